//! Input of the subcommands: studios, sizes, points, thread pools.

use super::failure::Failure;
use super::{terminal, warnings};
use crate::figures;
use crate::io::{self, Loaded};
use crate::scene::{Scene, Shape, placement};
use anyhow::{Context, anyhow};
use glam::Vec3;
use rayon::ThreadPool;
use std::path::{Path, PathBuf};

/// Largest picture edge, pixels.
const LARGEST_EDGE: u32 = 16384;
/// Most threads that share a core.
const THREADS_PER_CORE: usize = 4;
/// Threads that a machine of any size may start.
const MOST_THREADS: usize = 16;

/// The studio of a subcommand.
#[derive(Debug, clap::Args)]
pub struct StudioArguments {
    /// Studio: a .ron file, or the name of a shipped one.
    pub scene: PathBuf,
    /// Variant of the studio, by its name [default: the studio itself].
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Time of its water tanks, seconds since their start [default: as in the studio].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub at_time: Option<f32>,
}

impl StudioArguments {
    /// Loads the studio, shows the variant and sets the time. Warnings go to stderr.
    pub fn load(&self) -> anyhow::Result<Loaded> {
        let mut loaded = load_studio(&self.scene)?;
        if self.variant.is_none() && self.at_time.is_none() {
            return Ok(loaded);
        }
        if let Some(name) = &self.variant {
            let variants = &loaded.scene.variants;
            let names = || variants.list().map(|(_, name)| name).collect::<Vec<_>>().join(", ");
            let id =
                variants.named(name).ok_or_else(|| anyhow!("there is no variant {name:?}; there are: {}", names()))?;
            figures::show_variant(&mut loaded.scene, id);
        }
        if let Some(time_s) = self.at_time {
            set_time(&mut loaded.scene, time_s)?;
        }
        // Eyes that follow another camera belong to other figures, and water at another time is another mesh
        let folder = self.scene.parent().filter(|_| self.scene.exists());
        let mut found = io::load_assets(&loaded.scene, folder, &mut loaded.assets);
        found.extend(placement(&loaded.scene, &loaded.assets));
        found.retain(|finding| !loaded.warnings.contains(finding));
        warnings::lines(&found).iter().for_each(terminal::warning);
        Ok(loaded)
    }
}

/// Sets the time of all water tanks.
fn set_time(scene: &mut Scene, time_s: f32) -> anyhow::Result<()> {
    let mut count = 0;
    for object in &mut scene.objects {
        let Shape::Tank(tank) = &mut object.shape else { continue };
        let longest_s = tank.longest_s();
        anyhow::ensure!(
            (0.0..=longest_s).contains(&time_s),
            "--at-time {time_s}: the time of {:?} must be from 0 to {longest_s} s",
            object.name
        );
        tank.time_s = time_s;
        count += 1;
    }
    anyhow::ensure!(count > 0, "--at-time: the studio has no water tank");
    Ok(())
}

/// Loads a studio: a file, or a shipped one by name. Warnings go to stderr.
pub fn load_studio(scene: &Path) -> anyhow::Result<Loaded> {
    let shipped = if scene.exists() { None } else { scene.to_str().and_then(io::find_preset) };
    let loaded = match shipped {
        Some(preset) => preset.load().with_context(|| format!("the shipped studio {}", preset.file_name))?,
        None => io::load_scene(scene)?,
    };
    warnings::lines(&loaded.warnings).iter().for_each(terminal::warning);
    Ok(loaded)
}

/// Fails for a studio that is neither a file nor shipped, before a window is opened for it.
pub fn check_exists(scene: &Path) -> anyhow::Result<()> {
    anyhow::ensure!(
        scene.exists() || scene.to_str().is_some_and(|name| io::find_preset(name).is_some()),
        "neither a command, nor a studio file, nor a shipped studio: {}",
        scene.display()
    );
    Ok(())
}

/// Parses a picture size like `1920x1280`.
pub fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let wrong = || format!("`{text}` is not a picture size: write WIDTHxHEIGHT in pixels, such as 1920x1280");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let edge = |side: &str| side.trim().parse::<u32>().ok().filter(|n| *n > 0).ok_or_else(wrong);
    let (width, height) = (edge(width)?, edge(height)?);
    if width > LARGEST_EDGE || height > LARGEST_EDGE {
        return Err(format!("a picture edge has at most {LARGEST_EDGE} pixels, not {}", width.max(height)));
    }
    Ok((width, height))
}

/// Parses a pixel like `120,80`.
pub fn parse_pixel(text: &str) -> Result<(u32, u32), String> {
    let pixel = text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    pixel.ok_or_else(|| format!("`{text}` is no pixel: write X,Y from the top left, such as 120,80"))
}

/// Parses a point or direction like `0,1.4,-0.1`.
pub fn parse_vec3(text: &str) -> Result<Vec3, String> {
    let wrong = || format!("`{text}` is not a point: write X,Y,Z in metres, such as 0,1.4,-0.1");
    let parts: Vec<f32> =
        text.split(',').map(|part| part.trim().parse().map_err(|_| wrong())).collect::<Result<_, _>>()?;
    let vector = <[f32; 3]>::try_from(parts).map(Vec3::from).map_err(|_| wrong())?;
    if vector.is_finite() { Ok(vector) } else { Err(wrong()) }
}

/// Returns a pool of `threads` threads, or of one per core for 0. More threads than the cores can use are left out,
/// with a warning: they would spend the time on waiting for each other.
pub fn thread_pool(threads: usize) -> Result<ThreadPool, Failure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = MOST_THREADS.max(THREADS_PER_CORE * cores);
    if threads > most {
        terminal::warning(format_args!("{threads} threads are too many for {cores} cores; {most} are used"));
    }
    let threads = threads.min(most);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| Failure::Machine(anyhow!(error).context("can't start the threads")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn valid_sizes_are_parsed_and_others_are_errors() {
        assert_eq!(parse_size("640x480"), Ok((640, 480)));
        for wrong in ["640", "0x5", "x", "-3x4", "1e3x5", "99999x1", "640x480x3"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn points_have_three_finite_numbers() {
        assert_eq!(parse_vec3("-1, 2.5,3e-1"), Ok(Vec3::new(-1.0, 2.5, 0.3)));
        for wrong in ["1,2", "1,2,3,4", "", "a,b,c", "1;2;3", "NaN,0,0", "0,inf,0", "1e39,0,0"] {
            assert!(parse_vec3(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn pixels_are_pairs_of_whole_numbers() {
        assert_eq!(parse_pixel("12, 7"), Ok((12, 7)));
        for wrong in ["12", "1,-2", "a,b", "1,2,3"] {
            assert!(parse_pixel(wrong).unwrap_err().contains(wrong));
        }
    }
}
