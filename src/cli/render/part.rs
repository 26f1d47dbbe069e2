//! `catchlight render --samples A..B`: a part of a picture, for farms.

use super::arguments::Arguments;
use super::progress::ProgressDisplay;
use super::report::RenderReport;
use super::{print_plan, tell_memory, warn_of_nonfinite};
use crate::cli::failure::Failure;
use crate::cli::{picture_output, terminal};
use crate::io::{self, Loaded, PictureInfo, PicturePart, RenderId};
use crate::jobs::{self, RenderInput, RenderMonitor, RenderStage, RenderedPart};
use crate::raytrace::{GeometryCache, RenderControl, Settings};
use rayon::ThreadPool;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// The render of a part.
#[derive(Debug)]
pub struct PartRender<'a> {
    /// The command line.
    pub arguments: &'a Arguments,
    /// The studio.
    pub loaded: &'a Loaded,
    /// The settings of the whole picture.
    pub settings: &'a Settings,
    /// The threads.
    pub pool: &'a ThreadPool,
    /// When the process began.
    pub started: Instant,
    /// Time to load the studio, seconds.
    pub load_s: f64,
}

impl PartRender<'_> {
    /// Renders the samples, writes the part and prints the statistics. An interrupted part is kept with the samples
    /// that it has.
    pub fn run(
        &self,
        samples: Range<u32>,
        control: Arc<RenderControl>,
        interrupted: &AtomicBool,
    ) -> Result<(), Failure> {
        let own = Settings { spp: samples.end - samples.start, ..self.settings.clone() };
        let monitor = Arc::new(RenderMonitor::new(&own, control));
        let rendered = self.render(samples.clone(), &monitor)?;
        let interrupted = interrupted.load(Ordering::Relaxed);
        if rendered.part.samples == 0 {
            terminal::progress("interrupted before the first sample of every pixel was done; nothing is written");
            return Err(Failure::Interrupted);
        }
        let nonfinite = rendered.part.nonfinite;
        warn_of_nonfinite(self.arguments, self.settings, &nonfinite);
        let report = self.report(&rendered, &monitor, interrupted);
        let part = self.part(rendered, samples.start);
        let written = picture_output::write(&io::encode_part(self.arguments.output(), &part)?)?;
        let output = written.path.display().to_string();
        let wall_s = self.started.elapsed().as_secs_f64();
        RenderReport { nonfinite: nonfinite.count, wall_s, output, ..report }.print(self.arguments.json)?;
        written.finish()?;
        if !interrupted {
            return Ok(());
        }
        let (has, asked) = (&part.samples, &samples);
        terminal::warning(format_args!(
            "interrupted: the part has the samples {}..{}, not {}..{}",
            has.start, has.end, asked.start, asked.end
        ));
        Err(Failure::Interrupted)
    }

    fn render(&self, samples: Range<u32>, monitor: &Arc<RenderMonitor>) -> Result<RenderedPart, Failure> {
        let (scene, assets, cache) = (&self.loaded.scene, &self.loaded.assets, GeometryCache::default());
        let input =
            RenderInput { without: self.arguments.without(), ..RenderInput::new(scene, assets, &cache, self.settings) };
        let mut display = None;
        let rendered = jobs::render_part(&input, samples, self.pool, monitor, &mut |stage| {
            if let RenderStage::Prepared(scene, memory) = stage {
                tell_memory(memory, self.arguments.explain);
                if self.arguments.explain {
                    print_plan(scene, self.arguments.json);
                }
                display = Some(ProgressDisplay::start(monitor.clone(), self.arguments.progress));
            }
        });
        drop(display);
        Ok(rendered?)
    }

    fn part(&self, rendered: RenderedPart, first: u32) -> PicturePart {
        let (scene, assets) = (&self.loaded.scene, &self.loaded.assets);
        let sums = rendered.part;
        let settings = format!("part {:?} {:?}", self.settings, self.arguments.without());
        PicturePart {
            render: RenderId::new(scene, assets, &settings),
            studio: scene.title(),
            samples: first..first + sums.samples,
            of: self.settings.spp,
            info: PictureInfo::new(scene, &rendered.method, sums.samples, self.arguments.seed.into()),
            sums,
        }
    }

    /// Returns the statistics, without what is known once the file is written.
    fn report(&self, rendered: &RenderedPart, monitor: &RenderMonitor, interrupted: bool) -> RenderReport {
        let seconds = |then: Option<Instant>| then.map_or(0.0, |then| (then - self.started).as_secs_f64());
        let rays = monitor.control().rays();
        let first_wave_s = seconds(monitor.first_pass());
        RenderReport {
            width: self.settings.width,
            height: self.settings.height,
            spp: rendered.part.samples,
            mean_spp: f64::from(rendered.part.samples),
            threads: self.pool.current_num_threads(),
            method: self.arguments.method.label(),
            seed: self.arguments.seed,
            triangles: rendered.scene.triangle_count(),
            lights: rendered.scene.light_count(),
            load_s: self.load_s,
            build_s: rendered.build_s,
            trace_s: rendered.trace_s,
            denoise_s: None,
            wall_s: 0.0,
            first_picture_s: first_wave_s,
            first_wave_s,
            rays,
            mrays_s: rays as f64 / rendered.trace_s.max(1e-9) / 1e6,
            photons: rendered.has_photons,
            // Of this part alone; the merge tells that of the picture.
            noise_stops: None,
            nonfinite: 0,
            interrupted,
            output: String::new(),
        }
    }
}
