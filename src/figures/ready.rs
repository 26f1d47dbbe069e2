//! The figures on the shelf, and random ones.

use super::materials::{EYE_COLORS, HAIR_COLORS, PARTS_OF_HAIR, SKIN_TONES, default_parts};
use super::named_expressions::NamedExpression;
use super::named_poses::NamedPose;
use super::random::Random;
use crate::scene::{Beard, Body, Bottom, Face, Figure, HairStyle, Material, ParameterSet, Top};

/// A figure of the shelf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadyFigure {
    /// What one sees: sex, age, hair.
    pub name: &'static str,
    /// Height, clothes and pose.
    pub tip: &'static str,
    body: Body,
    face: Face,
    expression: NamedExpression,
    pose: NamedPose,
    hair: HairStyle,
    beard: Beard,
    top: Top,
    bottom: Bottom,
    /// Index into [`SKIN_TONES`].
    tone: usize,
    /// Index into [`EYE_COLORS`].
    eye_color: usize,
    /// Index into [`HAIR_COLORS`].
    hair_color: usize,
    top_color: [f32; 3],
    bottom_color: [f32; 3],
}

const WOMAN: Body = Body {
    sex: 0.0,
    age_years: 30.0,
    height_m: 1.68,
    muscle: 0.5,
    weight: 0.45,
    african: 0.0,
    asian: 0.0,
    european: 1.0,
};
const MAN: Body = Body { sex: 1.0, height_m: 1.8, muscle: 0.55, weight: 0.5, ..WOMAN };
const FACE: Face = Face {
    width: 0.0,
    forehead: 0.0,
    cheekbones: 0.0,
    cheeks: 0.0,
    jaw: 0.0,
    chin: 0.0,
    chin_forward: 0.0,
    eye_size: 0.0,
    eye_distance: 0.0,
    eye_slant: 0.0,
    brows: 0.0,
    nose_length: 0.0,
    nose_width: 0.0,
    nose_bridge: 0.0,
    nose_tip: 0.0,
    mouth_width: 0.0,
    lips: 0.0,
    ears: 0.0,
};
const BASE: ReadyFigure = ReadyFigure {
    name: "",
    tip: "",
    body: WOMAN,
    face: FACE,
    expression: NamedExpression::Neutral,
    pose: NamedPose::Standing,
    hair: HairStyle::Short,
    beard: Beard::None,
    top: Top::ShortSleeves,
    bottom: Bottom::Trousers,
    tone: 1,
    eye_color: 2,
    hair_color: 1,
    top_color: [0.16, 0.2, 0.26],
    bottom_color: [0.035, 0.045, 0.07],
};

/// The figures of the shelf, in list order.
pub const READY: [ReadyFigure; 12] = [
    ReadyFigure {
        name: "Woman, 34, long hair",
        tip: "1.68 m, dark top, upright.",
        body: Body { age_years: 34.0, ..WOMAN },
        face: Face { cheekbones: 0.3, lips: 0.2, nose_width: -0.2, ..FACE },
        expression: NamedExpression::SoftSmile,
        hair: HairStyle::Long,
        eye_color: 1,
        hair_color: 2,
        ..BASE
    },
    ReadyFigure {
        name: "Man, 41, short hair, stubble",
        tip: "1.82 m, grey top, upright.",
        body: Body { age_years: 41.0, height_m: 1.82, ..MAN },
        face: Face { jaw: 0.3, nose_bridge: 0.3, brows: -0.2, ..FACE },
        expression: NamedExpression::Serious,
        beard: Beard::Stubble,
        eye_color: 4,
        hair_color: 1,
        top: Top::LongSleeves,
        top_color: [0.12, 0.12, 0.125],
        ..BASE
    },
    ReadyFigure {
        name: "Woman, 26, curls",
        tip: "1.65 m, light top, weight on one leg.",
        body: Body { age_years: 26.0, height_m: 1.65, african: 1.0, european: 0.0, ..WOMAN },
        face: Face { lips: 0.3, cheekbones: 0.2, ..FACE },
        expression: NamedExpression::Smile,
        pose: NamedPose::Relaxed,
        hair: HairStyle::Curly,
        tone: 4,
        eye_color: 0,
        hair_color: 0,
        top: Top::Straps,
        top_color: [0.55, 0.5, 0.42],
        ..BASE
    },
    ReadyFigure {
        name: "Man, 30, crop",
        tip: "1.85 m, athletic, arms crossed.",
        body: Body { height_m: 1.85, muscle: 0.85, african: 1.0, european: 0.0, ..MAN },
        face: Face { jaw: 0.2, ..FACE },
        pose: NamedPose::ArmsCrossed,
        hair: HairStyle::Crop,
        tone: 5,
        eye_color: 0,
        hair_color: 0,
        top_color: [0.5, 0.5, 0.48],
        ..BASE
    },
    ReadyFigure {
        name: "Woman, 29, bob",
        tip: "1.60 m, red top, turned a third away.",
        body: Body { age_years: 29.0, height_m: 1.6, weight: 0.4, asian: 1.0, european: 0.0, ..WOMAN },
        face: Face { width: -0.1, lips: 0.1, ..FACE },
        pose: NamedPose::ThreeQuarter,
        hair: HairStyle::Bob,
        eye_color: 0,
        hair_color: 0,
        top_color: [0.35, 0.04, 0.05],
        bottom: Bottom::Skirt,
        ..BASE
    },
    ReadyFigure {
        name: "Man, 52, full beard",
        tip: "1.76 m, heavy, hands joined.",
        body: Body { age_years: 52.0, height_m: 1.76, weight: 0.75, muscle: 0.45, european: 0.6, asian: 0.4, ..MAN },
        face: Face { nose_bridge: 0.5, nose_length: 0.2, cheeks: 0.2, ..FACE },
        pose: NamedPose::HandsJoined,
        beard: Beard::Full,
        tone: 3,
        eye_color: 1,
        hair_color: 0,
        top: Top::LongSleeves,
        top_color: [0.08, 0.11, 0.09],
        ..BASE
    },
    ReadyFigure {
        name: "Woman, 58, tied back",
        tip: "1.66 m, blue top, seated on 45 cm.",
        body: Body { age_years: 58.0, height_m: 1.66, weight: 0.6, muscle: 0.4, ..WOMAN },
        face: Face { cheeks: 0.2, ..FACE },
        expression: NamedExpression::SoftSmile,
        pose: NamedPose::Seated,
        hair: HairStyle::TiedBack,
        eye_color: 4,
        hair_color: 5,
        tone: 0,
        top: Top::LongSleeves,
        top_color: [0.05, 0.09, 0.22],
        ..BASE
    },
    ReadyFigure {
        name: "Man, 75, grey hair",
        tip: "1.72 m, seated on 45 cm.",
        body: Body { age_years: 75.0, height_m: 1.72, muscle: 0.35, ..MAN },
        face: Face { nose_length: 0.3, ears: 0.4, lips: -0.3, ..FACE },
        pose: NamedPose::Seated,
        eye_color: 5,
        hair_color: 6,
        tone: 1,
        top: Top::LongSleeves,
        top_color: [0.3, 0.27, 0.22],
        ..BASE
    },
    ReadyFigure {
        name: "Girl, 6, bob",
        tip: "1.16 m, yellow top, waving.",
        body: Body { age_years: 6.0, height_m: 1.16, weight: 0.5, ..WOMAN },
        expression: NamedExpression::Smile,
        pose: NamedPose::Waving,
        hair: HairStyle::Bob,
        eye_color: 4,
        hair_color: 4,
        tone: 0,
        top_color: [0.6, 0.42, 0.06],
        ..BASE
    },
    ReadyFigure {
        name: "Boy, 10, short hair",
        tip: "1.40 m, green top, upright.",
        body: Body { age_years: 10.0, height_m: 1.4, sex: 1.0, asian: 0.5, african: 0.5, european: 0.0, ..WOMAN },
        tone: 3,
        eye_color: 0,
        hair_color: 0,
        top_color: [0.07, 0.2, 0.08],
        bottom: Bottom::Shorts,
        ..BASE
    },
    ReadyFigure {
        name: "Woman, 19, tied back",
        tip: "1.73 m, slim, over the shoulder.",
        body: Body { age_years: 19.0, height_m: 1.73, weight: 0.3, european: 0.5, african: 0.5, ..WOMAN },
        face: Face { cheekbones: 0.4, eye_size: 0.2, ..FACE },
        pose: NamedPose::OverShoulder,
        hair: HairStyle::TiedBack,
        tone: 3,
        eye_color: 1,
        hair_color: 1,
        top: Top::Straps,
        top_color: [0.03, 0.03, 0.032],
        ..BASE
    },
    ReadyFigure {
        name: "Man, 23, long hair",
        tip: "1.78 m, slim, leaning.",
        body: Body { age_years: 23.0, height_m: 1.78, weight: 0.35, asian: 0.6, european: 0.4, ..MAN },
        face: Face { width: -0.2, cheekbones: 0.3, ..FACE },
        pose: NamedPose::Leaning,
        hair: HairStyle::Long,
        eye_color: 1,
        hair_color: 1,
        tone: 2,
        top_color: [0.6, 0.6, 0.58],
        ..BASE
    },
];

impl ReadyFigure {
    /// Returns its parameters.
    pub fn figure(&self) -> Figure {
        Figure {
            body: self.body,
            face: self.face,
            expression: self.expression.expression(),
            pose: self.pose.pose(),
            top: self.top,
            bottom: self.bottom,
            hair: self.hair,
            beard: self.beard,
            ..Figure::default()
        }
    }

    /// Returns the material of its skin, and those of its other parts.
    pub fn materials(&self) -> (Material, Vec<(String, Material)>) {
        let skin = SKIN_TONES[self.tone].material();
        let mut parts = default_parts(&skin, &self.figure());
        for (name, color) in [("top", self.top_color), ("bottom", self.bottom_color)] {
            if let Some((_, material)) = parts.iter_mut().find(|(part, _)| part == name) {
                material.base_color = color;
            }
        }
        for (part, material) in &mut parts {
            match part.as_str() {
                "iris" => *material = EYE_COLORS[self.eye_color].material(),
                hair if PARTS_OF_HAIR.contains(&hair) => *material = HAIR_COLORS[self.hair_color].material(),
                _ => {}
            }
        }
        (skin, parts)
    }
}

/// Returns a figure with random body, face and hair, dressed and posed as `model`. Equal seeds give equal figures.
pub fn randomised(model: &Figure, seed: u32) -> Figure {
    let mut random = Random::new(seed, 0);
    let mut figure = *model;
    let sex = if random.unit() < 0.5 { 0.0 } else { 1.0 };
    let age_years = (6.0 + 69.0 * random.unit()).round();
    // Mean heights of adults (NCD-RisC 2016: about 1.65 and 1.78 m in Europe), less for children.
    let adult = 1.65 + 0.13 * sex + 0.07 * random.bell();
    let growth = ((age_years - 6.0) / 12.0).clamp(0.0, 1.0);
    figure.body = Body {
        sex,
        age_years,
        height_m: ((1.16 + (adult - 1.16) * growth) * 100.0).round() / 100.0,
        muscle: (0.5 + 0.18 * random.bell()).clamp(0.1, 0.9),
        weight: (0.5 + 0.18 * random.bell()).clamp(0.1, 0.9),
        african: random.unit().powi(3),
        asian: random.unit().powi(3),
        european: random.unit().powi(3) + 1e-3,
    };
    for value in figure.face.values_mut() {
        *value = (0.4 * random.bell()).clamp(-0.9, 0.9);
    }
    let styles = if sex == 0.0 || random.unit() < 0.15 {
        [HairStyle::Long, HairStyle::Bob, HairStyle::TiedBack, HairStyle::Curly]
    } else {
        [HairStyle::Short, HairStyle::Crop, HairStyle::Short, HairStyle::Bald]
    };
    figure.hair = styles[(random.unit() * 4.0) as usize % 4];
    let has_beard = sex == 1.0 && age_years > 20.0;
    let beards = [Beard::None, Beard::None, Beard::Stubble, Beard::Full];
    figure.beard = if has_beard { beards[(random.unit() * 4.0) as usize % 4] } else { Beard::None };
    figure.seed = seed;
    figure
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ready_and_random_figures_are_within_every_range() {
        let ready = READY.iter().map(ReadyFigure::figure);
        let random: Vec<Figure> = (0..200).map(|seed| randomised(&Figure::default(), seed)).collect();
        assert_eq!(random[7], randomised(&Figure::default(), 7));
        assert_ne!(random[7], random[8]);
        for figure in ready.chain(random) {
            assert_eq!(figure.body.clamped(), figure.body);
            assert_eq!(figure.face.clamped(), figure.face);
            let pose = &figure.pose;
            assert_eq!(pose.torso.clamped(), pose.torso);
            assert_eq!(
                (pose.arms.map(ParameterSet::clamped), pose.legs.map(ParameterSet::clamped)),
                (pose.arms, pose.legs)
            );
        }
        let ages = READY.map(|ready| ready.body.age_years);
        assert_eq!(ages.into_iter().fold((99.0_f32, 0.0_f32), |(l, h), a| (l.min(a), h.max(a))), (6.0, 75.0));
    }

    #[test]
    fn named_poses_stay_within_the_limits_of_the_joints() {
        for pose in NamedPose::ALL.map(NamedPose::pose) {
            assert_eq!(pose.torso.clamped(), pose.torso, "{pose:?}");
            assert_eq!(pose.arms.map(ParameterSet::clamped), pose.arms);
            assert_eq!(pose.legs.map(ParameterSet::clamped), pose.legs);
        }
    }
}
