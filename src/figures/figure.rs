//! Assembles a figure from its skeleton, body, head, eyes and clothes.

use super::culled_field::CulledField;
use super::field::{Field, Join, PrimitiveGroup};
use super::garment::Garment;
use super::head::{HEAD_UNITS, head};
use super::meshing::WarpedGrid;
use super::pose::PoseAngles;
use super::primitive::Primitive;
use super::proportions::Build;
use super::skeleton::Skeleton;
use super::{eyes, limbs, meshing, torso};
use crate::scene::Mesh;
use glam::{Affine3A, Vec3, vec3};

/// The part of a figure that is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// From head to foot.
    Whole,
    /// Head and shoulders on a flat base.
    Bust,
}

/// The resolution of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Edge length as a multiple of full detail's.
    coarseness: f32,
}

impl Detail {
    /// The resolution of the shipped files, for portraits.
    pub const FULL: Detail = Detail { coarseness: 1.0 };

    /// Returns a resolution with edges longer than full detail's by a factor, clamped to 1 to 4: thin parts need no
    /// longer ones.
    pub fn new(coarseness: f32) -> Detail {
        Detail { coarseness: coarseness.clamp(1.0, 4.0) }
    }
}

/// Height above a standing figure's floor at which a bust is cut off, body units.
const BUST_CUT: f32 = 1.19;

/// A posed figure before it is meshed.
#[derive(Clone, Debug)]
pub struct Sculpture {
    build: Build,
    skeleton: Skeleton,
    extent: Extent,
}

impl Sculpture {
    /// Builds the skeleton of a posed figure.
    pub fn new(build: Build, pose: &PoseAngles, extent: Extent) -> Sculpture {
        Sculpture { build, skeleton: Skeleton::new(&build, pose), extent }
    }

    /// Returns the height of the lowest point, metres, which the mesh is lowered by.
    fn base(&self) -> f32 {
        match self.extent {
            Extent::Whole => 0.0,
            Extent::Bust => BUST_CUT * self.skeleton.unit,
        }
    }

    /// Returns world from head on the finished mesh, metres: origin between the eyes, +Z the direction of view.
    pub fn head(&self) -> Affine3A {
        Affine3A::from_translation(Vec3::NEG_Y * self.base()) * self.skeleton.head
    }

    /// Returns the middle of the face on the finished mesh, metres: between the eyes and the tip of the nose.
    pub fn face_point(&self) -> Vec3 {
        let scale = self.build.head / HEAD_UNITS;
        self.head().transform_point3(vec3(0.0, -18.0, 101.0) * scale)
    }

    /// Builds the distance field of the body, at its standing height.
    fn field(&self) -> Field {
        let (s, b) = (&self.skeleton, &self.build);
        let mut groups = vec![torso::torso(s, b)];
        groups.push(head(s.head, b.head, &b.face));
        let mut cuts = Vec::new();
        match self.extent {
            Extent::Whole => {
                groups.extend(s.legs.iter().map(|leg| limbs::leg(s, leg, b)));
                groups.extend(s.arms.iter().map(|arm| limbs::arm(s, arm, b)));
            }
            Extent::Bust => {
                groups.extend(s.arms.iter().map(|arm| shoulder_cap(s, arm.shoulder, arm.elbow)));
                cuts.push((Primitive::HalfSpace { normal: Vec3::Y, offset: self.base() }, 0.012));
            }
        }
        Field { groups, cuts, ..Field::default() }
    }

    /// The suit as a part of its own, fine at its hems.
    fn clothes(&self, detail: Detail, low: Vec3, high: Vec3) -> Mesh {
        let unit = self.skeleton.unit;
        let garment = Garment::new(&self.skeleton, &self.build);
        let culled = CulledField::new(&garment.field, low, high);
        let middle = self.skeleton.waist.transform_point3(Vec3::Y * 1.15 * unit);
        let grid = WarpedGrid { focus: middle, cell_m: 0.006 * unit * detail.coarseness.min(1.5), core_m: 1.0 };
        let target = |p: Vec3| {
            let hem = ramp(garment.to_hem(p) / unit, 0.005, 0.035, 0.004, 0.02);
            // Collar bones are thinner than the triangles of a flat back.
            let bones = ramp(garment.to_neckline(p) / unit, 0.01, 0.2, 0.006, 0.02);
            detail.coarseness * unit * hem.min(bones)
        };
        meshing::skin(&culled, &grid, low, high, target).with_single_part("clothes")
    }

    /// Wanted length of the mesh's edges, metres: finest at lids and lips, finer than the trunk at hands and feet.
    fn edge_length(&self, p: Vec3, head_from_world: &Affine3A) -> f32 {
        let (unit, scale) = (self.skeleton.unit, self.build.head / HEAD_UNITS);
        let head = scale * head_edge_length(head_from_world.transform_point3(p) / scale);
        let hands = self.skeleton.arms.iter().map(|a| (p - a.wrist - a.fingers * 0.09 * unit).length());
        let feet =
            self.skeleton.legs.iter().map(|l| (p - l.foot.transform_point3(vec3(0.0, 0.03, 0.08) * unit)).length());
        let hand = ramp(hands.fold(f32::INFINITY, f32::min) / unit, 0.11, 0.2, 0.006, 0.02);
        let foot = ramp(feet.fold(f32::INFINITY, f32::min) / unit, 0.13, 0.25, 0.0075, 0.02);
        head.min(hand * unit).min(foot * unit)
    }

    /// Meshes the figure with its parts.
    pub fn mesh(&self, detail: Detail) -> Mesh {
        let (low, high) = self.skeleton.bounds();
        let low = low.with_y(low.y.max(self.base() - 0.03));
        let culled = CulledField::new(&self.field(), low, high);
        let scale = self.build.head / HEAD_UNITS;
        let focus = self.skeleton.head.transform_point3(vec3(0.0, -32.0, 80.0) * scale);
        let grid = WarpedGrid { focus, cell_m: 0.001_5 * detail.coarseness, core_m: 0.1 };
        let head_from_world = self.skeleton.head.inverse();
        let target = |p: Vec3| detail.coarseness * self.edge_length(p, &head_from_world);
        let mut mesh = meshing::skin(&culled, &grid, low, high, target).with_single_part("skin");
        eyes::add_eyes(&mut mesh, self.skeleton.head, scale, &self.build.face);
        if self.extent == Extent::Whole {
            mesh.append(&self.clothes(detail, low, high));
        }
        for p in &mut mesh.positions {
            p.y -= self.base();
        }
        mesh
    }
}

/// Builds the rounded end of an arm on a bust.
fn shoulder_cap(s: &Skeleton, shoulder: Vec3, elbow: Vec3) -> PrimitiveGroup {
    let u = s.unit;
    let mut g = PrimitiveGroup::in_world(Join { center: shoulder, radius: 0.085 * u, near: 0.05 * u, far: 0.05 * u });
    let along = elbow - shoulder;
    g.cone(shoulder, 0.047 * u, shoulder + along * 0.22, 0.041 * u, 0.0);
    g
}

/// Interpolates linearly from `y0` at `x0` to `y1` at `x1`, constant outside.
fn ramp(x: f32, x0: f32, x1: f32, y0: f32, y1: f32) -> f32 {
    y0 + (y1 - y0) * ((x - x0) / (x1 - x0)).clamp(0.0, 1.0)
}

/// Returns the target edge length on and around a head. All lengths in head units.
fn head_edge_length(p: Vec3) -> f32 {
    let p = p.with_x(p.x.abs());
    let from_face = p.distance(vec3(0.0, -32.0, 80.0));
    let general = ramp(from_face, 55.0, 140.0, 2.2, 5.2) + ramp(from_face, 160.0, 450.0, 0.0, 13.0);
    // Line of the mouth, lids, nostrils, ears: middle, radius, length of edges in it.
    let mouth = p.distance(vec3(p.x.min(27.0), -71.0, 98.0 - 0.4 * p.x.min(27.0)));
    let fine = [
        (mouth, 5.0, 1.1),
        (p.distance(vec3(31.5, 0.0, 82.0)), 16.0, 1.1),
        (p.distance(vec3(p.x.min(9.0), -50.0, 101.0)), 9.0, 1.3),
        (p.distance(vec3(0.0, -56.0, 101.0)), 8.0, 1.2),
        (p.distance(vec3(78.0, -18.0, -14.0)), 28.0, 2.2),
    ];
    fine.iter()
        .fold(general, |length, &(d, radius, target)| length.min(ramp(d, radius, radius + 14.0, target, general)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Figure, Pose};
    use rayon::prelude::*;

    /// Checks the midpoints of edges and triangles, where a round body would intersect the cloth first.
    #[test]
    fn the_suit_lies_outside_the_body() {
        let dressed = [
            (Figure::Woman, Pose::Standing),
            (Figure::Man, Pose::Standing),
            (Figure::Child, Pose::Contrapposto),
            (Figure::Man, Pose::Seated),
        ];
        for (figure, pose) in dressed {
            let sculpture = Sculpture::new(Build::of(figure), &PoseAngles::of(figure, pose), Extent::Whole);
            let (low, high) = sculpture.skeleton.bounds();
            let body = CulledField::new(&sculpture.field(), low, high);
            let garment = Garment::new(&sculpture.skeleton, &sculpture.build);
            let suit = sculpture.clothes(Detail::FULL, low, high);
            let nearest = |i: usize| {
                let [a, b, c] = suit.corners(i);
                let middles = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0];
                // The hems' flat ends reach into the body.
                let off_hem = middles.into_iter().filter(|&p| garment.to_hem(p) > 0.01);
                off_hem.map(|p| (body.distance(p), p.to_array())).min_by(|a, b| a.0.total_cmp(&b.0))
            };
            let nearest = (0..suit.triangles.len()).into_par_iter().filter_map(nearest);
            let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            assert!(nearest.0 > 0.000_8, "{figure:?} {pose:?}: {nearest:?}");
        }
    }
}
