//! The inspector of a figure, prop or backdrop.

use super::figure::{face_rows, figure_ui, framing_rows};
use super::material::{material_group, material_rows, preset_name};
use super::tank::tank_ui;
use super::{InspectorContext, text_ui, title};
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::document::placement::{stool_under, wrap_deg};
use crate::editor::ui::widgets::{self, DEGREES, METRES, NumberField, SIZE_CM, row, section};
use crate::io::MODEL_UNITS;
use crate::scene::{Assets, Object, ObjectId, Shape, TextureSlot, Transform};
use eframe::egui::{Button, RichText, Ui};
use glam::Vec3;

/// Draws the inspector of an object.
pub(super) fn object_ui(ui: &mut Ui, context: &mut InspectorContext<'_>, id: ObjectId) {
    let (scene, assets) = (context.document.scene(), context.document.assets());
    let Some(original) = scene.object(id) else { return };
    let mut object = original.clone();
    title(ui, &original.name, object.shape.label());
    let mut new_name = None;
    row(ui, "Name", "Names are unique in a studio", |ui| new_name = text_ui(ui, "name", &original.name, false));
    row(ui, "Show", "Hidden things are neither seen nor do they cast shadows", |ui| {
        widgets::choice(
            ui,
            &mut object.visible,
            &[(true, "Visible", "It is there"), (false, "Hidden", "As if it were not there")],
        );
    });
    ui.separator();
    match &mut object.shape {
        Shape::Tank(tank) => tank_ui(ui, id, tank, context.tank_tools, context.out),
        Shape::Figure(_) => {
            if original.visible {
                face_rows(ui, context.patterns.face(id));
            }
            framing_rows(ui, id, context.out);
            if figure_ui(ui, scene, &mut object)
                && let Some(stool) = stool_under(&object, assets)
            {
                context.out.push(Command::Apply(Action::AddObject(Box::new(stool))));
            }
        }
        _ => section(ui, "Shape and size", true, |ui| shape_rows(ui, assets, &mut object)),
    }
    section(ui, "Place", true, |ui| {
        row(ui, "Lock", "Locked it cannot be moved, and clicks in the view go past it (K)", |ui| {
            let mut locked = object.locked;
            ui.checkbox(&mut locked, "In its place");
            if locked != object.locked {
                context.out.push(Command::Apply(Action::Lock(vec![Item::Object(id)], locked)));
            }
        });
        ui.add_enabled_ui(!object.locked, |ui| place_rows(ui, &mut object));
    });
    section(ui, "Surface", true, |ui| {
        if let Some(slot) = material_rows(ui, "own", &mut object.material) {
            context.out.push(Command::ChooseTexture(Item::Object(id), None, slot));
        }
    });
    if let Some((part, slot)) = part_rows(ui, assets, &mut object) {
        context.out.push(Command::ChooseTexture(Item::Object(id), Some(part), slot));
    }
    if object != *original {
        context.out.push(Command::Apply(Action::SetObject(Box::new(object))));
    }
    // After the other changes, which have the old name: a click on their controls ends the typing
    context.out.extend(new_name.map(|name| Command::Apply(Action::Rename(Item::Object(id), name))));
}

fn shape_rows(ui: &mut Ui, assets: &Assets, object: &mut Object) {
    match &mut object.shape {
        // Figures and tanks have sections of their own.
        Shape::Figure(_) | Shape::Tank(_) => {}
        Shape::Prop(model) => {
            row(ui, "Prop", "A thing of a fixed form; its scale changes its size", |ui| ui.label(model.label()));
        }
        Shape::MeshFile { path } => {
            row(ui, "File", "The model, relative to the studio's file", |ui| ui.label(path.as_str()));
        }
        Shape::Plane { width_m, depth_m } => {
            centimetres(ui, &mut [("Width", width_m, 100.0), ("Length", depth_m, 100.0)])
        }
        Shape::Box { size_m } => {
            let Vec3 { x, y, z } = size_m;
            centimetres(ui, &mut [("Width", x, 100.0), ("Height", y, 100.0), ("Depth", z, 100.0)]);
        }
        Shape::Sphere { radius_m } => centimetres(ui, &mut [("Diameter", radius_m, 200.0)]),
        Shape::Cylinder { radius_m, height_m } => {
            centimetres(ui, &mut [("Diameter", radius_m, 200.0), ("Height", height_m, 100.0)]);
        }
        Shape::Sweep { width_m, height_m, depth_m, radius_m } => {
            row(ui, "Roll", "Widths that paper comes in", |ui| {
                let rolls = [(1.35, "1.35 m", "Narrow"), (2.72, "2.72 m", "Usual"), (3.55, "3.55 m", "Wide")];
                widgets::choice(ui, width_m, &rolls);
            });
            let sizes = &mut [
                ("Width", width_m, 100.0),
                ("Hung at", height_m, 100.0),
                ("On the floor", depth_m, 100.0),
                ("Curve", radius_m, 100.0),
            ];
            centimetres(ui, sizes);
        }
        Shape::VFlat { wing_m, height_m, angle_deg } => {
            centimetres(ui, &mut [("Each board", wing_m, 100.0), ("Height", height_m, 100.0)]);
            row(ui, "Opened", "Angle between the boards: 180\u{b0} is one flat board", |ui| {
                NumberField::new(1.0, 5.0, 180.0, 0, "\u{b0}").ui(ui, angle_deg)
            });
        }
    }
    scale_rows(ui, assets, object);
}

fn centimetres(ui: &mut Ui, sizes: &mut [(&str, &mut f32, f32)]) {
    for (label, value, factor) in sizes {
        row(ui, label, "Size of the thing itself, before its scale", |ui| SIZE_CM.scaled_ui(ui, value, *factor));
    }
}

/// Draws the scale: of figures as a height, of other objects as a percentage.
fn scale_rows(ui: &mut Ui, assets: &Assets, object: &mut Object) {
    let scale = &mut object.transform.scale;
    let is_uniform = scale.x == scale.y && scale.y == scale.z;
    let height_m = match &object.shape {
        Shape::Figure(_) => assets.mesh_of(&object.shape).map(|mesh| mesh.bounds().1.y).filter(|h| *h > 0.0),
        _ => None,
    };
    let model_bounds = match &object.shape {
        Shape::MeshFile { .. } => assets.mesh_of(&object.shape).map(|mesh| mesh.bounds()),
        _ => None,
    };
    let before = scale.y;
    let mut factor = before;
    match height_m {
        Some(height_m) => row(ui, "Height", "From the floor to the top of the head", |ui| {
            NumberField::new(0.5, 5.0, 400.0, 1, " cm").scaled_ui(ui, &mut factor, 100.0 * height_m)
        }),
        None => row(ui, "Scale", "Of the whole thing", |ui| {
            NumberField::new(0.5, 0.1, 100_000.0, 1, " %").scaled_ui(ui, &mut factor, 100.0)
        }),
    };
    if factor != before && before != 0.0 {
        *scale *= factor / before;
    }
    if let Some((low, high)) = model_bounds.filter(|(low, high)| high.y > low.y) {
        model_rows(ui, low.y, high.y, &mut object.transform);
    }
    let scale = &mut object.transform.scale;
    if !is_uniform {
        row(ui, "Each axis", "Scale along its own axes", |ui| {
            widgets::vec3_ui(ui, "Scale", NumberField::new(0.005, 0.001, 1000.0, 3, ""), scale);
        });
        row(ui, "", "", |ui| {
            if ui.button("Same on all axes").on_hover_text("Undo the stretching").clicked() {
                *scale = Vec3::splat(scale.y);
            }
        });
    }
}

/// Draws the unit of a model's file and its height, by which it is scaled on the spot. `low` and `high` are its ends in its
/// own unit.
fn model_rows(ui: &mut Ui, low: f32, high: f32, transform: &mut Transform) {
    let mut scale = transform.scale.y;
    row(ui, "Unit", "Of the lengths in the model's file", |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (unit, metres) in MODEL_UNITS {
            let is_it = (scale / metres - 1.0).abs() < 1e-4;
            let tip = format!("Then it is {:.1} cm high", 100.0 * metres * (high - low));
            if ui.selectable_label(is_it, unit).on_hover_text(tip).clicked() {
                scale = metres;
            }
        }
    });
    row(ui, "Height", "The model is scaled to it, evenly", |ui| {
        NumberField::new(0.2, 0.1, 10_000.0, 1, " cm").scaled_ui(ui, &mut scale, 100.0 * (high - low))
    });
    let before = transform.scale.y;
    if scale != before && before != 0.0 {
        // What stands on the floor, or on a table, stays on it
        transform.position.y += low * (before - scale);
        transform.scale *= scale / before;
    }
}

fn place_rows(ui: &mut Ui, object: &mut Object) {
    let transform = &mut object.transform;
    row(ui, "Position", "Of its origin, in the room", |ui| {
        widgets::vec3_ui(ui, "Position", METRES, &mut transform.position)
    });
    row(ui, "Turn", "About the vertical axis", |ui| {
        DEGREES.ui(ui, &mut transform.rotation_deg.y);
        ui.spacing_mut().item_spacing.x = 2.0;
        for (text, by) in [("\u{2212}15\u{b0}", -15.0), ("+15\u{b0}", 15.0)] {
            if ui.add(Button::new(text)).on_hover_text("Turn by 15 degrees").clicked() {
                transform.rotation_deg.y = wrap_deg(transform.rotation_deg.y + by);
            }
        }
    });
    row(ui, "Tilt", "Forwards and backwards", |ui| DEGREES.ui(ui, &mut transform.rotation_deg.x));
    row(ui, "Roll", "Sideways", |ui| DEGREES.ui(ui, &mut transform.rotation_deg.z));
}

/// Draws the materials of named parts; returns the part to choose a texture for.
fn part_rows(ui: &mut Ui, assets: &Assets, object: &mut Object) -> Option<(String, TextureSlot)> {
    let mesh = assets.mesh_of(&object.shape)?;
    if mesh.part_names().count() < 2 {
        return None;
    }
    let mut choose = None;
    for part in mesh.part_names() {
        let own = object.part_materials.iter().position(|(name, _)| name == part);
        let Some(own) = own else {
            row(ui, part, "A part of the model that has the surface of the whole", |ui| {
                if ui.button("Own surface").on_hover_text("Give this part a surface of its own").clicked() {
                    object.part_materials.push((part.to_owned(), object.material.clone()));
                }
            });
            continue;
        };
        let label = format!("Surface of {part}");
        if let Some(slot) = material_group(ui, &label, &mut object.part_materials[own].1) {
            choose = Some((part.to_owned(), slot));
        }
        ui.horizontal(|ui| {
            ui.label(RichText::new(preset_name(&object.part_materials[own].1)).weak());
            if ui.small_button("Same as the whole").on_hover_text("Take this part's own surface away").clicked() {
                object.part_materials.remove(own);
            }
        });
    }
    choose
}
