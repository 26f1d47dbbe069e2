//! Tests of the live preview: closed forms, the path tracer's layout and direct light, picking, overlays and caching.
//!
//! Without a GPU adapter these tests print that they are skipped and pass; with `CATCHLIGHT_REQUIRE_GPU` set they fail.
#![cfg(feature = "gui")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so by panicking")]
#![allow(clippy::print_stderr, clippy::print_stdout, reason = "measurements and skipped tests are reported")]

use adapter::headless_gpu;
use catchlight::color;
use catchlight::io::Loaded;
use catchlight::photo::{Picture, exposure};
use catchlight::preview::{Gpu, Options, Overlay, Pick, PreviewError, PreviewInput, PreviewRenderer};
use catchlight::raytrace;
use catchlight::scene::{
    Aim, Assets, Camera, CameraFrame, Emitter, Light, LightId, Material, MaterialPreset, MaterialTextures, Object,
    ObjectId, Output, Room, Scene, Shape, Texture, TextureRef, Transform,
};
use glam::{Vec2, Vec3};
use people::{coarse_and_hairless, hairless, shipped};
use std::f32::consts::PI;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

#[path = "../studio/adapter.rs"]
mod adapter;
mod against_tracer;
mod bodies;
mod bounced_light;
mod channels;
mod closed_forms;
mod drafts;
mod each_light;
mod environment;
mod hair;
mod layers;
mod lens;
mod measured_light;
#[path = "../studio/people.rs"]
mod people;
mod picture;
mod room;
mod shadow_cache;
mod soft_surfaces;
mod stored;
#[path = "../studio/strands.rs"]
mod strands;
mod texture_maps;
mod textures;
mod thin_shadows;

/// Returns a renderer on a device of its own, or none with a message if the machine has no adapter.
fn renderer() -> Option<(Gpu, PreviewRenderer)> {
    let gpu = headless_gpu()?;
    let renderer = PreviewRenderer::new(&gpu.device, &gpu.queue).unwrap();
    Some((gpu, renderer))
}

/// A renderer whose device and pipelines several tests use, one after the other.
struct SharedRenderer {
    gpu: Gpu,
    renderer: PreviewRenderer,
}

impl std::ops::Deref for SharedRenderer {
    type Target = PreviewRenderer;

    fn deref(&self) -> &PreviewRenderer {
        &self.renderer
    }
}

impl std::ops::DerefMut for SharedRenderer {
    fn deref_mut(&mut self) -> &mut PreviewRenderer {
        &mut self.renderer
    }
}

/// Returns the renderer that tests share: compiling the pipelines takes longer than most of them. For tests that do not
/// depend on what earlier frames left in its caches.
fn shared_renderer() -> Option<MutexGuard<'static, SharedRenderer>> {
    static SHARED: LazyLock<Option<Mutex<SharedRenderer>>> =
        LazyLock::new(|| renderer().map(|(gpu, renderer)| Mutex::new(SharedRenderer { gpu, renderer })));
    // A test that failed while it held the lock leaves a renderer that still works.
    SHARED.as_ref().map(|shared| shared.lock().unwrap_or_else(PoisonError::into_inner))
}

/// A Lambertian surface of 18 % without specular reflection: pixels are illuminance times a known factor.
fn grey_card() -> Material {
    MaterialPreset::GreyCard.material()
}

fn object(id: u32, shape: Shape, position: Vec3, material: Material) -> Object {
    Object {
        id: ObjectId(id),
        transform: Transform::at(position),
        material,
        ..Object::new(format!("Object {id}"), shape)
    }
}

fn light(id: u32, position: Vec3, target: Vec3, emitter: Emitter, output: Output) -> Light {
    let (id, name) = (LightId(id), format!("Light {id}"));
    Light { id, name, position, aim: Aim::Point(target), ..Light::new(emitter, output) }
}

/// A grey card floor and one light without a room; the camera looks at the centre of the floor from the side.
fn floor_under(light: Light) -> Scene {
    let floor = Shape::Plane { width_m: 12.0, depth_m: 12.0 };
    Scene {
        camera: Camera {
            position: Vec3::new(0.0, 6.0, 6.0),
            aim: Aim::Point(Vec3::ZERO),
            focal_length_mm: 24.0,
            iso: 100.0,
            f_number: 4.0,
            shutter_s: 0.5,
            ..Camera::default()
        },
        objects: vec![object(0, floor, Vec3::ZERO, grey_card())],
        lights: vec![light],
        ..Scene::default()
    }
}

fn direct(scene: &Scene, size: (u32, u32)) -> PreviewInput<'_> {
    let no_assets: &'static Assets = Box::leak(Box::default());
    PreviewInput { options: Options::direct_only(), ..PreviewInput::camera_view(scene, no_assets, size) }
}

/// Returns the scene-linear luminance at a world point, bilinearly interpolated.
fn luminance_at(picture: &Picture, frame: &CameraFrame, point: Vec3) -> f32 {
    let size = Vec2::new(picture.width as f32, picture.height as f32);
    let position_px = frame.project(point).unwrap() * size - 0.5;
    let (corner, part) = (position_px.floor().as_uvec2(), position_px.fract());
    let at = |x: u32, y: u32| color::luminance(picture.at(corner.x + x, corner.y + y).into());
    let row = |y: u32| at(0, y) + (at(1, y) - at(0, y)) * part.x;
    row(0) + (row(1) - row(0)) * part.y
}

/// Returns the illuminance at a point of a grey card, lx.
fn lux_at(renderer: &mut PreviewRenderer, scene: &Scene, point: Vec3) -> f32 {
    lux_of(renderer, &direct(scene, (301, 201)), point)
}

/// Returns the illuminance at a point of a grey card without shadows, lx.
fn unshadowed_lux_at(renderer: &mut PreviewRenderer, scene: &Scene, point: Vec3) -> f32 {
    let mut input = direct(scene, (301, 201));
    input.options.shadows = false;
    lux_of(renderer, &input, point)
}

fn lux_of(renderer: &mut PreviewRenderer, input: &PreviewInput, point: Vec3) -> f32 {
    let picture = renderer.linear_picture(input).unwrap();
    let per_lux = exposure::pixel_per_cd_s_m2(input.scene) * input.scene.camera.shutter_s * 0.18 / PI;
    luminance_at(&picture, &input.frame, point) / per_lux
}

fn assert_close(actual: f32, expected: f32, tolerance: f32, what: &str) {
    let error = actual / expected - 1.0;
    assert!(error.abs() <= tolerance, "{what}: {actual} instead of {expected}, off by {:.2} %", error * 100.0);
}

/// Returns the floor point at a pixel's centre; none above the horizon.
fn floor_at(frame: &CameraFrame, size: (u32, u32), (x, y): (u32, u32)) -> Option<Vec3> {
    let uv = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::new(size.0 as f32, size.1 as f32);
    let (eye, direction) = (frame.position(), frame.direction(uv));
    (direction.y < 0.0).then(|| eye - direction * (eye.y / direction.y))
}
