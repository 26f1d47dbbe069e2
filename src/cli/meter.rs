//! `catchlight meter SCENE --at X,Y,Z`: what an incident light meter reads at a place of the studio.

use super::{Failure, input, say};
use crate::io::Loaded;
use crate::photo::meter::{LUX_PER_FOOT_CANDLE, LightReading, Reading, Receptor, nearest_third};
use crate::photo::thirds::Dial;
use crate::raytrace::{LightMeter, MeterEffort, MeterPoint, MeterResult, RenderControl};
use crate::scene::Scene;
use anyhow::{Context, anyhow};
use glam::Vec3;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

/// Arguments of `meter`.
///
/// Continuous light is read in lux, flash in lux seconds. Where a flash is told in lux, that is the steady light which
/// would expose the same at the camera's shutter: lux times shutter is lux seconds for every light. The receptor stands
/// 0.02 mm before the place, so that a place on a surface reads what falls on it.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// Studio: a .ron file, or the name of a shipped one.
    scene: PathBuf,
    /// Where the receptor is: X,Y,Z in metres [default: where the studio's own meter stands, as that stands].
    #[arg(long, value_name = "X,Y,Z", value_parser = input::parse_vec3, allow_hyphen_values = true)]
    at: Option<Vec3>,
    /// The direction that it faces: X,Y,Z of any length [default: towards the camera].
    #[arg(long, value_name = "X,Y,Z", value_parser = input::parse_vec3, allow_hyphen_values = true)]
    facing: Option<Vec3>,
    /// A dome (cardioid response) in place of the flat receptor (cosine law).
    #[arg(long)]
    dome: bool,
    /// Paths for the bounced light, and points on each emitter [default: until every light is good to 0.15 %, or 3
    /// million rays are spent].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    spp: Option<u32>,
    /// Threads [default: all cores]. The reading is the same for any number.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Another seed gives another sampling error.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report {
    at: [f32; 3],
    receptor: &'static str,
    /// Unit vector.
    facing: [f32; 3],
    total: Total,
    lights: Vec<LightReport>,
    ratios: Vec<RatioReport>,
    /// The light that `share_stops` compares with.
    key: Option<String>,
    flash_percent: Option<f32>,
    /// Standard error of the whole, percent.
    noise_percent: Option<f32>,
    paths: u64,
    rays: u64,
    nonfinite: u64,
}

#[derive(Debug, Serialize)]
struct Total {
    direct_lux: f32,
    bounced_lux: f32,
    lux: f32,
    lux_s: f32,
    foot_candles: f32,
    /// Null in the dark.
    ev100: Option<f32>,
    f_number: f32,
    iso: f32,
    shutter_s: f32,
}

#[derive(Debug, Serialize)]
struct LightReport {
    name: String,
    flash: bool,
    direct_lux: f32,
    bounced_lux: f32,
    lux: f32,
    lux_s: f32,
    /// Null in the dark.
    share_stops: Option<f32>,
    /// Standard error, lux.
    noise_lux: f32,
}

#[derive(Debug, Serialize)]
struct RatioReport {
    name: &'static str,
    value: f32,
    stops: f32,
}

/// Reads the meter and prints.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.unwrap_or(0).into())
        .build()
        .map_err(|error| Failure::Machine(anyhow!(error).context("can't start the threads")))?;
    let loaded = pool.install(|| input::load_studio(&arguments.scene))?;
    let place = place(arguments, &loaded.scene)?;
    let probed = pool.install(|| read(arguments, &loaded, &place))?;
    warn(&loaded.scene, &place, &probed);
    if arguments.json {
        say(serde_json::to_string(&report(&place, &probed)).context("can't write the reading")?);
    } else {
        say(table(arguments, &place, &probed).trim_end());
    }
    Ok(())
}

fn place(arguments: &Arguments, scene: &Scene) -> anyhow::Result<MeterPoint> {
    let own = scene.meter.filter(|_| arguments.at.is_none());
    let position = arguments.at.or(own.map(|meter| meter.position));
    let position = position.context("say where the meter is with --at X,Y,Z, or put one up in the editor")?;
    anyhow::ensure!(
        position.abs().max_element() <= 1e6,
        "--at {position} is further from the origin than a studio reaches (1000 km)"
    );
    let facing = match (arguments.facing, own) {
        (Some(direction), _) => direction
            .as_dvec3()
            .try_normalize()
            .ok_or_else(|| anyhow!("--facing {direction} has no length, and so no direction"))?
            .as_vec3(),
        (None, Some(meter)) => meter.direction(scene),
        (None, None) => (scene.camera.position - position)
            .try_normalize()
            .ok_or_else(|| anyhow!("the meter is where the camera is; say what it faces with --facing X,Y,Z"))?,
    };
    let dome = arguments.dome || own.is_some_and(|meter| meter.receptor == Receptor::Dome);
    let receptor = if dome { Receptor::Dome } else { Receptor::Flat };
    Ok(MeterPoint { position, facing, receptor })
}

fn read(arguments: &Arguments, loaded: &Loaded, place: &MeterPoint) -> anyhow::Result<MeterResult> {
    let probe = LightMeter::new(&loaded.scene, &loaded.assets, place.position)?;
    let effort = MeterEffort { paths: arguments.spp, seed: arguments.seed, ..MeterEffort::default() };
    probe.read(place, &effort, &RenderControl::new()).ok_or_else(|| anyhow!("the reading was cancelled"))
}

/// What a photographer hardly meant.
fn warn(scene: &Scene, place: &MeterPoint, probed: &MeterResult) {
    if let Some(object) = probed.inside.and_then(|index| scene.objects.get(index as usize)) {
        eprintln!("warning: the meter is inside of {:?}", object.name);
    }
    let outside = scene.room.as_ref().is_some_and(|room| {
        let half = room.size_m * 0.5;
        let p = place.position;
        p.x.abs() > half.x || p.z.abs() > half.z || p.y < 0.0 || p.y > room.size_m.y
    });
    if outside {
        eprintln!("warning: the meter is outside of the room");
    }
    if !scene.lights.iter().any(|light| light.on) {
        eprintln!("warning: no light is on");
    }
    if probed.nonfinite.count > 0 {
        eprintln!("warning: {} non-finite contributions were left out", probed.nonfinite.count);
    }
}

fn report(place: &MeterPoint, probed: &MeterResult) -> Report {
    let reading = &probed.reading;
    let (direct_lux, bounced_lux) = reading.total_lux();
    let lux = direct_lux + bounced_lux;
    Report {
        at: place.position.to_array(),
        receptor: place.receptor.label(),
        facing: place.facing.to_array(),
        total: Total {
            direct_lux,
            bounced_lux,
            lux,
            lux_s: reading.total_lux_s(),
            foot_candles: lux / LUX_PER_FOOT_CANDLE,
            ev100: Some(reading.ev100()).filter(|ev| ev.is_finite()),
            f_number: reading.f_number(),
            iso: reading.iso,
            shutter_s: reading.shutter_s,
        },
        lights: reading.lights.iter().map(|light| light_report(reading, light)).collect(),
        ratios: (reading.ratios().into_iter().flatten())
            .map(|ratio| RatioReport { name: ratio.name, value: ratio.value, stops: ratio.stops() })
            .collect(),
        key: reading.key().map(|key| key.name.clone()),
        flash_percent: reading.flash_share().map(|share| share * 100.0),
        noise_percent: reading.relative_error().map(|error| error * 100.0),
        paths: probed.paths,
        rays: probed.rays,
        nonfinite: probed.nonfinite.count,
    }
}

fn light_report(reading: &Reading, light: &LightReading) -> LightReport {
    LightReport {
        name: light.name.clone(),
        flash: light.flash,
        direct_lux: reading.as_lux(light, light.direct),
        bounced_lux: reading.as_lux(light, light.bounced),
        lux: reading.as_lux(light, light.sum()),
        lux_s: reading.lux_s(light),
        share_stops: reading.share_stops(light),
        noise_lux: reading.as_lux(light, light.standard_error),
    }
}

/// The reading for a reader: a line a light, then what to set.
fn table(arguments: &Arguments, place: &MeterPoint, probed: &MeterResult) -> String {
    let reading = &probed.reading;
    let [p, d] = [place.position, place.facing];
    let to_camera = arguments.facing.is_none() && arguments.at.is_some();
    let towards = if to_camera { "the camera".to_owned() } else { vector(d) };
    let mut text = format!("{} receptor at {} m, facing {towards}\n\n", place.receptor.label(), vector(p));
    let width = reading.lights.iter().map(|l| l.name.chars().count()).max().unwrap_or(0).max(5);
    let _ = writeln!(
        text,
        "{:width$}  {:>10}  {:>10}  {:>10}        {:>10}",
        "light", "direct", "bounced", "total", "to key"
    );
    for light in &reading.lights {
        let unit = if light.flash { "lx s" } else { "lx" };
        let share = reading.share_stops(light).map_or("\u{2013}".to_owned(), |s| format!("{s:+.2} stops"));
        let [direct, bounced, sum] = [light.direct, light.bounced, light.sum()].map(digits);
        let _ = writeln!(text, "{:width$}  {direct:>10}  {bounced:>10}  {sum:>10} {unit:<4}  {share:>11}", light.name);
    }
    if reading.total_lux_s() <= 0.0 {
        text += "\nno light reaches the meter\n";
        return text;
    }
    let (direct, bounced) = reading.total_lux();
    let lux = direct + bounced;
    let _ = writeln!(
        text,
        "\n{} ({:.2}) at ISO {} and {}   EV100 {:.2}",
        nearest_third(reading.f_number()),
        reading.f_number(),
        Dial::Iso.label(reading.iso),
        Dial::Shutter.label(reading.shutter_s),
        reading.ev100()
    );
    let _ = writeln!(
        text,
        "{} lx s in one exposure, as steady light {} lx = {} fc, of it {:.0} % bounced",
        digits(reading.total_lux_s()),
        digits(lux),
        digits(lux / LUX_PER_FOOT_CANDLE),
        100.0 * bounced / lux
    );
    for ratio in reading.ratios().into_iter().flatten() {
        let _ = writeln!(text, "{} {:.2}:1, {:.2} stops", ratio.name, ratio.value, ratio.stops());
    }
    let share = 100.0 * reading.flash_share().unwrap_or(0.0);
    let error = 100.0 * reading.relative_error().unwrap_or(0.0);
    let _ = writeln!(text, "flash {share:.1} %, continuous {:.1} %", 100.0 - share);
    let _ = writeln!(text, "standard error {error:.2} %, {} paths", probed.paths);
    text
}

fn vector(v: Vec3) -> String {
    format!("{:.2},{:.2},{:.2}", v.x, v.y, v.z)
}

/// Four digits and no more.
fn digits(value: f32) -> String {
    match value.abs() {
        v if v >= 1000.0 => format!("{value:.0}"),
        v if v >= 100.0 => format!("{value:.1}"),
        v if v >= 10.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}
