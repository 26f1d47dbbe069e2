//! Execution of exports: pictures, set-up sheets and lesson sheets.

use crate::editor::document::files::{self, PictureExport};
use crate::editor::window::app::App;
use crate::editor::window::background_tasks::TaskResult;
use crate::editor::window::run_file_command::waker;
use crate::gear::GearList;
use crate::io::PictureInfo;
use crate::jobs::{background_pool, sentence};
use crate::photo::Picture;
use crate::raytrace::{GeometryCache, RenderControl};
use crate::scene::{Assets, Camera, LightId, Scene};
use crate::sheet::{
    Lesson, LessonFormat, LessonSeries, LessonSheet, SheetContent, SheetFormat, Units, draft_picture, write_lesson,
    write_sheet,
};
use eframe::egui::Context;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Samples per pixel of a picture that is rendered for the sheet, and denoised.
const SAMPLES: u32 = 8;

impl App {
    /// Writes the rendered picture in the background.
    pub(super) fn export_picture_to(&mut self, path: PathBuf, ctx: &Context) {
        let (Some(developed), Some(job)) = (self.rendering.developed(), self.rendering.job()) else {
            self.toasts.info("There is no picture to export any more: another one is being rendered.");
            return;
        };
        let scene = self.rendering.mix.mixed(self.document.scene()).into_owned();
        let shown = shown_studio(&job.scene, &scene);
        let seed = job.settings.seed.into();
        let export = PictureExport {
            picture: developed.picture.clone(),
            denoised_from: developed.noisy.clone().zip(developed.denoiser),
            film: developed.film.upgrade(),
            info: PictureInfo::new(&shown, &developed.method, developed.spp, seed),
            scene,
        };
        let film = developed.film.clone();
        let work = move || {
            let written = || files::export(&path, &export);
            let pool = background_pool(0, "export").map_err(|error| sentence(&error));
            let result = pool.and_then(|pool| pool.install(written));
            TaskResult::Exported(path, film, result)
        };
        self.background.exports.start(work, waker(ctx));
    }

    /// Writes the set-up sheet in the background, with the rendered picture if it is up to date, else with a small one
    /// that is rendered for it.
    pub(super) fn export_sheet_to(&mut self, path: PathBuf, units: Units, ctx: &Context) {
        let scene = self.document.scene().clone();
        let rendering = &self.rendering;
        let is_current = !rendering.is_busy() && !rendering.is_out_of_date(&scene) && rendering.mix.is_neutral();
        let developed = self.rendering.developed().filter(|_| is_current);
        let (picture, assets) = (developed.map(|developed| developed.picture.clone()), self.document.assets().clone());
        if picture.is_none() {
            self.toasts.info("A small picture is rendered for the sheet; go on meanwhile.");
        }
        let gear = self.panels.gear.list().clone();
        let work = move || {
            let result = export_sheet(&path, &scene, &assets, picture, units, &gear);
            TaskResult::SheetExported("Set-up", path, result)
        };
        self.background.exports.start(work, waker(ctx));
    }

    /// Renders and writes a lesson sheet in the background.
    pub(super) fn export_lesson_to(
        &mut self,
        path: PathBuf,
        series: LessonSeries,
        light: Option<LightId>,
        ctx: &Context,
    ) {
        let (scene, assets) = (self.document.scene().clone(), self.document.assets().clone());
        self.toasts.info("Small pictures are rendered for the sheet; go on meanwhile.");
        let work = move || {
            let result = export_lesson(&path, series, &scene, &assets, light);
            TaskResult::SheetExported("Lesson", path, result)
        };
        self.background.exports.start(work, waker(ctx));
    }
}

/// Returns the studio that a picture shows: the one that was rendered, with the lights' power, colours and switches and the
/// exposure of now, by which the picture is developed.
fn shown_studio(rendered: &Scene, now: &Scene) -> Scene {
    let mut shown = rendered.clone();
    for light in &mut shown.lights {
        let now = now.light(light.id);
        light.on = now.is_some_and(|now| now.on);
        if let Some(now) = now {
            (light.power, light.color, light.muted) = (now.power, now.color, now.muted);
            light.name.clone_from(&now.name);
        }
    }
    let Camera { f_number, shutter_s, iso, white_balance_k, nd_stops, meter_constant, .. } = now.camera;
    shown.camera = Camera { f_number, shutter_s, iso, white_balance_k, nd_stops, meter_constant, ..shown.camera };
    shown
}

fn export_lesson(
    path: &Path,
    series: LessonSeries,
    scene: &Scene,
    assets: &Assets,
    light: Option<LightId>,
) -> Result<(), String> {
    LessonFormat::of(path).map_err(|error| sentence(&error))?;
    let pool = background_pool(0, "lesson").map_err(|error| sentence(&error))?;
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    let sheet = pool.install(|| {
        let lesson = Lesson::new(series, scene, assets, light, &cache, &control)?;
        LessonSheet::render(lesson, assets, SAMPLES, &cache, &control, &mut |_, _| ())
    });
    let sheet = sheet.map_err(|error| sentence(&error))?;
    write_lesson(path, &sheet).map_err(|error| sentence(&error))
}

fn export_sheet(
    path: &Path,
    scene: &Scene,
    assets: &Assets,
    picture: Option<Arc<Picture>>,
    units: Units,
    gear: &GearList,
) -> Result<(), String> {
    SheetFormat::of(path).map_err(|error| sentence(&error))?;
    let pool = background_pool(0, "sheet").map_err(|error| sentence(&error))?;
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    let content = pool.install(|| {
        let picture = match picture {
            Some(picture) => Some(Picture::clone(&picture)),
            None => draft_picture(scene, assets, SAMPLES, &cache, &control)?,
        };
        let picture = picture.unwrap_or_default();
        SheetContent::new(scene, assets, picture, units, gear, &cache, &control)
    });
    let content = content.map_err(|error| sentence(&error))?.ok_or("It was cancelled.")?;
    write_sheet(path, &content).map_err(|error| sentence(&error))
}
