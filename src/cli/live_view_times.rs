//! `catchlight preview SCENE --traced`: measures the time that the live traced view takes to show a change.

use super::failure::Failure;
use super::frame_rate_beside_live_view::{FrameRate, FrameWork};
use super::percentile::percentile;
use super::terminal;
use crate::io::{self, Loaded, PictureInfo};
use crate::jobs::{Clock, LivePacing, background_pool, render_all_passes};
use crate::photo::Picture;
use crate::raytrace::{self, AtrousFilter, LiveCamera, LivePicture, RenderControl, Settings};
use crate::scene::{Assets, CameraFrame, Scene, Shape};
use anyhow::Context;
use glam::{Affine3A, Quat, Vec3};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Angle by which the view turns from one picture to the next, radians: a slow drag of the mouse.
const TURN_RAD: f32 = 0.01;
/// Distance from the camera to the point that the view turns about, metres.
const PIVOT_M: f32 = 2.0;
/// Distance that a light or an object moves in one edit, metres.
const STEP_M: f32 = 0.01;

/// The report of `--traced`. Times are from a change to the first picture that shows it, ready for the screen.
#[derive(Debug, Serialize)]
struct LiveViewReport {
    scene: String,
    width: u32,
    height: u32,
    lights: usize,
    threads: usize,
    /// Number of changes of each kind.
    frames: usize,
    /// Opening of the studio, with all its BVHs.
    opened_ms: f64,
    /// Part of the time to show a moved light or object: BVHs and tables.
    prepared_ms: [f64; 2],
    /// A moved light: median and 90th percentile.
    light_moved_ms: [f64; 2],
    /// A moved object.
    thing_moved_ms: [f64; 2],
    /// A tank whose water moved on by a step, with its simulation, on all cores; none without a tank.
    #[serde(skip_serializing_if = "Option::is_none")]
    water_moved_ms: Option<[f64; 2]>,
    /// A dimmed light, for which no ray is traced.
    dimmed_ms: [f64; 2],
    /// A slightly turned view.
    view_turned_ms: [f64; 2],
    /// Fraction of the pixels of a turned view that are reprojected from its history.
    reused: f64,
    /// Time until every pixel has a sample, seconds.
    covered_s: f64,
    /// Millions of paths per second.
    mpaths_s: f64,
    /// Time to smooth the noise of a picture, on all cores.
    smoothing_ms: f64,
    /// Frame rate of a window that works 8 ms per frame, alone.
    frames_alone: FrameRate,
    /// The same while a turning view is traced on the same cores.
    frames_beside: FrameRate,
    /// The same while a turning view is traced and a picture is rendered.
    frames_beside_render: FrameRate,
}

/// Duration of a measurement of the frame rate.
const COUNT_TIME: Duration = Duration::from_secs(3);

/// Measures and prints; with `output`, writes the finished picture instead.
pub fn run(loaded: &Loaded, size: (u32, u32), frames: u32, output: Option<&Path>, json: bool) -> Result<(), Failure> {
    let mut bench = Bench::new(loaded, size)?;
    if let Some(output) = output {
        bench.open()?;
        bench.work_until(|pacing| pacing.picture().is_converged());
        let picture = bench.pacing.picture().develop(&loaded.scene);
        let spp = bench.pacing.picture().spp();
        io::export_picture(output, &picture, &PictureInfo::new(&loaded.scene, "path", spp, 0))?;
        return Ok(());
    }
    let report = bench.measure(frames.max(1) as usize)?;
    if json {
        terminal::result(serde_json::to_string(&report)?);
    } else {
        report.print();
    }
    Ok(())
}

/// A live view under measurement.
struct Bench {
    assets: Assets,
    pacing: LivePacing,
    scene: Scene,
    frame: CameraFrame,
    size: (u32, u32),
    control: RenderControl,
    /// Time of each update without tracing, milliseconds.
    updates_ms: Vec<f64>,
}

impl Bench {
    fn new(loaded: &Loaded, size: (u32, u32)) -> Result<Self, Failure> {
        let pacing = LivePacing::new(Arc::default(), Clock::default())
            .context("no threads to trace with")
            .map_err(Failure::Machine)?;
        let frame = loaded.scene.camera_frame(size.0 as f32 / size.1 as f32);
        Ok(Bench {
            assets: loaded.assets.clone(),
            pacing,
            scene: loaded.scene.clone(),
            frame,
            size,
            control: RenderControl::new(),
            updates_ms: Vec::new(),
        })
    }

    /// Traces scene and view as they are now. Returns the time to the first picture, milliseconds.
    fn open(&mut self) -> Result<f64, Failure> {
        self.open_while(true)
    }

    /// As [`Bench::open`]; on all cores while the user does nothing.
    fn open_while(&mut self, user_is_active: bool) -> Result<f64, Failure> {
        let (began, scene) = (Instant::now(), Arc::new(self.scene.clone()));
        self.pacing.update(scene, &self.assets, LiveCamera::pinhole(self.frame, self.size))?;
        self.updates_ms.push(began.elapsed().as_secs_f64() * 1e3);
        while self.pacing.step(user_is_active, &self.control).is_none() {}
        Ok(began.elapsed().as_secs_f64() * 1e3)
    }

    fn work_until(&mut self, enough: impl Fn(&LivePacing) -> bool) {
        while !enough(&self.pacing) {
            self.pacing.step(true, &self.control);
        }
    }

    /// Returns median and 90th percentile of the times to the first picture after a number of changes.
    fn time(&mut self, frames: usize, mut change: impl FnMut(&mut Self)) -> Result<[f64; 2], Failure> {
        let mut times = Vec::with_capacity(frames);
        for _ in 0..frames {
            change(self);
            times.push(self.open()?);
        }
        Ok(quantiles(&mut times))
    }

    fn measure(&mut self, frames: usize) -> Result<LiveViewReport, Failure> {
        let opened_ms = self.open()?;
        let (began, before) = (Instant::now(), self.control.samples_done());
        self.work_until(|pacing| pacing.picture().stride() == Some(1));
        let covered_s = began.elapsed().as_secs_f64();
        let mpaths_s = (self.control.samples_done() - before) as f64 * 1e-6 / covered_s.max(1e-9);
        let dimmed_ms = self.time(frames, |bench| {
            bench.scene.lights.iter_mut().take(1).for_each(|light| light.power.dial_stops -= 0.1);
        })?;
        let view_turned_ms = self.time(frames, |bench| {
            bench.frame.world_from_camera = turned(&bench.frame.world_from_camera);
        })?;
        self.work_until(|pacing| pacing.picture().completed_steps() > LivePicture::HISTORY_STEPS);
        let reused = f64::from(self.pacing.picture().reprojected_fraction());
        let water_moved_ms = self.has_tank().then(|| self.time_water(frames)).transpose()?;
        self.updates_ms.clear();
        let light_moved_ms =
            self.time(frames, |bench| bench.scene.lights.iter_mut().take(1).for_each(|l| l.position.y += STEP_M))?;
        let thing_moved_ms = self.time(frames, |bench| {
            bench.scene.objects.iter_mut().take(1).for_each(|object| object.transform.position.x += STEP_M);
        })?;
        let smoothing_ms = self.smoothing_ms();
        let work = FrameWork::new();
        let frames_alone = work.timed(|| std::thread::sleep(COUNT_TIME));
        let frames_beside = work.timed(|| self.turn_for(COUNT_TIME));
        let frames_beside_render = work.timed(|| self.turn_beside_a_render());
        Ok(LiveViewReport {
            scene: self.scene.name.clone(),
            width: self.size.0,
            height: self.size.1,
            lights: self.scene.lights.iter().filter(|light| light.on).count(),
            threads: self.pacing.threads(),
            frames,
            opened_ms,
            prepared_ms: quantiles(&mut self.updates_ms),
            light_moved_ms,
            thing_moved_ms,
            water_moved_ms,
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

    fn has_tank(&self) -> bool {
        self.scene.objects.iter().any(|object| matches!(object.shape, Shape::Tank(_)))
    }

    /// Returns median and 90th percentile of the times to the first picture after a step of the water.
    fn time_water(&mut self, frames: usize) -> Result<[f64; 2], Failure> {
        self.work_until(|pacing| pacing.picture().stride() == Some(1));
        let mut times = Vec::with_capacity(frames);
        for _ in 0..frames {
            let began = Instant::now();
            for object in &mut self.scene.objects {
                if let Shape::Tank(tank) = &mut object.shape {
                    tank.time_s += 1.0 / tank.steps_per_s();
                }
            }
            let mut assets = self.assets.clone();
            io::load_assets(&self.scene, None, &mut assets);
            self.assets = assets;
            let simulated_ms = began.elapsed().as_secs_f64() * 1e3;
            times.push(simulated_ms + self.open_while(false)?);
        }
        Ok(quantiles(&mut times))
    }

    /// Returns the time that smoothing adds to the development of a picture: the fastest of some trials.
    fn smoothing_ms(&self) -> f64 {
        let (picture, mut filter) = (self.pacing.picture(), AtrousFilter::default());
        let fastest = |develop: &mut dyn FnMut() -> Picture| {
            let trial = |_| {
                let began = Instant::now();
                std::hint::black_box(develop());
                began.elapsed().as_secs_f64() * 1e3
            };
            (0..5).map(trial).fold(f64::INFINITY, f64::min)
        };
        let smoothed = fastest(&mut || picture.develop_filtered(&self.scene, 1, &mut filter));
        smoothed - fastest(&mut || picture.develop(&self.scene))
    }

    /// Turns the view as a user would, with a picture of each view.
    fn turn_for(&mut self, time: Duration) {
        let began = Instant::now();
        while began.elapsed() < time {
            self.frame.world_from_camera = turned(&self.frame.world_from_camera);
            // The scene has been prepared before: it can be prepared again.
            let _ = self.open();
        }
    }

    /// Turns the view while all cores render a picture.
    fn turn_beside_a_render(&mut self) {
        let control = RenderControl::new();
        let Ok(prepared) = raytrace::prepare(&self.scene, &self.assets) else { return };
        let (width, height) = self.size;
        let settings = Settings { width, height, spp: 1 << 16, ..Settings::default() };
        std::thread::scope(|scope| {
            scope.spawn(|| {
                // The pool of the window's renders.
                let Ok(pool) = background_pool(0, "trace") else { return };
                pool.install(|| render_all_passes(&prepared, &settings, &control));
            });
            self.turn_for(COUNT_TIME);
            control.cancel();
        });
    }
}

impl LiveViewReport {
    fn print(&self) {
        let LiveViewReport { scene, width, height, lights, threads, frames, opened_ms, .. } = self;
        terminal::result(format!(
            "{scene}, {width}x{height}, {lights} lights, {threads} threads while the user works: first picture \
             {opened_ms:.0} ms after opening, a sample of every pixel {:.1} s later ({:.2} million paths a second)",
            self.covered_s, self.mpaths_s
        ));
        for (change, [median, most]) in [
            ("a light dimmed", self.dimmed_ms),
            ("the view turned", self.view_turned_ms),
            ("a light moved", self.light_moved_ms),
            ("an object moved", self.thing_moved_ms),
        ]
        .into_iter()
        .chain(self.water_moved_ms.map(|times| ("the water moved on", times)))
        {
            terminal::result(format!(
                "{change}: first picture after {median:.0} ms (median of {frames}), 90 % within {most:.0} ms"
            ));
        }
        terminal::result(format!("of that, BVHs and tables {:.0} ms", self.prepared_ms[0]));
        terminal::result(format!("smoothing the noise takes {:.0} ms a picture", self.smoothing_ms));
        let rate =
            |frames: FrameRate| format!("{:.0} frames/s, 99 % within {:.0} ms", frames.per_second, frames.most_ms);
        terminal::result(format!(
            "a window that works 8 ms a frame: alone {}; beside the traced view {}; beside a render, too, {}",
            rate(self.frames_alone),
            rate(self.frames_beside),
            rate(self.frames_beside_render)
        ));
        terminal::result(format!(
            "turned {} times, the view reuses {:.0} % of its pixels",
            self.frames,
            self.reused * 100.0
        ));
    }
}

/// Returns median and 90th percentile.
fn quantiles(times: &mut [f64]) -> [f64; 2] {
    times.sort_by(f64::total_cmp);
    [50, 90].map(|percent| percentile(times, percent))
}

/// Returns a view turned about the vertical line through the point ahead of it.
fn turned(world_from_camera: &Affine3A) -> Affine3A {
    let pivot = world_from_camera.transform_point3(Vec3::NEG_Z * PIVOT_M);
    let turn = Affine3A::from_quat(Quat::from_rotation_y(TURN_RAD));
    Affine3A::from_translation(pivot) * turn * Affine3A::from_translation(-pivot) * *world_from_camera
}
