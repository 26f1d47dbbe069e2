//! Channels of the G-buffer, illuminance in false colour, and Blinn-Phong highlights.

use super::*;
use catchlight::photo::false_color;
use catchlight::preview::{Channel, Gloss};

const SIZE: (u32, u32) = (61, 41);

/// A gold sphere on a grey card floor under two point lights.
fn studio() -> Scene {
    let mut scene = floor_under(light(0, Vec3::Y * 3.0, Vec3::ZERO, Emitter::Point, Output::Lumens(10_000.0)));
    scene.lights.push(light(1, Vec3::new(2.0, 2.0, 0.0), Vec3::ZERO, Emitter::Point, Output::Lumens(4000.0)));
    let gold = Material { base_color: [0.9, 0.6, 0.2], metallic: 1.0, roughness: 0.25, ..Material::default() };
    scene.objects.push(object(1, Shape::Sphere { radius_m: 0.4 }, Vec3::new(-2.0, 0.4, 0.0), gold));
    scene
}

fn input_with(scene: &Scene, options: Options) -> PreviewInput<'_> {
    PreviewInput { options, ..direct(scene, SIZE) }
}

fn channel_options(channel: Channel) -> Options {
    Options { channel, ..Options::direct_only() }
}

#[test]
fn each_channel_has_the_values_of_the_scene() {
    let Some(mut renderer) = shared_renderer() else { return };
    let scene = studio();
    let size = (301, 201);
    let frame = direct(&scene, size).frame;
    let (floor, ball) = (Vec3::new(1.0, 0.0, 1.0), Vec3::new(-2.0, 0.6828, 0.2828));
    let mut at = |channel, point: Vec3| {
        let input = PreviewInput { options: channel_options(channel), ..direct(&scene, size) };
        let picture = renderer.linear_picture(&input).unwrap();
        let place = frame.project(point).unwrap() * Vec2::new(size.0 as f32, size.1 as f32);
        Vec3::from(picture.at(place.x as u32, place.y as u32))
    };
    // Colour has 10 bits of square roots, roughness 12; the picture's half floats have 11.
    assert!(at(Channel::BaseColor, floor).distance(Vec3::splat(0.18)) < 1e-3);
    assert!(at(Channel::BaseColor, ball).distance(Vec3::new(0.9, 0.6, 0.2)) < 2e-3);
    assert!(at(Channel::Normal, floor).distance(Vec3::Y) < 1e-3);
    // The normal is half-way between up and the camera; half a pixel is 2 cm.
    assert!(at(Channel::Normal, ball).distance(Vec3::new(0.0, 0.5_f32.sqrt(), 0.5_f32.sqrt())) < 0.15);
    assert!((at(Channel::Roughness, ball).x - 0.25).abs() < 1e-3);
    assert_eq!((at(Channel::Metallic, ball).x, at(Channel::Metallic, floor).x), (1.0, 0.0));
    let depth = (floor - scene.camera.position).dot(frame.forward());
    assert!((at(Channel::Depth, floor).x / depth - 1.0).abs() < 0.02);
    assert!(at(Channel::Ids, floor).distance(at(Channel::Ids, ball)) > 0.1);
}

#[test]
fn illuminance_is_in_lux_and_its_false_colours_are_stops_relative_to_the_exposure() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut scene = studio();
    scene.lights.truncate(1);
    let options = channel_options(Channel::Illuminance);
    let picture = renderer.linear_picture(&input_with(&scene, options)).unwrap();
    let shown = renderer.picture(&input_with(&scene, options)).unwrap();
    let frame = direct(&scene, SIZE).frame;
    let per_lux = exposure::pixel_per_cd_s_m2(&scene) * scene.camera.shutter_s / PI;
    // An isotropic source of 10 000 lm 3 m above the floor: E = I cos / d^2
    for (r, lux) in [(0.0, 88.42), (1.0, 75.49), (2.0, 50.93)] {
        let place = Vec3::new(r, 0.0, 0.0);
        let white = luminance_at(&picture, &frame, place);
        assert_close(white / per_lux, lux, 0.01, &format!("{r} m beside"));
        let pixel = frame.project(place).unwrap() * Vec2::new(SIZE.0 as f32, SIZE.1 as f32);
        let (x, y) = (pixel.x as u32, pixel.y as u32);
        let expected = false_color(color::luminance(picture.at(x, y).into()).log2());
        let off = shown.get_pixel(x, y).0.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max().unwrap();
        assert!(off <= 1, "{:?} instead of {expected:?}", shown.get_pixel(x, y));
    }
}

#[test]
fn single_lights_sum_to_the_whole() {
    let Some(mut renderer) = shared_renderer() else { return };
    let scene = studio();
    let mut sum_with = |only_light| {
        let picture =
            renderer.linear_picture(&input_with(&scene, Options { only_light, ..Options::direct_only() })).unwrap();
        picture.rgb.iter().map(|rgb| color::luminance((*rgb).into())).sum::<f32>()
    };
    let all = sum_with(None);
    let (first, second) = (sum_with(Some(LightId(0))), sum_with(Some(LightId(1))));
    assert!(first > 0.0 && second > 0.0);
    assert_close(first + second, all, 2e-3, "both");
}

#[test]
fn a_blinn_phong_highlight_on_a_floor_is_its_closed_form() {
    let Some(mut renderer) = shared_renderer() else { return };
    let (intensity_cd, position) = (800.0, Vec3::new(0.0, 3.0, 0.0));
    let mut scene = floor_under(light(0, position, Vec3::ZERO, Emitter::Point, Output::Candela(intensity_cd)));
    let (roughness, ior) = (0.4_f32, 1.5_f32);
    scene.objects[0].material = Material { base_color: [0.0; 3], roughness, ior, ..Material::default() };
    let options = Options { gloss: Gloss::BlinnPhong, ..Options::direct_only() };
    let input = PreviewInput { options, ..direct(&scene, (301, 201)) };
    let picture = renderer.linear_picture(&input).unwrap();
    let per_cd_m2 = exposure::pixel_per_cd_s_m2(&scene) * scene.camera.shutter_s;

    // L = F0 (n + 8) / (8 pi) (n.h)^n E with n = 2 / alpha^2 - 2 and alpha = roughness^2
    let f0 = ((ior - 1.0) / (ior + 1.0)).powi(2);
    let exponent = 2.0 / roughness.powi(4) - 2.0;
    let luminance = |point: Vec3| {
        let to_light = position - point;
        let (wi, wo) = (to_light.normalize(), (scene.camera.position - point).normalize());
        let illuminance = intensity_cd * wi.y / to_light.length_squared();
        f0 * (exponent + 8.0) / (8.0 * PI) * (wi + wo).normalize().y.powf(exponent) * illuminance
    };
    // The mirror direction lies at z = 2 m. Light and camera are 3 m and 6 m above the floor.
    for (x, z) in [(0.0, 2.0), (0.3, 2.0), (-0.6, 2.1), (0.0, 1.4), (0.2, 2.7), (0.9, 1.8)] {
        let point = Vec3::new(x, 0.0, z);
        let actual = luminance_at(&picture, &input.frame, point) / per_cd_m2;
        // Half floats hold 0.1 %, and interpolation between pixels of 4 cm loses as much of the lobe's curvature.
        assert_close(actual, luminance(point), 0.01, &format!("{point}"));
    }
}

#[test]
fn blinn_phong_and_ggx_have_their_highlight_in_the_same_place() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut scene = studio();
    scene.objects[1].material = Material { base_color: [0.0; 3], roughness: 0.4, ..Material::default() };
    scene.objects.remove(0);
    let mut highlight = |gloss| {
        let input = input_with(&scene, Options { gloss, ..Options::direct_only() });
        let picture = renderer.linear_picture(&input).unwrap();
        let values: Vec<f32> = picture.rgb.iter().map(|rgb| color::luminance((*rgb).into())).collect();
        let brightest = (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap();
        (values.iter().sum::<f32>(), brightest as i32)
    };
    let ((ggx, ggx_at), (blinn, blinn_at)) = (highlight(Gloss::Ggx), highlight(Gloss::BlinnPhong));
    let distance = ((ggx_at - blinn_at) % SIZE.0 as i32).abs() + (ggx_at - blinn_at).abs() / SIZE.0 as i32;
    assert!(distance <= 2, "{ggx_at} and {blinn_at}");
    assert_ne!(ggx, blinn);
}
