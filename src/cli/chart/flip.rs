//! FLIP: the difference that people see between two pictures on a display, when they flip between both (Andersson,
//! Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild 2020, "FLIP: A Difference Evaluator for Alternating
//! Images").
//!
//! The difference of a pixel, 0 to 1, is that of colours after the blur of the eye, raised where edges and points
//! differ. The distance is the paper's: 67 pixels a degree, as of a 4K monitor 70 cm wide seen from 70 cm.

use crate::color::tone_curve;
use crate::photo::Picture;
use glam::{Mat3, Vec2, Vec3};
use std::f32::consts::PI;

const PIXELS_PER_DEGREE: f32 = 67.020_645;

/// Contrast sensitivity by channel of YCxCz: amplitude and width of two Gaussians each, section 4.1.1.
const CONTRAST_SENSITIVITY: [[(f32, f32); 2]; 3] =
    [[(1.0, 0.0047), (0.0, 1e-5)], [(1.0, 0.0053), (0.0, 1e-5)], [(34.1, 0.04), (13.5, 0.025)]];
/// Exponent of colour differences, section 4.1.3.
const COLOR_EXPONENT: f32 = 0.7;
/// Part of the largest colour difference that is mapped to this part of the scale, section 4.1.3.
const COLOR_KNEE: (f32, f32) = (0.4, 0.95);
/// Width of an edge or point that the eye detects, degrees, section 4.2.
const FEATURE_WIDTH_DEG: f32 = 0.082;
/// Exponent of feature differences, section 4.2.
const FEATURE_EXPONENT: f32 = 0.5;

/// CIE XYZ of linear sRGB colours.
const XYZ_FROM_RGB: Mat3 = Mat3::from_cols(
    Vec3::new(0.412_386_56, 0.212_636_82, 0.019_330_62),
    Vec3::new(0.357_591_49, 0.715_182_98, 0.119_197_16),
    Vec3::new(0.180_450_49, 0.072_180_2, 0.950_372_6),
);

/// Returns the mean FLIP difference of two pictures of one size, as a display shows them: 0 for equal ones, 1 at most.
pub fn mean_flip(picture: &Picture, reference: &Picture) -> f64 {
    let [seen, reference] = [picture, reference].map(SeenPicture::new);
    let largest = color_difference(hunt_lab(Vec3::Y), hunt_lab(Vec3::Z));
    let pixels = seen.colors.iter().zip(&reference.colors).zip(seen.features.iter().zip(&reference.features));
    let sum: f64 = pixels
        .map(|((color, reference_color), (features, reference_features))| {
            let color = redistributed(color_difference(*color, *reference_color), largest);
            let feature = (*features - *reference_features).abs().max_element();
            let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
            f64::from(color.powf(1.0 - feature))
        })
        .sum();
    sum / (picture.rgb.len().max(1)) as f64
}

/// A picture as the eye has it.
struct SeenPicture {
    /// Colours after the blur of the eye, in L*a*b* after Hunt.
    colors: Vec<Vec3>,
    /// Strength of edge and point at each pixel.
    features: Vec<Vec2>,
}

impl SeenPicture {
    fn new(picture: &Picture) -> Self {
        let size = (picture.width as usize, picture.height as usize);
        let shown: Vec<Vec3> = picture.rgb.iter().map(|rgb| Vec3::from(rgb.map(tone_curve))).collect();
        let opponent: Vec<Vec3> = shown.iter().map(|&rgb| opponent_from_rgb(rgb)).collect();
        let [y, x, z] = [0, 1, 2].map(|channel| {
            let plane: Vec<f32> = opponent.iter().map(|color| color[channel]).collect();
            blurred(&plane, size, &CONTRAST_SENSITIVITY[channel])
        });
        let colors = y.into_iter().zip(x).zip(z).map(|((y, x), z)| {
            let rgb = rgb_from_opponent(Vec3::new(y, x, z)).clamp(Vec3::ZERO, Vec3::ONE);
            hunt_lab(rgb)
        });
        let brightness: Vec<f32> = opponent.iter().map(|color| (color.x + 16.0) / 116.0).collect();
        SeenPicture { colors: colors.collect(), features: features(&brightness, size) }
    }
}

/// Returns the colour in YCxCz, a linear relative of L*a*b*.
fn opponent_from_rgb(rgb: Vec3) -> Vec3 {
    let white = XYZ_FROM_RGB * Vec3::ONE;
    let Vec3 { x, y, z } = XYZ_FROM_RGB * rgb / white;
    Vec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

fn rgb_from_opponent(color: Vec3) -> Vec3 {
    let y = (color.x + 16.0) / 116.0;
    let white = XYZ_FROM_RGB * Vec3::ONE;
    XYZ_FROM_RGB.inverse() * (Vec3::new(y + color.y / 500.0, y, y - color.z / 200.0) * white)
}

/// Returns the colour in L*a*b*, whose chroma grows with lightness (Hunt).
fn hunt_lab(rgb: Vec3) -> Vec3 {
    const DELTA: f32 = 6.0 / 29.0;
    let f = |t: f32| if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let Vec3 { x, y, z } = XYZ_FROM_RGB * rgb / (XYZ_FROM_RGB * Vec3::ONE);
    let lightness = 116.0 * f(y) - 16.0;
    let chroma = Vec2::new(500.0 * (f(x) - f(y)), 200.0 * (f(y) - f(z))) * (0.01 * lightness);
    Vec3::new(lightness, chroma.x, chroma.y)
}

/// Returns the difference of two colours: city blocks between lightness and chroma, compressed.
fn color_difference(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    (d.x.abs() + d.y.hypot(d.z)).powf(COLOR_EXPONENT)
}

/// Returns a colour difference on a scale to 1, most of which is left to small differences.
fn redistributed(difference: f32, largest: f32) -> f32 {
    let (part, shown) = COLOR_KNEE;
    let knee = part * largest;
    if difference < knee {
        difference * shown / knee
    } else {
        shown + (difference - knee) / (largest - knee) * (1.0 - shown)
    }
}

/// Returns a plane after the blur of the eye: the sum of two Gaussians with these amplitudes and widths.
fn blurred(plane: &[f32], size: (usize, usize), gaussians: &[(f32, f32); 2]) -> Vec<f32> {
    let widest = CONTRAST_SENSITIVITY.iter().flatten().map(|(_, width)| *width).fold(0.0, f32::max);
    let deviation = (widest / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE;
    let mut sum = vec![0.0; plane.len()];
    let mut total = 0.0;
    for &(amplitude, width) in gaussians.iter().filter(|(amplitude, _)| *amplitude > 0.0) {
        let kernel = kernel(deviation, |x| (-(PI * x / PIXELS_PER_DEGREE).powi(2) / width).exp());
        let weight = amplitude * (PI / width).sqrt() * kernel.iter().sum::<f32>().powi(2);
        total += weight;
        let kernel = normalised(kernel);
        for (sum, value) in sum.iter_mut().zip(convolved(plane, size, &kernel, &kernel)) {
            *sum += weight * value;
        }
    }
    sum.into_iter().map(|value| value / total).collect()
}

/// Returns the strength of edges and points in a plane of brightness, 0 to 1.
fn features(brightness: &[f32], size: (usize, usize)) -> Vec<Vec2> {
    let deviation = 0.5 * FEATURE_WIDTH_DEG * PIXELS_PER_DEGREE;
    let gaussian = |x: f32| (-0.5 * (x / deviation).powi(2)).exp();
    let smooth = normalised(kernel(deviation, gaussian));
    let edge = normalised(kernel(deviation, |x| -x * gaussian(x)));
    let point = normalised(kernel(deviation, |x| ((x / deviation).powi(2) - 1.0) * gaussian(x)));
    let strength = |derivative: &[f32]| {
        let (across, down) =
            (convolved(brightness, size, derivative, &smooth), convolved(brightness, size, &smooth, derivative));
        across.into_iter().zip(down).map(|(x, y)| x.hypot(y)).collect::<Vec<f32>>()
    };
    strength(&edge).into_iter().zip(strength(&point)).map(|(edge, point)| Vec2::new(edge, point)).collect()
}

/// Returns a function of whole pixels, up to three standard deviations of its Gaussian to both sides.
fn kernel(deviation: f32, value: impl Fn(f32) -> f32) -> Vec<f32> {
    let one_side = std::iter::successors(Some(1.0), |x| Some(x + 1.0)).take_while(|&x| x < 3.0 * deviation + 1.0);
    let one_side: Vec<f32> = one_side.collect();
    let both = one_side.iter().rev().map(|x| -x).chain(std::iter::once(0.0)).chain(one_side.iter().copied());
    both.map(value).collect()
}

/// Returns a kernel whose positive weights sum to 1, and whose negative ones, if it has any, sum to -1.
fn normalised(kernel: Vec<f32>) -> Vec<f32> {
    let sum = |sign: f32| kernel.iter().map(|weight| (sign * weight).max(0.0)).sum::<f32>();
    let (positive, negative) = (sum(1.0), sum(-1.0));
    kernel.into_iter().map(|weight| weight / if weight < 0.0 { negative } else { positive }).collect()
}

/// Returns the correlation of a plane with a kernel across and one down. The border pixels go on beyond the border.
fn convolved(plane: &[f32], (width, height): (usize, usize), across: &[f32], down: &[f32]) -> Vec<f32> {
    let tap = |at: usize, k: usize, radius: usize, length: usize| (at + k).saturating_sub(radius).min(length - 1);
    let mut rows = Vec::with_capacity(plane.len());
    for row in plane.chunks(width) {
        rows.extend((0..width).map(|x| {
            across.iter().enumerate().map(|(k, weight)| weight * row[tap(x, k, across.len() / 2, width)]).sum::<f32>()
        }));
    }
    let value = |x: usize, y: usize| {
        let row = |k: usize| tap(y, k, down.len() / 2, height);
        down.iter().enumerate().map(|(k, weight)| weight * rows[row(k) * width + x]).sum::<f32>()
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a picture of linear sRGB colours below the shoulder of the tone curve.
    fn picture(color: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
        let (width, height) = (40, 28);
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Picture { width, height, rgb: places.map(|(x, y)| color(x, y)).collect() }
    }

    #[test]
    fn the_difference_is_that_of_the_authors_program() {
        // By PyPI flip-evaluator 1.7 on the same linear colours.
        let gradient = |x: u32, y: u32| [0.05 + 0.5 * x as f32 / 40.0, 0.3, 0.55 - 0.5 * y as f32 / 28.0];
        let dotted =
            |x: u32, y: u32| gradient(x, y).map(|c| if (7 * x + 13 * y).is_multiple_of(5) { 0.7 * c } else { c });
        let in_patch = |x: u32, y: u32| (10..20).contains(&x) && (8..16).contains(&y);
        let patched = |x: u32, y: u32| if in_patch(x, y) { [0.6, 0.1, 0.05] } else { dotted(x, y) };
        let reference = picture(gradient);
        for (picture, expected) in [(picture(dotted), 0.106_048), (picture(patched), 0.174_860)] {
            let flip = mean_flip(&picture, &reference);
            assert!((flip - expected).abs() < 2e-4, "{flip} for {expected}");
        }
        let flip = mean_flip(&picture(|_, _| [0.6; 3]), &picture(|_, _| [0.0; 3]));
        assert!((flip - 0.960_751).abs() < 2e-4, "{flip}");
    }

    #[test]
    fn equal_pictures_do_not_differ_and_noise_is_seen_the_less_the_finer_it_is() {
        let grey = picture(|_, _| [0.2; 3]);
        assert_eq!(mean_flip(&grey, &grey), 0.0);
        let checks =
            |side: u32| picture(move |x, y| [if (x / side + y / side).is_multiple_of(2) { 0.1 } else { 0.3 }; 3]);
        let [fine, coarse] = [1, 8].map(|side| mean_flip(&checks(side), &grey));
        assert!(0.0 < fine && fine < 0.5 * coarse, "{fine} {coarse}");
    }
}
