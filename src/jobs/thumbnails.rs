//! Thumbnails of studios and of objects, made one by one in the background: shipped studios have pictures that were
//! rendered, the rest is drawn by the CPU z-buffer, so without shadows.

use super::threads::{Priority, background_pool};
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::color::ToneTable;
use crate::raster::{self, Framebuffer, NO_OBJECT, Shading};
use crate::scene::{Aim, Assets, Camera, CameraFrame, Emitter, Light, LightColor, Object, Output, Scene, Texture};
use crate::{io, math};
use glam::{Vec2, Vec3};
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// sRGB of the background of an object: black and white paper both differ from it.
pub const BACKGROUND: [u8; 3] = [102; 3];
/// Direction from an object to the camera: in front, a little to the right and above.
const CAMERA_DIRECTION: Vec3 = Vec3::new(0.35, 0.25, 1.0);
/// Half of the width of the view at a distance of 1 m, metres: a portrait lens.
const HALF_EXTENT: f32 = 0.2;
/// Size of the view relative to that which just holds the object.
const MARGIN: f32 = 1.04;

/// The subject of a thumbnail.
#[derive(Clone, Debug, PartialEq)]
pub enum ThumbnailSubject {
    /// A shipped studio, by its index in the list, as its camera sees it. Its picture has a size of its own.
    Studio(usize),
    /// A figure, prop or backdrop.
    Object(Box<Object>),
    /// A studio as its camera sees it, with the folder that its assets are relative to.
    Scene(Box<Scene>, Option<PathBuf>),
}

/// A drawn thumbnail.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ThumbnailImage {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// sRGB bytes, three per pixel, rows from the top.
    pub rgb: Vec<u8>,
}

/// A thumbnail to be drawn.
#[derive(Debug)]
struct Request<K> {
    key: K,
    subject: ThumbnailSubject,
    /// Longest side, pixels.
    side: u32,
}

/// The worker that draws thumbnails, each with a key that its owner chooses.
#[derive(Debug)]
pub struct ThumbnailJob<K> {
    worker: Worker<VecDeque<Request<K>>, Vec<(K, ThumbnailImage)>>,
}

const WORKER: WorkerSettings = WorkerSettings {
    name: "thumbnails",
    priority: Priority::Background,
    interrupt: Interrupt::AfterResult,
    panic_message: "A thumbnail could not be drawn.",
};

impl<K: Send + 'static> Default for ThumbnailJob<K> {
    fn default() -> Self {
        ThumbnailJob { worker: Worker::new(WORKER, serve) }
    }
}

impl<K: Send + 'static> ThumbnailJob<K> {
    /// Requests a thumbnail with a longest side of `side` pixels, after those that were requested before.
    pub fn request(&mut self, key: K, subject: ThumbnailSubject, side: u32, wake: &Wake) {
        self.worker.request_with(Arc::default(), wake, |pending| {
            let mut requests = pending.unwrap_or_default();
            requests.push_back(Request { key, subject, side });
            requests
        });
    }

    /// Takes the thumbnails that were drawn since the last call.
    pub fn take(&self) -> Vec<(K, ThumbnailImage)> {
        match self.worker.take() {
            Some(Ok(images)) => images,
            // A list is of use without thumbnails, too.
            Some(Err(message)) => {
                log::warn!("{message}");
                Vec::new()
            }
            None => Vec::new(),
        }
    }
}

/// The body of the thumbnails' thread.
fn serve<K: Send>(inbox: &Inbox<VecDeque<Request<K>>, Vec<(K, ThumbnailImage)>>) {
    let pool = match background_pool(1, "thumbnails") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail_all(&format!("No threads to draw thumbnails with: {error}.")),
    };
    while let Some(Request { key, subject, side }) = inbox.next_step(|pending| pending.take_part(VecDeque::pop_front)) {
        if let Some(image) = pool.install(|| known_or_drawn(subject, side)) {
            inbox.publish_with(|pending| {
                let mut images = pending.unwrap_or_default();
                images.push((key, image));
                images
            });
        }
    }
}

/// Returns a thumbnail that was drawn before, by any window, or draws it: a person takes a second to build. There are as
/// many as studios and things in the lists.
fn known_or_drawn(subject: ThumbnailSubject, side: u32) -> Option<ThumbnailImage> {
    static DRAWN: Mutex<Vec<(ThumbnailSubject, u32, ThumbnailImage)>> = Mutex::new(Vec::new());
    // A panic with the lock held leaves the list intact: it changes by whole entries.
    let drawn = || DRAWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((.., image)) = drawn().iter().find(|(known, size, _)| *size == side && *known == subject) {
        return Some(image.clone());
    }
    let image = draw_thumbnail(subject.clone(), side)?;
    if !matches!(subject, ThumbnailSubject::Scene(..)) {
        drawn().push((subject, side, image.clone()));
    }
    Some(image)
}

/// Draws a thumbnail with a longest side of `side` pixels. None if its studio or mesh cannot be loaded.
pub fn draw_thumbnail(subject: ThumbnailSubject, side: u32) -> Option<ThumbnailImage> {
    match subject {
        ThumbnailSubject::Studio(index) => rendered_studio(index),
        ThumbnailSubject::Object(object) => draw_object(*object, side),
        ThumbnailSubject::Scene(scene, folder) => {
            let mut assets = Assets::default();
            io::load_assets(&scene, folder.as_deref(), &mut assets);
            Some(draw_scene(&scene, &assets, side))
        }
    }
}

fn rendered_studio(index: usize) -> Option<ThumbnailImage> {
    let Texture { width, height, rgb, .. } = io::presets().get(index)?.picture()?;
    Some(ThumbnailImage { size: [width as usize, height as usize], rgb: rgb.into_flattened() })
}

fn draw_scene(scene: &Scene, assets: &Assets, side: u32) -> ThumbnailImage {
    let size = scene.camera.picture_size(side);
    let frame = scene.camera_frame(size.0 as f32 / size.1 as f32);
    image(&raster::draw(scene, assets, &frame, size, Shading::default()), |_| false)
}

fn draw_object(object: Object, side: u32) -> Option<ThumbnailImage> {
    let mut scene = Scene { objects: vec![object], lights: lights(), ..Scene::default() };
    let mut assets = Assets::default();
    io::load_assets(&scene, None, &mut assets);
    let frame = frame_around(assets.object_bounds(&scene.objects[0])?);
    scene.camera = Camera { f_number: 8.0, ..Camera::default() };
    let drawing = raster::draw(&scene, &assets, &frame, (side, side), Shading::default());
    Some(image(&drawing, |object| object == NO_OBJECT))
}

/// Returns a sun over the left shoulder and an even surround, two thirds of a stop brighter than f/8 is exposed for.
fn lights() -> Vec<Light> {
    let white = LightColor::default();
    let light = |emitter, lux| Light { color: white, ..Light::new(emitter, Output::Lux(lux)) };
    let sun = Light {
        position: Vec3::new(-1.0, 1.5, 1.5),
        aim: Aim::Point(Vec3::ZERO),
        ..light(Emitter::Sun { angular_diameter_deg: 0.53 }, 20_000.0)
    };
    vec![sun, light(Emitter::Surround, 12_000.0)]
}

/// Returns the view in which a box just fills a square picture.
fn frame_around((low, high): (Vec3, Vec3)) -> CameraFrame {
    let centre = 0.5 * (low + high);
    let view = math::look_at(centre + CAMERA_DIRECTION, centre, 0.0);
    let distance = |corner: usize| {
        let side = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
        let p = view.matrix3.transpose() * (Vec3::new(side(0), side(1), side(2)) - centre);
        p.z + p.x.abs().max(p.y.abs()) / HALF_EXTENT
    };
    let distance = MARGIN * (0..8).map(distance).fold(0.0, f32::max);
    let eye = centre + CAMERA_DIRECTION.normalize() * distance;
    CameraFrame { world_from_camera: math::look_at(eye, centre, 0.0), half_extent: Vec2::splat(HALF_EXTENT) }
}

/// Returns the drawing for the screen, with the background where `is_background` is true for the object of a pixel.
fn image(drawing: &Framebuffer, is_background: impl Fn(u32) -> bool) -> ThumbnailImage {
    let (tone, picture) = (ToneTable::default(), &drawing.picture);
    let pixel =
        |(rgb, object): (&[f32; 3], &u32)| if is_background(*object) { BACKGROUND } else { tone.display_srgb8(*rgb) };
    let rgb = picture.rgb.iter().zip(&drawing.objects).flat_map(pixel).collect();
    ThumbnailImage { size: [picture.width as usize, picture.height as usize], rgb }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn every_shipped_studio_has_a_thumbnail_in_its_cameras_shape() {
        for (index, preset) in io::presets().iter().enumerate() {
            let [width, height] = rendered_studio(index).unwrap().size;
            assert_eq!(width.max(height), 224, "{}", preset.name);
            let aspect = preset.scene().unwrap().camera.aspect();
            assert!((width as f32 / height as f32 - aspect).abs() < 0.02, "{}", preset.name);
        }
    }

    #[test]
    fn every_requested_thumbnail_is_drawn_and_one_that_does_not_exist_is_left_out() {
        let (sender, woken) = channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let mut job = ThumbnailJob::default();
        for index in [0, 1, usize::MAX, 2] {
            job.request(index, ThumbnailSubject::Studio(index), 24, &wake);
        }
        let mut drawn = Vec::new();
        while drawn.len() < 3 {
            woken.recv().unwrap();
            drawn.extend(job.take().into_iter().map(|(key, _)| key));
        }
        assert_eq!(drawn, [0, 1, 2]);
    }
}
