//! `catchlight chart`: speed against accuracy.

mod traversal;

use super::Failure;
use crate::raytrace::Intersection;
use anyhow::anyhow;
use std::path::PathBuf;

/// Arguments of `chart`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
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
    way: Vec<Intersection>,
    /// Print one JSON value with the results.
    #[arg(long)]
    json: bool,
}

/// Runs the study that was asked for.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.traversal {
        Some(model) => {
            let methods = if arguments.way.is_empty() { &Intersection::ALL[..] } else { &arguments.way };
            traversal::run(model, arguments.rays.as_deref(), arguments.ray_kind, methods, arguments.json)
        }
        None => Err(Failure::Input(anyhow!("say what to chart: --traversal MESH.obj"))),
    }
}
