//! Trunk and neck. Shapes are placed where they are on a standing figure and carried along by their bone.

use super::field::{Join, PrimitiveGroup};
use super::primitive::Primitive;
use super::proportions::Build;
use super::skeleton::{Skeleton, rest};
use glam::{Affine3A, Mat3, Vec3, vec3};

/// Puts shapes given in standing coordinates (body units) on a bone, on both sides.
struct Sculptor<'a> {
    group: &'a mut PrimitiveGroup,
    unit: f32,
}

impl Sculptor<'_> {
    fn ball(&mut self, bone: &Affine3A, center: Vec3, radii: Vec3, width: f32) {
        self.tilted(bone, center, radii, Mat3::IDENTITY, width);
    }

    fn tilted(&mut self, bone: &Affine3A, center: Vec3, radii: Vec3, turn: Mat3, width: f32) {
        let axes = Mat3::from(bone.matrix3) * turn;
        let center = bone.transform_point3(center * self.unit);
        self.group.add(Primitive::Ellipsoid { center, axes, radii: radii * self.unit }, width * self.unit);
    }

    /// A pair of ellipsoids, the left one turned by `turn`.
    fn pair(&mut self, bone: &Affine3A, center: Vec3, radii: Vec3, turn: Mat3, width: f32) {
        self.tilted(bone, center, radii, turn, width);
        let flip = Mat3::from_diagonal(vec3(-1.0, 1.0, 1.0));
        self.tilted(bone, center * vec3(-1.0, 1.0, 1.0), radii, flip * turn * flip, width);
    }

    fn cones(&mut self, a: (&Affine3A, Vec3, f32), b: (&Affine3A, Vec3, f32), width: f32) {
        for mirror in [vec3(1.0, 1.0, 1.0), vec3(-1.0, 1.0, 1.0)] {
            let start = a.0.transform_point3(a.1 * mirror * self.unit);
            let end = b.0.transform_point3(b.1 * mirror * self.unit);
            self.group.cone(start, a.2 * self.unit, end, b.2 * self.unit, width * self.unit);
        }
    }

    fn brush(&mut self, bone: &Affine3A, path: &[Vec3], radius: f32, height: f32) {
        let path: Vec<Vec3> = path.iter().map(|p| bone.transform_point3(*p * self.unit)).collect();
        self.group.brush(&path, radius * self.unit, height * self.unit, Vec3::ONE);
    }

    fn brush_pair(&mut self, bone: &Affine3A, path: &[Vec3], radius: f32, height: f32) {
        self.brush(bone, path, radius, height);
        let mirrored: Vec<Vec3> = path.iter().map(|p| *p * vec3(-1.0, 1.0, 1.0)).collect();
        self.brush(bone, &mirrored, radius, height);
    }
}

/// Builds pelvis, belly, chest, shoulders' root and neck.
pub fn torso(s: &Skeleton, b: &Build) -> PrimitiveGroup {
    let mut group = PrimitiveGroup::in_world(Join::even(0.0));
    let mut clay = Sculptor { group: &mut group, unit: s.unit };
    add_trunk(&mut clay, s, b);
    add_chest(&mut clay, s, b);
    add_neck(&mut clay, s, b);
    add_relief(&mut clay, s, b);
    group
}

fn add_trunk(clay: &mut Sculptor, s: &Skeleton, b: &Build) {
    let u = s.unit;
    let (cw, cd) = (0.5 * b.chest_width / u, 0.5 * b.chest_depth / u);
    let (ww, wd) = (0.5 * b.waist_width / u, 0.5 * b.waist_depth / u);
    let hw = 0.5 * b.hip_width / u;
    // Pelvis, and the width of the hips over the leg's joints.
    clay.ball(&s.pelvis, vec3(0.0, 0.975, -0.005), vec3(hw * 0.9, 0.105, wd * 1.0), 0.0);
    clay.pair(&s.pelvis, vec3(hw * 0.52, 0.925, -0.005), vec3(hw * 0.47, 0.105, wd * 0.92), Mat3::IDENTITY, 0.06);
    // Seat.
    let seat = 0.95 + 0.05 * (1.0 - b.muscle);
    clay.pair(
        &s.pelvis,
        vec3(hw * 0.45, 0.9, -0.062),
        vec3(hw * 0.46, 0.085, 0.075) * seat,
        Mat3::from_rotation_x(0.25),
        0.035,
    );
    // Belly, then the cage.
    clay.ball(&s.waist, vec3(0.0, 1.10, 0.004), vec3(ww, 0.15, wd), 0.11);
    clay.ball(&s.waist, vec3(0.0, 1.03, 0.022), vec3(ww * 0.8, 0.10, wd * 0.88), 0.06);
    clay.ball(&s.chest, vec3(0.0, 1.275, -0.008), vec3(cw, 0.185, cd), 0.10);
    clay.ball(&s.chest, vec3(0.0, 1.38, -0.02), vec3(cw * 0.96, 0.085, cd * 0.78), 0.05);
    // Broad back muscles.
    clay.cones(
        (&s.chest, vec3(cw * 0.92, 1.33, -0.045), 0.035 + 0.012 * b.muscle),
        (&s.waist, vec3(ww * 0.68, 1.09, -0.03), 0.035),
        0.05,
    );
}

fn add_chest(clay: &mut Sculptor, s: &Skeleton, b: &Build) {
    let u = s.unit;
    let (cw, cd) = (0.5 * b.chest_width / u, 0.5 * b.chest_depth / u);
    let shoulder = 0.5 * b.shoulder_width / u;
    // Root of the shoulder.
    clay.cones(
        (&s.chest, vec3(shoulder * 0.45, 1.425, -0.02), 0.052),
        (&s.chest, vec3(shoulder * 0.92, 1.425, -0.012), 0.046),
        0.05,
    );
    // Shoulder blades.
    let blade = Mat3::from_rotation_y(0.4);
    clay.pair(&s.chest, vec3(cw * 0.58, 1.345, -cd * 0.83), vec3(0.055, 0.075, 0.025), blade, 0.04);
    // Chest muscles.
    if b.muscle > 0.5 {
        let pec = Mat3::from_rotation_y(0.35) * Mat3::from_rotation_z(0.25);
        let depth = 0.016 + 0.008 * b.muscle;
        clay.pair(&s.chest, vec3(cw * 0.46, 1.345, cd * 0.76), vec3(0.08, 0.058, depth), pec, 0.06);
    }
    if b.bust > 0.0 {
        let r = b.bust / u;
        let turn = Mat3::from_rotation_y(0.3);
        clay.pair(&s.chest, vec3(cw * 0.54, 1.285, cd * 0.78), vec3(r, r * 1.02, r * 0.95), turn, 0.03);
        clay.cones(
            (&s.chest, vec3(cw * 0.5, 1.36, cd * 0.66), 0.03),
            (&s.chest, vec3(cw * 0.55, 1.295, cd * 0.85), 0.04),
            0.04,
        );
    }
}

fn add_neck(clay: &mut Sculptor, s: &Skeleton, b: &Build) {
    let u = s.unit;
    let n = b.neck / u;
    // Points of the head, in standing body units of the neck's bone, through the head's own turn.
    let head_unit = b.head / super::head::HEAD_UNITS;
    let on_head = |p: Vec3| s.head.transform_point3(p * head_unit) / u;
    let root = |p: Vec3| s.neck.transform_point3(p * u) / u;
    let group = &mut *clay.group;
    let mut column = |a: Vec3, ra: f32, b: Vec3, rb: f32, k: f32| {
        group.cone(a * u, ra * u, b * u, rb * u, k * u);
    };
    column(root(vec3(0.0, rest::NECK - 0.03, -0.03)), n * 1.12, on_head(vec3(0.0, -58.0, -20.0)), n, 0.05);
    column(root(vec3(0.0, rest::NECK - 0.005, -0.036)), n * 0.7, on_head(vec3(0.0, -34.0, -37.0)), n * 0.7, 0.03);
    column(root(vec3(0.0, rest::NECK - 0.03, -0.005)), n * 0.72, on_head(vec3(0.0, -80.0, 8.0)), n * 0.62, 0.03);
    // The muscle from behind the ear to the pit of the throat.
    let shoulder = 0.5 * b.shoulder_width / u;
    for side in [1.0, -1.0] {
        let ear = on_head(vec3(58.0 * side, -42.0, -22.0));
        let pit = s.chest.transform_point3(vec3(0.016 * side, 1.455, 0.035) * u) / u;
        let strap = 0.008 + 0.006 * n / 0.058;
        clay.group.cone(ear * u, strap * 1.2 * u, pit * u, strap * 0.72 * u, 0.022 * u);
    }
    // Slope from neck to shoulder.
    let thick = 0.022 + 0.008 * b.muscle;
    clay.cones(
        (&s.neck, vec3(0.01, 1.54, -0.045), thick),
        (&s.chest, vec3(shoulder * 0.9, 1.448, -0.028), thick * 0.72),
        0.045,
    );
    clay.cones((&s.neck, vec3(0.018, 1.50, -0.052), 0.03), (&s.chest, vec3(0.05, 1.36, -0.08), 0.03), 0.05);
    if b.muscle > 0.6 {
        // Larynx.
        let apple = on_head(vec3(0.0, -128.0, 30.0));
        clay.group.ball(apple * u, Vec3::splat(0.014 * u), 0.022 * u);
    }
}

/// Lines that catch light: collar bones, breastbone, spine, belly.
fn add_relief(clay: &mut Sculptor, s: &Skeleton, b: &Build) {
    let u = s.unit;
    let (cd, wd) = (0.5 * b.chest_depth / u, 0.5 * b.waist_depth / u);
    let shoulder = 0.5 * b.shoulder_width / u;
    clay.cones(
        (&s.chest, vec3(0.022, 1.448, 0.04), 0.0085),
        (&s.chest, vec3(shoulder * 0.5, 1.456, 0.016), 0.0065),
        0.022,
    );
    clay.cones(
        (&s.chest, vec3(shoulder * 0.5, 1.456, 0.016), 0.0065),
        (&s.chest, vec3(shoulder * 0.93, 1.458, -0.01), 0.008),
        0.022,
    );
    clay.brush(&s.chest, &[vec3(0.0, 1.46, 0.05), vec3(0.0, 1.45, 0.06)], 0.03, -0.008);
    let m = 0.2 + 0.8 * b.muscle;
    clay.brush(&s.chest, &[vec3(0.0, 1.42, cd * 0.85), vec3(0.0, 1.26, cd)], 0.035, -0.006 * m);
    clay.brush(&s.waist, &[vec3(0.0, 1.19, wd * 1.05), vec3(0.0, 1.06, wd * 1.05)], 0.03, -0.004 * m);
    clay.brush(&s.chest, &[vec3(0.0, 1.43, -cd * 0.9), vec3(0.0, 1.2, -cd)], 0.035, -0.004 - 0.003 * m);
    clay.brush(&s.waist, &[vec3(0.0, 1.2, -cd), vec3(0.0, 1.0, -wd)], 0.04, -0.005 - 0.004 * m);
    clay.brush_pair(&s.pelvis, &[vec3(0.14, 0.99, wd * 0.7), vec3(0.06, 0.915, wd * 0.95)], 0.03, -0.005 * m);
}
