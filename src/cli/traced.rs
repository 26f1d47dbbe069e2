//! `catchlight preview SCENE --traced`: how soon the live traced view shows something, measured without a window.

use super::beside::{FrameWork, Frames};
use super::{Failure, say};
use crate::io::{self, Loaded, PictureInfo};
use crate::jobs::{LivePace, background_pool};
use crate::photo::Picture;
use crate::raytrace::{self, LiveCamera, LivePicture, RenderControl, Settings, Smoother};
use crate::scene::{CameraFrame, Scene};
use anyhow::Context;
use glam::{Affine3A, Quat, Vec3};
use serde::Serialize;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Turn of the view from one picture to the next, radians: a slow drag of the mouse.
const TURN_RAD: f32 = 0.01;
/// Distance ahead of the camera about which the view turns, metres.
const PIVOT_M: f32 = 2.0;
/// Way of a light or a thing from one edit to the next, metres.
const STEP_M: f32 = 0.01;

/// What `--traced` prints. Times are from the change to the first picture that shows it, ready for the screen.
#[derive(Debug, Serialize)]
pub struct TracedReport {
    scene: String,
    width: u32,
    height: u32,
    lights: usize,
    threads: usize,
    /// Changes of each kind.
    frames: usize,
    /// The studio was opened: all trees are built.
    opened_ms: f64,
    /// Of the time to show a moved light or thing: trees and tables.
    prepared_ms: [f64; 2],
    /// A light moved: median and nine of ten.
    light_moved_ms: [f64; 2],
    /// A thing moved.
    thing_moved_ms: [f64; 2],
    /// A light was dimmed, with no ray traced.
    dimmed_ms: [f64; 2],
    /// The view turned a little.
    view_turned_ms: [f64; 2],
    /// Pixels that a turned view takes over from before, share.
    reused: f64,
    /// Seconds until every pixel has a sample, and paths a second.
    covered_s: f64,
    mpaths_s: f64,
    /// What smoothing the grain of a picture takes, on all cores.
    smoothing_ms: f64,
    /// Frames of a window that works 8 ms in each, on the same cores: alone, while the view that turns is traced, and
    /// while a picture is rendered, too.
    frames_alone: Frames,
    frames_beside: Frames,
    frames_beside_render: Frames,
}

/// How long frames are counted.
const COUNTED: Duration = Duration::from_secs(3);

/// Measures and prints; with `output`, writes the settled picture.
pub fn run(loaded: &Loaded, size: (u32, u32), frames: u32, output: Option<&Path>, json: bool) -> Result<(), Failure> {
    let mut bench = Bench::new(loaded, size)?;
    if let Some(output) = output {
        bench.open()?;
        bench.work_until(|pace| pace.picture().is_done());
        let picture = bench.pace.picture().develop(&loaded.scene);
        let spp = bench.pace.picture().spp();
        io::export_picture(output, &picture, &PictureInfo::new(&loaded.scene.camera, "path", spp, 0))?;
        return Ok(());
    }
    let report = bench.measure(frames.max(1) as usize)?;
    if json {
        say(serde_json::to_string(&report)?);
    } else {
        report.print();
    }
    Ok(())
}

struct Bench<'a> {
    loaded: &'a Loaded,
    pace: LivePace,
    scene: Scene,
    frame: CameraFrame,
    size: (u32, u32),
    control: RenderControl,
    /// Milliseconds that each update took, the pictures' own time left out.
    updates: Vec<f64>,
}

impl<'a> Bench<'a> {
    fn new(loaded: &'a Loaded, size: (u32, u32)) -> Result<Self, Failure> {
        let pace = LivePace::new(Arc::default()).context("no threads to trace with").map_err(Failure::Machine)?;
        let frame = loaded.scene.camera_frame(size.0 as f32 / size.1 as f32);
        Ok(Bench {
            loaded,
            pace,
            scene: loaded.scene.clone(),
            frame,
            size,
            control: RenderControl::new(),
            updates: Vec::new(),
        })
    }

    /// Shows the scene from the view as they are now; milliseconds to the first picture.
    fn open(&mut self) -> Result<f64, Failure> {
        let (began, scene) = (Instant::now(), Arc::new(self.scene.clone()));
        self.pace.update(scene, &self.loaded.assets, LiveCamera::pinhole(self.frame, self.size))?;
        self.updates.push(began.elapsed().as_secs_f64() * 1e3);
        while self.pace.look().is_none() {
            self.pace.slice(true, &self.control);
        }
        Ok(began.elapsed().as_secs_f64() * 1e3)
    }

    fn work_until(&mut self, enough: impl Fn(&LivePace) -> bool) {
        while !enough(&self.pace) {
            self.pace.slice(true, &self.control);
        }
    }

    /// Median and nine of ten of the times to the first picture after so many changes.
    fn time(&mut self, frames: usize, mut change: impl FnMut(&mut Self)) -> Result<[f64; 2], Failure> {
        let mut times = Vec::with_capacity(frames);
        for _ in 0..frames {
            change(self);
            times.push(self.open()?);
        }
        Ok(spread(&mut times))
    }

    fn measure(&mut self, frames: usize) -> Result<TracedReport, Failure> {
        let opened_ms = self.open()?;
        let (began, before) = (Instant::now(), self.control.samples_done());
        self.work_until(|pace| pace.picture().stride() == Some(1));
        let covered_s = began.elapsed().as_secs_f64();
        let mpaths_s = (self.control.samples_done() - before) as f64 * 1e-6 / covered_s.max(1e-9);
        let dimmed_ms = self.time(frames, |bench| {
            bench.scene.lights.iter_mut().take(1).for_each(|light| light.power.dial_stops -= 0.1);
        })?;
        let view_turned_ms = self.time(frames, |bench| {
            bench.frame.world_from_camera = turned(&bench.frame.world_from_camera);
        })?;
        self.work_until(|pace| pace.picture().steps() > LivePicture::SEEN);
        let reused = f64::from(self.pace.picture().reused());
        self.updates.clear();
        let light_moved_ms =
            self.time(frames, |bench| bench.scene.lights.iter_mut().take(1).for_each(|l| l.position.y += STEP_M))?;
        let thing_moved_ms = self.time(frames, |bench| {
            bench.scene.objects.iter_mut().take(1).for_each(|object| object.transform.position.x += STEP_M);
        })?;
        let smoothing_ms = self.smoothing_ms();
        let work = FrameWork::new();
        let frames_alone = work.timed(|| std::thread::sleep(COUNTED));
        let frames_beside = work.timed(|| self.turn_for(COUNTED));
        let frames_beside_render = work.timed(|| self.turn_beside_a_render());
        Ok(TracedReport {
            scene: self.scene.name.clone(),
            width: self.size.0,
            height: self.size.1,
            lights: self.scene.lights.iter().filter(|light| light.on).count(),
            threads: self.pace.threads(),
            frames,
            opened_ms,
            prepared_ms: spread(&mut self.updates),
            light_moved_ms,
            thing_moved_ms,
            dimmed_ms,
            view_turned_ms,
            reused,
            covered_s,
            mpaths_s,
            smoothing_ms,
            frames_alone,
            frames_beside,
            frames_beside_render,
        })
    }

    /// How much longer a picture takes to develop with its grain smoothed; the quickest of some.
    fn smoothing_ms(&self) -> f64 {
        let (picture, mut smoother) = (self.pace.picture(), Smoother::default());
        let quickest = |develop: &mut dyn FnMut() -> Picture| {
            let one = |_| {
                let began = Instant::now();
                std::hint::black_box(develop());
                began.elapsed().as_secs_f64() * 1e3
            };
            (0..5).map(one).fold(f64::INFINITY, f64::min)
        };
        let smoothed = quickest(&mut || picture.develop_smooth(&self.scene, 1, &mut smoother));
        smoothed - quickest(&mut || picture.develop(&self.scene))
    }

    /// Turns the view as a user would, showing every picture.
    fn turn_for(&mut self, time: Duration) {
        let began = Instant::now();
        while began.elapsed() < time {
            self.frame.world_from_camera = turned(&self.frame.world_from_camera);
            // The scene has been shown before: it can be shown again.
            let _ = self.open();
        }
    }

    /// The same while all cores render a picture.
    fn turn_beside_a_render(&mut self) {
        let control = RenderControl::new();
        let Ok(prepared) = raytrace::prepare(&self.scene, &self.loaded.assets) else { return };
        let (width, height) = self.size;
        let settings = Settings { width, height, spp: 1 << 16, ..Settings::default() };
        std::thread::scope(|scope| {
            scope.spawn(|| {
                // As the window renders.
                let Ok(pool) = background_pool(0, "trace") else { return };
                pool.install(|| raytrace::render(&prepared, &settings, &control, &mut |_| ControlFlow::Continue(())));
            });
            self.turn_for(COUNTED);
            control.cancel();
        });
    }
}

impl TracedReport {
    fn print(&self) {
        let TracedReport { scene, width, height, lights, threads, frames, opened_ms, .. } = self;
        say(format!(
            "{scene}, {width}x{height}, {lights} lights, {threads} threads while the user works: first picture \
             {opened_ms:.0} ms after opening, a sample of every pixel {:.1} s later ({:.2} million paths a second)",
            self.covered_s, self.mpaths_s
        ));
        for (what, [median, most]) in [
            ("a light dimmed", self.dimmed_ms),
            ("the view turned", self.view_turned_ms),
            ("a light moved", self.light_moved_ms),
            ("a thing moved", self.thing_moved_ms),
        ] {
            say(format!("{what}: first picture after {median:.0} ms (median of {frames}), 90 % within {most:.0} ms"));
        }
        say(format!("of that, trees and tables {:.0} ms", self.prepared_ms[0]));
        say(format!("smoothing the grain takes {:.0} ms a picture", self.smoothing_ms));
        let told = |frames: Frames| format!("{:.0} frames/s, 99 % within {:.0} ms", frames.per_second, frames.most_ms);
        say(format!(
            "a window that works 8 ms a frame: alone {}; beside the traced view {}; beside a render, too, {}",
            told(self.frames_alone),
            told(self.frames_beside),
            told(self.frames_beside_render)
        ));
        say(format!("turned {} times, the view takes over {:.0} % of its pixels", self.frames, self.reused * 100.0));
    }
}

/// Median and nine of ten; there is at least one.
fn spread(times: &mut [f64]) -> [f64; 2] {
    times.sort_by(f64::total_cmp);
    [0.5, 0.9].map(|part: f64| times[((times.len() - 1) as f64 * part).round() as usize])
}

/// A view turned about the vertical line through what lies ahead of it.
fn turned(world_from_camera: &Affine3A) -> Affine3A {
    let pivot = world_from_camera.transform_point3(Vec3::NEG_Z * PIVOT_M);
    let turn = Affine3A::from_quat(Quat::from_rotation_y(TURN_RAD));
    Affine3A::from_translation(pivot) * turn * Affine3A::from_translation(-pivot) * *world_from_camera
}
