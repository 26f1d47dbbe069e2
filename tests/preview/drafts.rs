//! Approximations and their errors: drafts while something moves, and light culling.

use super::*;

/// Returns the mean and the 99th percentile of the differences between two pictures, codes of 255.
fn differences(a: &image::RgbImage, b: &image::RgbImage) -> (f32, u8) {
    let mut codes: Vec<u8> = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| a.abs_diff(*b)).collect();
    codes.sort_unstable();
    let mean = codes.iter().map(|c| f32::from(*c)).sum::<f32>() / codes.len() as f32;
    (mean, codes[codes.len() * 99 / 100])
}

#[test]
fn a_draft_is_close_to_the_full_picture_and_leaves_no_trace_in_it() {
    let Some(mut renderer) = shared_renderer() else { return };
    for name in ["three_point", "product_still_life", "gel_portrait"] {
        let with_hair = shipped(name);
        // One pixel in nine or fewer is shaded: fine highlights and shadow edges are lost. Of strands, which are a pixel
        // wide, a quarter is drawn, four times as wide.
        for (loaded, mean_limit, most_limit) in [(hairless(with_hair.clone()), 1.5, 40), (with_hair, 5.0, 90)] {
            let mut input = PreviewInput::camera_view(&loaded.scene, &loaded.assets, (481, 321));
            let full = renderer.picture(&input).unwrap();
            input.options.draft = true;
            let (mean, most) = differences(&renderer.picture(&input).unwrap(), &full);
            let line = format!("{name}: {mean} codes in the mean, {most} in the 99th percentile");
            println!("{line}");
            assert!(mean < mean_limit && most < most_limit, "{line}");
            if !renderer.draws_drafts() {
                assert_eq!((mean, most), (0.0, 0), "a GPU draws no drafts");
            }
            input.options.draft = false;
            assert_eq!(renderer.picture(&input).unwrap(), full, "{name}: after a draft");
        }
    }
}

#[test]
fn light_culling_removes_only_faint_light() {
    let Some(mut renderer) = shared_renderer() else { return };
    // Small lights over the floor, each with a cull radius smaller than the floor
    for count in [40, 3, 1] {
        let mut scene = floor_under(light(0, Vec3::Y, Vec3::ZERO, Emitter::Point, Output::Candela(1.0)));
        scene.lights = (0..count).map(small_light).collect();
        assert_only_faint_light_is_culled(&mut renderer, &scene);
    }
}

/// Returns a light 0.6 m above the floor, cycling through the kinds.
fn small_light(i: u32) -> Light {
    let place = Vec3::new(((i + 4) % 8) as f32 * 1.2 - 4.2, 0.6, ((i / 8 + 2) % 5) as f32 * 1.2 - 2.4);
    let emitter = match i % 4 {
        0 => Emitter::Point,
        1 => Emitter::Sphere { radius_m: 0.05 },
        2 => Emitter::RectPanel { width_m: 0.2, height_m: 0.3 },
        _ => Emitter::RoundPanel { diameter_m: 0.2 },
    };
    light(i, place, place.with_y(0.0), emitter, Output::Candela(1.5))
}

fn assert_only_faint_light_is_culled(renderer: &mut PreviewRenderer, scene: &Scene) {
    let mut input = direct(scene, (301, 201));
    input.options.shadows = false;
    let culled = renderer.linear_picture(&input).unwrap();
    input.options.light_radius = false;
    let all = renderer.linear_picture(&input).unwrap();
    let luminance =
        |picture: &Picture| -> Vec<f32> { picture.rgb.iter().map(|rgb| color::luminance((*rgb).into())).collect() };
    let (culled, all) = (luminance(&culled), luminance(&all));
    let lost: Vec<f32> = all.iter().zip(&culled).map(|(all, culled)| all - culled).collect();
    let most = lost.iter().fold(0.0_f32, |a, b| a.max(*b));
    // A light is culled where a white surface would fall under 1/256; the card reflects 18 %.
    assert!(most < scene.lights.len() as f32 * 0.18 / 256.0 / 0.64, "{most} lost");
    assert!(most > 0.0, "some light is culled");
    assert!(lost.iter().all(|lost| *lost > -1e-3), "nothing is added");
    let brightest = all.iter().fold(0.0_f32, |a, b| a.max(*b));
    assert!(brightest > 0.005, "{brightest}");
}

#[test]
fn a_draft_under_many_lights_is_close_to_the_full_picture() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut scene = floor_under(light(0, Vec3::Y, Vec3::ZERO, Emitter::Point, Output::Candela(1.0)));
    let ball = Shape::Sphere { radius_m: 0.8 };
    scene.objects.push(object(1, ball, Vec3::new(0.0, 0.8, 0.0), grey_card()));
    for count in [8, 20, 40] {
        scene.lights = (0..count)
            .map(|i| {
                let turn = Vec2::from_angle(i as f32 * 2.4) * 3.0;
                let emitter = Emitter::RectPanel { width_m: 0.3, height_m: 0.4 };
                light(i, Vec3::new(turn.x, 2.5, turn.y), Vec3::Y, emitter, Output::Candela(60.0 / count as f32))
            })
            .collect();
        let mut input = direct(&scene, (301, 201));
        let full = renderer.picture(&input).unwrap();
        input.options.draft = true;
        let (mean, most) = differences(&renderer.picture(&input).unwrap(), &full);
        assert!(mean < 2.0 && most < 40, "{count} lights: {mean} codes in the mean, {most} in the 99th percentile");
    }
}
