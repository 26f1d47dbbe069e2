//! What the G-buffer holds, channel by channel, and light in false colour.

use super::*;
use catchlight::preview::{Channel, Gloss, false_color};

const SIZE: (u32, u32) = (61, 41);

/// A ball on a floor of grey card under two bulbs.
fn studio() -> Scene {
    let mut scene = floor_under(light(0, Vec3::Y * 3.0, Vec3::ZERO, Emitter::Point, Output::Lumens(10_000.0)));
    scene.lights.push(light(1, Vec3::new(2.0, 2.0, 0.0), Vec3::ZERO, Emitter::Point, Output::Lumens(4000.0)));
    let gold = Material { base_color: [0.9, 0.6, 0.2], metallic: 1.0, roughness: 0.25, ..Material::default() };
    scene.objects.push(object(1, Shape::Sphere { radius_m: 0.4 }, Vec3::new(-2.0, 0.4, 0.0), gold));
    scene
}

fn shows(scene: &Scene, options: Options) -> PreviewInput<'_> {
    PreviewInput { options, ..direct(scene, SIZE) }
}

fn of(channel: Channel) -> Options {
    Options { channel, ..Options::direct_only() }
}

#[test]
fn each_channel_holds_what_the_scene_says() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let scene = studio();
    let size = (301, 201);
    let frame = direct(&scene, size).frame;
    let (floor, ball) = (Vec3::new(1.0, 0.0, 1.0), Vec3::new(-2.0, 0.6828, 0.2828));
    let mut at = |channel, point: Vec3| {
        let input = PreviewInput { options: of(channel), ..direct(&scene, size) };
        let picture = renderer.linear_picture(&input).unwrap();
        let place = frame.project(point).unwrap() * Vec2::new(size.0 as f32, size.1 as f32);
        Vec3::from(picture.at(place.x as u32, place.y as u32))
    };
    // 10 bits of square roots for colour, 12 for roughness; the picture's half floats hold 11.
    assert!(at(Channel::BaseColor, floor).distance(Vec3::splat(0.18)) < 1e-3);
    assert!(at(Channel::BaseColor, ball).distance(Vec3::new(0.9, 0.6, 0.2)) < 2e-3);
    assert!(at(Channel::Normal, floor).distance(Vec3::Y) < 1e-3);
    // Half-way up towards the camera, half a pixel (2 cm) off at most.
    assert!(at(Channel::Normal, ball).distance(Vec3::new(0.0, 0.5_f32.sqrt(), 0.5_f32.sqrt())) < 0.15);
    assert!((at(Channel::Roughness, ball).x - 0.25).abs() < 1e-3);
    assert_eq!((at(Channel::Metallic, ball).x, at(Channel::Metallic, floor).x), (1.0, 0.0));
    let depth = (floor - scene.camera.position).dot(frame.forward());
    assert!((at(Channel::Depth, floor).x / depth - 1.0).abs() < 0.02);
    assert!(at(Channel::Ids, floor).distance(at(Channel::Ids, ball)) > 0.1);
}

#[test]
fn illuminance_is_lux_and_its_colours_are_stops_against_the_camera() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut scene = studio();
    scene.lights.truncate(1);
    let options = of(Channel::Illuminance);
    let picture = renderer.linear_picture(&shows(&scene, options)).unwrap();
    let shown = renderer.picture(&shows(&scene, options)).unwrap();
    let frame = direct(&scene, SIZE).frame;
    let per_lux = exposure::pixel_per_cd_s_m2(&scene.camera) * scene.camera.shutter_s / PI;
    // The table of light_and_camera.md: a bulb of 10 000 lm 3 m over the floor.
    for (r, lux) in [(0.0, 88.42), (1.0, 75.49), (2.0, 50.93)] {
        let place = Vec3::new(r, 0.0, 0.0);
        let white = seen_at(&picture, &frame, place);
        assert_close(white / per_lux, lux, 0.01, &format!("{r} m beside"));
        let pixel = frame.project(place).unwrap() * Vec2::new(SIZE.0 as f32, SIZE.1 as f32);
        let (x, y) = (pixel.x as u32, pixel.y as u32);
        let expected = false_color(color::luminance(picture.at(x, y).into()).log2());
        let off = shown.get_pixel(x, y).0.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max().unwrap();
        assert!(off <= 1, "{:?} instead of {expected:?}", shown.get_pixel(x, y));
    }
}

#[test]
fn one_light_alone_is_its_share_of_the_whole() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let scene = studio();
    let mut sum_with = |only_light| {
        let picture =
            renderer.linear_picture(&shows(&scene, Options { only_light, ..Options::direct_only() })).unwrap();
        picture.rgb.iter().map(|rgb| color::luminance((*rgb).into())).sum::<f32>()
    };
    let all = sum_with(None);
    let (first, second) = (sum_with(Some(LightId(0))), sum_with(Some(LightId(1))));
    assert!(first > 0.0 && second > 0.0);
    assert_close(first + second, all, 2e-3, "both");
}

#[test]
fn blinn_phong_shines_in_the_same_place_with_about_the_same_light() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut scene = studio();
    scene.objects[1].material = Material { base_color: [0.0; 3], roughness: 0.4, ..Material::default() };
    scene.objects.remove(0);
    let mut with = |gloss| {
        let picture = renderer.linear_picture(&shows(&scene, Options { gloss, ..Options::direct_only() })).unwrap();
        let values: Vec<f32> = picture.rgb.iter().map(|rgb| color::luminance((*rgb).into())).collect();
        let brightest = (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap();
        (values.iter().sum::<f32>(), brightest as i32)
    };
    let ((ggx, ggx_at), (blinn, blinn_at)) = (with(Gloss::Ggx), with(Gloss::BlinnPhong));
    let apart = ((ggx_at - blinn_at) % SIZE.0 as i32).abs() + (ggx_at - blinn_at).abs() / SIZE.0 as i32;
    assert!(apart <= 2, "{ggx_at} and {blinn_at}");
    // GGX has a long tail, and Fresnel at its rim.
    assert!(blinn > 0.4 * ggx && blinn < 1.6 * ggx, "{blinn} and {ggx}");
    assert_ne!(ggx, blinn);
}
