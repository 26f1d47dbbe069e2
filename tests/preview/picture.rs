//! Shadows, textures, picking, overlay, caching between frames and robustness.

use super::*;
use catchlight::photo::{PictureDisplay, Spot, false_color};

#[test]
fn objects_cast_contact_shadows_for_every_kind_of_light() {
    let Some(mut renderer) = shared_renderer() else { return };
    let emitters = [
        Emitter::Point,
        Emitter::Sphere { radius_m: 0.05 },
        Emitter::Spot { inner_deg: 60.0, outer_deg: 80.0 },
        Emitter::RectPanel { width_m: 0.2, height_m: 0.2 },
        Emitter::RoundPanel { diameter_m: 0.2 },
    ];
    let cube = Shape::Box { size_m: Vec3::splat(0.5) };
    for emitter in emitters {
        let mut scene = floor_under(light(0, Vec3::new(2.0, 2.0, 0.0), Vec3::ZERO, emitter, Output::Lumens(5000.0)));
        let lit = lux_at(&mut renderer, &scene, Vec3::new(-0.5, 0.0, 0.0));
        scene.objects.push(object(1, cube.clone(), Vec3::Y * 0.25, grey_card()));
        // The shadow extends from the box to 0.4 m behind it; a pixel of the shadow mask covers 6 cm.
        for x in [-0.34, -0.45, -0.55] {
            let dark = lux_at(&mut renderer, &scene, Vec3::new(x, 0.0, 0.0));
            assert!(dark < 0.03 * lit, "{emitter:?}: {dark} lx at {x} m, {lit} lx without the box");
        }
        let beside = lux_at(&mut renderer, &scene, Vec3::new(-0.5, 0.0, 0.6));
        let behind = lux_at(&mut renderer, &scene, Vec3::new(-1.2, 0.0, 0.0));
        assert!(beside > 0.5 * lit && behind > 0.3 * lit, "{emitter:?}: {beside}, {behind} of {lit}");
    }
}

#[test]
fn a_cube_of_three_millimetres_on_a_wide_floor_has_its_shadow_in_a_close_up() {
    let Some(mut renderer) = shared_renderer() else { return };
    let lumens = Output::Lumens(5000.0);
    let lights = [
        (Emitter::Point, lumens),
        (Emitter::Sphere { radius_m: 0.02 }, lumens),
        (Emitter::Spot { inner_deg: 60.0, outer_deg: 80.0 }, lumens),
        (Emitter::RectPanel { width_m: 0.05, height_m: 0.05 }, lumens),
        (Emitter::Sun { angular_diameter_deg: 0.53 }, Output::Lux(50_000.0)),
    ];
    for (emitter, output) in lights {
        let mut scene = floor_under(light(0, Vec3::new(1.0, 1.0, 0.0), Vec3::ZERO, emitter, output));
        (scene.camera.position, scene.camera.focal_length_mm) = (Vec3::new(0.0, 0.12, 0.2), 100.0);
        let places = [-0.0025, -0.003, 0.0025, -0.0065].map(|x| Vec3::X * x);
        let free = places.map(|place| lux_at(&mut renderer, &scene, place));
        scene.objects.push(object(1, Shape::Box { size_m: Vec3::splat(0.003) }, Vec3::Y * 0.0015, grey_card()));
        let lit = places.map(|place| lux_at(&mut renderer, &scene, place));
        let parts: [f32; 4] = std::array::from_fn(|i| lit[i] / free[i]);
        // Light from 45 degrees: the shadow extends to 3 mm behind the cube. A texel of the sun's map and a pixel of
        // the mask cover half a millimetre. It is dark 1 mm behind the cube, and lit 1 mm in front of the cube and 2 mm
        // behind the shadow.
        assert!(parts[..2].iter().all(|part| *part < 0.2), "{emitter:?}: {parts:?} of the light");
        assert!(parts[2..].iter().all(|part| *part > 0.9), "{emitter:?}: {parts:?} of the light");
    }
}

#[test]
fn a_floor_does_not_shadow_itself_under_grazing_light() {
    let Some(mut renderer) = shared_renderer() else { return };
    for height in [0.1, 0.5, 3.0] {
        let emitter = Emitter::RectPanel { width_m: 1.0, height_m: 0.1 };
        let place = Vec3::new(3.0, height, 0.0);
        let scene = floor_under(light(0, place, Vec3::new(0.0, height * 0.5, 0.0), emitter, Output::Lumens(9000.0)));
        let mut input = direct(&scene, (151, 101));
        let shadowed = renderer.linear_picture(&input).unwrap();
        input.options.shadows = false;
        let free = renderer.linear_picture(&input).unwrap();
        for (with, without) in shadowed.rgb.iter().zip(&free.rgb) {
            assert!((with[1] - without[1]).abs() <= 0.01 * without[1] + 1e-6, "{height} m: {with:?}, {without:?}");
        }
    }
}

#[test]
fn the_tone_curve_of_the_shader_equals_that_of_the_cpu() {
    let Some(mut renderer) = shared_renderer() else { return };
    let camera = Camera { position: Vec3::new(0.0, 0.0, 4.0), aim: Aim::Point(Vec3::ZERO), ..Camera::default() };
    let empty = Scene { camera, ..Scene::default() };
    let per_cd_m2 = exposure::pixel_per_cd_s_m2(&empty) * empty.camera.shutter_s;
    for step in 0..24 {
        let value = 0.002 * 1.4_f32.powi(step);
        let glow = Material {
            base_color: [0.0; 3],
            ior: 1.0,
            emission_cd_m2: [value / per_cd_m2, 0.5 * value / per_cd_m2, 0.0],
            ..Material::default()
        };
        let card = Shape::Box { size_m: Vec3::ONE };
        let scene = Scene { objects: vec![object(0, card, Vec3::ZERO, glow)], ..empty.clone() };
        let picture = renderer.picture(&direct(&scene, (9, 9))).unwrap();
        let expected = color::display_srgb8([value, 0.5 * value, 0.0]);
        for (channel, (ours, theirs)) in picture.get_pixel(4, 4).0.iter().zip(expected).enumerate() {
            assert!(ours.abs_diff(theirs) <= 1, "{value} in channel {channel}: {ours} instead of {theirs}");
        }
    }
}

#[test]
fn a_texture_is_upright_and_filtered() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut assets = Assets::default();
    // Upper half red, lower half blue.
    let rgb = (0..64 * 64).map(|i| if i < 32 * 64 { [255, 0, 0] } else { [0, 0, 255] }).collect();
    assets.insert_texture(TextureRef::file("flag.png"), Arc::new(Texture::opaque(64, 64, rgb)));
    let cloth = Material { textures: MaterialTextures::with_base_color(TextureRef::file("flag.png")), ..grey_card() };
    let front = Vec3::new(0.0, 0.0, 4.0);
    let scene = Scene {
        camera: Camera { position: front, aim: Aim::Point(Vec3::ZERO), ..Camera::default() },
        objects: vec![object(0, Shape::Box { size_m: Vec3::splat(1.0) }, Vec3::ZERO, cloth)],
        lights: vec![light(0, front, Vec3::ZERO, Emitter::Point, Output::Lumens(1e6))],
        ..Scene::default()
    };
    let input =
        PreviewInput { options: Options::direct_only(), ..PreviewInput::camera_view(&scene, &assets, (90, 60)) };
    let picture = renderer.linear_picture(&input).unwrap();
    let at = |y: f32| {
        let place = input.frame.project(Vec3::new(0.2, y, 0.5)).unwrap() * Vec2::new(90.0, 60.0);
        picture.at(place.x as u32, place.y as u32)
    };
    let (above, below) = (at(0.3), at(-0.3));
    assert!(above[0] > 0.1 && above[2] < 1e-3 * above[0], "{above:?}");
    assert!(below[2] > 0.1 && below[0] < 1e-3 * below[2], "{below:?}");
}

#[test]
fn a_pick_returns_the_object_light_or_point_at_a_pixel() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut scene = floor_under(light(
        7,
        Vec3::new(0.0, 1.0, -2.0),
        Vec3::new(0.0, 1.0, 0.0),
        Emitter::RectPanel { width_m: 1.0, height_m: 1.0 },
        Output::Lumens(1000.0),
    ));
    scene.lights[0].visible_to_camera = true;
    scene.room = Some(Room { size_m: Vec3::new(13.0, 9.0, 13.0), ..Room::default() });
    scene.objects.push(object(3, Shape::Sphere { radius_m: 0.4 }, Vec3::new(1.5, 0.4, 1.0), grey_card()));
    scene.objects.push(object(
        4,
        Shape::Sphere { radius_m: 0.4 },
        Vec3::new(-1.5, 0.4, 1.0),
        MaterialPreset::ClearGlass.material(),
    ));
    let mut input = direct(&scene, (300, 200));
    renderer.render(&input).unwrap();
    let frame = input.frame;
    let pixel = move |point: Vec3| {
        let px = frame.project(point).unwrap() * Vec2::new(300.0, 200.0);
        (px.x as u32, px.y as u32)
    };
    let ball = Vec3::new(1.5, 0.4, 1.0);
    assert_eq!(renderer.pick_blocking(pixel(ball)).unwrap(), Some(Pick::Object(ObjectId(3))));
    assert_eq!(
        renderer.pick_blocking(pixel(-ball * Vec3::new(1.0, -1.0, -1.0))).unwrap(),
        Some(Pick::Object(ObjectId(4)))
    );
    assert_eq!(renderer.pick_blocking(pixel(Vec3::new(0.0, 1.0, -2.0))).unwrap(), Some(Pick::Light(LightId(7))));
    assert_eq!(renderer.pick_blocking(pixel(Vec3::new(0.0, 0.5, -6.4))).unwrap(), None, "a wall cannot be picked");
    assert_eq!(renderer.pick_blocking((300, 0)).unwrap(), None);

    let floor = Vec3::new(0.5, 0.0, 2.0);
    let hit = renderer.hit_blocking(pixel(floor)).unwrap().unwrap();
    assert_eq!(hit.pick, Some(Pick::Object(ObjectId(0))));
    assert!((hit.point.unwrap() - floor).length() < 0.05, "{hit:?}");

    renderer.request_pick(pixel(ball)).unwrap();
    renderer.gpu.device.poll(eframe::wgpu::PollType::wait_indefinitely()).unwrap();
    assert_eq!(renderer.poll_pick().unwrap().pick, Some(Pick::Object(ObjectId(3))));
    assert_eq!(renderer.poll_pick(), None);

    // A light that is invisible to the camera is picked by its gizmo
    scene.lights[0].visible_to_camera = false;
    input = direct(&scene, (300, 200));
    let corner = pixel(Vec3::new(0.5, 1.2, -2.0));
    renderer.render(&input).unwrap();
    assert_eq!(renderer.pick_blocking(corner).unwrap(), Some(Pick::Object(ObjectId(0))));
    input.overlay.light_gizmos = true;
    renderer.render(&input).unwrap();
    assert_eq!(renderer.pick_blocking(corner).unwrap(), Some(Pick::Light(LightId(7))));
}

#[test]
fn the_overlay_changes_the_picture_only_where_it_is_enabled() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut scene = floor_under(light(0, Vec3::Y * 3.0, Vec3::ZERO, Emitter::Point, Output::Lumens(9000.0)));
    scene.objects.push(object(1, Shape::Sphere { radius_m: 0.6 }, Vec3::Y * 0.6, grey_card()));
    let mut input = direct(&scene, (240, 160));
    let plain = renderer.picture(&input).unwrap();
    let mut differs = |overlay: Overlay| {
        input.overlay = overlay;
        let picture = renderer.picture(&input).unwrap();
        picture.pixels().zip(plain.pixels()).filter(|(a, b)| a != b).count()
    };
    assert_eq!(differs(Overlay::default()), 0);
    assert!(differs(Overlay { grid: true, ..Overlay::default() }) > 500);
    assert!(differs(Overlay { light_gizmos: true, ..Overlay::default() }) > 20);
    let outlined = differs(Overlay { selection: vec![Pick::Object(ObjectId(1))], ..Overlay::default() });
    // Two pixels around a disc of about 13 pixels radius.
    assert!((100..400).contains(&outlined), "{outlined} pixels of outline");
}

#[test]
fn a_renderer_with_caches_draws_the_same_picture_as_a_fresh_one() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.6 };
    let mut scene = floor_under(light(0, Vec3::new(1.0, 2.0, 1.0), Vec3::ZERO, panel, Output::Lumens(20_000.0)));
    scene.objects.push(object(1, Shape::Box { size_m: Vec3::splat(0.6) }, Vec3::Y * 0.3, grey_card()));
    let changes: [fn(&mut Scene); 7] = [
        |_| (),
        |scene| scene.lights[0].power.dial_stops = -1.0,
        |scene| scene.lights[0].position.x = -1.0,
        |scene| scene.objects[1].transform.position.x = 0.7,
        |scene| scene.objects[1].material.base_color = [0.7, 0.1, 0.1],
        |scene| scene.objects[1].material.transmission = 1.0,
        |scene| scene.objects[1].material.transmission = 0.0,
    ];
    for (step, change) in changes.into_iter().enumerate() {
        change(&mut scene);
        let kept = renderer.picture(&direct(&scene, (150, 100))).unwrap();
        let (_, mut fresh) = self::renderer().unwrap();
        assert_eq!(kept, fresh.picture(&direct(&scene, (150, 100))).unwrap(), "after change {step}");
    }
}

#[test]
fn any_size_and_degenerate_scenes_are_drawn() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let empty = Scene::default();
    for size in [(0, 0), (1, 1), (0, 7), (333, 1), (1, 333), (17, 31), (640, 3), (64, 64)] {
        let picture = renderer.picture(&direct(&empty, size)).unwrap();
        assert_eq!(picture.dimensions(), (size.0.max(1), size.1.max(1)));
    }
    let mut crowd = floor_under(light(0, Vec3::Y * 3.0, Vec3::ZERO, Emitter::Point, Output::Lumens(9000.0)));
    for i in 0..1000 {
        let place = Vec3::new((i % 32) as f32 * 0.2 - 3.0, 0.1, (i / 32) as f32 * 0.2 - 3.0);
        crowd.objects.push(object(i + 1, Shape::Box { size_m: Vec3::splat(0.1) }, place, grey_card()));
    }
    crowd.lights.extend((1..70).map(|i| {
        let place = Vec3::new(i as f32 * 0.1 - 3.0, 1.0, 0.0);
        light(i, place, Vec3::ZERO, Emitter::RectPanel { width_m: 0.1, height_m: 0.1 }, Output::Lumens(50.0))
    }));
    crowd.objects[5].transform.scale = Vec3::ZERO;
    crowd.objects[6].transform.position.x = f32::NAN;
    crowd.objects[7].transform.scale = Vec3::new(-1.0, 1.0, 1.0);
    crowd.lights[3].power.output = Output::Lumens(f32::INFINITY);
    crowd.lights[4].position = Vec3::ZERO;
    let overlay = Overlay {
        grid: true,
        light_gizmos: true,
        camera_gizmo: Some(f32::NAN),
        selection: crowd.objects.iter().map(|o| Pick::Object(o.id)).collect(),
        ..Overlay::default()
    };
    let input = PreviewInput { overlay, ..direct(&crowd, (97, 61)) };
    assert!(renderer.picture(&input).unwrap().pixels().any(|p| p.0 != [0; 3]));
    let linear = renderer.linear_picture(&input).unwrap();
    assert!(linear.rgb.iter().flatten().all(|c| c.is_finite()));
    let dark = Scene { lights: Vec::new(), ..crowd };
    let unlit = renderer.linear_picture(&direct(&dark, (97, 61))).unwrap();
    assert!(unlit.rgb.iter().flatten().all(|c| *c == 0.0));
}

#[test]
fn a_lost_device_is_an_error_and_a_new_one_works() {
    let Some((gpu, mut renderer)) = renderer() else { return };
    let scene = floor_under(light(0, Vec3::Y * 3.0, Vec3::ZERO, Emitter::Point, Output::Lumens(9000.0)));
    renderer.render(&direct(&scene, (32, 32))).unwrap();
    gpu.device.destroy();
    let _ = gpu.device.poll(eframe::wgpu::PollType::wait_indefinitely());
    let error = renderer.render(&direct(&scene, (48, 32))).map(|_| ()).unwrap_err();
    assert!(matches!(error, PreviewError::DeviceLost(_)), "{error}");
    assert!(renderer.pick_blocking((1, 1)).is_err() && renderer.request_pick((1, 1)).is_err());
    assert!(renderer.poll_pick().is_none());
    let (_gpu, mut renderer) = self::renderer().unwrap();
    renderer.render(&direct(&scene, (48, 32))).unwrap();
}

#[test]
fn the_overlay_alone_leaves_out_the_picture_and_keeps_picking() {
    let Some(mut renderer) = shared_renderer() else { return };
    let lamp = light(0, Vec3::new(1.5, 3.0, 1.0), Vec3::ZERO, Emitter::Point, Output::Lumens(20_000.0));
    let mut scene = floor_under(lamp);
    for (id, x, material) in [(1, -0.5, grey_card()), (2, 0.5, MaterialPreset::ClearGlass.material())] {
        scene.objects.push(object(id, Shape::Sphere { radius_m: 0.4 }, Vec3::new(x, 0.4, 0.0), material));
    }
    let mut input = direct(&scene, (151, 101));
    input.overlay.selection = vec![Pick::Object(ObjectId(1))];
    let whole = renderer.picture(&input).unwrap();
    input.options.overlay_alone = true;
    let alone = renderer.picture(&input).unwrap();
    let pixel = |point: Vec3| {
        let place = input.frame.project(point).unwrap() * Vec2::new(151.0, 101.0);
        (place.x as u32, place.y as u32)
    };
    let (ball, glass) = (pixel(Vec3::new(-0.5, 0.4, 0.0)), pixel(Vec3::new(0.5, 0.4, 0.0)));
    assert!(whole.get_pixel(ball.0, ball.1).0[1] > 20);
    for place in [ball, glass] {
        assert_eq!(alone.get_pixel(place.0, place.1).0, [0; 3], "no picture under the overlay");
    }
    let outlined = alone.pixels().filter(|pixel| pixel.0 != [0; 3]).count();
    assert!((20..2000).contains(&outlined), "{outlined} pixels of outline");
    assert_eq!(renderer.pick_blocking(ball).unwrap(), Some(Pick::Object(ObjectId(1))));
    assert_eq!(renderer.pick_blocking(glass).unwrap(), Some(Pick::Object(ObjectId(2))));
    input.options.overlay_alone = false;
    assert_eq!(renderer.picture(&input).unwrap(), whole, "the picture comes back");
}

/// A white plate that glows, turned by a few degrees, before black.
fn turned_plate() -> Scene {
    let glow = Material { base_color: [0.0; 3], ior: 1.0, emission_cd_m2: [100.0; 3], ..Material::default() };
    let mut plate = object(0, Shape::Box { size_m: Vec3::new(0.3, 0.3, 0.01) }, Vec3::ZERO, glow);
    plate.transform.rotation_deg.z = 7.0;
    let camera = Camera { position: Vec3::Z, aim: Aim::Point(Vec3::ZERO), ..Camera::default() };
    Scene { camera, objects: vec![plate], ..Scene::default() }
}

#[test]
fn a_still_picture_has_the_coverage_of_the_pixels_at_an_edge() {
    let Some(mut renderer) = shared_renderer() else { return };
    let (scene, size) = (turned_plate(), (48, 48));
    let still = renderer.still_picture(&direct(&scene, size), 64).unwrap();
    // The same at 16 times the resolution, averaged
    let fine = renderer.linear_picture(&direct(&scene, (48 * 16, 48 * 16))).unwrap();
    let coverage = |x: u32, y: u32| (0..256).map(|k| fine.at(x * 16 + k % 16, y * 16 + k / 16)[1]).sum::<f32>() / 256.0;
    let white = still.at(24, 24)[1];
    let (mut edges, mut worst) = (0, 0.0_f32);
    for (x, y) in (0..48).flat_map(|y| (0..48).map(move |x| (x, y))) {
        let (shown, expected) = (still.at(x, y)[1] / white, coverage(x, y) / white);
        edges += u32::from((0.02..0.98).contains(&expected));
        worst = worst.max((shown - expected).abs());
    }
    // 64 points of a sequence of low discrepancy estimate the area of a half-plane in a pixel to a few hundredths.
    assert!(edges > 30 && worst < 0.06, "{worst} of white in {edges} pixels");
}

#[test]
fn samples_that_are_averaged_on_the_gpu_equal_their_mean() {
    let Some(mut renderer) = shared_renderer() else { return };
    let (scene, size) = (turned_plate(), (48, 48));
    let mut input = direct(&scene, size);
    let mut shown = None;
    for sample in 0..4 {
        input.options.sample = sample;
        shown = Some(renderer.picture(&input).unwrap());
    }
    let (shown, mean) = (shown.unwrap(), renderer.still_picture(&direct(&scene, size), 4).unwrap());
    for (pixel, linear) in shown.pixels().zip(&mean.rgb) {
        // The plate is under the shoulder of the tone curve, which the average would not commute with.
        let expected = color::srgb_encode(linear[1].min(1.0)) * 255.0;
        assert!((f32::from(pixel.0[1]) - expected).abs() < 2.5, "{} for {expected}", pixel.0[1]);
    }
}

#[test]
fn scopes_agree_between_preview_traced_view_and_final_picture() {
    let Some(mut renderer) = shared_renderer() else { return };
    // A grey card that is lit as the camera is set for, one of twice and one of a quarter of its reflectance
    let mut scene =
        Scene { camera: Camera { position: Vec3::new(0.0, 1.0, 3.0), ..Camera::default() }, ..Scene::default() };
    scene.camera.aim = Aim::Point(Vec3::new(0.0, 1.0, 0.0));
    scene.camera.focal_length_mm = 50.0;
    for (index, reflectance) in [0.045_f32, 0.18, 0.36].into_iter().enumerate() {
        let shape = Shape::Box { size_m: Vec3::new(0.2, 0.3, 0.01) };
        let position = Vec3::new(0.3 * (index as f32 - 1.0), 1.0, 0.0);
        let material = Material { base_color: [reflectance; 3], ..grey_card() };
        scene.objects.push(object(index as u32, shape, position, material));
    }
    // E = pi L / reflectance: a card of 18 % is middle grey where a white one has the value 1
    let lux_s = PI / exposure::pixel_per_cd_s_m2(&scene);
    let distance_m = 20.0;
    let candela = lux_s / scene.camera.shutter_s * distance_m * distance_m;
    let position = Vec3::new(0.0, 1.0, distance_m);
    scene.lights.push(light(0, position, Vec3::new(0.0, 1.0, 0.0), Emitter::Point, Output::Candela(candela)));
    let (width, height) = scene.camera.picture_size(240);
    let assets = Assets::default();

    let preview = renderer.linear_picture(&PreviewInput::camera_view(&scene, &assets, (width, height))).unwrap();
    let control = raytrace::RenderControl::new();
    let mut live = raytrace::LivePicture::default();
    let frame = scene.camera_frame(width as f32 / height as f32);
    live.update(&scene, &assets, raytrace::LiveCamera::pinhole(frame, (width, height))).unwrap();
    while !live.is_converged() {
        live.trace(100_000, &control);
    }
    let settings = raytrace::Settings { width, height, spp: 32, ..raytrace::Settings::default() };
    let prepared = raytrace::prepare(&scene, &assets).unwrap();
    let film = raytrace::render(&prepared, &settings, &control, &mut |_| std::ops::ControlFlow::Continue(()));
    let pictures = [("preview", preview), ("traced view", live.develop(&scene)), ("picture", film.develop(&scene))];
    for (name, picture) in pictures {
        let bands = PictureDisplay::FalseColor.to_srgb8(&picture);
        for (object, stops) in scene.objects.iter().zip([-2.0, 0.0, 1.0]) {
            let place = frame.project(object.transform.position).unwrap() * Vec2::new(width as f32, height as f32);
            let (x, y) = (place.x as u32, place.y as u32);
            let spot = Spot::around((x, y), (width, height), |x, y| picture.at(x, y));
            assert!((spot.stops() - stops).abs() < 0.02, "{name}: {} for {stops} stops", spot.stops());
            assert_eq!(bands[(y * width + x) as usize], false_color(stops), "{name}");
        }
    }
}
