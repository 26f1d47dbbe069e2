//! Chest and back as height fields: what long hair falls over.

use super::hair_body::HairBody;
use glam::{Vec2, Vec3};

/// Edge length of a cell, metres.
const CELL_M: f32 = 0.01;
/// Cells across, and down from the neck.
const COLUMNS: usize = 48;
const ROWS: usize = 64;
/// Height of the uppermost row over the joint of the neck, metres.
const TOP_M: f32 = 0.06;
/// Meshes that hair falls over: the skin, and the fitted clothes.
const GROUPS: [&str; 2] = ["body", "helper-tights"];
/// Bones of the torso, by the beginning of their names; arms may be before it.
const BONES: [&str; 5] = ["spine", "breast", "clavicle", "shoulder", "neck"];
/// Points along an edge of a quad at which its distance is taken: denser than the cells.
const SAMPLES: usize = 6;

/// The side of the shoulders on which hair falls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShoulderSide {
    /// Over the chest.
    Front,
    /// Over the back.
    Back,
}

/// Distances of chest and back from a vertical plane through the shoulders.
#[derive(Clone, Debug)]
pub struct TorsoSurface {
    neck: Vec3,
    /// Unit vectors to the left, up and forwards.
    axes: [Vec3; 3],
    /// Forward distances of the chest and backward distances of the back, rows from the top, metres; negative infinity
    /// beside the torso.
    chest: Vec<f32>,
    back: Vec<f32>,
}

impl TorsoSurface {
    /// Measures a body in the head's frame, from the joint of the neck, with unit vectors to its left and upwards.
    pub fn new(body: &HairBody, neck: Vec3, left: Vec3, up: Vec3) -> TorsoSurface {
        let forward = left.cross(up).normalize_or(Vec3::Z);
        let axes = [left, forward.cross(left), forward];
        let cells = vec![f32::NEG_INFINITY; COLUMNS * ROWS];
        let mut torso = TorsoSurface { neck, axes, chest: cells.clone(), back: cells };
        let to_head = body.head.inverse();
        let is_torso: Vec<bool> =
            body.data.bones.iter().map(|bone| BONES.iter().any(|name| bone.name.starts_with(name))).collect();
        let lies_on_torso = |v: u16| {
            let [(bone, _), ..] = body.data.weights[usize::from(v)];
            is_torso[usize::from(bone)]
        };
        let quads = GROUPS.iter().flat_map(|group| body.data.quads(group));
        for quad in quads.filter(|quad| quad.iter().all(|&v| lies_on_torso(v))) {
            let [a, b, c, d] = quad.map(|v| torso.local(to_head.transform_point3(body.positions[usize::from(v)])));
            for (s, t) in (0..SAMPLES * SAMPLES).map(|i| (i % SAMPLES, i / SAMPLES)) {
                let [s, t] = [s, t].map(|k| k as f32 / (SAMPLES - 1) as f32);
                torso.raise(a.lerp(b, s).lerp(d.lerp(c, s), t));
            }
        }
        torso
    }

    /// Returns a point's coordinates to the left, up and forwards, from the joint of the neck, metres.
    fn local(&self, p: Vec3) -> Vec3 {
        let offset = p - self.neck;
        Vec3::from(self.axes.map(|axis| offset.dot(axis)))
    }

    /// Raises both fields to a point of the surface.
    fn raise(&mut self, local: Vec3) {
        let at = cell_of(local).round();
        if at.cmpge(Vec2::ZERO).all() && at.x < COLUMNS as f32 && at.y < ROWS as f32 {
            let index = at.y as usize * COLUMNS + at.x as usize;
            self.chest[index] = self.chest[index].max(local.z);
            self.back[index] = self.back[index].max(-local.z);
        }
    }

    /// Returns a point moved forwards until it lies this far before the chest, or backwards until it lies this far behind
    /// the back, metres.
    pub fn pushed_out(&self, p: Vec3, distance: f32, side: ShoulderSide) -> Vec3 {
        let local = self.local(p);
        // Most hair is higher
        if local.y > TOP_M {
            return p;
        }
        let (field, along) = match side {
            ShoulderSide::Front => (&self.chest, 1.0),
            ShoulderSide::Back => (&self.back, -1.0),
        };
        let missing = height(field, cell_of(local)) + distance - local.z * along;
        if missing > 0.0 { p + self.axes[2] * (missing * along) } else { p }
    }
}

/// Returns column and row of a point, of cells whose middles are at whole numbers.
fn cell_of(local: Vec3) -> Vec2 {
    Vec2::new(local.x / CELL_M + (COLUMNS - 1) as f32 / 2.0, (TOP_M - local.y) / CELL_M)
}

/// Returns the height of a field between the middles of cells; negative infinity beside it. At its rim the nearest
/// cell counts.
fn height(field: &[f32], at: Vec2) -> f32 {
    if !at.cmpge(Vec2::ZERO).all() || at.x > (COLUMNS - 2) as f32 || at.y > (ROWS - 2) as f32 {
        return f32::NEG_INFINITY;
    }
    let (column, row) = (at.x as usize, at.y as usize);
    let t = at - Vec2::new(column as f32, row as f32);
    let value = |dx: usize, dy: usize| field[(row + dy) * COLUMNS + column + dx];
    let corners = [value(0, 0), value(1, 0), value(0, 1), value(1, 1)];
    if corners.iter().all(|corner| corner.is_finite()) {
        let [a, b, c, d] = corners;
        let (upper, lower) = (a + (b - a) * t.x, c + (d - c) * t.x);
        return upper + (lower - upper) * t.y;
    }
    value(t.x.round() as usize, t.y.round() as usize)
}
