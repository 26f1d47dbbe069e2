//! The scopes over a live view: its scene-linear picture in false colour or with a zebra, its charts, and the light under
//! the pointer.

use crate::editor::document::studio_document::Document;
use crate::editor::ui::image_texture::ImageTexture;
use crate::editor::ui::scopes::{ChartData, ScopeCharts, waveform_image};
use crate::editor::ui::spot_readout::{SpotLux, SpotReading};
use crate::editor::ui::wake::wake;
use crate::jobs::{SpotMeterJob, SpotRay};
use crate::photo::{Histogram, Picture, PictureDisplay, Spot, Waveform};
use crate::raytrace::{GeometryCache, LiveCamera};
use crate::scene::CameraFrame;
use eframe::egui::{ColorImage, Context, TextureId};
use glam::Vec2;
use std::sync::Arc;

/// What scopes are of.
#[derive(Clone, Debug)]
struct ScopedView {
    picture: Arc<Picture>,
    display: PictureDisplay,
    charts: ScopeCharts,
    /// Corners of the part that the charts count, in fractions of the view from the top left.
    part: [Vec2; 2],
}

impl ScopedView {
    fn is_same(&self, other: &ScopedView) -> bool {
        Arc::ptr_eq(&self.picture, &other.picture)
            && (self.display, self.charts, self.part) == (other.display, other.charts, other.part)
    }
}

/// The scopes over a live view.
#[derive(Debug)]
pub struct LiveScopes {
    shown: Option<ScopedView>,
    image: ImageTexture,
    waveform: ImageTexture,
    histogram: Option<Histogram>,
    spot: SpotMeterJob,
}

impl LiveScopes {
    /// Returns scopes without a picture, which share the BLAS cache with the renders.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        LiveScopes {
            shown: None,
            image: ImageTexture::default(),
            waveform: ImageTexture::default(),
            histogram: None,
            spot: SpotMeterJob::new(cache),
        }
    }

    /// Takes the picture of the view, none if there is none or if no scope is on. `part` has the corners of the part that
    /// the charts count. Returns the texture that shows the picture instead of the view's own, for false colour and zebra.
    pub fn show(
        &mut self,
        ctx: &Context,
        picture: Option<&Arc<Picture>>,
        (display, charts): (PictureDisplay, ScopeCharts),
        part: [Vec2; 2],
    ) -> Option<TextureId> {
        let Some(picture) = picture else {
            (self.shown, self.histogram) = (None, None);
            return None;
        };
        let view = ScopedView { picture: picture.clone(), display, charts, part };
        if !self.shown.as_ref().is_some_and(|shown| shown.is_same(&view)) {
            if display != PictureDisplay::Plain {
                let size = [picture.width as usize, picture.height as usize];
                self.image.set(ctx, ColorImage::from_rgb(size, display.to_srgb8(picture).as_flattened()));
            }
            if charts.histogram || charts.waveform {
                let counted = picture.cropped(part);
                self.histogram = charts.histogram.then(|| Histogram::of(&counted));
                if charts.waveform {
                    self.waveform.set(ctx, waveform_image(&Waveform::of(&counted)));
                }
            }
            self.shown = Some(view);
        }
        self.image.id().filter(|_| display != PictureDisplay::Plain)
    }

    /// Uploads the images to the window's current device.
    pub fn move_to(&mut self, ctx: &Context) {
        self.image.renew(ctx);
        self.waveform.renew(ctx);
    }

    /// Returns the charts of the picture.
    pub fn charts(&self) -> ChartData<'_> {
        let waveform = self.waveform.id().filter(|_| self.shown.is_some());
        ChartData { histogram: self.histogram.as_ref(), waveform }
    }

    /// Reads the light at a point of the view, in fractions from the top left. None without a picture.
    pub fn read_spot(
        &mut self,
        ctx: &Context,
        document: &Document,
        frame: &CameraFrame,
        point: Vec2,
    ) -> Option<SpotReading> {
        let picture = &self.shown.as_ref()?.picture;
        let size = (picture.width, picture.height);
        let pixel = point * Vec2::new(size.0 as f32, size.1 as f32);
        let spot = Spot::around((pixel.x as u32, pixel.y as u32), size, |x, y| picture.at(x, y));
        let scene = document.scene();
        let (origin, direction) = LiveCamera::view_ray(frame, scene.room.as_ref(), point);
        let (ray, revision) = (SpotRay { origin, direction }, document.revisions().image);
        let reading = self.spot.read(scene, document.assets(), revision, ray, &wake(ctx));
        let lights = reading
            .iter()
            .flat_map(|reading| reading.lights.iter().map(|light| (light.name.clone(), reading.lux_s(light))));
        let lights: Vec<(String, f32)> = lights.collect();
        let lux = reading.map(|reading| SpotLux {
            lux_s: lights.iter().map(|(_, lux_s)| lux_s).sum(),
            shutter_s: reading.shutter_s,
        });
        Some(SpotReading::new(spot, lux, lights))
    }

    /// Returns true while the light at a spot is being read.
    pub fn is_busy(&self) -> bool {
        self.spot.is_busy()
    }
}
