//! The BSDF of fibres: Chiang et al. 2016, "A Practical and Controllable Hair and Fur Model for Production Path
//! Tracing", as PBRT, 4th ed., section 9.9, describes it.
//!
//! A fibre is a rough dielectric cylinder with pigment. Light leaves it by reflection (R), straight through (TT), after
//! one internal reflection (TRT), or after more; the last lobe holds all of these. A lobe is the product of a
//! longitudinal density M, an azimuthal density N and an attenuation A. M and N are normalised, and the attenuations of a
//! fibre without pigment add up to 1, so that it reflects all light.
//!
//! In the paper, N and A are those of the offset at which a ray meets the fibre. A pixel sees many fibres, and the mean
//! over their widths: the far field of Marschner et al. 2003. Taken at every vertex, it has far less noise, and the live
//! view draws the same. A fibre that is wider than a pixel has no highlight of its own across its width.
//!
//! The local frame has the fibre's tangent as X and the outgoing direction in the XY plane: the outgoing azimuth is 0,
//! and the offset h across the fibre counts along -Z. Values include the cosine, which the model divides by.
//!
//! The absorption is that of colour channels, not of wavelengths. Reciprocity holds for M without tilt alone, as in the
//! paper: the attenuation depends on the outgoing direction.

use super::fresnel;
use super::sample::BsdfSample;
use crate::color::luminance;
use crate::math::simd::{self, Avx2, SimdTask};
use crate::math::{approx, atan2, orthonormal_basis, safe_sqrt, sin_cos_turn};
use crate::scene::Fibre;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};

/// Index of refraction of keratin (Marschner et al. 2003, "Light Scattering from Human Hair Fibers").
const IOR: f32 = 1.55;
/// Angle of the scales to the fibre, degrees: 2 to 3 (Marschner et al. 2003). They open towards the tip.
const TILT_DEG: f32 = 2.0;
/// Number of lobes: R, TT, TRT, and all others.
const LOBES: usize = 4;
/// Number of offsets across a fibre over which its light is averaged. With one, as in the paper, a portrait with hair has
/// 2.5 times the variance in as much time, for R reaches the light from a small part of the width; with 4, 1.1 times.
const OFFSETS: usize = 8;
/// Edges of the strata of the offset: equal steps of the angle of the cylinder's normal, so that R is sampled evenly
/// around the fibre.
const STRATA: [f32; OFFSETS + 1] =
    [-1.0, -0.923_879_5, -FRAC_1_SQRT_2, -0.382_683_43, 0.0, 0.382_683_43, FRAC_1_SQRT_2, 0.923_879_5, 1.0];

/// A fibre material prepared for tracing.
#[derive(Clone, Copy, Debug)]
pub struct TracedFibre {
    /// Per fibre radius.
    absorption: Vec3,
    longitudinal: [Longitudinal; LOBES],
    azimuthal: TrimmedLogistic,
    /// Sine and cosine of the tilt of R, TT and TRT.
    tilts: [(f32, f32); LOBES],
    /// Mean albedo over all directions and offsets.
    albedo: Vec3,
}

impl TracedFibre {
    /// Prepares a fibre.
    pub fn new(fibre: &Fibre) -> Self {
        let v = fibre.longitudinal_variance();
        // The scales tilt R by twice their angle towards the root, TT and TRT by one and four angles towards the tip
        let tilt = |factor: f32| (factor * TILT_DEG).to_radians().sin_cos();
        let mut traced = TracedFibre {
            absorption: fibre.absorption_per_radius(),
            longitudinal: [v, 0.25 * v, 4.0 * v, 4.0 * v].map(Longitudinal::new),
            azimuthal: TrimmedLogistic::new(fibre.azimuthal_scale()),
            tilts: [tilt(2.0), tilt(-1.0), tilt(-4.0), tilt(0.0)],
            albedo: Vec3::ZERO,
        };
        traced.albedo = traced.mean_albedo();
        traced
    }

    /// Returns the mean albedo over all directions and offsets.
    pub fn albedo(&self) -> Vec3 {
        self.albedo
    }

    /// Averages the albedo over offsets and directions by the midpoint rule. A fibre's area in a direction is
    /// proportional to the cosine of its longitude.
    fn mean_albedo(&self) -> Vec3 {
        const STEPS: usize = 16;
        let midpoint = |i: usize| (i as f32 + 0.5) / STEPS as f32;
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (i, k) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |k| (i, k))) {
            let sin_theta = midpoint(i);
            let cos_theta = safe_sqrt(1.0 - sin_theta * sin_theta);
            let (attenuation, _) = attenuations(self.absorption, sin_theta, cos_theta, 2.0 * midpoint(k) - 1.0);
            sum += attenuation.into_iter().sum::<Vec3>() * cos_theta;
            weights += cos_theta;
        }
        sum / weights
    }
}

/// A fibre's BSDF for one outgoing direction, averaged over the width of the fibre.
#[derive(Clone, Copy, Debug)]
pub struct FibreBsdf<'a> {
    fibre: &'a TracedFibre,
    tangent: Vec3,
    /// Perpendicular to the tangent, towards the outgoing direction.
    facing: Vec3,
    /// Perpendicular to both.
    across: Vec3,
    /// Sine and cosine of the outgoing direction's longitude, tilted for each lobe.
    outgoing: [(f32, f32); LOBES],
    /// R, TT and TRT.
    peaks: [AzimuthalPeaks; LOBES - 1],
    /// Attenuation of each lobe, summed over the offsets, by which lobes are sampled.
    attenuation: [Vec3; LOBES],
    /// Luminance of the albedo.
    luminance: f32,
}

/// The azimuthal lobe of R, TT or TRT for rays that meet a fibre at each offset.
#[derive(Clone, Copy, Debug, Default)]
struct AzimuthalPeaks {
    /// Azimuths that the cylinder's surface would give.
    azimuth: [f32; OFFSETS],
    /// Attenuations of the colour channels, times the offset's part of the width.
    attenuation: [[f32; OFFSETS]; 3],
}

impl<'a> FibreBsdf<'a> {
    /// Returns the BSDF for a unit outgoing direction at an offset `h`, -1 to 1, of a fibre along `tangent`, from root to
    /// tip. The mean over the width is taken at one offset a stratum, and `h` moves them: over all `h`, the mean is exact.
    pub fn new(fibre: &'a TracedFibre, tangent: Vec3, h: f32, wo: Vec3) -> Self {
        // Build the local frame
        let sin_theta = wo.dot(tangent).clamp(-1.0, 1.0);
        let cos_theta = safe_sqrt(1.0 - sin_theta * sin_theta);
        let facing = (wo - tangent * sin_theta).try_normalize().unwrap_or_else(|| orthonormal_basis(tangent).0);
        let across = tangent.cross(facing);
        // Refract a ray into the cylinder at an offset in each stratum
        let place = (0.5 + 0.5 * h.clamp(-1.0, 1.0)) * OFFSETS as f32;
        let place = place - place as u32 as f32;
        let refraction = Refraction { absorption: fibre.absorption, sin_theta, cos_theta, place };
        let (peaks, attenuation) = simd::dispatch(refraction);
        let luminance = luminance(attenuation.into_iter().sum());
        let tilted =
            |(sin, cos): (f32, f32)| (sin_theta * cos + cos_theta * sin, (cos_theta * cos - sin_theta * sin).abs());
        FibreBsdf { fibre, tangent, facing, across, outgoing: fibre.tilts.map(tilted), peaks, attenuation, luminance }
    }

    /// Returns BSDF times cosine, and the density of [`FibreBsdf::sample`] (1/sr), for a unit direction.
    pub fn eval(&self, direction: Vec3) -> (Vec3, f32) {
        let sin_theta = direction.dot(self.tangent).clamp(-1.0, 1.0);
        let azimuth = atan2(direction.dot(self.across), direction.dot(self.facing));
        self.eval_local(sin_theta, safe_sqrt(1.0 - sin_theta * sin_theta), azimuth)
    }

    fn eval_local(&self, sin_theta: f32, cos_theta: f32, azimuth: f32) -> (Vec3, f32) {
        let value = simd::dispatch(Evaluation { bsdf: self, sin_theta, cos_theta, azimuth });
        // Lobes and offsets are sampled by their luminance, so that the density is that of the value
        (value, luminance(value) / self.luminance)
    }

    /// Samples a direction for a lobe number in 0..1 and a point of the unit square.
    pub fn sample(&self, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        // Sample a lobe and an offset; the rest of the number is uniform again
        let mut rest = u_lobe * self.luminance;
        let lobe = sample_index(self.attenuation.map(luminance), &mut rest);
        let (sin_theta, cos_theta) = self.fibre.longitudinal[lobe].sample(self.outgoing[lobe], u);
        let azimuth = match self.peaks.get(lobe) {
            Some(peaks) => {
                let [r, g, b] = peaks.attenuation;
                let weights = std::array::from_fn::<_, OFFSETS, _>(|k| luminance(Vec3::new(r[k], g[k], b[k])));
                let offset = sample_index(weights, &mut rest);
                let u_azimuth = (rest / weights[offset]).clamp(0.0, 1.0 - f32::EPSILON);
                peaks.azimuth[offset] + self.fibre.azimuthal.sample(u_azimuth)
            }
            None => TAU * rest / luminance(self.attenuation[lobe]),
        };
        // Evaluate all lobes in that direction
        let (value, pdf) = self.eval_local(sin_theta, cos_theta, azimuth);
        // R, TT and TRT turn by less than two turns
        let turns = azimuth / TAU + 2.0;
        let (sin, cos) = sin_cos_turn(turns - turns as u32 as f32);
        let direction = self.tangent * sin_theta + (self.facing * cos + self.across * sin) * cos_theta;
        (pdf > 0.0).then(|| BsdfSample::non_specular(direction.normalize_or(self.facing), value / pdf, pdf))
    }
}

/// Samples an index in proportion to the weights, for a number between 0 and their sum. Leaves the part of the number
/// that is within the weight of that index.
fn sample_index<const N: usize>(weights: [f32; N], number: &mut f32) -> usize {
    let mut index = 0;
    while index + 1 < N && *number >= weights[index] {
        *number -= weights[index];
        index += 1;
    }
    index
}

/// The refraction of a ray into a cylinder at an offset in each stratum, eight at a time.
struct Refraction {
    absorption: Vec3,
    sin_theta: f32,
    cos_theta: f32,
    /// Place in each stratum, 0 to 1.
    place: f32,
}

impl SimdTask for Refraction {
    type Output = ([AzimuthalPeaks; LOBES - 1], [Vec3; LOBES]);

    #[inline(always)]
    fn run(self, _: Option<Avx2>) -> Self::Output {
        let Refraction { absorption, sin_theta, cos_theta, place } = self;
        let mut azimuth = [[0.0; OFFSETS]; LOBES - 1];
        let mut attenuation = [[[0.0; OFFSETS]; 3]; LOBES];
        for k in 0..OFFSETS {
            let h = STRATA[k] + place * (STRATA[k + 1] - STRATA[k]);
            let part = 0.5 * (STRATA[k + 1] - STRATA[k]);
            let (attenuations, sin_gamma_t) = attenuations(absorption, sin_theta, cos_theta, h);
            let azimuths = azimuths(h, sin_gamma_t);
            for lobe in 0..LOBES - 1 {
                azimuth[lobe][k] = azimuths[lobe];
            }
            for lobe in 0..LOBES {
                for channel in 0..3 {
                    attenuation[lobe][channel][k] = attenuations[lobe][channel] * part;
                }
            }
        }
        let peaks =
            std::array::from_fn(|lobe| AzimuthalPeaks { azimuth: azimuth[lobe], attenuation: attenuation[lobe] });
        (peaks, attenuation.map(|channels| Vec3::from(channels.map(sum))))
    }
}

/// The value of all lobes in a direction, eight offsets at a time.
struct Evaluation<'a> {
    bsdf: &'a FibreBsdf<'a>,
    sin_theta: f32,
    cos_theta: f32,
    azimuth: f32,
}

impl SimdTask for Evaluation<'_> {
    type Output = Vec3;

    #[inline(always)]
    fn run(self, _: Option<Avx2>) -> Vec3 {
        let Evaluation { bsdf: FibreBsdf { fibre, outgoing, peaks, attenuation, .. }, sin_theta, cos_theta, azimuth } =
            self;
        let along: [f32; LOBES] = std::array::from_fn(|lobe| {
            let (sin_o, cos_o) = outgoing[lobe];
            fibre.longitudinal[lobe].density(sin_theta, cos_theta, sin_o, cos_o)
        });
        let mut values = [[0.0; OFFSETS]; 3];
        for (peaks, along) in peaks.iter().zip(along) {
            let densities = peaks.azimuth.map(|mean| fibre.azimuthal.density(azimuth - mean) * along);
            for (values, attenuation) in values.iter_mut().zip(&peaks.attenuation) {
                for ((value, attenuation), density) in values.iter_mut().zip(attenuation).zip(densities) {
                    *value += attenuation * density;
                }
            }
        }
        Vec3::from(values.map(sum)) + attenuation[LOBES - 1] * (along[LOBES - 1] / TAU)
    }
}

/// Returns the sum of values, by halves.
#[inline(always)]
fn sum(values: [f32; OFFSETS]) -> f32 {
    let fours: [f32; 4] = std::array::from_fn(|k| values[k] + values[k + 4]);
    (fours[0] + fours[2]) + (fours[1] + fours[3])
}

/// Returns the azimuths of R, TT and TRT that the cylinder's surface would give at an offset, from the sine of the
/// azimuth of the ray inside of it.
#[inline(always)]
fn azimuths(h: f32, sin_gamma_t: f32) -> [f32; LOBES - 1] {
    let (gamma_o, gamma_t) = (FRAC_PI_2 - approx::acos(h), FRAC_PI_2 - approx::acos(sin_gamma_t));
    [0.0, 1.0, 2.0].map(|p| 2.0 * p * gamma_t - 2.0 * gamma_o + p * PI)
}

/// Returns the attenuation of each lobe, and the sine of the azimuth of the ray inside of the fibre. The fourth lobe is
/// the geometric series of all internal reflections.
#[inline(always)]
fn attenuations(absorption: Vec3, sin_theta: f32, cos_theta: f32, h: f32) -> ([Vec3; LOBES], f32) {
    // Refract the ray; the azimuth has the modified index of refraction of the ray's projection
    let cos_theta_t = safe_sqrt(1.0 - sin_theta * sin_theta / (IOR * IOR));
    let projected_ior = safe_sqrt(IOR * IOR - sin_theta * sin_theta) / cos_theta.max(1e-6);
    let sin_gamma_t = h / projected_ior;
    let cos_gamma_t = safe_sqrt(1.0 - sin_gamma_t * sin_gamma_t);
    // Absorb light on one way through the fibre
    let length = 2.0 * cos_gamma_t / cos_theta_t;
    let transmittance = Vec3::from((-absorption * length).to_array().map(approx::exp));
    // Divide it among the lobes
    let reflectance = fresnel::dielectric(cos_theta * safe_sqrt(1.0 - h * h), IOR);
    let straight = transmittance * ((1.0 - reflectance) * (1.0 - reflectance));
    let reflected = straight * transmittance * reflectance;
    let others =
        reflected * transmittance * reflectance / (Vec3::ONE - transmittance * reflectance).max(Vec3::splat(1e-6));
    ([Vec3::splat(reflectance), straight, reflected, others], sin_gamma_t)
}

/// The longitudinal density M of a lobe (d'Eon et al. 2011, "An Energy-Conserving Hair Reflectance Model", equation 7):
/// its integral over the sine of the longitude is 1.
#[derive(Clone, Copy, Debug)]
struct Longitudinal {
    variance: f32,
    inverse_variance: f32,
    /// e^(-2 / variance).
    floor: f32,
    /// 1 / (variance (1 - e^(-2 / variance))).
    scale: f32,
}

impl Longitudinal {
    fn new(variance: f32) -> Self {
        let floor = (-2.0 / variance).exp();
        Longitudinal { variance, inverse_variance: 1.0 / variance, floor, scale: 1.0 / (variance * (1.0 - floor)) }
    }

    /// Returns the density for the incident and the tilted outgoing longitude.
    #[inline(always)]
    fn density(&self, sin_i: f32, cos_i: f32, sin_o: f32, cos_o: f32) -> f32 {
        let a = cos_i * cos_o * self.inverse_variance;
        // Without overflow: the factor e^a of the Bessel function is in the exponent.
        let exponent = (cos_i * cos_o - sin_i * sin_o - 1.0) * self.inverse_variance;
        scaled_bessel_i0(a) * approx::exp(exponent) * self.scale
    }

    /// Samples sine and cosine of the incident longitude (d'Eon 2013, "Importance Sampling for Physically-Based Hair
    /// Fiber Models").
    fn sample(&self, (sin_o, cos_o): (f32, f32), u: Vec2) -> (f32, f32) {
        let u_x = u.x.max(1e-7);
        let cos = 1.0 + self.variance * (u_x + (1.0 - u_x) * self.floor).ln();
        let sin = safe_sqrt(1.0 - cos * cos);
        let (_, cos_turn) = sin_cos_turn(u.y);
        let sin_theta = (-cos * sin_o + sin * cos_turn * cos_o).clamp(-1.0, 1.0);
        (sin_theta, safe_sqrt(1.0 - sin_theta * sin_theta))
    }
}

/// The azimuthal density N: a logistic distribution of a scale, trimmed to -pi to pi.
#[derive(Clone, Copy, Debug)]
struct TrimmedLogistic {
    scale: f32,
    inverse_scale: f32,
    /// 1 / (scale (1 - 2 low)).
    norm: f32,
    /// Cumulative density of the untrimmed distribution at -pi.
    low: f32,
}

impl TrimmedLogistic {
    fn new(scale: f32) -> Self {
        let low = 1.0 / (1.0 + (PI / scale).exp());
        TrimmedLogistic { scale, inverse_scale: 1.0 / scale, norm: 1.0 / (scale * (1.0 - 2.0 * low)), low }
    }

    /// Returns the density at any angle, wrapped to -pi to pi.
    #[inline(always)]
    fn density(&self, angle: f32) -> f32 {
        let wrapped = angle - TAU * approx::round(angle * (1.0 / TAU));
        let e = approx::exp(-wrapped.abs() * self.inverse_scale);
        self.norm * e / ((1.0 + e) * (1.0 + e))
    }

    /// Samples an angle.
    fn sample(&self, u: f32) -> f32 {
        let cumulative = self.low + u * (1.0 - 2.0 * self.low);
        (-self.scale * (1.0 / cumulative - 1.0).ln()).clamp(-PI, PI)
    }
}

/// Returns the modified Bessel function I0(x) e^-x for x >= 0, within 5e-7 (Abramowitz and Stegun 1964, 9.8.1 and 9.8.2).
#[inline(always)]
fn scaled_bessel_i0(x: f32) -> f32 {
    const NEAR: [f32; 7] = [1.0, 3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3];
    const FAR: [f32; 9] = [
        0.398_942_3,
        0.013_285_92,
        0.002_253_19,
        -0.001_575_65,
        0.009_162_81,
        -0.020_577_06,
        0.026_355_37,
        -0.016_476_33,
        0.003_923_77,
    ];
    let t = (x / 3.75) * (x / 3.75);
    let near = horner(t, &NEAR) * approx::exp(-x);
    let far = horner(3.75 / x, &FAR) / x.sqrt();
    // Selected without a branch, so that loops over lobes vectorize
    if x < 3.75 { near } else { far }
}

/// Returns a polynomial of these coefficients, the constant first.
#[inline(always)]
fn horner<const N: usize>(t: f32, coefficients: &[f32; N]) -> f32 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

#[cfg(test)]
mod tests;
