//! The names by which a file refers to its objects and lights.

use super::figure::GazeV1;
use super::{AimV1, FocusV1, LightV1, ObjectV1, VariantV1};
use crate::scene::{Aim, Focus, Gaze, LightId, ObjectId};
use glam::Vec3;
use std::collections::HashMap;

/// A reference to an object, a light or a variant that the file does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::io) struct UnknownName {
    /// The kind it refers to: `object`, `light` or `variant`.
    pub kind: &'static str,
    /// The field that refers to it, such as `lights[2] "Key" aim.name`.
    pub place: String,
    /// The name.
    pub name: String,
    /// All names of this kind.
    pub known: Vec<String>,
}

/// Object ids by name, the index in the file. The first of two equal names counts.
pub(super) struct ObjectIds(HashMap<String, ObjectId>);

impl ObjectIds {
    pub fn of(objects: &[ObjectV1]) -> Self {
        let mut ids = HashMap::new();
        for (index, object) in (0..).zip(objects) {
            ids.entry(object.name.clone()).or_insert(ObjectId(index));
        }
        ObjectIds(ids)
    }

    pub fn id(&self, name: &str, place: &str) -> Result<ObjectId, UnknownName> {
        self.0.get(name).copied().ok_or_else(|| {
            let mut known: Vec<String> = self.0.keys().cloned().collect();
            known.sort_unstable();
            UnknownName { kind: "object", place: place.to_owned(), name: name.to_owned(), known }
        })
    }

    pub fn aim(&self, aim: AimV1, place: &str) -> Result<Aim, UnknownName> {
        Ok(match aim {
            AimV1::Point(x, y, z) => Aim::Point(Vec3::new(x, y, z)),
            AimV1::Object { name, offset } => {
                Aim::Object { object: self.id(&name, &format!("{place}aim.name"))?, offset: Vec3::from(offset) }
            }
            AimV1::Angles { yaw_deg, pitch_deg } => Aim::Angles { yaw_deg, pitch_deg },
        })
    }

    /// Resolves the object of a focus; `place` is that of the camera, with a dot.
    pub fn focus(&self, focus: FocusV1, place: &str) -> Result<Focus, UnknownName> {
        Ok(match focus {
            FocusV1::OnAim => Focus::OnAim,
            FocusV1::OnObject { name, offset } => {
                Focus::OnObject { object: self.id(&name, &format!("{place}focus.name"))?, offset: Vec3::from(offset) }
            }
            FocusV1::Distance(distance) => Focus::Distance(distance),
        })
    }
}

/// Light ids by name: the index in the file, then those of lights that variants add. The first of two equal names counts,
/// and lights of equal names that variants add are one light.
pub(super) struct LightIds {
    of_studio: HashMap<String, LightId>,
    added: HashMap<String, LightId>,
}

impl LightIds {
    pub fn of(lights: &[LightV1], variants: &[VariantV1]) -> Self {
        let (mut of_studio, mut added, mut next) = (HashMap::new(), HashMap::new(), 0);
        for light in lights {
            of_studio.entry(light.name.clone()).or_insert(LightId(next));
            next += 1;
        }
        for light in variants.iter().flat_map(|variant| &variant.added_lights) {
            if !added.contains_key(&light.name) {
                added.insert(light.name.clone(), LightId(next));
                next += 1;
            }
        }
        LightIds { of_studio, added }
    }

    /// Returns the id of a light of the studio itself.
    pub fn id(&self, name: &str, place: &str) -> Result<LightId, UnknownName> {
        self.of_studio.get(name).copied().ok_or_else(|| unknown_light(name, place, self.of_studio.keys()))
    }

    /// Returns the id of a light that a variant adds. It may have the name of a light of the studio.
    pub fn added_id(&self, name: &str, place: &str) -> Result<LightId, UnknownName> {
        self.added.get(name).copied().ok_or_else(|| unknown_light(name, place, self.added.keys()))
    }

    pub fn gaze(&self, gaze: GazeV1, place: &str) -> Result<Gaze, UnknownName> {
        Ok(match gaze {
            GazeV1::Camera => Gaze::Camera,
            GazeV1::Light(name) => Gaze::Light(match self.added.get(&name) {
                Some(added) if !self.of_studio.contains_key(&name) => *added,
                _ => self.id(&name, place)?,
            }),
        })
    }
}

fn unknown_light<'a>(name: &str, place: &str, known: impl Iterator<Item = &'a String>) -> UnknownName {
    let mut known: Vec<String> = known.cloned().collect();
    known.sort_unstable();
    UnknownName { kind: "light", place: place.to_owned(), name: name.to_owned(), known }
}
