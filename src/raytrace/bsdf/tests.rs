//! Statistical tests of BSDFs: densities, energy, and the geometry of specular directions.

use super::*;
use crate::math::simd::LANES;
use crate::math::{orthonormal_basis, warp};
use crate::scene::{Material, MaterialPreset};
use crate::statistics::{ChiSquare, SampleMean, TestRng, sidak_level};
use std::f32::consts::TAU;

/// Returns the albedo in a white furnace: the mean weight of many stratified samples.
fn furnace(material: &Material, cos: f32) -> Vec3 {
    albedo(&TracedMaterial::new(material), cos)
}

/// Returns the albedo of a prepared material in a white furnace.
fn albedo(material: &TracedMaterial, cos: f32) -> Vec3 {
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let bsdf = Bsdf::new(material, Vec3::ONE, Vec3::Z, Vec3::Z, wo);
    let n = 128;
    let mut sum = Vec3::ZERO;
    for i in 0..n * n {
        let set = sobol_burley::sample_4d(i, 0, 7);
        if let Some(sample) = bsdf.sample(set[0], Vec2::new(set[2], set[3])) {
            sum += sample.weight / sample.eta_scale;
        }
    }
    sum / (n * n) as f32
}

#[test]
fn white_materials_have_albedo_one_in_a_white_furnace() {
    // The error of 16384 Sobol samples is less than 0.2 % here, that of the albedo tables less than 1e-4.
    for roughness in [0.0, 0.01, 0.1, 0.3, 0.6, 1.0] {
        for cos in [1.0, 0.7, 0.3, 0.1] {
            let white = Material { base_color: [1.0; 3], roughness, ..Material::default() };
            let metal = Material { metallic: 1.0, ..white.clone() };
            let glass = Material { transmission: 1.0, ..white.clone() };
            for material in [&white, &metal, &glass] {
                let albedo = furnace(material, cos).x;
                assert!((albedo - 1.0).abs() < 0.003, "{material:?} under {cos}: {albedo}");
            }
        }
    }
}

#[test]
fn blurred_gloss_reflects_as_much_as_the_gloss_it_replaces() {
    let gloss = std::sync::Arc::new(BlurredGloss::new(1.5, 0.5));
    for base_color in [0.0, 1.0] {
        for roughness in [0.0, 0.1, 0.3, 0.45] {
            let material = Material { base_color: [base_color; 3], roughness, ..Material::default() };
            let sharp = TracedMaterial::new(&material);
            assert!(sharp.has_gloss_below(0.5));
            let blurred = sharp.with_blurred_gloss(&gloss);
            for cos in [1.0, 0.7, 0.3, 0.1] {
                let (ours, truth) = (albedo(&blurred, cos), albedo(&sharp, cos));
                assert!((ours - truth).abs().max_element() < 0.003, "{material:?} under {cos}: {ours}, not {truth}");
            }
        }
    }
    // Rougher gloss and textures of rougher places stay as they are
    let rough = Material { roughness: 0.9, ..Material::default() };
    assert!(!TracedMaterial::new(&rough).has_gloss_below(0.5));
    let textured = mapped(&Material { roughness: 1.0, ..Material::default() });
    let blurred = textured.with_blurred_gloss(&gloss);
    let wo = Vec3::new(0.6, 0.0, 0.8);
    let eval = |material, roughness| {
        let factors = TextureFactors { roughness, ..TextureFactors::ONE };
        Bsdf::new(material, factors, Vec3::Z, Vec3::Z, wo).eval(Vec3::new(-0.6, 0.0, 0.8)).0.x
    };
    assert_eq!(eval(&blurred, 0.8), eval(&textured, 0.8));
    assert!(eval(&blurred, 0.2) < 0.5 * eval(&textured, 0.2), "the mirror direction is darker");
}

/// Returns a material whose roughness and metal a texture varies.
fn mapped(material: &Material) -> TracedMaterial {
    let mut traced = TracedMaterial::new(material);
    traced.map_gloss(material, std::sync::Arc::new(RoughnessTables::new(material.ior)));
    traced
}

#[test]
fn mapped_roughness_and_metal_are_those_of_a_material_with_their_product() {
    let base = Material { base_color: [0.8, 0.5, 0.2], roughness: 0.9, metallic: 1.0, ..Material::default() };
    let textured = mapped(&base);
    for (roughness, metallic) in [(0.1, 0.0), (0.3, 0.4), (0.77, 1.0), (1.0, 0.5)] {
        let constant = Material { roughness: 0.9 * roughness, metallic, ..base.clone() };
        let constant = TracedMaterial::new(&constant);
        for cos in [0.9_f32, 0.3] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let factors = TextureFactors { color: Vec3::ONE, roughness, metallic };
            let (ours, truth) = (
                Bsdf::new(&textured, factors, Vec3::Z, Vec3::Z, wo),
                Bsdf::new(&constant, Vec3::ONE, Vec3::Z, Vec3::Z, wo),
            );
            for i in 0..200 {
                let set = sobol_burley::sample_4d(i, 0, 11);
                let direction = warp::uniform_sphere(Vec2::new(set[0], set[1]));
                let ((value, pdf), (expected, expected_pdf)) = (ours.eval(direction), truth.eval(direction));
                // Albedos are interpolated between 33 levels of roughness
                let tolerance = 0.01 * expected.max_element() + 1e-4;
                assert!(
                    (value - expected).abs().max_element() < tolerance,
                    "{roughness} {metallic}: {value} {expected}"
                );
                assert!((pdf - expected_pdf).abs() < 0.01 * expected_pdf + 1e-4, "{roughness} {metallic}: {pdf}");
            }
        }
    }
}

#[test]
fn no_normal_map_reflects_more_light_than_arrives() {
    // White plastic and white metal under normals that are tilted up to the horizon and beyond, in a white furnace
    for material in [Material { metallic: 1.0, ..Material::default() }, Material::default()] {
        for roughness in [0.05, 0.4, 1.0] {
            let white = mapped(&Material { base_color: [1.0; 3], roughness, ..material.clone() });
            for i in 0..60 {
                let set = sobol_burley::sample_4d(i, 0, 13);
                let wo = warp::cosine_hemisphere(Vec2::new(set[0], set[1]));
                let tilted = warp::uniform_sphere(Vec2::new(set[2], 0.8 * set[3]));
                let normal = crate::math::bend_above(tilted, Vec3::Z, wo);
                let mut bsdf = Bsdf::new(&white, Vec3::ONE, normal, Vec3::Z, wo);
                bsdf.set_relief(tilted);
                let weights = (0..1024).map(|k| {
                    let set = sobol_burley::sample_4d(k, 0, 17);
                    let sample = bsdf.sample(set[0], Vec2::new(set[2], set[3]));
                    let sample = sample.filter(|sample| sample.direction.z > 0.0);
                    sample.map_or(0.0, |sample| sample.weight.max_element())
                });
                let albedo = weights.sum::<f32>() / 1024.0;
                // Sampling noise of a white lobe is below 2 %
                assert!(albedo < 1.02, "{roughness}: albedo {albedo} for {wo} and {normal}");
                let is_lit = tilted.z > 0.0 || material.metallic > 0.0;
                assert!(albedo > 0.2 || wo.z < 0.1 || !is_lit, "{roughness}: black, {albedo}, for {wo} and {normal}");
            }
        }
    }
}

#[test]
fn lanes_evaluate_and_sample_a_bsdf_as_one_direction_after_the_other() {
    let mut rng = TestRng::new(31);
    let plastic = Material { base_color: [0.7, 0.4, 0.2], roughness: 0.3, ..Material::default() };
    let materials = [
        TracedMaterial::new(&plastic),
        TracedMaterial::new(&Material { ior: 1.0, roughness: 1.0, ..plastic.clone() }),
        TracedMaterial::new(&Material { metallic: 1.0, ..plastic.clone() }),
        TracedMaterial::new(&Material { roughness: 0.0, ..plastic.clone() }),
        TracedMaterial::new(&Material { transmission: 0.4, ..plastic.clone() }),
        TracedMaterial::new(&Material { transmission: 1.0, ..plastic.clone() }),
        TracedMaterial::new(&MaterialPreset::Velvet.material()),
        mapped(&Material { metallic: 0.3, ..plastic.clone() }),
        TracedMaterial::new(&plastic).with_blurred_gloss(&std::sync::Arc::new(BlurredGloss::new(1.5, 0.6))),
    ];
    let (mut lit, mut sampled) = (0, 0);
    for (material, _) in materials.iter().flat_map(|material| std::iter::repeat_n(material, 40).zip(0..)) {
        let (normal, wo) = (rng.direction(), rng.direction());
        let plain = Bsdf::new(material, Vec3::ONE, normal, normal, wo);
        let [mut relief, mut soft, mut coat] = [plain; 3];
        relief.set_relief(rng.direction());
        soft.set_subsurface();
        coat.remove_matte_base();
        for bsdf in [plain, relief, soft, coat, Bsdf::at_exit(material, normal, normal)] {
            // Evaluate
            let mut directions = Vec3Lanes::ZERO;
            (0..LANES).for_each(|lane| directions.set_lane(lane, rng.direction()));
            let values = bsdf.eval_lanes(&directions, LANES);
            for lane in 0..LANES {
                assert_eq!(values.lane(lane), bsdf.eval(directions.lane(lane)), "{bsdf:?}");
                lit += usize::from(values.lane(lane).1 > 0.0);
            }
            // Sample
            let mut numbers = || std::array::from_fn(|_| rng.uniform());
            let numbers = BsdfNumbers { lobe: numbers(), u: [numbers(), numbers()] };
            let Some(samples) = bsdf.sample_lanes(&numbers) else { continue };
            for lane in 0..LANES {
                let u = Vec2::new(numbers.u[0][lane], numbers.u[1][lane]);
                let (ours, one) = (samples.lane(lane), bsdf.sample(numbers.lobe[lane], u));
                assert_eq!(format!("{ours:?}"), format!("{one:?}"), "{bsdf:?}");
                sampled += usize::from(ours.is_some());
            }
        }
    }
    assert!(lit > 4000 && sampled > 4000, "{lit} directions, {sampled} samples");
}

#[test]
fn relief_that_leans_away_from_the_viewer_is_lit_by_its_own_normal() {
    // Without a coat: index 1
    let matte = mapped(&Material { base_color: [0.8; 3], ior: 1.0, roughness: 1.0, ..Material::default() });
    let (sin, cos) = 40.0_f32.to_radians().sin_cos();
    let (relief, wo) = (Vec3::new(-sin, 0.0, cos), Vec3::new(0.9, 0.0, 0.19_f32.sqrt()));
    let bent = crate::math::bend_above(relief, Vec3::Z, wo);
    assert!(bent.dot(relief) < 0.9, "it is bent by far");
    for side in [1.0, -1.0] {
        let mut bsdf = Bsdf::new(&matte, Vec3::ONE, bent * side, Vec3::Z * side, wo);
        bsdf.set_relief(relief * side);
        for wi in [Vec3::Z, relief, Vec3::new(-0.95, 0.0, 0.0975_f32.sqrt()), Vec3::new(0.95, 0.1, 0.08).normalize()] {
            // Lambert's law
            let expected = 0.8 / std::f32::consts::PI * wi.dot(relief).max(0.0);
            assert!((bsdf.eval(wi).0 - expected).length() < 1e-5, "{wi}: {} for {expected}", bsdf.eval(wi).0);
        }
        // A facet sees (1 + cos) / 2 of a sky by its cosine
        let samples = (0..4096).filter_map(|k| {
            let set = sobol_burley::sample_4d(k, 0, 23);
            bsdf.sample(set[0], Vec2::new(set[2], set[3]))
        });
        let albedo = samples.map(|sample| sample.weight.x).sum::<f32>() / 4096.0;
        assert!((albedo - 0.8 * 0.5 * (1.0 + cos)).abs() < 0.005, "{albedo}");
    }
}

#[test]
fn no_material_preset_has_an_albedo_above_one() {
    for preset in MaterialPreset::ALL {
        for cos in [1.0, 0.4, 0.05] {
            let albedo = furnace(&preset.material(), cos).max_element();
            assert!(albedo < 1.005, "{}: {albedo}", preset.label());
        }
    }
}

#[test]
fn sample_and_eval_agree() {
    let material = TracedMaterial::new(&MaterialPreset::GlossyPlastic.material());
    let bsdf = Bsdf::new(&material, Vec3::ONE, Vec3::Z, Vec3::Z, Vec3::new(0.6, 0.0, 0.8));
    for i in 0..256 {
        let set = sobol_burley::sample_4d(i, 0, 3);
        let Some(sample) = bsdf.sample(set[0], Vec2::new(set[2], set[3])) else { continue };
        let (value, pdf) = bsdf.eval(sample.direction);
        assert!((pdf - sample.pdf).abs() <= 1e-3 * pdf);
        assert!((value / pdf - sample.weight).abs().max_element() <= 1e-3 * sample.weight.max_element());
    }
}

#[test]
fn pdfs_integrate_to_one() {
    for preset in [MaterialPreset::GlossyPlastic, MaterialPreset::BrushedAluminium, MaterialPreset::SkinLight] {
        let material = TracedMaterial::new(&preset.material());
        let bsdf = Bsdf::new(&material, Vec3::ONE, Vec3::Z, Vec3::Z, Vec3::new(0.6, 0.0, 0.8));
        let n = 400;
        let mut sum = 0.0_f64;
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let direction = warp::uniform_cone(u, 1.0);
            sum += f64::from(bsdf.eval(direction).1) * 2.0 * std::f64::consts::PI;
        }
        let total = sum / f64::from(n * n);
        // Microfacet samples below the horizon are discarded: the integral may be slightly below 1, never above.
        assert!(total > 0.95 && total < 1.01, "{}: {total}", preset.label());
    }
}

/// Cells of directions about an axis. `1 - cos` is `k ((1 + 2/k)^s - 1)` for s in 0..1, which resolves both a narrow
/// lobe (`1 - cos` about `k`) and a wide one; the azimuth is uniform.
pub(super) struct DirectionCells {
    axis: Vec3,
    tangent: Vec3,
    bitangent: Vec3,
    k: f64,
}

impl DirectionCells {
    const RINGS: usize = 12;
    const TURNS: usize = 16;

    pub fn about(axis: Vec3, k: f64) -> Self {
        let (tangent, bitangent) = orthonormal_basis(axis);
        DirectionCells { axis, tangent, bitangent, k }
    }

    pub fn index(&self, direction: Vec3) -> usize {
        let drop = 0.5 * f64::from((direction - self.axis).length_squared());
        let s = (drop / self.k).ln_1p() / (2.0 / self.k).ln_1p();
        let turn = f64::from(direction.dot(self.bitangent).atan2(direction.dot(self.tangent)) / TAU);
        let turn = turn - turn.floor();
        let cell = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        cell(s, Self::RINGS) * Self::TURNS + cell(turn, Self::TURNS)
    }

    /// Integrates a density over each cell by the midpoint rule, with so many steps along each side of it.
    pub fn integrate(&self, fine: usize, pdf: impl Fn(Vec3) -> f64) -> Vec<f64> {
        let (rings, turns) = (Self::RINGS * fine, Self::TURNS * fine);
        let mut sums = vec![0.0; Self::RINGS * Self::TURNS];
        for i in 0..rings {
            let s = (i as f64 + 0.5) / rings as f64;
            let scale = (2.0 / self.k).ln_1p();
            let drop = self.k * (s * scale).exp_m1();
            let solid_angle = (drop + self.k) * scale / rings as f64 * std::f64::consts::TAU / turns as f64;
            let sin = (drop * (2.0 - drop)).max(0.0).sqrt() as f32;
            for j in 0..turns {
                let (y, x) = (TAU * (j as f32 + 0.5) / turns as f32).sin_cos();
                let side = self.tangent * x + self.bitangent * y;
                let direction = (self.axis * (1.0 - drop) as f32 + side * sin).normalize();
                sums[i / fine * Self::TURNS + j / fine] += pdf(direction) * solid_angle;
            }
        }
        sums
    }
}

pub(super) fn view(cos: f32) -> Vec3 {
    Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
}

#[test]
fn sampled_directions_follow_their_pdf_for_every_lobe_roughness_and_angle() {
    let plain = Material { base_color: [0.6, 0.4, 0.2], ..Material::default() };
    let mut cases = Vec::new();
    for roughness in [0.05, 0.2, 0.5, 1.0] {
        for cos in [1.0, 0.6, 0.15, 0.05] {
            cases.push((Material { roughness, ..plain.clone() }, cos));
            cases.push((Material { roughness, metallic: 1.0, ..plain.clone() }, cos));
            cases.push((Material { roughness, metallic: 0.5, transmission: 0.4, ..plain.clone() }, cos));
        }
    }
    cases.push((Material { roughness: 0.0, ..plain.clone() }, 0.7));
    cases.push((Material { roughness: 1.0, ior: 1.0, ..plain.clone() }, 0.3));
    let mut rng = TestRng::new(21);
    for (material, cos) in &cases {
        const SAMPLES: usize = 40_000;
        let material = TracedMaterial::new(material);
        let bsdf = Bsdf::new(&material, Vec3::ONE, Vec3::Z, Vec3::Z, view(*cos));
        // Towards grazing angles the lobe narrows by the cosine in one direction.
        let width = f64::from(material.alpha.max(1e-3) * cos);
        let cells = DirectionCells::about(Vec3::new(-view(*cos).x, 0.0, *cos), 2.0 * width * width);
        let expected = cells.integrate(40, |direction| f64::from(bsdf.eval(direction).1));
        let mut counts = vec![0.0; expected.len()];
        // Discarded and specular samples have no density and share one cell.
        let mut rest = 0.0;
        for _ in 0..SAMPLES {
            match bsdf.sample(rng.uniform(), rng.unit_square()) {
                Some(sample) if !sample.specular => counts[cells.index(sample.direction)] += 1.0,
                _ => rest += 1.0,
            }
        }
        let mut test = ChiSquare::default();
        let samples = SAMPLES as f64;
        counts.iter().zip(&expected).for_each(|(&c, &e)| test.add_bin(c, e * samples));
        test.add_bin(rest, (1.0 - expected.iter().sum::<f64>()).max(0.0) * samples + 1e-3);
        assert!(test.p_value() > sidak_level(cases.len()), "{material:?} under {cos}: p = {}", test.p_value());
    }
}

#[test]
fn glass_reflects_by_fresnels_equations_and_refracts_by_snells_law() {
    let glass =
        TracedMaterial::new(&Material { base_color: [1.0; 3], transmission: 1.0, ior: 1.52, ..Material::default() });
    let mut rng = TestRng::new(22);
    let angles = [0.0_f64, 20.0, 41.0, 42.0, 60.0, 80.0, 89.0];
    for (deg, outside) in angles.into_iter().flat_map(|deg| [(deg, true), (deg, false)]) {
        const SAMPLES: usize = 20_000;
        let side = if outside { 1.0 } else { -1.0 };
        let (sin, cos) = deg.to_radians().sin_cos();
        let wo = Vec3::new(sin as f32, 0.0, (cos * side) as f32);
        let bsdf = Bsdf::new(&glass, Vec3::ONE, Vec3::Z, Vec3::Z, wo);
        let eta = if outside { 1.52 } else { 1.0 / 1.52 };
        let sin_t = sin / eta;
        let reflectance = if sin_t >= 1.0 {
            1.0
        } else {
            let cos_t = (1.0 - sin_t * sin_t).sqrt();
            let p = (eta * cos - cos_t) / (eta * cos + cos_t);
            let s = (cos - eta * cos_t) / (cos + eta * cos_t);
            0.5 * (p * p + s * s)
        };
        let mut reflected = 0.0;
        for _ in 0..SAMPLES {
            let sample = bsdf.sample(rng.uniform(), rng.unit_square()).unwrap();
            assert!(sample.specular);
            let d = sample.direction;
            if d.z * side as f32 > 0.0 {
                reflected += 1.0;
                assert!((d - Vec3::new(-wo.x, 0.0, wo.z)).length() < 1e-6, "{deg}: reflected to {d}");
            } else {
                // Near the critical angle, single precision keeps half the digits of the cosine.
                assert!((f64::from(d.x) + sin_t).abs() < 1e-5 && d.y == 0.0, "{deg}: refracted to {d}");
                assert!((f64::from(d.z) * side + (1.0 - sin_t * sin_t).sqrt()).abs() < 1e-3, "{deg}: refracted to {d}");
            }
        }
        let mut test = ChiSquare::default();
        test.add_bin(reflected, reflectance * SAMPLES as f64);
        test.add_bin(SAMPLES as f64 - reflected, (1.0 - reflectance) * SAMPLES as f64);
        let certain = reflectance >= 1.0 && reflected as usize == SAMPLES;
        assert!(
            certain || test.p_value() > sidak_level(2 * angles.len()),
            "{deg} outside {outside}: p = {}",
            test.p_value()
        );
    }
}

#[test]
fn clear_glass_did_not_know_its_base_color_and_tints_what_it_transmits() {
    let base = Vec3::new(0.81, 0.25, 0.0);
    let tinted = Material { base_color: base.into(), transmission: 1.0, ior: 1.5, ..Material::default() };
    let material = TracedMaterial::new(&tinted);
    let wo = view(0.8);
    let texture = Vec3::new(1.0, 0.64, 1.0);
    // Both faces of a body together, or a pane alone, have the base color times its texture.
    let face = Vec3::new(0.9, 0.4, 0.0);
    assert!(
        (MaterialPoint::new(&material, texture.into()).transmission_color(false) - face).abs().max_element() < 1e-6
    );
    let pane = MaterialPoint::new(&material, texture.into()).transmission_color(true);
    assert!((pane - base * texture).abs().max_element() < 1e-6);
    for (boundary, expected) in [
        (Boundary::Interface(DielectricInterface { eta: 1.5, starts_inside: false }), face / 2.25),
        (Boundary::Interface(DielectricInterface { eta: 1.0 / 1.5, starts_inside: false }), face * 2.25),
        (Boundary::ThinPane, base * texture),
    ] {
        let mut bsdf = Bsdf::new(&material, texture, Vec3::Z, Vec3::Z, wo);
        bsdf.set_boundary(boundary, Polarisation::NONE);
        let (reflected, transmitted) = (bsdf.sample(0.0, Vec2::ZERO).unwrap(), bsdf.sample(0.999, Vec2::ZERO).unwrap());
        assert!(!reflected.is_transmission && transmitted.is_transmission);
        assert_eq!(reflected.weight, Vec3::ONE, "reflections have no colour");
        assert!((transmitted.weight - expected).abs().max_element() < 1e-5, "{boundary:?}: {}", transmitted.weight);
    }
}

#[test]
fn no_material_has_an_albedo_above_one_at_any_roughness_and_angle() {
    // The tolerance is the standard error of independent samples and 0.05 % for the albedo tables: they are good to
    // 1e-4, and the metal is divided by albedos down to 0.3. Only white materials are also held to 1 from below.
    let roughness = [0.0, 1e-4, 0.01, 0.032, 0.1, 0.3, 0.5, 0.7, 1.0];
    let cosines = [1.0, 0.6, 0.2, 0.05, 0.01];
    let mut rng = TestRng::new(23);
    let tests = roughness.len() * cosines.len() * 6;
    for (roughness, cos) in roughness.into_iter().flat_map(|r| cosines.map(|c| (r, c))) {
        let white = Material { base_color: [1.0; 3], roughness, ..Material::default() };
        for (material, is_white) in [
            (white.clone(), true),
            (Material { metallic: 1.0, ..white.clone() }, true),
            (Material { metallic: 0.5, ..white.clone() }, true),
            (Material { transmission: 1.0, ..white.clone() }, true),
            (Material { transmission: 0.5, ior: 2.4, ..white.clone() }, true),
            (Material { metallic: 1.0, base_color: [0.9, 0.5, 0.1], ..white.clone() }, false),
        ] {
            let material = TracedMaterial::new(&material);
            let bsdf = Bsdf::new(&material, Vec3::ONE, Vec3::Z, Vec3::Z, view(cos));
            let albedo = SampleMean::of((0..8000).map(|_| {
                let sample = bsdf.sample(rng.uniform(), rng.unit_square());
                sample.map_or(0.0, |s| f64::from(s.weight.x / s.eta_scale))
            }));
            let error = crate::statistics::critical_z(tests) * albedo.standard_error + 5e-4;
            assert!(albedo.mean < 1.0 + error, "{material:?} under {cos} gains energy: {albedo:?}");
            assert!(!is_white || albedo.mean > 1.0 - error, "{material:?} under {cos} loses energy: {albedo:?}");
        }
    }
}

#[test]
fn a_surface_with_the_index_of_air_has_no_microfacet_lobe() {
    let matt = TracedMaterial::new(&Material { ior: 1.0, roughness: 1.0, ..Material::default() });
    assert!(!matt.has_microfacets, "coat albedo {} by rounding", matt.tables.coat.mean);
    // A faint coat is kept: an index of 1.1 reflects 0.2 % at normal incidence.
    assert!(TracedMaterial::new(&Material { ior: 1.1, roughness: 1.0, ..Material::default() }).has_microfacets);
}
