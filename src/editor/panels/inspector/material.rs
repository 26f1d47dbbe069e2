//! The rows of a material.

use super::fibre::fibre_rows;
use super::surface_layers::layer_rows;
use super::unit_slider::unit_slider;
use crate::editor::ui::widgets::{self, NumberField, row};
use crate::scene::{Alpha, Material, MaterialPreset, Subsurface, TextureRef, TextureSlot};
use eframe::egui::{ComboBox, Ui};

/// Returns the name of the preset that equals a material, or "Custom".
pub fn preset_name(material: &Material) -> &'static str {
    let preset = MaterialPreset::ALL.iter().find(|preset| preset.material() == *material);
    preset.map_or("Custom", |preset| preset.label())
}

/// Draws the list of material presets.
pub fn preset_combo(ui: &mut Ui, salt: &str, material: &mut Material) {
    let current = preset_name(material);
    ComboBox::from_id_salt(salt).selected_text(current).width(ui.available_width() - 8.0).show_ui(ui, |ui| {
        for preset in MaterialPreset::ALL {
            if ui.selectable_label(current == preset.label(), preset.label()).clicked() {
                *material = preset.material();
            }
        }
    });
}

/// Draws the rows of a material; returns true to choose a texture.
pub fn material_rows(ui: &mut Ui, salt: &str, material: &mut Material) -> Option<TextureSlot> {
    let before = material.clone();
    let mut choose = None;
    ui.push_id(salt, |ui| {
        row(ui, "Surface", "A material of the shelf; the rows below fine-tune it", |ui| {
            preset_combo(ui, "preset", material)
        });
        let color_tip = "Base colour; of a metal, its reflection; of something clear, the colour of what passes a pane, \
                         or both faces of a solid piece: white is clear glass";
        row(ui, "Colour", color_tip, |ui| {
            widgets::color_ui(ui, &mut material.base_color);
            let percent = 100.0 * crate::color::luminance(material.base_color.into());
            let (text, tip) = if material.transmission == 1.0 {
                (format!("passes {percent:.0} %"), "How much of the light it lets through, reflections apart")
            } else {
                (format!("reflects {percent:.0} %"), "How much of the light it gives back")
            };
            ui.label(text).on_hover_text(tip);
        });
        choose = texture_rows(ui, material);
        unit_slider(ui, "Roughness", "0 is a mirror or polished, 1 is matte", &mut material.roughness);
        unit_slider(ui, "Metal", "0 is skin, paper, plastic; 1 is metal", &mut material.metallic);
        unit_slider(ui, "Clear", "0 is opaque, 1 is clear glass or water", &mut material.transmission);
        row(ui, "Refraction", "Index of refraction: skin 1.4, glass 1.52, water 1.33", |ui| {
            NumberField::new(0.005, 1.0, 3.0, 3, "").ui(ui, &mut material.ior)
        });
        if material.transmission > 0.0 {
            row(ui, "Absorption", "What the inside takes away in a metre: red, green, blue", |ui| {
                per_channel(
                    ui,
                    "Absorption",
                    NumberField::new(0.1, 0.0, 10_000.0, 1, ""),
                    &mut material.absorption_per_m,
                );
            });
        }
        layer_rows(ui, material);
        if material.transmission == 0.0 {
            subsurface_rows(ui, &mut material.subsurface);
        }
        if material.transmission == 0.0 {
            fibre_rows(ui, &mut material.fibre);
        }
        row(ui, "Glow", "Luminance it gives off by itself, cd/m\u{b2}: red, green, blue", |ui| {
            per_channel(ui, "Glow", NumberField::new(1.0, 0.0, 1e7, 0, ""), &mut material.emission_cd_m2);
        });
    });
    let is_clear = material.transmission == 1.0 && material.metallic == 0.0;
    if *material != before && !is_clear {
        // An albedo of 1 would never absorb light.
        material.base_color = material.base_color.map(|c| c.min(0.99));
    }
    choose
}

/// Draws the rows of all texture slots, and of what depends on them. Returns the slot whose texture is to be chosen.
fn texture_rows(ui: &mut Ui, material: &mut Material) -> Option<TextureSlot> {
    let mut choose = None;
    for slot in TextureSlot::ALL {
        // A map of what does not glow shows nothing
        if slot == TextureSlot::Emission && !material.is_emissive() && material.textures.emission.is_none() {
            continue;
        }
        if texture_row(ui, slot, material.textures.get_mut(slot)) {
            choose = Some(slot);
        }
    }
    if material.textures.normal.is_some() {
        row(
            ui,
            "Relief",
            "How strong the relief of the normal map is; 1 is as drawn, less than 0 turns it inside out",
            |ui| NumberField::new(0.02, -4.0, 4.0, 2, "").ui(ui, &mut material.textures.normal_scale),
        );
        // Under a dome it is smooth
        if material.textures.dome_radius == 0.0 {
            row(ui, "Gloss", "It lies over the relief and does not follow it, as lacquer does", |ui| {
                ui.checkbox(&mut material.textures.smooth_gloss, "Smooth over the relief")
            });
        }
    }
    if material.textures.iter().next().is_some() {
        dome_rows(ui, &mut material.textures.dome_radius);
    }
    if material.transmission == 0.0 {
        alpha_rows(ui, &mut material.alpha);
    }
    choose
}

/// Draws the rows of a clear dome over the textures.
fn dome_rows(ui: &mut Ui, radius: &mut f32) {
    let mut has_dome = *radius > 0.0;
    let tip = "The surface is a clear cap of a sphere, and its textures are seen on the flat base of it, by refraction, as \
               the iris below the cornea";
    row(ui, "Dome", tip, |ui| {
        if ui.checkbox(&mut has_dome, "Over the textures").changed() {
            *radius = if has_dome { 1.5 } else { 0.0 };
        }
    });
    if has_dome {
        row(ui, "Radius", "That of the sphere, in half widths of the picture: 1 is half a ball", |ui| {
            NumberField::new(0.01, 1.0, 1000.0, 2, "").ui(ui, radius)
        });
    }
}

/// Draws the rows of what is not there of a surface.
fn alpha_rows(ui: &mut Ui, alpha: &mut Alpha) {
    const CHOICES: [(&str, Alpha); 3] = [
        ("None", Alpha::Opaque),
        ("Cut out", Alpha::Mask { cutoff: 0.5 }),
        ("See-through", Alpha::Blend { opacity: 1.0 }),
    ];
    let is_same = |a: &Alpha, b: &Alpha| std::mem::discriminant(a) == std::mem::discriminant(b);
    let tip = "What the transparent parts of the texture are: leaves and lace are cut out, veils are see-through. Light \
               passes what is not there";
    row(ui, "Holes", tip, |ui| {
        let current = CHOICES.iter().find(|(_, choice)| is_same(choice, alpha)).map_or("None", |(name, _)| name);
        ComboBox::from_id_salt("alpha").selected_text(current).show_ui(ui, |ui| {
            for (name, choice) in CHOICES {
                if ui.selectable_label(name == current, name).clicked() && name != current {
                    *alpha = choice;
                }
            }
        });
    });
    match alpha {
        Alpha::Opaque => {}
        Alpha::Mask { cutoff } => unit_slider(ui, "Least alpha", "Where the texture has less, there is a hole", cutoff),
        Alpha::Blend { opacity } => {
            unit_slider(ui, "Opacity", "0 lets all light pass, 1 as much as the texture", opacity)
        }
    }
}

/// Draws the row of a texture slot. Returns true if a texture is to be chosen.
fn texture_row(ui: &mut Ui, slot: TextureSlot, texture: &mut Option<TextureRef>) -> bool {
    let (label, tip) = match slot {
        TextureSlot::BaseColor => ("Texture", "A picture that multiplies the colour"),
        TextureSlot::MetallicRoughness => {
            ("Gloss map", "A picture whose green multiplies the roughness and whose blue multiplies the metal")
        }
        TextureSlot::Emission => ("Glow map", "A picture that multiplies the glow"),
        TextureSlot::Normal => ("Normal map", "A picture of fine relief: it tilts the surface for the light"),
    };
    let mut choose = false;
    row(ui, label, tip, |ui| match texture {
        Some(reference) => {
            let path = reference.to_string();
            let name = match reference {
                TextureRef::Builtin(texture) => texture.label(),
                TextureRef::File(_) | TextureRef::Embedded { .. } => path.rsplit('/').next().unwrap_or(&path),
            };
            choose = ui.button(name).on_hover_text(format!("{path}. Click to choose another.")).clicked();
            if ui.button("Remove").on_hover_text("Take the texture away").clicked() {
                *texture = None;
            }
        }
        None => choose = ui.button("Choose\u{2026}").on_hover_text("PNG or JPEG").clicked(),
    });
    choose
}

/// Draws the rows of scattering under the surface.
fn subsurface_rows(ui: &mut Ui, subsurface: &mut Option<Subsurface>) {
    let tip = "Light enters skin, wax or marble and comes out some way off: shadow edges turn soft and warm, ears glow \
               against the light. The colour stays that of a thick piece";
    row(ui, "Inside", tip, |ui| {
        let mut is_soft = subsurface.is_some();
        if ui.checkbox(&mut is_soft, "Soft under the surface").changed() {
            *subsurface = is_soft.then_some(Subsurface::SKIN);
        }
    });
    if let Some(Subsurface { mean_free_path_mm }) = subsurface {
        let tip = "How far light goes inside before it turns, mm: red, green, blue. Skin is about 1.3, 1.0, 0.8; more is \
                   waxier";
        row(ui, "Light path", tip, |ui| {
            per_channel(ui, "Light path", NumberField::new(0.02, 0.01, 1000.0, 2, ""), mean_free_path_mm);
        });
    }
}

fn per_channel(ui: &mut Ui, name: &str, number: NumberField, value: &mut [f32; 3]) {
    ui.spacing_mut().item_spacing.x = 3.0;
    for (channel, letter) in value.iter_mut().zip(["red", "green", "blue"]) {
        ui.name_inputs(format!("{name} {letter}"), |ui| number.ui(ui, channel)).on_hover_text(letter);
    }
}

/// Draws the rows of a wall or part in a collapsible group.
pub fn material_group(ui: &mut Ui, label: &str, material: &mut Material) -> Option<TextureSlot> {
    let mut choose = None;
    widgets::section(ui, label, false, |ui| choose = material_rows(ui, label, material));
    choose
}
