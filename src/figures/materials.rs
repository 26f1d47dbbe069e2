//! The materials of a figure's parts, and skin tones.

use super::iris::CORNEA;
use super::skin_colors::mean_of_blotches;
use super::skin_textures::skin_textures;
use crate::scene::{BuiltinTexture, Figure, Material, MaterialPreset, MaterialTextures, Object, Shape, TextureRef};
use glam::Vec3;

/// A skin tone: a class of the individual typology angle ITA = atan((L* - 50) / b*) (Chardon et al. 1991, "Skin colour
/// typology and suntanning pathways"), with the reflectance of its middle. Redness a* is a typical value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinTone {
    /// Name of the class.
    pub label: &'static str,
    /// CIE 1976 L*, a*, b* (D65).
    lab: [f32; 3],
}

/// Skin tones from light to dark. The angles are 60, 48, 34, 19, -10 and -45 degrees.
pub const SKIN_TONES: [SkinTone; 6] = [
    SkinTone { label: "Very light", lab: [70.0, 9.0, 11.5] },
    SkinTone { label: "Light", lab: [66.5, 10.5, 15.0] },
    SkinTone { label: "Intermediate", lab: [62.0, 11.5, 17.5] },
    SkinTone { label: "Tan", lab: [56.5, 12.5, 19.0] },
    SkinTone { label: "Brown", lab: [47.0, 12.5, 17.0] },
    SkinTone { label: "Dark", lab: [37.0, 10.0, 13.0] },
];

impl SkinTone {
    /// Returns skin of this tone for a figure: with its blotches, it has the tone's reflectance on average. Skin with more
    /// melanin lets light less far in.
    pub fn material(&self) -> Material {
        let [lightness, ..] = self.lab;
        let preset = match lightness {
            l if l > 60.0 => MaterialPreset::SkinLight,
            l if l > 50.0 => MaterialPreset::SkinMedium,
            _ => MaterialPreset::SkinDark,
        };
        let base_color = (Vec3::from(self.base_color()) / mean_of_blotches()).min(Vec3::ONE).to_array();
        Material { base_color, textures: skin_textures(), ..preset.material() }
    }

    /// Returns the reflectance, scene-linear Rec.709.
    pub fn base_color(&self) -> [f32; 3] {
        let [l, a, b] = self.lab;
        let fy = (l + 16.0) / 116.0;
        let inverse =
            |f: f32| if f > 6.0 / 29.0 { f * f * f } else { 3.0 * (6.0_f32 / 29.0).powi(2) * (f - 4.0 / 29.0) };
        // D65 white
        let [x, y, z] = [0.950_47 * inverse(fy + a / 500.0), inverse(fy), 1.088_83 * inverse(fy - b / 200.0)];
        [
            3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
            -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
            0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
        ]
        .map(|c| c.clamp(0.0, 0.95))
    }
}

/// A colour of eyes. The values are typical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeColor {
    /// Its name.
    pub label: &'static str,
    /// Reflectance of the iris at its light fibres, scene-linear Rec.709.
    pub base_color: [f32; 3],
}

/// Colours of eyes from dark to light.
pub const EYE_COLORS: [EyeColor; 6] = [
    EyeColor { label: "Dark brown", base_color: [0.07, 0.035, 0.018] },
    EyeColor { label: "Brown", base_color: [0.14, 0.07, 0.03] },
    EyeColor { label: "Hazel", base_color: [0.13, 0.095, 0.05] },
    EyeColor { label: "Green", base_color: [0.13, 0.15, 0.075] },
    EyeColor { label: "Blue", base_color: [0.12, 0.19, 0.27] },
    EyeColor { label: "Grey", base_color: [0.2, 0.22, 0.23] },
];

impl EyeColor {
    /// Returns the material of the iris.
    pub fn material(&self) -> Material {
        Material { base_color: self.base_color, textures: iris_textures(), ..MaterialPreset::Eye.material() }
    }
}

/// Returns the textures of the iris, under the cornea.
pub fn iris_textures() -> MaterialTextures {
    MaterialTextures {
        base_color: Some(TextureRef::Builtin(BuiltinTexture::Iris)),
        normal: Some(TextureRef::Builtin(BuiltinTexture::IrisRelief)),
        dome_radius: CORNEA.radius,
        ..MaterialTextures::default()
    }
}

/// Natural colours of hair.
pub const HAIR_COLORS: [MaterialPreset; 7] = [
    MaterialPreset::HairBlack,
    MaterialPreset::HairDarkBrown,
    MaterialPreset::HairBrown,
    MaterialPreset::HairRed,
    MaterialPreset::HairBlond,
    MaterialPreset::HairGrey,
    MaterialPreset::HairWhite,
];

/// A colour of cloth. The values are typical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClothColor {
    /// Its name.
    pub label: &'static str,
    /// Reflectance, scene-linear Rec.709.
    pub base_color: [f32; 3],
}

/// Colours of clothes and shoes.
pub const CLOTH_COLORS: [ClothColor; 6] = [
    ClothColor { label: "White", base_color: [0.75, 0.75, 0.73] },
    ClothColor { label: "Sand", base_color: [0.5, 0.42, 0.31] },
    ClothColor { label: "Grey blue", base_color: [0.16, 0.2, 0.26] },
    ClothColor { label: "Red", base_color: [0.35, 0.035, 0.03] },
    ClothColor { label: "Navy", base_color: [0.035, 0.045, 0.07] },
    ClothColor { label: "Black", base_color: [0.02, 0.02, 0.02] },
];

/// Colour of lips as a factor of the skin's: less melanin, and more blood near the surface. Typical, not measured.
pub(super) const LIP_TINT: [f32; 3] = [0.86, 0.56, 0.6];

/// Returns the materials of the parts that are not skin. A dark `skin`, the object's own material, gets darker eyes.
pub fn default_parts(skin: &Material, figure: &Figure) -> Vec<(String, Material)> {
    let gloss = |base_color| Material { base_color, ..MaterialPreset::Eye.material() };
    let cloth = |base_color| Material { base_color, ..MaterialPreset::MatteFabric.material() };
    let [r, g, b] = skin.base_color;
    let light = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let [dark_brown, _, hazel, ..] = EYE_COLORS;
    let iris = if light > 0.3 { hazel } else { dark_brown };
    // Eyes of old people are less white.
    let age = ((figure.body.age_years - 40.0) / 50.0).clamp(0.0, 1.0);
    let white = MaterialPreset::Eye.material();
    let white = Material { base_color: white.base_color.map(|c| c * (1.0 - 0.12 * age)), ..white };
    // Lips are moist: a typical roughness.
    let [red, green, blue] = LIP_TINT;
    let lips = Material { base_color: [red * r, green * g, blue * b], roughness: 0.42, ..skin.clone() };
    let parts = [
        ("eyes", white),
        ("iris", iris.material()),
        ("teeth", Material { base_color: [0.62, 0.58, 0.49], roughness: 0.25, ..gloss([0.0; 3]) }),
        ("tongue", Material { base_color: [0.35, 0.12, 0.1], roughness: 0.3, ..gloss([0.0; 3]) }),
        ("top", cloth([0.16, 0.2, 0.26])),
        ("bottom", cloth([0.035, 0.045, 0.07])),
        ("lips", lips),
        ("nails", Material { roughness: 0.3, textures: MaterialTextures::default(), ..skin.clone() }),
        ("mouth", Material { base_color: [0.25, 0.07, 0.06], roughness: 0.3, ..gloss([0.0; 3]) }),
        ("hair", MaterialPreset::HairDarkBrown.material()),
        ("beard", MaterialPreset::HairDarkBrown.material()),
        ("brows", MaterialPreset::HairDarkBrown.material()),
        ("lashes", MaterialPreset::HairBlack.material()),
        ("shoes", Material { base_color: [0.03, 0.025, 0.02], roughness: 0.4, ..Material::default() }),
    ];
    parts.into_iter().map(|(part, material)| (part.to_owned(), material)).collect()
}

/// Parts that have the colour of the hair.
pub(super) const PARTS_OF_HAIR: [&str; 3] = ["hair", "beard", "brows"];

/// Gives a figure eyes of a colour.
pub fn give_eyes(object: &mut Object, color: &EyeColor) {
    give_parts(object, &["iris"], &color.material());
}

/// Gives a figure hair, a beard and brows of one colour.
pub fn give_hair(object: &mut Object, color: MaterialPreset) {
    give_parts(object, &PARTS_OF_HAIR, &color.material());
}

/// Gives a garment or the shoes of a figure a colour; the cloth stays as it is.
pub fn give_cloth_color(object: &mut Object, garment: &str, base_color: [f32; 3]) {
    let material = match object.part_materials.iter().find(|(part, _)| part == garment) {
        Some((_, own)) => own.clone(),
        None => MaterialPreset::MatteFabric.material(),
    };
    give_parts(object, &[garment], &Material { base_color, ..material });
}

fn give_parts(object: &mut Object, names: &[&str], material: &Material) {
    for name in names {
        match object.part_materials.iter_mut().find(|(part, _)| part == name) {
            Some((_, own)) => *own = material.clone(),
            None => object.part_materials.push(((*name).to_owned(), material.clone())),
        }
    }
}

/// Parts whose materials follow from the skin's.
const PARTS_OF_SKIN: [&str; 2] = ["lips", "nails"];

/// Gives a figure skin of a tone, with lips and nails that suit it.
pub fn give_skin(object: &mut Object, tone: &SkinTone) {
    object.material = tone.material();
    let Shape::Figure(figure) = &object.shape else { return };
    for (part, material) in default_parts(&object.material, figure) {
        if PARTS_OF_SKIN.contains(&part.as_str()) {
            object
                .part_materials
                .iter_mut()
                .filter(|(known, _)| *known == part)
                .for_each(|own| own.1 = material.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::skin_colors::skin_colors;
    use crate::scene::HairStyle;

    #[test]
    fn lips_and_nails_follow_the_tone_of_the_skin() {
        let figure = Figure::default();
        let [light, dark] = [SKIN_TONES[0], SKIN_TONES[5]];
        let shape = Shape::Figure(Box::new(figure));
        let parts = default_parts(&light.material(), &figure);
        let object = Object::new("Woman", shape);
        let mut object = Object { material: light.material(), part_materials: parts.clone(), ..object };
        give_skin(&mut object, &dark);
        assert_eq!(object.material, dark.material());
        for ((part, before), (_, after)) in parts.iter().zip(&object.part_materials) {
            assert_eq!(before != after, PARTS_OF_SKIN.contains(&part.as_str()), "{part}");
            assert!(before == after || after.base_color[0] < before.base_color[0]);
        }
    }

    #[test]
    fn eyes_and_hair_take_a_colour_and_nothing_else_changes() {
        let shape = Shape::Figure(Box::default());
        let parts = default_parts(&SKIN_TONES[1].material(), &Figure::default());
        let before = Object { part_materials: parts, ..Object::new("Woman", shape) };
        let mut object = before.clone();
        // A file need not name every part
        object.part_materials.retain(|(part, _)| part != "beard");
        give_eyes(&mut object, &EYE_COLORS[4]);
        give_hair(&mut object, MaterialPreset::HairRed);
        for (part, material) in &before.part_materials {
            let expected = match part.as_str() {
                "iris" => EYE_COLORS[4].material(),
                "hair" | "beard" | "brows" => MaterialPreset::HairRed.material(),
                _ => material.clone(),
            };
            assert_eq!(*object.material_of(part), expected, "{part}");
        }
        assert_eq!(object.part_materials.len(), before.part_materials.len());
    }

    #[test]
    fn skin_with_blotches_has_the_reflectance_of_its_tone_on_average() {
        let figure = Figure { hair: HairStyle::Bald, ..Figure::default() };
        // Places on the back, where no region has a colour of its own
        let place = |i: usize| Vec3::new((i % 40) as f32 * 0.004 - 0.08, -0.4 - (i / 40) as f32 * 0.005, -0.2);
        let factors = skin_colors(&(0..2000).map(place).collect::<Vec<_>>(), &figure);
        let mean = factors.iter().sum::<Vec3>() / factors.len() as f32;
        for tone in SKIN_TONES {
            let shown = Vec3::from(tone.material().base_color) * mean;
            let error = shown / Vec3::from(tone.base_color()) - Vec3::ONE;
            assert!(error.abs().max_element() < 0.01, "{}: {error}", tone.label);
        }
    }

    #[test]
    fn skin_tones_darken_in_order_and_have_the_luminance_of_their_lightness() {
        let luminance = |tone: &SkinTone| {
            let [r, g, b] = tone.base_color();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!(SKIN_TONES.windows(2).all(|pair| luminance(&pair[0]) > luminance(&pair[1])));
        // L* 50 is a luminance factor of 0.184; L* 70 of 0.407 (CIE 15).
        assert!((luminance(&SKIN_TONES[0]) - 0.407).abs() < 0.002);
        for tone in SKIN_TONES {
            let [r, g, b] = tone.base_color();
            assert!(r > g && g > b && b > 0.0, "{}", tone.label);
        }
    }
}
