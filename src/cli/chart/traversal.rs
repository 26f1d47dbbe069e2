//! `catchlight chart --traversal MESH.obj`: rays per second by intersection method and number of threads.

use crate::cli::failure::Failure;
use crate::cli::input::thread_pool;
use crate::cli::terminal;
use crate::io;
use crate::math::{Ray, orthonormal_basis, warp};
use crate::raytrace::{IntersectionMethod, Intersector};
use crate::scene::Mesh;
use anyhow::{Context, ensure};
use clap::ValueEnum;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Kinds of generated rays.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum RayKind {
    /// From a camera in front of the model, pixel by pixel.
    #[default]
    Primary,
    /// Scattered diffusely at the hits of the primary rays, in their order.
    Bounce,
    /// Scattered rays in random order.
    Shuffled,
}

/// Edge of the picture of the primary rays, pixels.
const EDGE: u32 = 512;
/// Rays per task of a thread.
const CHUNK: usize = 4096;
/// Time for which passes over all rays are repeated, seconds. The fastest one counts: it is disturbed least.
const TIMED_S: f64 = 1.0;
/// Triangle tests per pass above which a method traces only every n-th ray.
const MOST_TESTS: u64 = 4_000_000_000;
/// Largest ray file, bytes.
const RAY_FILE_LIMIT: u64 = 4 << 30;

/// One measurement.
#[derive(Debug, Serialize)]
struct TraversalRow {
    method: &'static str,
    threads: usize,
    build_s: f64,
    mrays_s: f64,
    hits: u64,
    /// Mean distance over the hits, in multiples of the direction; null without hits.
    mean_t: Option<f64>,
    /// Rays traced: a part of the rays for methods that would take minutes.
    rays: usize,
}

/// Parses the name of an intersection method.
pub fn parse_method(name: &str) -> Result<IntersectionMethod, String> {
    let known = IntersectionMethod::ALL.map(IntersectionMethod::label);
    let found = IntersectionMethod::ALL.into_iter().find(|method| method.label() == name);
    found.ok_or_else(|| format!("there is no `{name}`, only {}", known.join(", ")))
}

/// Measures and prints.
pub fn run(
    model: &Path,
    rays: Option<&Path>,
    kind: RayKind,
    methods: &[IntersectionMethod],
    json: bool,
) -> Result<(), Failure> {
    let mesh = Arc::new(io::import_model(model)?.mesh);
    let rays = match rays {
        Some(path) => read_rays(path)?,
        None => generated_rays(&mesh, kind),
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut rows = Vec::new();
    for &method in methods {
        for threads in 1..=cores {
            rows.push(measure(&mesh, method, threads, &rays)?);
            let mrays_s = rows.last().map_or(0.0, |row: &TraversalRow| row.mrays_s);
            terminal::progress(format_args!("{} on {threads} threads: {mrays_s:.3} Mrays/s", method.label()));
        }
    }
    if json {
        terminal::result(serde_json::to_string(&rows).context("can't write the results")?);
    } else {
        terminal::result(format!("{} triangles, {} rays, closest hit\n", mesh.triangles.len(), rays.len()));
        terminal::result("| method | threads | build s | Mrays/s | hits | mean t |\n|---|---|---|---|---|---|");
        for row in rows {
            let mean_t = row.mean_t.map_or("-".to_owned(), |t| format!("{t:.5}"));
            let TraversalRow { method, threads, build_s, mrays_s, hits, rays, .. } = row;
            terminal::result(format!(
                "| {method} | {threads} | {build_s:.3} | {mrays_s:.3} | {hits} of {rays} | {mean_t} |"
            ));
        }
    }
    Ok(())
}

fn measure(
    mesh: &Arc<Mesh>,
    method: IntersectionMethod,
    threads: usize,
    rays: &[Ray],
) -> Result<TraversalRow, Failure> {
    let pool = thread_pool(threads)?;
    let started = Instant::now();
    let intersector = pool.install(|| Intersector::new(mesh, method));
    let build_s = started.elapsed().as_secs_f64();
    let tests_a_ray = if method == IntersectionMethod::Bvh { 1 } else { mesh.triangles.len() as u64 };
    let step = (rays.len() as u64 * tests_a_ray).div_ceil(MOST_TESTS).max(1);
    let rays: Vec<Ray> = rays.iter().step_by(usize::try_from(step).unwrap_or(usize::MAX)).copied().collect();
    let pass = || -> (Vec<f32>, f64) {
        let started = Instant::now();
        let distances =
            pool.install(|| rays.par_chunks(CHUNK).flat_map_iter(|chunk| intersector.distances(chunk)).collect());
        (distances, started.elapsed().as_secs_f64())
    };
    let started = Instant::now();
    let (distances, mut best_s) = pass();
    while started.elapsed().as_secs_f64() < TIMED_S {
        best_s = best_s.min(pass().1);
    }
    let hits = distances.iter().filter(|t| t.is_finite()).count() as u64;
    let sum: f64 = distances.iter().filter(|t| t.is_finite()).map(|&t| f64::from(t)).sum();
    Ok(TraversalRow {
        method: method.label(),
        threads,
        build_s,
        mrays_s: rays.len() as f64 / best_s / 1e6,
        hits,
        mean_t: (hits > 0).then(|| sum / hits as f64),
        rays: rays.len(),
    })
}

/// Reads a ray file. Fails for a size that is not a whole number of rays, and for rays that are not finite.
fn read_rays(path: &Path) -> anyhow::Result<Vec<Ray>> {
    let size = std::fs::metadata(path).with_context(|| format!("can't read the rays: {}", path.display()))?.len();
    ensure!(size <= RAY_FILE_LIMIT, "a ray file has at most {RAY_FILE_LIMIT} bytes, not {size}: {}", path.display());
    let bytes = std::fs::read(path).with_context(|| format!("can't read the rays: {}", path.display()))?;
    let ray_bytes = 6 * size_of::<f32>();
    ensure!(
        !bytes.is_empty() && bytes.len().is_multiple_of(ray_bytes),
        "a ray file holds six 4-byte floats a ray; {} bytes are not a whole number of rays: {}",
        bytes.len(),
        path.display()
    );
    let rays = bytes.chunks_exact(ray_bytes).enumerate().map(|(index, ray)| {
        let number = |i: usize| f32::from_le_bytes([ray[4 * i], ray[4 * i + 1], ray[4 * i + 2], ray[4 * i + 3]]);
        let origin = Vec3::new(number(0), number(1), number(2));
        let direction = Vec3::new(number(3), number(4), number(5));
        let usable = origin.is_finite() && direction.is_finite() && direction != Vec3::ZERO;
        ensure!(usable, "ray {index} is not valid: from {origin} along {direction}: {}", path.display());
        Ok(Ray { origin, direction, t_max: f32::INFINITY })
    });
    rays.collect()
}

/// Returns the rays of a kind for a model, the same for each call.
fn generated_rays(mesh: &Arc<Mesh>, kind: RayKind) -> Vec<Ray> {
    let primary = camera_rays(mesh);
    if matches!(kind, RayKind::Primary) {
        return primary;
    }
    let mut rays = bounced(mesh, &primary);
    if matches!(kind, RayKind::Shuffled) {
        // Fisher-Yates shuffle, with numbers from a scrambled Sobol sequence.
        for index in (1..u32::try_from(rays.len()).unwrap_or(u32::MAX)).rev() {
            let u = f64::from(sobol_burley::sample(index & 0xffff, 0, index >> 16));
            rays.swap(index as usize, below(index + 1, u));
        }
    }
    rays
}

/// Returns the number below `count` at a fraction of 0 to 1 of it.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the product is positive and below count")]
fn below(count: u32, fraction: f64) -> usize {
    (f64::from(count) * fraction) as usize
}

/// Returns the rays of a square picture that the model fills, seen from the front and a little above.
fn camera_rays(mesh: &Mesh) -> Vec<Ray> {
    let (low, high) = mesh.bounds();
    let (centre, radius) = ((low + high) * 0.5, (high - low).length() * 0.5);
    let back = Vec3::new(0.2, 0.2, 1.0).normalize();
    let (right, up) = orthonormal_basis(back);
    let origin = centre + back * (3.0 * radius);
    let pixel = |i: u32| {
        let x = (((i % EDGE) as f32 + 0.5) / EDGE as f32 - 0.5) * 2.0 * radius;
        let y = (((i / EDGE) as f32 + 0.5) / EDGE as f32 - 0.5) * 2.0 * radius;
        let direction = (centre + right * x + up * y - origin).normalize_or(-back);
        Ray { origin, direction, t_max: f32::INFINITY }
    };
    (0..EDGE * EDGE).map(pixel).collect()
}

/// Returns one ray from each hit of `rays`, cosine-distributed about the incident direction, offset from the surface.
fn bounced(mesh: &Arc<Mesh>, rays: &[Ray]) -> Vec<Ray> {
    let distances = Intersector::new(mesh, IntersectionMethod::Bvh).distances(rays);
    let hits = (0_u32..).zip(rays.iter().zip(distances)).filter(|(_, (_, t))| t.is_finite());
    hits.map(|(i, (ray, t))| {
        let [a, b, ..] = sobol_burley::sample_4d(i & 0xffff, 0, i >> 16);
        let local = warp::cosine_hemisphere(Vec2::new(a, b));
        let (tangent, bitangent) = orthonormal_basis(-ray.direction);
        let direction = tangent * local.x + bitangent * local.y - ray.direction * local.z;
        Ray { origin: ray.origin + ray.direction * (t * 0.9999), direction, t_max: f32::INFINITY }
    })
    .collect()
}
