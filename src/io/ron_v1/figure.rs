//! Figures in the scene file: sets of parameters, of which those with their default value are left out.

use super::defaults::is_default;
use crate::scene::{
    Arm, Beard, Body, Bottom, Expression, Extent, Face, Figure, Gaze, HairStyle, Leg, ParameterSet, Pose, Top, Torso,
};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::ser::SerializeStruct;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::marker::PhantomData;

/// A person.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(rename = "Figure", deny_unknown_fields)]
pub(super) struct PersonV1 {
    #[serde(default)]
    body: SetV1<Body>,
    #[serde(default, skip_serializing_if = "is_default")]
    face: SetV1<Face>,
    #[serde(default, skip_serializing_if = "is_default")]
    expression: SetV1<Expression>,
    #[serde(default, skip_serializing_if = "is_default")]
    pose: BodyPoseV1,
    /// What its eyes follow. The conversion of the scene resolves the name of a light.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) gaze: Option<GazeV1>,
    #[serde(default)]
    top: TopV1,
    #[serde(default)]
    bottom: BottomV1,
    #[serde(default)]
    hair: HairStyleV1,
    #[serde(default, skip_serializing_if = "is_default")]
    beard: BeardV1,
    #[serde(default, skip_serializing_if = "is_default")]
    seed: u32,
    #[serde(default, skip_serializing_if = "is_default")]
    extent: ExtentV1,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Gaze")]
pub(super) enum GazeV1 {
    Camera,
    /// The name of a light.
    Light(String),
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Pose", deny_unknown_fields)]
struct BodyPoseV1 {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    seat_m: Option<f32>,
    #[serde(default, skip_serializing_if = "is_default")]
    torso: SetV1<Torso>,
    #[serde(default, skip_serializing_if = "is_default")]
    left_arm: SetV1<Arm>,
    #[serde(default, skip_serializing_if = "is_default")]
    right_arm: SetV1<Arm>,
    #[serde(default, skip_serializing_if = "is_default")]
    left_leg: SetV1<Leg>,
    #[serde(default, skip_serializing_if = "is_default")]
    right_leg: SetV1<Leg>,
}

/// Declares an enum of the file with the variants of one of the scene, and both conversions.
macro_rules! variants {
    ($file:ident = $name:literal <=> $scene:ident { $first:ident $(, $variant:ident)* }) => {
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(rename = $name)]
        enum $file { $first $(, $variant)* }

        impl From<$file> for $scene {
            fn from(value: $file) -> Self {
                match value { $file::$first => $scene::$first $(, $file::$variant => $scene::$variant)* }
            }
        }

        impl From<$scene> for $file {
            fn from(value: $scene) -> Self {
                match value { $scene::$first => $file::$first $(, $scene::$variant => $file::$variant)* }
            }
        }

        impl Default for $file {
            fn default() -> Self {
                $scene::default().into()
            }
        }
    };
}

variants!(TopV1 = "Top" <=> Top { LongSleeves, ShortSleeves, Straps });
variants!(BottomV1 = "Bottom" <=> Bottom { Trousers, Shorts, Skirt });
variants!(HairStyleV1 = "HairStyle" <=> HairStyle { Bald, Crop, Short, Bob, Long, TiedBack, Curly });
variants!(BeardV1 = "Beard" <=> Beard { None, Stubble, Full });
variants!(ExtentV1 = "Extent" <=> Extent { Whole, Bust });

/// A set of parameters, by name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct SetV1<S>(S);

impl<S: ParameterSet> Serialize for SetV1<S> {
    fn serialize<Ser: Serializer>(&self, serializer: Ser) -> Result<Ser::Ok, Ser::Error> {
        let changed = || S::PARAMETERS.iter().zip(self.0.values()).filter(|(p, value)| *value != p.default);
        let mut fields = serializer.serialize_struct(S::NAME, changed().count())?;
        for (parameter, value) in changed() {
            fields.serialize_field(parameter.name, &value)?;
        }
        fields.end()
    }
}

impl<'de, S: ParameterSet> Deserialize<'de> for SetV1<S> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // Names are only used by error messages, so that none are listed here.
        deserializer.deserialize_struct(S::NAME, &[], SetVisitor(PhantomData))
    }
}

struct SetVisitor<S>(PhantomData<S>);

impl<'de, S: ParameterSet> Visitor<'de> for SetVisitor<S> {
    type Value = SetV1<S>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the parameters of {}", S::NAME)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut set = S::default();
        let mut seen = vec![false; S::PARAMETERS.len()];
        while let Some(Name(name)) = map.next_key()? {
            let index = S::PARAMETERS.iter().position(|p| p.name == name);
            let index = index.ok_or_else(|| A::Error::custom(unknown::<S>(&name)))?;
            if std::mem::replace(&mut seen[index], true) {
                return Err(A::Error::custom(format!("`{name}` is given twice")));
            }
            let value: f32 = map.next_value()?;
            if let Some(slot) = set.values_mut().into_iter().nth(index) {
                *slot = value;
            }
        }
        Ok(SetV1(set))
    }
}

fn unknown<S: ParameterSet>(name: &str) -> String {
    let names: Vec<&str> = S::PARAMETERS.iter().map(|p| p.name).collect();
    format!("{} has no field `{name}`; it has {}", S::NAME, names.join(", "))
}

/// The name of a field.
struct Name(String);

impl<'de> Deserialize<'de> for Name {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameVisitor;
        impl Visitor<'_> for NameVisitor {
            type Value = Name;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a parameter")
            }

            fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Name, E> {
                Ok(Name(name.to_owned()))
            }
        }
        deserializer.deserialize_identifier(NameVisitor)
    }
}

/// Converts what does not depend on the scene: the gaze is left as [`Gaze::Pose`].
impl From<PersonV1> for Figure {
    fn from(file: PersonV1) -> Self {
        let BodyPoseV1 { seat_m, torso, left_arm, right_arm, left_leg, right_leg } = file.pose;
        Figure {
            body: file.body.0,
            face: file.face.0,
            expression: file.expression.0,
            pose: Pose { seat_m, torso: torso.0, arms: [left_arm.0, right_arm.0], legs: [left_leg.0, right_leg.0] },
            gaze: Gaze::Pose,
            top: file.top.into(),
            bottom: file.bottom.into(),
            hair: file.hair.into(),
            beard: file.beard.into(),
            seed: file.seed,
            extent: file.extent.into(),
        }
    }
}

/// Converts what does not depend on the scene: the gaze is left out.
impl From<&Figure> for PersonV1 {
    fn from(figure: &Figure) -> Self {
        let Figure { body, face, expression, pose, gaze: _, top, bottom, hair, beard, seed, extent } = *figure;
        let Pose { seat_m, torso, arms, legs } = pose;
        let ([left_arm, right_arm], [left_leg, right_leg]) = (arms.map(SetV1), legs.map(SetV1));
        PersonV1 {
            body: SetV1(body),
            face: SetV1(face),
            expression: SetV1(expression),
            pose: BodyPoseV1 { seat_m, torso: SetV1(torso), left_arm, right_arm, left_leg, right_leg },
            gaze: None,
            top: top.into(),
            bottom: bottom.into(),
            hair: hair.into(),
            beard: beard.into(),
            seed,
            extent: extent.into(),
        }
    }
}
