//! Fluids of water tanks in the scene file.

use super::defaults::{Triple, is_default};
use crate::scene::{Drop, Fluid, Jet, Obstacle, ObstacleForm};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A fluid; an empty one is the still water and the blocks of its tank.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename = "Fluid", deny_unknown_fields)]
pub(super) struct FluidV1 {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    drops: Vec<DropV1>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    jets: Vec<JetV1>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    obstacles: Vec<ObstacleV1>,
    #[serde(default, skip_serializing_if = "is_default")]
    seed: u32,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Drop", deny_unknown_fields)]
struct DropV1 {
    at_m: Triple,
    radius_m: f32,
    #[serde(default, skip_serializing_if = "is_default")]
    velocity_m_s: Triple,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Jet", deny_unknown_fields)]
struct JetV1 {
    at_m: Triple,
    radius_m: f32,
    velocity_m_s: Triple,
    until_s: f32,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Obstacle", deny_unknown_fields)]
struct ObstacleV1 {
    form: ObstacleFormV1,
    at_m: Triple,
    #[serde(default, skip_serializing_if = "is_default")]
    falls_m_s: f32,
    #[serde(default, skip_serializing_if = "is_default")]
    stands_s: f32,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "ObstacleForm", deny_unknown_fields)]
enum ObstacleFormV1 {
    Ball {
        radius_m: f32,
    },
    Box {
        size_m: Triple,
    },
    Cylinder {
        radius_m: f32,
        height_m: f32,
    },
    Glass {
        floor_m: f32,
        floor_radius_m: f32,
        rim_m: f32,
        rim_radius_m: f32,
        #[serde(default, skip_serializing_if = "is_default")]
        drink_m: f32,
    },
}

impl From<ObstacleFormV1> for ObstacleForm {
    fn from(form: ObstacleFormV1) -> Self {
        match form {
            ObstacleFormV1::Ball { radius_m } => ObstacleForm::Ball { radius_m },
            ObstacleFormV1::Box { size_m } => ObstacleForm::Box { size_m: size_m.into() },
            ObstacleFormV1::Cylinder { radius_m, height_m } => ObstacleForm::Cylinder { radius_m, height_m },
            ObstacleFormV1::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, drink_m } => {
                ObstacleForm::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, drink_m }
            }
        }
    }
}

impl From<ObstacleForm> for ObstacleFormV1 {
    fn from(form: ObstacleForm) -> Self {
        match form {
            ObstacleForm::Ball { radius_m } => ObstacleFormV1::Ball { radius_m },
            ObstacleForm::Box { size_m } => ObstacleFormV1::Box { size_m: size_m.into() },
            ObstacleForm::Cylinder { radius_m, height_m } => ObstacleFormV1::Cylinder { radius_m, height_m },
            ObstacleForm::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, drink_m } => {
                ObstacleFormV1::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, drink_m }
            }
        }
    }
}

impl From<FluidV1> for Fluid {
    fn from(file: FluidV1) -> Self {
        let FluidV1 { drops, jets, obstacles, seed } = file;
        let drop = |DropV1 { at_m, radius_m, velocity_m_s }| Drop {
            at_m: Vec3::from(at_m),
            radius_m,
            velocity_m_s: velocity_m_s.into(),
        };
        let jet = |JetV1 { at_m, radius_m, velocity_m_s, until_s }| Jet {
            at_m: at_m.into(),
            radius_m,
            velocity_m_s: velocity_m_s.into(),
            until_s,
        };
        let obstacle = |ObstacleV1 { form, at_m, falls_m_s, stands_s }| Obstacle {
            form: form.into(),
            at_m: at_m.into(),
            falls_m_s,
            stands_s,
        };
        Fluid {
            drops: drops.into_iter().map(drop).collect(),
            jets: jets.into_iter().map(jet).collect(),
            obstacles: obstacles.into_iter().map(obstacle).collect(),
            seed,
        }
    }
}

impl From<Fluid> for FluidV1 {
    fn from(fluid: Fluid) -> Self {
        let Fluid { drops, jets, obstacles, seed } = fluid;
        let drop = |Drop { at_m, radius_m, velocity_m_s }: Drop| DropV1 {
            at_m: at_m.into(),
            radius_m,
            velocity_m_s: velocity_m_s.into(),
        };
        let jet = |Jet { at_m, radius_m, velocity_m_s, until_s }: Jet| JetV1 {
            at_m: at_m.into(),
            radius_m,
            velocity_m_s: velocity_m_s.into(),
            until_s,
        };
        let obstacle = |Obstacle { form, at_m, falls_m_s, stands_s }: Obstacle| ObstacleV1 {
            form: form.into(),
            at_m: at_m.into(),
            falls_m_s,
            stands_s,
        };
        FluidV1 {
            drops: drops.into_iter().map(drop).collect(),
            jets: jets.into_iter().map(jet).collect(),
            obstacles: obstacles.into_iter().map(obstacle).collect(),
            seed,
        }
    }
}
