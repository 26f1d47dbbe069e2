//! Edge functions in exact integers, with the top-left fill rule (Pineda 1988).

use super::viewport::SUBPIXELS;

/// Returns twice the signed area of a triangle in 1/256 pixels; exact. Positive for clockwise vertices, y down.
#[inline(always)]
pub(super) fn doubled_area(a: [i32; 2], b: [i32; 2], p: [i32; 2]) -> i64 {
    let product = |i: i32, k: i32| i64::from(i) * i64::from(k);
    product(b[0] - a[0], p[1] - a[1]) - product(b[1] - a[1], p[0] - a[0])
}

/// Returns the centre of a pixel in 1/256 pixels.
#[inline(always)]
pub(super) fn pixel_centre(x: usize, y: usize) -> [i32; 2] {
    [x, y].map(|i| i as i32 * SUBPIXELS + SUBPIXELS / 2)
}

/// The edge function along a row of pixels: not negative inside. With the top-left rule, a pixel centre on an edge is
/// inside where the edge is a top or a left one, so that exactly one of two neighbours covers it.
pub(super) struct EdgeFunction {
    /// Value at the first pixel of a row.
    pub start: i64,
    pub per_pixel: i64,
    pub per_row: i64,
}

impl EdgeFunction {
    /// The edge function of a clockwise edge, in rows that start at pixel (x, y).
    #[inline(always)]
    pub fn new([from, to]: [[i32; 2]; 2], x: usize, y: usize) -> Self {
        let (dx, dy) = (i64::from(to[0] - from[0]), i64::from(to[1] - from[1]));
        let top_or_left = dy < 0 || (dy == 0 && dx > 0);
        let bias = if top_or_left { 0 } else { -1 };
        let subpixels = i64::from(SUBPIXELS);
        EdgeFunction {
            start: doubled_area(from, to, pixel_centre(x, y)) + bias,
            per_pixel: -dy * subpixels,
            per_row: dx * subpixels,
        }
    }

    /// Narrows a span of pixels of the row to those inside.
    #[inline(always)]
    pub fn narrow(&self, low: &mut i64, high: &mut i64) {
        match self.per_pixel {
            0 if self.start < 0 => *high = *low,
            0 => {}
            // start + per_pixel x >= 0.
            rise if rise > 0 => *low = (*low).max((-self.start + rise - 1).div_euclid(rise)),
            fall => *high = (*high).min(self.start.div_euclid(-fall) + 1),
        }
    }
}
