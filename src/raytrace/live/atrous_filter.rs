//! An edge-aware filter for display while the live view converges. It never changes the accumulated samples.
//!
//! The à-trous wavelet filter of Dammertz, Sewtz, Hanika and Lensch (2010, "Edge-Avoiding À-Trous Wavelet Transform for
//! fast Global Illumination Filtering"): each pass doubles the distance to its taps, here four, in turn along the axes
//! and the diagonals. A tap's weight is the product of edge-stopping functions of the surface (object, material,
//! normal, tangent plane) and of the irradiance. The texture is divided out before and multiplied after, so patterns
//! stay sharp. The irradiance function's width is the noise expected of the pixel's samples, so the filter fades as the
//! picture converges. Mirrors, glass and polished surfaces are left unfiltered: their reflections do not lie on the
//! surface.

use super::primary_hit::PrimaryHit;
use crate::math::simd::{self, Avx2, SimdTask};
use crate::photo::Picture;
use glam::Vec3;
use rayon::prelude::*;

/// Number of passes, with taps at 1, 2, 4 and 8 pixels, by the mean number of samples from which it is used.
const PASSES: [(f32, i32); 3] = [(64.0, 2), (16.0, 3), (0.0, 4)];
/// Relative noise of one sample within which two irradiances count as equal.
const NOISE_OF_ONE_SAMPLE: f32 = 1.6;
/// GGX alpha below which a surface shows reflections: roughness 0.3, squared.
const MIN_ALPHA: f32 = 0.09;
/// Distance of a tap off the tangent plane at which its weight is 0, as a fraction of the depth scale.
const MAX_PLANE_DISTANCE: f32 = 0.01;
/// Irradiance that counts as black, as a fraction of display white. Keeps relative differences finite.
const DARK: f32 = 1e-3;
/// Smallest texture value to divide by.
const MIN_TEXTURE: f32 = 0.02;
/// Distance to the neighbours whose mean irradiance the noise is relative to, pixels.
const MEAN_DISTANCE: isize = 2;
/// Weight of a tap that agrees in everything; the centre has 1.
const TAP_WEIGHT: f32 = 0.75;
/// Taps of the even passes, to the right and down.
const AXIS_TAPS: [[isize; 2]; 4] = [[-1, 0], [1, 0], [0, -1], [0, 1]];
/// Taps of the odd passes.
const DIAGONAL_TAPS: [[isize; 2]; 4] = [[-1, -1], [1, -1], [-1, 1], [1, 1]];
/// Pixels of a row that are filtered at a time.
const BLOCK: usize = 64;
/// Padding at both ends of each row, pixels: the largest tap distance.
const PADDING: usize = 8;

/// Channels of the surface rows.
const SURFACE_CHANNELS: usize = 9;
/// Key of object and material; 0, which equals no other, where nothing is filtered.
const KEY: usize = 0;
/// First of three channels: unit normal.
const NORMAL: usize = 1;
/// First of three channels: position, metres.
const POSITION: usize = 4;
/// Inverse of the plane distance at which a tap's weight is 0, 1/m.
const INVERSE_REACH: usize = 7;
/// Difference of irradiance that halves a tap's weight; relative until the mean irradiance is known.
const NOISE: usize = 8;
/// Channels of the irradiance rows: red, green, blue.
const IRRADIANCE_CHANNELS: usize = 3;

/// The filter's input for a pixel.
#[derive(Clone, Copy, Debug)]
pub struct FilterInput {
    /// The primary hit.
    pub hit: PrimaryHit,
    /// Depth scale there, metres; see [`super::LiveCamera::depth_scale`].
    pub depth_scale_m: f32,
    /// Number of samples of the pixel's value.
    pub samples: f32,
}

impl FilterInput {
    /// The input of pixels without a surface.
    pub const BACKGROUND: Self = FilterInput { hit: PrimaryHit::BACKGROUND, depth_scale_m: 1.0, samples: 0.0 };
}

/// A picture in planar rows: each row holds its channels one after the other, with padding at both ends, so that blocks
/// and taps need no bounds tests.
#[derive(Debug, Default)]
struct PlanarRows {
    values: Vec<f32>,
    channels: usize,
    /// Length of a channel of a row, padding included.
    stride: usize,
}

impl PlanarRows {
    /// Sets the size. All values are 0 if it differs.
    fn resize(&mut self, channels: usize, width: usize, height: usize) {
        let stride = PADDING + width.next_multiple_of(BLOCK) + PADDING;
        if (self.channels, self.stride, self.values.len()) != (channels, stride, channels * stride * height) {
            *self = PlanarRows { values: vec![0.0; channels * stride * height], channels, stride };
        }
    }

    fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.channels * self.stride..][..self.channels * self.stride]
    }

    fn rows_mut(&mut self) -> impl IndexedParallelIterator<Item = &mut [f32]> {
        self.values.par_chunks_mut(self.channels * self.stride)
    }

    fn height(&self) -> usize {
        self.values.len() / (self.channels * self.stride)
    }
}

/// One channel of a block of pixels.
type Lanes = [f32; BLOCK];

/// Returns the index of a channel of pixel x in its row.
#[inline(always)]
fn index(stride: usize, channel: usize, x: usize) -> usize {
    channel * stride + PADDING + x
}

/// The edge-aware filter with its buffers, which are kept from picture to picture: fifteen numbers per pixel.
#[derive(Debug, Default)]
pub struct AtrousFilter {
    surfaces: PlanarRows,
    irradiance: PlanarRows,
    /// Destination of a pass.
    filtered: PlanarRows,
}

impl AtrousFilter {
    /// Filters a picture; `input` returns the filter's input for pixel (x, y).
    pub fn apply(&mut self, picture: &mut Picture, input: impl Fn(usize, usize) -> FilterInput + Sync) {
        if picture.rgb.is_empty() {
            return;
        }

        // Divide out the texture, and estimate the noise of each pixel
        let mean_samples = self.load(picture, &input);
        self.scale_noise_by_mean();

        // Run the wavelet passes; each halves the noise of the one before
        let passes = PASSES.into_iter().find(|(from, _)| mean_samples >= *from).map_or(0, |(_, passes)| passes);
        for pass in 0..passes {
            let taps = if pass % 2 == 0 { AXIS_TAPS } else { DIAGONAL_TAPS };
            self.pass(&taps.map(|tap| tap.map(|distance| distance << pass)), Some(0.25_f32.powi(pass)));
            std::mem::swap(&mut self.irradiance, &mut self.filtered);
        }

        // Multiply by the texture again
        let (surfaces, irradiance) = (&self.surfaces, &self.irradiance);
        picture.rgb.par_chunks_mut(picture.width as usize).enumerate().for_each(|(y, row)| {
            let (surface, filtered) = (surfaces.row(y), irradiance.row(y));
            for (x, rgb) in row.iter_mut().enumerate() {
                if surface[index(surfaces.stride, KEY, x)] != 0.0 {
                    let value = [0, 1, 2].map(|channel| filtered[index(irradiance.stride, channel, x)]);
                    *rgb = (Vec3::from(value) * clamped_texture(&input(x, y).hit)).into();
                }
            }
        });
    }

    /// Writes a picture's surfaces and irradiance to the planar rows; returns the mean number of samples.
    fn load(&mut self, picture: &Picture, input: &(impl Fn(usize, usize) -> FilterInput + Sync)) -> f32 {
        let (width, height) = (picture.width as usize, picture.height as usize);
        self.surfaces.resize(SURFACE_CHANNELS, width, height);
        self.irradiance.resize(IRRADIANCE_CHANNELS, width, height);
        self.filtered.resize(IRRADIANCE_CHANNELS, width, height);
        let stride = self.surfaces.stride;
        let rows = picture.rgb.par_chunks(width).zip(self.surfaces.rows_mut()).zip(self.irradiance.rows_mut());
        let samples = rows.enumerate().map(|(y, ((rgb, surfaces), irradiance))| {
            let load_pixel = |(x, rgb): (usize, &[f32; 3])| {
                let FilterInput { hit, depth_scale_m, samples } = input(x, y);
                let value = Vec3::from(*rgb) / clamped_texture(&hit);
                for axis in 0..3 {
                    surfaces[index(stride, NORMAL + axis, x)] = hit.normal[axis];
                    surfaces[index(stride, POSITION + axis, x)] = hit.position[axis];
                    irradiance[index(stride, axis, x)] = value[axis];
                }
                surfaces[index(stride, KEY, x)] = surface_key(&hit);
                surfaces[index(stride, INVERSE_REACH, x)] = (MAX_PLANE_DISTANCE * depth_scale_m).max(1e-6).recip();
                surfaces[index(stride, NOISE, x)] = NOISE_OF_ONE_SAMPLE / samples.max(1.0).sqrt();
                samples
            };
            rgb.iter().enumerate().map(load_pixel).sum::<f32>()
        });
        samples.collect::<Vec<f32>>().into_iter().sum::<f32>() / picture.rgb.len() as f32
    }

    /// Turns relative noise into absolute noise by the mean irradiance around each pixel. Relative to the pixel itself,
    /// bright outliers would have a larger tolerance.
    fn scale_noise_by_mean(&mut self) {
        self.pass(&AXIS_TAPS.map(|tap| tap.map(|distance| MEAN_DISTANCE * distance)), None);
        let (means, stride) = (&self.filtered, self.surfaces.stride);
        self.surfaces.rows_mut().enumerate().for_each(|(y, surfaces)| {
            let mean = means.row(y);
            for x in 0..stride - 2 * PADDING {
                let [r, g, b] = [0, 1, 2].map(|channel| mean[index(stride, channel, x)]);
                surfaces[index(stride, NOISE, x)] *= approximate_luminance(r, g, b) + DARK;
            }
        });
    }

    /// Filters with the taps at these offsets, pixels to the right and down. `variance_scale` is the fraction of the
    /// noise's square that is left; without it, the irradiance does not stop the filter.
    fn pass(&mut self, taps: &[[isize; 2]; 4], variance_scale: Option<f32>) {
        let AtrousFilter { surfaces, irradiance, filtered } = self;
        filtered.rows_mut().enumerate().for_each(|(y, out)| {
            simd::dispatch(RowPass { surfaces, irradiance, y, taps, variance_scale, out });
        });
    }
}

/// Returns a key of object and material. Two surfaces with an equal key by collision still differ in normal or plane.
fn surface_key(hit: &PrimaryHit) -> f32 {
    let mixed = hit.object.wrapping_mul(0x9e37_79b1) ^ hit.material.wrapping_mul(0x85eb_ca6b).rotate_left(16);
    if hit.alpha < MIN_ALPHA { 0.0 } else { (1 + (mixed >> 10)) as f32 }
}

fn clamped_texture(hit: &PrimaryHit) -> Vec3 {
    hit.texture.max(Vec3::splat(MIN_TEXTURE))
}

/// One row of [`AtrousFilter::pass`].
struct RowPass<'a> {
    surfaces: &'a PlanarRows,
    irradiance: &'a PlanarRows,
    y: usize,
    taps: &'a [[isize; 2]; 4],
    variance_scale: Option<f32>,
    out: &'a mut [f32],
}

impl SimdTask for RowPass<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: Option<Avx2>) {
        let stride = self.surfaces.stride;
        let rows = (self.surfaces.row(self.y), self.irradiance.row(self.y));
        for x in (0..stride - 2 * PADDING).step_by(BLOCK) {
            let centre = PixelBlock::at(rows, stride, x, 0);
            let (mut weights, mut sums) = ([1.0; BLOCK], [[0.0; BLOCK]; 3]);
            for (sum, irradiance) in sums.iter_mut().zip(centre.irradiance) {
                sum.copy_from_slice(irradiance);
            }
            for [right, down] in self.taps {
                let y = self.y.wrapping_add_signed(*down);
                if y < self.surfaces.height() {
                    let tap = PixelBlock::at((self.surfaces.row(y), self.irradiance.row(y)), stride, x, *right);
                    let scale = self.variance_scale;
                    let agreement = scale.map_or([1.0; BLOCK], |scale| centre.irradiance_agreement(&tap, scale));
                    centre.accumulate(&tap, &agreement, &mut weights, &mut sums);
                }
            }
            for (channel, sum) in sums.iter().enumerate() {
                let out = &mut self.out[index(stride, channel, x)..][..BLOCK];
                for i in 0..BLOCK {
                    out[i] = sum[i] / weights[i];
                }
            }
        }
    }
}

/// The channels of a block of neighbouring pixels.
struct PixelBlock<'a> {
    key: &'a Lanes,
    normal: [&'a Lanes; 3],
    position: [&'a Lanes; 3],
    inverse_reach: &'a Lanes,
    noise: &'a Lanes,
    irradiance: [&'a Lanes; 3],
}

impl<'a> PixelBlock<'a> {
    /// The block that begins `right` of pixel x of a row.
    #[inline(always)]
    fn at((surfaces, irradiance): (&'a [f32], &'a [f32]), stride: usize, x: usize, right: isize) -> Self {
        let first = |channel: usize| index(stride, channel, x).wrapping_add_signed(right);
        PixelBlock {
            key: lanes(surfaces, first(KEY)),
            normal: [0, 1, 2].map(|axis| lanes(surfaces, first(NORMAL + axis))),
            position: [0, 1, 2].map(|axis| lanes(surfaces, first(POSITION + axis))),
            inverse_reach: lanes(surfaces, first(INVERSE_REACH)),
            noise: lanes(surfaces, first(NOISE)),
            irradiance: [0, 1, 2].map(|channel| lanes(irradiance, first(channel))),
        }
    }

    /// Adds a tap to the sums, weighted by the agreement of the surfaces and of the irradiance.
    #[inline(always)]
    fn accumulate(&self, tap: &PixelBlock, agreement: &Lanes, weights: &mut Lanes, [r, g, b]: &mut [Lanes; 3]) {
        for i in 0..BLOCK {
            // Normals: the eighth power of the cosine
            let normal = vector(&self.normal, i);
            let cosine = clamp_negative(normal.dot(vector(&tap.normal, i)));
            let squared = cosine * cosine;
            let fourth = squared * squared;
            let normal_weight = fourth * fourth;

            // Tangent plane: linear in the distance
            let plane_distance = (vector(&tap.position, i) - vector(&self.position, i)).dot(normal).abs();
            let plane_weight = clamp_negative(1.0 - plane_distance * self.inverse_reach[i]);

            // Object and material: all or nothing
            let is_same = (self.key[i] == tap.key[i]) & (self.key[i] != 0.0);
            let weight = if is_same { normal_weight * plane_weight * agreement[i] * TAP_WEIGHT } else { 0.0 };
            weights[i] += weight;
            r[i] += weight * tap.irradiance[0][i];
            g[i] += weight * tap.irradiance[1][i];
            b[i] += weight * tap.irradiance[2][i];
        }
    }

    /// Returns the edge-stopping weight of the irradiance, a Lorentzian whose width is the noise.
    #[inline(always)]
    fn irradiance_agreement(&self, tap: &PixelBlock, variance_scale: f32) -> Lanes {
        let mut agreement = [0.0; BLOCK];
        for (i, agreement) in agreement.iter_mut().enumerate() {
            let [r, g, b] = (vector(&tap.irradiance, i) - vector(&self.irradiance, i)).to_array();
            let difference = approximate_luminance(r, g, b);
            // Symmetric in both pixels: otherwise bright ones would have more weight, or less.
            let noise = (self.noise[i] + tap.noise[i]) * 0.5;
            let variance = noise * noise * variance_scale;
            *agreement = variance / (variance + difference * difference);
        }
        agreement
    }
}

#[inline(always)]
fn lanes(row: &[f32], first: usize) -> &Lanes {
    // Always there: the padding is as wide as the largest tap distance.
    row[first..].first_chunk().unwrap_or(&[0.0; BLOCK])
}

#[inline(always)]
fn vector([x, y, z]: &[&Lanes; 3], i: usize) -> Vec3 {
    Vec3::new(x[i], y[i], z[i])
}

/// `max(x, 0)` in a form that compiles to one instruction; NaN becomes 0.
#[inline(always)]
fn clamp_negative(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// Luminance with weights of powers of two.
#[inline(always)]
fn approximate_luminance(r: f32, g: f32, b: f32) -> f32 {
    0.25 * r + 0.5 * g + 0.25 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    type Case = Box<dyn Fn(usize, usize) -> FilterInput + Sync>;

    const WIDTH: usize = 96;
    const HEIGHT: usize = 64;

    fn input(x: usize, y: usize) -> FilterInput {
        let position = Vec3::new(x as f32, y as f32, 0.0) * 0.01;
        let hit = PrimaryHit { position, normal: Vec3::Z, object: 1, material: 2, alpha: 0.5, texture: Vec3::ONE };
        FilterInput { hit, depth_scale_m: 3.0, samples: 1.0 }
    }

    fn filter_picture(picture: &mut Picture, input: impl Fn(usize, usize) -> FilterInput + Sync) {
        // Buffers of another size and other surfaces must not leak into the result.
        let mut filter = AtrousFilter::default();
        for (width, height) in [(WIDTH as u32 + 40, 7), (picture.width, picture.height)] {
            filter.apply(&mut Picture::new(width, height), |x, y| FilterInput { samples: 9.0, ..self::input(y, x) });
        }
        filter.apply(picture, input);
    }

    /// Uniform noise with a mean of 1, between 0 and 2, by Steele and Vigna's SplitMix64.
    fn noise(i: usize) -> f32 {
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
    fn noise_on_a_flat_wall_falls_to_an_eighth_and_its_mean_is_kept() {
        let mut wall = picture(|i| 0.3 * noise(i));
        let (mean, before) = mean_and_deviation(&green(&wall));
        filter_picture(&mut wall, input);
        let (smoothed, after) = mean_and_deviation(&green(&wall));
        assert!((smoothed / mean - 1.0).abs() < 0.01, "{smoothed} for {mean}");
        assert!(after < 0.125 * before, "{after} of {before}");
    }

    #[test]
    fn a_picture_with_many_samples_is_not_filtered() {
        let mut wall = picture(|i| 0.3 * noise(i));
        let before = green(&wall);
        filter_picture(&mut wall, |x, y| FilterInput { samples: 1e6, ..input(x, y) });
        let off = green(&wall).iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 0.01, "{off}");
    }

    #[test]
    fn edges_of_normal_object_plane_and_texture_stay_sharp() {
        let half = WIDTH / 2;
        let (bright, dark) = (0.5, 0.4);
        let step = |i: usize| if i % WIDTH < half { bright } else { dark };
        let turned = move |x: usize| if x < half { Vec3::Z } else { Vec3::X };
        let cases: [(&str, Case); 4] = [
            (
                "normal",
                Box::new(move |x, y| {
                    let plain = input(x, y);
                    FilterInput { hit: PrimaryHit { normal: turned(x), ..plain.hit }, ..plain }
                }),
            ),
            (
                "object",
                Box::new(move |x, y| {
                    let plain = input(x, y);
                    FilterInput { hit: PrimaryHit { object: u32::from(x < half), ..plain.hit }, ..plain }
                }),
            ),
            (
                "plane",
                Box::new(move |x, y| {
                    let plain = input(x, y);
                    let back = if x < half { Vec3::ZERO } else { Vec3::NEG_Z * 0.1 };
                    FilterInput { hit: PrimaryHit { position: plain.hit.position + back, ..plain.hit }, ..plain }
                }),
            ),
            (
                "texture",
                Box::new(move |x, y| {
                    let plain = input(x, y);
                    let texture = Vec3::splat(if x < half { bright } else { dark });
                    FilterInput { hit: PrimaryHit { texture, ..plain.hit }, ..plain }
                }),
            ),
        ];
        for (name, case) in cases {
            let mut picture = picture(step);
            filter_picture(&mut picture, case);
            for (i, value) in green(&picture).into_iter().enumerate() {
                assert!((value - step(i)).abs() < 1e-4, "{name}: {value} at {} for {}", i % WIDTH, step(i));
            }
        }
        // Without any such edge the filter blurs the step.
        let mut picture = picture(step);
        filter_picture(&mut picture, input);
        assert!((green(&picture)[half] - dark).abs() > 0.01);
    }

    #[test]
    fn polished_surfaces_glass_and_the_background_are_not_filtered() {
        for alpha in [0.0, 0.05, PrimaryHit::VIEW_DEPENDENT] {
            let mut mirror = picture(|i| 0.3 * noise(i));
            let before = mirror.clone();
            filter_picture(&mut mirror, |x, y| {
                let plain = input(x, y);
                FilterInput { hit: PrimaryHit { alpha, ..plain.hit }, ..plain }
            });
            assert_eq!(mirror, before);
        }
    }

    #[test]
    fn pictures_smaller_than_the_tap_distance_are_filtered() {
        for (width, height) in [(1, 1), (1, 9), (9, 1), (3, 5)] {
            let mut small = Picture::new(width, height);
            small.rgb.iter_mut().for_each(|rgb| *rgb = [0.25; 3]);
            filter_picture(&mut small, input);
            assert!(small.rgb.iter().flatten().all(|value| (value - 0.25).abs() < 1e-6));
        }
        filter_picture(&mut Picture::default(), input);
    }
}
