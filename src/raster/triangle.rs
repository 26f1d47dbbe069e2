//! Triangle set-up: culling, bounding box, edges, and 1/w as an affine function of the screen.

use super::edge_function::{EdgeFunction, doubled_area, pixel_centre};
use super::gbuffer_row::Span;
#[cfg(test)]
use super::viewport::Viewport;
use super::viewport::{SUBPIXELS, ScreenVertex};
use glam::{Mat3, Vec3};
use std::ops::Range;

/// Culling and depth bias of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct PrimitiveState {
    pub cull_back_faces: bool,
    /// Factor of 1/w: slightly under 1 draws a room behind paper that lies on its floor.
    pub depth_factor: f32,
}

/// The identity of a triangle: its surface, and its index in the surface's mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleId {
    pub surface: u32,
    pub triangle: u32,
}

/// A triangle in screen space, inside the viewport.
#[derive(Clone, Debug)]
pub(super) struct ScreenTriangle {
    positions: [[i32; 2]; 3],
    inverse_w: [f32; 3],
    /// Clockwise on the screen.
    clockwise: bool,
    pub id: TriangleId,
    /// For a piece of a clipped triangle, the barycentric coordinates of its vertices in the unclipped one.
    unclipped_from_clipped: Option<Box<Mat3>>,
}

impl ScreenTriangle {
    /// Returns none for a triangle without area, a culled back face, and one that covers no pixel centre's row or
    /// column. `barycentric` holds the coordinates of the vertices of a clipped piece in the unclipped triangle.
    pub fn new(
        vertices: [ScreenVertex; 3],
        state: PrimitiveState,
        id: TriangleId,
        barycentric: Option<[Vec3; 3]>,
    ) -> Option<Self> {
        let positions = vertices.map(|vertex| vertex.position);
        let area = doubled_area(positions[0], positions[1], positions[2]);
        // With y down, clockwise vertices have a positive area; front faces are counter-clockwise.
        let clockwise = area > 0;
        if area == 0 || (state.cull_back_faces && clockwise) {
            return None;
        }
        let inverse_w = vertices.map(|vertex| vertex.inverse_w * state.depth_factor);
        let unclipped_from_clipped = barycentric.map(|[a, b, c]| Box::new(Mat3::from_cols(a, b, c)));
        let triangle = ScreenTriangle { positions, inverse_w, clockwise, id, unclipped_from_clipped };
        (0..2).all(|axis| !triangle.pixel_bounds(axis).is_empty()).then_some(triangle)
    }

    /// Returns the smallest and the largest coordinate along an axis, 1/256 pixels.
    #[inline(always)]
    fn extent(&self, axis: usize) -> (i32, i32) {
        let [a, b, c] = self.positions.map(|p| p[axis]);
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Returns the pixels along an axis whose centres may lie inside.
    #[inline(always)]
    pub fn pixel_bounds(&self, axis: usize) -> Range<usize> {
        let (low, high) = self.extent(axis);
        let half = SUBPIXELS / 2;
        // Positions inside the viewport are not negative.
        let first_from = |position: i32| ((position + half - 1) / SUBPIXELS) as usize;
        first_from(low)..first_from(high + 1)
    }

    /// Returns true if both sides of the bounding box are at most so many pixels long.
    #[inline(always)]
    pub fn fits_within(&self, pixels: i32) -> bool {
        (0..2).all(|axis| {
            let (low, high) = self.extent(axis);
            high - low <= pixels * SUBPIXELS
        })
    }

    /// Returns the clockwise edges opposite to each vertex, each with its ends.
    #[inline(always)]
    fn edges(&self) -> [[[i32; 2]; 2]; 3] {
        let [a, b, c] = self.positions;
        if self.clockwise { [[b, c], [c, a], [a, b]] } else { [[c, b], [a, c], [b, a]] }
    }

    /// Returns the three edge functions, in rows that start at pixel (x, y).
    #[inline(always)]
    pub fn edge_functions(&self, x: usize, y: usize) -> [EdgeFunction; 3] {
        self.edges().map(|edge| EdgeFunction::new(edge, x, y))
    }

    /// Returns the barycentric coordinates over w: at a pixel's centre, and their steps to the right and down. Their
    /// sum is 1/w.
    #[inline(always)]
    pub fn barycentric_over_w(&self, x: usize, y: usize) -> [Vec3; 3] {
        let [a, b, c] = self.positions;
        let scale = Vec3::from(self.inverse_w) / doubled_area(a, b, c).abs() as f32;
        let edges = self.edges();
        let at = Vec3::from(edges.map(|[from, to]| doubled_area(from, to, pixel_centre(x, y)) as f32));
        let right = Vec3::from(edges.map(|[from, to]| ((from[1] - to[1]) * SUBPIXELS) as f32));
        let down = Vec3::from(edges.map(|[from, to]| ((to[0] - from[0]) * SUBPIXELS) as f32));
        [at * scale, right * scale, down * scale]
    }

    /// Returns a span of this triangle in a row, with pixels numbered from pixel `tile_x` of the screen.
    #[inline(always)]
    pub fn span(&self, tile_x: usize, y: usize, pixels: Range<usize>) -> Span {
        let [start, step, _] = self.barycentric_over_w(tile_x + pixels.start, y);
        match &self.unclipped_from_clipped {
            Some(unclipped) => Span { pixels, start: **unclipped * start, step: **unclipped * step },
            None => Span { pixels, start, step },
        }
    }
}

/// The viewport of tests.
#[cfg(test)]
pub(super) const TEST_VIEWPORT: Viewport = Viewport { width: 97, height: 61 };

#[cfg(test)]
impl ScreenTriangle {
    /// A two-sided triangle between points of the test viewport, all at the same depth.
    pub fn at_depth(vertices: [(f32, f32); 3], depth: f32) -> Option<ScreenTriangle> {
        let Viewport { width, height } = TEST_VIEWPORT;
        let clip = |(x, y): (f32, f32)| {
            let (x, y) = (2.0 * x / width as f32 - 1.0, 1.0 - 2.0 * y / height as f32);
            glam::Vec4::new(x * depth, y * depth, 0.1, depth)
        };
        let screen = vertices.map(|vertex| TEST_VIEWPORT.screen_from_clip(clip(vertex)));
        let state = PrimitiveState { cull_back_faces: false, depth_factor: 1.0 };
        ScreenTriangle::new(screen, state, TriangleId { surface: 0, triangle: 0 }, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    const TWO_SIDED: PrimitiveState = PrimitiveState { cull_back_faces: false, depth_factor: 1.0 };
    const ID: TriangleId = TriangleId { surface: 0, triangle: 0 };

    #[test]
    fn triangles_without_area_or_between_pixel_centres_are_discarded() {
        assert!(ScreenTriangle::at_depth([(3.0, 3.0), (9.0, 9.0), (6.0, 6.0)], 1.0).is_none(), "no area");
        assert!(ScreenTriangle::at_depth([(3.6, 3.6), (4.4, 3.6), (3.6, 4.4)], 1.0).is_none(), "between four centres");
        assert!(ScreenTriangle::at_depth([(3.4, 3.4), (3.8, 3.4), (3.4, 3.8)], 1.0).is_some(), "around a centre");
    }

    #[test]
    fn barycentric_coordinates_are_perspective_correct() {
        // A strip from depth 1 to 9: half-way on the screen is a tenth of the way along.
        let (near, far) = (Vec4::new(-1.0, -1.0, 0.1, 1.0), Vec4::new(9.0, -9.0, 0.1, 9.0));
        let vertices = [near, far, Vec4::new(9.0, 9.0, 0.1, 9.0)].map(|p| TEST_VIEWPORT.screen_from_clip(p));
        let triangle = ScreenTriangle::new(vertices, TWO_SIDED, ID, None).unwrap();
        let span = triangle.span(0, 60, 40..49);
        let at_48 = span.start + 8.0 * span.step;
        let along = at_48 / at_48.element_sum();
        assert!((along.y - 0.1).abs() < 0.01, "{along}");
        // The same strip as the clipped piece of a triangle twice as long.
        let half = [Vec3::X, Vec3::new(0.5, 0.5, 0.0), Vec3::Z];
        let clipped = ScreenTriangle::new(vertices, TWO_SIDED, ID, Some(half)).unwrap().span(0, 60, 48..49);
        let along = clipped.start / clipped.start.element_sum();
        assert!((along.y - 0.05).abs() < 0.005, "{along}");
    }
}
