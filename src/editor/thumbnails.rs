//! Small pictures of what can be chosen: shipped studios as their cameras see them, figures and things on the shelf.
//!
//! The processor draws them (`raster`, so without shadows), one by one in the background, each when it is first asked
//! for: a list opens at once and fills while one looks at it.

use crate::color::ToneTable;
use crate::editor::document::bounds;
use crate::editor::document::catalog::{Entry, Made};
use crate::editor::ui::image_texture::Canvas;
use crate::io;
use crate::jobs::background_pool;
use crate::math;
use crate::raster::{self, Drawing, NO_OBJECT, Shading};
use crate::scene::{
    Aim, Assets, Camera, CameraFrame, ColorSource, Emitter, Gel, Light, LightColor, Object, Output, Scene,
};
use eframe::egui::{self, Color32, ColorImage, Context, Pos2, Rect, TextureId, pos2};
use glam::{Vec2, Vec3};
use rayon::ThreadPool;
use std::collections::HashMap;
use std::sync::mpsc::{Receiver, Sender, channel};

/// Longer side of a studio's picture, points.
pub const STUDIO_POINTS: f32 = 84.0;
/// Side of a thing's picture, points.
pub const THING_POINTS: f32 = 30.0;
/// Pixels drawn for a point, along each side: what a dense display shows; on others, four are averaged.
const PIXELS_A_POINT: f32 = 2.0;
/// Whence a thing is seen: from before, a little from the right and from above.
const SEEN_FROM: Vec3 = Vec3::new(0.35, 0.25, 1.0);
/// Half of the width that is seen 1 m ahead, metres: a portrait lens.
const HALF_EXTENT: f32 = 0.2;
/// Behind a thing: both black and white paper can be told from it.
const TILE: Color32 = Color32::from_gray(102);
/// Room around a thing, as a factor.
const MARGIN: f32 = 1.04;

/// Something a picture is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Subject {
    /// A shipped studio, by its place in the list.
    Studio(usize),
    /// A figure, prop or backdrop, by its name on the shelf.
    Thing(&'static str),
}

/// A picture that is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Thumbnail {
    texture: TextureId,
    /// Points.
    size: egui::Vec2,
}

impl Thumbnail {
    fn of(canvas: &Canvas) -> Option<Self> {
        let size = canvas.size()?.map(|pixels| pixels as f32 / PIXELS_A_POINT);
        Some(Thumbnail { texture: canvas.id()?, size: size.into() })
    }

    /// Paints it in the middle of a place.
    pub fn paint(&self, ui: &egui::Ui, place: Rect) {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        ui.painter().image(self.texture, Rect::from_center_size(place.center(), self.size), whole, Color32::WHITE);
    }
}

/// The pictures that were asked for.
#[derive(Debug)]
pub struct Thumbnails {
    /// Empty until they are drawn.
    pictures: HashMap<Subject, Canvas>,
    /// One thread, started with the first picture.
    pool: Option<ThreadPool>,
    sender: Sender<(Subject, ColorImage)>,
    receiver: Receiver<(Subject, ColorImage)>,
}

impl Default for Thumbnails {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Thumbnails { pictures: HashMap::new(), pool: None, sender, receiver }
    }
}

impl Thumbnails {
    /// The picture of a shipped studio, none until it is drawn.
    pub fn studio(&mut self, ctx: &Context, index: usize) -> Option<Thumbnail> {
        self.picture(ctx, Subject::Studio(index), move || draw_studio(index))
    }

    /// The picture of a figure or a thing, none until it is drawn; lights have none.
    pub fn thing(&mut self, ctx: &Context, entry: &'static Entry) -> Option<Thumbnail> {
        let Made::Object(object) = entry.make() else { return None };
        self.picture(ctx, Subject::Thing(entry.name), move || draw_thing(object))
    }

    fn picture(
        &mut self,
        ctx: &Context,
        subject: Subject,
        draw: impl FnOnce() -> Option<ColorImage> + Send + 'static,
    ) -> Option<Thumbnail> {
        for (subject, image) in self.receiver.try_iter() {
            self.pictures.entry(subject).or_default().set(ctx, image);
        }
        if let Some(canvas) = self.pictures.get(&subject) {
            return Thumbnail::of(canvas);
        }
        self.pictures.insert(subject, Canvas::default());
        if self.pool.is_none() {
            self.pool = background_pool(1, "thumbnails").ok();
        }
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        self.pool.as_ref()?.spawn_fifo(move || {
            // What cannot be drawn goes without; a list is of use without pictures, too.
            if let Some(image) = draw() {
                let _ = sender.send((subject, image));
                ctx.request_repaint();
            }
        });
        None
    }

    /// How many are drawn, as of the last time one was asked for.
    pub fn drawn(&self) -> usize {
        self.pictures.values().filter(|canvas| canvas.id().is_some()).count()
    }

    /// Uploads all pictures to the device that the window has now.
    pub fn renew(&mut self, ctx: &Context) {
        self.pictures.values_mut().for_each(|canvas| canvas.renew(ctx));
    }
}

fn draw_studio(index: usize) -> Option<ColorImage> {
    let loaded = io::presets().get(index)?.load().ok()?;
    let (scene, size) = (&loaded.scene, loaded.scene.camera.picture_size((STUDIO_POINTS * PIXELS_A_POINT) as u32));
    let frame = scene.camera_frame(size.0 as f32 / size.1 as f32);
    let drawing = raster::draw(scene, &loaded.assets, &frame, size, Shading::default());
    Some(image(&drawing, |_| false))
}

fn draw_thing(object: Object) -> Option<ColorImage> {
    let mut scene = Scene { objects: vec![object], lights: lights(), ..Scene::default() };
    let mut assets = Assets::default();
    io::load_assets(&scene, None, &mut assets);
    let frame = frame_around(bounds::object_bounds(&scene.objects[0], &assets)?);
    scene.camera = Camera { f_number: 8.0, ..Camera::default() };
    let side = (THING_POINTS * PIXELS_A_POINT) as u32;
    let drawing = raster::draw(&scene, &assets, &frame, (side, side), Shading::default());
    Some(image(&drawing, |object| object == NO_OBJECT))
}

/// Sun over the left shoulder and an even surround, two thirds of a stop more than f/8 asks for.
fn lights() -> Vec<Light> {
    let white = LightColor { source: ColorSource::Kelvin(5500.0), gel: Gel::None };
    let light = |emitter, lux| Light { color: white, ..Light::new(emitter, Output::Lux(lux)) };
    let sun = Light {
        position: Vec3::new(-1.0, 1.5, 1.5),
        aim: Aim::Point(Vec3::ZERO),
        ..light(Emitter::Sun { angular_diameter_deg: 0.53 }, 20_000.0)
    };
    vec![sun, light(Emitter::Surround, 12_000.0)]
}

/// The view in which a box just fills a square picture.
fn frame_around((low, high): (Vec3, Vec3)) -> CameraFrame {
    let centre = 0.5 * (low + high);
    let view = math::look_at(centre + SEEN_FROM, centre, 0.0);
    let distance = |corner: usize| {
        let side = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
        let p = view.matrix3.transpose() * (Vec3::new(side(0), side(1), side(2)) - centre);
        p.z + p.x.abs().max(p.y.abs()) / HALF_EXTENT
    };
    let distance = MARGIN * (0..8).map(distance).fold(0.0, f32::max);
    let eye = centre + SEEN_FROM.normalize() * distance;
    CameraFrame { world_from_camera: math::look_at(eye, centre, 0.0), half_extent: Vec2::splat(HALF_EXTENT) }
}

/// As it is shown; `is_tile` tells by its object whether a pixel shows nothing.
fn image(drawing: &Drawing, is_tile: impl Fn(u32) -> bool) -> ColorImage {
    let (tone, picture) = (ToneTable::default(), &drawing.picture);
    let shown = |(rgb, object): (&[f32; 3], &u32)| {
        let [r, g, b] = tone.shown(*rgb);
        if is_tile(*object) { TILE } else { Color32::from_rgb(r, g, b) }
    };
    let pixels = picture.rgb.iter().zip(&drawing.objects).map(shown).collect();
    ColorImage::new([picture.width as usize, picture.height as usize], pixels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog::{Shelf, entries};

    #[test]
    fn everything_on_the_shelf_fills_its_picture_and_can_be_seen() {
        for shelf in [Shelf::Figures, Shelf::Props, Shelf::Backdrops] {
            for entry in entries(shelf) {
                let Made::Object(object) = entry.make() else { panic!("{} is a light", entry.name) };
                let image = draw_thing(object).unwrap();
                let [width, height] = image.size;
                let drawn = |x: usize, y: usize| image[(x, y)] != TILE;
                let columns = (0..width).filter(|x| (0..height).any(|y| drawn(*x, y))).count();
                let rows = (0..height).filter(|y| (0..width).any(|x| drawn(x, *y))).count();
                // The box around it fills one of the sides; a ball fills less of it than its box.
                assert!(columns.max(rows) >= 6 * width / 10, "{}: {columns} x {rows} of {width}", entry.name);
                assert!(!drawn(0, 0) && !drawn(width - 1, 0), "{} is cut off", entry.name);
                let channels = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]);
                let contrast = channels.map(|channel| channel.abs_diff(TILE.g())).max().unwrap();
                assert!(contrast > 20, "{} can hardly be seen: {contrast}", entry.name);
            }
        }
    }

    #[test]
    fn every_shipped_studio_has_a_picture_in_its_cameras_shape() {
        for (index, preset) in io::presets().iter().enumerate() {
            let [width, height] = draw_studio(index).unwrap().size;
            let aspect = preset.load().unwrap().scene.camera.aspect();
            assert!((width as f32 / height as f32 - aspect).abs() < 0.02, "{}", preset.name);
        }
    }
}
