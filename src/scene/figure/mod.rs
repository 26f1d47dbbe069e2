//! Figures: people, by parameters. `figures` makes their meshes.

mod body;
mod gaze;
mod parameter;
mod pose;

pub use body::{Body, Expression, Face};
pub use gaze::Gaze;
pub use parameter::{Parameter, ParameterSet};
pub use pose::{Arm, Leg, Pose, SEAT_RANGE_M, Torso};

use std::cmp::Ordering;
use std::hash::{Hash, Hasher};

/// Upper garment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Top {
    /// Long sleeves, round neck.
    LongSleeves,
    /// Short sleeves, round neck.
    #[default]
    ShortSleeves,
    /// No sleeves, low neck.
    Straps,
}

impl Top {
    /// All upper garments.
    pub const ALL: [Top; 3] = [Top::LongSleeves, Top::ShortSleeves, Top::Straps];

    /// Returns its label.
    pub fn label(self) -> &'static str {
        match self {
            Top::LongSleeves => "Long sleeves",
            Top::ShortSleeves => "Short sleeves",
            Top::Straps => "Straps",
        }
    }

    /// Returns true if its neckline has a collar that stands off the skin; straps lie on it.
    pub fn has_collar(self) -> bool {
        match self {
            Top::LongSleeves | Top::ShortSleeves => true,
            Top::Straps => false,
        }
    }
}

/// Lower garment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Bottom {
    /// Long trousers.
    #[default]
    Trousers,
    /// Trousers that end above the knee.
    Shorts,
    /// A skirt to the knee.
    Skirt,
}

impl Bottom {
    /// All lower garments.
    pub const ALL: [Bottom; 3] = [Bottom::Trousers, Bottom::Shorts, Bottom::Skirt];

    /// Returns its label.
    pub fn label(self) -> &'static str {
        match self {
            Bottom::Trousers => "Trousers",
            Bottom::Shorts => "Shorts",
            Bottom::Skirt => "Skirt",
        }
    }

    /// Returns true if it hangs from the waist and covers the thighs without touching them, with the top tucked in; false
    /// for trousers, which the top hangs over.
    pub fn hangs_from_waist(self) -> bool {
        match self {
            Bottom::Skirt => true,
            Bottom::Trousers | Bottom::Shorts => false,
        }
    }
}

/// Hair of the head.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum HairStyle {
    /// No hair.
    Bald,
    /// Clipped to some millimetres.
    Crop,
    /// A few centimetres, parted.
    #[default]
    Short,
    /// To the jaw.
    Bob,
    /// To the shoulders and below.
    Long,
    /// Combed back into a tail.
    TiedBack,
    /// Curls to the jaw.
    Curly,
}

impl HairStyle {
    /// All styles.
    pub const ALL: [HairStyle; 7] = [
        HairStyle::Bald,
        HairStyle::Crop,
        HairStyle::Short,
        HairStyle::Bob,
        HairStyle::Long,
        HairStyle::TiedBack,
        HairStyle::Curly,
    ];

    /// Returns its label.
    pub fn label(self) -> &'static str {
        match self {
            HairStyle::Bald => "Bald",
            HairStyle::Crop => "Crop",
            HairStyle::Short => "Short",
            HairStyle::Bob => "Bob",
            HairStyle::Long => "Long",
            HairStyle::TiedBack => "Tied back",
            HairStyle::Curly => "Curly",
        }
    }
}

/// Hair of the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Beard {
    /// Shaved.
    #[default]
    None,
    /// A few days old.
    Stubble,
    /// A full beard.
    Full,
}

impl Beard {
    /// All beards.
    pub const ALL: [Beard; 3] = [Beard::None, Beard::Stubble, Beard::Full];

    /// Returns its label.
    pub fn label(self) -> &'static str {
        match self {
            Beard::None => "None",
            Beard::Stubble => "Stubble",
            Beard::Full => "Full",
        }
    }
}

/// The part of a figure that is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Extent {
    /// From head to foot; its origin is the floor below the pelvis.
    #[default]
    Whole,
    /// Head and shoulders; its origin is the middle of the cut.
    Bust,
}

/// A person. It looks along +Z.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Figure {
    /// Body measures.
    pub body: Body,
    /// Features of the face.
    pub face: Face,
    /// Expression.
    pub expression: Expression,
    /// Pose.
    pub pose: Pose,
    /// What its eyes follow.
    pub gaze: Gaze,
    /// Upper garment.
    pub top: Top,
    /// Lower garment.
    pub bottom: Bottom,
    /// Hair of the head.
    pub hair: HairStyle,
    /// Hair of the face.
    pub beard: Beard,
    /// Seed of the hair.
    pub seed: u32,
    /// The part that is there.
    pub extent: Extent,
}

impl Figure {
    /// Returns every value that the mesh depends on, as bits: the key of caches.
    fn key(&self) -> Vec<u32> {
        let Figure { body, face, expression, pose, gaze, top, bottom, hair, beard, seed, extent } = self;
        let Pose { seat_m, torso, arms, legs } = pose;
        let mut key = vec![
            *top as u32,
            *bottom as u32,
            *hair as u32,
            *beard as u32,
            *seed,
            *extent as u32,
            seat_m.is_some().into(),
        ];
        key.extend(gaze.key());
        let mut add = |values: Vec<f32>| key.extend(values.into_iter().map(|v| (v + 0.0).to_bits()));
        add(vec![seat_m.unwrap_or_default()]);
        [body.values(), face.values(), expression.values(), torso.values()].into_iter().for_each(&mut add);
        arms.iter().map(Arm::values).chain(legs.iter().map(Leg::values)).for_each(&mut add);
        key
    }
}

// Values are finite in a valid scene, so that equality is an equivalence.
impl Eq for Figure {}

impl Hash for Figure {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

impl PartialOrd for Figure {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Figure {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_is_part_of_the_key_and_within_its_range_by_default() {
        let figure = Figure::default();
        let sets: [(&[Parameter], Vec<f32>); 6] = [
            (Body::PARAMETERS, figure.body.values()),
            (Face::PARAMETERS, figure.face.values()),
            (Expression::PARAMETERS, figure.expression.values()),
            (Torso::PARAMETERS, figure.pose.torso.values()),
            (Arm::PARAMETERS, figure.pose.arms[0].values()),
            (Leg::PARAMETERS, figure.pose.legs[0].values()),
        ];
        for (parameters, values) in sets {
            for (parameter, value) in parameters.iter().zip(values) {
                assert_eq!(value, parameter.default, "{}", parameter.name);
                assert!((parameter.low..=parameter.high).contains(&value), "{}", parameter.name);
            }
        }
        let mut other = figure;
        for slot in 0..Expression::PARAMETERS.len() {
            *other.expression.values_mut()[slot] = 0.5;
            assert_ne!(other.key(), figure.key());
            other = figure;
        }
        other.pose.arms[1].elbow_deg = 90.0;
        assert!(other != figure && other.cmp(&figure).is_ne());
        assert_eq!(other.pose.mirrored().mirrored(), other.pose);
        assert_eq!(other.pose.mirrored().arms[0].elbow_deg, 90.0);
    }
}
