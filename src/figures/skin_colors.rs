//! Colours of the skin by region, as factors of its base colour: blood near the surface of cheeks, nose, ears and
//! knuckles, thin skin round the eyes, and the shade between the roots of hair.
//!
//! Regions are ellipsoids with soft edges on the base mesh. Their strengths are typical, not measured.

use super::body_data::BodyData;
use super::hair::{beard_density, begins_sparse, brow_density, scalp_density};
use super::random::Random;
use crate::scene::{Beard, Figure, HairStyle};
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::sync::LazyLock;

/// Where there is no skin: metres from between the eyes, beyond every region.
pub const NO_SKIN: Vec3 = Vec3::splat(1e3);

/// Factor where blood is near the surface.
const BLOOD: Vec3 = Vec3::new(0.97, 0.76, 0.73);
/// Factor where the skin is thin over veins.
const VEINS: Vec3 = Vec3::new(0.87, 0.82, 0.85);
/// Factor on the lids: thin skin over muscle, with the roots of lashes.
const LIDS: Vec3 = Vec3::new(0.74, 0.6, 0.58);
/// Factor between the roots of dense hair, which shade each other. It makes up for the hairs that a head has more than a
/// figure: between so few a brighter scalp would look bald.
const ROOTS: Vec3 = Vec3::new(0.2, 0.17, 0.15);
/// Factor between the roots of white hair, which pass more light.
const WHITE_ROOTS: Vec3 = Vec3::new(0.72, 0.7, 0.68);
/// Distances over which the factor between the roots fades out at the hairline, of hair that begins dense and of hair that
/// begins sparse, metres.
const ROOTS_BLUR_M: f32 = 0.004;
const SPARSE_ROOTS_BLUR_M: f32 = 0.012;
/// Factor between the roots of beard and brows.
const STUBBLE: Vec3 = Vec3::new(0.62, 0.62, 0.63);

/// How far blotches of blood and of melanin darken the skin, on average.
const BLOOD_SPREAD: Vec3 = Vec3::new(0.012, 0.05, 0.045);
const MELANIN_SPREAD: Vec3 = Vec3::new(0.03, 0.04, 0.05);

/// Cells along a side of the noise, a power of two.
const LATTICE: usize = 32;

/// Returns the mean factor of the blotches, which only darken: factors stay below 1.
pub fn mean_of_blotches() -> Vec3 {
    Vec3::ONE - BLOOD_SPREAD - MELANIN_SPREAD
}

/// A region on both sides of the base mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    /// Middle, metres from between the eyes, on the left.
    middle: Vec3,
    /// Distance along each axis at which the strength has fallen to 1/e.
    radius: Vec3,
    /// Factor at full strength.
    color: Vec3,
    /// Strength in the middle.
    strength: f32,
}

/// Returns a region of a factor and its strength in the middle.
pub(super) const fn region(middle: [f32; 3], radius: [f32; 3], color: Vec3, strength: f32) -> Region {
    Region { middle: Vec3::from_array(middle), radius: Vec3::from_array(radius), color, strength }
}

/// Squared distance, in radii, at which a region has no strength.
const NEGLIGIBLE: f32 = 7.0;

impl Region {
    /// Returns false if the region has no strength at any place between these corners, metres from between the eyes.
    pub(super) fn may_reach(&self, corners: &[Vec3; 4]) -> bool {
        let (mut low, mut high) = (corners[0], corners[0]);
        for corner in corners {
            (low, high) = (low.min(*corner), high.max(*corner));
        }
        let nearest = self.middle.clamp(low, high);
        ((nearest - self.middle) / self.radius).length_squared() < NEGLIGIBLE
    }
}

/// Returns the product of the factors of regions at a place on the left, metres from between the eyes.
pub(super) fn factor_at(on_left: Vec3, regions: &[Region]) -> Vec3 {
    let mut factor = Vec3::ONE;
    for region in regions {
        // Most places are far above or below
        let offset = on_left - region.middle;
        if offset.y.abs() > NEGLIGIBLE.sqrt() * region.radius.y {
            continue;
        }
        let distance = (offset / region.radius).length_squared();
        if distance < NEGLIGIBLE {
            factor *= Vec3::ONE.lerp(region.color, region.strength * (-distance).exp());
        }
    }
    factor
}

/// Regions of the face.
const FACE: [Region; 8] = [
    region([0.044, -0.04, 0.012], [0.02, 0.017, 0.03], BLOOD, 0.55),
    region([0.0, -0.038, 0.042], [0.014, 0.011, 0.016], BLOOD, 0.6),
    region([0.015, -0.042, 0.025], [0.006, 0.007, 0.012], BLOOD, 0.5),
    region([0.0, -0.097, 0.024], [0.016, 0.01, 0.02], BLOOD, 0.25),
    region([0.084, -0.012, -0.086], [0.012, 0.034, 0.03], BLOOD, 0.8),
    region([0.026, -0.014, 0.014], [0.015, 0.006, 0.02], VEINS, 0.6),
    region([0.028, 0.009, 0.014], [0.017, 0.006, 0.02], VEINS, 0.5),
    // The lids and their edges
    region([0.031, -0.001, 0.014], [0.019, 0.0075, 0.016], LIDS, 0.75),
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
    let blotches = Blotches::new(figure.seed);
    let color = |place: &Vec3| {
        if *place == NO_SKIN { Vec3::ONE } else { region_color(*place, figure) * blotches.factor(*place) }
    };
    places.par_iter().map(color).collect()
}

/// Returns the colour of the regions at a place, without blotches.
fn region_color(place: Vec3, figure: &Figure) -> Vec3 {
    let mut color = factor_at(place.with_x(place.x.abs()), regions());
    // Only the head has hair
    if place.y < -0.16 {
        return color;
    }
    let roots = ROOTS.lerp(WHITE_ROOTS, ((figure.body.age_years - 55.0) / 20.0).clamp(0.0, 1.0));
    if figure.hair != HairStyle::Bald {
        let blur_m = if begins_sparse(figure.hair) { SPARSE_ROOTS_BLUR_M } else { ROOTS_BLUR_M };
        color *= Vec3::ONE.lerp(roots, blurred(scalp_density, place, blur_m));
    }
    let beard = match figure.beard {
        Beard::None => 0.0,
        Beard::Stubble => 0.7,
        Beard::Full => 1.0,
    };
    if beard > 0.0 {
        color *= Vec3::ONE.lerp(STUBBLE, beard * blurred(beard_density, place, 0.008));
    }
    color * Vec3::ONE.lerp(STUBBLE, 0.8 * brow_density(place, figure.body.sex))
}

/// The blotches of blood and of melanin in a figure's skin.
struct Blotches {
    /// Where in the noise the blotches of each size lie, cells.
    shifts: [Vec3; 4],
}

impl Blotches {
    /// Returns the blotches of a seed.
    fn new(seed: u32) -> Blotches {
        let shift = |size| {
            let mut random = Random::new(seed, size);
            Vec3::from_array([(); 3].map(|()| random.unit())) * LATTICE as f32
        };
        Blotches { shifts: [0, 1, 2, 3].map(shift) }
    }

    /// Returns the factor of the skin's unevenness at a place: blotches of some millimetres and of a centimetre and a
    /// half across.
    fn factor(&self, place: Vec3) -> Vec3 {
        let [large_blood, small_blood, large_melanin, small_melanin] = self.shifts;
        let blood = 0.6 * noise(place / 0.015 + large_blood) + 0.4 * noise(place / 0.006 + small_blood);
        let melanin = 0.5 * noise(place / 0.011 + large_melanin) + 0.5 * noise(place / 0.0045 + small_melanin);
        (Vec3::ONE - BLOOD_SPREAD * (1.0 + blood) - MELANIN_SPREAD * (1.0 + melanin)).clamp(Vec3::ZERO, Vec3::ONE)
    }
}

/// Returns value noise at a point: random values of -1 to 1 at points of whole coordinates, blended smoothly between. It
/// repeats after [`LATTICE`] cells.
fn noise(point: Vec3) -> f32 {
    static VALUES: LazyLock<Vec<f32>> = LazyLock::new(|| {
        let mut random = Random::new(0, 13);
        (0..LATTICE.pow(3)).map(|_| 2.0 * random.unit() - 1.0).collect()
    });
    let values = &*VALUES;
    // Rounded by one instruction, as Vec3 is not
    let cell = Vec3::from(Vec3A::from(point).floor());
    let t = point - cell;
    let t = t * t * (3.0 - 2.0 * t);
    let [x, y, z] = cell.as_ivec3().to_array().map(|c| [c, c + 1].map(|c| c as usize & (LATTICE - 1)));
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |y: usize, z: usize| {
        let row = &values[(z * LATTICE + y) * LATTICE..][..LATTICE];
        mix(row[x[0]], row[x[1]], t.x)
    };
    let along_y = |z: usize| mix(along_x(y[0], z), along_x(y[1], z), t.y);
    mix(along_y(z[0]), along_y(z[1]), t.z)
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
        let [cheek, forehead, scalp] =
            [Vec3::new(-0.044, -0.04, 0.012), Vec3::new(0.0, 0.04, 0.028), Vec3::new(0.01, 0.12, -0.07)];
        let colors = [cheek, forehead, scalp].map(|place| region_color(place, &figure));
        assert!(colors[0].y < 0.9 && colors[0].x > 0.95, "{}", colors[0]);
        assert!(colors[1].min_element() > 0.97, "{}", colors[1]);
        assert!(colors[2].max_element() < 0.25, "{}", colors[2]);
        assert_eq!(skin_colors(&[NO_SKIN], &figure), [Vec3::ONE]);
        assert!(region_color(scalp, &bald).min_element() > 0.97);
        let shown = skin_colors(&[cheek, forehead, scalp], &figure);
        assert!(shown.iter().all(|color| color.min_element() > 0.0 && color.max_element() <= 1.0));
        // Blotches leave more than four fifths of every colour.
        assert!(shown.iter().zip(&colors).all(|(all, region)| (*all / *region).min_element() > 0.8), "{shown:?}");
    }

    #[test]
    fn knuckles_are_regions_of_both_hands() {
        let data = BodyData::shipped();
        let knuckle = |name: &str| data.positions[usize::from(data.bones[data.bone(name).unwrap()].head)];
        let places = ["finger3-1.L", "finger3-1.R"].map(|name| knuckle(name) - data.eyes_middle());
        let colors = places.map(|place| region_color(place, &READY[0].figure()));
        assert!(colors.iter().all(|color| color.y < 0.9), "{colors:?}");
    }
}
