//! Samplers of lights against their densities, and every emitter's flux over a sphere around it.

use super::*;
use crate::math::Ray;
use crate::math::look_at;
use crate::math::statistics::{ChiSquare, Estimate, Numbers, share};
use crate::raytrace::bvh::TraversalStack;
use crate::scene::{Camera, Emitter, Light, Output};

/// A light at the origin that shines along -Z.
fn traced(emitter: Emitter, output: Output) -> TracedLight {
    let light = Light::new(emitter, output);
    let light = PhotometricLight::in_frame(&light, look_at(Vec3::ZERO, Vec3::NEG_Z, 0.0), &Camera::default());
    TracedLight::new(&light, Vec3::ZERO).unwrap()
}

/// Places before a panel of 0.6 x 0.9 m: on the axis, aside, grazing, close to its middle, edge and corner, far away.
const PLACES: [Vec3; 10] = [
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

/// Chi-square of a flat emitter's sampler on a grid of its surface. `place(u, v)` maps the grid's unit square to the
/// surface with a constant area density, `cell` back.
fn flat_sampler_p(
    light: &TracedLight,
    from: Vec3,
    area: f32,
    place: impl Fn(f64, f64) -> Vec3,
    cell: impl Fn(Vec3) -> (f32, f32),
    numbers: &mut Numbers,
) -> f64 {
    const SAMPLES: usize = 40_000;
    // The density over a cell, on a finer grid: near places make it vary over a cell by orders of magnitude. A point
    // every millimetre or two for places that are some millimetres away.
    let fine = if from.z.abs() < 0.01 { 100 } else { 40 };
    let mut counts = vec![0.0; CELLS * CELLS];
    let mut drawn = 0.0;
    for _ in 0..SAMPLES {
        let Some(sample) = light.sample(from, numbers.square()) else { continue };
        let (u, v) = cell(from + sample.direction * sample.distance);
        let index = |x: f32| ((x * CELLS as f32) as usize).min(CELLS - 1);
        counts[index(v) * CELLS + index(u)] += 1.0;
        drawn += 1.0;
    }
    let mut expected = vec![0.0_f64; CELLS * CELLS];
    let steps = CELLS * fine;
    for i in 0..steps {
        for j in 0..steps {
            let target = place((i as f64 + 0.5) / steps as f64, (j as f64 + 0.5) / steps as f64);
            let to = target - from;
            let (distance, direction) = (to.length(), to.normalize());
            let cos = f64::from(direction.z.abs());
            let solid_angle = f64::from(area) / (steps * steps) as f64 * cos / f64::from(distance * distance);
            let pdf = f64::from(light.pdf(from, direction, distance));
            expected[j / fine * CELLS + i / fine] += pdf * solid_angle;
        }
    }
    // The density is that of all samples, those beside the emitter too, which are lost. Midpoints integrate
    // it to better than half a percent.
    let (total, share): (f64, f64) = (expected.iter().sum(), drawn / SAMPLES as f64);
    let lost = (share * (1.0 - share) / SAMPLES as f64).sqrt();
    assert!((total - share).abs() < 5e-3 + 4.0 * lost, "density {total}, samples {share} seen from {from}");
    let mut test = ChiSquare::default();
    counts.iter().zip(&expected).for_each(|(&c, &e)| test.cell(c, e / total * drawn));
    test.p_value()
}

#[test]
fn directions_to_rectangles_follow_their_density() {
    let (width_m, height_m) = (0.6, 0.9);
    let light = traced(Emitter::RectPanel { width_m, height_m }, Output::Lumens(1000.0));
    let mut numbers = Numbers::new(11);
    for from in PLACES {
        let place = |u: f64, v: f64| Vec3::new((u as f32 - 0.5) * width_m, (v as f32 - 0.5) * height_m, 0.0);
        let cell = |p: Vec3| (p.x / width_m + 0.5, p.y / height_m + 0.5);
        let p = flat_sampler_p(&light, from, width_m * height_m, place, cell, &mut numbers);
        assert!(p > share(PLACES.len()), "from {from}: p = {p}");
    }
}

#[test]
fn directions_to_discs_follow_their_density() {
    let radius = 0.6_f32;
    let light = traced(Emitter::RoundPanel { diameter_m: 2.0 * radius }, Output::Lumens(1000.0));
    let mut numbers = Numbers::new(12);
    for from in PLACES {
        // Equal areas: radius by the root, angle.
        let place = |u: f64, v: f64| {
            let (r, angle) = (f64::from(radius) * u.sqrt(), std::f64::consts::TAU * v);
            Vec3::new((r * angle.cos()) as f32, (r * angle.sin()) as f32, 0.0)
        };
        let cell = |p: Vec3| {
            let turn = p.y.atan2(p.x) / std::f32::consts::TAU;
            ((p.x * p.x + p.y * p.y) / (radius * radius), turn - turn.floor())
        };
        let p = flat_sampler_p(&light, from, light_area(&light), place, cell, &mut numbers);
        assert!(p > share(PLACES.len()), "from {from}: p = {p}");
    }
}

fn light_area(light: &TracedLight) -> f32 {
    match light.source {
        Source::Rect { rect, .. } => rect.area(),
        Source::Disc { disc, .. } => disc.area(),
        _ => 0.0,
    }
}

#[test]
fn directions_to_balls_and_suns_fill_their_cones_evenly() {
    let mut numbers = Numbers::new(13);
    let ball = |radius_m| traced(Emitter::Sphere { radius_m }, Output::Lumens(1000.0));
    let sun = |angular_diameter_deg| traced(Emitter::Sun { angular_diameter_deg }, Output::Lux(1000.0));
    let far = Vec3::new(0.4, -0.3, 2.0);
    let lights = [
        (ball(0.5), far),
        (ball(1e-3), far),
        (ball(1.0), Vec3::new(0.0, 1.0001, 0.0)),
        (ball(1e-5), Vec3::X * 100.0),
        (sun(0.53), far),
        (sun(90.0), far),
        (sun(0.01), far),
    ];
    for (light, from) in &lights {
        const SAMPLES: usize = 40_000;
        let axis = match light.source {
            Source::Sun { towards, .. } => towards,
            _ => -from.normalize(),
        };
        let first = light.sample(*from, Vec2::splat(0.5)).unwrap();
        let pdf = light.pdf(*from, first.direction, first.distance);
        // Uniform: the density is one over the cone's solid angle, 2 pi (1 - cos).
        let one_minus_cos = 1.0 / (std::f32::consts::TAU * pdf);
        let (tangent, bitangent) = orthonormal_basis(axis);
        let mut counts = vec![0.0; CELLS * CELLS];
        for _ in 0..SAMPLES {
            let sample = light.sample(*from, numbers.square()).unwrap();
            assert_eq!(sample.pdf, Some(light.pdf(*from, sample.direction, sample.distance)));
            let drop = 0.5 * (sample.direction - axis).length_squared() / one_minus_cos;
            let turn = sample.direction.dot(bitangent).atan2(sample.direction.dot(tangent)) / std::f32::consts::TAU;
            let index = |x: f32| ((x * CELLS as f32) as usize).min(CELLS - 1);
            counts[index(drop) * CELLS + index(turn - turn.floor())] += 1.0;
        }
        let mut test = ChiSquare::default();
        counts.iter().for_each(|&c| test.cell(c, SAMPLES as f64 / (CELLS * CELLS) as f64));
        assert!(test.p_value() > share(lights.len()), "{light:?}: p = {}", test.p_value());
    }
}

#[test]
fn a_sphere_around_any_emitter_receives_its_whole_flux() {
    // 1000 lm in each; the illuminance normal to the sphere, at random places of a sphere of 1.5 m, with one light
    // sample each. The tolerance is the sampling error; single precision adds 1e-5.
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
    let mut numbers = Numbers::new(14);
    for emitter in emitters {
        let light = traced(emitter, Output::Lumens(1000.0));
        const RADIUS: f32 = 1.5;
        let area = f64::from(4.0 * PI * RADIUS * RADIUS);
        let flux = Estimate::of((0..200_000).map(|_| {
            let outwards = numbers.direction();
            let sample = light.sample(outwards * RADIUS, numbers.square());
            // Inside the sphere everything is before the receiver, which looks to the centre.
            sample.map_or(0.0, |s| f64::from(s.value * s.direction.dot(-outwards).max(0.0)) * area)
        }));
        assert!(flux.agrees(1000.0, 1e-5, emitters.len()), "{emitter:?}: {flux:?} lm");
    }
}

#[test]
fn the_chosen_direction_meets_what_a_ray_sees() {
    // Light sampling and rays that happen to meet the emitter must speak of the same luminance and density.
    let mut numbers = Numbers::new(15);
    for emitter in [
        Emitter::Sphere { radius_m: 0.2 },
        Emitter::RectPanel { width_m: 0.6, height_m: 0.9 },
        Emitter::RoundPanel { diameter_m: 1.2 },
    ] {
        let light = traced(emitter, Output::Lumens(1000.0));
        for from in PLACES {
            let mut met = 0;
            for _ in 0..200 {
                let Some(sample) = light.sample(from, numbers.square()) else { continue };
                let pdf = sample.pdf.unwrap();
                // At the very rim rounding may miss it.
                let Some(seen) = light.intersect(from, sample.direction) else { continue };
                met += 1;
                assert!((seen.luminance / pdf / sample.value - 1.0).abs() < 1e-4, "{emitter:?} from {from}");
                assert!((seen.distance / sample.distance - 1.0).abs() < 2e-3, "{emitter:?} from {from}");
                let again = light.pdf(from, sample.direction, seen.distance);
                // The distance to a plane met at a grazing angle keeps few digits.
                assert!((again / pdf - 1.0).abs() < 2e-2, "{emitter:?} from {from}: {again} for {pdf}");
            }
            assert!(met > 150 || (met == 0 && from.length() < 0.2), "{emitter:?} from {from}: {met} of 200 met");
        }
    }
}

/// Lights of all kinds about the origin.
pub(super) fn crowd(count: usize, numbers: &mut Numbers) -> Vec<TracedLight> {
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
        let position = numbers.direction() * numbers.between(0.5, 4.0);
        let frame = look_at(position, position + numbers.direction(), 0.0);
        let camera = Camera { shutter_s: numbers.between(0.01, 1.0), ..Camera::default() };
        TracedLight::new(&PhotometricLight::in_frame(&light, frame, &camera), Vec3::ZERO).unwrap()
    };
    (0..count).map(light).collect()
}

#[test]
fn lights_are_chosen_as_often_as_they_say() {
    let mut numbers = Numbers::new(16);
    for count in [1, 3, 8, 40, 300, 5000] {
        let lights = crowd(count, &mut numbers);
        let light_sampler = LightSampler::new(&lights);
        for _ in 0..4 {
            let (point, normal) = (numbers.direction() * numbers.between(0.01, 4.0), numbers.direction());
            const GRID: usize = 20_000;
            let mut counts = vec![0.0_f64; count];
            let importances = light_sampler.importances(&lights, point, normal).unwrap();
            for i in 0..GRID {
                let u = (i as f32 + 0.5) / GRID as f32;
                let Some((light, chance)) = importances.sample(&lights, u) else { continue };
                let said = light_sampler.pmf(&lights, light, point, normal);
                assert!((chance / said - 1.0).abs() < 1e-5, "{chance} {said}");
                counts[light as usize] += 1.0 / GRID as f64;
            }
            let chances = (0..count as u32).map(|light| light_sampler.pmf(&lights, light, point, normal));
            for (light, (chance, share)) in chances.zip(&counts).enumerate() {
                // An even grid meets each light's piece of the unit interval to within one of its points.
                assert!(
                    (f64::from(chance) - share).abs() < 1.5 / GRID as f64,
                    "{light} of {count}: {chance} for {share}"
                );
            }
            let total: f64 = counts.iter().sum();
            // A cluster may be chosen that turns out to give nothing.
            assert!(total < 1.0 + 1e-9, "{total}");
        }
    }
}

#[test]
fn one_chosen_light_stands_for_all_in_the_mean() {
    // Illuminance at a place, by one light a sample, against the sum over all of them.
    let mut numbers = Numbers::new(17);
    const COUNTS: [usize; 4] = [2, 12, 100, 1000];
    for count in COUNTS {
        let lights = crowd(count, &mut numbers);
        let light_sampler = LightSampler::new(&lights);
        let (point, normal) = (numbers.direction() * 0.5, numbers.direction());
        let lit = |light: &TracedLight, u: Vec2| {
            light.sample(point, u).map_or(0.0, |s| f64::from(s.value * s.direction.dot(normal).max(0.0)))
        };
        let truth: f64 =
            lights.iter().map(|light| (0..4096).map(|_| lit(light, numbers.square())).sum::<f64>() / 4096.0).sum();
        let importances = light_sampler.importances(&lights, point, normal).unwrap();
        let estimate = Estimate::of((0..60_000).map(|_| {
            let choice = importances.sample(&lights, numbers.number());
            choice.map_or(0.0, |(light, chance)| lit(&lights[light as usize], numbers.square()) / f64::from(chance))
        }));
        // The sum itself is good to some 1e-3.
        assert!(estimate.agrees(truth, 3e-3, COUNTS.len()), "{count} lights: {estimate:?} for {truth}");
    }
}

#[test]
fn ten_thousand_lights_lie_three_nodes_deep() {
    let mut numbers = Numbers::new(18);
    for (count, most) in [(60, 1), (1000, 2), (10_000, 3)] {
        let light_sampler = LightSampler::new(&crowd(count, &mut numbers));
        assert!(light_sampler.depth() <= most, "{count} lights: {} deep", light_sampler.depth());
    }
}

#[test]
fn rays_meet_the_emitters_that_asking_each_would_find() {
    let mut numbers = Numbers::new(19);
    let lights = crowd(200, &mut numbers);
    let emitter_bvh = EmitterBvh::new(&lights);
    let mut stack = TraversalStack::default();
    let mut met = 0;
    for i in 0..20_000 {
        let origin = numbers.direction() * numbers.between(0.0, 5.0);
        let t_max = if i % 2 == 0 { f32::INFINITY } else { numbers.between(0.1, 4.0) };
        let ray = Ray { origin, direction: numbers.direction(), t_max };
        let mut found = Vec::new();
        // The end of the ray is for the caller to judge: it lies within rounding.
        emitter_bvh.for_each_hit(&lights, &ray, &mut stack, |light, seen| {
            if seen.distance <= t_max {
                found.push(light);
            }
        });
        found.sort_unstable();
        let truth = |light: &u32| {
            let light = &lights[*light as usize];
            light.intersect(origin, ray.direction).is_some_and(|seen| seen.distance <= t_max)
        };
        let truth: Vec<u32> = (0..lights.len() as u32).filter(truth).collect();
        assert_eq!(found, truth, "{ray:?}");
        met += truth.len();
    }
    assert!(met > 10_000, "only {met} emitters met: the test says little");
}

#[test]
fn no_light_that_gives_something_is_never_chosen() {
    // Choice by importance is right only where no light with a share has none.
    let mut numbers = Numbers::new(16);
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
            let from = numbers.direction() * numbers.between(0.01, 4.0);
            let normal = numbers.direction();
            let Some(sample) = light.sample(from, numbers.square()) else { continue };
            if sample.direction.dot(normal) > 1e-4 && sample.value > 0.0 {
                let chance = light_sampler.pmf(std::slice::from_ref(&light), 0, from, normal);
                assert!(chance > 0.0, "{emitter:?} seen from {from}, facing {normal}");
            }
        }
    }
}

#[test]
fn no_light_of_a_crowd_that_gives_something_is_never_chosen() {
    // Clusters must not forget members that lie aside or look elsewhere.
    let mut numbers = Numbers::new(20);
    let lights = crowd(600, &mut numbers);
    let light_sampler = LightSampler::new(&lights);
    let mut given = 0;
    for _ in 0..300 {
        let (from, normal) = (numbers.direction() * numbers.between(0.01, 6.0), numbers.direction());
        for (light, index) in lights.iter().zip(0..).step_by(7) {
            let Some(sample) = light.sample(from, numbers.square()) else { continue };
            if sample.direction.dot(normal) > 1e-4 && sample.value > 0.0 {
                given += 1;
                assert!(
                    light_sampler.pmf(&lights, index, from, normal) > 0.0,
                    "{light:?} from {from}, facing {normal}"
                );
            }
        }
    }
    assert!(given > 5000, "only {given}");
}
