//! The tear line: the fillet of tear fluid between the lower lid and the eyeball, whose wet edge shows the lights.
//!
//! Its section is a quarter of a circle that touches the ball and the edge of the lid. Its height of 0.3 mm is typical of
//! healthy eyes. Tears are clear: the colours behind them are those of the white and of the lid's edge.

use super::EYE_RADIUS_M;
use super::body_data::BodyData;
use super::subdivide::QuadMesh;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Radius of the fillet, in radii of the ball.
const RADIUS: f32 = 0.0003 / EYE_RADIUS_M;
/// Steps along the lid, and around the fillet.
const ALONG: usize = 32;
const AROUND: usize = 4;
/// Farthest that the edge of the lid is from its lashes, in radii of the ball.
const LID_EDGE: f32 = 0.3;
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
    let contact = contact_line(&skin_on_ball(skin, to_eye, &lashes), &lashes.lower);
    if contact.len() < 3 {
        return Vec::new();
    }
    let first = mesh.positions.len() as u32;
    let mut colors = Vec::new();
    for (i, &on_ball) in contact.iter().enumerate() {
        let along = contact[(i + 1).min(contact.len() - 1)] - contact[i.saturating_sub(1)];
        let up = on_ball.cross(along).normalize_or(Vec3::Y);
        // It thins out at the corners of the eye
        let t = i as f32 / (contact.len() - 1) as f32;
        let radius = RADIUS * (8.0 * t * (1.0 - t)).clamp(0.05, 1.0);
        let middle = on_ball + (up + on_ball) * radius;
        for k in 0..=AROUND {
            let part = k as f32 / AROUND as f32;
            let (sin, cos) = (part * FRAC_PI_2).sin_cos();
            mesh.positions.push(world_from_eye.transform_point3(middle - (on_ball * cos + up * sin) * radius));
            colors.push(COLORS[0].lerp(COLORS[1], part));
        }
    }
    let ring = AROUND as u32 + 1;
    for i in 0..contact.len() as u32 - 1 {
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
        let height = |points: &[Vec3]| points.iter().map(|p| p.y).sum::<f32>() / points.len().max(1) as f32;
        ["l", "r"].map(|side| {
            let [first, second] = [1, 2].map(|row| {
                let quads = data.quads(&format!("helper-{side}-eyelashes-{row}"));
                quads.iter().flatten().map(|&v| positions[usize::from(v)]).collect::<Vec<_>>()
            });
            let (lower, upper) = if height(&first) < height(&second) { (first, second) } else { (second, first) };
            Lashes { lower, upper }
        })
    }
}

/// Returns the points at which edges of the skin near the lower lashes cross the ball, unit vectors.
fn skin_on_ball(skin: &QuadMesh, to_eye: Affine3A, lashes: &Lashes) -> Vec<Vec3> {
    let nearest = |lashes: &[Vec3], point: Vec3| lashes.iter().map(|l| l.distance(point)).fold(f32::MAX, f32::min);
    let mut points = Vec::new();
    for quad in &skin.quads {
        let corners = quad.map(|v| to_eye.transform_point3(skin.positions[v as usize]));
        if corners[0].length_squared() > 4.0 || corners[0].z < 0.0 {
            continue;
        }
        for k in 0..4 {
            let [a, b] = [corners[k], corners[(k + 1) % 4]];
            let [from, to] = [a.length() - 1.0, b.length() - 1.0];
            if (from < 0.0) != (to < 0.0) {
                let point = a.lerp(b, from / (from - to)).normalize_or_zero();
                let distance = nearest(&lashes.lower, point);
                if distance < LID_EDGE.min(nearest(&lashes.upper, point)) {
                    points.push(point);
                }
            }
        }
    }
    points
}

/// Returns where the lower lid meets the ball from one corner of the eye to the other, in the order of X, unit vectors.
fn contact_line(points: &[Vec3], lashes: &[Vec3]) -> Vec<Vec3> {
    let (low, high) = lashes.iter().fold((f32::MAX, f32::MIN), |(l, h), p| (l.min(p.x), h.max(p.x)));
    let step = (high - low) / ALONG as f32;
    // The highest point of each step
    let highest = |i: usize| {
        let from = low + i as f32 * step;
        let inside = points.iter().filter(|p| (from..from + step).contains(&p.x));
        inside.max_by(|a, b| a.y.total_cmp(&b.y)).copied()
    };
    let mut line: Vec<Vec3> = (0..ALONG).filter_map(highest).collect();
    for _ in 0..SMOOTHING_ROUNDS {
        let last = line.len().saturating_sub(1);
        let mean = |i: usize| (line[i.saturating_sub(1)] + line[i] + line[(i + 1).min(last)]).normalize_or_zero();
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

    /// The fillet has the light of a lid below it and the ball behind it: it is thin, closed to both and wide as the eye.
    #[test]
    fn tear_lines_lie_on_the_ball_and_end_at_the_lower_lid() {
        for ready in READY {
            let figure = ready.figure();
            let mesh = build(&figure).fine;
            let vertices = |name: &str| {
                let part = mesh.parts.iter().find(|part| part.name == name).unwrap();
                mesh.triangles[part.triangles.start as usize..part.triangles.end as usize].iter().flatten()
            };
            let skin: Vec<Vec3> = vertices("skin").map(|&v| mesh.positions[v as usize]).collect();
            let data = BodyData::shipped();
            for eye in PosedBody::new(data, &figure).eyeballs(data, &without_gaze(&figure)) {
                let (to_eye, ahead) = (eye.inverse(), eye.transform_vector3(Vec3::Z).normalize());
                let local = |v: &u32| to_eye.transform_point3(mesh.positions[*v as usize]);
                // Off the ball, unlike all of the white
                let tears: Vec<&u32> =
                    vertices("eyes").filter(|v| (1.001..1.0 + 2.0 * RADIUS).contains(&local(v).length())).collect();
                assert!(tears.len() > 200, "{}: {} vertices", ready.name, tears.len());
                let (low, high) =
                    tears.iter().map(|v| local(v).x).fold((f32::MAX, f32::MIN), |(l, h), x| (l.min(x), h.max(x)));
                assert!(high - low > 1.2, "{}: from {low} to {high} radii", ready.name);
                for vertex in tears {
                    let (point, normal) = (mesh.positions[*vertex as usize], mesh.normals[*vertex as usize]);
                    let to_skin = skin.iter().map(|p| p.distance(point)).fold(f32::MAX, f32::min);
                    assert!(to_skin < 0.0025, "{}: {to_skin} m from the lid", ready.name);
                    assert!(normal.dot(ahead) > -0.3, "{}: {normal}", ready.name);
                }
            }
        }
    }
}
