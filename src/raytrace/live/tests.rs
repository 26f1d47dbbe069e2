//! Tests of the samples that the live view keeps and discards, and of its convergence to a render.

use super::*;
use crate::raytrace::geometry::PassedBodies;
use crate::raytrace::{Settings, render};
use crate::scene::{
    Aim, Asset, AssetKey, Camera, CameraFrame, Emitter, Light, Material, Object, ObjectId, Output, Room, Shape, Tank,
    Transform, tessellate,
};
use glam::Affine3A;
use std::borrow::Cow;
use std::ops::ControlFlow;

const SIZE: (u32, u32) = (60, 40);

fn object(id: u32, shape: Shape, position: Vec3, material: Material) -> Object {
    let transform = Transform::at(position);
    let name = format!("Thing {id}");
    Object { id: ObjectId(id), name, transform, shape, material, part_materials: vec![], visible: true, locked: false }
}

fn matte() -> Material {
    Material { base_color: [0.5; 3], roughness: 0.9, ..Material::default() }
}

/// Returns a ball of a material before a grey wall, under two lights, without a room.
fn studio(ball: Material) -> Scene {
    let wall = Shape::Box { size_m: Vec3::new(8.0, 6.0, 0.2) };
    let light = |id: u32, x: f32| Light {
        id: LightId(id),
        name: format!("Lamp {id}"),
        position: Vec3::new(x, 2.0, 3.0),
        aim: Aim::Point(Vec3::ZERO),
        ..Light::new(Emitter::RectPanel { width_m: 0.6, height_m: 0.6 }, Output::Lumens(9000.0))
    };
    Scene {
        camera: Camera { position: Vec3::Z * 4.0, aim: Aim::Point(Vec3::ZERO), ..Camera::default() },
        objects: vec![
            object(0, wall, Vec3::Z * -1.0, matte()),
            object(1, Shape::Sphere { radius_m: 0.5 }, Vec3::ZERO, ball),
        ],
        lights: vec![light(0, 2.0), light(1, -2.5)],
        ..Scene::default()
    }
}

/// Returns the scene's camera, moved sideways.
fn view(scene: &Scene, aside_m: f32) -> LiveCamera {
    let mut frame: CameraFrame = scene.camera_frame(1.5);
    frame.world_from_camera = Affine3A::from_translation(Vec3::X * aside_m) * frame.world_from_camera;
    LiveCamera::pinhole(frame, SIZE)
}

fn started(scene: &Scene) -> LivePicture {
    let mut live = LivePicture::default();
    live.update(scene, &Assets::default(), view(scene, 0.0)).unwrap();
    live
}

/// Traces until every tile has completed so many steps.
fn trace_to(live: &mut LivePicture, steps: u32) {
    let least =
        |live: &LivePicture| live.view.as_ref().unwrap().film.tiles.iter().map(|t| t.progress.completed()).min();
    while !live.is_converged() && least(live) < Some(steps) {
        live.trace(1, &RenderControl::new());
    }
}

/// Steps until every pixel is traced or reprojected, and until every pixel has its primary hit.
const ALL_TRACED: u32 = 8;
const ALL_HITS: u32 = 5;

fn converge(live: &mut LivePicture) {
    while live.trace(1 << 20, &RenderControl::new()) > 0 {}
    assert!(live.is_converged());
}

/// Renders the picture of a view.
fn reference(scene: &Scene, camera: &LiveCamera, spp: u32) -> Picture {
    let mut seen = scene.clone();
    seen.camera.position = camera.frame.position();
    seen.camera.aim = Aim::Point(camera.frame.position() + 4.0 * camera.frame.forward());
    let settings = Settings { width: SIZE.0, height: SIZE.1, spp, ..Settings::default() };
    let prepared = prepare::prepare(&seen, &Assets::default()).unwrap();
    render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(())).develop(&seen)
}

fn mean(picture: &Picture) -> f32 {
    picture.rgb.iter().flatten().sum::<f32>() / (3 * picture.rgb.len()) as f32
}

/// Root mean square difference over the mean.
fn difference(a: &Picture, b: &Picture) -> f32 {
    let square: f32 = a.rgb.iter().flatten().zip(b.rgb.iter().flatten()).map(|(a, b)| (a - b).powi(2)).sum();
    (square / (3 * a.rgb.len()) as f32).sqrt() / mean(b)
}

/// Asserts that two pictures differ by no more than the noise of converged tiles: 0.06 stops, 4 %, in each pixel.
fn assert_same(live_view: &Picture, rendered: &Picture) {
    let (off, brightness) = (difference(live_view, rendered), mean(live_view) / mean(rendered));
    assert!(off < 0.045, "{off} off, {brightness} times as bright");
}

/// Returns the number of pixels of an object, and how many of them were reprojected. Valid after [`ALL_HITS`] steps.
fn pixels_of(live: &LivePicture, object: u32) -> (usize, usize) {
    let film = &live.view.as_ref().unwrap().film;
    let all = film.tiles.iter().flat_map(|tile| (0..tile.pixels()).map(move |pixel| (tile, pixel)));
    // Pixels of the coarse grid without a history were traced: they have the weight of one path.
    let of_object = all.filter(|(tile, pixel)| tile.primary_hits[*pixel].object == object);
    of_object.fold((0, 0), |(count, reprojected), (tile, pixel)| {
        (count + 1, reprojected + usize::from(tile.sums.at(0, pixel).w > 1.0))
    })
}

#[test]
fn caustics_of_a_point_light_through_a_glass_ball_agree_with_a_render() {
    let mut scene = studio(Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ..Material::default() });
    scene.lights.truncate(1);
    (scene.lights[0].emitter, scene.lights[0].power.output) = (Emitter::Point, Output::Lumens(2e6));
    // Behind the ball, seen from the light.
    scene.objects[1].transform.position = Vec3::new(0.4, 0.4, -0.2);
    let camera = view(&scene, 0.0);
    let mut live = started(&scene);
    trace_to(&mut live, ALL_TRACED + 2);
    // The caustics of an added light are traced alone.
    let name = "Other".to_owned();
    scene.lights.push(Light { id: LightId(7), name, position: Vec3::new(-2.0, 1.0, 3.0), ..scene.lights[0].clone() });
    live.update(&scene, &Assets::default(), camera).unwrap();
    converge(&mut live);
    let (live_view, rendered) = (live.develop(&scene), reference(&scene, &camera, 128));
    assert!((mean(&live_view) / mean(&rendered) - 1.0).abs() < 0.01, "{} for {}", mean(&live_view), mean(&rendered));
    // Caustics are the pixels brighter than any pixel without the ball. The sharpness of their foci depends on the
    // samples.
    scene.objects[1].visible = false;
    let open = reference(&scene, &camera, 16).rgb.iter().map(|rgb| rgb[1]).fold(0.0, f32::max);
    let caustics = |picture: &Picture| picture.rgb.iter().map(|rgb| rgb[1]).filter(|g| *g > 1.5 * open).sum::<f32>();
    let (live_view, rendered) = (caustics(&live_view), caustics(&rendered));
    assert!(
        rendered > 20.0 * open && (live_view / rendered - 1.0).abs() < 0.1,
        "{live_view} for {rendered}, beside {open}"
    );
}

#[test]
fn it_converges_to_the_picture_of_a_render() {
    let scene = studio(Material::default());
    let mut live = started(&scene);
    converge(&mut live);
    let (live_view, rendered) = (live.develop(&scene), reference(&scene, &view(&scene, 0.0), 256));
    // A converged tile is within 0.06 stops, 4 %, of the reference in each pixel; the mean of thousands of pixels is
    // closer.
    assert_same(&live_view, &rendered);
    assert!((mean(&live_view) / mean(&rendered) - 1.0).abs() < 0.005, "{} for {}", mean(&live_view), mean(&rendered));
    assert_eq!((live.trace(1000, &RenderControl::new()), live.nonfinite().count), (0, 0), "every tile is converged");
}

#[test]
fn the_first_coarse_picture_has_the_mean_of_the_converged_one() {
    let scene = studio(matte());
    let mut live = started(&scene);
    assert!(!live.has_picture());
    trace_to(&mut live, 2);
    assert_eq!(live.stride(), Some(8));
    let coarse = live.develop(&scene);
    converge(&mut live);
    let fine = live.develop(&scene);
    assert!((mean(&coarse) / mean(&fine) - 1.0).abs() < 0.15, "{} for {}", mean(&coarse), mean(&fine));
    let dark = coarse.rgb.iter().filter(|rgb| rgb[1] <= 0.0).count();
    assert!(dark < 40, "{dark} black pixels: pixels without a value are interpolated");
}

#[test]
fn a_small_pan_reprojects_most_of_a_matte_scene_correctly() {
    let scene = studio(matte());
    let mut live = started(&scene);
    converge(&mut live);
    let moved = view(&scene, 0.1);
    live.update(&scene, &Assets::default(), moved).unwrap();
    trace_to(&mut live, ALL_HITS);
    assert!(live.reprojected_fraction() > 0.8, "{} of the pixels", live.reprojected_fraction());
    trace_to(&mut live, ALL_TRACED);
    let (live_view, rendered) = (live.develop(&scene), reference(&scene, &moved, 256));
    // The noise is that of one path at the ball's former edge, and that of converged tiles elsewhere.
    let off = difference(&live_view, &rendered);
    assert!(off < 0.1, "{off}");
    assert!((mean(&live_view) / mean(&rendered) - 1.0).abs() < 0.01, "{} for {}", mean(&live_view), mean(&rendered));
}

#[test]
fn land_keeps_its_samples_when_water_moves_on_and_water_is_traced_anew() {
    // In place of a simulation: a matte wall, and a clear box before it that rises
    let tank_at = |time_s: f32| Tank { time_s, ..Tank::default() };
    let mut assets = Assets::default();
    for time_s in [0.0, 1.0] {
        let part = |shape: Shape, offset: Vec3, name: &str| {
            let mut mesh = tessellate(&shape).unwrap().with_single_part(name);
            mesh.positions.iter_mut().for_each(|position| *position += offset);
            mesh
        };
        let mut mesh = part(Shape::Box { size_m: Vec3::new(8.0, 6.0, 0.2) }, Vec3::Z * -1.0, "ground");
        let rise = Vec3::new(0.0, -0.4 + 0.3 * time_s, 0.0);
        mesh.append(&part(Shape::Box { size_m: Vec3::new(0.8, 0.6, 0.3) }, rise, "water"));
        assets.insert(AssetKey::tank(Cow::Owned(tank_at(time_s))), Asset::Tank(Arc::new(mesh)));
    }
    let mut scene = studio(matte());
    let water = Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ..Material::default() };
    scene.objects = vec![Object {
        part_materials: vec![("water".to_owned(), water)],
        ..object(0, Shape::Tank(Box::new(tank_at(0.0))), Vec3::ZERO, matte())
    }];
    let mut live = LivePicture::default();
    live.update(&scene, &assets, view(&scene, 0.0)).unwrap();
    trace_to(&mut live, ALL_TRACED + 8);
    scene.objects[0].shape = Shape::Tank(Box::new(tank_at(1.0)));
    live.update(&scene, &assets, view(&scene, 0.0)).unwrap();
    trace_to(&mut live, ALL_HITS);
    let film = &live.view.as_ref().unwrap().film;
    let pixels = film.tiles.iter().flat_map(|tile| (0..tile.pixels()).map(move |pixel| (tile, pixel)));
    let (mut land, mut kept, mut water, mut stale) = (0, 0, 0, 0);
    for (tile, pixel) in pixels {
        let weight = tile.sums.at(0, pixel).w;
        assert!(weight <= FLOW_WEIGHT, "{weight}");
        if tile.primary_hits[pixel].alpha < 0.0 {
            (water, stale) = (water + 1, stale + usize::from(weight > 1.0));
        } else {
            (land, kept) = (land + 1, kept + usize::from(weight > 1.0));
        }
    }
    assert!(water > 30 && stale == 0, "{stale} of {water} pixels of water have old light");
    assert!(kept > land * 3 / 4, "{kept} of {land} pixels of land");
    // It converges to the light of a view that never saw the water elsewhere
    converge(&mut live);
    let mut fresh = LivePicture::default();
    fresh.update(&scene, &assets, view(&scene, 0.0)).unwrap();
    converge(&mut fresh);
    let brightness = mean(&live.develop(&scene)) / mean(&fresh.develop(&scene));
    assert!((brightness - 1.0).abs() < 0.02, "{brightness}");
    // Anything else discards the samples
    scene.objects[0].transform.position.x += 0.1;
    live.update(&scene, &assets, view(&scene, 0.0)).unwrap();
    assert!(live.history.is_none() && !live.has_picture());
}

#[test]
fn disoccluded_pixels_are_traced() {
    let scene = studio(matte());
    let mut live = started(&scene);
    converge(&mut live);
    let old_eye = view(&scene, 0.0).frame.position();
    live.update(&scene, &Assets::default(), view(&scene, 0.4)).unwrap();
    trace_to(&mut live, ALL_HITS);
    let traced = live.prepared.as_ref().unwrap();
    let mut caster = crate::raytrace::ray_caster::RayCaster::new(&traced.full);
    let (mut hidden, mut wrong) = (0, 0);
    for tile in &live.view.as_ref().unwrap().film.tiles {
        for (pixel, hit) in tile.primary_hits.iter().enumerate().filter(|(_, hit)| hit.object == 0) {
            let from = old_eye - traced.origin;
            let to = hit.position - from;
            if caster.occluded(from, to.normalize(), 0.99 * to.length(), PassedBodies::None) {
                hidden += 1;
                wrong += usize::from(tile.sums.at(0, pixel).w > 1.0);
            }
        }
    }
    assert!(hidden > 20 && wrong == 0, "{wrong} of {hidden} disoccluded pixels were reprojected");
    let (wall, reprojected) = pixels_of(&live, 0);
    assert!(reprojected * 2 > wall, "{reprojected} of {wall} pixels of the wall are reprojected");
}

#[test]
fn mirrors_and_glass_are_traced_and_the_weight_of_gloss_falls_with_the_view_angle() {
    let smooth = Material { roughness: 0.0, metallic: 1.0, base_color: [0.9; 3], ..Material::default() };
    let glass = Material { base_color: [1.0; 3], roughness: 0.0, transmission: 1.0, ..Material::default() };
    let glossy = Material { roughness: 0.3, ..matte() };
    let reprojected_weight = |ball: &Material, aside_m: f32| {
        let scene = studio(ball.clone());
        let mut live = started(&scene);
        trace_to(&mut live, ALL_TRACED + 20);
        live.update(&scene, &Assets::default(), view(&scene, aside_m)).unwrap();
        trace_to(&mut live, ALL_HITS);
        let film = &live.view.as_ref().unwrap().film;
        let weights = film.tiles.iter().flat_map(|tile| {
            (0..tile.pixels())
                .filter(|p| tile.primary_hits[*p].object == 1)
                .map(|p| (tile.sums.at(0, p).w - 1.0).max(0.0))
        });
        let weights: Vec<f32> = weights.collect();
        weights.iter().sum::<f32>() / weights.len() as f32
    };
    assert_eq!((reprojected_weight(&smooth, 0.1), reprojected_weight(&glass, 0.1)), (0.0, 0.0));
    let (near, farther, far) =
        (reprojected_weight(&glossy, 0.05), reprojected_weight(&glossy, 0.2), reprojected_weight(&glossy, 0.6));
    assert!(near > farther && farther > far && far == 0.0, "{near} {farther} {far}");
    assert!(reprojected_weight(&matte(), 0.2) > farther);
}

#[test]
fn errors_of_the_history_fade_with_the_number_of_samples() {
    let scene = studio(matte());
    let mut live = started(&scene);
    trace_to(&mut live, ALL_TRACED + 30);
    live.update(&scene, &Assets::default(), view(&scene, 0.05)).unwrap();
    live.history.as_mut().unwrap().distort(3.0);
    trace_to(&mut live, ALL_TRACED);
    let rendered = reference(&scene, &view(&scene, 0.05), 64);
    let start = mean(&live.develop(&scene)) / mean(&rendered) - 1.0;
    assert!(start > 1.2, "three times as bright where it is reprojected: {start}");
    for samples in [16, 64, 240] {
        let target = ALL_TRACED + samples;
        while live.view.as_ref().unwrap().film.tiles.iter().any(|t| t.progress.kept < target) {
            // Converged tiles take more samples, too: the noise estimate leaves the history out.
            live.view.as_mut().unwrap().film.tiles.iter_mut().for_each(LiveTile::reactivate);
            live.trace(1, &RenderControl::new());
        }
        let wrong = mean(&live.develop(&scene)) / mean(&rendered) - 1.0;
        let expected = 2.0 * MAX_WEIGHT / (MAX_WEIGHT + samples as f32);
        assert!(wrong < 1.1 * expected + 0.01, "{wrong} after {samples} samples, {expected} expected at most");
    }
}

#[test]
fn a_moved_object_discards_all_samples() {
    let mut scene = studio(matte());
    let mut live = started(&scene);
    converge(&mut live);
    scene.objects[1].transform.position.x += 0.3;
    live.update(&scene, &Assets::default(), view(&scene, 0.0)).unwrap();
    assert!(!live.has_picture() && live.history.is_none());
    converge(&mut live);
    let (live_view, rendered) = (live.develop(&scene), reference(&scene, &view(&scene, 0.0), 256));
    assert_same(&live_view, &rendered);
    assert_eq!(live.reprojected_fraction(), 0.0);
}

#[test]
fn power_colour_and_switch_of_a_light_trace_no_ray() {
    let mut scene = studio(matte());
    let mut live = started(&scene);
    converge(&mut live);
    let (control, from_here) = (RenderControl::new(), view(&scene, 0.0));
    let mut edited = |edit: &dyn Fn(&mut Scene)| {
        edit(&mut scene);
        live.update(&scene, &Assets::default(), from_here).unwrap();
        assert_eq!((live.trace(1 << 20, &control), control.rays()), (0, 0));
        mean(&live.develop(&scene))
    };
    let bright = edited(&|_| {});
    let dimmed = edited(&|scene| scene.lights.iter_mut().for_each(|light| light.power.dial_stops = -1.0));
    assert!((dimmed / bright - 0.5).abs() < 1e-5, "a stop down: {dimmed} of {bright}");
    let one = edited(&|scene| scene.lights[0].on = false);
    let other = edited(&|scene| (scene.lights[0].on, scene.lights[1].on) = (true, false));
    assert!(((one + other) / dimmed - 1.0).abs() < 1e-5, "{one} + {other} = {dimmed}");
    edited(&|scene| scene.lights[0].color.source = crate::scene::ColorSource::Kelvin(3200.0));
    edited(&|scene| (scene.camera.iso, scene.camera.f_number, scene.camera.shutter_s) = (400.0, 8.0, 0.1));
    let unfiltered = edited(&|_| {});
    let filtered = edited(&|scene| scene.camera.nd_stops = 3.0);
    assert!((filtered / unfiltered - 0.125).abs() < 1e-6, "3 stops of ND: {filtered} of {unfiltered}");
    edited(&|scene| scene.camera.position.x += 1.0);
    edited(&|scene| scene.objects[0].name = "Backdrop".to_owned());
    // A light that is off can move away and back.
    edited(&|scene| scene.lights[1].position.y += 1.0);
    edited(&|scene| scene.lights[1].position.y -= 1.0);
    let both = edited(&|scene| scene.lights[1].on = true);
    assert!(both > 0.0);
}

#[test]
fn a_moved_light_is_traced_alone_and_the_others_keep_their_samples() {
    let mut scene = studio(matte());
    let mut live = started(&scene);
    converge(&mut live);
    let sums = |live: &LivePicture, layer: usize| -> Vec<glam::Vec4> {
        let film = &live.view.as_ref().unwrap().film;
        film.tiles.iter().flat_map(|t| (0..t.pixels()).map(move |p| t.sums.at(layer, p))).collect()
    };
    let others = sums(&live, 1);
    scene.lights[0].power.dial_stops = -1.0;
    scene.lights[0].position.x -= 0.8;
    live.update(&scene, &Assets::default(), view(&scene, 0.0)).unwrap();
    assert_eq!(live.prepared.as_ref().unwrap().retraced.as_ref().unwrap().lights, [LightId(0)]);
    trace_to(&mut live, 2);
    // The first picture of the moved light is coarse; that of the other light keeps its samples.
    let first = live.develop(&scene);
    scene.lights[0].position.x -= 0.1;
    live.update(&scene, &Assets::default(), view(&scene, 0.0)).unwrap();
    converge(&mut live);
    assert!(sums(&live, 1) == others, "the other light was traced again");
    let (live_view, rendered) = (live.develop(&scene), reference(&scene, &view(&scene, 0.0), 256));
    assert_same(&live_view, &rendered);
    assert!((mean(&first) / mean(&rendered) - 1.0).abs() < 0.2, "{} for {}", mean(&first), mean(&rendered));
    // An added and a removed light.
    let mut third = scene.lights[1].clone();
    (third.id, third.name, third.position) = (LightId(7), "Third".to_owned(), Vec3::new(0.0, 3.0, 2.0));
    scene.lights.insert(0, third);
    live.update(&scene, &Assets::default(), view(&scene, 0.0)).unwrap();
    converge(&mut live);
    assert!(sums(&live, 2) == others);
    scene.lights.remove(1);
    live.update(&scene, &Assets::default(), view(&scene, 0.0)).unwrap();
    assert_eq!(live.trace(1 << 20, &RenderControl::new()), 0);
    let (live_view, rendered) = (live.develop(&scene), reference(&scene, &view(&scene, 0.0), 256));
    assert_same(&live_view, &rendered);
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let scene = studio(Material::default());
    let picture = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut live = started(&scene);
            trace_to(&mut live, ALL_TRACED + 2);
            live.update(&scene, &Assets::default(), view(&scene, 0.1)).unwrap();
            trace_to(&mut live, ALL_TRACED + 2);
            live.develop(&scene)
        })
    };
    assert_eq!(picture(1), picture(3));
}

#[test]
fn every_input_gives_finite_pixels() {
    let scene = studio(Material::default());
    let no_assets = Assets::default();
    let mut live = LivePicture::default();
    assert_eq!(
        (live.trace(10, &RenderControl::new()), live.is_converged(), live.develop(&scene)),
        (0, true, Picture::default())
    );
    let mut wrong = scene.clone();
    wrong.camera.focal_length_mm = f32::NAN;
    let frame = scene.camera_frame(1.5);
    assert!(live.update(&wrong, &no_assets, LiveCamera::pinhole(frame, SIZE)).is_err());
    for size in [(0, 0), (1, 1), (33, 1), (31, 65)] {
        live.update(&scene, &no_assets, LiveCamera::pinhole(frame, size)).unwrap();
        live.trace(3000, &RenderControl::new());
        let picture = live.develop(&scene);
        assert_eq!((picture.width, picture.height), (size.0.max(1), size.1.max(1)));
        assert!(picture.rgb.iter().flatten().all(|value| value.is_finite()));
    }
    let cancelled = RenderControl::new();
    cancelled.cancel();
    live.update(&scene, &no_assets, LiveCamera::pinhole(frame, SIZE)).unwrap();
    assert_eq!((live.trace(1000, &cancelled), live.has_picture()), (0, false));
    // Without lights, with many lights, with depth of field, from far away, with everything moved at once.
    let dark = Scene { lights: Vec::new(), ..scene.clone() };
    let mut many = scene.clone();
    many.lights = (0..40).map(|i| Light { id: LightId(i), ..scene.lights[0].clone() }).collect();
    for (i, light) in many.lights.iter_mut().enumerate() {
        light.name = format!("Light {i}");
    }
    let mut blurred = scene.clone();
    (blurred.camera.depth_of_field, blurred.camera.f_number) = (true, 1.4);
    let mut far = scene.clone();
    far.room = Some(Room::default());
    for scene in [&dark, &many, &blurred, &many, &far, &dark, &scene] {
        for aside_m in [0.0, 0.1, 100.0] {
            let mut camera = view(scene, aside_m);
            if scene.camera.depth_of_field {
                camera = LiveCamera::through_lens(scene, camera.frame, SIZE);
            }
            live.update(scene, &no_assets, camera).unwrap();
            live.trace(6000, &RenderControl::new());
            let picture = live.develop(scene);
            assert!(picture.rgb.iter().flatten().all(|value| value.is_finite()));
        }
    }
    assert_eq!(live.nonfinite().count, 0);
}

#[test]
fn out_of_focus_pixels_are_blurred_and_never_reprojected() {
    let mut scene = studio(matte());
    (scene.camera.depth_of_field, scene.camera.f_number, scene.camera.focal_length_mm) = (true, 1.4, 135.0);
    let camera = |aside_m: f32| LiveCamera::through_lens(&scene, view(&scene, aside_m).frame, SIZE);
    let mut live = LivePicture::default();
    live.update(&scene, &Assets::default(), camera(0.0)).unwrap();
    converge(&mut live);
    let (live_view, rendered) = (live.develop(&scene), reference(&scene, &view(&scene, 0.0), 256));
    assert!(difference(&live_view, &rendered) < 0.05, "{}", difference(&live_view, &rendered));
    live.update(&scene, &Assets::default(), camera(0.05)).unwrap();
    trace_to(&mut live, ALL_HITS);
    assert_eq!(live.reprojected_fraction(), 0.0);
}
