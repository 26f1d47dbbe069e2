//! A row of a tile: what each pixel shows, as arrays, so that plain loops shade eight pixels at a time.

use glam::Vec3;
use std::ops::Range;

/// Pixels of a row.
pub(super) const WIDTH: usize = 64;
/// Pixels that are written at a time.
pub(super) const LANES: usize = 8;
/// Pixels that a row has room for: the last eight may reach over its end.
pub(super) const ROOM: usize = WIDTH + LANES;

/// A number a pixel.
pub(super) type Line = [f32; ROOM];

/// A vector a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vectors(pub [Line; 3]);

impl Vectors {
    pub const ZERO: Self = Vectors([[0.0; ROOM]; 3]);

    #[inline(always)]
    pub fn at(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }

    #[inline(always)]
    pub fn set(&mut self, i: usize, vector: Vec3) {
        let [x, y, z] = &mut self.0;
        (x[i], y[i], z[i]) = (vector.x, vector.y, vector.z);
    }

    /// Gives a run of pixels one vector; see [`spread`].
    #[inline(always)]
    pub fn spread(&mut self, pixels: &Range<usize>, vector: Vec3) {
        let [x, y, z] = &mut self.0;
        spread(x, pixels, vector.x);
        spread(y, pixels, vector.y);
        spread(z, pixels, vector.z);
    }
}

/// Gives a run of pixels one value, and up to seven behind it, which are written later or show nothing.
#[inline(always)]
pub(super) fn spread<T: Copy>(line: &mut [T; ROOM], pixels: &Range<usize>, value: T) {
    for from in pixels.clone().step_by(LANES) {
        line[from..from + LANES].fill(value);
    }
}

/// What is blended between the corners of a triangle: two vectors, point and normal or matte and glossy light, and a
/// place on the texture.
pub(super) type Attributes = [f32; 8];

/// Pixels in a row that show one triangle. Weights of its three corners, over distance, are affine on the screen.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub pixels: Range<usize>,
    /// At the first pixel.
    pub start: Vec3,
    /// From one pixel to the next.
    pub step: Vec3,
}

/// The pixels. Runs are noted from left to right.
#[derive(Debug)]
pub(super) struct Row {
    pub surface: [u32; ROOM],
    pub first: Vectors,
    pub second: Vectors,
    pub uv: [Line; 2],
    /// Normal of the triangle's plane, of any length.
    pub face: Vectors,
}

impl Row {
    /// Pixels that show nothing.
    pub fn new(nothing: u32) -> Self {
        let (surface, uv) = ([nothing; ROOM], [[0.0; ROOM]; 2]);
        Row { surface, first: Vectors::ZERO, second: Vectors::ZERO, uv, face: Vectors::ZERO }
    }

    /// The surfaces of the first `width` pixels, each with the pixels that show it.
    #[inline(always)]
    pub fn surfaces(&self, width: usize) -> impl Iterator<Item = (u32, Range<usize>)> {
        let mut first = 0;
        self.surface[..width].chunk_by(|a, b| a == b).map(move |same| {
            first += same.len();
            (same[0], first - same.len()..first)
        })
    }

    /// Blends what stands at the corners for every pixel of a run, correct in perspective: affine on the screen are
    /// every attribute over distance, and one over distance.
    #[inline(always)]
    pub fn blend(&mut self, run: &Run, [a, b, c]: [&Attributes; 3]) {
        let blended = |w: Vec3| -> Attributes { std::array::from_fn(|k| a[k] * w.x + b[k] * w.y + c[k] * w.z) };
        let (start, step) = (blended(run.start), blended(run.step));
        let (nearness, nearness_step) = (run.start.element_sum(), run.step.element_sum());
        let Row { first: Vectors([x, y, z]), second: Vectors([p, q, r]), uv: [u, v], .. } = self;
        let mut lines = [x, y, z, p, q, r, u, v];
        for from in run.pixels.clone().step_by(LANES) {
            // Always so; the compiler knows it, too, and asks no more.
            let from = from.min(WIDTH);
            let i: [f32; LANES] = std::array::from_fn(|lane| (from - run.pixels.start + lane) as f32);
            let distance: [f32; LANES] = std::array::from_fn(|lane| 1.0 / (nearness + nearness_step * i[lane]));
            for (k, line) in lines.iter_mut().enumerate() {
                for lane in 0..LANES {
                    line[from + lane] = (start[k] + step[k] * i[lane]) * distance[lane];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_of_neighbouring_runs_has_what_its_own_run_gives_it() {
        let corner = |k: usize| -> Attributes { std::array::from_fn(|i| (k * 10 + i) as f32) };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let run = |pixels: Range<usize>| {
            let start = Vec3::new(0.2 + pixels.start as f32, 0.5, 0.3);
            Run { pixels, start, step: Vec3::new(0.01, -0.002, 0.003) }
        };
        let runs = [0..1, 1..3, 3..30, 30..37, 37..64].map(run);
        let mut row = Row::new(7);
        for run in &runs {
            row.blend(run, [&a, &b, &c]);
            spread(&mut row.surface, &run.pixels, run.pixels.start as u32);
        }
        for run in runs {
            for x in run.pixels.clone() {
                let over_distance = run.start + run.step * (x - run.pixels.start) as f32;
                let weights = over_distance / over_distance.element_sum();
                let of = |i: usize| weights.dot(Vec3::new(a[i], b[i], c[i]));
                assert!((row.first.at(x) - Vec3::new(of(0), of(1), of(2))).length() < 1e-4, "{x}");
                assert!((row.second.at(x) - Vec3::new(of(3), of(4), of(5))).length() < 1e-4, "{x}");
                assert!((row.uv[0][x] - of(6)).abs() + (row.uv[1][x] - of(7)).abs() < 1e-4, "{x}");
                assert_eq!(row.surface[x], run.pixels.start as u32);
            }
        }
        assert_eq!(row.surfaces(40).last(), Some((37, 37..40)));
    }
}
