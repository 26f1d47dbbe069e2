//! The face. Units and frame as in `head`.

use super::field::PrimitiveGroup;
use super::primitive::{Almond, Primitive};
use super::proportions::FaceShape;
use glam::{Mat3, Vec3, vec3};

/// Radius of an eyeball, head units.
pub const EYE_RADIUS: f32 = 12.2;

/// Returns the centre of the eye at +X, head units.
pub fn eye_center(f: &FaceShape) -> Vec3 {
    vec3(31.5, 0.0, 71.5 + f.eye_forward)
}

/// Axis weights of strokes on the face: nearly independent of depth.
const ON_FACE: Vec3 = Vec3::new(1.0, 1.0, 0.45);

pub(super) fn add_face(g: &mut PrimitiveGroup, f: &FaceShape) {
    add_cheeks(g, f);
    add_sockets(g, f);
    add_nose(g, f);
    add_mouth(g, f);
    add_eyelids(g, f);
}

fn add_cheeks(g: &mut PrimitiveGroup, f: &FaceShape) {
    // Cheekbone, from under the eye to the arch before the ear.
    g.cone(vec3(38.0, -26.0, 66.0), 13.0, vec3(60.0, -22.0, 32.0), 8.0, 22.0);
    g.cone(vec3(60.0, -22.0, 32.0), 6.5, vec3(65.0, -16.0, 4.0), 5.0, 18.0);
    g.cone(vec3(47.0, -40.0, 52.0), 15.0 * f.fullness, vec3(56.0, -40.0, 16.0), 11.0 * f.fullness, 26.0);
    g.brush(&[vec3(42.0, -24.0, 74.0), vec3(58.0, -20.0, 50.0)], 24.0, 2.5 * f.cheek, Vec3::ONE);
    // The hollow under it.
    g.brush(&[vec3(46.0, -56.0, 60.0), vec3(54.0, -48.0, 40.0)], 26.0, -2.5 * f.hollow, Vec3::ONE);
}

fn add_sockets(g: &mut PrimitiveGroup, f: &FaceShape) {
    // Brow ridge.
    g.cone(vec3(8.0, 15.0, 82.0), 10.0, vec3(30.0, 20.0, 80.0), 9.0, 18.0);
    g.cone(vec3(30.0, 20.0, 80.0), 9.0, vec3(50.0, 13.0, 60.0), 8.0, 18.0);
    g.brush(&[vec3(8.0, 16.0, 92.0), vec3(28.0, 21.0, 90.0), vec3(46.0, 17.0, 78.0)], 15.0, f.brow, ON_FACE);
    // Socket.
    let socket = Mat3::from_rotation_y(0.35);
    g.cut(Primitive::Ellipsoid { center: vec3(32.0, 0.5, 91.0), axes: socket, radii: vec3(20.0, 14.0, 14.0) }, 13.0);
    g.brush(&[vec3(15.0, -2.0, 84.0), vec3(17.0, 6.0, 84.0)], 11.0, -2.0, ON_FACE);
}

fn add_nose(g: &mut PrimitiveGroup, f: &FaceShape) {
    let n = f.nose;
    // Pyramid, then the bridge on it.
    g.cone(vec3(0.0, -2.0, 80.0), 9.0, vec3(0.0, -40.0, 88.0), 15.0 * f.nose_width, 12.0);
    g.cone(vec3(0.0, 4.0, 85.5), 6.0, vec3(0.0, -22.0, 85.5 + 14.5 * n), 6.5, 9.0);
    g.cone(vec3(0.0, -22.0, 85.5 + 14.5 * n), 6.5, vec3(0.0, -38.0, 86.0 + 23.0 * n), 8.0, 8.0);
    // Tip.
    g.ball(vec3(0.0, -41.0, 87.0 + 24.0 * n), vec3(9.0, 8.2, 9.5), 7.0);
    // Wings.
    let wing = Mat3::from_rotation_y(-0.25);
    g.add(
        Primitive::Ellipsoid {
            center: vec3(11.5 * f.nose_width, -44.5, 88.0 + 10.5 * n),
            axes: wing,
            radii: vec3(6.0, 7.2, 11.0),
        },
        5.0,
    );
    // Column between the nostrils.
    g.cone(vec3(0.0, -48.0, 87.0 + 23.0 * n), 4.0, vec3(0.0, -53.0, 96.0), 4.5, 5.0);
    let nostril = Mat3::from_rotation_y(0.45);
    g.cut(
        Primitive::Ellipsoid {
            center: vec3(7.2 * f.nose_width, -52.0, 88.0 + 16.5 * n),
            axes: nostril,
            radii: vec3(3.2, 4.5, 6.0),
        },
        2.5,
    );
    // Groove behind the wing.
    let w = f.nose_width;
    g.brush(
        &[vec3(13.0 * w, -36.0, 100.0), vec3(18.5 * w, -42.0, 95.0), vec3(18.0 * w, -50.0, 92.0)],
        5.0,
        -1.3,
        ON_FACE,
    );
}

fn add_mouth(g: &mut PrimitiveGroup, f: &FaceShape) {
    let l = f.lips;
    // The round of the teeth.
    g.ball(vec3(0.0, -70.0, 70.0), vec3(31.0, 22.0, 30.0), 18.0);
    // Upper lip with its bow, lower lip; both run out into the corners.
    let w = f.mouth;
    let upper = vec![
        (vec3(0.0, -66.6, 97.6), 4.9 * l),
        (vec3(6.0 * w, -65.8, 97.6), 5.2 * l),
        (vec3(14.0 * w, -67.6, 94.6), 4.2 * l),
        (vec3(24.0 * w, -71.0, 86.0), 1.8),
    ];
    let lower = vec![
        (vec3(0.0, -76.6, 95.5), 5.8 * l),
        (vec3(8.0 * w, -76.4, 95.0), 5.6 * l),
        (vec3(16.0 * w, -74.8, 91.5), 3.9 * l),
        (vec3(24.0 * w, -71.8, 86.0), 1.8),
    ];
    g.add(Primitive::Tube(upper), 4.0);
    g.add(Primitive::Tube(lower), 4.0);
    // Line of the mouth, and its corners.
    let line = [
        vec3(0.0, -71.6, 101.0),
        vec3(6.0 * w, -71.0, 100.5),
        vec3(14.0 * w, -71.3, 97.0),
        vec3(23.0 * w, -71.6, 89.5),
    ];
    g.brush(&line, 3.0, -1.7, ON_FACE);
    g.brush(&[vec3(24.5 * w, -71.8, 88.0), vec3(26.5 * w, -72.5, 86.0)], 6.0, -1.6, ON_FACE);
    // Philtrum with its two ridges.
    g.brush(&[vec3(0.0, -57.5, 100.0), vec3(0.0, -62.5, 102.0)], 4.5, -1.1, ON_FACE);
    g.brush(&[vec3(4.6, -58.0, 100.0), vec3(5.6, -62.5, 101.0)], 3.6, 0.7, ON_FACE);
    // Fold over the chin, fold beside the nose.
    g.brush(&[vec3(0.0, -87.5, 96.0), vec3(12.0, -86.0, 93.0)], 11.0, -2.6, ON_FACE);
    g.brush(&[vec3(21.0, -48.0, 90.0), vec3(29.0, -60.0, 86.0), vec3(33.0, -69.0, 82.0)], 9.0, -f.age, ON_FACE);
}

fn add_eyelids(g: &mut PrimitiveGroup, f: &FaceShape) {
    let eye = eye_center(f);
    // Lids: a shell round the ball.
    g.add(Primitive::ball(eye, Vec3::splat(EYE_RADIUS + 1.9)), 6.0);
    // Crease of the upper lid.
    let crease = [
        vec3(18.0, 3.0, 80.0),
        vec3(24.0, 8.3, 83.0),
        vec3(32.0, 10.0, 84.0),
        vec3(40.0, 8.5, 80.0),
        vec3(47.0, 3.0, 72.0),
    ];
    g.brush(&crease, 3.2, -1.5, ON_FACE);
    // The slit.
    let slit = Almond {
        center: eye + vec3(0.3, 0.2, 0.0),
        half_length: 13.9,
        rise: 4.8 * f.eye_open,
        fall: 4.2 * f.eye_open,
        tilt: 0.07,
        peak: -0.15,
        back: eye.z + 2.5,
    };
    g.cut(Primitive::Almond(slit), 1.6);
}
