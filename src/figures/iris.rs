//! Pictures of the iris and the pupil, which lie on the flat base of the cornea: colours and relief.
//!
//! The lengths of its zones are typical ones.

use super::random::Random;
use crate::color::srgb_encode;
use crate::math::Dome;
use crate::scene::Texture;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Radius of the iris, metres.
pub const IRIS_M: f32 = 0.0059;
/// Radius of the pupil in studio light as it is seen from the front, in radii of the iris.
pub const PUPIL: f32 = 0.0018 / IRIS_M;
/// The cornea, in radii of the iris: 7.8 mm.
pub const CORNEA: Dome = Dome { radius: 1.322, ior: 1.38 };

/// Side of the pictures, pixels.
const SIZE: usize = 256;
/// Fibres around.
const FIBRES: usize = 180;
/// Angle by which the edge of the iris leans inwards: the cornea focuses light onto the opposite side. Typical.
const HOLLOW_RAD: f32 = 0.25;
/// Greatest slope of the fibres of the iris, across them. Typical.
const FIBRE_SLOPE: f32 = 0.35;

/// The fibres of an iris, which run from its edge to the pupil.
#[derive(Clone, Debug)]
pub struct IrisFibres {
    /// Radius of the pupil, in radii of the iris.
    pupil: f32,
    /// Random numbers of each fibre, 0 to 1: its lightness at the edge and at the pupil, and the width of the light zone
    /// around the pupil.
    fibres: Vec<[f32; 3]>,
}

impl IrisFibres {
    /// Returns the fibres of an iris with a pupil of a radius, in radii of the iris.
    pub fn new(pupil: f32) -> Self {
        let mut random = Random::new(0, 7);
        let fibres = (0..FIBRES).map(|_| [random.unit(), random.unit(), random.unit()]).collect();
        IrisFibres { pupil, fibres }
    }

    /// Returns the numbers of the fibres at a point, smooth around the iris, and their derivatives by the fibre's index.
    fn at(&self, point: Vec2) -> (Vec3, Vec3) {
        let around = (point.to_angle() / TAU).rem_euclid(1.0) * FIBRES as f32;
        let [a, b] = [0, 1].map(|k| Vec3::from(self.fibres[(around as usize + k) % FIBRES]));
        let t = around.fract();
        (a.lerp(b, t * t * (3.0 - 2.0 * t)), (b - a) * (6.0 * t * (1.0 - t)))
    }

    /// Returns how far a point is from the pupil, 0, to the edge, 1.
    fn outwards(&self, point: Vec2) -> f32 {
        ((point.length() - self.pupil) / (1.0 - self.pupil)).clamp(0.0, 1.0)
    }

    /// Returns the colour at a point in radii of the iris, a factor of the base colour: dark at the edge (the limbal ring),
    /// with fibres from there to the pupil, which are lighter near it, and black in the pupil.
    pub fn color(&self, point: Vec2) -> Vec3 {
        let outwards = self.outwards(point);
        let [at_edge, at_pupil, zone] = self.at(point).0.to_array();
        let limbus = ((outwards - 0.78) / 0.22).clamp(0.0, 1.0);
        let inner = 1.0 - ((outwards - 0.1) / (0.2 + 0.15 * zone)).clamp(0.0, 1.0);
        let streak = 0.4 + 0.45 * (at_pupil + (at_edge - at_pupil) * outwards);
        // The inner zone is lighter and warmer
        let tint = Vec3::ONE.lerp(Vec3::new(1.0, 0.8, 0.45), inner) * (streak + 0.25 * inner);
        // The pupil's edge is a thin dark line
        let rim = 0.4 + 0.6 * (outwards / 0.06).min(1.0);
        let in_pupil = ((self.pupil - point.length()) / (0.03 * self.pupil)).clamp(0.0, 1.0);
        tint * (rim * (1.0 - 0.8 * limbus) * (1.0 - in_pupil))
    }

    /// Returns the normal at a point in radii of the iris: X and Y as those of the point, Z out of the eye.
    fn normal(&self, point: Vec2) -> Vec3 {
        let outwards = self.outwards(point);
        let (_, slopes) = self.at(point);
        // Fibres end before the edge
        let across = FIBRE_SLOPE * slopes.x / 1.5 * 4.0 * outwards * (1.0 - outwards);
        let radial = point.normalize_or_zero();
        let tilt = radial.perp() * -across - radial * (HOLLOW_RAD * outwards).tan();
        tilt.extend(1.0).normalize()
    }
}

/// Returns the radius of the pupil on the base: the cornea magnifies it.
fn pupil_on_base() -> f32 {
    let point = Vec2::X * PUPIL;
    let view_dir = CORNEA.frame(point).transpose() * Vec3::Z;
    CORNEA.seen_uv(point, view_dir).x * 2.0 - 1.0
}

/// Draws a picture of the base: pixels for points in radii of the iris.
fn picture(pixel: impl Fn(Vec2) -> [u8; 3]) -> Texture {
    let point = |index: usize| {
        let (x, y) = ((index % SIZE) as f32 + 0.5, (index / SIZE) as f32 + 0.5);
        // Rows run down, V runs up
        Vec2::new(x, SIZE as f32 - y) * (2.0 / SIZE as f32) - Vec2::ONE
    };
    Texture::opaque(SIZE as u32, SIZE as u32, (0..SIZE * SIZE).map(|index| pixel(point(index))).collect())
}

/// Draws the colours of iris and pupil.
pub fn iris_picture() -> Texture {
    let fibres = IrisFibres::new(pupil_on_base());
    picture(|point| fibres.color(point).to_array().map(|c| (srgb_encode(c.min(1.0)) * 255.0).round() as u8))
}

/// Draws the normals of the iris.
pub fn iris_relief() -> Texture {
    let fibres = IrisFibres::new(pupil_on_base());
    picture(|point| fibres.normal(point).to_array().map(|c| ((c + 1.0) * 127.5).round() as u8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pupil_has_its_size_as_seen_from_the_front() {
        // Within a pixel of the picture
        let (picture, fibres) = (iris_picture(), IrisFibres::new(pupil_on_base()));
        assert!((0.85..0.93).contains(&(fibres.pupil / PUPIL)), "magnified by {}", PUPIL / fibres.pupil);
        let row = &picture.rgb[SIZE / 2 * SIZE..][..SIZE];
        let black = row.iter().filter(|rgb| rgb.iter().all(|&c| c < 40)).count() as f32;
        assert!((black / SIZE as f32 - fibres.pupil).abs() < 2.5 / SIZE as f32, "{black} pixels");
    }

    #[test]
    fn the_normals_lean_inwards_all_around() {
        let fibres = IrisFibres::new(pupil_on_base());
        for degrees in (0..360).map(|d| d as f32) {
            let radial = Vec2::from_angle(degrees.to_radians());
            for radius in [0.5, 0.7, 0.95] {
                let normal = fibres.normal(radial * radius);
                let outwards = normal.dot(radial.extend(0.0));
                assert!(
                    normal.is_normalized() && (-0.26..-0.05).contains(&outwards),
                    "{normal} at {radius}, {degrees}"
                );
            }
        }
        assert_eq!(fibres.normal(Vec2::ZERO), Vec3::Z);
    }
}
