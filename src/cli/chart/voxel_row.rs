//! The rows of the study of voxels.

use crate::raytrace::VoxelWay;
use serde::Serialize;

/// A way of finding the first cell on a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// Grid traversal, with or without the bricks.
    Grid(VoxelWay),
    /// The BVH over the faces.
    Bvh,
}

impl Way {
    /// All, in the order of the table.
    pub(super) const ALL: [Way; 3] = [Way::Grid(VoxelWay::Cells), Way::Grid(VoxelWay::Bricks), Way::Bvh];

    /// Returns the name in tables.
    pub(super) fn label(self) -> &'static str {
        match self {
            Way::Grid(VoxelWay::Cells) => "cells",
            Way::Grid(VoxelWay::Bricks) => "bricks",
            Way::Bvh => "bvh",
        }
    }
}

/// One measurement, on one thread.
#[derive(Debug, Serialize)]
pub(super) struct VoxelRow {
    pub way: &'static str,
    pub bounces: usize,
    pub distance_cells: f32,
    pub frame_ms: f64,
    pub rays: usize,
    pub hits: usize,
    /// Cells and bricks that a ray visits in the mean; none for the BVH.
    pub visits_per_ray: Option<f64>,
}
