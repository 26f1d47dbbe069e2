//! The paths that fill the irradiance cache (`irradiance_cache.rs`), and the decision whether a picture has one.
//!
//! Pilot paths find points where camera paths take cells; from these points paths gather the cells' light. The points
//! are distributed as the paths that take the cells, so that a cell's mean is the mean that those would find.

use super::aggregate::Hit;
use super::bsdf::Bsdf;
use super::caustics::PhotonMap;
use super::control::RenderControl;
use super::geometry::SurfaceInteraction;
use super::irradiance_cache::{CellKey, Footprint, IrradianceCache};
use super::lens::{FilmCamera, PixelCamera, camera_ray};
use super::limits::PathLimits;
use super::path_tracer::PathTracer;
use super::pilot_path::{self, PilotRaster, PilotVertex};
use super::ray_caster::RayCaster;
use super::render_scene::RenderScene;
use super::sample_pass::SamplePass;
use super::sampler::Sampler;
use super::sink::RadianceSink;
use crate::color::luminance;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Maximum number of pilot paths that find points on surfaces, for each sample of a pixel. A smaller picture has one for
/// each of its pixels: with so many, one of a thousand pixels took four times as long.
const MAX_PILOT_PATHS: u32 = 1 << 14;
/// Samples of a pass for which there are pilot paths, at most.
const MOST_PILOTS: u32 = 2;
/// Pilot paths by which it is decided whether the cache pays, at least.
const MIN_DECIDING_PATHS: u32 = 1 << 10;
/// Matte surfaces that a pilot path passes.
const PILOT_SCATTERINGS: u32 = 3;
/// Largest cells along the diagonal of the box around all points.
const CELLS_ALONG_DIAGONAL: f32 = 40.0;
/// Points without which a cell is left to paths.
const MIN_POINTS: usize = 3;
/// Points of a cell from which paths start, at most.
const MAX_POINTS: usize = 64;
/// Paths from each cell for each sample of a pixel. In a white room more of them take longer than they save.
const PATHS_PER_SAMPLE: u32 = 2;
/// Throughput with which camera paths arrive at the second matte surface, on average, below which there is no cache.
const MIN_BOUNCED: f32 = 0.05;
/// Part of it that is left at the third matte surface, from which on the cache pays: 0.5 to 0.7 in rooms with white
/// walls, 0.01 to 0.25 in the shipped studios.
const MIN_BRIGHTNESS: f32 = 0.4;
/// The same without hair and skin, where paths split, as most noise is that of bounced light: 0.25 around things of
/// plastic on a pale floor, for half of the variance in the same time; 0.21 and less in the shipped studios.
const MIN_BRIGHTNESS_OF_SPLIT: f32 = 0.22;
/// Added to the seed, so that these paths and those of the picture have different random numbers.
const SEED: u32 = 0x69_72_72_61;

/// Points on the surfaces that paths of a picture meet after a bounce, cell by cell.
#[derive(Debug)]
struct CachePoints {
    largest_cell_m: f32,
    cells: Vec<(CellKey, Vec<CachePoint>)>,
}

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
struct CachePoint {
    hit: Hit,
    surface: SurfaceInteraction,
    footprint: Footprint,
    /// Number of the pilot path that met it.
    path: u32,
}

/// Returns true if the cache pays for a camera's picture: where much of the light that bounced once bounces again.
pub fn pays(scene: &RenderScene, camera: &FilmCamera) -> bool {
    let paths = pilot_paths(camera).max(MIN_DECIDING_PATHS);
    let arriving = trace_pilots(scene, camera, paths, 0, |_, vertex| {
        (vertex.non_specular_depth > 0).then(|| (vertex.non_specular_depth, luminance(vertex.throughput)))
    });
    let sum = |depth| arriving.iter().filter(|(at, _)| *at == depth).map(|(_, throughput)| throughput).sum::<f32>();
    let (second, third) = (sum(1), sum(2));
    let least = if scene.plan().split_factor > 1 { MIN_BRIGHTNESS_OF_SPLIT } else { MIN_BRIGHTNESS };
    // With too little bounced light the ratio below is noise
    second > MIN_BOUNCED * paths as f32 && third >= least * second
}

/// Returns the number of pilot paths of a camera's picture for each sample of a pixel.
fn pilot_paths(camera: &FilmCamera) -> u32 {
    let (width, height) = camera.size();
    width.saturating_mul(height).min(MAX_PILOT_PATHS)
}

/// Traces about so many pilot paths of a camera's picture, and returns what `found` has of their vertices.
fn trace_pilots<T: Send>(
    scene: &RenderScene,
    camera: &FilmCamera,
    paths: u32,
    index: u32,
    found: impl Fn(u32, &PilotVertex<'_>) -> Option<T> + Sync,
) -> Vec<T> {
    let raster = PilotRaster::new(camera.size(), paths);
    let across = raster.across;
    let row = |y: u32| {
        let mut caster = RayCaster::new(scene);
        let mut row = Vec::new();
        for x in 0..across {
            // Several paths of one pixel of a small picture differ by their seeds
            let pixel = raster.pixel(x, y);
            let sampler = Sampler::new(pixel.0, pixel.1, index, SEED ^ (x + y * across));
            pilot_path::trace(&mut caster, camera_ray(camera, &sampler), &sampler, PILOT_SCATTERINGS, |vertex| {
                row.extend(found(x + y * across, vertex));
            });
        }
        row
    };
    (0..raster.down).into_par_iter().flat_map_iter(row).collect()
}

impl CachePoints {
    /// Finds points for a pass. They are others in each pass, so that no spot of light is missed in all of them.
    fn find(scene: &RenderScene, camera: &FilmCamera, pass: SamplePass) -> Self {
        let paths = pilot_paths(camera) * pass.samples.clamp(1, MOST_PILOTS);
        let points = trace_pilots(scene, camera, paths, 1 + pass.first_sample, |path, vertex| {
            let is_outside = vertex.wo.dot(vertex.surface.geometric_normal) > 0.0;
            let is_cached = vertex.non_specular_depth > 0 && is_outside && vertex.bsdf.matte_factor().is_some();
            let PilotVertex { hit, surface, footprint, .. } = *vertex;
            is_cached.then_some(CachePoint { hit: *hit, surface: *surface, footprint, path })
        });
        CachePoints::in_cells(&points)
    }

    /// Divides points among cells.
    fn in_cells(points: &[CachePoint]) -> Self {
        let (low, high) = points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), point| {
            (low.min(point.surface.position), high.max(point.surface.position))
        });
        let largest_cell_m = ((high - low).length() / CELLS_ALONG_DIAGONAL).max(f32::MIN_POSITIVE);
        let mut cells: BTreeMap<CellKey, Vec<CachePoint>> = BTreeMap::new();
        // The first vertex of a pilot path where it would take a cell
        let mut last = None;
        for point in points {
            let Some(level) = point.footprint.level(largest_cell_m).filter(|_| last != Some(point.path)) else {
                continue;
            };
            last = Some(point.path);
            cells.entry(CellKey::of(&point.surface, largest_cell_m, level)).or_default().push(*point);
        }
        cells.retain(|_, points| points.len() >= MIN_POINTS);
        for points in cells.values_mut() {
            let every = points.len().div_ceil(MAX_POINTS);
            *points = points.iter().copied().step_by(every).collect();
        }
        CachePoints { largest_cell_m, cells: cells.into_iter().collect() }
    }
}

/// Adds contributions to the layers of a cell.
struct LayerSums<'a>(&'a mut [Vec3]);

impl RadianceSink for LayerSums<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        self.0[layer] += value;
    }
}

impl PathTracer<'_> {
    /// Traces a path from a point of a cell as from a white diffuse base under the coat.
    fn trace_from_cell(
        &mut self,
        CachePoint { hit, surface, .. }: &CachePoint,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) {
        let material = &self.caster.scene.materials[surface.material as usize];
        let bsdf = Bsdf::at_exit(material, surface.normal, surface.geometric_normal);
        self.trace_from_surface((hit, surface), &bsdf, sampler, limits, sink);
    }
}

impl IrradianceCache {
    /// Traces the light of the cells for a pass of a camera's picture, on rayon's current pool. Of no use if `control`
    /// is cancelled.
    pub fn trace(
        scene: &RenderScene,
        camera: &FilmCamera,
        photon_map: Option<&PhotonMap>,
        pass: SamplePass,
        seed: u32,
        control: &RenderControl,
    ) -> Self {
        let points = CachePoints::find(scene, camera, pass);
        // Beyond the bounces of a camera path, which leave out 1/512 of the light
        let depth = 2 * scene.plan().max_depth;
        let limits = PathLimits { max_non_specular_depth: depth, max_depth: depth, split_factor: 1 };
        let paths = pass.first_sample * PATHS_PER_SAMPLE..(pass.first_sample + pass.samples) * PATHS_PER_SAMPLE;
        let gather = |tracer: &mut PathTracer<'_>, (key, points): &(CellKey, Vec<CachePoint>)| {
            let mut light = vec![Vec3::ZERO; scene.layers.len()];
            let (x, y) = key.seeds();
            let rays = tracer.caster.rays;
            for index in paths.clone().take_while(|_| !control.is_cancelled()) {
                let sampler = Sampler::new(x, y, index, seed ^ SEED);
                let point = &points[index as usize % points.len()];
                tracer.trace_from_cell(point, &sampler, limits, &mut LayerSums(&mut light));
            }
            control.count(tracer.caster.rays - rays, 0);
            light.iter_mut().for_each(|sum| *sum /= paths.len() as f32);
            // Paths that come to a cell without finite light find, discard and count what is not finite
            light.iter().all(|sum| sum.is_finite()).then_some((*key, light))
        };
        let tracer = || PathTracer::new(scene, photon_map);
        let cells = points.cells.par_iter().map_init(tracer, gather).flatten_iter().collect();
        IrradianceCache { largest_cell_m: points.largest_cell_m, cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::emitters::MisVertex;
    use crate::raytrace::path_tracer::PathState;
    use crate::raytrace::test_pictures::{blocks, mean};
    use crate::raytrace::{Film, Settings, Shortcut, prepare, render};
    use crate::scene::{
        Aim, Assets, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Room, Scene, Shape, Transform,
    };
    use std::ops::ControlFlow;

    /// A closed room of one reflectance with a glossy ball on its floor, lit by a panel that shines at the ceiling.
    fn room(reflectance: f32) -> Scene {
        let matte = Material { base_color: [reflectance; 3], roughness: 0.9, ..Material::default() };
        let glossy = Material { base_color: [0.6, 0.3, 0.2], roughness: 0.3, ..Material::default() };
        let ball = Object {
            id: ObjectId(1),
            transform: Transform::at(Vec3::new(0.3, 0.4, -0.5)),
            material: glossy,
            ..Object::new("Ball", Shape::Sphere { radius_m: 0.4 })
        };
        let panel = Light {
            id: LightId(2),
            position: Vec3::new(-0.8, 1.8, -0.5),
            aim: Aim::Point(Vec3::new(-0.8, 3.0, -0.5)),
            ..Light::new(Emitter::RectPanel { width_m: 0.5, height_m: 0.5 }, Output::Lumens(8000.0))
        };
        let camera = Camera {
            position: Vec3::new(0.0, 1.4, 1.8),
            aim: Aim::Point(Vec3::new(0.0, 1.0, -1.0)),
            focal_length_mm: 24.0,
            ..Camera::default()
        };
        let size_m = Vec3::new(4.0, 3.0, 4.0);
        let room = Room { size_m, floor: matte.clone(), walls: matte.clone(), ceiling: matte };
        Scene { camera, room: Some(room), objects: vec![ball], lights: vec![panel], ..Scene::default() }
    }

    /// Pixels of a picture: nearly as many as a pass has pilot paths at most.
    const SIZE: (u32, u32) = (144, 96);
    /// Pixels along a side of the blocks that are compared one by one.
    const BLOCK: usize = 4;

    fn settings(spp: u32, seed: u32) -> Settings {
        Settings { width: SIZE.0, height: SIZE.1, spp, seed, ..Settings::default() }
    }

    fn film(prepared: &RenderScene, settings: &Settings) -> Film {
        render(prepared, settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()))
    }

    /// Returns the scene with and without the cache.
    fn both(scene: &Scene) -> [RenderScene; 2] {
        let [cached, mut paths] = [0; 2].map(|_| prepare(scene, &Assets::default()).unwrap());
        paths.set_plan(paths.plan().clone().without(Shortcut::IrradianceCache));
        [cached, paths]
    }

    fn picture_mean(prepared: &RenderScene, scene: &Scene, settings: Settings) -> f64 {
        mean(&blocks(&film(prepared, &settings).develop(scene), 1))
    }

    #[test]
    fn a_bright_room_has_the_light_that_paths_find_and_a_third_of_their_noise() {
        let scene = room(0.7);
        let [cached, paths] = both(&scene);
        let picture = |prepared: &RenderScene, spp, seed| film(prepared, &settings(spp, seed)).develop(&scene);
        // Twice the mean relative variance of a pixel
        let noise = |prepared: &RenderScene| {
            let [first, second] = [1, 2].map(|seed| blocks(&picture(prepared, 16, seed), 1));
            let squares = first.iter().zip(&second).map(|(a, b)| ((a - b) / (0.5 * (a + b))).powi(2));
            mean(&squares.collect::<Vec<_>>())
        };
        let (ours, theirs) = (noise(&cached), noise(&paths));
        assert!(ours < theirs / 3.0, "{ours} against {theirs} at 16 samples");
        // The mean of the picture, and that of its lower half with the shadow under the ball
        let (values, reference) = (blocks(&picture(&cached, 16, 3), BLOCK), blocks(&picture(&paths, 64, 9), BLOCK));
        let half = values.len() / 2;
        for range in [0..values.len(), half..values.len()] {
            let ratio = mean(&values[range.clone()]) / mean(&reference[range]);
            assert!((ratio - 1.0).abs() < 0.003, "{ratio}");
        }
        // No block is far off: edges and contact shadows stay
        let worst = values.iter().zip(&reference).map(|(value, right)| (value / right - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 0.12, "{worst}");
    }

    #[test]
    fn a_spot_of_light_of_a_few_cells_is_reflected_in_full() {
        let mut scene = room(0.7);
        scene.lights[0] = Light {
            position: Vec3::new(-1.6, 1.2, -0.6),
            aim: Aim::Point(Vec3::new(-2.0, 1.2, -0.6)),
            ..Light::new(Emitter::Spot { inner_deg: 60.0, outer_deg: 70.0 }, Output::Lumens(4000.0))
        };
        let [cached, paths] = both(&scene);
        let ratio = picture_mean(&cached, &scene, settings(16, 3)) / picture_mean(&paths, &scene, settings(64, 4));
        // Both means scatter by half a per cent over seeds
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    }

    #[test]
    fn light_that_a_mirror_throws_is_in_the_cache() {
        let mut scene = room(0.7);
        scene.objects[0].material =
            Material { metallic: 1.0, roughness: 0.0, base_color: [0.9; 3], ..Material::default() };
        scene.lights[0] = Light {
            position: Vec3::new(-1.5, 2.5, 0.5),
            aim: Aim::Point(Vec3::new(0.3, 0.4, -0.5)),
            ..Light::new(Emitter::Spot { inner_deg: 7.0, outer_deg: 8.0 }, Output::Lumens(4000.0))
        };
        let [cached, paths] = both(&scene);
        assert!(cached.plan().photons);
        let ratio = picture_mean(&cached, &scene, settings(8, 3)) / picture_mean(&paths, &scene, settings(32, 4));
        // The photons that meet a small ball scatter the means by a per cent
        assert!((ratio - 1.0).abs() < 0.04, "{ratio}");
    }

    #[test]
    fn the_cache_has_the_same_bits_for_any_number_of_threads() {
        let scene = room(0.7);
        let [cached, _] = both(&scene);
        let picture = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| film(&cached, &settings(4, 5)).develop(&scene))
        };
        assert_eq!(picture(1).rgb, picture(3).rgb);
    }

    #[test]
    fn cells_are_a_third_of_the_samples_that_take_them_at_most() {
        let width = |width_m: f32| Footprint::new(1.0, width_m, 1.0);
        for width_m in [0.05_f32, 0.1, 0.31, 0.59, 0.61, 5.0] {
            let cell_m = width(width_m).level(0.2).expect("neither too narrow nor too near").cell_m(0.2);
            assert!(cell_m <= width_m / 3.0, "{cell_m} for {width_m}");
            assert!(cell_m > width_m / 6.001 || width_m > 1.0, "{cell_m} for {width_m}");
        }
        assert_eq!(width(0.01).level(0.2), None);
        assert_eq!(Footprint::new(0.0, 1.0, 1.0).level(0.2), None, "after specular scattering");
    }

    #[test]
    fn only_pictures_of_bright_rooms_have_a_cache() {
        let is_bright = |scene: &Scene| {
            let [cached, _] = both(scene);
            pays(&cached, &cached.lens.film_camera(SIZE.0, SIZE.1))
        };
        assert!(is_bright(&room(0.7)));
        assert!(!is_bright(&room(0.15)));
        assert!(!is_bright(&Scene { room: None, ..room(0.7) }), "light leaves");
        let [bright, dark] = [0.7, 0.15].map(|reflectance| both(&room(reflectance)));
        assert!(bright[0].plan().irradiance_cache && !bright[1].plan().irradiance_cache);
        // The ball is as bright as 0.6
        assert!(dark[0].plan().irradiance_cache);
    }

    #[test]
    fn paths_take_smaller_cells_from_nearby_and_none_from_touching_surfaces() {
        let scene = room(0.7);
        let [cached, _] = both(&scene);
        let (camera, pass) = (cached.lens.film_camera(SIZE.0, SIZE.1), SamplePass { first_sample: 0, samples: 1 });
        let points = CachePoints::find(&cached, &camera, pass);
        let cache = IrradianceCache::trace(&cached, &camera, None, pass, 0, &RenderControl::new());
        let mut tracer = PathTracer::new(&cached, None);
        tracer.irradiance_cache = Some(&cache);
        assert!(cache.cells.len() > 200 && (0.1..0.4).contains(&cache.largest_cell_m), "{}", cache.largest_cell_m);
        let (_, found) = &points.cells[points.cells.len() / 2];
        let surface = &found[0].surface;
        let bsdf =
            Bsdf::at_exit(&cached.materials[surface.material as usize], surface.normal, surface.geometric_normal);
        let cell_m = |distance, sample_solid_angle, non_specular_depth| {
            let mut path = PathState::new(surface.position, Vec3::Y, MisVertex::new(surface.position, Vec3::Y));
            (path.sample_solid_angle, path.non_specular_depth) = (sample_solid_angle, non_specular_depth);
            tracer.cached_light(&path, surface, surface.geometric_normal, distance, &bsdf).map(|cached| cached.cell_m)
        };
        let matte = std::f32::consts::PI;
        assert_eq!(cell_m(2.0, matte, 1), Some(cache.largest_cell_m));
        assert_eq!(cell_m(2.0, matte, 0), None, "what the camera sees is never from the cache");
        assert!(cell_m(0.2, matte, 1).is_none_or(|cell_m| cell_m < 0.12), "what is near is in small cells or in none");
        assert_eq!(cell_m(0.001, matte, 1), None, "what touches is in none");
        assert_eq!(cell_m(0.2, 0.01, 1), None, "nor what a glossy surface shows");
        assert_eq!(cell_m(2.0, 0.0, 1), None, "nor what a mirror shows");
    }
}
