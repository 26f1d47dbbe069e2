//! A view of a live picture with less grain, for while it settles: an edge-aware filter that never goes into the sums.
//!
//! The à-trous wavelet of Dammertz, Sewtz, Hanika and Lensch (2010, "Edge-Avoiding À-Trous Wavelet Transform for fast
//! Global Illumination Filtering"): each pass looks twice as far as the one before, here at four places, in turn beside
//! and across, and neighbours count by how well their surface (object, material, normal, plane) and their light agree
//! with the pixel's. Light is what is left when the texture is divided out, so that patterns stay sharp. Two lights
//! agree within the grain that so many samples have: the filter fades by itself as the picture converges. Mirrors,
//! glass and polished things, whose pictures lie elsewhere than their surfaces, are left as they are.

use super::tile::Shown;
use crate::math::simd::{self, Avx2, SimdTask};
use crate::photo::Picture;
use glam::Vec3;
use rayon::prelude::*;

/// Passes, with steps of 1, 2, 4 and 8 pixels, and the mean number of samples from which fewer will do: there is less
/// grain, and less that still counts as grain.
const PASSES: [(f32, i32); 3] = [(64.0, 2), (16.0, 3), (0.0, 4)];
/// Relative grain of one sample that still counts as the same light.
const GRAIN_OF_ONE: f32 = 1.6;
/// Gloss narrower than this mirrors things: roughness 0.3, squared.
const LEAST_ALPHA: f32 = 0.09;
/// How far a neighbour may lie off the pixel's plane, parts of its distance from the eye.
const OFF_PLANE: f32 = 0.01;
/// Light that counts as none, parts of display white: keeps relative differences finite.
const DARK: f32 = 1e-3;
/// Texture that counts as black.
const LEAST_TEXTURE: f32 = 0.02;
/// Pixels to the neighbours whose mean grain is judged against.
const AROUND: isize = 2;
/// Weight of a neighbour that agrees in everything, against the pixel's own.
const SIDE: f32 = 0.75;
/// Neighbours of a pass, to the right and down; every second pass has the others.
const CROSS: [[isize; 2]; 4] = [[-1, 0], [1, 0], [0, -1], [0, 1]];
const DIAGONALS: [[isize; 2]; 4] = [[-1, -1], [1, -1], [-1, 1], [1, 1]];
/// Pixels of a row that are worked on at a time.
const BLOCK: usize = 64;
/// Room beside each row, pixels: the longest step.
const MARGIN: usize = 8;

/// Lines of a row of surfaces: what they say, and how much grain their light has.
const SURFACE_LINES: usize = 9;
/// A number for each object and material; 0, which is like nothing, where there is no surface to smooth.
const KEY: usize = 0;
/// Three lines each, x, y and z.
const NORMAL: usize = 1;
const POSITION: usize = 4;
/// One over the distance off the plane at which a neighbour counts no more, 1/m.
const REACH: usize = 7;
/// Difference of light that counts half; before the mean light is known, for a light of one.
const GRAIN: usize = 8;
/// Lines of a row of light.
const LIGHT_LINES: usize = 3;

/// What a pixel of the picture says of its surface.
#[derive(Clone, Copy, Debug)]
pub struct Guide {
    /// What its first ray met.
    pub shown: Shown,
    /// What counts as far there, metres; see [`super::LiveCamera::depth_scale`].
    pub scale: f32,
    /// Samples behind its value.
    pub samples: f32,
}

impl Guide {
    /// Of no surface.
    pub const NONE: Self = Guide { shown: Shown::VOID, scale: 1.0, samples: 0.0 };
}

/// Rows of a picture, each with some lines of a number a pixel. Lines have room around them: blocks reach over their
/// ends without a question.
#[derive(Debug, Default)]
struct Rows {
    numbers: Vec<f32>,
    lines: usize,
    /// Length of a line.
    stride: usize,
}

impl Rows {
    /// Takes a size. Where it is another one, all numbers are 0.
    fn resize(&mut self, lines: usize, width: usize, height: usize) {
        let stride = MARGIN + width.next_multiple_of(BLOCK) + MARGIN;
        if (self.lines, self.stride, self.numbers.len()) != (lines, stride, lines * stride * height) {
            *self = Rows { numbers: vec![0.0; lines * stride * height], lines, stride };
        }
    }

    fn row(&self, y: usize) -> &[f32] {
        &self.numbers[y * self.lines * self.stride..][..self.lines * self.stride]
    }

    fn each_mut(&mut self) -> impl IndexedParallelIterator<Item = &mut [f32]> {
        self.numbers.par_chunks_mut(self.lines * self.stride)
    }

    fn height(&self) -> usize {
        self.numbers.len() / (self.lines * self.stride)
    }
}

/// Pixels of a line, side by side.
type Line = [f32; BLOCK];

/// Where a line's pixel stands in its row.
#[inline(always)]
fn place(stride: usize, line: usize, x: usize) -> usize {
    line * stride + MARGIN + x
}

/// Smooths pictures. Keeps its memory from one to the next: fifteen numbers a pixel.
#[derive(Debug, Default)]
pub struct Smoother {
    surfaces: Rows,
    lights: Rows,
    /// What a pass makes of the lights.
    next: Rows,
}

impl Smoother {
    /// Smooths a picture; `guide` says what its pixel (x, y) shows.
    pub fn smooth(&mut self, picture: &mut Picture, guide: impl Fn(usize, usize) -> Guide + Sync) {
        if picture.rgb.is_empty() {
            return;
        }
        let samples = self.take_in(picture, &guide);
        self.judge_grain();
        let passes = PASSES.into_iter().find(|(from, _)| samples >= *from).map_or(0, |(_, passes)| passes);
        for pass in 0..passes {
            let sides = if pass % 2 == 0 { CROSS } else { DIAGONALS };
            // The grain falls by half with every pass.
            self.pass(&sides.map(|side| side.map(|steps| steps << pass)), Some(0.25_f32.powi(pass)));
            std::mem::swap(&mut self.lights, &mut self.next);
        }
        let (surfaces, lights) = (&self.surfaces, &self.lights);
        picture.rgb.par_chunks_mut(picture.width as usize).enumerate().for_each(|(y, row)| {
            let (surface, light) = (surfaces.row(y), lights.row(y));
            for (x, rgb) in row.iter_mut().enumerate() {
                if surface[place(surfaces.stride, KEY, x)] != 0.0 {
                    let light = [0, 1, 2].map(|line| light[place(lights.stride, line, x)]);
                    *rgb = (Vec3::from(light) * texture(&guide(x, y).shown)).into();
                }
            }
        });
    }

    /// Lays out what a picture's pixels show; gives the mean number of samples.
    fn take_in(&mut self, picture: &Picture, guide: &(impl Fn(usize, usize) -> Guide + Sync)) -> f32 {
        let (width, height) = (picture.width as usize, picture.height as usize);
        self.surfaces.resize(SURFACE_LINES, width, height);
        self.lights.resize(LIGHT_LINES, width, height);
        self.next.resize(LIGHT_LINES, width, height);
        let stride = self.surfaces.stride;
        let rows = picture.rgb.par_chunks(width).zip(self.surfaces.each_mut()).zip(self.lights.each_mut());
        let samples = rows.enumerate().map(|(y, ((rgb, surfaces), lights))| {
            let take = |(x, rgb): (usize, &[f32; 3])| {
                let Guide { shown, scale, samples } = guide(x, y);
                let light = Vec3::from(*rgb) / texture(&shown);
                for axis in 0..3 {
                    surfaces[place(stride, NORMAL + axis, x)] = shown.normal[axis];
                    surfaces[place(stride, POSITION + axis, x)] = shown.position[axis];
                    lights[place(stride, axis, x)] = light[axis];
                }
                surfaces[place(stride, KEY, x)] = key(&shown);
                surfaces[place(stride, REACH, x)] = (OFF_PLANE * scale).max(1e-6).recip();
                surfaces[place(stride, GRAIN, x)] = GRAIN_OF_ONE / samples.max(1.0).sqrt();
                samples
            };
            rgb.iter().enumerate().map(take).sum::<f32>()
        });
        samples.collect::<Vec<f32>>().into_iter().sum::<f32>() / picture.rgb.len() as f32
    }

    /// Grain is judged against the mean around a pixel: against the pixel itself, bright ones would count more.
    fn judge_grain(&mut self) {
        self.pass(&CROSS.map(|side| side.map(|steps| AROUND * steps)), None);
        let (means, stride) = (&self.next, self.surfaces.stride);
        self.surfaces.each_mut().enumerate().for_each(|(y, surfaces)| {
            let lights = means.row(y);
            for x in 0..stride - 2 * MARGIN {
                let [r, g, b] = [0, 1, 2].map(|line| lights[place(stride, line, x)]);
                surfaces[place(stride, GRAIN, x)] *= brightness(r, g, b) + DARK;
            }
        });
    }

    /// Each pixel's mean with its neighbours at `sides`, pixels to the right and down. `part` is of the grain's square;
    /// without it, light is not asked to agree.
    fn pass(&mut self, sides: &[[isize; 2]; 4], part: Option<f32>) {
        let Smoother { surfaces, lights, next } = self;
        next.each_mut().enumerate().for_each(|(y, out)| {
            simd::dispatch(RowMeans { surfaces, lights, y, sides, part, out });
        });
    }
}

/// A number for an object with its material. Two that share one by chance are still told apart by normal and plane.
fn key(shown: &Shown) -> f32 {
    let mixed = shown.object.wrapping_mul(0x9e37_79b1) ^ shown.material.wrapping_mul(0x85eb_ca6b).rotate_left(16);
    if shown.alpha < LEAST_ALPHA { 0.0 } else { (1 + (mixed >> 10)) as f32 }
}

fn texture(shown: &Shown) -> Vec3 {
    shown.texture.max(Vec3::splat(LEAST_TEXTURE))
}

/// A row of [`Smoother::pass`].
struct RowMeans<'a> {
    surfaces: &'a Rows,
    lights: &'a Rows,
    y: usize,
    sides: &'a [[isize; 2]; 4],
    part: Option<f32>,
    out: &'a mut [f32],
}

impl SimdTask for RowMeans<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: Option<Avx2>) {
        let stride = self.surfaces.stride;
        let own = (self.surfaces.row(self.y), self.lights.row(self.y));
        for x in (0..stride - 2 * MARGIN).step_by(BLOCK) {
            let own = Block::at(own, stride, x, 0);
            let (mut weights, mut sums) = ([1.0; BLOCK], [[0.0; BLOCK]; 3]);
            for (sum, light) in sums.iter_mut().zip(own.light) {
                sum.copy_from_slice(light);
            }
            for [right, down] in self.sides {
                let y = self.y.wrapping_add_signed(*down);
                if y < self.surfaces.height() {
                    let there = Block::at((self.surfaces.row(y), self.lights.row(y)), stride, x, *right);
                    let alike = if let Some(part) = self.part { own.alike(&there, part) } else { [1.0; BLOCK] };
                    own.gather(&there, &alike, &mut weights, &mut sums);
                }
            }
            for (line, sum) in sums.iter().enumerate() {
                let out = &mut self.out[place(stride, line, x)..][..BLOCK];
                for i in 0..BLOCK {
                    out[i] = sum[i] / weights[i];
                }
            }
        }
    }
}

/// Pixels side by side.
struct Block<'a> {
    key: &'a Line,
    normal: [&'a Line; 3],
    position: [&'a Line; 3],
    reach: &'a Line,
    grain: &'a Line,
    light: [&'a Line; 3],
}

impl<'a> Block<'a> {
    /// `right` of pixel x of a row of surfaces and one of lights.
    #[inline(always)]
    fn at((surfaces, lights): (&'a [f32], &'a [f32]), stride: usize, x: usize, right: isize) -> Self {
        let first = |line: usize| place(stride, line, x).wrapping_add_signed(right);
        Block {
            key: block(surfaces, first(KEY)),
            normal: [0, 1, 2].map(|axis| block(surfaces, first(NORMAL + axis))),
            position: [0, 1, 2].map(|axis| block(surfaces, first(POSITION + axis))),
            reach: block(surfaces, first(REACH)),
            grain: block(surfaces, first(GRAIN)),
            light: [0, 1, 2].map(|line| block(lights, first(line))),
        }
    }

    /// Adds other pixels to the sums of these, as far as their surfaces are the same and `alike` says.
    #[inline(always)]
    fn gather(&self, there: &Block, alike: &Line, weights: &mut Line, [r, g, b]: &mut [Line; 3]) {
        for i in 0..BLOCK {
            let normal = vector(&self.normal, i);
            let facing = at_least_0(normal.dot(vector(&there.normal, i)));
            let facing = facing * facing;
            let facing = facing * facing;
            let facing = facing * facing;
            let aside = (vector(&there.position, i) - vector(&self.position, i)).dot(normal).abs();
            let near = at_least_0(1.0 - aside * self.reach[i]);
            let same = (self.key[i] == there.key[i]) & (self.key[i] != 0.0);
            let weight = if same { facing * near * alike[i] * SIDE } else { 0.0 };
            weights[i] += weight;
            r[i] += weight * there.light[0][i];
            g[i] += weight * there.light[1][i];
            b[i] += weight * there.light[2][i];
        }
    }

    /// How much the light of these pixels is that of the others.
    #[inline(always)]
    fn alike(&self, there: &Block, part: f32) -> Line {
        let mut alike = [0.0; BLOCK];
        for (i, alike) in alike.iter_mut().enumerate() {
            let [r, g, b] = (vector(&there.light, i) - vector(&self.light, i)).to_array();
            let apart = brightness(r, g, b);
            // The same from either side: otherwise the brighter ones would have more weight, or less.
            let allowed = (self.grain[i] + there.grain[i]) * 0.5;
            let allowed = allowed * allowed * part;
            *alike = allowed / (allowed + apart * apart);
        }
        alike
    }
}

#[inline(always)]
fn block(row: &[f32], first: usize) -> &Line {
    // Always there: rows have a margin as wide as the longest step.
    row[first..].first_chunk().unwrap_or(&[0.0; BLOCK])
}

#[inline(always)]
fn vector([x, y, z]: &[&Line; 3], i: usize) -> Vec3 {
    Vec3::new(x[i], y[i], z[i])
}

#[inline(always)]
fn at_least_0(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// About the luminance, in numbers that a processor likes.
#[inline(always)]
fn brightness(r: f32, g: f32, b: f32) -> f32 {
    0.25 * r + 0.5 * g + 0.25 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    type Case = Box<dyn Fn(usize, usize) -> Guide + Sync>;

    const WIDTH: usize = 96;
    const HEIGHT: usize = 64;

    fn guide(x: usize, y: usize) -> Guide {
        let position = Vec3::new(x as f32, y as f32, 0.0) * 0.01;
        let shown = Shown { position, normal: Vec3::Z, object: 1, material: 2, alpha: 0.5, texture: Vec3::ONE };
        Guide { shown, scale: 3.0, samples: 1.0 }
    }

    fn smooth(picture: &mut Picture, guide: impl Fn(usize, usize) -> Guide + Sync) {
        // What a picture of another size and other things left behind makes no difference.
        let mut smoother = Smoother::default();
        for (width, height) in [(WIDTH as u32 + 40, 7), (picture.width, picture.height)] {
            smoother.smooth(&mut Picture::new(width, height), |x, y| Guide { samples: 9.0, ..self::guide(y, x) });
        }
        smoother.smooth(picture, guide);
    }

    /// Grain with a mean of 1, between 0 and 2: numbers from Steele and Vigna's SplitMix64.
    fn grain(i: usize) -> f32 {
        let mut z = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32
    }

    fn picture(of: impl Fn(usize) -> f32) -> Picture {
        let mut picture = Picture::new(WIDTH as u32, HEIGHT as u32);
        picture.rgb.iter_mut().enumerate().for_each(|(i, rgb)| *rgb = [of(i); 3]);
        picture
    }

    fn mean_and_deviation(values: &[f32]) -> (f32, f32) {
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        let square = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f32>();
        (mean, (square / values.len() as f32).sqrt())
    }

    fn green(picture: &Picture) -> Vec<f32> {
        picture.rgb.iter().map(|rgb| rgb[1]).collect()
    }

    #[test]
    fn the_grain_of_a_flat_wall_falls_to_an_eighth_and_its_mean_stays() {
        let mut wall = picture(|i| 0.3 * grain(i));
        let (mean, before) = mean_and_deviation(&green(&wall));
        smooth(&mut wall, guide);
        let (smoothed, after) = mean_and_deviation(&green(&wall));
        assert!((smoothed / mean - 1.0).abs() < 0.01, "{smoothed} for {mean}");
        assert!(after < 0.125 * before, "{after} of {before}");
    }

    #[test]
    fn with_many_samples_the_picture_is_left_alone() {
        let mut wall = picture(|i| 0.3 * grain(i));
        let before = green(&wall);
        smooth(&mut wall, |x, y| Guide { samples: 1e6, ..guide(x, y) });
        let off = green(&wall).iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 0.01, "{off}");
    }

    #[test]
    fn edges_of_normal_thing_plane_and_texture_stay_sharp() {
        let half = WIDTH / 2;
        let (bright, dark) = (0.5, 0.4);
        let step = |i: usize| if i % WIDTH < half { bright } else { dark };
        let turned = move |x: usize| if x < half { Vec3::Z } else { Vec3::X };
        let cases: [(&str, Case); 4] = [
            (
                "normal",
                Box::new(move |x, y| {
                    let plain = guide(x, y);
                    Guide { shown: Shown { normal: turned(x), ..plain.shown }, ..plain }
                }),
            ),
            (
                "thing",
                Box::new(move |x, y| {
                    let plain = guide(x, y);
                    Guide { shown: Shown { object: u32::from(x < half), ..plain.shown }, ..plain }
                }),
            ),
            (
                "plane",
                Box::new(move |x, y| {
                    let plain = guide(x, y);
                    let back = if x < half { Vec3::ZERO } else { Vec3::NEG_Z * 0.1 };
                    Guide { shown: Shown { position: plain.shown.position + back, ..plain.shown }, ..plain }
                }),
            ),
            (
                "texture",
                Box::new(move |x, y| {
                    let plain = guide(x, y);
                    let texture = Vec3::splat(if x < half { bright } else { dark });
                    Guide { shown: Shown { texture, ..plain.shown }, ..plain }
                }),
            ),
        ];
        for (name, case) in cases {
            let mut picture = picture(step);
            smooth(&mut picture, case);
            for (i, value) in green(&picture).into_iter().enumerate() {
                assert!((value - step(i)).abs() < 1e-4, "{name}: {value} at {} for {}", i % WIDTH, step(i));
            }
        }
        // Without any of them the filter would have washed it out.
        let mut picture = picture(step);
        smooth(&mut picture, guide);
        assert!((green(&picture)[half] - dark).abs() > 0.01);
    }

    #[test]
    fn polished_things_glass_and_the_void_are_left_as_they_are() {
        for alpha in [0.0, 0.05, Shown::NEVER] {
            let mut mirror = picture(|i| 0.3 * grain(i));
            let before = mirror.clone();
            smooth(&mut mirror, |x, y| {
                let plain = guide(x, y);
                Guide { shown: Shown { alpha, ..plain.shown }, ..plain }
            });
            assert_eq!(mirror, before);
        }
    }

    #[test]
    fn pictures_smaller_than_a_step_and_values_that_are_none_do_no_harm() {
        for (width, height) in [(1, 1), (1, 9), (9, 1), (3, 5)] {
            let mut small = Picture::new(width, height);
            small.rgb.iter_mut().for_each(|rgb| *rgb = [0.25; 3]);
            smooth(&mut small, guide);
            assert!(small.rgb.iter().flatten().all(|value| (value - 0.25).abs() < 1e-6));
        }
        smooth(&mut Picture::default(), guide);
    }
}
