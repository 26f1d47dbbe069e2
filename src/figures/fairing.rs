//! Fairs edges of garments: removes the waves that the cut of a coarse mesh and folds leave, by a Fourier series.

use super::patch::Patch;
use super::subdivide::SubdivisionSurface;
use crate::math::find_interval;
use glam::Vec3;
use std::f32::consts::TAU;

/// Harmonics of an edge of a patch that are kept: the first is a tilted ellipse, which the second one bends.
const PATCH_HARMONICS: usize = 2;
/// Points at equal distances at which a line is sampled.
const SAMPLES: usize = 128;

impl Patch {
    /// Moves the vertices of edges to smooth closed lines. `is_wanted` tells, by their sources, which vertices are on such
    /// an edge; those edges are faired most of whose vertices are.
    pub fn fair_edges(&mut self, is_wanted: &dyn Fn(u16) -> bool) {
        let surface = SubdivisionSurface::new(self.clone().into_mesh(0, &|_| Vec3::ZERO));
        for edge in surface.border_loops() {
            let count = edge.iter().filter(|&&v| is_wanted(self.sources[v as usize])).count();
            if 2 * count > edge.len() {
                let line: Vec<Vec3> = edge.iter().map(|&v| self.positions[v as usize]).collect();
                for (&vertex, position) in edge.iter().zip(low_pass(&line, PATCH_HARMONICS)) {
                    self.positions[vertex as usize] = position;
                }
            }
        }
    }
}

/// Returns the vertices of a closed line moved to its Fourier series over its length, cut after so many harmonics. The
/// line must have a length.
pub fn low_pass(line: &[Vec3], harmonics: usize) -> Vec<Vec3> {
    let ends = line.iter().zip(line.iter().cycle().skip(1));
    let lengths: Vec<f32> = ends.map(|(a, b)| a.distance(*b)).collect();
    let length = lengths.iter().sum::<f32>();

    // Sample the line at equal distances
    let at = |i: usize| {
        let (side, length, along) = find_interval(&lengths, length * i as f32 / SAMPLES as f32)?;
        Some(line[side].lerp(line[(side + 1) % line.len()], along / length))
    };
    let samples: Vec<Vec3> = (0..SAMPLES).filter_map(at).collect();

    // Project it on each harmonic
    let mean = samples.iter().sum::<Vec3>() / SAMPLES as f32;
    let wave = |harmonic: usize| {
        let phase = |i: usize| TAU * (harmonic * i) as f32 / SAMPLES as f32;
        let sum = |part: fn(f32) -> f32| samples.iter().enumerate().map(|(i, p)| *p * part(phase(i))).sum::<Vec3>();
        [sum(f32::cos), sum(f32::sin)].map(|sum| sum * (2.0 / SAMPLES as f32))
    };
    let waves: Vec<[Vec3; 2]> = (1..=harmonics).map(wave).collect();

    // Evaluate the series at the vertices
    let starts = lengths.iter().scan(0.0, |end, side| Some(std::mem::replace(end, *end + side)));
    let point = |start: f32| {
        let phase = TAU * start / length;
        let waves = waves.iter().zip(1_u8..).map(|([cosine, sine], harmonic)| {
            let (sin, cos) = (phase * f32::from(harmonic)).sin_cos();
            *cosine * cos + *sine * sin
        });
        mean + waves.sum::<Vec3>()
    };
    starts.map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bent circle of so many points, to which a higher harmonic is added.
    fn line(count: u16, ripple_m: f32) -> Vec<Vec3> {
        let point = |i: u16| {
            let phase = TAU * f32::from(i) / f32::from(count);
            let (sin, cos) = phase.sin_cos();
            Vec3::new(0.1 * cos, 0.01 * (2.0 * phase).cos() + ripple_m * (5.0 * phase).cos(), 0.1 * sin)
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn a_faired_line_keeps_its_shape_and_loses_its_ripples() {
        let smooth = line(1000, 0.0);
        let to_smooth = |p: &Vec3| smooth.iter().map(|q| p.distance(*q)).fold(f32::MAX, f32::min);
        for ripple_m in [0.0, 0.006] {
            let faired = low_pass(&line(40, ripple_m), PATCH_HARMONICS);
            let farthest = faired.iter().map(to_smooth).fold(0.0, f32::max);
            assert!(farthest < 0.001, "{ripple_m} m: {farthest} m");
        }
    }
}
