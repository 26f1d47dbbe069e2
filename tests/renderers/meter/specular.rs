//! Light that mirrors and balls of glass throw on the meter.

use super::*;

/// An object of a material, turned.
fn specular(shape: Shape, material: Material, position: Vec3, rotation_deg: Vec3) -> Object {
    let mut object = studio::object("Specular", shape, position);
    object.transform.rotation_deg = rotation_deg;
    Object { material, ..object }
}

#[test]
fn a_mirror_gives_the_meter_the_illuminance_of_the_lights_image() {
    // The meter faces up under a lamp at 1 m; a mirror 1 m beside shows its image at (2, 1, 0). Flat: inverse square and
    // cosine; a dome weights it by (1 + cos) / 2.
    let mirror = Material { metallic: 1.0, roughness: 0.0, base_color: [0.999; 3], ..Material::default() };
    let plane = Shape::Plane { width_m: 0.4, depth_m: 0.4 };
    let cos = 0.2_f64.sqrt();
    for emitter in [Emitter::Point, Emitter::Sphere { radius_m: 0.005 }, Emitter::Sun { angular_diameter_deg: 0.53 }] {
        for receptor in [Receptor::Flat, Receptor::Dome] {
            let mut lamp = light(emitter, Output::Lumens(12_566.37), Vec3::Y);
            let mut image = 1000.0 / 5.0 * if receptor == Receptor::Flat { cos } else { 0.5 * (1.0 + cos) };
            if let Emitter::Sun { .. } = emitter {
                lamp.power.output = Output::Lux(1000.0);
                lamp.aim = Aim::Angles { yaw_deg: -90.0, pitch_deg: -30.0 };
                image = if receptor == Receptor::Flat { 500.0 } else { 750.0 };
            }
            let mut scene = Scene { lights: vec![lamp], ..Scene::default() };
            let at = Vec3::new(1.0, 0.5, 0.0);
            scene.objects.push(specular(plane.clone(), mirror.clone(), at, Vec3::Z * 90.0));
            let reading = &read(&scene, Vec3::ZERO, Vec3::Y, receptor).reading.lights[0];
            let (ours, error) = (f64::from(reading.bounced), f64::from(reading.standard_error));
            // Over a receptor of 1 cm the image's illuminance changes by less than 0.1 %.
            assert!(
                (ours - 0.999 * image).abs() < 4.0 * error + 2e-3 * image,
                "{emitter:?} {receptor:?}: {ours} of {image} lx"
            );
            assert!(error < 0.06 * image, "{emitter:?} {receptor:?}: {error} says little");
        }
    }
}

/// Illuminance of a disc of this radius by a lamp of 1 cd through a ball of glass between both, all on one axis: rays in
/// a plane of the axis, at equal steps of the angle, with all inner reflections. Distances from the ball's centre.
fn through_ball(lamp: f64, ball: f64, n: f64, disc: f64, disc_radius: f64) -> f64 {
    use glam::DVec2;
    let steps = 20_000;
    let widest = (ball / lamp).asin();
    let reflectances = |cos: f64, eta: f64| {
        let (s, p) = studio::closed_forms::fresnel(cos.min(1.0).acos(), eta);
        [s, p]
    };
    let refract = |d: DVec2, normal: DVec2, eta: f64| {
        let cos = -d.dot(normal);
        d / eta + normal * (cos / eta - (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt())
    };
    let mut flux = 0.0;
    for step in 0..steps {
        let angle = (f64::from(step) + 0.5) / f64::from(steps) * widest;
        let (mut at, d) = (DVec2::new(0.0, lamp), DVec2::new(angle.sin(), -angle.cos()));
        let b = at.dot(d);
        at += d * (-b - (b * b - lamp * lamp + ball * ball).sqrt());
        let mut weights = reflectances(-d.dot(at / ball), n).map(|r| 1.0 - r);
        let mut inside = refract(d, at / ball, n);
        for _ in 0..8 {
            at -= inside * (2.0 * at.dot(inside));
            let normal = -at / ball;
            let faces = reflectances(-inside.dot(normal), 1.0 / n);
            let out = refract(inside, normal, 1.0 / n);
            let x = at.x + out.x * (at.y + disc) / -out.y;
            if out.y < 0.0 && x.abs() < disc_radius {
                let passed = 0.5 * (weights[0] * (1.0 - faces[0]) + weights[1] * (1.0 - faces[1]));
                flux += passed * 2.0 * std::f64::consts::PI * angle.sin() * widest / f64::from(steps);
            }
            weights = [weights[0] * faces[0], weights[1] * faces[1]];
            inside -= normal * (2.0 * inside.dot(normal));
        }
    }
    flux / (std::f64::consts::PI * disc_radius * disc_radius)
}

#[test]
fn a_ball_of_glass_focuses_small_lamps_on_the_meter_with_every_seed() {
    // 7 % of the light is that of three inner reflections. The lamp is 2.6 m before the ball's centre, the meter 0.4 m
    // behind it, with a receptor of 1 cm.
    let truth = 1000.0 * through_ball(2.6, 0.1, 1.5, 0.4, 0.01);
    assert!((truth - 63.68).abs() < 0.1, "{truth}");
    let glass = Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ior: 1.5, ..Material::default() };
    for emitter in [Emitter::Point, Emitter::Sphere { radius_m: 0.005 }] {
        let lamp = light(emitter, Output::Lumens(12_566.37), Vec3::Z * 3.0);
        let mut scene = Scene { lights: vec![lamp], ..Scene::default() };
        scene.objects.push(specular(Shape::Sphere { radius_m: 0.1 }, glass.clone(), Vec3::Z * 0.4, Vec3::ZERO));
        for seed in 0..5 {
            let effort = MeterEffort { seed, ..MeterEffort::default() };
            let result = read_with(&scene, Vec3::ZERO, Vec3::Z, Receptor::Flat, &effort);
            let reading = &result.reading.lights[0];
            let (ours, error) = (f64::from(reading.sum()), f64::from(reading.standard_error));
            // The ball is a mesh, which focuses like a ball to 1 %.
            assert!(
                (ours - truth).abs() < 0.01 * truth + 4.0 * error,
                "{emitter:?}, seed {seed}: {ours} of {truth} lx"
            );
            assert!(error < 0.03 * truth, "{emitter:?}, seed {seed}: {error} says little");
        }
    }
}

#[test]
fn a_meter_that_finds_no_light_says_what_mirrors_may_throw_on_it() {
    // A lamp behind a wall; a mirror shows it to the meter from one direction of many, or from none.
    let mirror = Material { metallic: 1.0, roughness: 0.0, ..Material::default() };
    let wall = studio::object("Wall", Shape::Box { size_m: Vec3::new(1.0, 1.0, 0.1) }, Vec3::Z);
    let lamp = light(Emitter::Point, Output::Lumens(12_566.37), Vec3::Z * 2.0);
    let mut scene = Scene { objects: vec![wall], lights: vec![lamp], ..Scene::default() };
    let dark = read(&scene, Vec3::ZERO, Vec3::Z, Receptor::Flat).reading;
    assert_eq!((dark.total_lux_s(), dark.missed_lux_s()), (0.0, 0.0), "nothing can bring light here");
    let plane = Shape::Plane { width_m: 0.5, depth_m: 0.5 };
    scene.objects.push(specular(plane, mirror, Vec3::new(1.5, -0.5, 1.0), Vec3::ZERO));
    let unknown = read(&scene, Vec3::ZERO, Vec3::Z, Receptor::Flat).reading;
    assert!(unknown.total_lux_s() == 0.0 && unknown.missed_lux_s() > 0.0, "{unknown:?}");
    assert!(unknown.missed_lux_s() * 125.0 < 30.0, "{} lx are more than it can be", unknown.missed_lux_s() * 125.0);
}
