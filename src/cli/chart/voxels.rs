//! `catchlight chart --voxels`: time of a frame of a landscape of cells against the number of bounces and the view
//! distance, by every cell, by bricks, and by the BVH over the faces of the cells.
//!
//! All ways trace the same rays: those of a camera over the landscape, and at each hit a diffusely scattered one. A ray
//! ends at the view distance.

use super::voxel_drawing;
use super::voxel_row::{VoxelRow, Way};
use crate::cli::failure::Failure;
use crate::cli::terminal;
use crate::math::{Ray, orthonormal_basis, warp};
use crate::raytrace::{IntersectionMethod, Intersector, VoxelGrid, VoxelWay};
use crate::scene::{Tank, TankLook, Terrain};
use crate::water::{FULL, Simulation, surface_of};
use anyhow::Context;
use glam::{Vec2, Vec3};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Cells of the landscape.
const CELLS: [u16; 3] = [128, 64, 128];
/// Height of the camera over the ground, cells.
const EYE_CELLS: f32 = 4.0;
/// Picture size, pixels.
const SIZE: (u32, u32) = (320, 200);
/// Numbers of bounces.
const BOUNCES: [usize; 4] = [1, 2, 4, 8];
/// View distances, cells.
const DISTANCES: [f32; 8] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0];
/// Seed of the scattered directions.
const SEED: u32 = 3;
/// Time for which passes over all rays are repeated, seconds. The fastest one counts: it is disturbed least.
const TIMED_S: f64 = 0.15;

/// The landscape, prepared for all ways.
struct Landscape {
    /// Place of the camera.
    eye: Vec3,
    grid: VoxelGrid,
    bvh: Intersector,
}

/// Measures, writes voxels.csv, voxels.svg and voxels.md into a folder, and prints the table.
pub fn run(folder: &Path, json: bool) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).with_context(|| format!("can't create {}", folder.display()))?;
    let landscape = Landscape::new(CELLS);
    let mut rows = Vec::new();
    for distance in DISTANCES {
        terminal::progress(format_args!("a view of {distance} cells ..."));
        rows.extend(landscape.measure(distance, SIZE, TIMED_S));
    }
    let table = table(&rows);
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).with_context(|| format!("can't write {}", path.display()))
    };
    write("voxels.csv", &csv(&rows))?;
    write("voxels.md", &table)?;
    voxel_drawing::draw(&folder.join("voxels.svg"), &rows)?;
    if json {
        terminal::result(serde_json::to_string(&rows).context("can't print the results")?);
    } else {
        terminal::result(table.trim_end());
    }
    Ok(())
}

impl Landscape {
    fn new(cells: [u16; 3]) -> Self {
        let [_, height, _] = cells.map(f32::from);
        let terrain =
            Terrain::Hills { seed: 5, low_m: 0.1 * height, high_m: 0.9 * height, period_m: 0.8 * f32::from(cells[0]) };
        let tank =
            Tank { cells, cell_m: 1.0, terrain, water_m: 0.35 * height, look: TankLook::Cubes, ..Tank::default() };
        let simulation = Simulation::new(&tank);
        let start = simulation.grid();
        let grid = VoxelGrid::new(start.size(), |at| start.level(start.index(at)) >= FULL / 2);
        // One body of ground and water: its outer faces alone
        let mut body = start.clone();
        (0..tank.cell_count()).for_each(|cell| body.set_ground(cell, start.level(cell)));
        let faces = surface_of(&body, TankLook::Cubes, Vec3::ZERO, 1.0);
        // Some cells over the ground of a quarter of the way across
        let [x, z] = [cells[0] / 4, cells[2] / 4].map(usize::from);
        let is_filled = |y: &usize| start.level(start.index([x, *y, z])) >= FULL / 2;
        let top = (0..usize::from(cells[1])).filter(is_filled).count();
        let eye = Vec3::new(x as f32, top as f32 + EYE_CELLS, z as f32) + 0.5;
        Landscape { eye, grid, bvh: Intersector::new(&Arc::new(faces), IntersectionMethod::Bvh) }
    }

    /// Measures all ways and numbers of bounces for a view distance, in cells.
    fn measure(&self, distance: f32, size: (u32, u32), timed_s: f64) -> Vec<VoxelRow> {
        // The rays of each bounce, and their hits
        let mut levels = vec![primary_rays(self.eye, size, distance)];
        let mut hits = Vec::new();
        let most = BOUNCES.into_iter().max().unwrap_or(1);
        while hits.len() < most {
            let (next, count) = self.scatter(levels.last().map_or(&[], Vec::as_slice), distance);
            hits.push(count);
            levels.push(next);
        }
        let mut rows = Vec::new();
        for way in Way::ALL {
            let times: Vec<f64> = levels.iter().map(|rays| self.seconds(way, rays, timed_s)).collect();
            for bounces in BOUNCES {
                let rays: usize = levels[..bounces].iter().map(Vec::len).sum();
                let visits = match way {
                    Way::Grid(way) => {
                        Some(levels[..bounces].iter().flatten().map(|ray| self.visits(ray, way)).sum::<u64>())
                    }
                    Way::Bvh => None,
                };
                rows.push(VoxelRow {
                    way: way.label(),
                    bounces,
                    distance_cells: distance,
                    frame_ms: 1e3 * times[..bounces].iter().sum::<f64>(),
                    rays,
                    hits: hits[..bounces].iter().sum(),
                    visits_per_ray: visits.map(|visits| visits as f64 / rays.max(1) as f64),
                });
            }
        }
        rows
    }

    fn visits(&self, ray: &Ray, way: VoxelWay) -> u64 {
        self.grid.intersect(ray, way).1.into()
    }

    /// Returns the rays that are scattered where these hit, and the number of hits.
    fn scatter(&self, rays: &[Ray], distance: f32) -> (Vec<Ray>, usize) {
        let mut scattered = Vec::new();
        let mut count = 0;
        for (index, ray) in (0_u32..).zip(rays) {
            let Some(hit) = self.grid.intersect(ray, VoxelWay::Bricks).0 else { continue };
            count += 1;
            if hit.t == 0.0 {
                continue;
            }
            let normal = hit.normal.as_vec3();
            let [a, b] = sobol_burley::sample_4d(index, 0, SEED)[..2] else { continue };
            let (u, v) = orthonormal_basis(normal);
            let local = warp::cosine_hemisphere(Vec2::new(a, b));
            let origin = ray.origin + ray.direction * hit.t + normal * 1e-3;
            scattered.push(Ray { origin, direction: u * local.x + v * local.y + normal * local.z, t_max: distance });
        }
        (scattered, count)
    }

    /// Returns the time in which a way finds the first cells on these rays.
    fn seconds(&self, way: Way, rays: &[Ray], timed_s: f64) -> f64 {
        let pass = || match way {
            Way::Grid(way) => rays.iter().filter(|ray| self.grid.intersect(ray, way).0.is_some()).count(),
            Way::Bvh => self.bvh.distances(rays).iter().filter(|t| t.is_finite()).count(),
        };
        let (mut fastest, began) = (f64::INFINITY, Instant::now());
        while began.elapsed().as_secs_f64() < timed_s || fastest.is_infinite() {
            let started = Instant::now();
            std::hint::black_box(pass());
            fastest = fastest.min(started.elapsed().as_secs_f64());
        }
        fastest
    }
}

/// Returns the rays of a camera that looks across the landscape.
fn primary_rays(eye: Vec3, (width, height): (u32, u32), distance: f32) -> Vec<Ray> {
    let ahead = Vec3::new(1.0, -0.35, 1.0).normalize_or(Vec3::X);
    let right = ahead.cross(Vec3::Y).normalize_or(Vec3::Z);
    let up = right.cross(ahead);
    let ray = |pixel: u32| {
        let at = Vec2::new((pixel % width) as f32 + 0.5, (pixel / width) as f32 + 0.5) / width as f32;
        let offset = right * (at.x - 0.5) * 1.6 - up * (at.y - 0.5 * height as f32 / width as f32) * 1.6;
        Ray { origin: eye, direction: (ahead + offset).normalize_or(ahead), t_max: distance }
    };
    (0..width * height).map(ray).collect()
}

fn csv(rows: &[VoxelRow]) -> String {
    let mut text = "way,bounces,distance_cells,frame_ms,rays,hits,visits_per_ray\n".to_owned();
    for VoxelRow { way, bounces, distance_cells, frame_ms, rays, hits, visits_per_ray } in rows {
        let visits = visits_per_ray.map(|visits| format!("{visits:.2}")).unwrap_or_default();
        let _ = writeln!(text, "{way},{bounces},{distance_cells},{frame_ms:.3},{rays},{hits},{visits}");
    }
    text
}

/// Returns the table of frame times, and the law that they follow.
fn table(rows: &[VoxelRow]) -> String {
    let mut text = String::from("| way | bounces |");
    text.extend(DISTANCES.map(|distance| format!(" {distance} cells |")));
    text += "\n|---|---|";
    text.extend(DISTANCES.map(|_| "---|"));
    text.push('\n');
    for way in Way::ALL.map(Way::label) {
        for bounces in BOUNCES {
            let _ = write!(text, "| {way} | {bounces} |");
            for row in rows.iter().filter(|row| row.way == way && row.bounces == bounces) {
                let _ = write!(text, " {:.1} ms |", row.frame_ms);
            }
            text.push('\n');
        }
    }
    for way in [VoxelWay::Cells, VoxelWay::Bricks].map(|way| Way::Grid(way).label()) {
        if let Some(law) = Law::of(rows.iter().filter(|row| row.way == way)) {
            let Law { ray_ns, visit_ns, r_squared } = law;
            let _ = writeln!(
                text,
                "\n{way}: frame time = rays x ({ray_ns:.0} ns + {visit_ns:.1} ns x visits per ray), R2 = {r_squared:.3}"
            );
        }
    }
    text
}

/// The law of grid traversal: a ray costs a constant, and another one for each cell or brick that it visits.
struct Law {
    ray_ns: f64,
    visit_ns: f64,
    /// Part of the variance that it explains.
    r_squared: f64,
}

impl Law {
    /// Fits the law by least squares of the time of a ray.
    fn of<'a>(rows: impl Iterator<Item = &'a VoxelRow>) -> Option<Law> {
        let point = |row: &VoxelRow| Some((row.visits_per_ray?, 1e6 * row.frame_ms / row.rays.max(1) as f64));
        let points: Vec<(f64, f64)> = rows.filter_map(point).collect();
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let sum = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>();
        let (xx, xy, yy) =
            (sum(&|p| (p.0 - x) * (p.0 - x)), sum(&|p| (p.0 - x) * (p.1 - y)), sum(&|p| (p.1 - y) * (p.1 - y)));
        (xx > 0.0 && yy > 0.0).then(|| Law {
            ray_ns: y - xy / xx * x,
            visit_ns: xy / xx,
            r_squared: xy * xy / (xx * yy),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_ways_find_the_same_cells_and_the_law_is_fitted() {
        let landscape = Landscape::new([32, 64, 32]);
        let mut rays = primary_rays(landscape.eye, (24, 16), 200.0);
        rays.extend(landscape.scatter(&rays, 200.0).0);
        let mut hits = 0;
        let distances = landscape.bvh.distances(&rays);
        for (ray, by_bvh) in rays.iter().zip(distances) {
            for way in [VoxelWay::Cells, VoxelWay::Bricks] {
                let by_grid = landscape.grid.intersect(ray, way).0.map_or(f32::INFINITY, |hit| hit.t);
                let is_same = by_grid == by_bvh || (by_grid - by_bvh).abs() < 1e-3;
                assert!(is_same, "{way:?} {ray:?}: {by_grid} for {by_bvh}");
            }
            hits += usize::from(by_bvh.is_finite());
        }
        assert!(hits > 50, "{hits}");
        let rows = landscape.measure(16.0, (24, 16), 0.0);
        assert_eq!(rows.len(), Way::ALL.len() * BOUNCES.len());
        assert!(rows.iter().all(|row| row.rays > 0 && row.frame_ms > 0.0));
        assert!(csv(&rows).lines().count() == 13 && table(&rows).contains("R2"), "{}", table(&rows));
        let row = |rays, visits, frame_ms| VoxelRow {
            way: "cells",
            bounces: 1,
            distance_cells: 1.0,
            frame_ms,
            rays,
            hits: 0,
            visits_per_ray: Some(visits),
        };
        let rows = [row(1000, 2.0, 0.025), row(2000, 4.0, 0.07), row(1000, 10.0, 0.065)];
        let law = Law::of(rows.iter()).unwrap();
        assert!((law.ray_ns - 15.0).abs() < 1e-9 && (law.visit_ns - 5.0).abs() < 1e-9 && law.r_squared > 0.999);
    }
}
