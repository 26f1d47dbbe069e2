//! Colour: scene-linear Rec.709 RGB, Kelvin, gels, white balance, tone curve and sRGB, shared by all renderers.

use glam::{DMat3, DVec3, Vec3};

/// Returns the luminance of linear Rec.709 RGB.
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Returns the CIE 1931 xy chromaticity of a colour temperature: Planckian locus below 4000 K, CIE daylight above 5000
/// K, a continuous blend between. Clamped to 1000..25000 K.
pub fn xy_from_kelvin(kelvin: f64) -> (f64, f64) {
    let t = kelvin.clamp(1000.0, 25_000.0);
    let blend = ((t - 4000.0) / 1000.0).clamp(0.0, 1.0);
    let (planck, daylight) = (planckian_xy(t), daylight_xy(t.max(4000.0)));
    (planck.0 + (daylight.0 - planck.0) * blend, planck.1 + (daylight.1 - planck.1) * blend)
}

/// Returns the Planckian locus by Krystek's rational approximation in CIE 1960 uv (1985): within 1e-4 from 1000 to
/// 15000 K. Used up to 5000 K.
fn planckian_xy(t: f64) -> (f64, f64) {
    let u = (0.860_117_757 + 1.541_182_54e-4 * t + 1.286_412_12e-7 * t * t)
        / (1.0 + 8.424_202_35e-4 * t + 7.081_451_63e-7 * t * t);
    let v = (0.317_398_726 + 4.228_062_45e-5 * t + 4.204_816_91e-8 * t * t)
        / (1.0 - 2.897_418_16e-5 * t + 1.614_560_53e-7 * t * t);
    let d = 2.0 * u - 8.0 * v + 4.0;
    (3.0 * u / d, 2.0 * v / d)
}

/// Returns the CIE daylight locus (CIE 15), 4000..25000 K.
fn daylight_xy(t: f64) -> (f64, f64) {
    let i = 1.0 / t;
    let x = if t <= 7000.0 {
        ((-4.607_0e9 * i + 2.967_8e6) * i + 0.099_11e3) * i + 0.244_063
    } else {
        ((-2.006_4e9 * i + 1.901_8e6) * i + 0.247_48e3) * i + 0.237_040
    };
    (x, (-3.0 * x + 2.87) * x - 0.275)
}

fn xyz_from_xy((x, y): (f64, f64)) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

/// Returns the matrix from linear Rec.709 RGB to XYZ (IEC 61966-2-1).
fn xyz_from_rgb() -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.412_390_8, 0.212_639_0, 0.019_330_8),
        DVec3::new(0.357_584_3, 0.715_168_7, 0.119_194_8),
        DVec3::new(0.180_480_8, 0.072_192_3, 0.950_532_2),
    )
}

/// Returns the Bradford matrix from XYZ to cone responses.
fn bradford() -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.8951, -0.7502, 0.0389),
        DVec3::new(0.2664, 1.7135, -0.0685),
        DVec3::new(-0.1614, 0.0367, 1.0296),
    )
}

const D65_XY: (f64, f64) = (0.312_727, 0.329_023);

/// Returns RGB of a chromaticity for a camera balanced to `white`, scaled to luminance 1. Negative channels of colours
/// outside Rec.709 are clamped to 0 before scaling.
fn rgb_from_xy(xy: (f64, f64), white: (f64, f64)) -> Vec3 {
    let cone = bradford();
    let (from, to) = (cone * xyz_from_xy(white), cone * xyz_from_xy(D65_XY));
    let adapt = cone.inverse() * DMat3::from_diagonal(to / from) * cone;
    let rgb = xyz_from_rgb().inverse() * (adapt * xyz_from_xy(xy));
    unit_luminance(rgb.as_vec3().max(Vec3::ZERO))
}

/// Scales a colour to luminance 1. Returns white for black.
pub fn unit_luminance(rgb: Vec3) -> Vec3 {
    let y = luminance(rgb);
    if y > 0.0 && y.is_finite() { rgb / y } else { Vec3::ONE }
}

/// Returns RGB of a light of a colour temperature for a camera balanced to `white_balance_k`, scaled to luminance 1.
pub fn rgb_from_kelvin(kelvin: f32, white_balance_k: f32) -> Vec3 {
    rgb_from_xy(xy_from_kelvin(f64::from(kelvin)), xy_from_kelvin(f64::from(white_balance_k)))
}

/// Returns the colour temperature behind a gel that shifts by `mired`, at most 25000 K.
pub fn shift_kelvin(kelvin: f32, mired: f32) -> f32 {
    1e6 / (1e6 / kelvin + mired).max(40.0)
}

/// Encodes a linear value in 0..=1 in sRGB (IEC 61966-2-1).
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Decodes an sRGB value in 0..=1 to linear.
pub fn srgb_decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Value at which the shoulder of the tone curve begins.
const SHOULDER: f32 = 0.6;

/// Applies the tone curve to one channel: linear up to 0.6, so that meter and picture agree on skin and grey cards,
/// then a smooth shoulder that approaches 1. White paper (0.9) becomes 0.81, one stop above it 0.97.
pub fn tone_curve(x: f32) -> f32 {
    let x = if x > 0.0 { x } else { 0.0 };
    let range = 1.0 - SHOULDER;
    if x <= SHOULDER { x } else { SHOULDER + range * (1.0 - (-(x - SHOULDER) / range).exp()) }
}

/// Applies the tone curve and sRGB encoding to a scene-linear pixel.
pub fn display_srgb8(rgb: [f32; 3]) -> [u8; 3] {
    rgb.map(|c| (srgb_encode(tone_curve(c)) * 255.0 + 0.5) as u8)
}

/// As [`display_srgb8`], with 16 bits a channel.
pub fn display_srgb16(rgb: [f32; 3]) -> [u16; 3] {
    rgb.map(|c| (srgb_encode(tone_curve(c)) * 65_535.0 + 0.5) as u16)
}

/// Returns [`display_srgb8`] of a pixel, dithered by less than one code against contour lines in dark backdrops:
/// interleaved gradient noise (Jimenez 2014, "Next Generation Post Processing in Call of Duty"), as in the live view.
/// Values that are codes stay as they are.
pub fn dithered_srgb8(rgb: [f32; 3], [x, y]: [u32; 2]) -> [u8; 3] {
    let stripes = (0.067_110_56 * x as f32 + 0.005_837_15 * y as f32).fract();
    let noise = ((52.982_92 * stripes).fract() - 0.5) * DITHER_CODES;
    rgb.map(|c| (srgb_encode(tone_curve(c)) * 255.0 + noise + 0.5) as u8)
}

/// Width of the dither's distribution, codes. Under 1, so that codes stay as they are.
const DITHER_CODES: f32 = 0.9;

/// A lookup table of tone curve and sRGB encoding, within one code of 255, for interactive display: it avoids the power
/// function.
#[derive(Debug)]
pub struct ToneTable(Vec<u8>);

impl Default for ToneTable {
    fn default() -> Self {
        ToneTable::new()
    }
}

impl ToneTable {
    /// Mantissa bits that the table index leaves out: steps of 1/256 of the value.
    const DROPPED_BITS: u32 = 15;
    /// Values below are black, values above `MAX` white.
    const MIN: f32 = 1.0 / 16384.0;
    const MAX: f32 = 16.0;

    /// Computes the table.
    pub fn new() -> Self {
        let (first, last) = (Self::MIN.to_bits() >> Self::DROPPED_BITS, Self::MAX.to_bits() >> Self::DROPPED_BITS);
        let middle = |index: u32| f32::from_bits(index << Self::DROPPED_BITS | 1 << (Self::DROPPED_BITS - 1));
        ToneTable((first..=last).map(|index| display_srgb8([middle(index); 3])[0]).collect())
    }

    /// Returns [`display_srgb8`] of a pixel, within one code.
    pub fn display_srgb8(&self, rgb: [f32; 3]) -> [u8; 3] {
        rgb.map(|value| {
            // NaN is black, as in the tone curve
            let value = if value >= Self::MIN { value.min(Self::MAX) } else { return 0 };
            self.0[((value.to_bits() >> Self::DROPPED_BITS) - (Self::MIN.to_bits() >> Self::DROPPED_BITS)) as usize]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_within_one_code_of_the_tone_curve() {
        let table = ToneTable::new();
        for step in 0..4000 {
            let value = 1e-6 * 1.006_f32.powi(step);
            let (ours, exact) = (table.display_srgb8([value; 3])[0], display_srgb8([value; 3])[0]);
            assert!(ours.abs_diff(exact) <= 1, "{value}: {ours} for {exact}");
        }
        assert_eq!(table.display_srgb8([f32::NAN, -1.0, f32::INFINITY]), [0, 0, 255]);
    }

    #[test]
    fn a_light_of_the_white_balance_is_neutral() {
        for k in [2900.0, 4500.0, 5500.0, 9000.0] {
            assert!((rgb_from_kelvin(k, k) - Vec3::ONE).abs().max_element() < 1e-3, "{k}");
        }
    }

    #[test]
    fn tungsten_is_warm_and_shade_is_cool_at_daylight_balance() {
        let (warm, cool) = (rgb_from_kelvin(3200.0, 5500.0), rgb_from_kelvin(7500.0, 5500.0));
        assert!(warm.x > warm.y && warm.y > warm.z && cool.z > cool.y && cool.y > cool.x);
        assert!((luminance(warm) - 1.0).abs() < 1e-5 && (luminance(cool) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn kelvin_matches_published_chromaticities() {
        // CIE illuminant A (Planck, 2856 K) and D65 (daylight, 6504 K).
        for (k, (x, y)) in [(2856.0, (0.44758, 0.40745)), (6504.0, (0.31272, 0.32903))] {
            let ours = xy_from_kelvin(k);
            assert!((ours.0 - x).abs() < 5e-4 && (ours.1 - y).abs() < 5e-4, "{k}: {ours:?}");
        }
    }

    #[test]
    fn gels_shift_in_mired() {
        for (mired, k) in [(159.0, 2934.0), (109.0, 3439.0), (64.0, 4068.0), (26.0, 4812.0)] {
            assert!((shift_kelvin(5500.0, mired) - k).abs() < 1.0);
        }
    }

    #[test]
    fn the_tone_curve_preserves_grey_and_is_monotonic_without_steps() {
        assert_eq!(tone_curve(0.18), 0.18);
        let mut last = 0.0;
        for i in 0..1000 {
            let y = tone_curve(i as f32 * 0.01);
            assert!(y >= last && y - last < 0.0101 && y <= 1.0);
            last = y;
        }
        assert_eq!(tone_curve(f32::NAN), 0.0);
        assert_eq!(display_srgb8([0.18; 3]), [118; 3]);
    }

    #[test]
    fn srgb_round_trips() {
        for i in 0..=255 {
            let encoded = i as f32 / 255.0;
            assert!((srgb_encode(srgb_decode(encoded)) - encoded).abs() < 1e-5);
        }
    }
}
