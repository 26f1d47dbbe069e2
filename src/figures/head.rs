//! The head, in head units: millimetres of a head 230 mm high, origin between the eyes, +Z forwards, +Y up. One half is
//! modelled and mirrored. Landmarks follow mean adult head measurements.

use super::face::add_face;
use super::field::{Join, PrimitiveGroup};
use super::primitive::Primitive;
use super::proportions::FaceShape;
use glam::{Affine3A, Mat3, Vec3, vec3};

/// Height of the head, chin to crown, head units.
pub const HEAD_UNITS: f32 = 230.0;

/// Builds the head. `height_m` is its height from chin to crown, metres.
pub fn head(world_from_head: Affine3A, height_m: f32, face: &FaceShape) -> PrimitiveGroup {
    let scale = height_m / HEAD_UNITS;
    let mut group = PrimitiveGroup::new(world_from_head, scale, Join::even(0.03)).mirrored();
    add_skull(&mut group, face);
    add_face(&mut group, face);
    add_ear(&mut group, face);
    group
}

fn add_skull(g: &mut PrimitiveGroup, f: &FaceShape) {
    // Cranium: a broad back, a narrower forehead.
    g.ball(vec3(0.0, 36.0, -18.0), vec3(75.0 * f.skull, 79.0, 80.0), 0.0);
    g.ball(vec3(0.0, 32.0, 28.0), vec3(63.0 * f.skull, 72.0, 66.0), 40.0);
    // The face below it, down to the upper jaw.
    g.ball(vec3(0.0, -28.0, 36.0), vec3(56.0, 66.0, 56.0), 34.0);
    g.ball(vec3(0.0, -66.0, 52.0), vec3(37.0, 42.0, 43.0), 26.0);
    // Lower jaw: from its angle under the ear to the chin, and the rising branch behind the cheek.
    let angle = vec3(50.0 * f.jaw, -68.0, 4.0);
    g.cone(angle, 10.0, vec3(17.0 * f.jaw, -97.0 + f.chin_lift, 72.0), 14.0, 24.0);
    g.cone(angle, 10.0, vec3(58.0, -22.0, 2.0), 12.0, 24.0);
    g.ball(vec3(0.0, -98.0 + f.chin_lift, 77.0 + f.chin), vec3(21.0 * f.jaw, 16.0, 18.0), 20.0);
    // The floor of the mouth, where jaw and neck meet.
    g.cone(vec3(0.0, -88.0, 52.0), 14.0, vec3(0.0, -78.0, 5.0), 34.0, 24.0);
    // Cheeks.
    g.ball(vec3(36.0, -52.0, 38.0), vec3(21.0, 30.0, 30.0) * f.fullness, 24.0);
    g.cone(vec3(57.0, -26.0, 20.0), 9.0, angle + vec3(-4.0, 4.0, 6.0), 9.0, 20.0);
    // Temples.
    g.brush(&[vec3(66.0, 30.0, 42.0), vec3(68.0, 12.0, 36.0)], 34.0, -2.5, Vec3::ONE);
}

/// Ear: a shell in its own plane, the back edge standing off the head.
fn add_ear(g: &mut PrimitiveGroup, f: &FaceShape) {
    // Columns: towards the back of the head, up along the ear, out of its plane.
    let (flare, lean) = (0.42_f32, 0.2_f32);
    let out = vec3(flare.cos(), 0.0, flare.sin());
    let back = vec3(flare.sin(), 0.0, -flare.cos());
    let up = vec3(0.0, lean.cos(), 0.0) + back * lean.sin();
    let back = up.cross(out).normalize() * -1.0;
    let back = if back.z > 0.0 { -back } else { back };
    let size = f.ear;
    let place = |u: f32, w: f32, n: f32| vec3(71.0 * f.skull, -19.0, -9.0) + (back * u + up * w + out * n) * size;
    let axes = Mat3::from_cols(back, up, back.cross(up));
    let ball = |c: Vec3, r: Vec3| Primitive::Ellipsoid { center: c, axes, radii: r * size };
    // Plate and lobe.
    let tilt = 0.3_f32;
    let (plate_back, plate_out) = (back * tilt.cos() + out * tilt.sin(), out * tilt.cos() - back * tilt.sin());
    let plate = Mat3::from_cols(plate_back, up, plate_out);
    g.add(Primitive::Ellipsoid { center: place(5.0, 6.0, 3.2), axes: plate, radii: vec3(17.0, 27.0, 4.2) * size }, 5.0);
    g.add(ball(place(-1.0, -23.0, 2.5), vec3(7.5, 9.0, 3.8)), 5.0);
    // Helix: the rolled rim, from the crus round the top to the lobe.
    let rim: Vec<(Vec3, f32)> = [
        (-5.0, 0.0, 3.5, 2.0),
        (-10.0, 8.0, 4.0, 2.4),
        (-9.5, 18.0, 5.0, 2.7),
        (-4.0, 27.0, 6.0, 2.8),
        (4.0, 31.5, 7.0, 2.8),
        (13.0, 29.0, 8.0, 2.8),
        (19.0, 21.0, 8.8, 2.7),
        (21.0, 10.0, 9.0, 2.6),
        (19.0, -2.0, 8.2, 2.5),
        (14.0, -12.0, 6.8, 2.3),
        (7.0, -21.0, 5.0, 2.6),
    ]
    .iter()
    .map(|&(u, w, n, r)| (place(u, w, n), r * size))
    .collect();
    g.add(Primitive::Tube(rim), 3.0);
    // The bowl in front of the canal, then the ridge between bowl and rim.
    g.cut(ball(place(0.5, -4.0, 10.0), vec3(8.5, 11.5, 8.0)), 3.0);
    let ridge: Vec<(Vec3, f32)> = [
        (3.0, -16.0, 4.5, 2.6),
        (9.5, -9.0, 6.0, 2.4),
        (11.5, 1.0, 7.0, 2.4),
        (9.5, 11.0, 7.0, 2.3),
        (3.0, 19.0, 5.8, 2.0),
    ]
    .iter()
    .map(|&(u, w, n, r)| (place(u, w, n), r * size))
    .collect();
    g.add(Primitive::Tube(ridge), 3.0);
    // Tragus, and the knob across from it.
    g.add(ball(place(-10.0, -5.5, 4.5), vec3(3.2, 5.5, 3.6)), 4.0);
    g.add(ball(place(1.0, -16.5, 5.5), vec3(4.0, 3.0, 3.0)), 3.0);
}
