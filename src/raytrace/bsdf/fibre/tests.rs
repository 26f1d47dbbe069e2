//! Energy, densities and symmetries of the fibre BSDF.

use super::*;
use crate::scene::FibreColor;
use crate::statistics::{ChiSquare, SampleMean, TestRng, critical_z, sidak_level};
use std::f64::consts::TAU as TAU64;

/// Roughness along and around of the tests: smooth, human, dull.
const ROUGHNESS: [(f32, f32); 4] = [(0.1, 0.3), (0.3, 0.3), (0.6, 0.15), (1.0, 1.0)];
/// Sines of the outgoing longitude, both signs and grazing.
const SINES: [f32; 3] = [0.1, -0.8, 0.98];
const OFFSETS: [f32; 3] = [0.0, 0.5, -0.98];

fn fibre(melanin: f32, (roughness_along, roughness_around): (f32, f32)) -> TracedFibre {
    let color = FibreColor::Melanin { melanin, redness: 0.3 };
    TracedFibre::new(&Fibre { color, roughness_along, roughness_around })
}

/// Returns an outgoing direction at this sine of the longitude, of a fibre along Z.
fn outgoing(sin_theta: f32) -> Vec3 {
    let cos_theta = (1.0 - sin_theta * sin_theta).sqrt();
    Vec3::new(0.6 * cos_theta, -0.8 * cos_theta, sin_theta)
}

fn cases() -> Vec<((f32, f32), f32, f32)> {
    let offsets = |roughness, sin| OFFSETS.map(|h| (roughness, sin, h));
    ROUGHNESS.into_iter().flat_map(|roughness| SINES.into_iter().flat_map(move |sin| offsets(roughness, sin))).collect()
}

/// Integrates value and density over the sphere: over the sine of the longitude, finer near the lobes' peak, and over
/// the azimuth.
fn integrate(bsdf: &FibreBsdf<'_>, mut add: impl FnMut(usize, f64)) -> (f64, f64) {
    const RINGS: usize = 360;
    const TURNS: usize = 180;
    let (mut value_sum, mut pdf_sum) = (0.0, 0.0);
    for i in 0..RINGS {
        // Equal steps of the longitude: lobes are narrow in it.
        let theta = ((i as f64 + 0.5) / RINGS as f64 - 0.5) * std::f64::consts::PI;
        let solid_angle = theta.cos() * std::f64::consts::PI / RINGS as f64 * TAU64 / TURNS as f64;
        for j in 0..TURNS {
            let phi = TAU64 * (j as f64 + 0.5) / TURNS as f64;
            let (sin, cos) = (theta.sin(), theta.cos());
            let direction = Vec3::new((cos * phi.cos()) as f32, (cos * phi.sin()) as f32, sin as f32);
            let (value, pdf) = bsdf.eval(direction);
            value_sum += f64::from(value.x) * solid_angle;
            pdf_sum += f64::from(pdf) * solid_angle;
            add(cell(direction), f64::from(pdf) * solid_angle);
        }
    }
    (value_sum, pdf_sum)
}

const CELL_RINGS: usize = 30;
const CELL_TURNS: usize = 12;

/// Returns the cell of a direction: equal steps of longitude and azimuth.
fn cell(direction: Vec3) -> usize {
    let ring = (f64::from(direction.z).clamp(-1.0, 1.0).asin() / std::f64::consts::PI + 0.5) * CELL_RINGS as f64;
    let turn = (f64::from(direction.y).atan2(f64::from(direction.x)) / TAU64).rem_euclid(1.0) * CELL_TURNS as f64;
    (ring as usize).min(CELL_RINGS - 1) * CELL_TURNS + (turn as usize).min(CELL_TURNS - 1)
}

#[test]
fn white_fibres_scatter_all_light_in_a_white_furnace() {
    // The midpoint rule is within 0.1 % for all lobes but those near the fibre's own direction.
    for (roughness, sin, h) in cases() {
        let fibre = fibre(0.0, roughness);
        let (albedo, pdf) = integrate(&FibreBsdf::new(&fibre, Vec3::Z, h, outgoing(sin)), |_, _| {});
        assert!((albedo - 1.0).abs() < 0.005, "{roughness:?} {sin} {h}: {albedo}");
        assert!((pdf - 1.0).abs() < 0.005, "{roughness:?} {sin} {h}: density {pdf}");
        assert!((fibre.albedo() - 1.0).abs().max_element() < 1e-4, "{}", fibre.albedo());
    }
}

#[test]
fn sampled_directions_follow_their_pdf_and_weigh_the_integral() {
    const SAMPLES: usize = 20_000;
    let mut rng = TestRng::new(31);
    let cases = cases();
    for &(roughness, sin, h) in &cases {
        let fibre = fibre(0.6, roughness);
        let bsdf = FibreBsdf::new(&fibre, Vec3::Z, h, outgoing(sin));
        let mut expected = vec![0.0; CELL_RINGS * CELL_TURNS];
        let (albedo, density) = integrate(&bsdf, |cell, pdf| expected[cell] += pdf);
        let mut counts = vec![0.0; expected.len()];
        let mut weights = Vec::new();
        for _ in 0..SAMPLES {
            let sample = bsdf.sample(rng.uniform(), rng.unit_square()).unwrap();
            assert!(!sample.specular && (sample.direction.length() - 1.0).abs() < 1e-5);
            counts[cell(sample.direction)] += 1.0;
            weights.push(f64::from(sample.weight.x));
            // Where densities fall by a factor of e in 1e-3 of the sine, single precision leaves 1 %.
            let (value, pdf) = bsdf.eval(sample.direction);
            assert!((pdf - sample.pdf).abs() <= 0.01 * pdf + 1e-6, "{roughness:?} {sin} {h}: {pdf} {}", sample.pdf);
            assert!((value - sample.weight * sample.pdf).abs().max_element() <= 0.01 * value.max_element() + 1e-6);
        }
        let mut test = ChiSquare::default();
        let samples = SAMPLES as f64;
        counts.iter().zip(&expected).for_each(|(&c, &e)| test.add_bin(c, (e / density * samples).max(1e-9)));
        let p = test.p_value();
        assert!(p > sidak_level(cases.len()), "{roughness:?} {sin} {h}: p = {p}");
        let mean = SampleMean::of(weights);
        let error = critical_z(cases.len()) * mean.standard_error + 0.002;
        assert!((mean.mean - albedo).abs() < error, "{roughness:?} {sin} {h}: {mean:?} for {albedo}");
    }
}

#[test]
fn the_longitudinal_density_is_reciprocal_and_the_azimuthal_one_integrates_to_one() {
    let mut rng = TestRng::new(32);
    for roughness in ROUGHNESS {
        let fibre = fibre(0.5, roughness);
        for _ in 0..1000 {
            let [(sin_i, cos_i), (sin_o, cos_o)] = [(); 2].map(|()| rng.range(-1.5, 1.5).sin_cos());
            for lobe in &fibre.longitudinal {
                let there = lobe.density(sin_i, cos_i, sin_o, cos_o);
                assert_eq!(there, lobe.density(sin_o, cos_o, sin_i, cos_i));
            }
        }
        let steps = 20_000;
        let density = |i| f64::from(fibre.azimuthal.density(7.0 + TAU * (i as f32 + 0.5) / steps as f32));
        let sum = (0..steps).map(density).sum::<f64>() * TAU64 / f64::from(steps);
        assert!((sum - 1.0).abs() < 1e-3, "{roughness:?}: {sum}");
    }
}

#[test]
fn reflection_leaves_a_fibre_like_a_mirror_on_its_surface() {
    // The mean azimuth of R at an offset is that of a mirror with the normal of the cylinder there.
    for h in [-0.7_f32, -0.2, 0.5] {
        let (sin_theta, wo) = (0.0, Vec3::X);
        let (_, sin_gamma_t) = attenuations(Vec3::ONE, sin_theta, 1.0, h);
        let azimuth = azimuths(h, sin_gamma_t)[0];
        // The tangent is Z, the azimuth counts from X towards Y, the point lies at -h along Y.
        let normal = Vec3::new((1.0 - h * h).sqrt(), -h, 0.0);
        let mirrored = 2.0 * wo.dot(normal) * normal - wo;
        let mean = Vec3::new(azimuth.cos(), azimuth.sin(), 0.0);
        assert!((mean - mirrored).length() < 1e-5, "{h}: {mean} for {mirrored}");
    }
}

/// Returns mean and variance of a value over the offsets at which rays meet a fibre.
fn over_offsets(value: impl Fn(f32) -> f32) -> (f64, f64) {
    const STEPS: u32 = 1024;
    let values = (0..STEPS).map(|i| f64::from(value(2.0 * (i as f32 + 0.5) / STEPS as f32 - 1.0)));
    let (sum, squares) = values.fold((0.0, 0.0), |(sum, squares), value| (sum + value, squares + value * value));
    let mean = sum / f64::from(STEPS);
    (mean, squares / f64::from(STEPS) - mean * mean)
}

/// Returns the value that a fibre along Z has at one offset (Chiang et al. 2016).
fn at_offset(fibre: &TracedFibre, h: f32, wo: Vec3, direction: Vec3) -> Vec3 {
    let bsdf = FibreBsdf::new(fibre, Vec3::Z, h, wo);
    let (attenuation, sin_gamma_t) = attenuations(fibre.absorption, wo.z, safe_sqrt(1.0 - wo.z * wo.z), h);
    let azimuths = azimuths(h, sin_gamma_t);
    let azimuth = direction.dot(bsdf.across).atan2(direction.dot(bsdf.facing));
    let lobe = |lobe: usize| {
        let (sin_o, cos_o) = bsdf.outgoing[lobe];
        let along =
            fibre.longitudinal[lobe].density(direction.z, safe_sqrt(1.0 - direction.z * direction.z), sin_o, cos_o);
        let around = azimuths.get(lobe).map_or(1.0 / TAU, |&mean| fibre.azimuthal.density(azimuth - mean));
        attenuation[lobe] * (along * around)
    };
    (0..LOBES).map(lobe).sum()
}

#[test]
fn the_mean_over_the_width_is_that_of_all_offsets_with_a_twentieth_of_their_variance() {
    let fibre = fibre(0.7, (0.3, 0.3));
    let mut rng = TestRng::new(34);
    let (mut ours, mut single) = (0.0, 0.0);
    for _ in 0..100 {
        let (wo, direction) = (outgoing(rng.range(-0.9, 0.9)), rng.direction());
        let (expected, single_variance) = over_offsets(|h| at_offset(&fibre, h, wo, direction).x);
        let (mean, variance) = over_offsets(|h| FibreBsdf::new(&fibre, Vec3::Z, h, wo).eval(direction).0.x);
        assert!((mean - expected).abs() < 0.01 * expected + 1e-5, "{wo} {direction}: {mean} for {expected}");
        (ours, single) = (ours + variance, single + single_variance);
    }
    assert!(ours < 0.05 * single, "variance {ours} for {single}");
}

#[test]
fn black_fibres_reflect_as_a_smooth_cylinder_does() {
    // N of R over all offsets of a smooth cylinder is cos(phi / 2) / 4 times the reflectance at the offset sin(phi / 2)
    // (Marschner et al. 2003). Blue light leaves black fibres by R alone.
    let fibre = fibre(1.0, (0.3, 0.05));
    for phi in [0.3_f32, 1.2, 2.2] {
        let half = 0.5 * phi;
        let reflectance = fresnel::dielectric(half.cos(), IOR);
        let (sin_o, cos_o) = FibreBsdf::new(&fibre, Vec3::Z, 0.0, Vec3::X).outgoing[0];
        let along = fibre.longitudinal[0].density(0.0, 1.0, sin_o, cos_o);
        let expected = f64::from(along * reflectance * half.cos() / 4.0);
        let direction = Vec3::new(phi.cos(), phi.sin(), 0.0);
        let (mean, _) = over_offsets(|h| FibreBsdf::new(&fibre, Vec3::Z, h, Vec3::X).eval(direction).0.z);
        assert!((mean / expected - 1.0).abs() < 0.02, "{phi}: {mean} for {expected}");
    }
}

#[test]
fn the_scales_reflect_towards_the_root_and_colour_towards_the_tip() {
    // Lit and seen from the front, a scale's normal leans to the root, so that R leaves towards the root.
    let fibre = fibre(0.5, (0.1, 0.3));
    let bsdf = FibreBsdf::new(&fibre, Vec3::Z, 0.3, Vec3::X);
    let peak = |lobe: usize| {
        let at = |step: i32| (step as f32 * 0.001).sin_cos();
        let density = |step: &i32| {
            let ((sin, cos), (sin_o, cos_o)) = (at(*step), bsdf.outgoing[lobe]);
            fibre.longitudinal[lobe].density(sin, cos, sin_o, cos_o)
        };
        (-300..300).max_by(|a, b| density(a).total_cmp(&density(b))).unwrap() as f32 * 0.001
    };
    let expected = [-2.0, 1.0, 4.0].map(|factor: f32| (factor * TILT_DEG).to_radians());
    for (lobe, expected) in expected.into_iter().enumerate() {
        // The Bessel function falls towards the pole, which moves the peak of the widest lobe by 0.14 degrees.
        assert!((peak(lobe) - expected).abs() < 0.0025, "{lobe}: {} for {expected}", peak(lobe));
    }
}

#[test]
fn more_melanin_is_darker_and_a_dye_gives_its_colour_to_much_hair() {
    let mut last = Vec3::ONE;
    for step in 1..=20 {
        let albedo = fibre(0.05 * step as f32, (0.3, 0.3)).albedo();
        assert!(albedo.cmplt(last).all(), "{step}: {albedo} after {last}");
        last = albedo;
    }
    // Black hair reflects by its surface alone: 5 to 10 %.
    assert!(last.max_element() < 0.15 && last.min_element() > 0.04, "{last}");
    // Brighter dyes and redder ones keep their order.
    let dye = |color| TracedFibre::new(&Fibre { color: FibreColor::Dye(color), ..Fibre::default() }).albedo();
    let red = dye([0.8, 0.2, 0.1]);
    assert!(red.x > red.y && red.y > red.z && dye([0.9; 3]).x > dye([0.4; 3]).x);
}

#[test]
fn the_bessel_function_agrees_with_its_series() {
    for x in [0.0_f64, 0.5, 2.0, 3.74, 3.76, 8.0, 20.0] {
        let mut term = 1.0;
        let mut sum = 1.0;
        for k in 1..200 {
            term *= x * x / 4.0 / f64::from(k * k);
            sum += term;
        }
        let (ours, expected) = (f64::from(scaled_bessel_i0(x as f32)), sum * (-x).exp());
        assert!((ours - expected).abs() < 1e-6 * expected, "{x}: {ours} for {expected}");
    }
}

#[test]
fn directions_along_the_fibre_and_offsets_at_the_rim_are_finite() {
    let fibre = fibre(0.4, (0.3, 0.3));
    let mut rng = TestRng::new(33);
    for wo in [Vec3::Z, Vec3::NEG_Z, Vec3::X] {
        for h in [-1.0, 0.0, 1.0] {
            let bsdf = FibreBsdf::new(&fibre, Vec3::Z, h, wo);
            for _ in 0..100 {
                let sample = bsdf.sample(rng.uniform(), rng.unit_square());
                assert!(sample.is_none_or(|s| s.direction.is_finite() && s.weight.is_finite() && s.pdf.is_finite()));
                let (value, pdf) = bsdf.eval(rng.direction());
                assert!(value.is_finite() && pdf.is_finite());
            }
        }
    }
}
