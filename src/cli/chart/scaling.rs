//! `catchlight chart --scaling`: build time, trace time and memory against the number of triangles, lights, pixels and
//! threads.
//!
//! In theory the build time is linear in the number of triangles and a ray's time in its logarithm; the time of light
//! sampling is linear in the number of lights if each is evaluated; that of a picture is linear in its pixels, and
//! inverse to the number of threads while each has a core.

use crate::cli::failure::Failure;
use crate::cli::{input, light_crowd, terminal};
use crate::io::{self, Loaded};
use crate::jobs::render_all_passes;
use crate::raytrace::{self, RenderControl, Settings};
use crate::scene::{
    Aim, Assets, Camera, Emitter, Light, LightId, Mesh, Object, ObjectId, Output, Room, Scene, Shape, Transform,
};
use anyhow::{Context, anyhow};
use glam::Vec3;
use serde::Serialize;
use std::f32::consts::{PI, TAU};
use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

/// Ranges of the study.
#[derive(Debug, clap::Args)]
pub struct ScalingRange {
    /// Numbers of triangles of --scaling.
    #[arg(long, value_delimiter = ',', value_name = "N,...", requires = "scaling", value_parser = clap::value_parser!(u64).range(8..=100_000_000), default_values_t = [10_000, 100_000, 1_000_000, 10_000_000])]
    triangles: Vec<u64>,
    /// Numbers of lights of --scaling, around five figures.
    #[arg(long, value_delimiter = ',', value_name = "N,...", requires = "scaling", value_parser = clap::value_parser!(u32).range(1..=100_000), default_values_t = [1, 10, 100, 1000])]
    lights: Vec<u32>,
    /// Picture sizes of --scaling; the first one is that of the study of threads, too.
    #[arg(long, value_delimiter = ',', value_name = "WIDTHxHEIGHT,...", requires = "scaling", value_parser = input::parse_size, default_value = "640x480,1920x1080,3840x2160,7680x4320")]
    sizes: Vec<(u32, u32)>,
    /// Numbers of threads of --scaling [default: 1, 2, 4 ... and the number of cores].
    #[arg(long, value_delimiter = ',', value_name = "N,...", requires = "scaling", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<Vec<u32>>,
}

/// Picture size of the studies of triangles and lights.
const SIZE: (u32, u32) = (320, 240);
/// Samples per pixel of the studies of triangles, lights and threads.
const SPP: u32 = 4;

/// One measurement.
#[derive(Debug, Serialize)]
struct ScalingRow {
    /// Varied quantity: `triangles`, `lights`, `pixels` or `threads`.
    varies: &'static str,
    /// Value of the varied quantity.
    count: u64,
    triangles: u64,
    lights: usize,
    /// Time to build BVHs and tables, seconds.
    prepare_s: f64,
    trace_s: f64,
    /// Millions of rays per second, all threads.
    mrays_s: f64,
    paths: u64,
    /// Growth of the process's resident memory by the build, MB; null where the system does not report it.
    memory_mb: Option<f64>,
    /// Parallel efficiency: the speedup over the first number of threads, divided by the ratio of both numbers. Null in
    /// the other studies.
    efficiency: Option<f64>,
}

/// Measures and prints.
pub fn run(range: &ScalingRange, json: bool) -> Result<(), Failure> {
    let mut rows = Vec::new();
    for &count in &range.triangles {
        let (scene, assets) = bumpy_ball(count);
        rows.push(measure("triangles", count, &scene, &assets, SIZE, SPP)?);
    }
    let studio = io::find_preset("three_point").context("the studio three_point is not shipped")?.load()?;
    let crowd = light_crowd::five_figures(&studio.scene).context("the studio three_point has no figure")?;
    for &count in &range.lights {
        let lit = light_crowd::lit_by(&crowd, count);
        rows.push(measure("lights", count.into(), &lit, &studio.assets, SIZE, SPP)?);
    }
    for &(width, height) in &range.sizes {
        let pixels = u64::from(width) * u64::from(height);
        rows.push(measure("pixels", pixels, &studio.scene, &studio.assets, (width, height), 1)?);
    }
    let counts = range.threads.clone().unwrap_or_else(up_to_all_cores);
    if let Some(size) = range.sizes.first() {
        rows.extend(measure_threads(&counts, &studio, *size)?);
    }
    if json {
        terminal::result(serde_json::to_string(&rows).context("can't write the results")?);
    } else {
        terminal::result(table(&rows).trim_end());
    }
    Ok(())
}

/// Returns the powers of two below the number of cores, and that number.
fn up_to_all_cores() -> Vec<u32> {
    let cores = std::thread::available_parallelism().map_or(1, |cores| u32::try_from(cores.get()).unwrap_or(1));
    let powers = std::iter::successors(Some(1_u32), |threads| threads.checked_mul(2));
    powers.take_while(|threads| *threads < cores).chain([cores]).collect()
}

/// Measures a studio with numbers of threads.
fn measure_threads(counts: &[u32], studio: &Loaded, size: (u32, u32)) -> Result<Vec<ScalingRow>, Failure> {
    let mut rows: Vec<ScalingRow> = Vec::new();
    for &threads in counts {
        let pool = input::thread_pool(threads as usize)?;
        let mut row = pool.install(|| measure("threads", threads.into(), &studio.scene, &studio.assets, size, SPP))?;
        let first = rows.first().unwrap_or(&row);
        row.efficiency = Some(first.thread_seconds() / row.thread_seconds());
        rows.push(row);
    }
    Ok(rows)
}

impl ScalingRow {
    /// Returns the time of all threads together while they trace, in the study of threads.
    fn thread_seconds(&self) -> f64 {
        self.trace_s * self.count as f64
    }
}

fn measure(
    varies: &'static str,
    count: u64,
    scene: &Scene,
    assets: &Assets,
    (width, height): (u32, u32),
    spp: u32,
) -> Result<ScalingRow, Failure> {
    terminal::progress(format_args!("{count} {varies} ..."));
    let before = resident_mb();
    let started = Instant::now();
    let prepared = raytrace::prepare(scene, assets)?;
    let prepare_s = started.elapsed().as_secs_f64();
    let memory_mb = resident_mb().zip(before).map(|(after, before)| (after - before).max(0.0));
    let control = RenderControl::new();
    let settings = Settings { width, height, spp, ..Settings::default() };
    let started = Instant::now();
    let film = render_all_passes(&prepared, &settings, &control);
    let trace_s = started.elapsed().as_secs_f64();
    if film.spp() < spp {
        return Err(Failure::Machine(anyhow!("the picture of {count} {varies} was not finished")));
    }
    Ok(ScalingRow {
        varies,
        count,
        triangles: prepared.triangle_count(),
        lights: prepared.light_count(),
        prepare_s,
        trace_s,
        mrays_s: control.rays() as f64 / trace_s.max(1e-9) / 1e6,
        paths: u64::from(width) * u64::from(height) * u64::from(spp),
        memory_mb,
        efficiency: None,
    })
}

/// Returns the resident memory of this process, MB; none without /proc.
fn resident_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

/// Returns a ball with bumps of about `triangles` triangles, in a room under a softbox.
fn bumpy_ball(triangles: u64) -> (Scene, Assets) {
    const NAME: &str = "bumpy ball";
    let mut assets = Assets::default();
    assets.insert_mesh(NAME, Arc::new(bumpy_mesh(triangles)));
    let ball = Object {
        id: ObjectId(1),
        transform: Transform::at(Vec3::Y),
        ..Object::new("Ball", Shape::MeshFile { path: NAME.to_owned() })
    };
    let softbox = Light {
        id: LightId(2),
        position: Vec3::new(1.2, 2.0, 1.5),
        aim: Aim::Point(Vec3::Y),
        ..Light::new(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, Output::Lumens(8000.0))
    };
    let camera = Camera { position: Vec3::new(0.0, 1.2, 2.6), aim: Aim::Point(Vec3::Y), ..Camera::default() };
    let scene =
        Scene { camera, room: Some(Room::default()), objects: vec![ball], lights: vec![softbox], ..Scene::default() };
    (scene, assets)
}

/// Returns a sphere of rings and sectors, two triangles each; those at the poles have no area.
fn bumpy_mesh(triangles: u64) -> Mesh {
    // Four triangles a ring and sector pair; at most 100 million triangles are accepted
    let rings = u32::try_from((triangles / 4).isqrt()).unwrap_or(u32::MAX).max(2);
    let sectors = 2 * rings;
    let point = |ring: u32, sector: u32| {
        let (down, around) = (ring as f32 / rings as f32 * PI, sector as f32 / sectors as f32 * TAU);
        let radius = 0.5 + 0.03 * (9.0 * down).sin() * (11.0 * around).sin();
        Vec3::new(down.sin() * around.cos(), down.cos(), -down.sin() * around.sin()) * radius
    };
    let positions = (0..=rings).flat_map(|ring| (0..sectors).map(move |sector| point(ring, sector))).collect();
    let corner = |ring: u32, sector: u32| ring * sectors + sector % sectors;
    let quads = (0..rings).flat_map(|ring| (0..sectors).map(move |sector| (ring, sector)));
    let triangles = quads.flat_map(|(ring, sector)| {
        let [a, b] = [corner(ring, sector), corner(ring + 1, sector)];
        let [c, d] = [corner(ring + 1, sector + 1), corner(ring, sector + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh { positions, triangles: triangles.collect(), ..Mesh::default() }.with_single_part("ball")
}

fn table(rows: &[ScalingRow]) -> String {
    let mut text =
        "| varies | count | triangles | lights | prepare, s | trace, s | Mrays/s | us a path | memory, MB | efficiency |\n\
                    |---|---|---|---|---|---|---|---|---|---|\n"
            .to_owned();
    for row in rows {
        let ScalingRow { varies, count, triangles, lights, prepare_s, trace_s, mrays_s, paths, .. } = row;
        let path_us = trace_s / *paths as f64 * 1e6;
        let memory = row.memory_mb.map_or("-".to_owned(), |mb| format!("{mb:.0}"));
        let efficiency = row.efficiency.map_or("-".to_owned(), |part| format!("{:.0} %", part * 100.0));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {varies} | {count} | {triangles} | {lights} | {prepare_s:.3} | {trace_s:.3} | {mrays_s:.2} | {path_us:.2} \
             | {memory} | {efficiency} |"
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ball_is_closed_and_has_the_requested_number_of_triangles() {
        let mesh = bumpy_mesh(10_000);
        assert_eq!(mesh.triangles.len(), 10_000);
        // Every edge belongs to two triangles, in opposite directions.
        let mut edges = std::collections::HashMap::<(u32, u32), i32>::new();
        for [a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((*from.min(to), *from.max(to))).or_default() += if from < to { 1 } else { -1 };
            }
        }
        let inner = |edge: &(u32, u32)| edge.0 >= 100 && edge.1 < 50 * 100;
        assert!(edges.iter().filter(|(edge, _)| inner(edge)).all(|(_, balance)| *balance == 0));
    }
}
