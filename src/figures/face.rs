//! The targets of faces and expressions.

use crate::scene::{Expression, Face, ParameterSet};

/// The targets of each parameter of [`Face`], in its order: those for -1, then those for 1. Names are MakeHuman's, without
/// the side.
pub const FACE_TARGETS: [&[&str]; 2 * FACE_PARAMETERS] = [
    &["head-scale-horiz-decr"],
    &["head-scale-horiz-incr"],
    &["forehead-scale-vert-decr"],
    &["forehead-scale-vert-incr"],
    &["cheek-bones-decr"],
    &["cheek-bones-incr"],
    &["cheek-volume-decr"],
    &["cheek-volume-incr"],
    &["chin-width-decr"],
    &["chin-width-incr"],
    &["chin-height-decr"],
    &["chin-height-incr"],
    &["chin-prominent-decr"],
    &["chin-prominent-incr"],
    &["eye-scale-decr"],
    &["eye-scale-incr"],
    &["eye-trans-in"],
    &["eye-trans-out"],
    &["eye-corner2-down"],
    &["eye-corner2-up"],
    &["eyebrows-trans-down"],
    &["eyebrows-trans-up"],
    &["nose-scale-vert-decr"],
    &["nose-scale-vert-incr"],
    &["nose-scale-horiz-decr"],
    &["nose-scale-horiz-incr"],
    &["nose-hump-decr"],
    &["nose-hump-incr"],
    &["nose-point-down"],
    &["nose-point-up"],
    &["mouth-scale-horiz-decr"],
    &["mouth-scale-horiz-incr"],
    &["mouth-lowerlip-volume-decr", "mouth-upperlip-volume-decr"],
    &["mouth-lowerlip-volume-incr", "mouth-upperlip-volume-incr"],
    &["ear-scale-decr"],
    &["ear-scale-incr"],
];

/// The targets of every face, with their weights: the lobes of the base mesh's ears end in a straight line.
pub const EVERY_FACE: [(&str, f32); 1] = [("ear-lobe-decr", 0.8)];
/// Part of [`Expression::eyes_wide`] that neutral eyes have: the upper lids of the base mesh hang low.
const NEUTRAL_EYES_WIDE: f32 = 0.25;

const FACE_PARAMETERS: usize = <Face as ParameterSet>::PARAMETERS.len();

/// Returns the targets of a face with their weights.
pub fn face_weights(face: &Face) -> Vec<(&'static str, f32)> {
    let mut weights = EVERY_FACE.to_vec();
    for (parameter, value) in face.values().into_iter().enumerate() {
        let names = FACE_TARGETS[2 * parameter + usize::from(value > 0.0)];
        weights.extend(names.iter().map(|name| (*name, value.abs())));
    }
    weights
}

/// Returns the face units of an expression with their weights. Units are those of ARKit, as in the Face Units asset
/// pack of MakeHuman.
pub fn expression_weights(expression: &Expression) -> Vec<(&'static str, f32)> {
    let Expression {
        smile,
        teeth,
        mouth_open,
        frown,
        lips_pressed,
        pucker,
        brows_up,
        brows_down,
        squint,
        eyes_wide,
        eyes_closed,
        wink,
    } = *expression;
    // A smile that reaches the eyes raises the cheeks and the lower lids.
    let cheeks = 0.55 * smile;
    let [left_closed, right_closed] = [(eyes_closed + wink).min(1.0), eyes_closed];
    let wide = |closed: f32| eyes_wide + NEUTRAL_EYES_WIDE * (1.0 - eyes_wide) * (1.0 - closed);
    vec![
        ("mouthSmileLeft", smile),
        ("mouthSmileRight", smile),
        ("mouthDimpleLeft", 0.35 * smile),
        ("mouthDimpleRight", 0.35 * smile),
        ("cheekSquintLeft", cheeks),
        ("cheekSquintRight", cheeks),
        ("eyeSquintLeft", 0.5 * smile + squint),
        ("eyeSquintRight", 0.5 * smile + squint),
        ("mouthUpperUpLeft", 0.7 * teeth),
        ("mouthUpperUpRight", 0.7 * teeth),
        ("mouthLowerDownLeft", 0.35 * teeth),
        ("mouthLowerDownRight", 0.35 * teeth),
        ("jawOpen", mouth_open + 0.04 * teeth),
        ("mouthFrownLeft", frown),
        ("mouthFrownRight", frown),
        ("mouthPressLeft", lips_pressed),
        ("mouthPressRight", lips_pressed),
        ("mouthPucker", pucker),
        ("browInnerUp", brows_up),
        ("browOuterUpLeft", brows_up),
        ("browOuterUpRight", brows_up),
        ("browDownLeft", brows_down),
        ("browDownRight", brows_down),
        ("eyeWideLeft", wide(left_closed)),
        ("eyeWideRight", wide(right_closed)),
        ("eyeBlinkLeft", left_closed),
        ("eyeBlinkRight", right_closed),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::BodyData;

    #[test]
    fn the_shipped_body_has_every_target_of_faces_and_expressions() {
        let data = BodyData::shipped();
        let all = Expression::PARAMETERS.iter().map(|_| 1.0);
        let mut expression = Expression::default();
        expression.values_mut().into_iter().zip(all).for_each(|(value, one)| *value = one);
        let units = expression_weights(&expression).into_iter().map(|(name, _)| name);
        let of_every_face = EVERY_FACE.map(|(name, _)| name);
        for name in FACE_TARGETS.into_iter().flatten().copied().chain(of_every_face).chain(units) {
            assert!(data.targets.get(name).is_some_and(|t| !t.offsets.is_empty()), "{name}");
        }
    }
}
