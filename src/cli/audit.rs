//! `catchlight audit SCENE`: what the room does to the light on the subject.

use super::failure::Failure;
use super::input::{self, StudioArguments};
use super::terminal;
use crate::photo::text::signed_hundredths;
use crate::raytrace::{GeometryCache, RenderControl};
use crate::setup::{AuditedLight, RoomAudit, RoomSurface};
use anyhow::Context;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Arguments of `audit`.
///
/// Reads the meter at the subject with each of walls, ceiling, floor and backdrops as it is and black: the difference is
/// the light that comes by that surface, in stops that it adds to each light. Then what a black and a white ceiling would
/// change, what each light gives the background, and which lights shine at the lens.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    #[command(flatten)]
    studio: StudioArguments,
    /// Number of threads [default: all cores]. The audit is the same for any number.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// The object that `--json` prints.
#[derive(Debug, Serialize)]
struct AuditReport {
    lights: Vec<LightReport>,
    total: LightReport,
    ceilings: Vec<CeilingReport>,
    /// Lights that shine at the lens.
    flaring: Vec<String>,
}

#[derive(Debug, Serialize)]
struct LightReport {
    name: String,
    lux_s: f32,
    /// Stops that each surface adds; null where all light comes by it.
    added_stops: BTreeMap<&'static str, Option<f32>>,
    /// Exposure of the background over that of the key at the subject, stops; null in the dark.
    background_stops: Option<f32>,
}

#[derive(Debug, Serialize)]
struct CeilingReport {
    color: &'static str,
    /// Null if no light is left.
    stops: Option<f32>,
    key_to_fill: Option<f32>,
}

/// Meters the studio and prints.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pool = input::thread_pool(arguments.threads.unwrap_or(0).into())?;
    let loaded = pool.install(|| arguments.studio.load())?;
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    let audit = pool.install(|| RoomAudit::measure(&loaded.scene, &loaded.assets, &cache, &control));
    let audit = audit.context("can't meter the studio")?.ok_or(Failure::Interrupted)?;
    if arguments.json {
        terminal::result(serde_json::to_string(&report(&audit)).context("can't write the audit")?);
    } else {
        terminal::result(table(&audit).trim_end());
    }
    Ok(())
}

fn report(audit: &RoomAudit) -> AuditReport {
    let light = |light: &AuditedLight| LightReport {
        name: light.name.clone(),
        lux_s: light.lux_s,
        added_stops: (RoomSurface::ALL.into_iter())
            .filter_map(|surface| Some((surface.label(), Some(light.added_stops(surface)?).filter(|s| s.is_finite()))))
            .collect(),
        background_stops: audit.background_stops(light),
    };
    let ceilings = audit.ceilings.iter();
    AuditReport {
        lights: audit.lights.iter().map(light).collect(),
        total: light(&audit.total),
        ceilings: ceilings
            .map(|trial| CeilingReport { color: trial.color, stops: trial.stops, key_to_fill: trial.key_to_fill })
            .collect(),
        flaring: audit.flaring.clone(),
    }
}

/// Returns the audit as text: a line per light, then ceilings and flare.
fn table(audit: &RoomAudit) -> String {
    let rows = || audit.lights.iter().chain([&audit.total]);
    let width = rows().map(|light| light.name.chars().count()).max().unwrap_or(0).max(5);
    let surfaces = RoomSurface::ALL.into_iter().filter(|surface| audit.total.without_lux_s.contains_key(surface));
    let surfaces: Vec<RoomSurface> = surfaces.collect();
    let mut text =
        "Stops that each surface adds at the subject; light on the background against the key\n\n".to_owned();
    let _ = write!(text, "{:width$}", "light");
    for surface in &surfaces {
        let _ = write!(text, "  {:>10}", surface.label());
    }
    text += "  background\n";
    for light in rows() {
        let _ = write!(text, "{:width$}", light.name);
        for surface in &surfaces {
            let stops = light.added_stops(*surface).map_or_else(|| "dark".to_owned(), stops_text);
            let _ = write!(text, "  {stops:>w$}", w = surface.label().len().max(10));
        }
        let background = audit.background_stops(light).map_or_else(|| "none".to_owned(), signed_hundredths);
        let _ = writeln!(text, "  {background:>10}");
    }
    text.push('\n');
    for trial in &audit.ceilings {
        let stops =
            trial.stops.map_or_else(|| "no light".to_owned(), |stops| format!("{} stops", signed_hundredths(stops)));
        let _ = write!(text, "a {} ceiling: {stops} at the subject", trial.color);
        if let (Some(now), Some(then)) = (audit.key_to_fill, trial.key_to_fill) {
            let _ = write!(text, ", key:fill {then:.1}:1 instead of {now:.1}:1");
        }
        text.push('\n');
    }
    for name in &audit.flaring {
        let _ = writeln!(text, "{name} shines at the lens: shade it with a flag, or use a lens hood");
    }
    text
}

fn stops_text(stops: f32) -> String {
    if stops.is_finite() { signed_hundredths(stops) } else { "all".to_owned() }
}
