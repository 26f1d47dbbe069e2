//! Replay of a failed test: the command that traces one sample of its pictures again, with every step.
//!
//! [`remember`] keeps the last pictures of each test. When a test panics, their scenes are written to files, and the
//! command for the pixel farthest from the mean of each picture is printed below the failure.

use catchlight::io::write_scene;
use catchlight::photo::Picture;
use catchlight::raytrace::{self, Method, Settings, Shortcut};
use catchlight::scene::{AssetRef, Assets, Scene};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::Path;
use std::sync::Once;

/// Number of pictures kept: an assertion compares two at most.
const KEPT: usize = 2;

thread_local! {
    /// The last pictures of the test that runs in this thread, the newest last.
    static LAST: RefCell<VecDeque<Rendered>> = const { RefCell::new(VecDeque::new()) };
}

/// A picture with what it was rendered from.
struct Rendered {
    scene: Scene,
    assets: Assets,
    settings: Settings,
    /// The shortcuts of the render plan that were not taken.
    without: &'static [Shortcut],
    picture: Picture,
}

/// Keeps a picture, so that a failure of this test prints how to trace its worst pixel again.
pub fn remember(scene: &Scene, assets: &Assets, settings: &Settings, without: &'static [Shortcut], picture: &Picture) {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let report_panic = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            report_panic(panic);
            print_commands();
        }));
    });
    LAST.with_borrow_mut(|last| {
        while last.len() >= KEPT {
            last.pop_front();
        }
        last.push_back(Rendered {
            scene: scene.clone(),
            assets: assets.clone(),
            settings: settings.clone(),
            without,
            picture: picture.clone(),
        });
    });
}

/// Writes the scenes of this thread's pictures to files and prints the commands.
#[expect(clippy::print_stderr, reason = "a failure is reported")]
fn print_commands() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("replay");
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("test").replace("::", "-");
    let _ = LAST.try_with(|last| {
        let Ok(last) = last.try_borrow() else { return };
        for (number, rendered) in last.iter().enumerate() {
            let file = folder.join(format!("{test}-{number}.ron"));
            let written =
                std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&file, write_scene(&rendered.scene)));
            match written {
                Ok(()) => eprintln!("{}", rendered.description(&file)),
                Err(error) => eprintln!("can't write the scene: {error}: {}", file.display()),
            }
        }
    });
}

impl Rendered {
    /// Returns the pixel whose green value is farthest from the mean of the picture, with both values.
    fn worst_pixel(&self) -> ((u32, u32), f32, f32) {
        let Picture { width, rgb, .. } = &self.picture;
        let mean = rgb.iter().map(|pixel| pixel[1]).sum::<f32>() / rgb.len() as f32;
        let distance = |index: &usize| (rgb[*index][1] - mean).abs();
        let worst = (0..rgb.len()).max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        ((worst as u32 % width, worst as u32 / width), rgb[worst][1], mean)
    }

    /// Returns the command that traces the brightest sample of the worst pixel again.
    fn description(&self, file: &Path) -> String {
        let ((x, y), value, mean) = self.worst_pixel();
        let Settings { width, height, spp, seed, .. } = self.settings;
        let method = match self.settings.method {
            Method::Path => "path",
            Method::Direct => "direct",
            Method::Whitted => "whitted",
        };
        let depth = self.settings.max_depth.map_or(String::new(), |depth| format!(" --max-depth {depth}"));
        let caustics = if self.without.contains(&Shortcut::Photons) { " --caustics paths" } else { "" };
        let sample = self.brightest_sample((x, y)).map_or(String::new(), |index| format!(" --sample {index}"));
        let needs_files = self.scene.assets().any(|(_, asset)| !matches!(asset, AssetRef::Figure(_)));
        let note = if needs_files { "\n(models and textures of this scene exist in the test alone)" } else { "" };
        format!(
            "pixel {x},{y} is farthest from the mean of a picture of this test: {value} for {mean}. To trace it again:\n\
             catchlight render '{}' --method {method} --size {width}x{height} --spp {spp}{depth}{caustics} \
             --seed {seed} --explain-pixel {x},{y}{sample}{note}",
            file.display()
        )
    }

    fn brightest_sample(&self, pixel: (u32, u32)) -> Option<u32> {
        let mut prepared = raytrace::prepare(&self.scene, &self.assets).ok()?;
        let plan = self.without.iter().fold(prepared.plan().clone(), |plan, shortcut| plan.without(*shortcut));
        prepared.set_plan(plan);
        Some(raytrace::brightest_sample(&prepared, &self.settings, pixel))
    }
}
