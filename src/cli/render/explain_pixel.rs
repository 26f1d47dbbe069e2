//! `catchlight render SCENE --explain-pixel X,Y`: one sample of one pixel, traced again and printed step by step.

use super::Arguments;
use crate::cli::terminal::result;
use crate::io::Loaded;
use crate::raytrace::{
    self, GeometryCache, PathEnd, PathEvent, PathVertex, Purpose, RenderScene, Replay, SampleId, ScatteringKind,
    Settings,
};
use crate::scene::Scene;
use anyhow::{Context, anyhow};
use glam::Vec3;
use serde::Serialize;

/// The JSON object of `--explain-pixel`.
#[derive(Serialize)]
struct Report<'a> {
    pixel: [u32; 2],
    sample: u32,
    seed: u32,
    /// Value of the sample in the picture, scene-linear.
    value: Vec3,
    nonfinite: u64,
    /// Names of the lights, by the events' indices.
    lights: Vec<&'a str>,
    /// Names of the objects, by the events' indices.
    objects: Vec<&'a str>,
    /// Names of the film layers, by the events' indices.
    layers: Vec<&'a str>,
    events: &'a [PathEvent],
}

/// Traces a sample of a pixel, by default its brightest, and prints every step.
pub fn run(arguments: &Arguments, loaded: &Loaded, settings: &Settings, (x, y): (u32, u32)) -> anyhow::Result<()> {
    let Settings { width, height, spp, .. } = *settings;
    if x >= width || y >= height {
        return Err(anyhow!("the picture of {width}x{height} pixels has no pixel {x},{y}"));
    }
    let scene = &loaded.scene;
    let purpose = Purpose { picture: Some((width, height)), ..Purpose::default() };
    let mut prepared = raytrace::prepare_for(scene, &loaded.assets, purpose, &GeometryCache::default())?;
    let plan = arguments.without().iter().fold(prepared.plan().clone(), |plan, shortcut| plan.without(*shortcut));
    prepared.set_plan(plan);
    let chosen = arguments.sample.unwrap_or_else(|| raytrace::brightest_sample(&prepared, settings, (x, y)));
    let replay = raytrace::replay(&prepared, settings, (x, y), chosen);
    let replay = replay.ok_or_else(|| anyhow!("a render with {spp} samples per pixel has no sample {chosen}"))?;
    let names = Names { scene, prepared: &prepared };
    if arguments.json {
        return names.print_json(&replay);
    }
    let SampleId { seed, .. } = replay.sample;
    let which = if arguments.sample.is_none() { format!(", the brightest of {spp}") } else { String::new() };
    result(format!("pixel {x},{y}, sample {chosen}{which}, seed {seed}"));
    replay.events.iter().for_each(|event| result(names.line(event)));
    if replay.nonfinite.count > 0 {
        result(format!("{} non-finite contributions were discarded", replay.nonfinite.count));
    }
    result(format!("picture value {}", triple(replay.picture_value(prepared.layers(), scene))));
    Ok(())
}

/// Names of what the events refer to by index.
struct Names<'a> {
    scene: &'a Scene,
    prepared: &'a RenderScene,
}

impl Names<'_> {
    fn print_json(&self, replay: &Replay) -> anyhow::Result<()> {
        let SampleId { x, y, index, seed } = replay.sample;
        let report = Report {
            pixel: [x, y],
            sample: index,
            seed,
            value: replay.picture_value(self.prepared.layers(), self.scene),
            nonfinite: replay.nonfinite.count,
            lights: (0..).take(self.prepared.light_count()).map(|light| self.light(light)).collect(),
            objects: self.scene.objects.iter().map(|object| object.name.as_str()).collect(),
            layers: self.prepared.layers().iter().map(|layer| layer.name.as_str()).collect(),
            events: &replay.events,
        };
        result(serde_json::to_string(&report).context("can't write the events")?);
        Ok(())
    }

    fn light(&self, index: u32) -> &str {
        let light = self.prepared.light_id(index).and_then(|id| self.scene.light(id));
        light.map_or("?", |light| &light.name)
    }

    /// One event as a line of text.
    fn line(&self, event: &PathEvent) -> String {
        match event {
            // Where the path goes
            PathEvent::CameraRay { origin, direction } => {
                format!("camera ray from {} towards {}", triple(*origin), triple(*direction))
            }
            PathEvent::Vertex(vertex) => self.vertex(vertex),
            PathEvent::Miss => "the ray leaves the studio".to_owned(),
            // Light that it finds
            PathEvent::VisibleEmitter { light, distance } => {
                format!("  visible emitter: {} at {distance} m", self.light(*light))
            }
            PathEvent::EmitterHit { light, distance, mis_weight } => {
                format!("  emitter hit: {} at {distance} m, MIS weight {mis_weight}", self.light(*light))
            }
            PathEvent::Emission => "  emission of the surface".to_owned(),
            PathEvent::LightSample { light, pmf, pdf, bsdf_pdf, visibility, mis_weight } => {
                let pdf = pdf.map_or("delta".to_owned(), |pdf| format!("pdf {pdf} /sr"));
                format!(
                    "  light sample: {}, pmf {pmf}, {pdf}, BSDF pdf {bsdf_pdf} /sr, visibility {}, MIS weight {mis_weight}",
                    self.light(*light),
                    triple(*visibility)
                )
            }
            PathEvent::PhotonGather { radius } => format!("  photons within {radius} m"),
            // How it goes on
            PathEvent::BsdfSample { lobe, direction, pdf, weight, throughput } => {
                let pdf = pdf.map_or("delta".to_owned(), |pdf| format!("pdf {pdf} /sr"));
                format!(
                    "  BSDF sample: {}, towards {}, {pdf}, weight {}, throughput {}",
                    lobe_name(*lobe),
                    triple(*direction),
                    triple(*weight),
                    triple(*throughput)
                )
            }
            PathEvent::Subsurface { position, rays, at_entry, weight, throughput } => {
                let end = if *at_entry { ", back at its entry" } else { "" };
                format!(
                    "  walk under the surface: {rays} rays, out at {}{end}, weight {}, throughput {}",
                    triple(*position),
                    triple(*weight),
                    triple(*throughput)
                )
            }
            PathEvent::BlurredGloss { roughness } => format!("  gloss blurred to a roughness of {roughness}"),
            PathEvent::CachedLight { cell_m } => {
                format!("  diffuse light from a cell of {cell_m} m of the irradiance cache")
            }
            PathEvent::PathSplit { paths } => format!("  split into {paths} paths"),
            PathEvent::DielectricSplit { reflectance } => {
                format!("  split into reflection ({reflectance}) and transmission")
            }
            PathEvent::Branch { index } => format!("path {} of the split", index + 1),
            PathEvent::Roulette { survival, u } => {
                format!("  Russian roulette: survival probability {survival}, u {u}")
            }
            // Its end and what it adds to the pixel
            PathEvent::End(end) => format!("path ends: {}", end_name(*end)),
            PathEvent::Contribution { layer, value } => {
                let name = self.prepared.layers().get(*layer).map_or("?", |layer| &layer.name);
                let discarded = if value.is_finite() { "" } else { ", not finite: discarded" };
                format!("    + {} to layer {name}{discarded}", triple(*value))
            }
        }
    }

    fn vertex(&self, vertex: &PathVertex) -> String {
        let PathVertex { depth, position, distance, normal, object, part, material, throughput } = vertex;
        let no_object = if matches!(part.as_str(), "floor" | "walls" | "ceiling") { "Room" } else { "Body of a light" };
        let object = object.map_or(no_object, |index| {
            self.scene.objects.get(index as usize).map_or("?", |object| object.name.as_str())
        });
        let part = if part.is_empty() { String::new() } else { format!(", part {part}") };
        format!(
            "vertex {depth}: {object}{part}, material {material}, at {}, {distance} m, normal {}, throughput {}",
            triple(*position),
            triple(*normal),
            triple(*throughput)
        )
    }
}

fn triple(value: Vec3) -> String {
    format!("({} {} {})", value.x, value.y, value.z)
}

fn lobe_name(lobe: ScatteringKind) -> &'static str {
    match lobe {
        ScatteringKind::NonSpecular => "diffuse or glossy",
        ScatteringKind::SpecularReflection => "specular reflection",
        ScatteringKind::SpecularTransmission => "specular transmission",
        ScatteringKind::Pane => "transmission through a pane",
    }
}

fn end_name(end: PathEnd) -> &'static str {
    match end {
        PathEnd::Depth => "maximum depth",
        PathEnd::Absorbed => "no direction carries light",
        PathEnd::Roulette => "Russian roulette",
        PathEnd::Cached => "all its light is from the irradiance cache",
    }
}
