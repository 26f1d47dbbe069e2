//! Eight points, directions or colours side by side, one a lane.

use glam::Vec3;
use std::ops::{Add, Neg, Sub};
use wide::f32x8;

/// Lanes of a packet.
pub(super) const LANES: usize = 8;

/// Eight vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vec3x8 {
    pub x: f32x8,
    pub y: f32x8,
    pub z: f32x8,
}

impl Vec3x8 {
    pub const ZERO: Self = Vec3x8 { x: f32x8::ZERO, y: f32x8::ZERO, z: f32x8::ZERO };

    pub fn splat(v: Vec3) -> Self {
        Vec3x8 { x: f32x8::splat(v.x), y: f32x8::splat(v.y), z: f32x8::splat(v.z) }
    }

    /// The vector that `of` gives for each lane.
    pub fn from_lanes(of: impl Fn(usize) -> Vec3) -> Self {
        let lanes: [Vec3; LANES] = std::array::from_fn(of);
        Vec3x8 {
            x: f32x8::from(lanes.map(|v| v.x)),
            y: f32x8::from(lanes.map(|v| v.y)),
            z: f32x8::from(lanes.map(|v| v.z)),
        }
    }

    /// One lane after the other.
    pub fn lanes(self) -> [Vec3; LANES] {
        let (x, y, z) = (self.x.to_array(), self.y.to_array(), self.z.to_array());
        std::array::from_fn(|k| Vec3::new(x[k], y[k], z[k]))
    }

    pub fn dot(self, other: Self) -> f32x8 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    pub fn times(self, factor: f32x8) -> Self {
        Vec3x8 { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    /// Component by component.
    pub fn tinted(self, other: Self) -> Self {
        Vec3x8 { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    /// Unit vectors; zero where there is no direction.
    pub fn normalize_or_zero(self) -> Self {
        let squared = self.dot(self);
        self.times(squared.simd_gt(f32x8::ZERO) & (f32x8::ONE / squared.sqrt()))
    }

    /// Turned round where it points away from `other`.
    pub fn towards(self, other: Self) -> Self {
        let away = self.dot(other).simd_lt(f32x8::ZERO);
        let sign = away.bitselect(-f32x8::ONE, f32x8::ONE);
        self.times(sign)
    }
}

/// x^n lane by lane, for 0 < x <= 1 and n >= 0.
pub(super) fn power(x: f32x8, n: f32x8) -> f32x8 {
    let (x, n) = (x.to_array(), n.to_array());
    f32x8::from(std::array::from_fn::<f32, LANES, _>(|k| two_to(log2(x[k]) * n[k])))
}

/// Base-2 logarithm of a normal positive number, to 2e-7 absolute: the exponent, and the series of
/// artanh((m - 1) / (m + 1)) for a mantissa between sqrt(1/2) and sqrt(2). Without a jump, so that lanes can share it.
fn log2(x: f32) -> f32 {
    const SQRT_HALF: i32 = std::f32::consts::FRAC_1_SQRT_2.to_bits() as i32;
    let exponent = (x.to_bits() as i32 - SQRT_HALF) >> 23;
    let mantissa = f32::from_bits((x.to_bits() as i32 - (exponent << 23)) as u32);
    let t = (mantissa - 1.0) / (mantissa + 1.0);
    let square = t * t;
    let series = 1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0)));
    exponent as f32 + 2.0 * std::f32::consts::LOG2_E * t * series
}

/// Two to the power of a number under 1, to 3e-7 of the result; 2^-125 for all below. Without a jump, too.
fn two_to(power: f32) -> f32 {
    /// Adding it rounds to whole numbers, which then are its last bits.
    const ROUNDER: f32 = 12_582_912.0;
    let power = if power > -125.0 { power } else { -125.0 };
    let rounded = power + ROUNDER;
    let whole = rounded.to_bits() as i32 - ROUNDER.to_bits() as i32;
    let f = (power - (rounded - ROUNDER)) * std::f32::consts::LN_2;
    // Taylor's series for |f| under 0.35.
    let series =
        1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    f32::from_bits((series.to_bits() as i32 + (whole << 23)) as u32)
}

impl Add for Vec3x8 {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Vec3x8 { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Vec3x8 {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Vec3x8 { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Neg for Vec3x8 {
    type Output = Self;

    fn neg(self) -> Self {
        Vec3x8::ZERO - self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lane_is_what_one_vector_would_be() {
        let one = |k: usize| if k == 3 { Vec3::ZERO } else { Vec3::new(k as f32 - 3.5, 0.3, -0.1 * k as f32) };
        let other = |k: usize| Vec3::new(0.5, k as f32 - 4.0, 1.0);
        let (a, b) = (Vec3x8::from_lanes(one), Vec3x8::from_lanes(other));
        let close = |x: Vec3, y: Vec3| assert!((x - y).length() < 1e-5, "{x} {y}");
        for k in 0..LANES {
            assert!((a.dot(b).to_array()[k] - one(k).dot(other(k))).abs() < 1e-5);
            close(a.normalize_or_zero().lanes()[k], one(k).normalize_or_zero());
            let turned = if one(k).dot(other(k)) < 0.0 { -one(k) } else { one(k) };
            close(a.towards(b).lanes()[k], turned);
            close((a - b + -a).lanes()[k], -other(k));
            close(a.tinted(b).times(f32x8::splat(2.0)).lanes()[k], one(k) * other(k) * 2.0);
        }
    }

    #[test]
    fn powers_are_those_of_the_library() {
        for n in [0.0_f32, 0.7, 1.0, 13.0, 800.0, 2e4] {
            for x in [1e-30_f32, 1e-3, 0.3, 0.707, std::f32::consts::FRAC_1_SQRT_2, 0.99, 0.999_999, 1.0] {
                let (got, exact) = (power(f32x8::splat(x), f32x8::splat(n)).to_array()[5], x.powf(n));
                // The logarithm's error counts n times.
                let error = (got - exact).abs();
                assert!(error <= 1e-6 * exact * (1.0 + 0.3 * n) + 1e-30, "{x}^{n}: {got}, not {exact}");
            }
        }
    }
}
