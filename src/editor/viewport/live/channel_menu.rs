//! The menu of the live view's options (channel, single light, highlights) and the legend of the false-colour
//! illuminance.

use crate::editor::ui::{legend, scopes};
use crate::editor::viewport::live::preview_host::ViewOptions;
use crate::photo::text::three_digits;
use crate::photo::{FALSE_STOPS, exposure, false_color};
use crate::preview::{Channel, Gloss};
use crate::scene::Scene;
use eframe::egui::{Checkbox, Painter, RadioButton, Rect, Ui, UiBuilder, vec2};

/// Width of the view below which the axes would cover false colour and scopes, points.
const NARROW: f32 = 440.0;

/// Draws the menu in the upper left corner of the view and changes `view_options`. The CPU preview (`on_cpu`) has
/// neither channels nor a choice of highlights.
pub fn channel_menu_ui(ui: &mut Ui, view: Rect, scene: &Scene, view_options: &mut ViewOptions, on_cpu: bool) {
    if on_cpu {
        (view_options.channel, view_options.gloss) = (Channel::Lit, Gloss::Ggx);
    }
    let place = Rect::from_min_size(view.min + vec2(8.0, 8.0), vec2(360.0, 24.0));
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            menu_ui(ui, scene, view_options, on_cpu);
            if view.width() > NARROW && view_options.channel == Channel::Lit {
                scopes::scopes_ui(ui, &mut view_options.display, &mut view_options.charts);
            }
        });
    });
    if view_options.channel == Channel::Illuminance {
        paint_legend(&ui.painter_at(view), view, scene);
    }
}

/// Draws the menu of channels, of the light that is shown, and of the view's quality.
fn menu_ui(ui: &mut Ui, scene: &Scene, view_options: &mut ViewOptions, on_cpu: bool) {
    let title = title(scene, view_options);
    ui.menu_button(title, |ui| {
        ui.set_min_width(210.0);
        for channel in Channel::ALL {
            let radio = RadioButton::new(view_options.channel == channel, channel.label());
            let response = ui.add_enabled(!on_cpu || channel == Channel::Lit, radio);
            if response.on_hover_text(tip(channel)).on_disabled_hover_text(NEEDS_DEVICE).clicked() {
                view_options.channel = channel;
            }
        }
        ui.separator();
        let lights = ui.menu_button("Show the light of", |ui| {
            ui.set_min_width(160.0);
            ui.radio_value(&mut view_options.only_light, None, "All lights");
            for light in &scene.lights {
                ui.radio_value(&mut view_options.only_light, Some(light.id), &light.name);
            }
        });
        lights.response.on_hover_text(
            "One light's share, in this view alone: meter and pictures keep them all. \
             Solo (O) switches the others off.",
        );
        let mut blinn_phong = view_options.gloss == Gloss::BlinnPhong;
        let tip = "Quicker highlights without the emitter's shape, instead of GGX";
        let checkbox = Checkbox::new(&mut blinn_phong, "Blinn-Phong highlights");
        if ui.add_enabled(!on_cpu, checkbox).on_hover_text(tip).changed() {
            view_options.gloss = if blinn_phong { Gloss::BlinnPhong } else { Gloss::Ggx };
        }
        let tip = "While nothing moves, the live view is drawn several times, each time through other points of its \
                   pixels, and shows the average";
        let checkbox = Checkbox::new(&mut view_options.smooth_edges, "Smooth edges");
        ui.add_enabled(!on_cpu, checkbox).on_hover_text(tip);
        let tip = "What walls, floor and backdrops throw back. Off, Quick shows the direct light of the lights alone";
        let checkbox = Checkbox::new(&mut view_options.bounced_light, "Bounced light");
        ui.add_enabled(!on_cpu, checkbox).on_hover_text(tip);
        let tip = "The traced view (True) shows smoothed light while it is worked on; settled, it is as traced. \
                   Pictures that are rendered are never smoothed.";
        ui.checkbox(&mut view_options.smooth, "Low-noise preview").on_hover_text(tip);
    })
    .response
    .on_hover_text("What the view shows of the studio");
}

fn title(scene: &Scene, view_options: &ViewOptions) -> String {
    match view_options.only_light.and_then(|id| scene.light(id)) {
        Some(light) => format!("{}: light of {} only", view_options.channel.label(), light.name),
        None => view_options.channel.label().to_owned(),
    }
}

/// Tooltip of options that the CPU preview lacks.
const NEEDS_DEVICE: &str = "Needs a GPU: the CPU draws this view";

fn tip(channel: Channel) -> &'static str {
    match channel {
        Channel::Lit => "The studio as it is lit",
        Channel::BaseColor => "What surfaces reflect, without any light",
        Channel::Normal => "Where surfaces face: red right, green up, blue to the front",
        Channel::Roughness => "From black, a mirror, to white, matte",
        Channel::Metallic => "Metal is white",
        Channel::Depth => {
            "From white at 0.5 m to black at 32 m, a sixth each time it doubles; without perspective, from the nearest \
             thing to the farthest"
        }
        Channel::Ids => "A colour for each surface",
        Channel::Illuminance => "Direct light on surfaces, in stops against the exposure that the camera is set for",
    }
}

/// Returns the lines of the legend: stops against the camera's exposure, in lux seconds and in lux at the camera's
/// shutter.
fn legend_lines(scene: &Scene) -> Vec<([u8; 3], String)> {
    let lux_s = exposure::lux_s_to_set(scene, scene.camera.f_number);
    let line = |stops: i32| {
        let lux_s = lux_s * (stops as f32).exp2();
        let [lux_s, lux] = [lux_s, lux_s / scene.camera.shutter_s].map(three_digits);
        let text = format!("{stops:+}   {lux_s} lx s   {lux} lx");
        (false_color(stops as f32), text)
    };
    (FALSE_STOPS.0..=FALSE_STOPS.1).rev().map(line).collect()
}

fn paint_legend(painter: &Painter, view: Rect, scene: &Scene) {
    legend::paint(painter, view, "Stops against the exposure set", &legend_lines(scene));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Camera;

    #[test]
    fn the_legend_shows_the_illuminance_of_the_camera_setting() {
        // ISO 100, f/8: 160 lx s (light_and_camera.md), at 1/125 s 20 000 lx.
        let camera = Camera { iso: 100.0, f_number: 8.0, shutter_s: 0.008, ..Camera::default() };
        let lines = legend_lines(&Scene { camera, ..Scene::default() });
        let set = lines.iter().find(|(_, line)| line.starts_with("+0")).unwrap();
        assert_eq!(set.1, "+0   160 lx s   20000 lx");
        assert_eq!(lines.len(), 10);
    }
}
