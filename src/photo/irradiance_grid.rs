//! Bounced light on a regular grid of probes: an ambient cube (McTaggart, "Half-Life 2 / Valve Source Shading", GDC 2004) at
//! each, the irradiance on surfaces that face along the six axes.

use glam::{UVec3, Vec3};

/// Directions of the six values of a probe.
pub const FACES: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

/// The positions of a grid's probes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridLayout {
    /// Position of the first probe, world space.
    pub low: Vec3,
    /// Distances between neighbouring probes, metres.
    pub step_m: Vec3,
    /// Number of probes along each axis, at least 1.
    pub counts: UVec3,
}

impl GridLayout {
    /// Returns a grid of cells of about the longest side over `cells`, at least `min_step_m`, with a probe in the middle
    /// of each, over the box from `low` to `high`; none if it has no finite size.
    pub fn over((low, high): (Vec3, Vec3), cells: u32, min_step_m: f32) -> Option<Self> {
        let size = high - low;
        let step_m = (size.max_element() / cells as f32).max(min_step_m);
        if !(low.is_finite() && high.is_finite() && size.min_element() >= 0.0 && step_m.is_finite()) {
            return None;
        }
        let counts = (size / step_m).ceil().max(Vec3::ONE).as_uvec3().min(UVec3::splat(cells));
        let step_m = (size / counts.as_vec3()).max(Vec3::splat(min_step_m));
        // The cells of a flat box are as thick as the smallest step.
        let low = 0.5 * (low + high) - 0.5 * step_m * (counts.as_vec3() - 1.0);
        Some(GridLayout { low, step_m, counts })
    }

    /// Returns the number of probes.
    pub fn len(&self) -> usize {
        self.counts.element_product() as usize
    }

    /// Returns true if there is no probe.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the index of a probe: x first, then y, then z.
    pub fn index(&self, probe: UVec3) -> usize {
        ((probe.z * self.counts.y + probe.y) * self.counts.x + probe.x) as usize
    }

    /// Returns the whole coordinates of a probe.
    pub fn probe(&self, index: usize) -> UVec3 {
        let (index, UVec3 { x, y, .. }) = (index as u32, self.counts);
        UVec3::new(index % x, index / x % y, index / (x * y))
    }

    /// Returns the position of a probe, world space.
    pub fn position(&self, index: usize) -> Vec3 {
        self.low + self.step_m * self.probe(index).as_vec3()
    }
}

/// Bounced irradiance on a grid, picture units.
#[derive(Clone, Debug, PartialEq)]
pub struct IrradianceGrid {
    /// The probes.
    pub layout: GridLayout,
    /// Irradiance of each probe on surfaces that face along each of [`FACES`].
    pub probes: Vec<[Vec3; 6]>,
}

impl IrradianceGrid {
    /// Returns a grid of one probe: the same irradiance everywhere.
    pub fn uniform(irradiance: [Vec3; 6]) -> Self {
        let layout = GridLayout { low: Vec3::ZERO, step_m: Vec3::ONE, counts: UVec3::ONE };
        IrradianceGrid { layout, probes: vec![irradiance] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_are_in_the_middle_of_cells_that_fill_the_box() {
        let layout = GridLayout::over((Vec3::new(-3.0, 0.0, -1.0), Vec3::new(3.0, 3.0, 1.0)), 12, 0.05).unwrap();
        assert_eq!(layout.counts, UVec3::new(12, 6, 4));
        assert!((layout.position(0) - Vec3::new(-2.75, 0.25, -0.75)).length() < 1e-5);
        assert!((layout.position(layout.len() - 1) - Vec3::new(2.75, 2.75, 0.75)).length() < 1e-5);
        assert!((0..layout.len()).all(|index| layout.index(layout.probe(index)) == index));
    }

    #[test]
    fn flat_and_broken_boxes_have_a_layer_or_none() {
        let flat = GridLayout::over((Vec3::ZERO, Vec3::new(2.0, 0.0, 2.0)), 10, 0.05).unwrap();
        assert_eq!((flat.counts.y, flat.low.y), (1, 0.0));
        let point = GridLayout::over((Vec3::ONE, Vec3::ONE), 10, 0.05).unwrap();
        assert_eq!((point.len(), point.low), (1, Vec3::ONE));
        assert_eq!(GridLayout::over((Vec3::INFINITY, Vec3::NEG_INFINITY), 10, 0.05), None);
        assert_eq!(GridLayout::over((Vec3::NAN, Vec3::ONE), 10, 0.05), None);
    }
}
