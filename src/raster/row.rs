//! A row of a tile: what each pixel shows, as arrays that can be shaded eight pixels at a time.

use super::packet::{LANES, Vec3x8};
use glam::Vec3;
use std::ops::Range;
use wide::f32x8;

/// Pixels of a row.
pub(super) const WIDTH: usize = 64;

/// The numbers of a row's pixels.
pub(super) const STEPS: [f32; WIDTH] = {
    let mut steps = [0.0; WIDTH];
    let mut i = 0;
    while i < WIDTH {
        steps[i] = i as f32;
        i += 1;
    }
    steps
};

/// Pixels in a row that show one triangle. Weights of its three corners, over distance, are affine on the screen.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub first: usize,
    pub end: usize,
    /// At the first pixel.
    pub start: Vec3,
    /// From one pixel to the next.
    pub step: Vec3,
}

impl Run {
    pub fn pixels(&self) -> Range<usize> {
        self.first..self.end
    }

    /// Weights of the corners at a pixel, correct in perspective.
    pub fn weights(&self, x: usize) -> Vec3 {
        let over_distance = self.start + self.step * (x - self.first) as f32;
        over_distance / over_distance.element_sum()
    }
}

/// The pixels.
#[derive(Debug)]
pub(super) struct Row {
    pub surface: [u32; WIDTH],
    /// Two blended vectors: point and normal, or matte and glossy light.
    blended: [[f32; WIDTH]; 6],
    face: [[f32; WIDTH]; 3],
    /// Colour of the texture; one where there is none.
    texel: [[f32; WIDTH]; 3],
}

impl Row {
    /// Pixels that show nothing.
    pub fn new(nothing: u32) -> Self {
        Row { surface: [nothing; WIDTH], blended: [[0.0; WIDTH]; 6], face: [[0.0; WIDTH]; 3], texel: [[1.0; WIDTH]; 3] }
    }

    /// Two vectors for every pixel of a run, blended from those at the corners.
    pub fn blend(&mut self, run: &Run, first: [Vec3; 3], second: [Vec3; 3]) {
        let mut distances = [0.0; WIDTH];
        let (start, step) = (run.start.element_sum(), run.step.element_sum());
        for (distance, i) in distances[..run.end - run.first].iter_mut().zip(&STEPS) {
            *distance = 1.0 / (start + step * i);
        }
        for (component, row) in self.blended.iter_mut().enumerate() {
            let corners = if component < 3 { first } else { second };
            let values = Vec3::from(corners.map(|corner| corner[component % 3]));
            let (start, step) = (run.start.dot(values), run.step.dot(values));
            for ((value, distance), i) in row[run.pixels()].iter_mut().zip(&distances).zip(&STEPS) {
                *value = (start + step * i) * distance;
            }
        }
    }

    /// The triangle's plane.
    pub fn set_face(&mut self, run: &Run, face: Vec3) {
        for (row, value) in self.face.iter_mut().zip(face.to_array()) {
            row[run.pixels()].fill(value);
        }
    }

    /// No texture.
    pub fn set_plain(&mut self, run: &Run) {
        self.texel.iter_mut().for_each(|row| row[run.pixels()].fill(1.0));
    }

    /// The texture at a pixel.
    pub fn set_texel(&mut self, x: usize, colour: Vec3) {
        self.texel.iter_mut().zip(colour.to_array()).for_each(|(row, value)| row[x] = value);
    }

    /// The blended vectors of eight pixels.
    pub fn blended(&self, start: usize) -> (Vec3x8, Vec3x8) {
        let [a, b, c, d, e, f] = &self.blended;
        (eight([a, b, c], start), eight([d, e, f], start))
    }

    /// The textures at eight pixels.
    pub fn texel(&self, start: usize) -> Vec3x8 {
        eight(self.texel.each_ref(), start)
    }

    /// The planes of eight pixels.
    pub fn face(&self, start: usize) -> Vec3x8 {
        eight(self.face.each_ref(), start)
    }
}

fn eight(rows: [&[f32; WIDTH]; 3], start: usize) -> Vec3x8 {
    let [x, y, z] = rows.map(|row| f32x8::from(std::array::from_fn::<f32, LANES, _>(|k| row[start + k])));
    Vec3x8 { x, y, z }
}
