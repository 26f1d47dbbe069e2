//! Clothes: patches of the base mesh's helper meshes, cut at the edges of garments, fitted to the body and draped as cloth.

use super::bands::{Band, sew_bands};
use super::body_data::BodyData;
use super::cloth::Cloth;
use super::patch::{Patch, Skin};
use super::posed_body::PosedBody;
use super::regions::{Clothes, Edges, Garment, Place};
use super::skin_colors::NO_SKIN;
use super::subdivide::{QuadMesh, SubdivisionSurface};
use crate::scene::{Bottom, Figure, Top};
use glam::Vec3;
use rayon::prelude::*;

/// Distances of a collar and of straps from the cage of the skin, metres.
const COLLAR_M: f32 = 0.007;
const STRAP_M: f32 = 0.002;
/// Distance from where a garment is held at which it moves freely, metres.
const FREE_M: f32 = 0.04;

/// Returns the garments of a figure in its pose, subdivided once, with the part of each.
pub fn dress(
    data: &BodyData,
    figure: &Figure,
    body: &PosedBody,
    part: impl Fn(Garment) -> u8 + Sync,
) -> SubdivisionSurface {
    let neck = shoulders(data, figure.top, &body.positions).subdivided_skin();
    let worn = |garment: &Garment| {
        let fitted = |positions| fitted(data, figure, body, *garment, positions);
        let coarse = SubdivisionSurface::new(fitted(&body.positions));
        let mut surface = coarse.subdivided();
        if *garment != Garment::Shoe {
            let rest = &coarse.subdivided_positions(&fitted(&body.rest).positions);
            let mobility: Vec<f32> = surface.mesh.values.iter().map(|value| value.x).collect();
            let support_m = figure.pose.seat_m.unwrap_or(0.0);
            surface.mesh.positions = Cloth { fitted: &surface, rest, mobility: &mobility, support_m }.draped();
        }
        surface.mesh.parts.fill(part(*garment));
        let mut surface = sew_bands(&surface, |edge| band_of(&surface, edge, *garment, Clothes::new(figure), &neck));
        surface.mesh.values.fill(NO_SKIN);
        surface
    };
    let mut clothes = SubdivisionSurface::new(QuadMesh::default());
    for surface in [Garment::Top, Garment::Bottom, Garment::Shoe].par_iter().map(worn).collect::<Vec<_>>() {
        clothes.append(&surface);
    }
    clothes
}

/// Returns a garment as it fits the body whose vertices have these positions, before subdivision. Its values are its
/// mobility (0 where it is held, 1 where it is free), its nearness to an edge that lies close, and 1 by the cut of a bust
/// and by an edge that is tucked in.
fn fitted(data: &BodyData, figure: &Figure, body: &PosedBody, garment: Garment, positions: &[Vec3]) -> QuadMesh {
    let (edges, clothes) = (Edges::shipped(), Clothes::new(figure));
    let is_skirt = garment == Garment::Bottom && clothes.bottom.hangs_from_waist();
    let group = if is_skirt { "helper-skirt" } else { "helper-tights" };
    let field = |v: u16| match garment {
        Garment::Bottom => edges.bottom(v, clothes.bottom),
        Garment::Top => edges.top(v, clothes),
        Garment::Shoe => edges.shoe(v),
    };
    let inside = |quad: &[u16; 4]| body.has(quad) && quad.iter().any(|&v| field(v) > 0.0);
    let mut patch = Patch::new(data, group, positions, &inside).cut(&|v| field(v).min(body.above_cut(v)));
    if garment == Garment::Top {
        patch.fill_hollows(&|v| edges.spans_hollows(v, clothes));
        patch.fair_edges(&|v| edges.nearness_to_close_edge(v, clothes.top) > 0.5);
    }
    let shins = shins(data, positions);
    patch.move_by(&|v, normal| {
        let looseness_m =
            edges.looseness(v, garment, clothes) * (1.0 - edges.lies_closer(v, garment) * normal.y.max(0.0));
        match edges.place(v) {
            // Across the shin: in front of the ankle, normals meet
            Place::Leg(at) if garment == Garment::Bottom && !is_skirt && at > 1.0 => {
                let shin = shins[usize::from(data.positions[usize::from(v)].x < 0.0)];
                normal.reject_from(shin).normalize_or(normal) * looseness_m
            }
            _ => normal * looseness_m,
        }
    });
    // Only the edges of collar and straps lie close: further out the garment hangs from the shoulders
    if garment == Garment::Top {
        let shoulders = shoulders(data, clothes.top, positions).skin();
        let height_m = if clothes.top.has_collar() { COLLAR_M } else { STRAP_M };
        patch.lay_on(&shoulders, height_m, &|v| edges.nearness_to_close_edge(v, clothes.top).powi(8));
    }
    let mobility = |v: u16| {
        let to_hold = edges.to_hold(v, garment, clothes).min(body.above_cut(v));
        (to_hold / FREE_M).clamp(0.0, 1.0)
    };
    let closeness = |v: u16| if garment == Garment::Top { edges.nearness_to_close_edge(v, clothes.top) } else { 0.0 };
    let is_unseen =
        |v: u16| body.above_cut(v) < field(v) || (garment == Garment::Top && edges.is_tucked_in(v, clothes));
    patch.into_mesh(0, &|v| Vec3::new(mobility(v), closeness(v), f32::from(is_unseen(v))))
}

/// Returns the unit vectors from knee to ankle, left and right.
fn shins(data: &BodyData, positions: &[Vec3]) -> [Vec3; 2] {
    let joint = |name: String| data.bone(&name).map_or(Vec3::ZERO, |b| positions[usize::from(data.bones[b].head)]);
    ["L", "R"].map(|side| {
        let [knee, ankle] = ["lowerleg01", "foot"].map(|stem| joint(format!("{stem}.{side}")));
        (ankle - knee).normalize_or(Vec3::NEG_Y)
    })
}

/// Returns the band at an edge of a garment whose values are those of [`fitted`]. None where a bust is cut or the edge is
/// tucked in, and at the waist of trousers and skirts, over which the top hangs.
fn band_of<'a>(
    surface: &SubdivisionSurface,
    edge: &[u32],
    garment: Garment,
    clothes: Clothes,
    neck: &'a Skin,
) -> Option<Band<'a>> {
    let sum = edge.iter().map(|&v| surface.mesh.values[v as usize]).sum::<Vec3>();
    let [mobility, closeness, unseen] = (sum / edge.len() as f32).to_array();
    let (is_unseen, is_held, lies_close) = (unseen > 0.5, mobility < 0.1, closeness > 0.5);
    match garment {
        _ if is_unseen => None,
        Garment::Top if lies_close && clothes.top.has_collar() => Some(Band::Collar(neck)),
        Garment::Top if !lies_close => Some(Band::Hem),
        Garment::Bottom if is_held => None,
        // Trousers bend over the shoes
        Garment::Bottom if clothes.bottom != Bottom::Trousers => Some(Band::Hem),
        _ => Some(Band::Binding),
    }
}

/// Returns the skin below the edges of an upper garment that lie close.
fn shoulders(data: &BodyData, top: Top, positions: &[Vec3]) -> Patch {
    let edges = Edges::shipped();
    Patch::new(data, "body", positions, &|quad| quad.iter().all(|&v| edges.is_near_close_edge(v, top)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::READY;
    use std::collections::BTreeSet;

    /// Returns the garments of the ready figures as they fit, subdivided once, each with a name and its figure.
    fn fitted_garments() -> impl Iterator<Item = (String, Figure, Garment, SubdivisionSurface)> {
        READY.iter().flat_map(|ready| {
            let figure = ready.figure();
            let body = PosedBody::new(BodyData::shipped(), &figure);
            [Garment::Top, Garment::Bottom].map(|garment| {
                let fitted = fitted(BodyData::shipped(), &figure, &body, garment, &body.positions);
                let surface = SubdivisionSurface::new(fitted).subdivided();
                (format!("{}, {garment:?}", ready.name), figure, garment, surface)
            })
        })
    }

    /// Normals of folded garments turn away from those of the fitted ones by more than the few degrees of a garment that
    /// only sags.
    #[test]
    fn garments_of_the_ready_figures_fold_and_move_by_centimetres() {
        let data = BodyData::shipped();
        for (name, figure, garment, SubdivisionSurface { mesh: fitted, .. }) in fitted_garments() {
            let body = PosedBody::new(data, &figure);
            let draped = dress(data, &figure, &body, |other| u8::from(other == garment)).mesh;
            let quads = draped.quads.iter().zip(&draped.parts).filter(|(_, part)| **part == 1).map(|(quad, _)| *quad);
            let first = quads.clone().flatten().min().unwrap() as usize;
            let positions = &draped.positions[first..first + fitted.positions.len()];
            let (before, after) = (fitted.normals(), draped.normals());
            let turns = before.iter().zip(&after[first..]).map(|(a, b)| a.angle_between(*b).to_degrees());
            let turn = turns.sum::<f32>() / before.len() as f32;
            let farthest = positions.iter().zip(&fitted.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            assert!((3.0..25.0).contains(&turn), "{name}: {turn} degrees");
            assert!(farthest < 0.15, "{name}: {farthest} m");
        }
    }

    #[test]
    fn collars_of_the_ready_figures_lie_over_the_skin() {
        let data = BodyData::shipped();
        for ready in READY {
            let figure = ready.figure();
            let body = PosedBody::new(data, &figure);
            let top = SubdivisionSurface::new(fitted(data, &figure, &body, Garment::Top, &body.positions)).subdivided();
            assert_eq!(top.border_loops().len(), 4, "{}: neck, arms and hem", ready.name);
            let skin = shoulders(data, figure.top, &body.positions).subdivided_skin();
            let bands = top.border_loops().into_iter();
            let bands = bands.filter_map(|edge| band_of(&top, &edge, Garment::Top, Clothes::new(&figure), &skin));
            let tucked_in = usize::from(figure.bottom == Bottom::Skirt);
            assert_eq!(bands.count(), 4 - tucked_in, "{}", ready.name);
            let collar = |edge: &[u32]| {
                let band = band_of(&top, edge, Garment::Top, Clothes::new(&figure), &skin);
                band.filter(|band| matches!(band, Band::Collar(_)))
            };
            let first = top.mesh.positions.len();
            let collar = &sew_bands(&top, collar).mesh.positions[first..];
            assert_eq!(collar.is_empty(), figure.top == Top::Straps, "{}", ready.name);
            for position in collar {
                let height = skin.height(*position).map_or(0.0, |(height, _)| height);
                assert!((0.0005..0.015).contains(&height), "{}: {height} m over the skin at {position}", ready.name);
            }
        }
    }

    /// Returns the largest angle between successive vectors of a closed row, degrees.
    fn largest_turn_deg(ways: &[Vec3]) -> f32 {
        let pairs = ways.iter().zip(ways.iter().cycle().skip(1));
        pairs.map(|(a, b)| a.angle_between(*b).to_degrees()).fold(0.0, f32::max)
    }

    /// From the middle of the neckline in front the first quarter of its half width rises a third as much as the second
    /// one, as on a parabola. The cut of the coarse mesh had a corner there, where both rise alike, or was level.
    #[test]
    fn necklines_of_the_ready_figures_are_round_in_front() {
        let data = BodyData::shipped();
        for ready in READY {
            let figure = ready.figure();
            let body = PosedBody::new(data, &figure);
            // At rest a body looks along +Z
            let top = SubdivisionSurface::new(fitted(data, &figure, &body, Garment::Top, &body.rest)).subdivided();
            let lies_close = |edge: &Vec<u32>| edge.iter().all(|&v| top.mesh.values[v as usize].y > 0.5);
            // The longest one: straps have armholes, too
            let neckline = top.border_loops().into_iter().filter(lies_close).max_by_key(Vec::len).unwrap();
            let points: Vec<Vec3> = neckline.iter().map(|&v| top.mesh.positions[v as usize]).collect();
            let height_at = |x: f32| {
                let ends = points.iter().zip(points.iter().cycle().skip(1));
                let crossings = ends.filter(|(a, b)| (a.x > x) != (b.x > x));
                let (a, b) = crossings.max_by(|(a, _), (b, _)| a.z.total_cmp(&b.z)).unwrap();
                a.lerp(*b, (x - a.x) / (b.x - a.x)).y
            };
            let half_width = points.iter().map(|p| p.x).fold(0.0, f32::max);
            let [middle, quarter, half] = [0.0, 0.25, 0.5].map(|part| height_at(part * half_width));
            let ratio = (quarter - middle) / (half - quarter);
            assert!((0.18..0.48).contains(&ratio), "{}: {ratio}", ready.name);
        }
    }

    /// Trousers that stood out through the hem of a top made notches in it.
    #[test]
    fn tops_hang_outside_of_trousers() {
        // The hem is turned under: its inside is some millimetres below its outside
        const DEPTH_M: f32 = 0.003;
        const NEAR_HEM_M: f32 = 0.05;
        let data = BodyData::shipped();
        let hangs = |figure: &Figure| figure.pose.seat_m.is_none() && !figure.bottom.hangs_from_waist();
        for (name, figure) in READY.iter().map(|ready| (ready.name, ready.figure())).filter(|(_, f)| hangs(f)) {
            let body = PosedBody::new(data, &figure);
            let clothes = dress(data, &figure, &body, |garment| garment as u8).mesh;
            let (positions, normals) = (&clothes.positions, clothes.normals());
            let vertices = |wanted: Garment| -> BTreeSet<usize> {
                let quads = clothes.quads.iter().zip(&clothes.parts).filter(|(_, part)| **part == wanted as u8);
                quads.flat_map(|(quad, _)| quad.map(|v| v as usize)).collect()
            };
            let (top, bottom) = (vertices(Garment::Top), vertices(Garment::Bottom));
            let lowest = top.iter().map(|&v| positions[v].y).fold(f32::MAX, f32::min);
            let near_hem: Vec<usize> = top.into_iter().filter(|&v| positions[v].y < lowest + NEAR_HEM_M).collect();
            let depth = |v: usize| {
                let squared = |other: usize| positions[other].distance_squared(positions[v]);
                let nearest = bottom.iter().copied().min_by(|a, b| squared(*a).total_cmp(&squared(*b))).unwrap();
                (positions[nearest] - positions[v]).dot(normals[nearest])
            };
            let inside = near_hem.iter().filter(|&&v| depth(v) > DEPTH_M).count();
            assert!(inside * 40 < near_hem.len(), "{name}: {inside} of {} vertices", near_hem.len());
        }
    }

    /// The border of a cut mesh once ran back and forth, with normals turned inside out: hems had notches. The
    /// hem of a top follows the crease of the back, and its neckline is laid on the skin.
    #[test]
    fn edges_of_lower_garments_and_of_sleeves_are_lines_without_reversals() {
        for (name, figure, garment, surface) in fitted_garments() {
            let (positions, normals) = (&surface.mesh.positions, surface.mesh.normals());
            // Fewer vertices than hem and neckline
            let is_sleeve = |edge: &Vec<u32>| figure.top != Top::Straps && edge.len() < 50;
            for edge in surface.border_loops().iter().filter(|edge| garment == Garment::Bottom || is_sleeve(edge)) {
                let next = edge.iter().cycle().skip(1);
                let sides = edge.iter().zip(next).map(|(a, b)| positions[*b as usize] - positions[*a as usize]);
                let normals: Vec<Vec3> = edge.iter().map(|&v| normals[v as usize]).collect();
                let turns = [&sides.collect::<Vec<_>>(), &normals].map(|ways| largest_turn_deg(ways));
                assert!(turns.iter().all(|turn| *turn < 50.0), "{name}: {turns:?} degrees");
            }
        }
    }
}
