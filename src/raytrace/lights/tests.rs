//! Statistical tests of light sampling: densities, flux, the light sampler and the emitter BVH.

use super::traced_light::LightSource;
use super::*;
use crate::math::{Ray, look_at, orthonormal_basis};
use crate::photo::PhotometricLight;
use crate::raytrace::bvh::TraversalStack;
use crate::scene::{Camera, Emitter, IntensityTable, Light, Output};
use crate::statistics::{ChiSquare, SampleMean, TestRng, sidak_level};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// Returns a light at the origin that emits along -Z.
fn traced(emitter: Emitter, output: Output) -> TracedLight {
    let light = Light::new(emitter, output);
    let light = PhotometricLight::in_frame(&light, None, look_at(Vec3::ZERO, Vec3::NEG_Z, 0.0), &Camera::default());
    TracedLight::new(&light, Vec3::ZERO).unwrap()
}

/// Points in front of a panel of 0.6 x 0.9 m: on the axis, off axis, grazing, close to its centre, edge and corner, far
/// away.
const POINTS: [Vec3; 10] = [
    Vec3::new(0.0, 0.0, -1.0),
    Vec3::new(1.2, 0.3, -0.7),
    Vec3::new(2.0, -1.0, -0.05),
    Vec3::new(0.45, 0.1, -0.02),
    Vec3::new(0.05, -0.1, -0.01),
    Vec3::new(0.3, 0.45, -0.1),
    Vec3::new(0.31, 0.0, -0.003),
    Vec3::new(3.0, 4.0, -12.0),
    Vec3::new(0.0, 8.0, -0.4),
    Vec3::new(-20.0, 3.0, -5.0),
];

const CELLS: usize = 10;

/// Returns the p-value of a chi-square test of a flat emitter's sampling on a grid of its surface.
/// `surface_point(u, v)` maps the unit square to the surface with a constant area density, `cell` inverts it.
fn flat_sampling_p_value(
    light: &TracedLight,
    from: Vec3,
    area: f32,
    surface_point: impl Fn(f64, f64) -> Vec3,
    cell: impl Fn(Vec3) -> (f32, f32),
    rng: &mut TestRng,
) -> f64 {
    const SAMPLES: usize = 40_000;
    // Integrate the density over a cell on a finer grid: from near by it varies over a cell by orders of magnitude.
    // Grid points are one or two millimetres apart for points that are some millimetres away.
    let fine = if from.z.abs() < 0.01 { 100 } else { 40 };
    let mut counts = vec![0.0; CELLS * CELLS];
    let mut drawn = 0.0;
    for _ in 0..SAMPLES {
        let Some(sample) = light.sample(from, rng.unit_square()) else { continue };
        let (u, v) = cell(from + sample.direction * sample.distance);
        let index = |x: f32| ((x * CELLS as f32) as usize).min(CELLS - 1);
        counts[index(v) * CELLS + index(u)] += 1.0;
        drawn += 1.0;
    }
    let mut expected = vec![0.0_f64; CELLS * CELLS];
    let steps = CELLS * fine;
    for i in 0..steps {
        for j in 0..steps {
            let target = surface_point((i as f64 + 0.5) / steps as f64, (j as f64 + 0.5) / steps as f64);
            let to = target - from;
            let (distance, direction) = (to.length(), to.normalize());
            let cos = f64::from(direction.z.abs());
            let solid_angle = f64::from(area) / (steps * steps) as f64 * cos / f64::from(distance * distance);
            let pdf = f64::from(light.pdf(from, direction, distance));
            expected[j / fine * CELLS + i / fine] += pdf * solid_angle;
        }
    }
    // The density includes rejected samples. The midpoint rule integrates it to better than half a percent.
    let (total, accepted): (f64, f64) = (expected.iter().sum(), drawn / SAMPLES as f64);
    let error = (accepted * (1.0 - accepted) / SAMPLES as f64).sqrt();
    assert!((total - accepted).abs() < 5e-3 + 4.0 * error, "density {total}, accepted samples {accepted} from {from}");
    let mut test = ChiSquare::default();
    counts.iter().zip(&expected).for_each(|(&c, &e)| test.add_bin(c, e / total * drawn));
    test.p_value()
}

#[test]
fn directions_to_rectangles_follow_their_density() {
    let (width_m, height_m) = (0.6, 0.9);
    let light = traced(Emitter::RectPanel { width_m, height_m }, Output::Lumens(1000.0));
    let mut rng = TestRng::new(11);
    for from in POINTS {
        let surface_point = |u: f64, v: f64| Vec3::new((u as f32 - 0.5) * width_m, (v as f32 - 0.5) * height_m, 0.0);
        let cell = |p: Vec3| (p.x / width_m + 0.5, p.y / height_m + 0.5);
        let p = flat_sampling_p_value(&light, from, width_m * height_m, surface_point, cell, &mut rng);
        assert!(p > sidak_level(POINTS.len()), "from {from}: p = {p}");
    }
}

#[test]
fn directions_to_discs_follow_their_density() {
    let radius = 0.6_f32;
    let light = traced(Emitter::RoundPanel { diameter_m: 2.0 * radius }, Output::Lumens(1000.0));
    let mut rng = TestRng::new(12);
    for from in POINTS {
        // Equal areas: radius by the root, angle.
        let surface_point = |u: f64, v: f64| {
            let (r, angle) = (f64::from(radius) * u.sqrt(), std::f64::consts::TAU * v);
            Vec3::new((r * angle.cos()) as f32, (r * angle.sin()) as f32, 0.0)
        };
        let cell = |p: Vec3| {
            let turn = p.y.atan2(p.x) / std::f32::consts::TAU;
            ((p.x * p.x + p.y * p.y) / (radius * radius), turn - turn.floor())
        };
        let p = flat_sampling_p_value(&light, from, light_area(&light), surface_point, cell, &mut rng);
        assert!(p > sidak_level(POINTS.len()), "from {from}: p = {p}");
    }
}

fn light_area(light: &TracedLight) -> f32 {
    match light.source {
        LightSource::Rect { rect, .. } => rect.area(),
        LightSource::Disc { disc, .. } => disc.area(),
        _ => 0.0,
    }
}

#[test]
fn directions_to_spheres_and_suns_are_uniform_in_their_cones() {
    let mut rng = TestRng::new(13);
    let sphere = |radius_m| traced(Emitter::Sphere { radius_m }, Output::Lumens(1000.0));
    let sun = |angular_diameter_deg| traced(Emitter::Sun { angular_diameter_deg }, Output::Lux(1000.0));
    let far = Vec3::new(0.4, -0.3, 2.0);
    let lights = [
        (sphere(0.5), far),
        (sphere(1e-3), far),
        (sphere(1.0), Vec3::new(0.0, 1.0001, 0.0)),
        (sphere(1e-5), Vec3::X * 100.0),
        (sun(0.53), far),
        (sun(90.0), far),
        (sun(0.01), far),
    ];
    for (light, from) in &lights {
        const SAMPLES: usize = 40_000;
        let axis = match light.source {
            LightSource::Sun(sun) => sun.towards,
            _ => -from.normalize(),
        };
        let first = light.sample(*from, Vec2::splat(0.5)).unwrap();
        let pdf = light.pdf(*from, first.direction, first.distance);
        // Uniform: the density is one over the cone's solid angle, 2 pi (1 - cos).
        let one_minus_cos = 1.0 / (std::f32::consts::TAU * pdf);
        let (tangent, bitangent) = orthonormal_basis(axis);
        let mut counts = vec![0.0; CELLS * CELLS];
        for _ in 0..SAMPLES {
            let sample = light.sample(*from, rng.unit_square()).unwrap();
            assert_eq!(sample.pdf, Some(light.pdf(*from, sample.direction, sample.distance)));
            let drop = 0.5 * (sample.direction - axis).length_squared() / one_minus_cos;
            let turn = sample.direction.dot(bitangent).atan2(sample.direction.dot(tangent)) / std::f32::consts::TAU;
            let index = |x: f32| ((x * CELLS as f32) as usize).min(CELLS - 1);
            counts[index(drop) * CELLS + index(turn - turn.floor())] += 1.0;
        }
        let mut test = ChiSquare::default();
        counts.iter().for_each(|&c| test.add_bin(c, SAMPLES as f64 / (CELLS * CELLS) as f64));
        assert!(test.p_value() > sidak_level(lights.len()), "{light:?}: p = {}", test.p_value());
    }
}

#[test]
fn a_sphere_around_any_emitter_receives_its_whole_flux() {
    // Each emits 1000 lm. The illuminance is estimated at random points of a sphere of 1.5 m, with one light sample
    // each. The tolerance is the sampling error; single precision adds 1e-5.
    let emitters = [
        Emitter::Point,
        Emitter::Sphere { radius_m: 0.01 },
        Emitter::Sphere { radius_m: 1.0 },
        Emitter::RectPanel { width_m: 0.6, height_m: 0.9 },
        Emitter::RectPanel { width_m: 2.0, height_m: 0.05 },
        Emitter::RoundPanel { diameter_m: 1.2 },
        Emitter::RoundPanel { diameter_m: 2.9 },
        Emitter::Spot { inner_deg: 30.0, outer_deg: 30.0 },
        Emitter::Spot { inner_deg: 20.0, outer_deg: 60.0 },
        Emitter::Spot { inner_deg: 0.0, outer_deg: 180.0 },
        Emitter::Spot { inner_deg: 180.0, outer_deg: 180.0 },
    ];
    let mut rng = TestRng::new(14);
    for emitter in emitters {
        let light = traced(emitter, Output::Lumens(1000.0));
        const RADIUS: f32 = 1.5;
        let area = f64::from(4.0 * PI * RADIUS * RADIUS);
        let flux = SampleMean::of((0..200_000).map(|_| {
            let outwards = rng.direction();
            let sample = light.sample(outwards * RADIUS, rng.unit_square());
            // The receiver faces the centre: every emitter in the sphere is in front of it.
            sample.map_or(0.0, |s| f64::from(s.value * s.direction.dot(-outwards).max(0.0)) * area)
        }));
        assert!(flux.agrees_with(1000.0, 1e-5, emitters.len()), "{emitter:?}: {flux:?} lm");
    }
}

#[test]
fn light_sampling_agrees_with_the_intersection_of_rays() {
    let mut rng = TestRng::new(15);
    for emitter in [
        Emitter::Sphere { radius_m: 0.2 },
        Emitter::RectPanel { width_m: 0.6, height_m: 0.9 },
        Emitter::RoundPanel { diameter_m: 1.2 },
    ] {
        let light = traced(emitter, Output::Lumens(1000.0));
        for from in POINTS {
            let mut hits = 0;
            for _ in 0..200 {
                let Some(sample) = light.sample(from, rng.unit_square()) else { continue };
                let pdf = sample.pdf.unwrap();
                // At the rim, rounding may make the ray miss.
                let Some(hit) = light.intersect(from, sample.direction) else { continue };
                hits += 1;
                assert!((hit.luminance / pdf / sample.value - 1.0).abs() < 1e-4, "{emitter:?} from {from}");
                assert!((hit.distance / sample.distance - 1.0).abs() < 2e-3, "{emitter:?} from {from}");
                let again = light.pdf(from, sample.direction, hit.distance);
                // The distance to a plane at a grazing angle keeps few digits.
                assert!((again / pdf - 1.0).abs() < 2e-2, "{emitter:?} from {from}: {again} for {pdf}");
            }
            assert!(hits > 150 || (hits == 0 && from.length() < 0.2), "{emitter:?} from {from}: {hits} of 200 hit");
        }
    }
}

/// Returns a measured distribution with a narrow beam to one side.
fn lopsided_table() -> Arc<IntensityTable> {
    let candela = [[50.0, 900.0, 20.0, 0.0], [50.0, 30.0, 10.0, 0.0], [50.0, 900.0, 20.0, 0.0]].concat();
    Arc::new(IntensityTable::new(vec![0.0, 20.0, 40.0, 120.0], vec![0.0, 180.0, 360.0], candela).unwrap())
}

/// Returns lights of all kinds around the origin.
pub(super) fn random_lights(count: usize, rng: &mut TestRng) -> Vec<TracedLight> {
    let emitters = [
        Emitter::Point,
        Emitter::Sphere { radius_m: 0.3 },
        Emitter::Spot { inner_deg: 20.0, outer_deg: 70.0 },
        Emitter::Spot { inner_deg: 50.0, outer_deg: 50.0 },
        Emitter::RectPanel { width_m: 0.6, height_m: 0.9 },
        Emitter::RoundPanel { diameter_m: 1.5 },
        Emitter::Sun { angular_diameter_deg: 10.0 },
        Emitter::Surround,
    ];
    let light = |i: usize| {
        let emitter = emitters[i % emitters.len()];
        let output = if emitter.is_infinite() { Output::Lux(100.0) } else { Output::Lumens(1000.0) };
        let mut light = Light::new(emitter, output);
        light.modifier.grid_deg = (i % 5 == 4).then_some(60.0);
        let position = rng.direction() * rng.range(0.5, 4.0);
        let frame = look_at(position, position + rng.direction(), 0.0);
        let camera = Camera { shutter_s: rng.range(0.01, 1.0), ..Camera::default() };
        let table = (i % 7 == 3).then(lopsided_table);
        TracedLight::new(&PhotometricLight::in_frame(&light, table, frame, &camera), Vec3::ZERO).unwrap()
    };
    (0..count).map(light).collect()
}

#[test]
fn lanes_sample_lights_as_they_are_sampled_one_by_one() {
    let mut rng = TestRng::new(19);
    let (mut compared, mut dark) = (0, 0);
    for _ in 0..40 {
        // Seven of eight kinds are sampled: rectangles with and without a grid, and all others
        let mut lights = random_lights(8, &mut rng);
        lights[1] = traced(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, Output::Lumens(1000.0));
        let lanes = LightLanes::new(&lights).unwrap();
        assert_eq!(lanes.lights(), [0, 1, 2, 3, 4, 5, 6]);
        for from in POINTS.into_iter().chain([Vec3::ZERO, Vec3::X]) {
            let u = [(); 2].map(|()| std::array::from_fn(|_| rng.uniform()));
            let samples = lanes.sample(&lights, from, &u);
            for (lane, light) in lanes.lights().iter().enumerate() {
                let one = lights[*light as usize].sample(from, Vec2::new(u[0][lane], u[1][lane]));
                let ours = samples.lane(lane).filter(|sample| sample.value != 0.0);
                let one = one.filter(|sample| sample.value != 0.0);
                assert_eq!(format!("{ours:?}"), format!("{one:?}"), "light {light} from {from}");
                if ours.is_some() { compared += 1 } else { dark += 1 }
            }
        }
    }
    assert!(compared > 1000 && dark > 200, "{compared} samples, {dark} without light");
    // One light, or more than lanes, are sampled otherwise
    assert!(LightLanes::new(&random_lights(1, &mut rng)).is_none());
    assert!(LightLanes::new(&random_lights(12, &mut rng)).is_none());
}

#[test]
fn the_light_sampler_samples_by_its_pmf() {
    let mut rng = TestRng::new(16);
    for count in [1, 3, 8, 40, 300, 5000] {
        let lights = random_lights(count, &mut rng);
        let light_sampler = LightSampler::new(&lights);
        for _ in 0..4 {
            let (point, normal) = (rng.direction() * rng.range(0.01, 4.0), rng.direction());
            const GRID: usize = 20_000;
            let mut counts = vec![0.0_f64; count];
            let importances = light_sampler.importances(&lights, point, normal).unwrap();
            for i in 0..GRID {
                let u = (i as f32 + 0.5) / GRID as f32;
                let Some((light, pmf)) = importances.sample(&lights, u) else { continue };
                let evaluated = light_sampler.pmf(&lights, light, point, normal);
                assert!((pmf / evaluated - 1.0).abs() < 1e-5, "{pmf} {evaluated}");
                counts[light as usize] += 1.0 / GRID as f64;
            }
            let pmfs = (0..count as u32).map(|light| light_sampler.pmf(&lights, light, point, normal));
            for (light, (pmf, frequency)) in pmfs.zip(&counts).enumerate() {
                // A uniform grid hits each light's part of the unit interval to within one point.
                assert!(
                    (f64::from(pmf) - frequency).abs() < 1.5 / GRID as f64,
                    "{light} of {count}: pmf {pmf}, frequency {frequency}"
                );
            }
            let total: f64 = counts.iter().sum();
            // The sum is smaller than 1 where the members of a sampled cluster have no importance.
            assert!(total < 1.0 + 1e-9, "{total}");
        }
    }
}

#[test]
fn one_sampled_light_estimates_the_illuminance_of_all() {
    // The illuminance at a point by one sampled light, against the sum over all lights.
    let mut rng = TestRng::new(17);
    const COUNTS: [usize; 4] = [2, 12, 100, 1000];
    for count in COUNTS {
        let lights = random_lights(count, &mut rng);
        let light_sampler = LightSampler::new(&lights);
        let (point, normal) = (rng.direction() * 0.5, rng.direction());
        let illuminance = |light: &TracedLight, u: Vec2| {
            light.sample(point, u).map_or(0.0, |s| f64::from(s.value * s.direction.dot(normal).max(0.0)))
        };
        let truth: f64 = lights
            .iter()
            .map(|light| (0..4096).map(|_| illuminance(light, rng.unit_square())).sum::<f64>() / 4096.0)
            .sum();
        let importances = light_sampler.importances(&lights, point, normal).unwrap();
        let estimate = SampleMean::of((0..60_000).map(|_| {
            let sampled = importances.sample(&lights, rng.uniform());
            sampled.map_or(0.0, |(light, pmf)| illuminance(&lights[light as usize], rng.unit_square()) / f64::from(pmf))
        }));
        // The sum itself has an error of some 1e-3.
        assert!(estimate.agrees_with(truth, 3e-3, COUNTS.len()), "{count} lights: {estimate:?} for {truth}");
    }
}

#[test]
fn the_light_bvh_of_ten_thousand_lights_is_three_nodes_deep() {
    let mut rng = TestRng::new(18);
    for (count, max_depth) in [(60, 1), (1000, 2), (10_000, 3)] {
        let light_sampler = LightSampler::new(&random_lights(count, &mut rng));
        assert!(light_sampler.depth() <= max_depth, "{count} lights: {} deep", light_sampler.depth());
    }
}

#[test]
fn the_emitter_bvh_finds_the_hits_of_brute_force() {
    let mut rng = TestRng::new(19);
    let lights = random_lights(200, &mut rng);
    let emitter_bvh = EmitterBvh::new(&lights);
    let mut stack = TraversalStack::default();
    let mut hits = 0;
    for i in 0..20_000 {
        let origin = rng.direction() * rng.range(0.0, 5.0);
        let t_max = if i % 2 == 0 { f32::INFINITY } else { rng.range(0.1, 4.0) };
        let ray = Ray { origin, direction: rng.direction(), t_max };
        let mut found = Vec::new();
        // The caller compares with t_max.
        emitter_bvh.for_each_hit(&lights, &ray, &mut stack, |light, hit| {
            if hit.distance <= t_max {
                found.push(light);
            }
        });
        found.sort_unstable();
        let truth = |light: &u32| {
            let light = &lights[*light as usize];
            light.intersect(origin, ray.direction).is_some_and(|hit| hit.distance <= t_max)
        };
        let truth: Vec<u32> = (0..lights.len() as u32).filter(truth).collect();
        assert_eq!(found, truth, "{ray:?}");
        hits += truth.len();
    }
    assert!(hits > 10_000, "only {hits} hits: too few for the test");
}

#[test]
fn a_light_that_contributes_has_a_positive_pmf() {
    // Importance sampling is unbiased only if every light that contributes can be sampled.
    let mut rng = TestRng::new(16);
    for emitter in [
        Emitter::Point,
        Emitter::Sphere { radius_m: 0.7 },
        Emitter::Spot { inner_deg: 20.0, outer_deg: 70.0 },
        Emitter::RectPanel { width_m: 2.0, height_m: 3.0 },
        Emitter::RoundPanel { diameter_m: 3.0 },
    ] {
        let light = traced(emitter, Output::Lumens(1000.0));
        let light_sampler = LightSampler::new(std::slice::from_ref(&light));
        for _ in 0..20_000 {
            let from = rng.direction() * rng.range(0.01, 4.0);
            let normal = rng.direction();
            let Some(sample) = light.sample(from, rng.unit_square()) else { continue };
            if sample.direction.dot(normal) > 1e-4 && sample.value > 0.0 {
                let pmf = light_sampler.pmf(std::slice::from_ref(&light), 0, from, normal);
                assert!(pmf > 0.0, "{emitter:?} from {from}, normal {normal}");
            }
        }
    }
}

#[test]
fn a_light_that_contributes_has_a_positive_pmf_in_any_cluster() {
    // The bounds of a cluster include members that are off centre or face another way.
    let mut rng = TestRng::new(20);
    let lights = random_lights(600, &mut rng);
    let light_sampler = LightSampler::new(&lights);
    let mut contributing = 0;
    for _ in 0..300 {
        let (from, normal) = (rng.direction() * rng.range(0.01, 6.0), rng.direction());
        for (light, index) in lights.iter().zip(0..).step_by(7) {
            let Some(sample) = light.sample(from, rng.unit_square()) else { continue };
            if sample.direction.dot(normal) > 1e-4 && sample.value > 0.0 {
                contributing += 1;
                assert!(
                    light_sampler.pmf(&lights, index, from, normal) > 0.0,
                    "{light:?} from {from}, normal {normal}"
                );
            }
        }
    }
    assert!(contributing > 5000, "only {contributing}");
}
