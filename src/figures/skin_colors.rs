//! Colours of the skin by region, as factors of its base colour: blood near the surface of cheeks, nose, ears and
//! knuckles, thin skin round the eyes, and the shade between the roots of hair.
//!
//! Regions are ellipsoids with soft edges on the base mesh. Their strengths are typical, not measured.

use super::body_data::BodyData;
use super::hair::{beard_density, brow_density, scalp_density};
use crate::scene::{Beard, Figure, HairStyle};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::LazyLock;

/// Where there is no skin: metres from between the eyes, beyond every region.
pub const NO_SKIN: Vec3 = Vec3::splat(1e3);

/// Factor where blood is near the surface.
const BLOOD: Vec3 = Vec3::new(0.97, 0.76, 0.73);
/// Factor where the skin is thin over veins.
const VEINS: Vec3 = Vec3::new(0.87, 0.82, 0.85);
/// Factor between the roots of dense hair, which shade each other.
const ROOTS: Vec3 = Vec3::new(0.36, 0.33, 0.31);
/// Factor between the roots of white hair, which pass more light.
const WHITE_ROOTS: Vec3 = Vec3::new(0.72, 0.7, 0.68);
/// Factor between the roots of beard and brows.
const STUBBLE: Vec3 = Vec3::new(0.62, 0.62, 0.63);

/// A region on both sides of the base mesh.
#[derive(Clone, Copy, Debug)]
struct Region {
    /// Middle, metres from between the eyes, on the left.
    middle: Vec3,
    /// Distance along each axis at which the strength has fallen to 1/e.
    radius: Vec3,
    /// Factor of the base colour at full strength.
    color: Vec3,
    /// Strength in the middle.
    strength: f32,
}

const fn region(middle: [f32; 3], radius: [f32; 3], color: Vec3, strength: f32) -> Region {
    Region { middle: Vec3::from_array(middle), radius: Vec3::from_array(radius), color, strength }
}

/// Regions of the face.
const FACE: [Region; 7] = [
    region([0.044, -0.04, 0.012], [0.02, 0.017, 0.03], BLOOD, 0.55),
    region([0.0, -0.038, 0.042], [0.014, 0.011, 0.016], BLOOD, 0.6),
    region([0.015, -0.042, 0.025], [0.006, 0.007, 0.012], BLOOD, 0.5),
    region([0.0, -0.097, 0.024], [0.016, 0.01, 0.02], BLOOD, 0.25),
    region([0.084, -0.012, -0.086], [0.012, 0.034, 0.03], BLOOD, 0.8),
    region([0.026, -0.014, 0.014], [0.015, 0.006, 0.02], VEINS, 0.6),
    region([0.028, 0.009, 0.014], [0.017, 0.006, 0.02], VEINS, 0.5),
];

/// Returns the regions of face and joints.
fn regions() -> &'static [Region] {
    static REGIONS: LazyLock<Vec<Region>> = LazyLock::new(|| {
        let data = BodyData::shipped();
        let eyes = data.eyes_middle();
        let at_joint = |name: &str, radius: f32, strength: f32| {
            let bone = data.bone(&format!("{name}.L"))?;
            let middle = data.positions[usize::from(data.bones[bone].head)] - eyes;
            Some(Region { middle, radius: Vec3::splat(radius), color: BLOOD, strength })
        };
        let fingers = (2..=5).flat_map(|finger| {
            [(1, 0.014, 0.55), (2, 0.011, 0.55), (3, 0.009, 0.4)]
                .map(|(joint, radius, strength)| at_joint(&format!("finger{finger}-{joint}"), radius, strength))
        });
        let limbs = [at_joint("lowerarm01", 0.04, 0.45), at_joint("lowerleg01", 0.06, 0.35)];
        FACE.into_iter().chain(fingers.chain(limbs).flatten()).collect()
    });
    &REGIONS
}

/// Returns the colour of the skin at places of the base mesh, metres from between the eyes, as factors of its base
/// colour. 1 at [`NO_SKIN`].
pub fn skin_colors(places: &[Vec3], figure: &Figure) -> Vec<Vec3> {
    let regions = regions();
    places.par_iter().map(|place| color_at(*place, regions, figure)).collect()
}

fn color_at(place: Vec3, regions: &[Region], figure: &Figure) -> Vec3 {
    if place == NO_SKIN {
        return Vec3::ONE;
    }
    let on_left = place.with_x(place.x.abs());
    let mut color = Vec3::ONE;
    for region in regions {
        let distance = ((on_left - region.middle) / region.radius).length_squared();
        if distance < 7.0 {
            color *= Vec3::ONE.lerp(region.color, region.strength * (-distance).exp());
        }
    }
    // Only the head has hair
    if place.y < -0.16 {
        return color;
    }
    let roots = ROOTS.lerp(WHITE_ROOTS, ((figure.body.age_years - 55.0) / 20.0).clamp(0.0, 1.0));
    if figure.hair != HairStyle::Bald {
        color *= Vec3::ONE.lerp(roots, blurred(scalp_density, place, 0.004));
    }
    let beard = match figure.beard {
        Beard::None => 0.0,
        Beard::Stubble => 0.7,
        Beard::Full => 1.0,
    };
    if beard > 0.0 {
        color *= Vec3::ONE.lerp(STUBBLE, beard * blurred(beard_density, place, 0.008));
    }
    color * Vec3::ONE.lerp(STUBBLE, 0.8 * brow_density(place))
}

/// Returns the mean density of hair within a distance of a place, metres.
fn blurred(density: fn(Vec3) -> f32, place: Vec3, radius: f32) -> f32 {
    const NEAR: [Vec3; 7] =
        [Vec3::ZERO, Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::splat(0.5), Vec3::splat(-0.5)];
    NEAR.iter().map(|offset| density(place + offset * radius)).sum::<f32>() / NEAR.len() as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::READY;

    #[test]
    fn cheeks_are_redder_than_the_forehead_and_a_scalp_under_hair_is_dark() {
        let figure = READY[0].figure();
        let bald = Figure { hair: HairStyle::Bald, ..figure };
        let [cheek, forehead, scalp, nothing] =
            [Vec3::new(-0.044, -0.04, 0.012), Vec3::new(0.0, 0.04, 0.028), Vec3::new(0.01, 0.12, -0.07), NO_SKIN];
        let colors = skin_colors(&[cheek, forehead, scalp, nothing], &figure);
        assert!(colors[0].y < 0.9 && colors[0].x > 0.95, "{}", colors[0]);
        assert!(colors[1].min_element() > 0.97, "{}", colors[1]);
        assert!(colors[2].max_element() < 0.4, "{}", colors[2]);
        assert_eq!(colors[3], Vec3::ONE);
        assert!(skin_colors(&[scalp], &bald)[0].min_element() > 0.97);
        assert!(colors.iter().all(|color| color.min_element() > 0.0 && color.max_element() <= 1.0));
    }

    #[test]
    fn knuckles_are_regions_of_both_hands() {
        let data = BodyData::shipped();
        let knuckle = |name: &str| data.positions[usize::from(data.bones[data.bone(name).unwrap()].head)];
        let places = ["finger3-1.L", "finger3-1.R"].map(|name| knuckle(name) - data.eyes_middle());
        let colors = skin_colors(&places, &READY[0].figure());
        assert!(colors.iter().all(|color| color.y < 0.9), "{colors:?}");
    }
}
