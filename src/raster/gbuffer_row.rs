//! A G-buffer row: the surface attributes of the pixels of one row of a tile, as a structure of arrays, so that plain
//! loops shade eight pixels at a time.

use super::surface_texture::PixelFactors;
use super::viewport::TILE_WIDTH;
use glam::Vec3;
use std::ops::Range;

/// Pixels of a row.
pub(super) const WIDTH: usize = TILE_WIDTH;
/// Pixels that are written at a time.
pub(super) const LANES: usize = 8;
/// Length of a row's arrays: the last eight lanes may extend beyond its end.
pub(super) const PADDED_WIDTH: usize = WIDTH + LANES;

/// A scalar per pixel.
pub(super) type RowScalar = [f32; PADDED_WIDTH];

/// A vector per pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowVec3(pub [RowScalar; 3]);

impl RowVec3 {
    pub const ZERO: Self = RowVec3([[0.0; PADDED_WIDTH]; 3]);

    #[inline(always)]
    pub fn at(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }

    #[inline(always)]
    pub fn set(&mut self, i: usize, vector: Vec3) {
        let [x, y, z] = &mut self.0;
        (x[i], y[i], z[i]) = (vector.x, vector.y, vector.z);
    }

    /// Sets a range of pixels to one vector; see [`splat`].
    #[inline(always)]
    pub fn splat(&mut self, pixels: &Range<usize>, vector: Vec3) {
        let [x, y, z] = &mut self.0;
        splat(x, pixels, vector.x);
        splat(y, pixels, vector.y);
        splat(z, pixels, vector.z);
    }
}

/// Sets a range of pixels to one value, and up to seven after it, which are written later or not shown.
#[inline(always)]
pub(super) fn splat<T: Copy>(row: &mut [T; PADDED_WIDTH], pixels: &Range<usize>, value: T) {
    for from in pixels.clone().step_by(LANES) {
        row[from..from + LANES].fill(value);
    }
}

/// Vertex attributes that are interpolated: two vectors (position from the eye and normal, or for Gouraud shading
/// diffuse and specular light) and texture coordinates.
pub(super) type VertexAttributes = [f32; 8];

/// Consecutive pixels of a row that show one triangle. Barycentric coordinates over w are affine on the screen.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub pixels: Range<usize>,
    /// Barycentric coordinates over w at the first pixel.
    pub start: Vec3,
    /// Their step from pixel to pixel.
    pub step: Vec3,
}

/// The attributes of a row's pixels. Spans are written from left to right.
#[derive(Debug)]
pub(super) struct GBufferRow {
    pub surface: [u32; PADDED_WIDTH],
    /// First interpolated vector.
    pub first: RowVec3,
    /// Second interpolated vector.
    pub second: RowVec3,
    pub uv: [RowScalar; 2],
    /// What textures give to the material, where the surface has textures.
    pub factors: [PixelFactors; PADDED_WIDTH],
    /// Normal of the triangle's plane, of any length.
    pub geometric_normal: RowVec3,
    /// Mean vertex colour of the triangle, where its mesh has colours.
    pub color: RowVec3,
}

impl GBufferRow {
    /// A row of pixels that show `background`.
    pub fn new(background: u32) -> Self {
        let (surface, uv) = ([background; PADDED_WIDTH], [[0.0; PADDED_WIDTH]; 2]);
        let [first, second, geometric_normal, color] = [RowVec3::ZERO; 4];
        let factors = [PixelFactors::ONE; PADDED_WIDTH];
        GBufferRow { surface, first, second, uv, factors, geometric_normal, color }
    }

    /// Returns the surfaces of the first `width` pixels, each with its range of pixels.
    #[inline(always)]
    pub fn surfaces(&self, width: usize) -> impl Iterator<Item = (u32, Range<usize>)> {
        let mut first = 0;
        self.surface[..width].chunk_by(|a, b| a == b).map(move |same| {
            first += same.len();
            (same[0], first - same.len()..first)
        })
    }

    /// Interpolates vertex attributes over a span, perspective-correct: attribute / w and 1/w are affine on the screen.
    #[inline(always)]
    pub fn interpolate(&mut self, span: &Span, [a, b, c]: [&VertexAttributes; 3]) {
        let combine = |w: Vec3| -> VertexAttributes { std::array::from_fn(|k| a[k] * w.x + b[k] * w.y + c[k] * w.z) };
        let (start, step) = (combine(span.start), combine(span.step));
        let (inverse_w, inverse_w_step) = (span.start.element_sum(), span.step.element_sum());
        let GBufferRow { first: RowVec3([x, y, z]), second: RowVec3([p, q, r]), uv: [u, v], .. } = self;
        let mut rows = [x, y, z, p, q, r, u, v];
        for from in span.pixels.clone().step_by(LANES) {
            // Always true; it lets the compiler drop the bounds checks.
            let from = from.min(WIDTH);
            let i: [f32; LANES] = std::array::from_fn(|lane| (from - span.pixels.start + lane) as f32);
            let w: [f32; LANES] = std::array::from_fn(|lane| 1.0 / (inverse_w + inverse_w_step * i[lane]));
            for (k, row) in rows.iter_mut().enumerate() {
                for lane in 0..LANES {
                    row[from + lane] = (start[k] + step[k] * i[lane]) * w[lane];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pixel_of_adjacent_spans_has_the_attributes_of_its_own_span() {
        let vertex = |k: usize| -> VertexAttributes { std::array::from_fn(|i| (k * 10 + i) as f32) };
        let (a, b, c) = (vertex(0), vertex(1), vertex(2));
        let span = |pixels: Range<usize>| {
            let start = Vec3::new(0.2 + pixels.start as f32, 0.5, 0.3);
            Span { pixels, start, step: Vec3::new(0.01, -0.002, 0.003) }
        };
        let spans = [0..1, 1..3, 3..30, 30..37, 37..64].map(span);
        let mut row = GBufferRow::new(7);
        for span in &spans {
            row.interpolate(span, [&a, &b, &c]);
            splat(&mut row.surface, &span.pixels, span.pixels.start as u32);
        }
        for span in spans {
            for x in span.pixels.clone() {
                let over_w = span.start + span.step * (x - span.pixels.start) as f32;
                let barycentric = over_w / over_w.element_sum();
                let of = |i: usize| barycentric.dot(Vec3::new(a[i], b[i], c[i]));
                assert!((row.first.at(x) - Vec3::new(of(0), of(1), of(2))).length() < 1e-4, "{x}");
                assert!((row.second.at(x) - Vec3::new(of(3), of(4), of(5))).length() < 1e-4, "{x}");
                assert!((row.uv[0][x] - of(6)).abs() + (row.uv[1][x] - of(7)).abs() < 1e-4, "{x}");
                assert_eq!(row.surface[x], span.pixels.start as u32);
            }
        }
        assert_eq!(row.surfaces(40).last(), Some((37, 37..40)));
    }
}
