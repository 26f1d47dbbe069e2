//! Hair styles as numbers.

use super::head_surface::is_ear;
use crate::math::atan2;
use crate::scene::{Beard, HairStyle};
use glam::Vec3;

/// Height of the hairline over the eyes, metres, by the angle from the front, degrees, which turns about the middle of the
/// head.
const HAIRLINE: [(f32, f32); 8] = [
    (0.0, 0.072),
    (25.0, 0.069),
    (45.0, 0.055),
    (62.0, 0.028),
    (80.0, 0.012),
    (98.0, 0.018),
    (125.0, -0.045),
    (180.0, -0.075),
];

/// Half the width of the strip along a parting where roots are denser, metres, and how many times.
const PARTING_M: f32 = 0.008;
const PARTING_DENSITY: f32 = 5.0;
/// Height over the hairline up to which roots of tied hair are denser, metres, and how many times; and up to which they
/// fade out.
const EDGE_M: f32 = 0.015;
const EDGE_DENSITY: f32 = 3.0;
const SOFT_EDGE_M: f32 = 0.02;
/// Least length of hair at the sides that hangs over the ears, metres.
const LEAST_OVER_EARS_M: f32 = 0.05;

/// How the hair of the head is combed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Comb {
    /// Away from the whorl at the back of the crown: forwards on top, down at the sides.
    FromWhorl,
    /// Away from a parting, at this distance to the left of the middle, and down.
    FromParting(f32),
    /// To a tie behind the head.
    ToTie,
    /// Straight out of the skin.
    Out,
}

/// A style of hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Number of strands.
    pub strands: usize,
    /// Radius of a strand at its root, metres.
    pub radius_m: f32,
    /// Lengths on top of the head and at the sides, metres; of a beard at the chin and at the sideburns.
    pub length_m: [f32; 2],
    /// Level at which falling hair is cut, metres under the eyes; infinite where it ends by its length.
    pub cut_m: f32,
    /// Direction of the comb.
    pub comb: Comb,
    /// Part of the normal in the first direction: 0 lies flat, 1 stands up.
    pub lift: f32,
    /// Pull of the comb on hair that lies on the head.
    pub grip: f32,
    /// Pull of gravity: 0 none, 1 falls at once.
    pub weight: f32,
    /// Distance at which the hair stays from the skull, metres.
    pub volume_m: f32,
    /// Radius of curls, metres.
    pub curl_m: f32,
    /// Turns of a curl in a metre.
    pub turns_per_m: f32,
    /// Turns by which the curls of neighbouring guides differ, 0 to 1: where it is small, curls are waves.
    pub phase_scatter: f32,
    /// Part of the length by which the shortest strands are shorter.
    pub layering: f32,
    /// How much strands gather round their guide towards the tips, 0 to 1.
    pub clumping: f32,
    /// Spread of directions, radians.
    pub frizz: f32,
}

impl Style {
    /// Returns true if the hair is too short at the sides to hang over the ears.
    pub fn is_short(&self) -> bool {
        self.length_m[1] < LEAST_OVER_EARS_M
    }

    /// Returns the density of roots at a place of the base mesh's head, at most 1. Hair that is combed aside covers
    /// the skin beside a parting with the few strands that grow between both: more of them grow there, or a finger's
    /// breadth of skin would show. So do more behind the edge of tied hair, which is combed away from it all round and
    /// begins sparse.
    pub fn root_density(&self, place: Vec3) -> f32 {
        let density = scalp_density(place).max(if self.is_short() { sideburn_density(place) } else { 0.0 });
        match self.comb {
            Comb::FromParting(_) => {
                let crowding = 1.0 + self.nearness_to_parting(place.x) * (PARTING_DENSITY - 1.0);
                density * crowding / PARTING_DENSITY
            }
            Comb::ToTie if density > 0.0 => {
                let over_m = over_hairline(place);
                let fading = (over_m / SOFT_EDGE_M).min(1.0);
                let crowding = 1.0 + (-(over_m / EDGE_M).powi(2)).exp() * (EDGE_DENSITY - 1.0);
                fading * fading * crowding / EDGE_DENSITY
            }
            Comb::ToTie | Comb::FromWhorl | Comb::Out => density,
        }
    }

    /// Returns 1 on the parting, falling to 0 within centimetres at both sides; 0 without one.
    pub fn nearness_to_parting(&self, x: f32) -> f32 {
        let Comb::FromParting(left) = self.comb else { return 0.0 };
        (-((x - left) / PARTING_M).powi(2)).exp()
    }

    /// Returns the side to which hair at a distance to the left of the middle is combed, metres: 1 for the left, -1 for
    /// the right of the parting; 1 without a parting.
    pub fn side_of_parting(&self, x: f32) -> f32 {
        match self.comb {
            Comb::FromParting(left) if x < left => -1.0,
            _ => 1.0,
        }
    }
}

const SHORT: Style = Style {
    strands: 30_000,
    radius_m: 65e-6,
    length_m: [0.045, 0.01],
    cut_m: f32::INFINITY,
    comb: Comb::FromParting(0.03),
    lift: 0.45,
    grip: 0.35,
    weight: 0.15,
    volume_m: 0.01,
    curl_m: 0.0,
    turns_per_m: 0.0,
    phase_scatter: 1.0,
    layering: 0.0,
    clumping: 0.4,
    frizz: 0.16,
};

/// The hairs of a brow.
pub const BROW: Style = Style { radius_m: 45e-6, lift: 0.35, weight: 0.0, frizz: 0.12, ..SHORT };

/// Returns the style of a head; none for a bald one.
pub fn of_head(hair: HairStyle) -> Option<Style> {
    Some(match hair {
        HairStyle::Bald => return None,
        HairStyle::Crop => Style {
            strands: 36_000,
            radius_m: 50e-6,
            length_m: [0.007, 0.004],
            comb: Comb::FromWhorl,
            lift: 0.8,
            grip: 0.22,
            weight: 0.0,
            clumping: 0.0,
            frizz: 0.3,
            volume_m: 0.0,
            ..SHORT
        },
        HairStyle::Short => SHORT,
        HairStyle::Bob => Style {
            strands: 38_000,
            radius_m: 75e-6,
            length_m: [0.28, 0.19],
            cut_m: 0.135,
            comb: Comb::FromParting(0.025),
            lift: 0.15,
            grip: 0.5,
            weight: 0.7,
            volume_m: 0.013,
            clumping: 0.4,
            frizz: 0.09,
            ..SHORT
        },
        HairStyle::Long => Style {
            strands: 38_000,
            radius_m: 80e-6,
            length_m: [0.4, 0.36],
            comb: Comb::FromParting(0.02),
            lift: 0.12,
            grip: 0.5,
            weight: 0.45,
            volume_m: 0.011,
            curl_m: 0.01,
            turns_per_m: 5.0,
            phase_scatter: 0.25,
            layering: 0.3,
            clumping: 0.65,
            frizz: 0.09,
            ..SHORT
        },
        HairStyle::TiedBack => Style {
            strands: 32_000,
            radius_m: 70e-6,
            length_m: [0.4, 0.34],
            comb: Comb::ToTie,
            lift: 0.12,
            grip: 0.22,
            weight: 0.3,
            volume_m: 0.004,
            clumping: 0.5,
            frizz: 0.04,
            ..SHORT
        },
        HairStyle::Curly => Style {
            strands: 30_000,
            radius_m: 75e-6,
            length_m: [0.13, 0.11],
            comb: Comb::Out,
            lift: 0.7,
            grip: 0.22,
            weight: 0.3,
            volume_m: 0.014,
            curl_m: 0.009,
            turns_per_m: 38.0,
            clumping: 0.75,
            frizz: 0.3,
            ..SHORT
        },
    })
}

/// Returns true for a style whose roots become dense within centimetres behind the hairline, and not within millimetres.
pub fn begins_sparse(hair: HairStyle) -> bool {
    of_head(hair).is_some_and(|style| style.comb == Comb::ToTie)
}

/// Returns the style of a beard; none for a shaved face.
pub fn of_beard(beard: Beard) -> Option<Style> {
    Some(match beard {
        Beard::None => return None,
        Beard::Stubble => Style {
            strands: 9_000,
            radius_m: 45e-6,
            length_m: [0.0022, 0.0022],
            lift: 0.7,
            weight: 0.2,
            frizz: 0.35,
            ..SHORT
        },
        Beard::Full => Style {
            strands: 16_000,
            radius_m: 60e-6,
            length_m: [0.03, 0.005],
            lift: 0.35,
            weight: 0.25,
            frizz: 0.28,
            ..SHORT
        },
    })
}

/// Returns how much hair grows at a place of the scalp (from between the eyes, metres on the base mesh): 1 inside of the
/// hairline, fading out within some millimetres.
pub fn scalp_density(place: Vec3) -> f32 {
    const SOFT_M: f32 = 0.006;
    // Most places are far above or below
    if place.y < HAIRLINE[HAIRLINE.len() - 1].1 || is_ear(place) {
        return 0.0;
    }
    if place.y > HAIRLINE[0].1 + SOFT_M {
        return 1.0;
    }
    (over_hairline(place) / SOFT_M).clamp(0.0, 1.0)
}

/// Returns the height of a place of the head over the hairline there, metres.
fn over_hairline(place: Vec3) -> f32 {
    let angle = angle_from_front(place);
    let upper = HAIRLINE.iter().position(|(at, _)| *at >= angle).unwrap_or(HAIRLINE.len() - 1).max(1);
    let ((a0, h0), (a1, h1)) = (HAIRLINE[upper - 1], HAIRLINE[upper]);
    place.y - h0 - (h1 - h0) * ((angle - a0) / (a1 - a0)).clamp(0.0, 1.0)
}

/// Returns how much hair grows before the ears, where short hair has sideburns; see [`scalp_density`].
pub fn sideburn_density(place: Vec3) -> f32 {
    // Angles from the front and heights over the eyes between which they grow
    const ANGLES: [f32; 2] = [62.0, 84.0];
    const HEIGHTS_M: [f32; 2] = [-0.02, 0.03];
    let angle = angle_from_front(place);
    let is_there = !is_ear(place) && angle < ANGLES[1] && place.y < HEIGHTS_M[1];
    let edge = ((angle - ANGLES[0]) / 4.0).min((place.y - HEIGHTS_M[0]) / 0.006).clamp(0.0, 1.0);
    if is_there { edge } else { 0.0 }
}

/// Returns the angle of a place from the front about the middle of the head, degrees.
fn angle_from_front(place: Vec3) -> f32 {
    atan2(place.x.abs(), place.z + 0.085).to_degrees()
}

/// Returns how much beard grows at a place of the face; see [`scalp_density`].
pub fn beard_density(place: Vec3) -> f32 {
    let Vec3 { x, y, z } = place;
    let x = x.abs();
    // From the sideburns in a curve over the cheek and along the jaw to the chin, round the mouth; down to the throat
    let to_sideburn = ((x - 0.046) / 0.02).clamp(0.0, 1.0);
    let cheek = -0.038 - 0.25 * (0.055 - x).max(0.0);
    let upper = cheek + (0.005 - cheek) * to_sideburn * to_sideburn;
    let lower = -0.128 - 0.35 * (z + 0.02).min(0.0).abs().min(0.05) + 0.9 * (x - 0.03).max(0.0);
    let lips = (x / 0.027).powi(2) + ((y + 0.068) / 0.0115).powi(2);
    // The ear from where it joins the cheek; `is_ear` is what stands out and hair of the head avoids
    let is_beside_cheek = x > 0.0675 && y > -0.05 && z < -0.0585;
    let is_skin = z > -0.078 && !is_beside_cheek && lips > 1.0 && !(x < 0.02 && y > -0.052);
    let edge = ((upper - y) / 0.008).min((y - lower) / 0.025).clamp(0.0, 1.0);
    // It thins out towards the sides of the neck
    let front = ((z + 0.078) / 0.02 - ((-0.1 - y) / 0.02).clamp(0.0, 1.0)).clamp(0.0, 1.0);
    if is_skin { edge * front } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tied_hair_begins_sparse_and_is_dense_behind_its_edge() {
        let tied = of_head(HairStyle::TiedBack).unwrap();
        let at = |over_m: f32| {
            let place = Vec3::new(0.0, HAIRLINE[0].1 + over_m, 0.03);
            assert!((over_hairline(place) - over_m).abs() < 1e-6);
            tied.root_density(place)
        };
        let crown = tied.root_density(Vec3::new(0.0, 0.15, -0.08));
        assert!(at(-0.001) == 0.0 && at(0.003) < 0.2 * at(0.014), "{} {}", at(0.003), at(0.014));
        assert!(at(0.02) > 1.2 * crown, "{} {crown}", at(0.02));
    }

    #[test]
    fn beards_grow_on_the_jaw_and_before_the_ears_and_not_on_them() {
        for side in [1.0, -1.0] {
            let density = |place: Vec3| beard_density(place * Vec3::new(side, 1.0, 1.0));
            let [jaw, sideburn] = [Vec3::new(0.06, -0.07, -0.04), Vec3::new(0.0704, -0.018, -0.0528)];
            assert!(density(jaw) > 0.9 && density(sideburn) > 0.9, "{} {}", density(jaw), density(sideburn));
            let lobe = [Vec3::new(0.0734, -0.0441, -0.0698), Vec3::new(0.071, -0.035, -0.0615)];
            assert_eq!(lobe.map(density), [0.0; 2]);
        }
    }
}
