//! A view of a live picture with less grain, for while it settles: an edge-aware filter that never goes into the sums.
//!
//! The à-trous wavelet of Dammertz, Sewtz, Hanika and Lensch (2010, "Edge-Avoiding À-Trous Wavelet Transform for fast
//! Global Illumination Filtering"): each pass looks twice as far as the one before, here at four places, in turn beside
//! and across, and neighbours count by how well their surface (object, material, normal, plane) and their light agree
//! with the pixel's. Light is what is left when the texture is divided out, so that patterns stay sharp. Two lights
//! agree within the grain that so many samples have: the filter fades by itself as the picture converges. Mirrors,
//! glass and polished things, whose pictures lie elsewhere than their surfaces, are left as they are.

use super::tile::Shown;
use crate::photo::Picture;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;
use wide::f32x8;

/// Passes, with steps of 1, 2, 4 and 8 pixels, and the mean number of samples from which fewer will do: there is less
/// grain, and less that still counts as grain.
const PASSES: [(f32, i32); 3] = [(64.0, 2), (16.0, 3), (0.0, 4)];
/// Relative grain of one sample that still counts as the same light.
const GRAIN: f32 = 1.6;
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
/// A difference that no light has.
const ANY_LIGHT: f32 = 1e15;
/// Weight of a neighbour that agrees in everything, against the pixel's own.
const SIDE: f32 = 0.75;
/// Neighbours of a pass, to the right and down; every second pass has the others.
const CROSS: [[isize; 2]; 4] = [[-1, 0], [1, 0], [0, -1], [0, 1]];
const DIAGONALS: [[isize; 2]; 4] = [[-1, -1], [1, -1], [-1, 1], [1, 1]];
/// Pixels that are worked on at a time.
const LANES: usize = 8;
/// Room beside each row, pixels: the longest step.
const MARGIN: usize = 8;

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

/// A number a pixel, in rows with room around them: eight at a time reach over a row's ends without a question.
#[derive(Clone, Debug)]
struct Plane {
    numbers: Vec<f32>,
    stride: usize,
}

impl Plane {
    fn new(width: usize, height: usize, of: impl Fn(usize) -> f32 + Sync, around: f32) -> Self {
        let stride = MARGIN + width.next_multiple_of(LANES) + MARGIN;
        let mut numbers = vec![around; stride * height];
        numbers.par_chunks_mut(stride).enumerate().for_each(|(y, row)| {
            row[MARGIN..MARGIN + width].iter_mut().enumerate().for_each(|(x, number)| *number = of(y * width + x));
        });
        Plane { numbers, stride }
    }

    /// Eight numbers from a place on.
    fn lanes(&self, at: usize) -> f32x8 {
        let there = self.numbers.get(at..).and_then(<[f32]>::first_chunk);
        there.map_or(f32x8::ZERO, |lanes| f32x8::new(*lanes))
    }

    fn at(&self, x: usize, y: usize) -> f32 {
        self.numbers[y * self.stride + MARGIN + x]
    }
}

/// Lights, three planes.
type Lights = [Plane; 3];

/// What the surfaces say, and how much grain their light has.
struct Surfaces {
    width: usize,
    height: usize,
    /// A number for each object and material; none, which is like nothing, where there is no surface to smooth.
    key: Plane,
    normal: [Plane; 3],
    position: [Plane; 3],
    /// One over the distance off the plane at which a neighbour counts no more, 1/m.
    reach: Plane,
    /// Difference of light that counts half.
    grain: Plane,
}

impl Surfaces {
    fn new(width: usize, guides: &[Guide]) -> Self {
        let (height, keys) = (guides.len() / width, keys(guides));
        let plane = |of: &(dyn Fn(&Guide) -> f32 + Sync)| Plane::new(width, height, |i| of(&guides[i]), 0.0);
        Surfaces {
            width,
            height,
            key: Plane::new(width, height, |i| keys[i], f32::NAN),
            normal: [0, 1, 2].map(|axis| plane(&|guide| guide.shown.normal[axis])),
            position: [0, 1, 2].map(|axis| plane(&|guide| guide.shown.position[axis])),
            reach: plane(&|guide| (OFF_PLANE * guide.scale).max(1e-6).recip()),
            grain: plane(&|_| ANY_LIGHT),
        }
    }
}

/// Numbers of objects with their materials, in the order in which they are seen.
fn keys(guides: &[Guide]) -> Vec<f32> {
    let mut known: HashMap<(u32, u32), f32> = HashMap::new();
    let mut last = ((Shown::NOTHING, 0), f32::NAN);
    let key = |guide: &Guide| {
        let Shown { object, material, alpha, .. } = guide.shown;
        if alpha < LEAST_ALPHA {
            return f32::NAN;
        }
        if last.0 != (object, material) || last.1.is_nan() {
            let next = known.len() as f32;
            last = ((object, material), *known.entry((object, material)).or_insert(next));
        }
        last.1
    };
    guides.iter().map(key).collect()
}

/// Smooths a picture whose pixels have these guides.
pub fn smooth(picture: &mut Picture, guides: &[Guide]) {
    if guides.is_empty() {
        return;
    }
    let mut surfaces = Surfaces::new(picture.width as usize, guides);
    let (width, height) = (surfaces.width, surfaces.height);
    let texture = |guide: &Guide| guide.shown.texture.max(Vec3::splat(LEAST_TEXTURE));
    let light = |channel: usize| {
        let of = |i: usize| picture.rgb[i][channel] / texture(&guides[i])[channel];
        Plane::new(width, height, of, 0.0)
    };
    let mut lights = [light(0), light(1), light(2)];
    // Grain is judged against the mean around a pixel: against the pixel itself, bright ones would count more.
    let around = one_pass(&surfaces, &lights, &CROSS.map(|side| side.map(|steps| AROUND * steps)), 1.0);
    let grain = |i: usize| {
        let [r, g, b] = around.each_ref().map(|plane| plane.at(i % width, i / width));
        (brightness(r, g, b) + DARK) * GRAIN / guides[i].samples.max(1.0).sqrt()
    };
    surfaces.grain = Plane::new(width, height, grain, 0.0);
    let samples = guides.iter().map(|guide| guide.samples).sum::<f32>() / guides.len() as f32;
    let passes = PASSES.into_iter().find(|(from, _)| samples >= *from).map_or(0, |(_, passes)| passes);
    for pass in 0..passes {
        let sides = if pass % 2 == 0 { CROSS } else { DIAGONALS };
        let sides = sides.map(|side| side.map(|steps| steps << pass));
        lights = one_pass(&surfaces, &lights, &sides, 0.25_f32.powi(pass));
    }
    picture.rgb.par_iter_mut().zip(guides).enumerate().for_each(|(i, (rgb, guide))| {
        let (x, y) = (i % width, i / width);
        if !surfaces.key.at(x, y).is_nan() {
            *rgb = (Vec3::from(lights.each_ref().map(|plane| plane.at(x, y))) * texture(guide)).into();
        }
    });
}

/// Each pixel's mean with its neighbours at `sides`, pixels to the right and down. `part` is of the grain's square: the
/// grain falls by half with every pass.
fn one_pass(surfaces: &Surfaces, lights: &Lights, sides: &[[isize; 2]; 4], part: f32) -> Lights {
    let mut out = lights.clone();
    let stride = surfaces.key.stride;
    let [r, g, b] = out.each_mut().map(|plane| plane.numbers.par_chunks_mut(stride));
    r.zip(g).zip(b).enumerate().for_each(|(y, ((r, g), b))| {
        for x in (MARGIN..MARGIN + surfaces.width).step_by(LANES) {
            let mean = mean_of_eight(surfaces, lights, (x, y), sides, part);
            for (row, lanes) in [&mut *r, &mut *g, &mut *b].into_iter().zip(mean) {
                row[x..x + LANES].copy_from_slice(&lanes.to_array());
            }
        }
    });
    out
}

/// The means of eight pixels from column `x` of the planes on.
fn mean_of_eight(
    surfaces: &Surfaces,
    lights: &Lights,
    (x, y): (usize, usize),
    sides: &[[isize; 2]; 4],
    part: f32,
) -> [f32x8; 3] {
    let Surfaces { key, normal, position, reach, grain, .. } = surfaces;
    let here = y * key.stride + x;
    let at = |planes: &[Plane; 3], at: usize| planes.each_ref().map(|plane| plane.lanes(at));
    let dot = |[ax, ay, az]: [f32x8; 3], [bx, by, bz]: [f32x8; 3]| ax * bx + ay * by + az * bz;
    let less = |[ax, ay, az]: [f32x8; 3], [bx, by, bz]: [f32x8; 3]| [ax - bx, ay - by, az - bz];
    let (own_key, own_normal, own_position) = (key.lanes(here), at(normal, here), at(position, here));
    let (own_reach, own_grain, own_light) = (reach.lanes(here), grain.lanes(here), at(lights, here));
    let (mut weights, mut sum) = (f32x8::ONE, own_light);
    for [right, down] in sides {
        let Some(row) = y.checked_add_signed(*down).filter(|row| *row < surfaces.height) else { continue };
        let there = (row * key.stride + x).wrapping_add_signed(*right);
        let facing = dot(own_normal, at(normal, there)).max(f32x8::ZERO);
        let facing = facing * facing;
        let facing = facing * facing;
        let facing = facing * facing;
        let aside = dot(less(at(position, there), own_position), own_normal).abs();
        let near = (f32x8::ONE - aside * own_reach).max(f32x8::ZERO);
        let light = at(lights, there);
        let [r, g, b] = less(light, own_light);
        let apart = r * 0.25 + g * 0.5 + b * 0.25;
        // The same from either side: otherwise the brighter ones would have more weight, or less.
        let allowed = (own_grain + grain.lanes(there)) * 0.5;
        let allowed = allowed * allowed * part;
        let alike = allowed / (allowed + apart * apart);
        let weight = own_key.simd_eq(key.lanes(there)) & (facing * near * alike * SIDE);
        weights += weight;
        sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += weight * light);
    }
    sum.map(|sum| sum / weights)
}

/// About the luminance, in numbers that a processor likes.
fn brightness(r: f32, g: f32, b: f32) -> f32 {
    0.25 * r + 0.5 * g + 0.25 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    type Case = Box<dyn Fn(usize, usize) -> Guide>;

    const WIDTH: usize = 96;
    const HEIGHT: usize = 64;

    fn guide(x: usize, y: usize) -> Guide {
        let position = Vec3::new(x as f32, y as f32, 0.0) * 0.01;
        let shown = Shown { position, normal: Vec3::Z, object: 1, material: 2, alpha: 0.5, texture: Vec3::ONE };
        Guide { shown, scale: 3.0, samples: 1.0 }
    }

    fn guides(of: impl Fn(usize, usize) -> Guide) -> Vec<Guide> {
        (0..WIDTH * HEIGHT).map(|i| of(i % WIDTH, i / WIDTH)).collect()
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
        smooth(&mut wall, &guides(guide));
        let (smoothed, after) = mean_and_deviation(&green(&wall));
        assert!((smoothed / mean - 1.0).abs() < 0.01, "{smoothed} for {mean}");
        assert!(after < 0.125 * before, "{after} of {before}");
    }

    #[test]
    fn with_many_samples_the_picture_is_left_alone() {
        let mut wall = picture(|i| 0.3 * grain(i));
        let before = green(&wall);
        smooth(&mut wall, &guides(|x, y| Guide { samples: 1e6, ..guide(x, y) }));
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
            smooth(&mut picture, &guides(case));
            for (i, value) in green(&picture).into_iter().enumerate() {
                assert!((value - step(i)).abs() < 1e-4, "{name}: {value} at {} for {}", i % WIDTH, step(i));
            }
        }
        // Without any of them the filter would have washed it out.
        let mut picture = picture(step);
        smooth(&mut picture, &guides(guide));
        assert!((green(&picture)[half] - dark).abs() > 0.01);
    }

    #[test]
    fn polished_things_glass_and_the_void_are_left_as_they_are() {
        for alpha in [0.0, 0.05, Shown::NEVER] {
            let mut mirror = picture(|i| 0.3 * grain(i));
            let before = mirror.clone();
            smooth(
                &mut mirror,
                &guides(|x, y| {
                    let plain = guide(x, y);
                    Guide { shown: Shown { alpha, ..plain.shown }, ..plain }
                }),
            );
            assert_eq!(mirror, before);
        }
    }

    #[test]
    fn pictures_smaller_than_a_step_and_values_that_are_none_do_no_harm() {
        for (width, height) in [(1, 1), (1, 9), (9, 1), (3, 5)] {
            let mut small = Picture::new(width, height);
            small.rgb.iter_mut().for_each(|rgb| *rgb = [0.25; 3]);
            let guides: Vec<Guide> =
                (0..width * height).map(|i| guide((i % width) as usize, (i / width) as usize)).collect();
            smooth(&mut small, &guides);
            assert!(small.rgb.iter().flatten().all(|value| (value - 0.25).abs() < 1e-6));
        }
        smooth(&mut Picture::default(), &[]);
    }
}
