//! The section of a tank's fluid: its drops, its jets and the things in it.

use crate::editor::ui::widgets::{self, NumberField, row};
use crate::scene::{Drop, Fluid, Jet, Obstacle, ObstacleForm, Tank};
use eframe::egui::Ui;
use glam::Vec3;

/// Places and sizes, to a millimetre.
const PLACE: NumberField = NumberField::new(0.001, -1000.0, 1000.0, 3, " m");
/// Components of velocities.
const VELOCITY: NumberField = NumberField::new(0.02, -100.0, 100.0, 2, " m/s");

/// Draws the choice between water that flows from cell to cell and a fluid.
pub(super) fn motion_row(ui: &mut Ui, tank: &mut Tank) {
    let was_fluid = tank.fluid.is_some();
    let mut is_fluid = was_fluid;
    row(ui, "Moves", "How the water moves", |ui| {
        let ways = [
            (false, "From cell to cell", "Fast: lakes and streams that fill, spread and come to rest"),
            (true, "As a fluid", "By the laws of motion: splashes, jets and waves"),
        ];
        widgets::choice(ui, &mut is_fluid, &ways);
    });
    if is_fluid != was_fluid {
        tank.fluid = is_fluid.then(|| Box::new(Fluid { seed: 1, ..Fluid::default() }));
    }
}

/// Draws the rows of a fluid. `size` is that of the tank, metres.
pub(super) fn fluid_rows(ui: &mut Ui, fluid: &mut Fluid, size: Vec3) {
    let unit = 0.1 * size.min_element();
    let above = Vec3::Y * (0.8 * size.y);
    list(
        ui,
        &mut fluid.drops,
        ("Drop", "A ball of water at the start"),
        || Drop { at_m: above, radius_m: unit, velocity_m_s: Vec3::ZERO },
        |ui, name, drop| {
            length(ui, "Radius", "Of the ball", &mut drop.radius_m);
            place(ui, name, "Its middle, from the middle of the underside", &mut drop.at_m);
            velocity(ui, name, "At the start", &mut drop.velocity_m_s);
        },
    );
    list(
        ui,
        &mut fluid.jets,
        ("Jet", "Water that a round nozzle pours"),
        || Jet { at_m: above, radius_m: 0.5 * unit, velocity_m_s: Vec3::NEG_Y, until_s: 10.0 },
        |ui, name, jet| {
            length(ui, "Radius", "Of the nozzle", &mut jet.radius_m);
            place(ui, name, "The middle of the nozzle, from the middle of the underside", &mut jet.at_m);
            velocity(ui, name, "At the nozzle", &mut jet.velocity_m_s);
            seconds(ui, "Ends", "The time at which it ends", &mut jet.until_s);
        },
    );
    list(
        ui,
        &mut fluid.obstacles,
        ("Obstacle", "A thing in the water; an object of the same size shows it"),
        || Obstacle { form: ObstacleForm::Ball { radius_m: unit }, at_m: Vec3::ZERO, falls_m_s: 0.0, stands_s: 0.0 },
        |ui, name, obstacle| {
            form_rows(ui, name, &mut obstacle.form, unit);
            place(ui, name, "The middle of its underside where it stands", &mut obstacle.at_m);
            row(ui, "Falls", "The speed at which it falls until it stands there", |ui| {
                NumberField::new(0.05, 0.0, 100.0, 2, " m/s").ui(ui, &mut obstacle.falls_m_s)
            });
            seconds(ui, "Stands", "The time at which it stands there", &mut obstacle.stands_s);
        },
    );
    row(ui, "Irregularity", "Another water by chance; undo brings the last one back", |ui| {
        if ui.button("Another one").on_hover_text("Drops and fingers elsewhere").clicked() {
            fluid.seed = fluid.seed.wrapping_add(1).max(1);
        }
    });
}

/// The forms of obstacles.
#[derive(Clone, Copy, PartialEq)]
enum FormKind {
    Ball,
    Box,
    Cylinder,
    Glass,
}

fn form_rows(ui: &mut Ui, name: &str, form: &mut ObstacleForm, unit: f32) {
    let before = match form {
        ObstacleForm::Ball { .. } => FormKind::Ball,
        ObstacleForm::Box { .. } => FormKind::Box,
        ObstacleForm::Cylinder { .. } => FormKind::Cylinder,
        ObstacleForm::Glass { .. } => FormKind::Glass,
    };
    let mut kind = before;
    row(ui, "Form", "Of the thing", |ui| {
        let kinds = [
            (FormKind::Ball, "Ball", "A ball"),
            (FormKind::Box, "Box", "A box"),
            (FormKind::Cylinder, "Cylinder", "An upright cylinder"),
            (FormKind::Glass, "Glass", "An upright glass with its drink"),
        ];
        widgets::choice(ui, &mut kind, &kinds);
    });
    if kind != before {
        *form = match kind {
            FormKind::Ball => ObstacleForm::Ball { radius_m: unit },
            FormKind::Box => ObstacleForm::Box { size_m: Vec3::splat(2.0 * unit) },
            FormKind::Cylinder => ObstacleForm::Cylinder { radius_m: unit, height_m: 2.0 * unit },
            // The hollow of the tumbler among the props
            FormKind::Glass => ObstacleForm::Glass {
                floor_m: 0.0108,
                floor_radius_m: 0.0306,
                rim_m: 0.1,
                rim_radius_m: 0.0344,
                drink_m: 0.02,
            },
        };
    }
    match form {
        ObstacleForm::Ball { radius_m } => length(ui, "Radius", "Of the ball", radius_m),
        ObstacleForm::Box { size_m } => {
            row(ui, "Size", "Of the box", |ui| widgets::vec3_ui(ui, &format!("{name} size"), PLACE, size_m));
            *size_m = size_m.max(Vec3::splat(1e-4));
        }
        ObstacleForm::Cylinder { radius_m, height_m } => {
            length(ui, "Radius", "Of the cylinder", radius_m);
            length(ui, "Height", "Of the cylinder", height_m);
        }
        ObstacleForm::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, drink_m } => {
            length(ui, "Floor", "Of the hollow, above the underside", floor_m);
            length(ui, "Floor radius", "Of the hollow at its floor", floor_radius_m);
            length(ui, "Rim", "Above the underside", rim_m);
            length(ui, "Rim radius", "Of the hollow at the rim", rim_radius_m);
            *rim_m = rim_m.max(*floor_m + 1e-3);
            row(ui, "Drink", "Its height above the floor at the start", |ui| {
                NumberField::new(0.5, 0.0, 10_000.0, 1, " mm").scaled_ui(ui, drink_m, 1000.0)
            });
        }
    }
}

/// Draws the things of a list, each with a button that takes it away, and one that adds another.
fn list<T>(
    ui: &mut Ui,
    things: &mut Vec<T>,
    (label, tip): (&str, &str),
    new: impl Fn() -> T,
    rows: impl Fn(&mut Ui, &str, &mut T),
) {
    let mut gone = None;
    for (index, thing) in things.iter_mut().enumerate() {
        let name = format!("{label} {}", index + 1);
        row(ui, &name, tip, |ui| {
            if widgets::small_button(ui, "\u{d7}", &format!("Take {name} away")).clicked() {
                gone = Some(index);
            }
        });
        rows(ui, &name, thing);
    }
    if let Some(index) = gone {
        things.remove(index);
    }
    row(ui, "", "", |ui| {
        let has_room = things.len() < Fluid::MAX_THINGS;
        ui.add_enabled_ui(has_room, |ui| {
            let article = if label.starts_with(['A', 'E', 'I', 'O', 'U']) { "an" } else { "a" };
            if ui.button(format!("Add {article} {}", label.to_lowercase())).on_hover_text(tip).clicked() {
                things.push(new());
            }
        });
    });
}

fn length(ui: &mut Ui, label: &str, tip: &str, value: &mut f32) {
    row(ui, label, tip, |ui| NumberField::new(0.2, 0.1, 10_000.0, 1, " mm").scaled_ui(ui, value, 1000.0));
}

fn seconds(ui: &mut Ui, label: &str, tip: &str, value: &mut f32) {
    row(ui, label, tip, |ui| NumberField::new(0.002, 0.0, 1e4, 3, " s").ui(ui, value));
}

fn place(ui: &mut Ui, name: &str, tip: &str, at_m: &mut Vec3) {
    row(ui, "Place", tip, |ui| widgets::vec3_ui(ui, name, PLACE, at_m));
}

fn velocity(ui: &mut Ui, name: &str, tip: &str, velocity_m_s: &mut Vec3) {
    row(ui, "Velocity", tip, |ui| widgets::vec3_ui(ui, &format!("{name} velocity"), VELOCITY, velocity_m_s));
}
