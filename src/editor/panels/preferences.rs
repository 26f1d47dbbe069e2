//! The window of the preferences.

use crate::editor::commands::command::Command;
use crate::editor::commands::preferences::{METER_CONSTANTS, Preferences, SCALES};
use crate::editor::ui::widgets::{self, NumberField, row};
use crate::sheet::Units;
use eframe::egui::{self, Align2, Button, ComboBox, Context, RichText, ThemePreference, Ui, vec2};

/// Selectable scales.
const STEPS: [f32; 9] = [SCALES.0, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, SCALES.1];

/// Draws the window; `open` becomes false when it is closed.
pub fn preferences_ui(ctx: &Context, open: &mut bool, preferences: &Preferences, out: &mut Vec<Command>) {
    let mut changed = *preferences;
    egui::Window::new("Preferences")
        .open(open)
        .resizable(false)
        .collapsible(false)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .show(ctx, |ui| {
            ui.set_width(380.0);
            rows(ui, &mut changed);
            ui.separator();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let is_default = changed == Preferences::default();
                let button = ui.add_enabled(!is_default, Button::new("As delivered").min_size(vec2(96.0, 24.0)));
                if button.on_hover_text("All preferences as in a new installation").clicked() {
                    changed = Preferences::default();
                }
            });
        });
    if changed != *preferences {
        out.push(Command::SetPreferences(changed));
    }
}

fn rows(ui: &mut Ui, preferences: &mut Preferences) {
    row(ui, "Scale", "Size of all texts and buttons", |ui| {
        let percent = |scale: f32| format!("{:.0} %", 100.0 * scale);
        ComboBox::from_id_salt("scale").selected_text(percent(preferences.scale)).width(84.0).show_ui(ui, |ui| {
            for step in STEPS {
                ui.selectable_value(&mut preferences.scale, step, percent(step));
            }
        });
    });
    note(ui, "Ctrl + plus, Ctrl + minus and Ctrl + 0 do the same.");
    row(ui, "Theme", "Colours of the panels; the picture always lies on dark grey", |ui| {
        let themes = [
            (ThemePreference::Dark, "Dark", "For a dim room: the eye judges the picture"),
            (ThemePreference::Light, "Light", "For a bright room"),
            (ThemePreference::System, "As the system", "As other programs are"),
        ];
        widgets::choice(ui, &mut preferences.theme, &themes);
    });
    row(ui, "Lengths", "In read-outs, plans and rulers, and on set-up sheets", |ui| {
        let units =
            [(Units::Metres, "Metres", "Metres and centimetres"), (Units::Feet, "Feet", "Feet and inches, as 4' 7\"")];
        widgets::choice(ui, &mut preferences.units, &units);
    });
    note(ui, "Number fields stay in metres, and take what is typed in any unit: 5 ft, 12 in.");
    row(ui, "Meter constant", "Calibration constant C of the incident meter (ISO 2720)", |ui| {
        let (low, high) = METER_CONSTANTS;
        NumberField::new(1.0, low, high, 0, " lx s").ui(ui, &mut preferences.meter_constant);
        for (constant, tip) in [
            (250.0, "Flat receptors, and what shipped studios are set for"),
            (330.0, "Domes of Minolta's meters and their like"),
            (340.0, "Domes of Sekonic's meters and their like"),
        ] {
            let is_it = preferences.meter_constant == constant;
            if ui.add(Button::selectable(is_it, format!("{constant}"))).on_hover_text(tip).clicked() {
                preferences.meter_constant = constant;
            }
        }
    });
    note(
        ui,
        "C of your own meter, for new studios: the f-numbers here are then those that it shows. The camera of an open \
         studio has its own, in the inspector.",
    );
}

fn note(ui: &mut Ui, text: &str) {
    ui.add(egui::Label::new(RichText::new(text).weak().small()).wrap());
    ui.add_space(4.0);
}
