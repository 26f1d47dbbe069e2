//! The window of the room's part in the light.

use crate::editor::ui::theme;
use crate::editor::ui::widgets;
use crate::photo::text::signed_hundredths;
use crate::setup::{AuditedLight, RoomAudit, RoomSurface};
use eframe::egui::{self, Grid, Label, Rect, RichText, ScrollArea, Ui, vec2};

const NAME_WIDTH: f32 = 128.0;
/// Height of the table that does not fit the window: it scrolls.
const TABLE_HEIGHT: f32 = 360.0;

/// Draws the window; `open` becomes false when it is closed.
pub fn room_audit_ui(
    ctx: &egui::Context,
    view: Rect,
    open: &mut bool,
    audit: Option<Result<&RoomAudit, &str>>,
    is_current: bool,
) {
    widgets::tool_window("What the room adds", view, vec2(60.0, 140.0)).open(open).show(ctx, |ui| match audit {
        Some(Ok(audit)) => {
            audit_ui(ui, audit);
            if !is_current {
                ui.label(RichText::new("Metering the changed studio\u{2026}").weak());
            }
        }
        Some(Err(message)) => drop(ui.label(message)),
        None => {
            ui.label(RichText::new("Metering with and without walls, ceiling, floor and backdrops\u{2026}").weak());
        }
    });
}

/// Draws table, ceilings and flare.
fn audit_ui(ui: &mut Ui, audit: &RoomAudit) {
    if audit.total.lux_s <= 0.0 {
        ui.label("No light reaches the subject.");
        return;
    }
    let is_there = |surface: &RoomSurface| audit.total.without_lux_s.contains_key(surface);
    let surfaces: Vec<RoomSurface> = RoomSurface::ALL.into_iter().filter(is_there).collect();
    let rows = audit.lights.iter().chain([&audit.total]);
    ScrollArea::vertical().max_height(TABLE_HEIGHT).show(ui, |ui| {
        Grid::new("audit").num_columns(surfaces.len() + 2).spacing([14.0, 4.0]).striped(true).show(ui, |ui| {
            ui.label("");
            for surface in &surfaces {
                let tip = "Stops that the light by way of it adds at the subject: metered with it and with it black";
                ui.label(RichText::new(surface.label()).weak()).on_hover_text(tip);
            }
            let tip = "Light on the background against the key at the subject";
            ui.label(RichText::new("On the background").weak()).on_hover_text(tip);
            ui.end_row();
            for light in rows {
                row_ui(ui, audit, light, &surfaces);
                ui.end_row();
            }
        });
    });
    ui.add_space(4.0);
    ui.set_max_width(520.0);
    for trial in &audit.ceilings {
        let ratio = match (audit.key_to_fill, trial.key_to_fill) {
            (Some(now), Some(then)) => format!(", key to fill {then:.1}:1 instead of {now:.1}:1"),
            _ => String::new(),
        };
        let stops =
            trial.stops.map_or_else(|| "no light".to_owned(), |stops| format!("{} stops", signed_hundredths(stops)));
        ui.label(format!("A {} ceiling: {stops} at the subject{ratio}.", trial.color));
    }
    for name in &audit.flaring {
        let text = format!("{name} shines at the lens: shade it with a flag, or use a lens hood.");
        ui.add(Label::new(RichText::new(text).color(theme::accent(ui))).wrap());
    }
}

/// Draws the row of a light, or of all of them.
fn row_ui(ui: &mut Ui, audit: &RoomAudit, light: &AuditedLight, surfaces: &[RoomSurface]) {
    widgets::role_name(ui, light.role.map(theme::role_color), &light.name, NAME_WIDTH);
    for surface in surfaces {
        let percent = 100.0 * light.part(*surface);
        match light.added_stops(*surface) {
            Some(stops) if stops.is_finite() => {
                ui.label(signed_hundredths(stops)).on_hover_text(format!("{percent:.0} % of its light on the subject"));
            }
            Some(_) => drop(ui.label("all")),
            None => drop(ui.label(RichText::new("dark").weak())),
        }
    }
    match audit.background_stops(light) {
        Some(stops) => drop(ui.label(signed_hundredths(stops))),
        None => drop(ui.label(RichText::new("none").weak())),
    }
}
