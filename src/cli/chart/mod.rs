//! `catchlight chart`: speed against accuracy, and rays a second by intersection method.

mod accuracy;
mod drawing;
mod reference;
mod scaling;
mod traversal;

use super::{Failure, input};
use crate::raytrace::IntersectionMethod;
use std::path::PathBuf;

/// Arguments of `chart`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Studios: .ron files, or names of shipped ones [default: three_point, product_still_life].
    #[arg(conflicts_with = "traversal")]
    scenes: Vec<PathBuf>,
    /// Folder for chart.csv, chart.md and a drawing (.svg) a studio, and for references, which are kept for the next
    /// time; made if it is not there.
    #[arg(short, long, value_name = "DIR", required_unless_present_any = ["traversal", "scaling"], conflicts_with_all = ["traversal", "scaling"])]
    output: Option<PathBuf>,
    /// Picture size in pixels, WIDTHxHEIGHT.
    #[arg(long, value_parser = input::parse_size, default_value = "120x80")]
    size: (u32, u32),
    /// Most samples a pixel that are timed; each method is timed at 1, 4, 16 ... of them.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    spp: u32,
    /// Samples a pixel of the reference, of its own seed [default: 32 times --spp].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    reference_spp: Option<u32>,
    /// Compare ways to find the closest hit in this OBJ model: every triangle, a box a part, our tree.
    #[arg(long, value_name = "MESH.obj")]
    traversal: Option<PathBuf>,
    /// Rays for --traversal: little-endian f32, six a ray: origin, direction [default: see --ray-kind].
    #[arg(long, value_name = "RAYS.bin", requires = "traversal", conflicts_with = "ray_kind")]
    rays: Option<PathBuf>,
    /// Rays for --traversal, made here.
    #[arg(long, value_enum, default_value_t, requires = "traversal")]
    ray_kind: traversal::RayKind,
    /// Measure only this way of --traversal; may be given several times.
    #[arg(long, value_parser = traversal::parse_method, requires = "traversal")]
    way: Vec<IntersectionMethod>,
    /// Show how build time, tracing and memory grow with triangles, lights and pixels.
    #[arg(long, conflicts_with_all = ["traversal", "scenes"])]
    scaling: bool,
    /// What --scaling takes.
    #[command(flatten)]
    range: scaling::Range,
    /// Print one JSON value with the results.
    #[arg(long)]
    json: bool,
}

/// Runs the study that was asked for.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.scaling {
        return scaling::run(&arguments.range, arguments.json);
    }
    match (&arguments.traversal, &arguments.output) {
        (Some(model), _) => {
            let methods = if arguments.way.is_empty() { &IntersectionMethod::ALL[..] } else { &arguments.way };
            traversal::run(model, arguments.rays.as_deref(), arguments.ray_kind, methods, arguments.json)
        }
        (None, Some(folder)) => accuracy::run(arguments, folder),
        (None, None) => Err(Failure::Input(anyhow::anyhow!("name a folder for the chart: -o DIR"))),
    }
}
