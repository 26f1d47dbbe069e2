//! `catchlight solve SCENE --want "Key=f/8,Fill=-1.5"`: finds dial settings for wanted exposures.

use super::failure::Failure;
use super::input::{self, StudioArguments};
use super::terminal;
use crate::io::{self, AssetFiles, Loaded};
use crate::photo::light_dial_text;
use crate::photo::meter::nearest_third;
use crate::photo::text::signed_stops;
use crate::photo::thirds::Dial;
use crate::raytrace::{GeometryCache, RenderControl};
use crate::scene::Scene;
use crate::setup::{DialPlan, MeteredAt, PlannedDial, SetupTransport, WishOutcome, named_levels, solve_dials, wishes};
use anyhow::Context;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Arguments of `solve`.
///
/// Each wish is NAME=LEVEL. NAME is a light, a part of its name, a role (key, fill, rim, hair, accent), or a place:
/// subject (all light on the meter of the studio), background (all light behind the subject, where the picture shows
/// it), spill (light on the subject of lights that aim at something else). LEVEL is an f-number at the camera's ISO and
/// shutter (f/8), stops over the key (+0.5, -1.5), or white or grey for the background. A light is metered by itself:
/// at the subject, or where it aims, or, for a rim light, turned to it.
///
/// Dials that change are set within the range and steps of their heads; of heads that are not known in tenths of a stop
/// between full power and 1/512. Lights that no wish concerns keep theirs. Wishes that
/// cannot be met are met as nearly as possible, with a warning.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    #[command(flatten)]
    studio: StudioArguments,
    /// Wishes, separated by commas: "Key=f/8,Fill=-1.5,Background=white".
    #[arg(long, value_name = "WISHES", required = true)]
    want: Vec<String>,
    /// Write the studio with these dials to a .ron file.
    #[arg(long, value_name = "OUT.ron")]
    write: Option<PathBuf>,
    /// Number of threads [default: all cores]. The dials are the same for any number.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// The object that `--json` prints.
#[derive(Debug, Serialize)]
struct SolveReport {
    iso: f32,
    shutter_s: f32,
    f_number: f32,
    wishes: Vec<WishReport>,
    dials: Vec<DialReport>,
    /// Luminous energy of all lights that are on in one exposure, lm s.
    energy_before_lm_s: f32,
    energy_after_lm_s: f32,
}

#[derive(Debug, Serialize)]
struct WishReport {
    name: String,
    wish: String,
    /// Null where no exposure is enough: white of a black background.
    wanted_f_number: Option<f32>,
    before_f_number: f32,
    after_f_number: f32,
    is_met: bool,
    /// Stops over the wanted exposure; null if the wish is met, or if no light can meet it.
    missed_stops: Option<f32>,
    /// Half of the range over the background, stops.
    evenness_stops: Option<f32>,
    note: Option<String>,
}

#[derive(Debug, Serialize)]
struct DialReport {
    name: String,
    was_on: bool,
    before_stops: f32,
    after_stops: f32,
}

/// Meters the studio, solves for the dials and prints them.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.write {
        io::check_file(path)?;
    }
    let wanted = arguments.want.join(",");
    // Report misspelt wishes before the metering, which takes seconds
    named_levels(&wanted)?;
    let pool = input::thread_pool(arguments.threads.unwrap_or(0).into())?;
    let loaded = pool.install(|| arguments.studio.load())?;
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    let setup = pool.install(|| SetupTransport::measure(&loaded.scene, &loaded.assets, &cache, &control));
    let setup = setup.context("can't meter the studio")?.ok_or(Failure::Interrupted)?;
    let plan = solve_dials(&setup, &wishes(&wanted, &setup)?);
    for outcome in &plan.outcomes {
        if let Some(note) = outcome.note() {
            terminal::warning(format_args!("{}={} cannot be met: {note}", outcome.wish.name, outcome.wish.level));
        }
    }
    if let Some(path) = &arguments.write {
        write_studio(&loaded, &arguments.studio.scene, &plan, path)?;
        terminal::progress(format_args!("the studio is written to {}", path.display()));
    }
    if arguments.json {
        let report = report(&loaded.scene, &setup, &plan);
        terminal::result(serde_json::to_string(&report).context("can't write the dials")?);
    } else {
        terminal::result(table(&loaded.scene, &setup, &plan).trim_end());
    }
    Ok(())
}

/// Writes the studio with the planned dials, and its models and textures beside it.
fn write_studio(loaded: &Loaded, source: &Path, plan: &DialPlan, path: &Path) -> anyhow::Result<()> {
    let mut scene = loaded.scene.clone();
    plan.apply(&mut scene);
    let files = AssetFiles::in_folder(source.parent().filter(|_| source.exists()));
    let (copies, gone) = files.copies_into(path.parent().unwrap_or(Path::new("")), &scene, &loaded.assets);
    for copy in copies {
        copy.make()?;
    }
    gone.iter().for_each(|file| terminal::warning(format!("{file} is gone: the new studio will miss it")));
    io::save_scene(&scene, path)?;
    Ok(())
}

fn report(scene: &Scene, setup: &SetupTransport, plan: &DialPlan) -> SolveReport {
    let wish = |outcome: &WishOutcome| WishReport {
        name: outcome.wish.name.clone(),
        wish: outcome.wish.level.to_string(),
        wanted_f_number: Some(setup.f_number(outcome.wanted_lux_s)).filter(|number| number.is_finite()),
        before_f_number: setup.f_number(outcome.before_lux_s),
        after_f_number: setup.f_number(outcome.after_lux_s),
        is_met: outcome.missed_stops.is_none(),
        missed_stops: outcome.missed_stops.filter(|stops| stops.is_finite()),
        evenness_stops: outcome.evenness_stops.filter(|stops| stops.is_finite()),
        note: outcome.note(),
    };
    let dial = |dial: &PlannedDial| DialReport {
        name: dial.name.clone(),
        was_on: dial.was_on,
        before_stops: dial.from_stops,
        after_stops: dial.to_stops,
    };
    let [energy_before_lm_s, energy_after_lm_s] = plan.energy_lm_s;
    SolveReport {
        iso: scene.camera.iso,
        shutter_s: scene.camera.shutter_s,
        f_number: scene.camera.f_number,
        wishes: plan.outcomes.iter().map(wish).collect(),
        dials: plan.dials.iter().map(dial).collect(),
        energy_before_lm_s,
        energy_after_lm_s,
    }
}

/// Returns the plan as text: a line per wish, then a line per light.
fn table(scene: &Scene, setup: &SetupTransport, plan: &DialPlan) -> String {
    let camera = &scene.camera;
    let [iso, shutter] = [Dial::Iso.label(camera.iso), Dial::Shutter.label(camera.shutter_s)];
    let mut text =
        format!("f-numbers at ISO {iso} and {shutter}; the camera is at {}\n\n", Dial::FNumber.label(camera.f_number));
    let names = plan.outcomes.iter().map(|outcome| &outcome.wish.name).chain(plan.dials.iter().map(|dial| &dial.name));
    let width = names.map(|name| name.chars().count()).max().unwrap_or(0).max(5);
    let _ = writeln!(text, "{:width$}  {:>8}  {:>8}  {:>8}", "wish", "wanted", "now", "then");
    for outcome in &plan.outcomes {
        let number = |lux_s: f32| if lux_s > 0.0 { nearest_third(setup.f_number(lux_s)) } else { "dark".to_owned() };
        let [before, after] = [outcome.before_lux_s, outcome.after_lux_s].map(number);
        let remark = match (outcome.missed_stops.is_some(), outcome.evenness_stops) {
            (true, _) => "  not met".to_owned(),
            (false, Some(stops)) => format!("  even to {stops:.1} stops"),
            (false, None) => String::new(),
        };
        let (name, level) = (&outcome.wish.name, outcome.wish.level.to_string());
        let _ = writeln!(text, "{name:width$}  {level:>8}  {before:>8}  {after:>8}{remark}");
    }
    let _ = writeln!(text, "\n{:width$}  {:>8}  {:>8}", "light", "now", "dial");
    for dial in &plan.dials {
        let now = if dial.was_on { signed_stops(dial.from_stops) } else { "off".to_owned() };
        let then = signed_stops(dial.to_stops);
        let light = scene.lights.iter().find(|light| light.id == dial.light);
        let display = light.map_or_else(String::new, |light| light_dial_text(light, dial.to_stops));
        let at = setup.light(dial.light).map_or("", |light| match light.at {
            MeteredAt::Subject => "",
            MeteredAt::Rim => ", metered from behind",
            MeteredAt::Aim => ", metered where it aims",
        });
        let change = if dial.is_change() { "" } else { ", unchanged" };
        let _ = writeln!(text, "{:width$}  {now:>8}  {then:>8}  ({display} on the head{at}{change})", dial.name);
    }
    let [before, after] = plan.energy_lm_s;
    if before > 0.0 && after > 0.0 {
        let _ = writeln!(text, "\nlight energy of one exposure: {} stops", signed_stops((after / before).log2()));
    }
    text
}
