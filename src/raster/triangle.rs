//! Triangles on the screen: corners in 1/256 of a pixel, exact integer edges, 1/w as depth.

use super::row::Run;
use glam::{Mat3, Vec3, Vec4};
use std::ops::Range;

/// Positions in a pixel, along each side.
pub(super) const SUBPIXELS: i32 = 256;
/// Largest picture edge, pixels: positions have 22 bits, and the edges' products 45.
const LARGEST_EDGE: u32 = 16384;

/// A picture's size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Screen {
    pub width: u32,
    pub height: u32,
}

impl Screen {
    pub fn new((width, height): (u32, u32)) -> Self {
        Screen { width: width.clamp(1, LARGEST_EDGE), height: height.clamp(1, LARGEST_EDGE) }
    }

    /// Where a point inside clip space lies.
    pub fn project(self, clip: Vec4) -> OnScreen {
        let inverse_w = 1.0 / clip.w;
        // Not negative inside: adding a half and cutting off rounds.
        let fixed = |part: f32, pixels: u32| (f64::from(part) * f64::from(pixels) * f64::from(SUBPIXELS) + 0.5) as i32;
        let x = fixed(0.5 + 0.5 * clip.x * inverse_w, self.width);
        let y = fixed(0.5 - 0.5 * clip.y * inverse_w, self.height);
        OnScreen { at: [x, y], inverse_w }
    }
}

/// A point on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OnScreen {
    /// In 1/256 pixels, y down.
    at: [i32; 2],
    /// One over the distance along the camera's axis, 1/m.
    inverse_w: f32,
}

/// Which of a mesh's sides are drawn, and how far it stands back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    pub one_sided: bool,
    /// Factor of 1/w: a little under 1 lets paper lie on a floor.
    pub depth_factor: f32,
}

/// A triangle inside the screen.
#[derive(Clone, Debug)]
pub(super) struct ScreenTriangle {
    at: [[i32; 2]; 3],
    inverse_w: [f32; 3],
    /// Whether its corners run clockwise on the screen.
    clockwise: bool,
    /// Its surface, and its number in the mesh that has it.
    pub surface: u32,
    pub triangle: u32,
    /// Where it was cut off another, the weights of the other's corners at each of its own.
    cut: Option<Box<Mat3>>,
}

impl ScreenTriangle {
    /// None if it has no area, shows its back where only fronts are drawn, or lies between the pixels.
    pub fn new(
        corners: [OnScreen; 3],
        facing: Facing,
        (surface, triangle): (u32, u32),
        cut: Option<[Vec3; 3]>,
    ) -> Option<Self> {
        let at = corners.map(|corner| corner.at);
        let area = edge(at[0], at[1], at[2]);
        // Where y runs down, clockwise corners have a positive area; fronts are counter-clockwise.
        let clockwise = area > 0;
        if area == 0 || (facing.one_sided && clockwise) {
            return None;
        }
        let inverse_w = corners.map(|corner| corner.inverse_w * facing.depth_factor);
        let cut = cut.map(|[a, b, c]| Box::new(Mat3::from_cols(a, b, c)));
        let placed = ScreenTriangle { at, inverse_w, clockwise, surface, triangle, cut };
        (0..2).all(|axis| !placed.pixels(axis).is_empty()).then_some(placed)
    }

    /// Smallest and largest position along an axis, 1/256 pixels.
    #[inline(always)]
    fn extent(&self, axis: usize) -> (i32, i32) {
        let [a, b, c] = self.at.map(|p| p[axis]);
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// The pixels along an axis whose centres may lie inside.
    #[inline(always)]
    pub fn pixels(&self, axis: usize) -> Range<usize> {
        let (low, high) = self.extent(axis);
        let half = SUBPIXELS / 2;
        // Positions inside the screen are not negative.
        let first_from = |position: i32| ((position + half - 1) / SUBPIXELS) as usize;
        first_from(low)..first_from(high + 1)
    }

    /// Whether both sides are at most so many pixels long.
    #[inline(always)]
    pub fn is_within(&self, pixels: i32) -> bool {
        (0..2).all(|axis| {
            let (low, high) = self.extent(axis);
            high - low <= pixels * SUBPIXELS
        })
    }

    /// The edges opposite to each corner, each from end to end: clockwise.
    #[inline(always)]
    pub fn edges(&self) -> [[[i32; 2]; 2]; 3] {
        let [a, b, c] = self.at;
        if self.clockwise { [[b, c], [c, a], [a, b]] } else { [[c, b], [a, c], [b, a]] }
    }

    /// Weights of the corners over their distance: at a pixel's centre, and what they gain with a pixel to the right and
    /// with one down.
    #[inline(always)]
    pub fn over_distance(&self, x: usize, y: usize) -> [Vec3; 3] {
        let [a, b, c] = self.at;
        let scale = Vec3::from(self.inverse_w) / edge(a, b, c).abs() as f32;
        let edges = self.edges();
        let at = Vec3::from(edges.map(|[from, to]| edge(from, to, centre(x, y)) as f32));
        let right = Vec3::from(edges.map(|[from, to]| ((from[1] - to[1]) * SUBPIXELS) as f32));
        let down = Vec3::from(edges.map(|[from, to]| ((to[0] - from[0]) * SUBPIXELS) as f32));
        [at * scale, right * scale, down * scale]
    }

    /// Pixels of a row that show it, numbered from pixel `tile_x` of the screen.
    #[inline(always)]
    pub fn run(&self, tile_x: usize, y: usize, pixels: Range<usize>) -> Run {
        let [start, step, _] = self.over_distance(tile_x + pixels.start, y);
        match &self.cut {
            Some(whole) => Run { pixels, start: **whole * start, step: **whole * step },
            None => Run { pixels, start, step },
        }
    }
}

/// Twice the signed area of three points; exact.
#[inline(always)]
pub(super) fn edge(a: [i32; 2], b: [i32; 2], p: [i32; 2]) -> i64 {
    let product = |i: i32, k: i32| i64::from(i) * i64::from(k);
    product(b[0] - a[0], p[1] - a[1]) - product(b[1] - a[1], p[0] - a[0])
}

/// The middle of a pixel.
#[inline(always)]
pub(super) fn centre(x: usize, y: usize) -> [i32; 2] {
    [x, y].map(|i| i as i32 * SUBPIXELS + SUBPIXELS / 2)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub const SCREEN: Screen = Screen { width: 97, height: 61 };
    const BOTH_SIDES: Facing = Facing { one_sided: false, depth_factor: 1.0 };

    /// A triangle between places on the screen, all equally far.
    pub fn on_screen(corners: [(f32, f32); 3], distance: f32) -> Option<ScreenTriangle> {
        let clip = |(x, y): (f32, f32)| {
            let (x, y) = (2.0 * x / SCREEN.width as f32 - 1.0, 1.0 - 2.0 * y / SCREEN.height as f32);
            Vec4::new(x * distance, y * distance, 0.1, distance)
        };
        ScreenTriangle::new(corners.map(|corner| SCREEN.project(clip(corner))), BOTH_SIDES, (0, 0), None)
    }

    #[test]
    fn what_has_no_area_or_lies_between_pixels_is_not_drawn() {
        assert!(on_screen([(3.0, 3.0), (9.0, 9.0), (6.0, 6.0)], 1.0).is_none(), "no area");
        assert!(on_screen([(3.6, 3.6), (4.4, 3.6), (3.6, 4.4)], 1.0).is_none(), "between four centres");
        assert!(on_screen([(3.4, 3.4), (3.8, 3.4), (3.4, 3.8)], 1.0).is_some(), "about a centre");
    }

    #[test]
    fn weights_are_correct_in_perspective() {
        // A strip that runs from distance 1 to 9: half-way on the screen is a tenth of the way along.
        let (near, far) = (Vec4::new(-1.0, -1.0, 0.1, 1.0), Vec4::new(9.0, -9.0, 0.1, 9.0));
        let corners = [near, far, Vec4::new(9.0, 9.0, 0.1, 9.0)].map(|p| SCREEN.project(p));
        let triangle = ScreenTriangle::new(corners, BOTH_SIDES, (0, 0), None).unwrap();
        let run = triangle.run(0, 60, 40..49);
        let at_48 = run.start + 8.0 * run.step;
        let along = at_48 / at_48.element_sum();
        assert!((along.y - 0.1).abs() < 0.01, "{along}");
        // The same strip as the part of a triangle whose second corner it does not reach.
        let half = [Vec3::X, Vec3::new(0.5, 0.5, 0.0), Vec3::Z];
        let cut = ScreenTriangle::new(corners, BOTH_SIDES, (0, 0), Some(half)).unwrap().run(0, 60, 48..49);
        let along = cut.start / cut.start.element_sum();
        assert!((along.y - 0.05).abs() < 0.005, "{along}");
    }
}
