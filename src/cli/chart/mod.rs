//! `catchlight chart`: speed against accuracy, and rays per second by intersection method.

mod accuracy;
mod accuracy_row;
mod caustics;
mod drawing;
mod flip;
mod front;
mod noise;
mod picture_error;
mod reference;
mod scaling;
mod traversal;
mod voxel_drawing;
mod voxel_row;
mod voxels;

use super::failure::Failure;
use super::input;
use crate::raytrace::IntersectionMethod;
use accuracy::AccuracyInput;
use std::path::PathBuf;

/// Arguments of `chart`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Studios: .ron files, or names of shipped ones [default: three_point, product_still_life].
    #[arg(conflicts_with = "traversal")]
    scenes: Vec<PathBuf>,
    /// Folder for chart.csv, chart.md, front.md, one drawing (.svg) per studio, and the references, which are reused the next
    /// time. It is created if it does not exist.
    #[arg(short, long, value_name = "DIR", required_unless_present_any = ["traversal", "scaling", "noise", "caustics"], conflicts_with_all = ["traversal", "scaling", "noise", "caustics"])]
    output: Option<PathBuf>,
    /// Picture size in pixels, WIDTHxHEIGHT.
    #[arg(long, value_parser = input::parse_size, default_value = "120x80")]
    size: (u32, u32),
    /// Largest number of samples per pixel; each method is timed with 1, 4, 16 ... samples up to it.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    spp: u32,
    /// Samples per pixel of the reference [default: 32 times --spp].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    reference_spp: Option<u32>,
    /// Compare methods of finding the closest hit in this OBJ model: every triangle, one box per part, our BVH.
    #[arg(long, value_name = "MESH.obj")]
    traversal: Option<PathBuf>,
    /// Rays for --traversal: little-endian f32, six per ray: origin, direction [default: see --ray-kind].
    #[arg(long, value_name = "RAYS.bin", requires = "traversal", conflicts_with = "ray_kind")]
    rays: Option<PathBuf>,
    /// Kind of the generated rays for --traversal.
    #[arg(long, value_enum, default_value_t, requires = "traversal")]
    ray_kind: traversal::RayKind,
    /// Measure only this method of --traversal; may be given several times.
    #[arg(long, value_parser = traversal::parse_method, requires = "traversal")]
    way: Vec<IntersectionMethod>,
    /// Measure build time, trace time and memory against the number of triangles, lights, pixels and threads.
    #[arg(long, conflicts_with_all = ["traversal", "scenes"])]
    scaling: bool,
    /// Compare the noise that renders state with their scatter over 16 seeds, on the studios [default: all shipped
    /// ones], for 4, 8, 16 ... samples up to --spp.
    #[arg(long, conflicts_with_all = ["traversal", "scaling", "reference_spp"])]
    noise: bool,
    /// Compare the caustic of a mirror's edge in close-ups with its closed form, for 1, 4, 16 ... samples up to --spp.
    #[arg(long, conflicts_with_all = ["traversal", "scaling", "noise", "scenes", "reference_spp"])]
    caustics: bool,
    /// Measure the time of a frame of cells against bounces and view distance: by every cell, by bricks, by the BVH; writes
    /// voxels.csv, voxels.svg and voxels.md into the folder.
    #[arg(long, requires = "output", conflicts_with_all = ["traversal", "scaling", "noise", "caustics", "scenes", "reference_spp"])]
    voxels: bool,
    /// Ranges of --scaling.
    #[command(flatten)]
    range: scaling::ScalingRange,
    /// Print one JSON value with the results.
    #[arg(long)]
    json: bool,
}

/// Runs the requested study.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.scaling {
        return scaling::run(&arguments.range, arguments.json);
    }
    if arguments.noise {
        return noise::run(&arguments.scenes, arguments.size, arguments.spp, arguments.json);
    }
    if arguments.caustics {
        return caustics::run(arguments.spp, arguments.json);
    }
    if let (true, Some(folder)) = (arguments.voxels, &arguments.output) {
        return voxels::run(folder, arguments.json);
    }
    match (&arguments.traversal, &arguments.output) {
        (Some(model), _) => {
            let methods = if arguments.way.is_empty() { &IntersectionMethod::ALL[..] } else { &arguments.way };
            traversal::run(model, arguments.rays.as_deref(), arguments.ray_kind, methods, arguments.json)
        }
        (None, Some(folder)) => {
            let Arguments { scenes, size, spp, reference_spp, json, .. } = arguments;
            let (size, spp, reference_spp, json) = (*size, *spp, *reference_spp, *json);
            accuracy::run(&AccuracyInput { scenes, size, spp, reference_spp, json }, folder)
        }
        (None, None) => Err(Failure::Input(anyhow::anyhow!("name a folder for the chart: -o DIR"))),
    }
}
