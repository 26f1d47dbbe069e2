//! The window of the user's gear: heads, modifiers, stands and booms, and what the studio needs of them.

use crate::editor::commands::command::Command;
use crate::editor::document::gear_shelf::{GearEntry, GearShelf, is_bare, support_text};
use crate::editor::ui::theme;
use crate::editor::ui::widgets;
use crate::gear::{GearUse, MOST_OWNED, gear_use, shortages};
use crate::photo::{dial_text, flash_time_text};
use crate::scene::{Head, Scene};
use eframe::egui::{self, DragValue, Grid, Label, Rect, RichText, ScrollArea, Ui, vec2};

/// Height of the list, which scrolls.
const LIST_HEIGHT: f32 = 300.0;
const NAME_WIDTH: f32 = 190.0;

/// The lists of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum GearTab {
    /// Heads.
    #[default]
    Heads,
    /// Modifiers.
    Modifiers,
    /// Stands and booms.
    Supports,
}

/// A row of a list.
struct GearRow {
    entry: GearEntry,
    name: String,
    owned: u32,
    facts: String,
    tip: String,
}

/// Draws the window; `open` becomes false when it is closed.
pub fn gear_ui(
    ctx: &egui::Context,
    view: Rect,
    open: &mut bool,
    tab: &mut GearTab,
    shelf: &GearShelf,
    scene: &Scene,
    out: &mut Vec<Command>,
) {
    widgets::tool_window("My gear", view, vec2(40.0, 60.0)).open(open).show(ctx, |ui| {
        let text = "Say how many of each you own. They then come first on the shelf, and what a studio needs beyond them \
                    is told here and on the set-up sheet.";
        ui.set_max_width(560.0);
        ui.add(Label::new(RichText::new(text).weak()).wrap());
        ui.horizontal(|ui| {
            let tabs = [
                (GearTab::Heads, "Heads", "Lamp heads: flash and continuous"),
                (GearTab::Modifiers, "Modifiers", "Softboxes, dishes, umbrellas, grids"),
                (GearTab::Supports, "Stands and booms", "What carries a light"),
            ];
            widgets::choice(ui, tab, &tabs);
        });
        let uses = gear_use(scene, shelf.list());
        ScrollArea::vertical().id_salt(*tab).max_height(LIST_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
            Grid::new(("gear", *tab)).num_columns(4).spacing([12.0, 4.0]).striped(true).show(ui, |ui| {
                for heading in ["Name", "Own", "In the studio", "Figures"] {
                    ui.label(RichText::new(heading).weak());
                }
                ui.end_row();
                for row in rows(*tab, shelf) {
                    row_ui(ui, &row, &uses, out);
                    ui.end_row();
                }
            });
        });
        ui.separator();
        shortages_ui(ui, shelf, scene);
        ui.horizontal(|ui| {
            if let Some(path) = shelf.path() {
                let tip = format!("Heads and modifiers of your own are written into {}", path.display());
                if ui.button("Read the list again").on_hover_text(tip).clicked() {
                    out.push(Command::ReadGear);
                }
                ui.add(Label::new(RichText::new(path.display().to_string()).weak().small()).truncate());
            }
        });
    });
}

fn shortages_ui(ui: &mut Ui, shelf: &GearShelf, scene: &Scene) {
    if let Some(failure) = shelf.failure() {
        ui.add(Label::new(RichText::new(failure).color(theme::bad(ui))).wrap());
    }
    if !shelf.list().has_own() {
        return;
    }
    let missing = shortages(scene, shelf.list(), &[]);
    if missing.is_empty() {
        ui.label(RichText::new("What this studio uses of the list is there.").weak());
    }
    for text in missing {
        ui.add(Label::new(RichText::new(text).color(theme::accent(ui))).wrap());
    }
}

fn rows(tab: GearTab, shelf: &GearShelf) -> Vec<GearRow> {
    let list = shelf.list();
    let source = |source: &str| format!("Source: {source}");
    let weight = |kg: Option<f32>| kg.map(|kg| format!(", {kg:.1} kg")).unwrap_or_default();
    let mut rows: Vec<GearRow> = match tab {
        GearTab::Heads => list
            .heads
            .iter()
            .map(|model| GearRow {
                entry: GearEntry::Head(model.head.name.clone()),
                name: model.head.name.clone(),
                owned: model.owned,
                facts: format!("{}{}", model.power_text(), weight(model.weight_kg)),
                tip: format!("{}\n{}", head_text(&model.head), source(&model.source)),
            })
            .collect(),
        GearTab::Modifiers => list
            .modifiers
            .iter()
            .filter(|model| !is_bare(model))
            .map(|model| GearRow {
                entry: GearEntry::Modifier(model.name.clone()),
                name: model.name.clone(),
                owned: model.owned,
                facts: format!(
                    "takes {:.1} stops{}",
                    model.modifier.loss_stops + model.modifier.scrim_stops,
                    weight(model.weight_kg)
                ),
                tip: source(&model.source),
            })
            .collect(),
        GearTab::Supports => list
            .supports
            .iter()
            .map(|support| GearRow {
                entry: GearEntry::Support(support.name.clone()),
                name: support.name.clone(),
                owned: support.owned,
                facts: support_text(support.kind, support.reach_m, support.load_kg),
                tip: source(&support.source),
            })
            .collect(),
    };
    rows.sort_by_key(|row| row.owned == 0);
    rows
}

/// Returns the dial of a head and what limits its flash.
pub fn head_text(head: &Head) -> String {
    let [low, full] = [head.dial.lowest_stops, 0.0].map(|stops| dial_text(&head.dial, stops));
    let mut text = format!("Dial {low} to {full}");
    if let Some(t01_s) = head.t01_s {
        text += &format!(", t0.1 {} at full power", flash_time_text(t01_s));
    }
    if let Some(sync_s) = head.sync_s {
        text += &format!(", sync up to {}", flash_time_text(sync_s));
    }
    if let Some(loss) = head.hss_loss_stops {
        text += &format!(", high-speed sync costs {loss:.1} stops and more");
    }
    text
}

fn row_ui(ui: &mut Ui, row: &GearRow, uses: &[GearUse], out: &mut Vec<Command>) {
    widgets::role_name(ui, None, &row.name, NAME_WIDTH).on_hover_text(&row.tip);
    let mut owned = row.owned;
    let field = ui.add(DragValue::new(&mut owned).range(0..=MOST_OWNED).speed(0.03).update_while_editing(false));
    widgets::named(ui, &field, &format!("Own {}", row.name));
    if owned != row.owned {
        out.push(Command::SetOwned(row.entry.clone(), owned));
    }
    let used = uses.iter().find(|each| each.name == row.name).map_or(0, |each| each.used);
    match (used, &row.entry) {
        (_, GearEntry::Support(_)) | (0, _) => drop(ui.label("")),
        (used, _) if used > row.owned && row.owned > 0 => {
            drop(ui.label(RichText::new(used.to_string()).color(theme::accent(ui))));
        }
        (used, _) => drop(ui.label(used.to_string())),
    }
    ui.label(RichText::new(&row.facts).weak()).on_hover_text(&row.tip);
}
