//! Sews bands to the edges of garments: collars, cuffs and hems. A band begins at a seam, stands out by the
//! thickness of folded cloth and ends in a rim that is turned under.

use super::fairing::low_pass;
use super::patch::Skin;
use super::subdivide::{QuadMesh, SubdivisionSurface};
use glam::{Vec2, Vec3};

/// Widths of bands, metres: of a collar, of a binding, of cuffs and hems. Typical.
const COLLAR_WIDTH_M: f32 = 0.018;
const BINDING_WIDTH_M: f32 = 0.008;
const HEM_WIDTH_M: f32 = 0.016;
/// Cross section at the seam: distances from it and heights over the garment, metres.
const SEAM: [[f32; 2]; 3] = [[0.0004, -0.0014], [0.0011, 0.0006], [0.003, 0.0009]];
/// Cross section at the rim: distances to the end of the band and heights, metres.
const RIM: [[f32; 2]; 5] = [[0.004, 0.0009], [0.001, 0.0006], [0.0, -0.0004], [0.0005, -0.0016], [0.006, -0.0018]];
/// Steps in which a band is laid out from seam to rim.
const STEPS: usize = 4;
/// Height of a rim that lies on skin, metres.
const RIM_HEIGHT_M: f32 = 0.0035;
/// Factors by which the positions along an edge are moved towards the mean of their neighbours, in turns: edges of a cut
/// mesh are ragged. The second one undoes the shrinkage of the first (Taubin 1995, "A Signal Processing Approach to Fair
/// Surface Design").
const SMOOTHING: [f32; 2] = [0.6, -0.63];
/// Rounds of that, and rounds in which the directions of the band are averaged: it would widen every wave.
const POSITION_ROUNDS: usize = 5;
const DIRECTION_ROUNDS: usize = 20;
/// Harmonics of the height along a hem that are kept: hems are sewn level.
const HEM_HARMONICS: usize = 3;

/// A band at one edge of a garment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Band<'a> {
    /// Of a neckline: it follows the skin.
    Collar(&'a Skin),
    /// Of straps, trousers and shoes: narrow.
    Binding,
    /// Of sleeves, tops and skirts.
    Hem,
}

/// A point of the surface that a band follows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    position: Vec3,
    normal: Vec3,
    /// Unit direction along the surface, away from the garment.
    out: Vec3,
}

/// Appends a band to the edges of a garment; `band` chooses it by the vertices of an edge.
pub fn sew_bands<'a>(garment: &SubdivisionSurface, band: impl Fn(&[u32]) -> Option<Band<'a>>) -> SubdivisionSurface {
    let mut mesh = garment.mesh.clone();
    let normals = mesh.normals();
    for edge in garment.border_loops() {
        let Some(band) = band(&edge) else { continue };
        let starts = edge_frames(&mesh, &normals, &edge, band);
        for (vertex, start) in edge.iter().zip(&starts) {
            mesh.positions[*vertex as usize] = start.position;
        }
        let frames: Vec<_> = starts.into_iter().map(|start| laid_out(start, band)).collect();
        add_rings(&mut mesh, &edge, &frames, band.width_m());
    }
    SubdivisionSurface::new(mesh)
}

impl Band<'_> {
    fn width_m(self) -> f32 {
        match self {
            Band::Collar(_) => COLLAR_WIDTH_M,
            Band::Binding => BINDING_WIDTH_M,
            Band::Hem => HEM_WIDTH_M,
        }
    }
}

/// Returns the frames of a band at the vertices of an edge, smoothed along it.
fn edge_frames(mesh: &QuadMesh, normals: &[Vec3], edge: &[u32], band: Band) -> Vec<Frame> {
    let count = edge.len();
    let positions: Vec<Vec3> = edge.iter().map(|&v| mesh.positions[v as usize]).collect();
    let outs = (0..count).map(|i| {
        let along = positions[(i + 1) % count] - positions[(i + count - 1) % count];
        along.cross(normals[edge[i] as usize])
    });
    let averaging = || std::iter::repeat_n(2.0 / 3.0, DIRECTION_ROUNDS);
    let outs = smoothed(outs.collect(), averaging());
    let normals = smoothed(edge.iter().map(|&v| normals[v as usize]).collect(), averaging());
    let frame = |((position, normal), out): ((Vec3, Vec3), Vec3)| {
        let normal = normal.normalize_or_zero();
        Frame { position, normal, out: out.reject_from(normal).normalize_or_zero() }
    };
    let factors = SMOOTHING.into_iter().cycle().take(2 * POSITION_ROUNDS);
    let mut smooth = smoothed(positions.clone(), factors);
    if band == Band::Hem {
        let faired = low_pass(&positions, HEM_HARMONICS);
        smooth.iter_mut().zip(faired).for_each(|(position, faired)| position.y = faired.y);
    }
    smooth.into_iter().zip(normals).zip(outs).map(frame).collect()
}

/// Returns vectors along a closed line after each was moved by these factors, in turns, towards the mean of its two
/// neighbours.
fn smoothed(mut vectors: Vec<Vec3>, factors: impl Iterator<Item = f32>) -> Vec<Vec3> {
    let count = vectors.len();
    for factor in factors {
        let mean = |i: usize| (vectors[(i + count - 1) % count] + vectors[(i + 1) % count]) / 2.0;
        vectors = (0..count).map(|i| vectors[i].lerp(mean(i), factor)).collect();
    }
    vectors
}

/// Returns the frames from a vertex of an edge to the end of its band.
fn laid_out(start: Frame, band: Band) -> [Frame; STEPS + 1] {
    let mut frames = [start; STEPS + 1];
    let first_height = match band {
        Band::Collar(skin) => skin.height(start.position).map_or(0.0, |(height, _)| height),
        _ => 0.0,
    };
    for step in 1..=STEPS {
        let mut frame = frames[step - 1];
        frame.position += frame.out * (band.width_m() / STEPS as f32);
        if let Band::Collar(skin) = band
            && let Some((height, normal)) = skin.height(frame.position)
        {
            let t = step as f32 / STEPS as f32;
            frame.position += normal * (first_height + (RIM_HEIGHT_M - first_height) * t - height);
            frame.normal = normal;
            frame.out = (frame.position - frames[step - 1].position).reject_from(normal).normalize_or_zero();
        }
        frames[step] = frame;
    }
    frames
}

/// Appends the quads of a band along an edge.
fn add_rings(mesh: &mut QuadMesh, edge: &[u32], frames: &[[Frame; STEPS + 1]], width_m: f32) {
    let middle = [width_m / 2.0, SEAM[SEAM.len() - 1][1]];
    let rim = RIM.map(|[to_end, height]| [width_m - to_end, height]);
    let profile: Vec<[f32; 2]> = SEAM.into_iter().chain([middle]).chain(rim).collect();
    let count = edge.len() as u32;
    let first = mesh.positions.len() as u32;
    for &[distance, height] in &profile {
        let at = distance / width_m * STEPS as f32;
        let step = (at as usize).min(STEPS - 1);
        for frames in frames {
            let (a, b, t) = (frames[step], frames[step + 1], at - step as f32);
            mesh.positions.push(a.position.lerp(b.position, t) + a.normal.lerp(b.normal, t) * height);
        }
    }
    let part = mesh.parts.first().copied().unwrap_or_default();
    for ring in 0..profile.len() as u32 {
        for i in 0..count {
            let next = (i + 1) % count;
            let of = |ring: u32, i: u32| first + ring * count + i;
            let inner = |i: u32| if ring == 0 { edge[i as usize] } else { of(ring - 1, i) };
            // The garment lies left of its edge
            mesh.quads.push([inner(next), inner(i), of(ring, i), of(ring, next)]);
            let uv = |i: u32, ring: u32| Vec2::new(i as f32 / count as f32, ring as f32 / profile.len() as f32);
            mesh.uvs.push([uv(i + 1, ring), uv(i, ring), uv(i, ring + 1), uv(i + 1, ring + 1)]);
            mesh.parts.push(part);
        }
    }
    if !mesh.values.is_empty() {
        mesh.values.resize(mesh.positions.len(), Vec3::ZERO);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    const RADIUS_M: f32 = 0.08;
    const HEIGHT_M: f32 = 0.1;

    /// An upright tube, open at both ends, seen from outside.
    fn tube() -> SubdivisionSurface {
        const AROUND: u32 = 64;
        const ROWS: u32 = 10;
        let position = |v: u32| {
            let (sin, cos) = (TAU * (v % AROUND) as f32 / AROUND as f32).sin_cos();
            let y = (v / AROUND) as f32 / ROWS as f32 * HEIGHT_M;
            Vec3::new(RADIUS_M * sin, y, RADIUS_M * cos)
        };
        let next = |v: u32| v / AROUND * AROUND + (v + 1) % AROUND;
        SubdivisionSurface::new(QuadMesh {
            positions: (0..AROUND * (ROWS + 1)).map(position).collect(),
            quads: (0..AROUND * ROWS).map(|v| [v, next(v), next(v) + AROUND, v + AROUND]).collect(),
            uvs: vec![[Vec2::ZERO; 4]; (AROUND * ROWS) as usize],
            parts: vec![3; (AROUND * ROWS) as usize],
            ..QuadMesh::default()
        })
    }

    #[test]
    fn a_hem_continues_a_tube_stands_out_and_turns_under() {
        let tube = tube();
        assert_eq!(tube.border_loops().len(), 2);
        let hemmed = sew_bands(&tube, |edge| (edge[0] == 0).then_some(Band::Hem));
        assert_eq!(hemmed.border_loops().len(), 2, "the other end and the inside of the band");
        let (old, mesh) = (tube.mesh.positions.len(), hemmed.mesh);
        let radius = |p: &Vec3| p.with_y(0.0).length();
        let band = || mesh.positions[old..].iter();
        let (low, high) = band().fold((f32::MAX, f32::MIN), |(l, h), p| (l.min(p.y), h.max(p.y)));
        assert!((low + HEM_WIDTH_M).abs() < 2e-4 && high < 0.0, "{low} to {high}");
        let (inner, outer) = band().map(radius).fold((f32::MAX, f32::MIN), |(l, h), r| (l.min(r), h.max(r)));
        assert!((outer - RADIUS_M - 0.0009).abs() < 1e-4, "{outer}");
        assert!((inner - RADIUS_M + 0.0018).abs() < 1e-4, "{inner}");
        // Outwards on the outside, inwards where it is turned under, downwards at the rim
        let normals = mesh.normals();
        for (p, normal) in mesh.positions.iter().zip(&normals).skip(old) {
            let away = normal.dot(p.with_y(0.0).normalize());
            match p.y + HEM_WIDTH_M {
                y if y < 0.0003 => assert!(normal.y < -0.5, "{p} {normal}"),
                y if (0.003..0.012).contains(&y) && radius(p) > RADIUS_M => assert!(away > 0.9, "{p} {normal}"),
                y if y > 0.003 && radius(p) < RADIUS_M - 0.0016 => assert!(away < -0.9, "{p} {normal}"),
                _ => {}
            }
        }
        assert!(mesh.parts.iter().all(|part| *part == 3));
    }

    #[test]
    fn a_hem_is_level_where_the_edge_of_the_garment_is_wavy() {
        const WAVES: u32 = 8;
        let mut tube = tube();
        let lower = tube.border_loops().into_iter().find(|edge| edge[0] == 0).unwrap();
        for (index, &vertex) in (0_u32..).zip(&lower) {
            let phase = TAU * (index * WAVES) as f32 / lower.len() as f32;
            tube.mesh.positions[vertex as usize].y = 0.005 * phase.cos();
        }
        let hemmed = sew_bands(&tube, |edge| (edge[0] == 0).then_some(Band::Hem));
        let highest = lower.iter().map(|&v| hemmed.mesh.positions[v as usize].y.abs()).fold(0.0, f32::max);
        assert!(highest < 0.001, "{highest} m");
    }
}
