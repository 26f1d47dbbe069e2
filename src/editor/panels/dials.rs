//! The window that sets the dials of the lights for wanted exposures.

use crate::editor::commands::command::Command;
use crate::editor::document::dial_wishes::{DialWishes, WishRow};
use crate::editor::ui::theme;
use crate::editor::ui::widgets;
use crate::photo::dial_text;
use crate::photo::meter::nearest_third;
use crate::photo::text::signed_stops;
use crate::scene::{Light, Scene};
use crate::setup::{DialPlan, LightTransport, MeasurementJob, MeteredAt, SetupTransport};
use eframe::egui::{self, Button, Grid, Label, Rect, RichText, ScrollArea, TextEdit, Ui, vec2};

const NAME_WIDTH: f32 = 128.0;
const WISH_WIDTH: f32 = 84.0;
/// Height of the table that does not fit the window: it scrolls.
const TABLE_HEIGHT: f32 = 360.0;
const HEADINGS: [(&str, &str); 5] = [
    ("Light", "Metered by itself: at the subject, where it aims, or, for a rim light, turned to it"),
    ("Now", "The f-number of a meter at the camera's ISO and shutter, and stops over the key"),
    ("Wish", "f/8, or stops over the key: +0.5, -1.5. Empty: as it is"),
    ("Then", "What the meter would show"),
    ("Dial", "As the head displays it; stops from full power where the head is not known"),
];

/// Draws the window; `open` becomes false when it is closed.
pub fn dials_ui(
    ctx: &egui::Context,
    view: Rect,
    open: &mut bool,
    wishes: &mut DialWishes,
    job: &MeasurementJob<SetupTransport>,
    scene: &Scene,
    out: &mut Vec<Command>,
) {
    widgets::tool_window("Set dials by wish", view, vec2(20.0, 90.0)).open(open).show(ctx, |ui| match job.latest() {
        Some(Ok(setup)) if setup.lights().is_empty() => drop(ui.label("There are no lights in the studio.")),
        Some(Ok(setup)) => table_ui(ui, wishes, (setup, job.is_current()), scene, out),
        Some(Err(message)) => drop(ui.label(message)),
        None => drop(ui.label(RichText::new("Metering the lights\u{2026}").weak())),
    });
}

/// Draws wishes and plan. `is_current` says that the exposures are those of `scene`.
fn table_ui(
    ui: &mut Ui,
    wishes: &mut DialWishes,
    (setup, is_current): (&SetupTransport, bool),
    scene: &Scene,
    out: &mut Vec<Command>,
) {
    let plan = wishes.plan(setup).clone();
    ScrollArea::vertical().max_height(TABLE_HEIGHT).show(ui, |ui| {
        Grid::new("wishes").num_columns(5).spacing([12.0, 4.0]).show(ui, |ui| {
            for (heading, tip) in HEADINGS {
                ui.label(RichText::new(heading).weak()).on_hover_text(tip);
            }
            ui.end_row();
            for light in &scene.lights {
                if let Some(metered) = setup.light(light.id) {
                    light_row(ui, wishes, setup, light, metered, plan.as_ref().ok());
                    ui.end_row();
                }
            }
            for row in WishRow::PLACES {
                if row != WishRow::Background || setup.has_background() {
                    place_row(ui, wishes, setup, row, plan.as_ref().ok());
                    ui.end_row();
                }
            }
        });
    });
    ui.add_space(4.0);
    ui.set_max_width(470.0);
    match &plan {
        Err(message) => drop(ui.label(RichText::new(message).color(theme::bad(ui)))),
        Ok(plan) => plan_ui(ui, plan),
    }
    ui.horizontal(|ui| {
        let can_apply = is_current && plan.as_ref().is_ok_and(|plan| plan.changes().next().is_some());
        let apply = ui.add_enabled(can_apply, Button::new("Set the dials"));
        let tip = "Write the dials to the lights, as one step that can be undone";
        if apply.on_hover_text(tip).clicked()
            && let Ok(plan) = plan
        {
            out.push(Command::SetDials(Box::new(plan)));
        }
        if ui.add_enabled(!wishes.is_empty(), Button::new("Clear wishes")).clicked() {
            wishes.clear();
        }
        if !is_current {
            ui.label(RichText::new("Metering\u{2026}").weak());
        }
    });
}

/// Draws what the plan misses, and what it costs.
fn plan_ui(ui: &mut Ui, plan: &DialPlan) {
    let wrapped = |ui: &mut Ui, text: RichText| drop(ui.add(Label::new(text).wrap()));
    if plan.outcomes.is_empty() {
        wrapped(ui, RichText::new("Write a wish, such as f/8 for the key and -1.5 for the fill.").weak());
        return;
    }
    for outcome in &plan.outcomes {
        if let Some(note) = outcome.note() {
            let text = format!("{} cannot be {}: {note}.", outcome.wish.name, outcome.wish.level);
            wrapped(ui, RichText::new(text).color(theme::accent(ui)));
        } else if let Some(stops) = outcome.evenness_stops {
            wrapped(ui, RichText::new(format!("The background is even to \u{b1}{stops:.1} stops.")).weak());
        }
    }
    let [before, after] = plan.energy_lm_s;
    if before > 0.0 && after > 0.0 {
        let text = format!("Light energy of one exposure: {} stops.", signed_stops((after / before).log2()));
        wrapped(ui, RichText::new(text).weak());
    }
}

/// Draws the row of a light: reading, wish, then reading and dial of the plan.
fn light_row(
    ui: &mut Ui,
    wishes: &mut DialWishes,
    setup: &SetupTransport,
    light: &Light,
    metered: &LightTransport,
    plan: Option<&DialPlan>,
) {
    let at = match metered.at {
        MeteredAt::Subject => "Metered at the subject",
        MeteredAt::Rim => "Metered on the subject's back, turned to the light",
        MeteredAt::Aim => "Metered where it aims",
    };
    widgets::role_name(ui, Some(theme::role_color(light.role)), &light.name, NAME_WIDTH).on_hover_text(at);
    if metered.is_on {
        if setup.present_key() == Some(light.id) {
            ui.label(format!("{}  key", nearest_third(setup.f_number(metered.own_lux_s))));
        } else {
            exposure_ui(ui, setup, metered.own_lux_s, setup.key_lux_s());
        }
    } else {
        ui.label(RichText::new("off").weak());
    }
    if !metered.has_dial {
        ui.label(RichText::new("fixed").weak()).on_hover_text("Suns and surrounds have no dial");
        return;
    }
    let row = WishRow::Light(light.id);
    wish_ui(ui, wishes, row, &light.name, "f/8, -1.5");
    let dial = plan.and_then(|plan| plan.dials.iter().find(|dial| dial.light == light.id));
    match plan.zip(dial) {
        Some((plan, dial)) => {
            let now = if metered.is_on { metered.own_lux_s } else { 0.0 };
            let then = metered.own_lux_s * (dial.to_stops - dial.from_stops).exp2();
            let then = if dial.is_change() { then } else { now };
            exposure_ui(ui, setup, then, plan.key_lux_s);
            let from = if dial.was_on { setting(light, dial.from_stops) } else { "off".to_owned() };
            let text = format!("{from} to {}", setting(light, dial.to_stops));
            let text = if dial.is_change() { text } else { setting(light, dial.to_stops) };
            ui.label(RichText::new(text).strong());
        }
        None => {
            ui.label("");
            ui.label(RichText::new(setting(light, metered.dial_stops)).weak());
        }
    }
}

/// Formats a setting as the head displays it; stops from full power where the head is not known.
fn setting(light: &Light, stops: f32) -> String {
    light.head.as_ref().map_or_else(|| signed_stops(stops), |head| dial_text(&head.dial, stops))
}

/// Draws the row of a place: reading, wish, then the reading of the plan.
fn place_row(ui: &mut Ui, wishes: &mut DialWishes, setup: &SetupTransport, row: WishRow, plan: Option<&DialPlan>) {
    let name = row.name(setup);
    let (tip, hint, now_lux_s) = match row {
        WishRow::Spill => {
            ("Light on the subject of lights that aim at something else: no more than this", "-4", setup.spill_lux_s())
        }
        WishRow::Background => {
            ("All light behind the subject, where the picture shows it", "white, +1", setup.background_lux_s())
        }
        WishRow::Subject | WishRow::Light(_) => {
            ("All light at the subject; the lights keep their ratios", "f/8", setup.subject_lux_s())
        }
    };
    widgets::role_name(ui, None, &name, NAME_WIDTH).on_hover_text(tip);
    let of_row = |plan: &DialPlan| {
        let outcome = plan.outcomes.iter().find(|outcome| outcome.wish.target == row.target())?;
        Some((outcome.after_lux_s, plan.key_lux_s))
    };
    exposure_ui(ui, setup, now_lux_s, setup.key_lux_s());
    wish_ui(ui, wishes, row, &name, hint);
    match plan.and_then(of_row) {
        Some((then_lux_s, key_lux_s)) => exposure_ui(ui, setup, then_lux_s, key_lux_s),
        None => drop(ui.label("")),
    }
    ui.label("");
}

/// Draws an exposure as f-number and in stops over the key.
fn exposure_ui(ui: &mut Ui, setup: &SetupTransport, lux_s: f32, key_lux_s: f32) {
    if lux_s <= 0.0 {
        ui.label(RichText::new("dark").weak());
        return;
    }
    let number = setup.f_number(lux_s);
    let tip = format!("f/{number:.2} exactly");
    let over = (lux_s / key_lux_s).log2();
    let text = nearest_third(number);
    let text = if over.is_finite() { format!("{text}  {}", signed_stops(over)) } else { text };
    ui.label(text).on_hover_text(tip);
}

/// Draws the field of a wish.
fn wish_ui(ui: &mut Ui, wishes: &mut DialWishes, row: WishRow, name: &str, hint: &str) {
    let mut text = wishes.text(row).to_owned();
    let mut field = TextEdit::singleline(&mut text).hint_text(hint);
    if wishes.is_wrong(row) {
        field = field.text_color(theme::bad(ui));
    }
    let field = ui.add_sized(vec2(WISH_WIDTH, 20.0), field);
    widgets::named(ui, &field, &format!("Wish for {name}"));
    if field.changed() {
        wishes.set(row, text);
    }
}
