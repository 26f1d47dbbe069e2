//! The tear line: the fillet of tear fluid between the lower lid and the eyeball, whose wet edge shows the lights.
//!
//! Where the lid touches the ball its section is a quarter of a circle that touches both, 0.3 mm high, which is typical of
//! healthy eyes; where the lid of the body data stands off it is an ellipse that bridges the gap. Tears are clear: the
//! colours behind them are those of the white and of the lid's edge.

use super::body_data::BodyData;
use super::eyes::BALL_M;
use super::subdivide::QuadMesh;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Radius of the fillet, in radii of the ball.
const RADIUS: f32 = 0.0003 / BALL_M;
/// Steps along the lid, and around the fillet.
const ALONG: usize = 20;
const AROUND: usize = 4;
/// How much higher on the ball the fillet is where the lid stands off, as a part of the gap.
const RISE: f32 = 0.25;
/// Farthest that the edge of the lid is from its lashes, and its greatest slope towards the ball, in radii of the ball.
const LID_EDGE: f32 = 0.3;
const SLOPE: f32 = 0.03;
/// Rounds in which neighbours along the lid are averaged.
const SMOOTHING_ROUNDS: usize = 3;
/// Colours of the fillet at the ball and at the lid, factors of the colour of the white.
const COLORS: [Vec3; 2] = [Vec3::new(0.95, 0.88, 0.85), Vec3::new(0.85, 0.55, 0.48)];

/// Appends the tear line of an eye, and returns the colours of its vertices. `world_from_eye` takes a ball of radius 1,
/// in a face that looks along +Z, to its place.
pub fn add_tear_line(
    mesh: &mut QuadMesh,
    skin: &QuadMesh,
    world_from_eye: Affine3A,
    lashes: &Lashes,
    part: u8,
) -> Vec<Vec3> {
    let to_eye = world_from_eye.inverse();
    let on_ball = |points: &[Vec3]| points.iter().map(|p| to_eye.transform_point3(*p).normalize_or_zero()).collect();
    let lashes = Lashes { lower: on_ball(&lashes.lower), upper: on_ball(&lashes.upper) };
    let line = lid_edge(&skin_by_lashes(skin, to_eye, &lashes), &lashes.lower);
    let Some(last) = line.len().checked_sub(1).filter(|last| *last > 1) else { return Vec::new() };
    let first = mesh.positions.len() as u32;
    let mut colors = Vec::new();
    for (i, &lid) in line.iter().enumerate() {
        // The point of the ball behind the lid's edge, and the fillet's axes from there: up the ball and to the lid
        let on_ball = lid.with_z((1.0 - lid.truncate().length_squared()).max(0.0).sqrt()).normalize_or(Vec3::Z);
        let gap = lid.distance(on_ball);
        let along = line[(i + 1).min(last)] - line[i.saturating_sub(1)];
        // It thins out at the corners of the eye
        let t = i as f32 / last as f32;
        let height = (RADIUS + RISE * gap) * (8.0 * t * (1.0 - t)).clamp(0.05, 1.0);
        let up = on_ball.cross(along).normalize_or(Vec3::Y) * height;
        let outwards = (lid - on_ball).normalize_or(on_ball) * gap.max(RADIUS);
        for k in 0..=AROUND {
            let share = k as f32 / AROUND as f32;
            let (sin, cos) = (share * FRAC_PI_2).sin_cos();
            let point = on_ball + up * (1.0 - sin) + outwards * (1.0 - cos);
            mesh.positions.push(world_from_eye.transform_point3(point));
            colors.push(COLORS[0].lerp(COLORS[1], share));
        }
    }
    let ring = AROUND as u32 + 1;
    for i in 0..last as u32 {
        for k in 0..AROUND as u32 {
            let at = |i: u32, k: u32| first + i * ring + k;
            mesh.quads.push([at(i, k + 1), at(i + 1, k + 1), at(i + 1, k), at(i, k)]);
            let uv = |i: u32, k: u32| Vec2::new(i as f32 / ALONG as f32, k as f32 / AROUND as f32);
            mesh.uvs.push([uv(i, k + 1), uv(i + 1, k + 1), uv(i + 1, k), uv(i, k)]);
            mesh.parts.push(part);
        }
    }
    colors
}

/// The places of the roots of an eye's lashes.
#[derive(Clone, Debug, PartialEq)]
pub struct Lashes {
    lower: Vec<Vec3>,
    upper: Vec<Vec3>,
}

impl Lashes {
    /// Returns the lashes of the left and right eye, at the strips that the body data mark them by.
    pub fn of_both_eyes(data: &BodyData, positions: &[Vec3]) -> [Lashes; 2] {
        ["l", "r"].map(|side| {
            let place = |quads: &[[u16; 4]]| quads.iter().flatten().map(|&v| positions[usize::from(v)]).collect();
            let [lower, upper] = data.lash_quads(side).map(place);
            Lashes { lower, upper }
        })
    }
}

/// Returns the vertices of the skin in front of the ball that lie by the lower lashes rather than by the upper ones, in
/// the frame of the eye.
fn skin_by_lashes(skin: &QuadMesh, to_eye: Affine3A, lashes: &Lashes) -> Vec<Vec3> {
    let nearest = |lashes: &[Vec3], point: Vec3| lashes.iter().map(|l| l.distance(point)).fold(f32::MAX, f32::min);
    let points = skin.positions.iter().map(|p| to_eye.transform_point3(*p));
    let before_ball = points.filter(|p| p.z > 0.0 && (1.0..2.25).contains(&p.length_squared()));
    let is_near = |p: &Vec3| {
        let distance = nearest(&lashes.lower, p.normalize());
        distance < LID_EDGE && distance < nearest(&lashes.upper, p.normalize())
    };
    before_ball.filter(is_near).collect()
}

/// Returns the inner edge of the lower lid from one corner of the eye to the other, in the order of X: of what is highest,
/// the points nearest to the ball.
fn lid_edge(points: &[Vec3], lashes: &[Vec3]) -> Vec<Vec3> {
    let (low, high) = lashes.iter().fold((f32::MAX, f32::MIN), |(l, h), p| (l.min(p.x), h.max(p.x)));
    let step = (high - low) / ALONG as f32;
    let inner = |i: usize| {
        let from = low + i as f32 * step;
        let inside = || points.iter().filter(|p| (from..from + step).contains(&p.x));
        let top = inside().map(|p| p.y).fold(f32::MIN, f32::max);
        inside().filter(|p| p.y > top - SLOPE).min_by(|a, b| a.length().total_cmp(&b.length())).copied()
    };
    let mut line: Vec<Vec3> = (0..ALONG).filter_map(inner).collect();
    for _ in 0..SMOOTHING_ROUNDS {
        let last = line.len().saturating_sub(1);
        let mean = |i: usize| (line[i.saturating_sub(1)] + line[i] + line[(i + 1).min(last)]) / 3.0;
        line = (0..line.len()).map(mean).collect();
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::gaze::without_gaze;
    use crate::figures::posed_body::PosedBody;
    use crate::figures::{READY, build};

    #[test]
    fn tear_lines_lie_on_the_ball_and_end_at_the_lower_lid() {
        for ready in READY {
            let figure = ready.figure();
            let mesh = build(&figure).fine;
            let vertices = |name: &str| {
                let part = mesh.parts.iter().find(|part| part.name == name).unwrap();
                mesh.triangles[part.triangles.start as usize..part.triangles.end as usize].iter().flatten()
            };
            let data = BodyData::shipped();
            for eye in PosedBody::new(data, &figure).eyeballs(data, &without_gaze(&figure)) {
                let (to_eye, ahead) = (eye.inverse(), eye.transform_vector3(Vec3::Z).normalize());
                let local = |v: &u32| to_eye.transform_point3(mesh.positions[*v as usize]);
                let around = vertices("skin").filter(|v| local(v).length() < 3.0);
                let lids: Vec<Vec3> = around.map(|&v| mesh.positions[v as usize]).collect();
                // Off the ball, unlike all of the white
                let tears: Vec<&u32> = vertices("eyes").filter(|v| (1.001..1.5).contains(&local(v).length())).collect();
                assert!(tears.len() > 100, "{}: {} corners of triangles", ready.name, tears.len());
                let (low, high) =
                    tears.iter().map(|v| local(v).x).fold((f32::MAX, f32::MIN), |(l, h), x| (l.min(x), h.max(x)));
                assert!(high - low > 1.0, "{}: from {low} to {high} radii", ready.name);
                for vertex in tears {
                    let (point, normal) = (mesh.positions[*vertex as usize], mesh.normals[*vertex as usize]);
                    let to_lid = lids.iter().map(|p| p.distance(point)).fold(f32::MAX, f32::min);
                    assert!(to_lid < 0.003, "{}: {to_lid} m from the lid", ready.name);
                    assert!(normal.dot(ahead) > -0.3, "{}: {normal}", ready.name);
                }
            }
        }
    }
}
