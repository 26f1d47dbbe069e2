//! The body data that every figure is made from: a base mesh with targets (shape offsets), bones and weights.
//!
//! The data are MakeHuman's, converted by `catchlight bake-figures`; `assets/figures/README.md` names source, version
//! and licence. Positions are in metres, Y up; the body looks along +Z, and its left is +X.

use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::FRAC_1_SQRT_2;

/// Offsets of vertices that change the shape of the base mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Target {
    /// Vertices with their offsets at full strength, metres; in ascending order of the vertices.
    pub offsets: Vec<(u16, Vec3)>,
}

/// A group of quads of the base mesh: `body`, `helper-tights` ...
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuadGroup {
    /// Name in the source.
    pub name: String,
    /// Corners, counter-clockwise from outside.
    pub quads: Vec<[u16; 4]>,
    /// Texture coordinates of the corners, as indices into [`BodyData::uvs`].
    pub uvs: Vec<[u16; 4]>,
}

/// A grey picture in the base mesh's texture coordinates: where a region of the skin is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mask {
    /// Width and height, pixels.
    pub size: usize,
    /// Strengths, 0 to 255, row by row from the top.
    pub values: Vec<u8>,
}

/// A bone of the skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    /// Name in the source: `upperarm01.L`.
    pub name: String,
    /// Index of the parent, which is listed before its children; none for the root.
    pub parent: Option<u8>,
    /// Vertex (of no quad) at the joint with the parent.
    pub head: u16,
    /// Vertex (of no quad) at the other end.
    pub tail: u16,
}

/// Bones that move a vertex, with weights in 1/255 that sum to 255.
pub type BoneWeights = [(u8, u8); 4];

impl Mask {
    /// Returns the strength at texture coordinates, 0 to 1, interpolated between the middles of pixels; 0 without a
    /// picture.
    pub fn at(&self, uv: Vec2) -> f32 {
        let last = self.size.saturating_sub(1);
        let place = |x: f32| {
            let x = (x.clamp(0.0, 1.0) * self.size as f32 - 0.5).clamp(0.0, last as f32);
            (x as usize, x - (x as usize) as f32)
        };
        let ((x, right), (y, down)) = (place(uv.x), place(1.0 - uv.y));
        let value = |x: usize, y: usize| {
            let value = self.values.get(y.min(last) * self.size + x.min(last));
            value.map_or(0.0, |&value| f32::from(value) / 255.0)
        };
        let row = |y| value(x, y) * (1.0 - right) + value(x + 1, y) * right;
        row(y) * (1.0 - down) + row(y + 1) * down
    }

    /// Returns the mean strength within a distance of texture coordinates.
    pub fn mean_around(&self, uv: Vec2, radius: f32) -> f32 {
        const RADII: [f32; 3] = [0.35, 0.68, 0.94];
        const DIAGONAL: Vec2 = Vec2::splat(FRAC_1_SQRT_2);
        // Each ring stands for a third of the disc, and has points in eight directions
        let directions = [Vec2::X, DIAGONAL].into_iter().flat_map(|d| [d, d.perp(), -d, -d.perp()]);
        let points = RADII.iter().flat_map(|part| directions.clone().map(move |d| uv + part * radius * d));
        points.map(|point| self.at(point)).sum::<f32>() / (8.0 * RADII.len() as f32)
    }
}

/// The base mesh of all figures with its targets, bones, weights and masks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyData {
    /// Vertices of the base mesh, then those of the joints, metres.
    pub positions: Vec<Vec3>,
    /// Texture coordinates.
    pub uvs: Vec<Vec2>,
    /// The vertex on the other side of the body for each vertex.
    pub mirror: Vec<u16>,
    /// Groups of quads.
    pub groups: Vec<QuadGroup>,
    /// Targets by name.
    pub targets: HashMap<String, Target>,
    /// The skeleton.
    pub bones: Vec<Bone>,
    /// Bones that move each vertex.
    pub weights: Vec<BoneWeights>,
    /// Regions of the skin: `lips`, `ears` ...
    pub masks: HashMap<String, Mask>,
}

impl BodyData {
    /// Returns a group of quads; none of this name.
    pub fn group(&self, name: &str) -> Option<&QuadGroup> {
        self.groups.iter().find(|each| each.name == name)
    }

    /// Returns the quads of a group; empty if there is none of this name.
    pub fn quads(&self, group: &str) -> &[[u16; 4]] {
        self.group(group).map_or(&[], |each| &each.quads)
    }

    /// Returns the point between the eyeballs.
    pub fn eyes_middle(&self) -> Vec3 {
        let points = ["helper-l-eye", "helper-r-eye"].into_iter().flat_map(|group| self.quads(group)).flatten();
        let (low, high) = points
            .map(|&v| self.positions[usize::from(v)])
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        (low + high) / 2.0
    }

    /// Returns the quads that mark where lashes grow: those of the lower lid and those of the upper one, at the left (`l`)
    /// or right (`r`) eye.
    pub fn lash_quads(&self, side: &str) -> [&[[u16; 4]]; 2] {
        let mut strips = [1, 2].map(|row| self.quads(&format!("helper-{side}-eyelashes-{row}")));
        let height = |strip: &&[[u16; 4]]| {
            let vertices = strip.iter().flatten();
            vertices.map(|&v| self.positions[usize::from(v)].y).sum::<f32>() / (4 * strip.len().max(1)) as f32
        };
        strips.sort_by(|a, b| height(a).total_cmp(&height(b)));
        strips
    }

    /// Returns the index of a bone.
    pub fn bone(&self, name: &str) -> Option<usize> {
        self.bones.iter().position(|bone| bone.name == name)
    }
}
