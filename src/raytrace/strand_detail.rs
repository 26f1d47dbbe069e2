//! Levels of detail of strands: fewer and thicker ones where a picture shows no single strand.
//!
//! Of every so many strands one is kept, as many times as wide: the length of a ray's way through hair is the same on
//! average (strands per volume times their width), and so is the light, for the BSDF of a fibre does not depend on its
//! width. What is lost is the pattern of single strands, so that a level is taken where a kept strand is still narrow
//! beside a pixel. Shadows and scattered light show less of the pattern than what the camera sees: they take a coarser
//! level.

use crate::scene::{StrandPart, StrandPoint, Strands};
use glam::Vec3;
use std::f32::consts::PI;

/// Most strands in place of which one is kept, as a power of two.
const COARSEST: u8 = 3;
/// Parts of a mesh through whose bounding box a ray meets fewer strands than this on average keep all of them: single
/// strands of brows, lashes and stubble are seen before the skin.
const MIN_THINNED_DEPTH: f32 = 1.0;
/// Width of a kept strand that the camera sees, pixels at most.
const SEEN_PX: f32 = 0.5;
/// Width of a kept strand in shadows and for scattered light, pixels at most.
const LIGHTING_PX: f32 = 1.5;
/// Least distance from which strands are looked at, metres.
const MIN_DISTANCE_M: f32 = 0.05;

/// A level of detail: one strand of so many is kept, a power of two, as many times as wide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct StrandLevel(u8);

impl StrandLevel {
    /// All strands.
    pub const ALL: StrandLevel = StrandLevel(0);
    /// The coarsest level.
    pub const COARSEST: StrandLevel = StrandLevel(COARSEST);
    /// Number of levels.
    pub const COUNT: usize = COARSEST as usize + 1;

    /// Returns the coarsest level at which strands of a width are at most `most` wide, both in the same unit.
    fn narrower_than(most: f32, width: f32) -> Self {
        (0..=COARSEST).rev().map(StrandLevel).find(|level| width * level.width() <= most).unwrap_or(Self::ALL)
    }

    /// Returns the index of the level, from that of all strands.
    pub fn index(self) -> usize {
        self.0.into()
    }

    /// Returns the number of strands of which one is kept.
    pub fn every(self) -> usize {
        1 << self.0
    }

    /// Returns the factor on the width of a kept strand.
    pub fn width(self) -> f32 {
        self.every() as f32
    }
}

/// What a ray is traced for, as far as its level of detail depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum StrandUse {
    /// What the camera sees, directly or by mirrors and glass.
    #[default]
    Seen,
    /// Shadows and scattered light.
    Lighting,
}

/// A camera, as far as levels of detail depend on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandView {
    /// Position, in the space of the instances.
    pub position: Vec3,
    /// Width of a pixel at 1 m, metres.
    pub pixel_m: f32,
}

/// The levels of detail of a mesh's strands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct StrandLevels {
    /// Of what the camera sees.
    pub seen: StrandLevel,
    /// Of shadows and scattered light.
    pub lighting: StrandLevel,
}

/// Returns true if levels of detail thin the strands of a part.
pub fn is_thinned(strands: &Strands, part: &StrandPart) -> bool {
    optical_depth(strands, part) >= MIN_THINNED_DEPTH
}

/// Returns how many strands of a part a random ray through their bounding box meets on average: by Crofton's formula the
/// surface of the strands by that of the box.
fn optical_depth(strands: &Strands, part: &StrandPart) -> f32 {
    let (mut surface, mut low, mut high) = (0.0, Vec3::INFINITY, Vec3::NEG_INFINITY);
    for strand in part.strands.clone() {
        let points = strands.strand(strand as usize);
        for [a, b] in points.array_windows() {
            surface += PI * (a.radius_m + b.radius_m) * a.position.distance(b.position);
        }
        for StrandPoint { position, radius_m } in points {
            (low, high) = (low.min(position - radius_m), high.max(position + radius_m));
        }
    }
    let size = high - low;
    surface / (2.0 * (size.x * size.y + size.y * size.z + size.z * size.x))
}

impl StrandView {
    /// Returns the levels for strands of a mean width within a bounding box.
    pub fn levels(&self, (low, high): (Vec3, Vec3), width_m: f32) -> StrandLevels {
        let distance_m = self.position.distance(self.position.clamp(low, high)).max(MIN_DISTANCE_M);
        let width_px = width_m / (self.pixel_m * distance_m);
        StrandLevels {
            seen: StrandLevel::narrower_than(SEEN_PX, width_px),
            lighting: StrandLevel::narrower_than(LIGHTING_PX, width_px),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sparse_parts_keep_all_strands() {
        // Parallel strands of 20 cm in a square of 1 cm
        let straight = |count: u32| {
            let mut strands = Strands::default();
            let side = f64::from(count).sqrt() as u32;
            for i in 0..count {
                let [x, z] = [i % side, i / side].map(|k| 0.01 * k as f32 / side.max(2) as f32);
                strands.push([0.0, 0.2].map(|y| StrandPoint { position: Vec3::new(x, y, z), radius_m: 50e-6 }));
            }
            strands.end_part("hair");
            strands
        };
        let depth = |strands: &Strands| optical_depth(strands, &strands.parts()[0]);
        // The surface of the strands by that of the box, 4 sides of 20 cm2 and two of 1 cm2
        let dense = straight(10_000);
        let surface = 10_000.0 * 2.0 * PI * 50e-6 * 0.2;
        assert!((depth(&dense) / (surface / 82e-4) - 1.0).abs() < 0.02, "{}", depth(&dense));
        // A cylinder by the box around it
        let one = straight(1);
        assert!((depth(&one) - PI / 4.0).abs() < 1e-3, "{}", depth(&one));
        assert!(is_thinned(&dense, &dense.parts()[0]) && !is_thinned(&one, &one.parts()[0]));
    }

    #[test]
    fn strands_are_thinned_until_they_are_as_wide_as_the_limits() {
        // Seen from 2 m, a pixel is 0.4 mm wide
        let view = StrandView { position: Vec3::Z * 2.1, pixel_m: 2e-4 };
        let head = (Vec3::splat(-0.1), Vec3::splat(0.1));
        let every = |width_m| {
            let levels = view.levels(head, width_m);
            (levels.seen.every(), levels.lighting.every())
        };
        assert_eq!(every(1e-3), (1, 1), "thicker than a pixel");
        assert_eq!(every(1.2e-4), (1, 4), "0.3 pixels");
        assert_eq!(every(0.9e-4), (2, 4), "0.225 pixels");
        assert_eq!(every(1e-6), (8, 8), "no more than the coarsest level");
        let near = StrandView { position: Vec3::ZERO, ..view };
        assert_eq!(near.levels(head, 1.2e-4), StrandLevels::default(), "within the hair");
    }
}
