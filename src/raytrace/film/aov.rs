//! AOVs: albedo, normal, depth and object of the first hit, for denoisers and compositing.
//!
//! The first hit is the first surface or visible emitter on the camera ray; mirrors and glass are not followed, as in
//! pbrt's `GBufferFilm`. Albedo and normal are means of a pixel's samples, zero where nothing is hit, as denoisers
//! expect. Depth and object are those of its first sample, as means across an edge belong to neither side.
//!
//! For the denoiser, albedo and normal of what mirrors and clear glass show are kept, too, as the documentation of Open
//! Image Denoise recommends: they hold the edges that reflections and refractions have.

use super::stored::stored_fields;
use crate::photo::AovPicture;
use crate::raytrace::sink::{FirstHit, FirstObject, SeenSurface};
use glam::Vec3;
use std::ops::Range;

/// The AOVs of a tile's pixels.
#[derive(Clone, Debug)]
pub struct AovTile {
    /// Sums over the samples.
    albedo: Vec<Vec3>,
    /// Sums over the samples.
    normal: Vec<Vec3>,
    /// Sums over the samples of what is seen directly or by mirrors and clear glass.
    seen_albedo: Vec<Vec3>,
    /// Sums over the samples, as `seen_albedo`.
    seen_normal: Vec<Vec3>,
    depth_m: Vec<f32>,
    object_id: Vec<u32>,
}

impl AovTile {
    /// Memory of a pixel, bytes.
    pub const BYTES_PER_PIXEL: usize = 4 * size_of::<Vec3>() + size_of::<f32>() + size_of::<u32>();

    /// Empty pixels.
    pub fn new(pixels: usize) -> Self {
        AovTile {
            albedo: vec![Vec3::ZERO; pixels],
            normal: vec![Vec3::ZERO; pixels],
            seen_albedo: vec![Vec3::ZERO; pixels],
            seen_normal: vec![Vec3::ZERO; pixels],
            depth_m: vec![f32::INFINITY; pixels],
            object_id: vec![AovPicture::NO_OBJECT; pixels],
        }
    }

    /// Adds the first hit of a sample; depth is measured along the unit `view_axis`.
    pub fn add(&mut self, pixel: usize, sample_index: u32, hit: &FirstHit, view_axis: Vec3) {
        let FirstHit { ray, distance, normal, albedo, object } = *hit;
        self.albedo[pixel] += albedo;
        self.normal[pixel] += normal;
        if sample_index == 0 {
            self.depth_m[pixel] = ray.origin.dot(view_axis) + distance * ray.direction.dot(view_axis);
            self.object_id[pixel] = match object {
                FirstObject::Emitter => AovPicture::NO_OBJECT,
                FirstObject::Room => AovPicture::ROOM,
                FirstObject::Object(index) => AovPicture::object_id(index as usize),
            };
        }
    }

    /// Adds a surface that a sample sees directly or by mirrors and clear glass.
    pub fn add_seen(&mut self, pixel: usize, surface: &SeenSurface) {
        let SeenSurface { albedo, normal } = *surface;
        self.seen_albedo[pixel] += albedo;
        self.seen_normal[pixel] += normal;
    }

    /// Sets a pixel to `samples` times the values of a picture's pixel.
    pub fn set(&mut self, pixel: usize, samples: f32, picture: &AovPicture, at: usize) {
        let sum = |values: &[[f32; 3]]| Vec3::from(values[at]) * samples;
        (self.albedo[pixel], self.normal[pixel]) = (sum(&picture.albedo), sum(&picture.normal));
        (self.seen_albedo[pixel], self.seen_normal[pixel]) = (sum(&picture.seen_albedo), sum(&picture.seen_normal));
        (self.depth_m[pixel], self.object_id[pixel]) = (picture.depth_m[at], picture.object_id[at]);
    }

    /// Returns a copy of some pixels.
    pub fn range(&self, pixels: Range<usize>) -> Self {
        let AovTile { albedo, normal, seen_albedo, seen_normal, depth_m, object_id } = self;
        let copy = |values: &[Vec3]| values[pixels.clone()].to_vec();
        AovTile {
            albedo: copy(albedo),
            normal: copy(normal),
            seen_albedo: copy(seen_albedo),
            seen_normal: copy(seen_normal),
            depth_m: depth_m[pixels.clone()].to_vec(),
            object_id: object_id[pixels.clone()].to_vec(),
        }
    }

    /// Replaces the pixels from `first` on by those of a copy.
    pub fn set_range(&mut self, first: usize, range: &Self) {
        let AovTile { albedo, normal, seen_albedo, seen_normal, depth_m, object_id } = range;
        let pixels = first..first + depth_m.len();
        self.albedo[pixels.clone()].copy_from_slice(albedo);
        self.normal[pixels.clone()].copy_from_slice(normal);
        self.seen_albedo[pixels.clone()].copy_from_slice(seen_albedo);
        self.seen_normal[pixels.clone()].copy_from_slice(seen_normal);
        self.depth_m[pixels.clone()].copy_from_slice(depth_m);
        self.object_id[pixels].copy_from_slice(object_id);
    }

    /// Returns true if both have the same number of pixels.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        let lengths = |AovTile { albedo, normal, seen_albedo, seen_normal, depth_m, object_id }: &Self| {
            ([albedo, normal, seen_albedo, seen_normal].map(Vec::len), depth_m.len(), object_id.len())
        };
        lengths(self) == lengths(other)
    }

    /// Returns the albedo of a pixel, with sums scaled by `per_sample`.
    pub fn albedo(&self, pixel: usize, per_sample: f32) -> [f32; 3] {
        (self.albedo[pixel] * per_sample).to_array()
    }

    /// Writes a pixel to a picture's pixel, with sums scaled by `per_sample`.
    pub fn write(&self, pixel: usize, per_sample: f32, picture: &mut AovPicture, at: usize) {
        picture.albedo[at] = self.albedo(pixel, per_sample);
        picture.normal[at] = (self.normal[pixel] * per_sample).to_array();
        picture.seen_albedo[at] = (self.seen_albedo[pixel] * per_sample).to_array();
        picture.seen_normal[at] = (self.seen_normal[pixel] * per_sample).to_array();
        picture.depth_m[at] = self.depth_m[pixel];
        picture.object_id[at] = self.object_id[pixel];
    }
}

stored_fields!(AovTile { albedo, normal, seen_albedo, seen_normal, depth_m, object_id });

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{Method, RenderControl, Settings, prepare, primary_objects, render};
    use crate::scene::{
        Aim, Assets, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Scene, Shape,
    };
    use glam::Vec2;
    use std::ops::ControlFlow;

    const WIDTH: u32 = 48;
    const HEIGHT: u32 = 32;

    fn object(id: u32, shape: Shape, position: Vec3, base_color: [f32; 3]) -> Object {
        Object {
            id: ObjectId(id),
            transform: crate::scene::Transform::at(position),
            material: Material { base_color, ..Material::default() },
            ..Object::new(format!("Object {id}"), shape)
        }
    }

    /// A floor and a ball, seen from above at an angle, without a room.
    fn still_life() -> Scene {
        let (position, aim) = (Vec3::new(0.5, 2.0, 3.0), Aim::Point(Vec3::ZERO));
        let camera = Camera { position, aim, focal_length_mm: 50.0, ..Camera::default() };
        let light = Light {
            id: LightId(7),
            position: Vec3::new(1.0, 3.0, 1.0),
            ..Light::new(Emitter::Point, Output::Lumens(5000.0))
        };
        Scene {
            camera,
            objects: vec![
                object(4, Shape::Plane { width_m: 3.0, depth_m: 3.0 }, Vec3::ZERO, [0.2, 0.4, 0.6]),
                object(9, Shape::Sphere { radius_m: 0.5 }, Vec3::Y * 0.5, [0.5, 0.5, 0.5]),
            ],
            lights: vec![light],
            ..Scene::default()
        }
    }

    fn aovs(scene: &Scene, settings: &Settings) -> (AovPicture, crate::photo::Picture) {
        let prepared = prepare(scene, &Assets::default()).unwrap();
        let film = render(&prepared, settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        (film.aovs().unwrap(), film.develop(scene))
    }

    #[test]
    fn aovs_hold_the_first_hits_object_depth_normal_and_albedo() {
        let scene = still_life();
        let camera = &scene.camera;
        let frame = scene.camera_frame(WIDTH as f32 / HEIGHT as f32);
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let objects = primary_objects(&prepared, WIDTH, HEIGHT);
        let at = |x: u32, y: u32| (y * WIDTH + x) as usize;
        for method in [Method::Path, Method::Direct, Method::Whitted] {
            let settings = Settings { width: WIDTH, height: HEIGHT, method, spp: 4, aovs: true, ..Settings::default() };
            let (aovs, _) = aovs(&scene, &settings);
            let (mut floor, mut ball, mut nothing) = (0, 0, 0);
            for (x, y) in (1..HEIGHT - 1).flat_map(|y| (1..WIDTH - 1).map(move |x| (x, y))) {
                let object = objects[at(x, y)];
                let neighbours = (0..9).map(|i| objects[at(x + i % 3 - 1, y + i / 3 - 1)]);
                // Edges go through other pixels.
                if neighbours.into_iter().any(|other| other != object) {
                    continue;
                }
                let i = at(x, y);
                let (normal, albedo) = (Vec3::from(aovs.normal[i]), Vec3::from(aovs.albedo[i]));
                // Depth at the pixel's centre, and how much it changes over the pixel.
                let point = (Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(WIDTH as f32, HEIGHT as f32);
                let direction = frame.direction(point);
                match object {
                    0 => {
                        assert_eq!(aovs.object_id[i], AovPicture::object_id(0));
                        assert!((normal - Vec3::Y).length() < 1e-5, "{normal}");
                        assert!((albedo - Vec3::new(0.2, 0.4, 0.6)).length() < 1e-5, "{albedo}");
                        // A ray whose component along the axis is 1 reaches the floor at this depth.
                        let depth = camera.position.y / -direction.y;
                        let edge = |dy: f32| camera.position.y / -frame.direction(point + Vec2::Y * dy).y;
                        let half = 0.5 / HEIGHT as f32;
                        let (near, far) = (edge(half), edge(-half));
                        let ours = aovs.depth_m[i];
                        // The horizon is level: depth changes over the height of a pixel alone.
                        assert!((near * 0.9999..far * 1.0001).contains(&ours), "{ours} for {depth}, {near} to {far}");
                        floor += 1;
                    }
                    1 => {
                        assert_eq!(aovs.object_id[i], AovPicture::object_id(1));
                        assert!((albedo - Vec3::splat(0.5)).length() < 1e-5);
                        // The sphere's normal at the centre ray, within the turn over a pixel.
                        let direction = direction.normalize();
                        let from_centre = camera.position - Vec3::Y * 0.5;
                        let b = from_centre.dot(direction);
                        let t = -b - (b * b - from_centre.length_squared() + 0.25).max(0.0).sqrt();
                        let expected = (from_centre + direction * t) / 0.5;
                        // Pixels are 5 cm wide there: up to 1/10 rad head-on, more towards the rim.
                        let cos = -expected.dot(direction);
                        if cos > 0.6 {
                            assert!((normal - expected).length() < 0.25, "{normal} for {expected}");
                            let depth = (direction * t).dot(frame.forward());
                            assert!((aovs.depth_m[i] / depth - 1.0).abs() < 0.03, "{} for {depth}", aovs.depth_m[i]);
                        }
                        ball += 1;
                    }
                    _ => {
                        assert_eq!(aovs.object_id[i], AovPicture::NO_OBJECT);
                        assert_eq!((normal, albedo, aovs.depth_m[i]), (Vec3::ZERO, Vec3::ZERO, f32::INFINITY));
                        nothing += 1;
                    }
                }
            }
            assert!(floor > 100 && ball > 20 && nothing > 20, "{method:?}: {floor}, {ball}, {nothing} pixels");
        }
    }

    #[test]
    fn the_picture_has_the_same_bits_with_aovs() {
        let scene = still_life();
        let settings = Settings { width: WIDTH, height: HEIGHT, spp: 4, aovs: true, ..Settings::default() };
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let plain = Settings { aovs: false, ..settings.clone() };
        let film = render(&prepared, &plain, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        assert!(film.aovs().is_none());
        assert_eq!(aovs(&scene, &settings).1, film.develop(&scene));
    }

    #[test]
    fn an_emitter_that_the_camera_sees_is_white_without_object() {
        let mut scene = still_life();
        let light = &mut scene.lights[0];
        (light.emitter, light.visible_to_camera) = (Emitter::Sphere { radius_m: 0.3 }, true);
        light.position = scene.camera.position.lerp(Vec3::ZERO, 0.5);
        let settings = Settings { width: WIDTH, height: HEIGHT, spp: 1, aovs: true, ..Settings::default() };
        let (aovs, _) = aovs(&scene, &settings);
        let centre = (HEIGHT / 2 * WIDTH + WIDTH / 2) as usize;
        assert_eq!((aovs.albedo[centre], aovs.normal[centre], aovs.object_id[centre]), ([1.0; 3], [0.0; 3], 0));
        let distance = scene.lights[0].position.distance(scene.camera.position) - 0.3;
        assert!((aovs.depth_m[centre] - distance).abs() < 0.01, "{} for {distance}", aovs.depth_m[centre]);
    }

    #[test]
    fn without_mirrors_and_glass_the_first_hits_are_seen() {
        for method in [Method::Path, Method::Direct, Method::Whitted] {
            let settings = Settings { width: WIDTH, height: HEIGHT, method, spp: 4, aovs: true, ..Settings::default() };
            assert!(!aovs(&still_life(), &settings).0.has_mirrors(), "{method:?}");
        }
    }

    #[test]
    fn what_a_mirror_shows_is_seen() {
        // The floor is a mirror, in which the camera sees a ceiling.
        let mut scene = still_life();
        scene.objects.truncate(1);
        scene.objects[0].material =
            Material { base_color: [0.5; 3], metallic: 1.0, roughness: 0.0, ..Material::default() };
        scene.objects.push(object(5, Shape::Plane { width_m: 80.0, depth_m: 80.0 }, Vec3::Y * 5.0, [0.2, 0.4, 0.6]));
        let settings = Settings { width: WIDTH, height: HEIGHT, spp: 4, aovs: true, ..Settings::default() };
        let (aovs, _) = aovs(&scene, &settings);
        assert!(aovs.has_mirrors());
        let centre = (HEIGHT / 2 * WIDTH + WIDTH / 2) as usize;
        assert!((Vec3::from(aovs.normal[centre]) - Vec3::Y).length() < 1e-5, "the mirror's own");
        // Schlick: 0.5 head-on, and 0.5 + 0.5 (1 - cos)^5 under the angle of the camera, here 0.56.
        let towards = scene.camera.position.normalize();
        let reflectance = 0.5 + 0.5 * (1.0 - towards.y).powi(5);
        let (albedo, normal) = (Vec3::from(aovs.seen_albedo[centre]), Vec3::from(aovs.seen_normal[centre]));
        assert!((albedo / (reflectance * Vec3::new(0.2, 0.4, 0.6)) - 1.0).abs().max_element() < 0.02, "{albedo}");
        assert!((normal + reflectance * Vec3::Y).length() < 0.02, "{normal}");
    }
}
