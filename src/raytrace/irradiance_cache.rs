//! The irradiance cache: light on matte surfaces that paths meet after a bounce, kept for cells of a few centimetres to
//! decimetres.
//!
//! In a bright closed room most noise comes from long paths, each of which finds little. A pass of samples therefore
//! begins with paths from points on the surfaces (Ward, Rubinstein and Clear 1988, "A Ray Tracing Solution for Diffuse
//! Interreflection"): what arrives there, directly and after any number of bounces, is averaged over each cell, and
//! camera paths take the diffuse light of a cell in place of paths of their own. It is the light of one bounce before
//! what is seen, so that a camera path averages over many cells. Contrary to Ward's, cells hold no gradients and are
//! new with each pass: their noise averages out as that of pixels does.
//!
//! What a cell holds is the radiance of a white diffuse base under the coat of its material, for each film layer. The
//! path's own texture and the coat towards it are factors; the coat's reflection is traced as everywhere else.
//!
//! Where it fails: light and shadow within a cell become one, which darkens or brightens what is near. So cells have
//! several sizes, each half of the next, and a path takes one of a third of the width of its sample at most
//! ([`MIN_FOOTPRINT_CELLS`]), or none; the mean of a room is then right within 0.001 stops. The cache is used only where
//! it pays (`irradiance_gather.rs`, which traces the cells), and not under normal maps, in water that moves while it is
//! lit, or by the light meter.

use super::bsdf::Bsdf;
use super::geometry::SurfaceInteraction;
use crate::math::approx;
use glam::{IVec3, Vec3};
use rustc_hash::FxHashMap;

/// Least width of a path's sample, where it meets the surface, in cells.
const MIN_FOOTPRINT_CELLS: f32 = 3.0;
/// Times that cells are halved for narrower samples.
const MAX_LEVEL: i32 = 5;

/// The key of a cell: a cube of space of one of the sizes, a range of normals and a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CellKey([i32; 6]);

impl CellKey {
    /// Returns the key of the cell of a level that a surface is in, for largest cells of this size.
    pub fn of(surface: &SurfaceInteraction, largest_cell_m: f32, CellLevel(level): CellLevel) -> Self {
        let cell_m = CellLevel(level).cell_m(largest_cell_m);
        let [x, y, z] = (surface.position / cell_m).to_array().map(floor);
        let normal = cube_direction(surface.normal);
        CellKey([x, y, z, normal.dot(IVec3::new(1, 4, 16)), surface.material.cast_signed(), level])
    }

    /// Returns two numbers by which the random numbers of the cell's paths differ from those of others.
    pub fn seeds(&self) -> (u32, u32) {
        let [x, y, z, normal, material, level] = self.0.map(i32::cast_unsigned);
        (x ^ z.rotate_left(16), y ^ normal.rotate_left(12) ^ material.rotate_left(20) ^ level.rotate_left(27))
    }
}

/// Returns the nearest of 26 directions: to the faces, edges and corners of a cube.
fn cube_direction(normal: Vec3) -> IVec3 {
    // 1.5 rounds to the even 2
    IVec3::from(normal.to_array().map(|part| approx::round(1.5 * part).clamp(-1.0, 1.0) as i32))
}

/// Returns the largest whole number up to a number: the standard library's is a call on CPUs without SSE 4.1.
fn floor(x: f32) -> i32 {
    let whole = x as i32;
    whole - i32::from(x < whole as f32)
}

/// The light of each cell in a pass.
#[derive(Debug)]
pub struct IrradianceCache {
    /// Size of the largest cells, metres.
    pub largest_cell_m: f32,
    /// Radiance of a white diffuse base, film layer by film layer.
    pub cells: FxHashMap<CellKey, Vec<Vec3>>,
}

/// The light of a cell towards a path.
#[derive(Clone, Copy, Debug)]
pub struct CachedLight<'a> {
    /// Factor of the light.
    pub factor: Vec3,
    /// Radiance of a white diffuse base, film layer by film layer.
    pub light: &'a [Vec3],
    /// Size of the cell, metres.
    pub cell_m: f32,
}

/// A size of cells: how often the largest are halved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellLevel(i32);

impl CellLevel {
    /// Returns the size of the level's cells, metres, of the largest cells'.
    pub fn cell_m(self, largest_cell_m: f32) -> f32 {
        largest_cell_m / (1 << self.0) as f32
    }
}

/// The area of a surface that a sample stands for, square metres.
#[derive(Clone, Copy, Debug)]
pub struct Footprint(f32);

impl Footprint {
    /// The footprint of a sample of this solid angle (sr) that meets a surface after so many metres, at this cosine.
    pub fn new(solid_angle: f32, distance: f32, cos: f32) -> Self {
        Footprint(if cos > 0.0 { solid_angle * distance * distance / cos } else { 0.0 })
    }

    /// Returns the level of the largest cells that are narrow enough, if there are such.
    pub fn level(self, largest_cell_m: f32) -> Option<CellLevel> {
        // Each halving of the width is a quarter of the area
        let mut area = (MIN_FOOTPRINT_CELLS * largest_cell_m).powi(2);
        for level in 0..=MAX_LEVEL {
            if area <= self.0 {
                return Some(CellLevel(level));
            }
            area *= 0.25;
        }
        None
    }
}

impl IrradianceCache {
    /// Returns the light of the cell of a surface, for a sample of this footprint, if there is a cell.
    pub fn light_at(
        &self,
        surface: &SurfaceInteraction,
        footprint: Footprint,
        bsdf: &Bsdf<'_>,
    ) -> Option<CachedLight<'_>> {
        let level = footprint.level(self.largest_cell_m)?;
        let factor = bsdf.matte_factor()?;
        let light = self.cells.get(&CellKey::of(surface, self.largest_cell_m, level))?;
        Some(CachedLight { factor, light, cell_m: level.cell_m(self.largest_cell_m) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_that_differ_by_rounding_are_of_one_direction() {
        for axis in [Vec3::X, Vec3::NEG_Y, Vec3::Z] {
            assert_eq!(cube_direction(axis), axis.as_ivec3());
            assert_eq!(cube_direction(axis * 0.999_999_94), axis.as_ivec3());
        }
        assert_eq!(cube_direction(Vec3::new(0.6, 0.0, -0.8)), IVec3::new(1, 0, -1));
        assert_eq!(cube_direction(Vec3::new(0.2, 0.3, 0.93)), IVec3::new(0, 0, 1));
    }
}
