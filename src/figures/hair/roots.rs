//! Roots of hair: points on the skin with the direction in which the skin faces.

use super::hair_body::HairBody;
use crate::figures::patch::Patch;
use crate::figures::random::Random;
use crate::figures::subdivide::{QuadMesh, SubdivisionSurface};
use glam::Vec3;
use rayon::prelude::*;

/// Rounds of as many trials as roots are wanted.
const MAX_ROUNDS: usize = 20;

/// A root, in the head's frame, metres.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    /// Position on the skin.
    pub position: Vec3,
    /// Unit normal of the skin.
    pub normal: Vec3,
    /// Position on the base mesh's head, from between its eyes, metres: what regions are drawn on.
    pub place: Vec3,
}

/// Places roots at random on the skin, evenly by the base mesh's area where `density` is 1, fewer where it is less.
///
/// Body, face, expression and pose of the figure do not change where on the skin they are.
pub fn scatter(body: &HairBody, count: usize, seed: u32, density: &(dyn Fn(Vec3) -> f32 + Sync)) -> Vec<Root> {
    // The skin of the region, as smooth as it is rendered
    let eyes = body.data.eyes_middle();
    let to_head = body.head.inverse();
    let is_dense: Vec<bool> = body.data.positions.par_iter().map(|p| density(*p - eyes) > 0.0).collect();
    let wanted = |quad: &[u16; 4]| quad.iter().any(|&v| is_dense[usize::from(v)]);
    let Patch { positions, quads, uvs, sources } = Patch::new(body.data, "body", body.positions, &wanted);
    let base: Vec<Vec3> = sources.iter().map(|&v| body.data.positions[usize::from(v)]).collect();
    let coarse = SubdivisionSurface::new(QuadMesh { positions, quads, uvs, ..QuadMesh::default() });
    let middle = coarse.subdivided();
    let base = middle.subdivided_positions(&coarse.subdivided_positions(&base));
    let skin = middle.subdivided().mesh;
    let normals = skin.normals();
    // Areas of the base mesh's quads, summed
    let area = |index: usize| {
        let [a, b, c, d] = skin.quads[index].map(|v| base[v as usize]);
        (c - a).cross(d - b).length() / 2.0
    };
    let mut sums = Vec::with_capacity(skin.quads.len());
    let mut sum = 0.0;
    for index in 0..skin.quads.len() {
        sum += area(index);
        sums.push(sum);
    }
    let root = |&[at, s, t, keep]: &[f32; 4]| {
        let at = at * sum;
        let index = sums.partition_point(|&s| s < at).min(sums.len() - 1);
        let mix = |values: &[Vec3]| {
            let [a, b, c, d] = skin.quads[index].map(|v| values[v as usize]);
            a.lerp(b, s).lerp(d.lerp(c, s), t)
        };
        let place = mix(&base) - eyes;
        (keep < density(place)).then(|| {
            let position = to_head.transform_point3(mix(&skin.positions));
            let normal = to_head.transform_vector3(mix(&normals)).normalize_or(Vec3::Y);
            Root { position, normal, place }
        })
    };
    let mut roots: Vec<Root> = Vec::with_capacity(count);
    let mut random = Random::new(seed, 1);
    // A region with little density everywhere would never fill: bound the trials.
    for _ in 0..MAX_ROUNDS {
        if roots.len() == count || sums.is_empty() {
            break;
        }
        let trials: Vec<[f32; 4]> = (0..count).map(|_| std::array::from_fn(|_| random.unit())).collect();
        roots.par_extend(trials.par_iter().filter_map(root));
        roots.truncate(count);
    }
    roots
}
