//! The sections of a water tank: its time, its springs, its ground and its cells.

use super::fluid::{fluid_rows, motion_row};
use super::{TankTools, text_ui};
use crate::editor::commands::choices::Brush;
use crate::editor::commands::command::Command;
use crate::editor::document::tank_player::TankPlayer;
use crate::editor::ui::widgets::{self, METRES, NumberField, fact, row, section};
use crate::scene::{BrushStroke, CellContent, ObjectId, Spring, Tank, TankLook, Terrain};
use eframe::egui::{DragValue, Ui};
use glam::Vec3;

/// Speeds of the studio's time.
const SPEEDS: [(f32, &str, &str); 5] = [
    (0.1, "1/10", "A tenth of the speed of nature"),
    (0.25, "1/4", "A quarter of the speed of nature"),
    (1.0, "1", "The speed of nature, if the machine keeps up"),
    (2.0, "2", "Twice the speed of nature"),
    (4.0, "4", "Four times the speed of nature"),
];
/// Flow of a new spring, litres per second.
const FLOW_L_S: f32 = 0.1;

/// Draws the sections of a tank.
pub(super) fn tank_ui(ui: &mut Ui, id: ObjectId, tank: &mut Tank, tools: TankTools<'_>, out: &mut Vec<Command>) {
    section(ui, "Water", true, |ui| {
        motion_row(ui, tank);
        time_rows(ui, id, tank, tools.player, out);
        row(ui, "Still water", "Height of the water at the start, above the underside", |ui| {
            NumberField::new(0.2, 0.0, 10_000.0, 1, " cm").scaled_ui(ui, &mut tank.water_m, 100.0)
        });
        row(ui, "Drawn as", "The surfaces of water and ground", |ui| {
            let looks = [
                (TankLook::Smooth, "Smooth", "Smooth surfaces through the cells"),
                (TankLook::Cubes, "Cubes", "The cells that are at least half full, as cubes"),
            ];
            widgets::choice(ui, &mut tank.look, &looks);
        });
    });
    let size = tank.size_m();
    match &mut tank.fluid {
        Some(fluid) => section(ui, "Drops, jets and obstacles", true, |ui| fluid_rows(ui, fluid, size)),
        None => section(ui, "Springs", true, |ui| spring_rows(ui, tank)),
    }
    section(ui, "Ground", true, |ui| ground_rows(ui, tank));
    section(ui, "Brush", true, |ui| brush_rows(ui, id, tank, tools.brush, out));
    section(ui, "Cells", false, |ui| cell_rows(ui, tank));
    tank.time_s = tank.time_s.min(tank.longest_s());
}

fn time_rows(ui: &mut Ui, id: ObjectId, tank: &mut Tank, player: &TankPlayer, out: &mut Vec<Command>) {
    let longest_s = tank.longest_s();
    row(ui, "Time", "Since the start; a render shows the water at this time", |ui| {
        NumberField::new(1.0 / f64::from(tank.steps_per_s()), 0.0, longest_s, 3, " s").ui(ui, &mut tank.time_s)
    });
    row(ui, "Run", "The water runs in the studio; undo brings back the time before", |ui| {
        let is_playing = player.is_playing(id);
        let (text, tip) = if is_playing { ("Pause", "Hold the water") } else { ("Play", "Let the water run") };
        if ui.button(text).on_hover_text(tip).clicked() {
            out.push(Command::PlayTank((!is_playing).then_some(id)));
        }
        if ui.button("Step").on_hover_text("A sixtieth of a second; a fluid: 1/240").clicked() {
            tank.time_s = (tank.steps() + 1) as f32 / tank.steps_per_s();
        }
        if ui.button("To the start").on_hover_text("The water as it was at first").clicked() {
            out.push(Command::PlayTank(None));
            tank.time_s = 0.0;
        }
    });
    row(ui, "Speed", "Of the water while it runs here; pictures do not depend on it", |ui| {
        let mut speed = player.speed();
        widgets::choice(ui, &mut speed, &SPEEDS);
        if speed != player.speed() {
            out.push(Command::SetTankSpeed(speed));
        }
    });
}

fn spring_rows(ui: &mut Ui, tank: &mut Tank) {
    let (step, time_s, low, size) = (tank.steps(), tank.time_s, tank.low_m(), tank.size_m());
    let mut gone = None;
    for (index, spring) in tank.springs.iter_mut().enumerate() {
        let name = format!("Spring {}", index + 1);
        row(ui, &name, "Switched at the time shown: what it did before stays", |ui| {
            let mut on = spring.is_on(step);
            let was_on = on;
            ui.checkbox(&mut on, "On");
            if on != was_on {
                spring.switch(time_s);
            }
            NumberField::new(0.01, 0.0, 1e6, 2, " l/s").ui(ui, &mut spring.litres_per_s);
            if widgets::small_button(ui, "\u{d7}", &format!("Take {name} away")).clicked() {
                gone = Some(index);
            }
        });
        row(ui, "", "Its place in the tank, from the middle of the underside", |ui| {
            widgets::vec3_ui(ui, &name, METRES, &mut spring.at_m);
        });
        spring.at_m = spring.at_m.clamp(low, low + size);
    }
    if let Some(index) = gone {
        tank.springs.remove(index);
    }
    row(ui, "", "", |ui| {
        let has_room = tank.springs.len() < Tank::MAX_SPRINGS;
        ui.add_enabled_ui(has_room, |ui| {
            if ui.button("Add a spring").on_hover_text("Above the middle; it is on from now on").clicked() {
                let at_m = Vec3::Y * (0.9 * size.y);
                tank.springs.push(Spring { switches_s: vec![time_s], ..Spring::new(at_m, FLOW_L_S) });
            }
        });
    });
}

/// The kinds of ground.
#[derive(Clone, Copy, PartialEq)]
enum GroundKind {
    Flat,
    Basin,
    Hills,
    Picture,
}

fn ground_rows(ui: &mut Ui, tank: &mut Tank) {
    let height = |ui: &mut Ui, label: &str, tip: &str, value: &mut f32| {
        row(ui, label, tip, |ui| NumberField::new(0.2, 0.0, 10_000.0, 1, " cm").scaled_ui(ui, value, 100.0));
    };
    // Draw the kinds of ground
    let before = match tank.terrain {
        Terrain::Flat { .. } => GroundKind::Flat,
        Terrain::Basin { .. } => GroundKind::Basin,
        Terrain::Hills { .. } => GroundKind::Hills,
        Terrain::Picture { .. } => GroundKind::Picture,
    };
    let mut kind = before;
    row(ui, "Ground", "The shape of the ground", |ui| {
        let kinds = [
            (GroundKind::Flat, "Flat", "Level, or none"),
            (GroundKind::Basin, "Basin", "A round basin with a rim"),
            (GroundKind::Hills, "Hills", "Hills and valleys by chance"),
            (GroundKind::Picture, "Picture", "The brightness of a picture"),
        ];
        widgets::choice(ui, &mut kind, &kinds);
    });
    // Another kind starts with heights that fit the tank
    let top_m = tank.size_m().y;
    if kind != before {
        tank.terrain = match kind {
            GroundKind::Flat => Terrain::Flat { height_m: 0.1 * top_m },
            GroundKind::Basin => Terrain::Basin { floor_m: 0.1 * top_m, rim_m: 0.7 * top_m },
            GroundKind::Picture => {
                Terrain::Picture { path: "heights.png".to_owned(), low_m: 0.1 * top_m, high_m: 0.9 * top_m }
            }
            GroundKind::Hills => {
                Terrain::Hills { seed: 5, low_m: 0.1 * top_m, high_m: 0.9 * top_m, period_m: 0.6 * tank.size_m().x }
            }
        };
    }
    // Draw the rows of the kind
    match &mut tank.terrain {
        Terrain::Picture { path, low_m, high_m } => {
            row(ui, "File", "A picture beside the studio's file, such as heights.png", |ui| {
                if let Some(typed) = text_ui(ui, "height picture", path, false) {
                    *path = typed;
                }
            });
            height(ui, "Black", "Height of the ground where the picture is black", low_m);
            height(ui, "White", "Height of the ground where it is white", high_m);
        }
        Terrain::Flat { height_m } => height(ui, "Height", "Above the underside; 0 for no ground", height_m),
        Terrain::Basin { floor_m, rim_m } => {
            height(ui, "Floor", "The lowest point, above the underside", floor_m);
            height(ui, "Rim", "The ground around the basin", rim_m);
        }
        Terrain::Hills { seed, low_m, high_m, period_m } => {
            row(ui, "Landscape", "Another one by chance; undo brings the last one back", |ui| {
                if ui.button("Another").clicked() {
                    *seed = seed.wrapping_add(1);
                }
            });
            height(ui, "Valleys", "The lowest one, above the underside", low_m);
            height(ui, "Hills", "The highest one", high_m);
            row(ui, "From hill to hill", "Distance", |ui| {
                NumberField::new(0.5, 0.1, 10_000.0, 1, " cm").scaled_ui(ui, period_m, 100.0)
            });
        }
    }
}

fn brush_rows(ui: &mut Ui, id: ObjectId, tank: &mut Tank, active: Option<Brush>, out: &mut Vec<Command>) {
    let active = active.filter(|brush| brush.tank == id);
    let remembered = ui.scope_id().with("brush");
    let mut brush = active.unwrap_or_else(|| {
        ui.data(|data| data.get_temp(remembered))
            .filter(|brush: &Brush| brush.tank == id)
            .unwrap_or(Brush::new(id, tank))
    });
    let before = brush;
    row(ui, "Paint", "What a drag over the tank in the view fills its cells with", |ui| {
        let contents = [
            (CellContent::Ground, "Ground", "Matte ground"),
            (CellContent::Water, "Water", "Water that is there at the start"),
            (CellContent::Metal, "Metal", "Metal"),
            (CellContent::Air, "Air", "Takes away what is there: holes, caves"),
        ];
        widgets::choice(ui, &mut brush.content, &contents);
    });
    let largest_m = BrushStroke::MAX_RADIUS_CELLS * tank.cell_m;
    row(ui, "Radius", "Of the brush, on the surface under the pointer", |ui| {
        NumberField::new(0.05, 0.01, 100.0 * largest_m, 2, " cm").scaled_ui(ui, &mut brush.radius_m, 100.0)
    });
    ui.data_mut(|data| data.insert_temp(remembered, brush));
    row(ui, "Brush", "Its strokes belong to the start: the water goes back there", |ui| {
        let text = if active.is_some() { "Put it down" } else { "Paint in the view" };
        if ui.button(text).clicked() {
            out.push(Command::SetBrush(active.is_none().then_some(brush)));
        } else if active.is_some() && brush != before {
            out.push(Command::SetBrush(Some(brush)));
        }
    });
    row(ui, "Strokes", "Each can be undone; together they can be cleared", |ui| {
        ui.label(tank.strokes.len().to_string());
        ui.add_enabled_ui(!tank.strokes.is_empty(), |ui| {
            if ui.button("Clear strokes").clicked() {
                tank.strokes.clear();
            }
        });
    });
}

fn cell_rows(ui: &mut Ui, tank: &mut Tank) {
    let mut changed = tank.clone();
    row(ui, "Cells", "Along X, Y and Z; more show finer water and take longer", |ui| {
        for side in &mut changed.cells {
            ui.add(DragValue::new(side).range(1..=Tank::MAX_SIDE));
        }
    });
    row(ui, "Edge", "Of a cell", |ui| {
        NumberField::new(0.1, 0.1, 10_000.0, 2, " mm").scaled_ui(ui, &mut changed.cell_m, 1000.0)
    });
    if changed.cell_count() <= Tank::MAX_CELLS {
        *tank = changed;
    }
    let size = 100.0 * tank.size_m();
    fact(ui, "Size", "Width, height and depth", format!("{:.1} x {:.1} x {:.1} cm", size.x, size.y, size.z));
}
