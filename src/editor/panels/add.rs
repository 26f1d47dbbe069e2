//! The catalog panel: adds lights, figures, props and backdrops.

use crate::editor::commands::command::Command;
use crate::editor::document::catalog::{self, CatalogEntry, CatalogItem, CatalogKind, CatalogTab, entries};
use crate::editor::document::gear_shelf::GearShelf;
use crate::editor::panels::thumbnails::{THING_POINTS, Thumbnails};
use crate::editor::ui::search::{is_match, search_ui};
use crate::editor::ui::theme;
use crate::editor::ui::widgets;
use crate::gear::{HeadModel, ModifierModel};
use crate::io;
use crate::scene::{Emitter, Material, Scene};
use eframe::egui::{self, Button, Color32, CornerRadius, RichText, ScrollArea, Sense, Stroke, StrokeKind, Ui, vec2};

/// Side of the icon of a light.
const ICON_POINTS: f32 = 20.0;

/// Draws the catalog; `tab` is the open one. The user's own heads and modifiers come first among the lights of `scene`. A
/// query shows what is found in all tabs instead.
pub fn add_ui(
    ui: &mut Ui,
    tab: &mut CatalogTab,
    query: &mut String,
    thumbnails: &mut Thumbnails,
    gear: &GearShelf,
    scene: &Scene,
    out: &mut Vec<Command>,
) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.label(RichText::new("Add").strong());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let formats = io::model_format_names();
            let tip = format!("Bring in a model ({formats}; Ctrl+I), or drop its file on the window");
            if ui.add(Button::new("Import\u{2026}").small()).on_hover_text(tip).clicked() {
                out.push(Command::Import);
            }
            search_ui(ui, "Search the shelf", query)
                .on_hover_text("In all tabs, by name and tip; Esc leaves the field");
        });
    });
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        // The last name fits in the narrowest window.
        ui.spacing_mut().button_padding.x = if ui.available_width() < 228.0 { 4.0 } else { 6.0 };
        for each in CatalogTab::ALL {
            let is_open = *tab == each && query.is_empty();
            if ui.selectable_label(is_open, each.label()).on_hover_text(tab_tip(each)).clicked() {
                *tab = each;
                query.clear();
            }
        }
    });
    ui.separator();
    ScrollArea::vertical().id_salt("add list").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        let (found, own, files) = (found(*tab, query), own_gear(gear, *tab, query), file_lights(*tab, query));
        if found.is_empty() && own.is_empty() && files.is_empty() {
            ui.label(RichText::new("Nothing on the shelf has these words.").weak());
        }
        own_gear_ui(ui, &own, gear, scene, out);
        for entry in found {
            if entry_ui(ui, entry, thumbnails) {
                out.push(Command::AddFromCatalog(Box::new(entry.make())));
            }
        }
        for light in files {
            if file_light_ui(ui, light) {
                out.push((light.command)());
            }
        }
    });
}

/// A light whose file a dialog selects.
struct FileLight {
    name: &'static str,
    tip: &'static str,
    command: fn() -> Command,
}

const FILE_LIGHTS: [FileLight; 2] = [
    FileLight {
        name: "Measured light",
        tip: "A lamp with the distribution of its photometric file (IES, EULUMDAT)",
        command: || Command::MeasuredLight(None),
    },
    FileLight {
        name: "Environment",
        tip: "Light from all round, by a panorama (HDR, EXR)",
        command: || Command::EnvironmentMap(None),
    },
];

/// Returns the lights of files that have the words of a query, or, without one, are in a tab.
fn file_lights(tab: CatalogTab, query: &str) -> Vec<&'static FileLight> {
    let is_in_tab = tab == CatalogTab::Lights || !query.trim().is_empty();
    FILE_LIGHTS.iter().filter(|light| is_in_tab && is_match(query, &[light.name, light.tip])).collect()
}

fn file_light_ui(ui: &mut Ui, light: &FileLight) -> bool {
    let size = vec2(ui.available_width(), 22.0);
    let button = Button::new(format!("{}\u{2026}", light.name)).frame_when_inactive(false).min_size(size);
    let button = ui.add(button.right_text(RichText::new("+").weak()));
    widgets::named(ui, &button, &format!("Add {}", light.name));
    button.on_hover_text(format!("Add: {}", light.tip)).clicked()
}

/// A head or a modifier that the user owns.
enum OwnGear<'a> {
    Head(&'a HeadModel),
    Modifier(&'a ModifierModel),
}

impl OwnGear<'_> {
    fn name(&self) -> &str {
        match self {
            OwnGear::Head(model) => &model.head.name,
            OwnGear::Modifier(model) => &model.name,
        }
    }
}

/// Returns the heads and modifiers of the user that have the words of a query, or, without one, are in a tab.
fn own_gear<'a>(gear: &'a GearShelf, tab: CatalogTab, query: &str) -> Vec<OwnGear<'a>> {
    let list = gear.list();
    let heads = list.heads.iter().filter(|model| model.owned > 0).map(OwnGear::Head);
    let modifiers = list.modifiers.iter().filter(|model| model.owned > 0).map(OwnGear::Modifier);
    let is_in_tab = tab == CatalogTab::Lights || !query.trim().is_empty();
    heads.chain(modifiers).filter(|own| is_in_tab && is_match(query, &[own.name()])).collect()
}

/// Draws heads and modifiers of the user, with how many of each the studio leaves.
fn own_gear_ui(ui: &mut Ui, own: &[OwnGear<'_>], gear: &GearShelf, scene: &Scene, out: &mut Vec<Command>) {
    if own.is_empty() {
        return;
    }
    ui.label(RichText::new("My gear").weak().small());
    for each in own {
        let (owned, tip, icon) = match each {
            OwnGear::Head(model) => {
                let light = GearShelf::light_on(model);
                let icon = CatalogKind::Light(light.emitter, light.modifier, light.power.output);
                (model.owned, model.power_text(), icon)
            }
            OwnGear::Modifier(model) => {
                let icon = CatalogKind::Light(model.emitter, model.modifier, catalog::HEAD);
                (model.owned, "On the first head that is free".to_owned(), icon)
            }
        };
        let left = match gear.left(scene, each.name(), owned) {
            left if left > 0 => format!("{left} of {owned} left"),
            _ => "all used".to_owned(),
        };
        if add_row(ui, each.name(), &tip, &left, &icon) {
            let light = match each {
                OwnGear::Head(model) => GearShelf::light_on(model),
                OwnGear::Modifier(model) => gear.light_with(scene, model),
            };
            out.push(Command::AddFromCatalog(Box::new(CatalogItem::Light(light))));
        }
    }
    ui.add_space(4.0);
    ui.label(RichText::new("All").weak().small());
}

/// Draws a row with the icon of a light; returns true if it is clicked.
fn add_row(ui: &mut Ui, name: &str, tip: &str, note: &str, icon: &CatalogKind) -> bool {
    let row = ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(ICON_POINTS, ICON_POINTS), Sense::hover());
        paint_icon(ui, rect, icon);
        let button = Button::new(name).frame_when_inactive(false).min_size(vec2(ui.available_width(), 22.0)).truncate();
        let button = ui.add(button.right_text(RichText::new(note).weak().small()));
        widgets::named(ui, &button, &format!("Add my {name}"));
        button.on_hover_text(format!("Add: {tip}")).clicked()
    });
    row.inner
}

/// Returns what has the words of a query, or, without one, what is in a tab.
fn found(tab: CatalogTab, query: &str) -> Vec<&'static CatalogEntry> {
    let tabs = if query.trim().is_empty() { vec![tab] } else { CatalogTab::ALL.to_vec() };
    let all = tabs.into_iter().flat_map(entries);
    all.filter(|entry| is_match(query, &[entry.name, entry.tip])).collect()
}

fn tab_tip(tab: CatalogTab) -> &'static str {
    match tab {
        CatalogTab::Lights => "Softboxes, strips, dishes, bulbs, spots, windows, sun and sky",
        CatalogTab::Figures => "People, ready dressed and posed; everything about them can be changed",
        CatalogTab::Props => "Things to light: shapes, products, boards, reference balls and cards",
        CatalogTab::Backdrops => {
            "Paper rolls in white, grey, black and colours, cloths, a painted canvas and a cyclorama"
        }
    }
}

fn entry_ui(ui: &mut Ui, entry: &'static CatalogEntry, thumbnails: &mut Thumbnails) -> bool {
    // Lights have icons of shape and size instead of thumbnails.
    let side = if matches!(entry.kind, CatalogKind::Light(..)) { ICON_POINTS } else { THING_POINTS };
    ui.horizontal(|ui| {
        let (icon, _) = ui.allocate_exact_size(vec2(side, side), Sense::hover());
        match thumbnails.thing(ui.ctx(), entry) {
            Some(picture) => picture.paint(ui, icon),
            None => paint_icon(ui, icon, &entry.kind),
        }
        let size = vec2(ui.available_width(), side.max(22.0));
        let button = Button::new(entry.name).frame_when_inactive(false).min_size(size);
        let button = ui.add(button.right_text(RichText::new("+").weak()));
        widgets::named(ui, &button, &format!("Add {}", entry.name));
        button.on_hover_text(format!("Add: {}", entry.tip)).clicked()
    })
    .inner
}

/// Paints the icon of an entry.
fn paint_icon(ui: &Ui, rect: egui::Rect, kind: &CatalogKind) {
    let (c, line) = (rect.center(), Stroke::new(1.3, ui.visuals().text_color()));
    let (painter, glow) = (ui.painter(), theme::accent(ui));
    match kind {
        CatalogKind::Light(Emitter::RectPanel { width_m, height_m }, ..) => {
            let scale = 14.0 / width_m.max(*height_m);
            let panel = egui::Rect::from_center_size(c, vec2((width_m * scale).max(4.0), (height_m * scale).max(4.0)));
            painter.rect_stroke(panel, CornerRadius::same(1), Stroke::new(1.3, glow), StrokeKind::Middle);
        }
        CatalogKind::Light(Emitter::RoundPanel { diameter_m }, ..) => {
            painter.circle_stroke(c, (4.0 + 2.0 * diameter_m).min(7.5), Stroke::new(1.3, glow));
        }
        CatalogKind::Light(Emitter::Spot { .. }, ..) => {
            let cone = [c + vec2(-6.0, 0.0), c + vec2(6.0, -5.5), c + vec2(6.0, 5.5)];
            painter.add(egui::Shape::closed_line(cone.to_vec(), Stroke::new(1.3, glow)));
        }
        CatalogKind::Light(Emitter::Surround, ..) => {
            painter.circle_stroke(c, 7.0, Stroke::new(1.0, glow));
            painter.circle_stroke(c, 4.0, Stroke::new(1.0, glow.gamma_multiply(0.6)));
        }
        CatalogKind::Light(Emitter::Point | Emitter::Sphere { .. } | Emitter::Sun { .. }, ..) => {
            painter.circle_filled(c, 3.2, glow);
            for i in 0..8 {
                let direction = egui::Vec2::angled(i as f32 * std::f32::consts::FRAC_PI_4);
                painter.line_segment([c + direction * 5.0, c + direction * 7.5], Stroke::new(1.2, glow));
            }
        }
        CatalogKind::Figure(_) => {
            painter.circle_filled(c - vec2(0.0, 4.0), 3.2, line.color);
            let shoulders = [c + vec2(-6.0, 8.0), c + vec2(-3.5, 1.0), c + vec2(3.5, 1.0), c + vec2(6.0, 8.0)];
            painter.add(egui::Shape::convex_polygon(shoulders.to_vec(), line.color, Stroke::NONE));
        }
        CatalogKind::Model(model, whole) => {
            let own = || model.materials().into_iter().next().map(|(_, material)| material).unwrap_or_default();
            paint_patch(painter, c, &whole.map_or_else(own, |preset| preset.material()), vec2(10.0, 13.0));
        }
        CatalogKind::Prop(_, preset) => paint_patch(painter, c, &preset.material(), vec2(12.0, 12.0)),
        CatalogKind::Roll { width_m, surface } => {
            paint_patch(painter, c, &surface.material(), vec2(5.0 * width_m.min(3.0), 14.0));
        }
    }
}

fn paint_patch(painter: &egui::Painter, c: egui::Pos2, material: &Material, size: egui::Vec2) {
    let [r, g, b] = material.base_color.map(|v| (crate::color::srgb_encode(v) * 255.0) as u8);
    let rect = egui::Rect::from_center_size(c, size);
    painter.rect(
        rect,
        CornerRadius::same(2),
        Color32::from_rgb(r, g, b),
        Stroke::new(1.0, Color32::from_gray(110)),
        StrokeKind::Middle,
    );
}
