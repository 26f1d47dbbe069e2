//! Stools, boxes and tables.

use super::solid::Solid;
use crate::scene::Mesh;
use glam::Vec3;

/// Height of tables, metres.
const TABLE_M: f32 = 0.75;

/// A round posing stool, 55 cm high.
pub(super) fn posing_stool() -> Mesh {
    let mut solid = Solid::default();
    solid.part("cushion").turned(&[
        (0.0, 0.48),
        (0.165, 0.48),
        (0.176, 0.484),
        (0.182, 0.494),
        (0.184, 0.51),
        (0.182, 0.528),
        (0.174, 0.54),
        (0.155, 0.547),
        (0.1, 0.55),
        (0.0, 0.551),
    ]);
    solid.part("metal").turned(&[(0.0, 0.455), (0.12, 0.455), (0.12, 0.4798), (0.0, 0.4798)]);
    solid.turned(&[(0.0, 0.035), (0.026, 0.035), (0.026, 0.4549), (0.0, 0.4549)]);
    solid.turned(&[
        (0.0, 0.0),
        (0.215, 0.0),
        (0.22, 0.006),
        (0.215, 0.012),
        (0.12, 0.022),
        (0.04, 0.0345),
        (0.0, 0.0348),
    ]);
    solid.finish()
}

/// A full apple box and a half one beside it on edge: 20 x 12 x 8 inches.
pub(super) fn apple_boxes() -> Mesh {
    let mut solid = Solid::default();
    solid.part("wood").chamfered(Vec3::Y * 0.1016, Vec3::new(0.508, 0.2032, 0.305), 0.004);
    solid.chamfered(Vec3::new(0.03, 0.2542, 0.01), Vec3::new(0.508, 0.1016, 0.305), 0.004);
    solid.part("hole");
    for side in [-1.0, 1.0] {
        solid.slab(Vec3::new(side * 0.2541, 0.125, 0.0), Vec3::new(0.0012, 0.035, 0.11));
        solid.slab(Vec3::new(0.03 + side * 0.2541, 0.2542, 0.01), Vec3::new(0.0012, 0.03, 0.11));
    }
    solid.finish()
}

/// A product table: a top of this thickness on four legs.
fn table(top: &str, thickness: f32, square_legs: bool) -> Mesh {
    let (width, depth) = (1.2, 0.7);
    let mut solid = Solid::default();
    let size = Vec3::new(width, thickness, depth);
    solid.part(top).chamfered(Vec3::Y * (TABLE_M - 0.5 * thickness), size, 0.25 * thickness.min(0.012));
    solid.part("legs");
    let under = TABLE_M - thickness - 2e-4;
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let foot = Vec3::new(x * (0.5 * width - 0.05), 0.0, z * (0.5 * depth - 0.05));
        if square_legs {
            solid.slab(foot + Vec3::Y * (0.5 * under), Vec3::new(0.06, under, 0.06));
        } else {
            solid.rod(foot, foot + Vec3::Y * under, 0.016);
        }
    }
    if square_legs {
        for side in [-1.0, 1.0] {
            let high = under - 0.045;
            solid.slab(Vec3::new(0.0, high, side * (0.5 * depth - 0.05)), Vec3::new(width - 0.16, 0.09, 0.022));
            solid.slab(Vec3::new(side * (0.5 * width - 0.05), high, 0.0), Vec3::new(0.022, 0.09, depth - 0.16));
        }
    }
    solid.finish()
}

/// A table of clear acrylic, 15 mm thick.
pub(super) fn acrylic_table() -> Mesh {
    table("acrylic", 0.015, false)
}

/// A table of oiled wood.
pub(super) fn wood_table() -> Mesh {
    table("wood", 0.04, true)
}

/// A table of black glass, 8 mm thick.
pub(super) fn black_glass_table() -> Mesh {
    table("glass", 0.008, false)
}
