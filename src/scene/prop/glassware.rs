//! Bottles, glasses and jars. A drink is slightly wider than the hollow that it fills, so that there is no air between
//! glass and drink.

use super::solid::{Solid, smooth};
use crate::scene::Mesh;
use glam::Vec3;

/// Overlap of a drink with its glass, metres.
const OVERLAP_M: f32 = 2e-4;

/// Returns a drink that fills a hollow of this inner profile, from the axis at its bottom upwards, up to a level.
fn drink(hollow: &[(f32, f32)], level: f32) -> Vec<(f32, f32)> {
    let mut profile: Vec<(f32, f32)> = Vec::new();
    for pair in hollow.windows(2) {
        let [(r0, h0), (r1, h1)] = [pair[0], pair[1]];
        if h0 > level {
            break;
        }
        let wider = |r: f32, h: f32| (if r > 0.0 { r + OVERLAP_M } else { 0.0 }, h - OVERLAP_M);
        profile.push(wider(r0, h0));
        if h1 > level {
            let part = ((level - h0) / (h1 - h0).max(1e-6)).clamp(0.0, 1.0);
            profile.push((r0 + (r1 - r0) * part + OVERLAP_M, level));
        }
    }
    profile.push((0.0, level));
    profile
}

/// Returns a hollow body: its outside from the axis at the bottom to the rim, and its inside from the axis up to the rim.
fn hollow(outside: &[(f32, f32)], inside: &[(f32, f32)]) -> Vec<(f32, f32)> {
    outside.iter().chain(inside.iter().rev()).copied().collect()
}

/// A bottle of wine, 30 cm high.
pub(super) fn wine_bottle() -> Mesh {
    let mut outside = vec![(0.0, 0.018), (0.012, 0.015), (0.024, 0.006), (0.031, 0.0005), (0.035, 0.0)];
    outside.extend(smooth(&[
        (0.0375, 0.004),
        (0.0375, 0.1),
        (0.0375, 0.185),
        (0.033, 0.208),
        (0.019, 0.232),
        (0.0145, 0.25),
        (0.0142, 0.284),
    ]));
    outside.extend([(0.0152, 0.285), (0.0154, 0.29), (0.0152, 0.297), (0.0135, 0.3)]);
    let mut inside = vec![(0.0, 0.023), (0.012, 0.0205), (0.022, 0.013), (0.029, 0.0085), (0.0335, 0.0095)];
    inside.extend(smooth(&[
        (0.0346, 0.014),
        (0.0346, 0.1),
        (0.0346, 0.183),
        (0.0302, 0.205),
        (0.016, 0.228),
        (0.0095, 0.25),
        (0.0095, 0.299),
    ]));
    let capsule = [
        (0.0, 0.3003),
        (0.0156, 0.3003),
        (0.0156, 0.243),
        (0.0162, 0.243),
        (0.0164, 0.3),
        (0.0158, 0.3015),
        (0.0, 0.3018),
    ];
    let label = [(0.0377, 0.05), (0.0379, 0.05), (0.0379, 0.135), (0.0377, 0.135), (0.0377, 0.05)];
    let band = [(0.03791, 0.066), (0.03796, 0.066), (0.03796, 0.072), (0.03791, 0.072), (0.03791, 0.066)];
    let mut solid = Solid::default();
    solid.part("glass").turned(&hollow(&outside, &inside));
    solid.part("drink").turned(&drink(&inside, 0.175));
    solid.part("label").turned(&label);
    solid.part("foil").turned(&band).turned(&capsule);
    solid.finish()
}

/// A bottle of perfume: a block of glass of 6 cm with a golden collar and a black cap.
pub(super) fn perfume_bottle() -> Mesh {
    let mut solid = Solid::default();
    solid.part("glass").chamfered(Vec3::Y * 0.036, Vec3::new(0.06, 0.072, 0.03), 0.004);
    solid.part("drink").chamfered(Vec3::Y * 0.034, Vec3::new(0.044, 0.046, 0.016), 0.003);
    solid.part("metal").turned(&[(0.0, 0.0721), (0.011, 0.0721), (0.011, 0.078), (0.009, 0.0795), (0.0, 0.0795)]);
    solid.part("cap").chamfered(Vec3::Y * 0.0952, Vec3::new(0.026, 0.031, 0.02), 0.0025);
    solid.finish()
}

/// The outside of a tumbler, 10 cm high.
const TUMBLER_OUTSIDE: [(f32, f32); 7] =
    [(0.0, 0.0), (0.029, 0.0), (0.0315, 0.001), (0.0325, 0.003), (0.0362, 0.099), (0.0358, 0.1), (0.0352, 0.1003)];
/// Its inside.
const TUMBLER_INSIDE: [(f32, f32); 6] =
    [(0.0, 0.01), (0.026, 0.0102), (0.0295, 0.0115), (0.0308, 0.0145), (0.0344, 0.099), (0.0347, 0.1)];

/// A tumbler of water.
pub(super) fn drinking_glass() -> Mesh {
    let mut solid = Solid::default();
    solid.part("glass").turned(&hollow(&TUMBLER_OUTSIDE, &TUMBLER_INSIDE));
    solid.part("drink").turned(&drink(&TUMBLER_INSIDE, 0.068));
    solid.finish()
}

/// A tumbler without a drink.
pub(super) fn empty_glass() -> Mesh {
    let mut solid = Solid::default();
    solid.part("glass").turned(&hollow(&TUMBLER_OUTSIDE, &TUMBLER_INSIDE));
    solid.finish()
}

/// A glass of red wine, 21 cm high.
pub(super) fn wine_glass() -> Mesh {
    let mut outside = vec![(0.0, 0.0), (0.036, 0.0), (0.0366, 0.0008), (0.036, 0.0017)];
    outside.extend(smooth(&[
        (0.03, 0.0024),
        (0.012, 0.0045),
        (0.0055, 0.01),
        (0.004, 0.03),
        (0.0038, 0.07),
        (0.0052, 0.088),
        (0.017, 0.099),
        (0.033, 0.116),
        (0.0418, 0.145),
        (0.0405, 0.178),
        (0.0345, 0.209),
    ]));
    outside.extend([(0.0343, 0.2098), (0.0338, 0.21)]);
    let mut inside = vec![(0.0, 0.0955)];
    inside.extend(smooth(&[
        (0.006, 0.0965),
        (0.0165, 0.1015),
        (0.0318, 0.1175),
        (0.0405, 0.1455),
        (0.0393, 0.178),
        (0.0334, 0.209),
    ]));
    let mut solid = Solid::default();
    solid.part("glass").turned(&hollow(&outside, &inside));
    solid.part("drink").turned(&drink(&inside, 0.142));
    solid.finish()
}

/// A jar of cream: frosted glass, a brushed lid.
pub(super) fn cosmetics_jar() -> Mesh {
    let outside = [
        (0.0, 0.0),
        (0.031, 0.0),
        (0.0345, 0.0015),
        (0.036, 0.005),
        (0.036, 0.034),
        (0.0345, 0.0375),
        (0.031, 0.039),
        (0.0275, 0.039),
    ];
    let inside = [(0.0, 0.011), (0.0245, 0.011), (0.0268, 0.0125), (0.0272, 0.015), (0.0272, 0.0385)];
    let cream = [(0.0, 0.0112), (0.0245, 0.0112), (0.0266, 0.0127), (0.027, 0.015), (0.027, 0.034), (0.0, 0.0345)];
    let mut solid = Solid::default();
    solid.part("glass").turned(&hollow(&outside, &inside));
    solid.part("cream").turned(&cream);
    solid.part("metal").turned(&[
        (0.0, 0.0392),
        (0.0345, 0.0392),
        (0.0358, 0.0405),
        (0.0358, 0.056),
        (0.0345, 0.0575),
        (0.0, 0.0578),
    ]);
    solid.finish()
}
