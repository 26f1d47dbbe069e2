//! Body measures. The shipped figures are values of [`Build`]; all lengths in metres.

use crate::scene::Figure;

/// The shape of a face, as factors and offsets relative to a mean adult's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceShape {
    /// Width of the skull.
    pub skull: f32,
    /// Width of the lower jaw and chin.
    pub jaw: f32,
    /// Offset of the chin forwards, head units (1/230 of the head's height).
    pub chin: f32,
    /// Offset of the chin upwards, head units.
    pub chin_lift: f32,
    /// Height of the brow ridge, head units.
    pub brow: f32,
    /// Strength of the cheekbones.
    pub cheek: f32,
    /// Depth of the hollow under the cheekbones.
    pub hollow: f32,
    /// Projection of the nose.
    pub nose: f32,
    /// Width of the nose.
    pub nose_width: f32,
    /// Width of the mouth.
    pub mouth: f32,
    /// Fullness of the lips.
    pub lips: f32,
    /// Opening of the eyes.
    pub eye_open: f32,
    /// Offset of the eyes forwards, head units.
    pub eye_forward: f32,
    /// Fullness of the cheeks.
    pub fullness: f32,
    /// Size of the ears.
    pub ear: f32,
    /// Depth of the folds beside nose and mouth.
    pub age: f32,
}

/// Measures of a body, standing, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Build {
    /// Floor to crown.
    pub height: f32,
    /// Chin to crown.
    pub head: f32,
    /// Between the joints of the shoulders.
    pub shoulder_width: f32,
    /// Rib cage from side to side.
    pub chest_width: f32,
    /// Rib cage from front to back.
    pub chest_depth: f32,
    /// Waist from side to side.
    pub waist_width: f32,
    /// Waist from front to back.
    pub waist_depth: f32,
    /// Hips from side to side.
    pub hip_width: f32,
    /// Radius of the breasts; 0 for a flat chest.
    pub bust: f32,
    /// Radius of the neck.
    pub neck: f32,
    /// Thickness of arms and legs relative to a mean man's of that height.
    pub limb: f32,
    /// Definition of the muscles, 0 to 1.
    pub muscle: f32,
    /// The face.
    pub face: FaceShape,
}

const MEAN_FACE: FaceShape = FaceShape {
    skull: 1.0,
    jaw: 1.0,
    chin: 0.0,
    chin_lift: 0.0,
    brow: 1.0,
    cheek: 1.0,
    hollow: 1.0,
    nose: 1.0,
    nose_width: 1.0,
    mouth: 1.0,
    lips: 1.0,
    eye_open: 1.0,
    eye_forward: 0.0,
    fullness: 1.0,
    ear: 1.0,
    age: 1.0,
};

impl Build {
    /// Returns the measures of a shipped figure. A bust has the woman's.
    pub fn of(figure: Figure) -> Build {
        match figure {
            Figure::Woman | Figure::Bust => Build {
                height: 1.68,
                head: 1.68 / 7.5,
                shoulder_width: 0.316,
                chest_width: 0.255,
                chest_depth: 0.185,
                waist_width: 0.235,
                waist_depth: 0.165,
                hip_width: 0.345,
                bust: 0.062,
                neck: 0.049,
                limb: 0.93,
                muscle: 0.35,
                face: FaceShape {
                    skull: 0.98,
                    jaw: 0.9,
                    brow: 0.0,
                    hollow: 0.5,
                    nose: 0.93,
                    nose_width: 0.92,
                    mouth: 0.96,
                    lips: 1.16,
                    eye_open: 1.06,
                    ear: 0.92,
                    age: 0.6,
                    ..MEAN_FACE
                },
            },
            Figure::Man => Build {
                height: 1.80,
                head: 1.80 / 7.5,
                shoulder_width: 0.375,
                chest_width: 0.31,
                chest_depth: 0.225,
                waist_width: 0.285,
                waist_depth: 0.2,
                hip_width: 0.335,
                bust: 0.0,
                neck: 0.058,
                limb: 1.05,
                muscle: 1.0,
                face: FaceShape { jaw: 1.06, chin: 1.5, brow: 2.0, eye_open: 0.92, ..MEAN_FACE },
            },
            Figure::Child => Build {
                height: 1.28,
                head: 1.28 / 6.0,
                shoulder_width: 0.244,
                chest_width: 0.21,
                chest_depth: 0.165,
                waist_width: 0.2,
                waist_depth: 0.158,
                hip_width: 0.225,
                bust: 0.0,
                neck: 0.04,
                limb: 0.98,
                muscle: 0.15,
                face: FaceShape {
                    skull: 1.05,
                    jaw: 0.88,
                    chin: -3.0,
                    chin_lift: 4.0,
                    brow: -1.0,
                    cheek: 0.7,
                    hollow: -0.5,
                    fullness: 1.1,
                    nose: 0.72,
                    nose_width: 0.86,
                    mouth: 0.84,
                    lips: 1.04,
                    eye_open: 1.15,
                    age: 0.2,
                    ..MEAN_FACE
                },
            },
        }
    }
}
