//! Illuminance on a floor against tables and numerical integrals.

use super::*;
use catchlight::photo::emitter::cone_falloff;
use catchlight::photo::light::axial_intensity;

#[test]
fn a_point_light_over_a_floor_has_the_tabulated_falloff() {
    let Some(mut renderer) = shared_renderer() else { return };
    let scene = floor_under(light(0, Vec3::Y * 3.0, Vec3::ZERO, Emitter::Point, Output::Lumens(10_000.0)));
    for (r, lux) in [(0.0, 88.42), (1.0, 75.49), (2.0, 50.93), (3.0, 31.26), (4.0, 19.10)] {
        let actual = lux_at(&mut renderer, &scene, Vec3::new(r, 0.0, 0.0));
        // The picture's half floats hold 0.1 %.
        assert_close(actual, lux, 0.003, &format!("{r} m beside"));
    }
}

#[test]
fn panels_have_the_tabulated_near_field() {
    let Some(mut renderer) = shared_renderer() else { return };
    let panels = [
        (Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, [729.52, 267.05, 130.27, 75.89, 34.62, 12.63]),
        (Emitter::RectPanel { width_m: 0.9, height_m: 1.2 }, [523.91, 232.79, 121.44, 72.80, 33.96, 12.54]),
        (Emitter::RoundPanel { diameter_m: 1.2 }, [521.82, 234.05, 121.96, 73.01, 34.01, 12.55]),
    ];
    for (emitter, table) in panels {
        for (distance, lux) in [0.5, 1.0, 1.5, 2.0, 3.0, 5.0].into_iter().zip(table) {
            let scene = floor_under(light(0, Vec3::Y * distance, Vec3::ZERO, emitter, Output::Lumens(1000.0)));
            let actual = lux_at(&mut renderer, &scene, Vec3::ZERO);
            assert_close(actual, lux, 0.01, &format!("{emitter:?} at {distance} m"));
        }
    }
}

#[test]
fn a_panel_partly_below_the_horizon_is_clipped() {
    let Some(mut renderer) = shared_renderer() else { return };
    for emitter in [Emitter::RectPanel { width_m: 1.0, height_m: 1.6 }, Emitter::RoundPanel { diameter_m: 1.4 }] {
        // Upright with its centre 0.2 m above the floor: its lower part is below the floor's plane
        let place = Vec3::new(0.0, 0.2, -1.0);
        let scene = floor_under(light(0, place, place + Vec3::Z, emitter, Output::Lumens(1000.0)));
        let point = Vec3::new(0.3, 0.0, 0.2);
        let expected = integrate_panel(&scene.lights[0], point);
        // The shader's hexagon is less exact for a clipped disc.
        assert_close(lux_at(&mut renderer, &scene, point), expected, 0.02, &format!("{emitter:?}"));
    }
}

/// Returns the illuminance of a panel that faces +Z at a floor point, by a grid over its area.
fn integrate_panel(light: &Light, point: Vec3) -> f32 {
    let (half, area, round) = match light.emitter {
        Emitter::RectPanel { width_m, height_m } => (Vec2::new(width_m, height_m) * 0.5, width_m * height_m, false),
        Emitter::RoundPanel { diameter_m } => (Vec2::splat(diameter_m * 0.5), PI * diameter_m * diameter_m / 4.0, true),
        _ => unreachable!("only panels are integrated here"),
    };
    let (luminance, steps) = (axial_intensity(light, None) / area, 400);
    let mut sum = 0.0;
    for i in 0..steps * steps {
        let cell = Vec2::new((i % steps) as f32 + 0.5, (i / steps) as f32 + 0.5) * 2.0 / steps as f32 - 1.0;
        let to_cell = light.position + (cell * half).extend(0.0) - point;
        if round && cell.length() > 1.0 || to_cell.y <= 0.0 {
            continue;
        }
        let squared = to_cell.length_squared();
        sum += to_cell.y * -to_cell.z / (squared * squared);
    }
    luminance * sum * 4.0 * half.x * half.y / (steps * steps) as f32
}

#[test]
fn a_sphere_partly_below_the_horizon_is_clipped() {
    let Some(mut renderer) = shared_renderer() else { return };
    for height in [2.0, 0.3, -0.1] {
        let radius_m = 0.5;
        let place = Vec3::new(0.0, height, 0.0);
        let lamp = light(0, place, Vec3::ZERO, Emitter::Sphere { radius_m }, Output::Lumens(1000.0));
        let scene = floor_under(lamp);
        let point = Vec3::new(1.2, 0.0, 0.0);
        let luminance = axial_intensity(&scene.lights[0], None) / (PI * radius_m * radius_m);
        let expected = luminance * cosine_weighted_cap(place - point, radius_m);
        // Without shadows: where the floor intersects the sphere, its centre is in the floor's shadow
        assert_close(unshadowed_lux_at(&mut renderer, &scene, point), expected, 0.015, &format!("{height} m up"));
    }
}

/// Returns the cosine-weighted solid angle of a sphere above the horizon of +Y, by a grid of directions.
fn cosine_weighted_cap(to_centre: Vec3, radius: f32) -> f32 {
    let steps = 1500;
    let mut sum = 0.0;
    for i in 0..steps {
        // Uniform steps of the squared sine are uniform steps of cosine-weighted solid angle
        let sine = ((i as f32 + 0.5) / steps as f32).sqrt();
        let hits = (0..steps).filter(|j| {
            let turn = Vec2::from_angle((*j as f32 + 0.5) / steps as f32 * 2.0 * PI) * sine;
            let direction = Vec3::new(turn.x, (1.0 - sine * sine).sqrt(), turn.y);
            let along = to_centre.dot(direction);
            along > 0.0 && to_centre.length_squared() - along * along < radius * radius
        });
        sum += hits.count() as f32;
    }
    PI * sum / (steps * steps) as f32
}

#[test]
fn a_spot_falls_off_linearly_in_angle_to_zero() {
    let Some(mut renderer) = shared_renderer() else { return };
    for (inner_deg, outer_deg) in [(30.0, 70.0), (50.0, 50.0)] {
        let emitter = Emitter::Spot { inner_deg, outer_deg };
        let scene = floor_under(light(0, Vec3::Y * 2.0, Vec3::ZERO, emitter, Output::Candela(4000.0)));
        for angle_deg in [0.0_f32, 10.0, 20.0, 30.0, 40.0] {
            let (sine, cosine) = angle_deg.to_radians().sin_cos();
            let expected = 1000.0 * cone_falloff(cosine, inner_deg, outer_deg) * cosine.powi(3);
            let actual = lux_at(&mut renderer, &scene, Vec3::new(2.0 * sine / cosine, 0.0, 0.0));
            assert!((actual - expected).abs() < 15.0, "{emitter:?} at {angle_deg}: {actual} instead of {expected}");
        }
    }
}

#[test]
fn a_sun_is_uniform_and_a_room_blocks_it() {
    let Some(mut renderer) = shared_renderer() else { return };
    let sun = Emitter::Sun { angular_diameter_deg: 0.53 };
    let mut scene = floor_under(light(0, Vec3::new(0.0, 3.0, 3.0), Vec3::ZERO, sun, Output::Lux(1000.0)));
    for point in [Vec3::ZERO, Vec3::new(2.0, 0.0, 1.0)] {
        assert_close(lux_at(&mut renderer, &scene, point), 1000.0 * 0.5_f32.sqrt(), 0.005, "cosine law");
    }
    scene.room = Some(Room { size_m: Vec3::new(20.0, 8.0, 20.0), ..Room::default() });
    assert_eq!(lux_at(&mut renderer, &scene, Vec3::ZERO), 0.0);
}

#[test]
fn doubling_the_shutter_time_doubles_continuous_light_and_not_flash() {
    let Some(mut renderer) = shared_renderer() else { return };
    let flash = Output::FlashWs { energy_ws: 25.0, efficacy_lm_s_per_ws: 40.0 };
    for (output, factor) in [(Output::Lumens(2000.0), 2.0), (flash, 1.0)] {
        let mut scene = floor_under(light(0, Vec3::Y * 2.0, Vec3::ZERO, Emitter::Point, output));
        let mut luminance = || {
            let input = direct(&scene, (61, 41));
            let value = luminance_at(&renderer.linear_picture(&input).unwrap(), &input.frame, Vec3::ZERO);
            scene.camera.shutter_s *= 2.0;
            value
        };
        let (once, twice) = (luminance(), luminance());
        assert_close(twice, once * factor, 0.001, &format!("{output:?}"));
    }
}
