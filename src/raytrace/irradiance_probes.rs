//! Bounced light on a grid of probes, for previews: one gather of traced paths at each probe.
//!
//! A probe's paths leave in directions uniform over the sphere. What arrives along them after at least one bounce is
//! added to the six irradiances of the probe: E = 4 pi mean(L cos). Direct light is left out; the previews compute it.
//! Sums are kept for each film layer, so that a light's power and colour change without new paths.
//!
//! Where it fails: a grid is coarser than contact shadows, and an object thinner than a cell does not separate the light
//! on its sides.

use super::control::RenderControl;
use super::enclosure::back_faces_around;
use super::film::{Layer, MAX_LIGHT_LAYERS, NonFiniteGate, NonFiniteReport, assign_layers};
use super::geometry_cache::GeometryCache;
use super::lights::TracedLight;
use super::limits::PathLimits;
use super::path_tracer::PathTracer;
use super::prepare::{PrepareError, Viewpoint, prepare_all};
use super::render_scene::RenderScene;
use super::retrace::Retrace;
use super::sampler::{self, Dimensions, Sampler};
use super::sink::RadianceSink;
use crate::math::warp;
use crate::photo::exposure;
use crate::photo::irradiance_grid::{FACES, GridLayout, IrradianceGrid};
use crate::scene::{Assets, Light, Scene, SceneChange};
use glam::{UVec3, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Largest number of probes along an axis.
const MAX_CELLS: u32 = 14;
/// Smallest distance between probes, metres.
const MIN_STEP_M: f32 = 0.04;
/// Rays that find whether a probe is inside of an object.
const INSIDE_RAYS: u32 = 24;

/// Bounced light of a scene on a grid, in film layers.
#[derive(Clone, Debug)]
pub struct IrradianceProbes {
    layout: GridLayout,
    layers: Vec<Layer>,
    /// Irradiance of white light of each probe, layer by layer.
    probes: Vec<Vec<[Vec3; 6]>>,
    /// Discarded non-finite contributions, by probe index.
    nonfinite: NonFiniteReport,
}

/// A scene prepared for its probes.
#[derive(Debug)]
pub struct ProbeScene {
    render_scene: RenderScene,
    layout: GridLayout,
    /// The probes inside of closed objects, which see no light of the studio.
    is_inside: Vec<bool>,
}

impl ProbeScene {
    /// Prepares a scene; none where there is nothing that bounces light.
    ///
    /// # Errors
    /// When the scene cannot be prepared.
    pub fn new(scene: &Scene, assets: &Assets, cache: &GeometryCache) -> Result<Option<Self>, PrepareError> {
        let Some(layout) = bounds(scene, assets).and_then(|bounds| GridLayout::over(bounds, MAX_CELLS, MIN_STEP_M))
        else {
            return Ok(None);
        };
        let origin = layout.low + 0.5 * layout.step_m * (layout.counts.as_vec3() - 1.0);
        // Probes are decimetres apart: the coarse meshes of figures without their hair serve
        let coarse = assets.clone().map_figures(|meshes| meshes.coarse_with_strands(|_| false));
        let mut render_scene = prepare_all(scene, &coarse, &Viewpoint::at(origin), assign_invisible_layers, cache)?;
        render_scene.aggregate.show_bodies();
        let is_inside = (0..layout.len())
            .into_par_iter()
            .map_init(
                || PathTracer::new(&render_scene, None),
                |tracer, probe| is_inside(tracer, layout.position(probe)),
            )
            .collect();
        Ok(Some(ProbeScene { render_scene, layout, is_inside }))
    }

    /// Traces so many paths from each probe, on rayon's current pool. None if cancelled.
    pub fn trace(&self, paths: u32, control: &RenderControl) -> Option<IrradianceProbes> {
        let gather = |tracer: &mut PathTracer<'_>, probe: usize| {
            let mut gathered = GatheredProbe::new(self.render_scene.layers().len());
            if !self.is_inside[probe] && !control.is_cancelled() {
                gathered.trace(tracer, self.layout.position(probe), probe as u32, paths);
            }
            gathered
        };
        let gathered: Vec<GatheredProbe> = (0..self.layout.len())
            .into_par_iter()
            .map_init(|| PathTracer::new(&self.render_scene, None), gather)
            .collect();
        if control.is_cancelled() {
            return None;
        }
        let nonfinite = gathered.iter().map(|probe| &probe.nonfinite).collect();
        let mut probes: Vec<Vec<[Vec3; 6]>> = gathered.into_iter().map(|probe| probe.layers).collect();
        fill_inside(&self.layout, &self.is_inside, &mut probes);
        let layers = self.render_scene.layers().to_vec();
        Some(IrradianceProbes { layout: self.layout, layers, probes, nonfinite })
    }
}

impl IrradianceProbes {
    /// Returns the irradiance in picture units, with the exposure, white balance, and each light's power, colour and
    /// switch in `scene`.
    pub fn develop(&self, scene: &Scene) -> IrradianceGrid {
        let scale = exposure::pixel_per_cd_s_m2(scene);
        let weights: Vec<Vec3> = self.layers.iter().map(|layer| layer.weight(scene) * scale).collect();
        let sum = |layers: &Vec<[Vec3; 6]>| {
            let mut faces = [Vec3::ZERO; 6];
            for (layer, weight) in layers.iter().zip(&weights) {
                faces.iter_mut().zip(layer).for_each(|(face, value)| *face += *value * *weight);
            }
            faces
        };
        IrradianceGrid { layout: self.layout, probes: self.probes.iter().map(sum).collect() }
    }

    /// Returns true if developing the probes of one scene gives the bounced light of another.
    pub fn can_follow(traced: &Scene, now: &Scene) -> bool {
        let on: Vec<&Light> = traced.lights.iter().filter(|light| light.on).collect();
        let (own, shared) = if on.len() > MAX_LIGHT_LAYERS { (&[][..], 2) } else { (&on[..], 1) };
        let shared = (0..shared).map(|_| Layer::shared("shared"));
        let layers: Vec<Layer> = own.iter().map(|light| Layer::of_light(light)).chain(shared).collect();
        Retrace::after(&SceneChange::between(traced, now), &layers, traced, now).is_developable()
    }

    /// Returns the discarded non-finite contributions, which count as black.
    pub fn nonfinite(&self) -> &NonFiniteReport {
        &self.nonfinite
    }
}

/// Returns the box around the room, or around all visible objects.
fn bounds(scene: &Scene, assets: &Assets) -> Option<(Vec3, Vec3)> {
    if let Some(room) = &scene.room {
        return Some(room.bounds().into());
    }
    let visible = scene.objects.iter().filter(|object| object.visible);
    let boxes = visible.filter_map(|object| assets.object_bounds(object));
    boxes.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
}

/// Assigns film layers, and hides all emitters from the paths: theirs is direct light.
fn assign_invisible_layers(scene: &Scene, lights: &mut [(TracedLight, &Light)]) -> Vec<Layer> {
    lights.iter_mut().for_each(|(traced, _)| traced.hide_from_camera());
    assign_layers(scene, lights)
}

/// Returns true if a quarter of the rays from a point first hit the back of a closed object.
fn is_inside(tracer: &mut PathTracer<'_>, position: Vec3) -> bool {
    let origin = position - tracer.caster.scene.origin;
    let faces = back_faces_around(&mut tracer.caster, origin, INSIDE_RAYS);
    4 * faces.iter().filter(|face| face.is_closed).count() >= INSIDE_RAYS as usize
}

/// The sums of a probe.
#[derive(Debug)]
struct GatheredProbe {
    layers: Vec<[Vec3; 6]>,
    nonfinite: NonFiniteReport,
}

impl GatheredProbe {
    fn new(layers: usize) -> Self {
        GatheredProbe { layers: vec![[Vec3::ZERO; 6]; layers], nonfinite: NonFiniteReport::default() }
    }

    /// Traces the paths of a probe.
    fn trace(&mut self, tracer: &mut PathTracer<'_>, position: Vec3, probe: u32, paths: u32) {
        let origin = position - tracer.caster.scene.origin;
        for index in 0..paths {
            let sampler = Sampler::new(probe, 0, index, 0);
            let direction = warp::uniform_sphere(sampler::first_pair(&sampler.set(Dimensions::Camera)));
            let weights = FACES.map(|face| face.dot(direction).max(0.0) * (4.0 * PI / paths as f32));
            let sink = ProbeSink { layers: &mut self.layers, weights };
            let mut gate = NonFiniteGate { sink, sample: sampler.id(), report: &mut self.nonfinite };
            tracer.trace_without_direct_light(origin, direction, &sampler, PathLimits::UNTIL_ROULETTE, None, &mut gate);
        }
    }
}

/// Adds the radiance along one direction to the irradiances of a probe.
struct ProbeSink<'a> {
    layers: &'a mut [[Vec3; 6]],
    weights: [f32; 6],
}

impl RadianceSink for ProbeSink<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        self.layers[layer].iter_mut().zip(self.weights).for_each(|(face, weight)| *face += value * weight);
    }
}

/// Gives probes inside of objects the mean of their neighbours, from the surface inwards.
fn fill_inside(layout: &GridLayout, is_inside: &[bool], probes: &mut [Vec<[Vec3; 6]>]) {
    let mut is_missing = is_inside.to_vec();
    for _ in 0..MAX_CELLS {
        let missing: Vec<usize> = (0..probes.len()).filter(|probe| is_missing[*probe]).collect();
        let filled: Vec<(usize, Vec<[Vec3; 6]>)> = missing
            .iter()
            .filter_map(|probe| {
                let known: Vec<usize> = neighbours(layout, *probe).filter(|other| !is_missing[*other]).collect();
                (!known.is_empty()).then(|| (*probe, mean_of(&known, probes)))
            })
            .collect();
        for (probe, mean) in filled {
            (probes[probe], is_missing[probe]) = (mean, false);
        }
    }
}

/// Returns the probes next to one along the axes.
fn neighbours(layout: &GridLayout, probe: usize) -> impl Iterator<Item = usize> {
    let (at, layout) = (layout.probe(probe), *layout);
    [UVec3::X, UVec3::Y, UVec3::Z].into_iter().flat_map(move |axis| {
        let before = at.cmpge(axis).all().then(|| layout.index(at - axis));
        let after = (at + axis).cmplt(layout.counts).all().then(|| layout.index(at + axis));
        before.into_iter().chain(after)
    })
}

fn mean_of(known: &[usize], probes: &[Vec<[Vec3; 6]>]) -> Vec<[Vec3; 6]> {
    let mut mean = vec![[Vec3::ZERO; 6]; probes[known[0]].len()];
    let part = 1.0 / known.len() as f32;
    for probe in known {
        for (faces, values) in mean.iter_mut().zip(&probes[*probe]) {
            faces.iter_mut().zip(values).for_each(|(face, value)| *face += *value * part);
        }
    }
    mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{LightMeter, MeterEffort, MeterPoint};
    use crate::scene::{
        Aim, ColorSource, Emitter, LightId, Material, Object, ObjectId, Output, Receptor, Room, Shape, Transform,
    };

    /// A room with a large box on its floor, under a softbox and a bulb.
    fn studio() -> Scene {
        let paint = |value: f32| Material { base_color: [value; 3], roughness: 1.0, ior: 1.0, ..Material::default() };
        let room = Room { size_m: Vec3::new(4.0, 3.0, 4.0), floor: paint(0.3), walls: paint(0.6), ceiling: paint(0.7) };
        let block = Object {
            id: ObjectId(1),
            transform: Transform::at(Vec3::new(0.0, 0.6, 0.0)),
            material: paint(0.5),
            ..Object::new("Box", Shape::Box { size_m: Vec3::new(1.4, 1.2, 1.4) })
        };
        let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
        let light = |id, emitter, position| Light {
            id: LightId(id),
            name: format!("Light {id}"),
            position,
            aim: Aim::Point(Vec3::Y),
            visible_to_camera: id == 2,
            ..Light::new(emitter, Output::Lumens(10_000.0))
        };
        let lights = vec![
            light(1, panel, Vec3::new(1.5, 2.4, 1.2)),
            light(2, Emitter::Sphere { radius_m: 0.05 }, Vec3::new(-1.2, 2.0, 0.8)),
        ];
        Scene { room: Some(room), objects: vec![block], lights, ..Scene::default() }
    }

    fn traced(scene: &Scene, paths: u32) -> IrradianceProbes {
        let cache = GeometryCache::default();
        let prepared = ProbeScene::new(scene, &Assets::default(), &cache).unwrap().unwrap();
        prepared.trace(paths, &RenderControl::new()).unwrap()
    }

    #[test]
    fn probes_read_the_bounced_light_of_the_meter() {
        let scene = studio();
        let grid = traced(&scene, 512).develop(&scene);
        let per_lux = exposure::pixel_per_cd_s_m2(&scene) * scene.camera.shutter_s;
        let meter = LightMeter::new(&scene, &Assets::default(), Vec3::Y).unwrap();
        let (mut ratios, mut compared) = (0.0, 0);
        for probe in (0..grid.layout.len()).step_by(97) {
            let position = grid.layout.position(probe);
            if position.x.abs() < 0.8 && position.z.abs() < 0.8 && position.y < 1.3 {
                continue;
            }
            for (face, facing) in FACES.into_iter().enumerate() {
                let point = MeterPoint { position, facing, receptor: Receptor::Flat };
                let read = meter.read(&point, &MeterEffort::quick(), &RenderControl::new()).unwrap();
                let ratio = grid.probes[probe][face].y / (read.reading.total_lux().1 * per_lux);
                // 512 paths, of which half are before a face, vary by some 4 %: five standard errors.
                assert!((ratio - 1.0).abs() < 0.2, "{position} towards {facing}: {ratio}");
                (ratios, compared) = (ratios + ratio, compared + 1);
            }
        }
        assert!(compared > 60, "{compared} readings");
        assert!((ratios / compared as f32 - 1.0).abs() < 0.02, "{} in the mean", ratios / compared as f32);
    }

    #[test]
    fn power_colour_and_switch_are_developed_and_a_moved_light_is_traced() {
        let scene = studio();
        let probes = traced(&scene, 16);
        let sum = |scene: &Scene| probes.develop(scene).probes.iter().flatten().sum::<Vec3>();
        let edited = |edit: &dyn Fn(&mut Scene)| {
            let mut edited = scene.clone();
            edit(&mut edited);
            edited
        };
        let dimmed = edited(&|s| s.lights.iter_mut().for_each(|light| light.power.dial_stops = -1.0));
        assert!((sum(&dimmed) / sum(&scene) - 0.5).abs().max_element() < 1e-5);
        let filtered = edited(&|s| s.camera.nd_stops = 2.0);
        assert!((sum(&filtered) / sum(&scene) - 0.25).abs().max_element() < 1e-5);
        let [first, second] = [0, 1].map(|other: usize| edited(&|s| s.lights[other].on = false));
        assert!(((sum(&first) + sum(&second)) / sum(&scene) - 1.0).abs().max_element() < 1e-5);
        let warm = edited(&|s| s.lights[0].color.source = ColorSource::Kelvin(3200.0));
        assert!(sum(&warm).x / sum(&warm).z > 1.2 * sum(&scene).x / sum(&scene).z);
        for followed in [&dimmed, &filtered, &first, &warm] {
            assert!(IrradianceProbes::can_follow(&scene, followed));
        }
        assert!(!IrradianceProbes::can_follow(&scene, &edited(&|s| s.lights[0].position.x += 0.1)));
        assert!(!IrradianceProbes::can_follow(&first, &scene), "the light was off");
        assert!(!IrradianceProbes::can_follow(&scene, &edited(&|s| s.objects.clear())));
        assert!(IrradianceProbes::can_follow(&scene, &edited(&|s| s.camera.position.x += 1.0)));
    }

    #[test]
    fn probes_inside_of_an_object_have_the_light_around_it() {
        let scene = studio();
        let cache = GeometryCache::default();
        let prepared = ProbeScene::new(&scene, &Assets::default(), &cache).unwrap().unwrap();
        let is_in_box = |probe: &usize| {
            let p = prepared.layout.position(*probe);
            p.x.abs() < 0.6 && p.z.abs() < 0.6 && p.y < 1.1
        };
        let inside: Vec<usize> = (0..prepared.layout.len()).filter(is_in_box).collect();
        assert!(inside.len() > 20 && inside.iter().all(|probe| prepared.is_inside[*probe]));
        assert!(prepared.is_inside.iter().filter(|inside| **inside).count() < 2 * inside.len(), "the room is free");
        let grid = prepared.trace(16, &RenderControl::new()).unwrap().develop(&scene);
        for probe in inside {
            assert!(grid.probes[probe].iter().all(|face| face.y > 0.0), "{}", prepared.layout.position(probe));
        }
    }

    #[test]
    fn nothing_bounces_light_in_an_empty_scene() {
        let cache = GeometryCache::default();
        assert!(ProbeScene::new(&Scene::default(), &Assets::default(), &cache).unwrap().is_none());
    }
}
