//! Roots of hair: points on the skin with the direction in which the skin faces.

use super::hair_body::HairBody;
use crate::figures::patch::Patch;
use crate::figures::random::Random;
use crate::figures::subdivide::QuadMesh;
use glam::Vec3;

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

/// Places roots at random on the skin, evenly by area where `density` is 1, fewer where it is less.
pub fn scatter(body: &HairBody, count: usize, seed: u32, density: &(dyn Fn(Vec3) -> f32 + Sync)) -> Vec<Root> {
    // The skin of the region, as smooth as it is rendered
    let eyes = body.data.eyes_middle();
    let to_head = body.head.inverse();
    let wanted = |quad: &[u16; 4]| quad.iter().any(|&v| density(body.data.positions[usize::from(v)] - eyes) > 0.0);
    let smooth = |positions: &[Vec3]| {
        let patch = Patch::new(body.data, "body", positions, &wanted);
        let mesh = QuadMesh { positions: patch.positions, quads: patch.quads, uvs: patch.uvs, ..QuadMesh::default() };
        mesh.subdivided().subdivided()
    };
    let (skin, base) = (smooth(body.positions), smooth(&body.data.positions));
    let normals = skin.normals();
    // Areas of the quads, summed
    let corners = |index: usize| skin.quads[index].map(|v| skin.positions[v as usize]);
    let area = |index: usize| {
        let [a, b, c, d] = corners(index);
        (c - a).cross(d - b).length() / 2.0
    };
    let mut sums = Vec::with_capacity(skin.quads.len());
    let mut sum = 0.0;
    for index in 0..skin.quads.len() {
        sum += area(index);
        sums.push(sum);
    }
    let mut roots = Vec::with_capacity(count);
    let mut random = Random::new(seed, 1);
    // A region with little density everywhere would never fill: bound the trials.
    for _ in 0..count * 20 {
        if roots.len() == count || sums.is_empty() {
            break;
        }
        let [at, s, t, keep] = [random.unit() * sum, random.unit(), random.unit(), random.unit()];
        let index = sums.partition_point(|&s| s < at).min(sums.len() - 1);
        let mix = |values: &[Vec3]| {
            let [a, b, c, d] = skin.quads[index].map(|v| values[v as usize]);
            a.lerp(b, s).lerp(d.lerp(c, s), t)
        };
        let place = mix(&base.positions) - eyes;
        if keep < density(place) {
            let position = to_head.transform_point3(mix(&skin.positions));
            let normal = to_head.transform_vector3(mix(&normals)).normalize_or(Vec3::Y);
            roots.push(Root { position, normal, place });
        }
    }
    roots
}
