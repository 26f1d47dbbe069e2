//! Water tanks in the scene file.

use super::defaults::{Triple, is_default};
use super::fluid::FluidV1;
use crate::scene::{Block, BrushStroke, CellContent, Spring, Tank, TankLook, Terrain};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A water tank.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename = "Tank", deny_unknown_fields)]
pub(super) struct TankV1 {
    cells: (u16, u16, u16),
    cell_m: f32,
    terrain: TerrainV1,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    blocks: Vec<BlockV1>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    strokes: Vec<BrushStrokeV1>,
    #[serde(default, skip_serializing_if = "is_default")]
    water_m: f32,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    springs: Vec<SpringV1>,
    #[serde(default, skip_serializing_if = "is_default")]
    time_s: f32,
    #[serde(default, skip_serializing_if = "is_default")]
    look: TankLookV1,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fluid: Option<Box<FluidV1>>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename = "Terrain", deny_unknown_fields)]
enum TerrainV1 {
    Flat { height_m: f32 },
    Basin { floor_m: f32, rim_m: f32 },
    Hills { seed: u32, low_m: f32, high_m: f32, period_m: f32 },
    Picture { path: String, low_m: f32, high_m: f32 },
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Block", deny_unknown_fields)]
struct BlockV1 {
    from: (u16, u16, u16),
    to: (u16, u16, u16),
    content: CellContentV1,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename = "BrushStroke", deny_unknown_fields)]
struct BrushStrokeV1 {
    content: CellContentV1,
    radius_m: f32,
    path_m: Vec<Triple>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "CellContent")]
enum CellContentV1 {
    Air,
    Ground,
    Metal,
    Water,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "TankLook")]
enum TankLookV1 {
    #[default]
    Smooth,
    Cubes,
}

/// A spring; without its switches it is on from the start.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename = "Spring", deny_unknown_fields)]
struct SpringV1 {
    at_m: Triple,
    litres_per_s: f32,
    #[serde(default = "on_from_the_start", skip_serializing_if = "is_on_from_the_start")]
    switches_s: Vec<f32>,
}

fn on_from_the_start() -> Vec<f32> {
    vec![0.0]
}

fn is_on_from_the_start(switches_s: &[f32]) -> bool {
    switches_s == [0.0]
}

same_variants!(TerrainV1 <=> Terrain {
    Flat { height_m }, Basin { floor_m, rim_m }, Hills { seed, low_m, high_m, period_m },
    Picture { path, low_m, high_m },
});
same_variants!(CellContentV1 <=> CellContent { Air, Ground, Metal, Water });
same_variants!(TankLookV1 <=> TankLook { Smooth, Cubes });

impl From<TankV1> for Tank {
    fn from(file: TankV1) -> Self {
        let TankV1 { cells, cell_m, terrain, blocks, strokes, water_m, springs, time_s, look, fluid } = file;
        let block = |BlockV1 { from, to, content }| Block { from: from.into(), to: to.into(), content: content.into() };
        let stroke = |BrushStrokeV1 { content, radius_m, path_m }: BrushStrokeV1| BrushStroke {
            content: content.into(),
            radius_m,
            path_m: path_m.into_iter().map(Vec3::from).collect(),
        };
        let spring =
            |SpringV1 { at_m, litres_per_s, switches_s }| Spring { at_m: Vec3::from(at_m), litres_per_s, switches_s };
        Tank {
            cells: cells.into(),
            cell_m,
            terrain: terrain.into(),
            blocks: blocks.into_iter().map(block).collect(),
            strokes: strokes.into_iter().map(stroke).collect(),
            water_m,
            springs: springs.into_iter().map(spring).collect(),
            time_s,
            look: look.into(),
            fluid: fluid.map(|fluid| Box::new((*fluid).into())),
        }
    }
}

impl From<Tank> for TankV1 {
    fn from(tank: Tank) -> Self {
        let Tank { cells, cell_m, terrain, blocks, strokes, water_m, springs, time_s, look, fluid } = tank;
        let block = |Block { from, to, content }| BlockV1 { from: from.into(), to: to.into(), content: content.into() };
        let stroke = |BrushStroke { content, radius_m, path_m }: BrushStroke| BrushStrokeV1 {
            content: content.into(),
            radius_m,
            path_m: path_m.into_iter().map(|point| point.to_array()).collect(),
        };
        let spring =
            |Spring { at_m, litres_per_s, switches_s }| SpringV1 { at_m: at_m.to_array(), litres_per_s, switches_s };
        TankV1 {
            cells: cells.into(),
            cell_m,
            terrain: terrain.into(),
            blocks: blocks.into_iter().map(block).collect(),
            strokes: strokes.into_iter().map(stroke).collect(),
            water_m,
            springs: springs.into_iter().map(spring).collect(),
            time_s,
            look: look.into(),
            fluid: fluid.map(|fluid| Box::new((*fluid).into())),
        }
    }
}
