//! Grows the hair of a head: guides that follow the comb, and strands between them.

use super::hair_body::HairBody;
use super::obstacles::Obstacles;
use super::roots::{Root, scatter};
use super::style::{Comb, Style, scalp_density};
use crate::figures::random::Random;
use crate::scene::{Figure, StrandPoint, Strands};
use glam::{Quat, Vec3};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Number of guides.
const GUIDES: usize = 420;
/// Height over the skull at which the comb holds hair no more, metres.
const HELD_M: f32 = 0.03;
/// Segments of a guide.
const STEPS: usize = 24;

/// Grows the strands of a style.
pub fn grow_head(body: &HairBody, figure: &Figure, style: &Style, strands: &mut Strands) {
    let roots = scatter(body, style.strands, figure.seed, &scalp_density);
    let obstacles = Obstacles::new(body, &roots);
    let down = body.head.inverse().transform_vector3(Vec3::NEG_Y).normalize_or(Vec3::NEG_Y);
    let field = CombField { style, obstacles: &obstacles, down };
    let every = (roots.len() / GUIDES).max(1);
    let guide = |(index, root): (usize, &Root)| Guide {
        root: *root,
        points: field.grow(root, Random::new(figure.seed, 100 + index as u32)),
    };
    let guides: Vec<Guide> = roots.par_iter().step_by(every).enumerate().map(guide).collect();
    let strand = |(index, root): (usize, &Root)| {
        let random = Random::new(figure.seed, 100_000 + index as u32);
        let points = follow(root, &guides, style, random);
        points.into_iter().map(|(p, radius_m)| (body.head.transform_point3(p), radius_m)).collect::<Vec<_>>()
    };
    let grown: Vec<Vec<(Vec3, f32)>> = roots.par_iter().enumerate().map(strand).collect();
    for points in grown {
        strands.push(points.into_iter().map(|(position, radius_m)| StrandPoint { position, radius_m }));
    }
}

/// A strand that others follow, in the head's frame.
struct Guide {
    root: Root,
    points: Vec<Vec3>,
}

/// The directions in which the hair of a style grows.
struct CombField<'a> {
    style: &'a Style,
    obstacles: &'a Obstacles,
    /// Direction of gravity in the head's frame.
    down: Vec3,
}

impl CombField<'_> {
    /// Grows a guide in equal steps.
    fn grow(&self, root: &Root, mut random: Random) -> Vec<Vec3> {
        let style = self.style;
        let length = self.length(root) * (1.0 + 0.08 * random.bell());
        let step = length / STEPS as f32;
        let jitter = Vec3::new(random.bell(), random.bell(), random.bell()) * style.frizz;
        let mut direction =
            (root.normal * style.lift + self.comb(root.position, root.normal) * (1.0 - style.lift) + jitter)
                .normalize();
        let root_level = self.obstacles.level(root.position).min(1.0);
        let mut position = root.position;
        let mut points = vec![position];
        for k in 0..STEPS {
            let along = k as f32 / STEPS as f32;
            let outwards = (position - self.obstacles.skull_centre()).normalize_or(Vec3::Y);
            // The comb holds what lies on the head; below, hair falls.
            let held = 1.0 - self.obstacles.height_over_skull(position) / HELD_M;
            let grip = if style.comb == Comb::ToTie { 0.7 } else { 0.22 } * held.clamp(0.0, 1.0);
            let pull = self.comb(position, outwards) * grip + self.down * style.weight * (0.25 + along);
            direction = (direction + pull).normalize_or(self.down);
            // Hair lies on the hair below it: the volume builds up over the first centimetres.
            let margin = style.volume_m * (along * length / 0.03).min(1.0);
            // The head is no ellipsoid: a strand rises from the level of its root to that of the skull.
            let level = root_level + (1.0 - root_level) * (along * length / 0.06).min(1.0);
            let next = self.obstacles.pushed_out(position + direction * step, level, margin);
            direction = (next - position).normalize_or(direction);
            position += direction * step;
            points.push(position);
        }
        points
    }

    /// Returns the length of the hair at a root: between that of the sides and that of the top.
    fn length(&self, root: &Root) -> f32 {
        let [top, side] = self.style.length_m;
        let height = ((root.place.y - 0.02) / 0.07).clamp(0.0, 1.0);
        side + (top - side) * height * height * (3.0 - 2.0 * height)
    }

    /// Returns the direction of the comb at a point, along the head.
    fn comb(&self, p: Vec3, outwards: Vec3) -> Vec3 {
        let centre = self.obstacles.skull_centre();
        let radii = self.obstacles.skull_radii();
        let wanted = match self.style.comb {
            Comb::FromWhorl => {
                let whorl = centre + radii * Vec3::new(-0.15, 0.85, -0.55);
                (p - whorl).normalize_or(Vec3::NEG_Z) + self.down * 0.35
            }
            Comb::FromParting(left) => {
                let side = if p.x >= left { 1.0 } else { -1.0 };
                // Locks at the forehead are combed aside and back.
                let back = if p.z > centre.z { -0.45 } else { -0.1 };
                Vec3::new(side * 0.5, 0.0, back) + self.down
            }
            Comb::ToTie => {
                let tie = centre + radii * Vec3::new(0.0, 0.1, -1.12);
                let to_tie = tie - p;
                // Behind the tie the tail hangs down.
                if to_tie.length() < 0.03 || p.z < tie.z + 0.01 {
                    self.down * 3.0 + Vec3::NEG_Z * 0.25
                } else {
                    to_tie.normalize() * 2.0
                }
            }
            Comb::Out => outwards + self.down * 0.2,
        };
        let tangent = wanted - outwards * wanted.dot(outwards).min(0.0);
        if self.style.comb == Comb::Out { wanted.normalize_or(outwards) } else { tangent.normalize_or(self.down) }
    }
}

/// Returns the points of a strand that follows the guides near its root, with its radius there.
fn follow(root: &Root, guides: &[Guide], style: &Style, mut random: Random) -> Vec<(Vec3, f32)> {
    let nearest = |wanted: usize| {
        let mut sorted: Vec<(f32, usize)> =
            guides.iter().enumerate().map(|(i, g)| (g.root.position.distance_squared(root.position), i)).collect();
        let wanted = wanted.min(sorted.len() - 1);
        sorted.select_nth_unstable_by(wanted, |a, b| a.0.total_cmp(&b.0));
        sorted.truncate(wanted + 1);
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        sorted
    };
    let near = nearest(2);
    // Guides on the other side of a parting are no neighbours: they go another way.
    let first = &guides[near[0].1];
    let reach = first.points[STEPS / 2] - first.root.position;
    let weights: Vec<(f32, &Guide)> = near
        .iter()
        .map(|&(distance, index)| (1.0 / (distance + 1e-6), &guides[index]))
        .filter(|(_, guide)| (guide.points[STEPS / 2] - guide.root.position).dot(reach) > 0.5 * reach.length_squared())
        .collect();
    let sum: f32 = weights.iter().map(|(w, _)| w).sum();
    let shorter = 1.0 - 0.25 * random.unit() * random.unit();
    let phase = TAU * random.unit() * (1.0 - style.clumping);
    let spread = Vec3::new(random.bell(), random.bell(), random.bell()) * style.frizz * 0.05 * style.length_m[0];
    let offset = root.position - first.root.position;
    // As many segments as length and curls need
    let length = style.length_m[0].max(style.length_m[1]);
    let segments = (length / 0.025).max(length * style.turns_per_m * 7.0).ceil().clamp(4.0, 32.0) as usize;
    let mut points = Vec::with_capacity(segments + 1);
    for k in 0..=segments {
        let along = k as f32 / segments as f32;
        let at = along * shorter * STEPS as f32;
        let (low, t) = ((at as usize).min(STEPS - 1), at - (at as usize).min(STEPS - 1) as f32);
        // The mean shape of the guides, from this root, drawn towards the first guide
        let shape = |guide: &Guide| guide.points[low].lerp(guide.points[low + 1], t) - guide.root.position;
        let mean = weights.iter().map(|(w, guide)| shape(guide) * *w).sum::<Vec3>() / sum;
        let gather = style.clumping * along.powf(0.7);
        let mut p = root.position + mean.lerp(shape(first), gather) - offset * gather * 0.8 + spread * along;
        if style.curl_m > 0.0 {
            let tangent = (first.points[low + 1] - first.points[low]).normalize_or(Vec3::NEG_Y);
            let length = at / STEPS as f32 * style.length_m[0];
            let turn = Quat::from_axis_angle(tangent, TAU * style.turns_per_m * length + phase + near[0].1 as f32);
            p += turn * tangent.any_orthonormal_vector() * style.curl_m * (along * 4.0).min(1.0);
        }
        points.push((p, style.radius_m * (1.0 - 0.7 * along * along)));
    }
    points
}
