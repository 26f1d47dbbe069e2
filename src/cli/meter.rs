//! `catchlight meter SCENE --at X,Y,Z`: reads an incident light meter at a point of the studio.

use super::failure::Failure;
use super::input::{self, StudioArguments};
use super::terminal;
use crate::io::Loaded;
use crate::jobs::read_meter;
use crate::photo::meter::{LUX_PER_FOOT_CANDLE, LightReading, Reading, Receptor, nearest_third};
use crate::photo::thirds::Dial;
use crate::raytrace::{GeometryCache, MeterEffort, MeterPoint, MeterResult, RenderControl};
use crate::scene::Scene;
use anyhow::{Context, anyhow};
use glam::Vec3;
use serde::Serialize;
use std::fmt::Write;

/// Arguments of `meter`.
///
/// Continuous light is read in lux, flash in lux seconds. A flash in lux is the continuous light that gives the same
/// exposure at the camera's shutter: lux times shutter is lux seconds for every light. The receptor is 0.02 mm in front
/// of the point, so that a point on a surface reads the light that falls on it.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    #[command(flatten)]
    studio: StudioArguments,
    /// Position of the receptor: X,Y,Z in metres [default: position, direction and receptor of the studio's own meter].
    #[arg(long, value_name = "X,Y,Z", value_parser = input::parse_vec3, allow_hyphen_values = true)]
    at: Option<Vec3>,
    /// Direction that the receptor faces: X,Y,Z of any length [default: towards the camera].
    #[arg(long, value_name = "X,Y,Z", value_parser = input::parse_vec3, allow_hyphen_values = true)]
    facing: Option<Vec3>,
    /// Use a dome (cardioid response) instead of the flat receptor (cosine response).
    #[arg(long)]
    dome: bool,
    /// Number of paths for the bounced light, and of points on each emitter [default: until the standard error of every
    /// light is 0.15 %, or after 3 million rays].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    spp: Option<u32>,
    /// Number of threads [default: all cores]. The reading is the same for any number.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Seed of the sampling error.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// The object that `--json` prints.
#[derive(Debug, Serialize)]
struct MeterReport {
    at: [f32; 3],
    receptor: &'static str,
    /// Unit vector.
    facing: [f32; 3],
    total: TotalReport,
    lights: Vec<LightReport>,
    ratios: Vec<RatioReport>,
    /// Name of the light that `share_stops` compares with.
    key: Option<String>,
    flash_percent: Option<f32>,
    /// Standard error of the total, percent.
    noise_percent: Option<f32>,
    paths: u64,
    rays: u64,
    nonfinite: u64,
}

#[derive(Debug, Serialize)]
struct TotalReport {
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
    /// ND filter and bellows factor that `f_number` makes up for.
    nd_stops: f32,
    bellows_stops: f32,
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
    let pool = input::thread_pool(arguments.threads.unwrap_or(0).into())?;
    let loaded = pool.install(|| arguments.studio.load())?;
    let point = meter_point(arguments, &loaded.scene)?;
    let result = pool.install(|| read(arguments, &loaded, &point))?;
    warn(&loaded.scene, &point, &result);
    if arguments.json {
        terminal::result(serde_json::to_string(&report(&point, &result)).context("can't write the reading")?);
    } else {
        terminal::result(table(arguments, &point, &result).trim_end());
    }
    Ok(())
}

fn meter_point(arguments: &Arguments, scene: &Scene) -> anyhow::Result<MeterPoint> {
    let own = scene.meter.filter(|_| arguments.at.is_none());
    let position = arguments.at.or(own.map(|meter| meter.position));
    let position = position.context("name the meter's position with --at X,Y,Z, or add a meter in the editor")?;
    anyhow::ensure!(position.abs().max_element() <= 1e6, "--at {position} is more than 1000 km from the origin");
    let facing = match (arguments.facing, own) {
        (Some(direction), _) => direction
            .as_dvec3()
            .try_normalize()
            .ok_or_else(|| anyhow!("--facing {direction} has length 0, and so no direction"))?
            .as_vec3(),
        (None, Some(meter)) => meter.direction(scene),
        (None, None) => (scene.camera.position - position)
            .try_normalize()
            .ok_or_else(|| anyhow!("the meter is at the camera's position; name its direction with --facing X,Y,Z"))?,
    };
    let dome = arguments.dome || own.is_some_and(|meter| meter.receptor == Receptor::Dome);
    let receptor = if dome { Receptor::Dome } else { Receptor::Flat };
    Ok(MeterPoint { position, facing, receptor })
}

fn read(arguments: &Arguments, loaded: &Loaded, point: &MeterPoint) -> anyhow::Result<MeterResult> {
    let effort = MeterEffort { paths: arguments.spp, seed: arguments.seed, ..MeterEffort::default() };
    let (cache, control, mut result) = (GeometryCache::default(), RenderControl::new(), None);
    let mut observe = |reading| result = Some(reading);
    read_meter(&loaded.scene, &loaded.assets, point, &[effort], &cache, &control, &mut observe)?;
    result.ok_or_else(|| anyhow!("the reading was cancelled"))
}

/// Warns of a meter in an object or outside of the room, of darkness, and of non-finite contributions.
fn warn(scene: &Scene, point: &MeterPoint, result: &MeterResult) {
    if let Some(object) = result.inside.and_then(|index| scene.objects.get(index as usize)) {
        terminal::warning(format_args!("the meter is inside of {:?}", object.name));
    }
    let outside = scene.room.as_ref().is_some_and(|room| {
        let half = room.size_m * 0.5;
        let p = point.position;
        p.x.abs() > half.x || p.z.abs() > half.z || p.y < 0.0 || p.y > room.size_m.y
    });
    if outside {
        terminal::warning("the meter is outside of the room");
    }
    if !scene.lights.iter().any(|light| light.on) {
        terminal::warning("no light is on");
    }
    if result.nonfinite.count > 0 {
        terminal::warning(format_args!("{} non-finite contributions were left out", result.nonfinite.count));
    }
}

fn report(point: &MeterPoint, result: &MeterResult) -> MeterReport {
    let reading = &result.reading;
    let (direct_lux, bounced_lux) = reading.total_lux();
    let lux = direct_lux + bounced_lux;
    MeterReport {
        at: point.position.to_array(),
        receptor: point.receptor.label(),
        facing: point.facing.to_array(),
        total: TotalReport {
            direct_lux,
            bounced_lux,
            lux,
            lux_s: reading.total_lux_s(),
            foot_candles: lux / LUX_PER_FOOT_CANDLE,
            ev100: Some(reading.ev100()).filter(|ev| ev.is_finite()),
            f_number: reading.f_number(),
            iso: reading.iso,
            shutter_s: reading.shutter_s,
            nd_stops: reading.nd_stops,
            bellows_stops: reading.bellows_stops,
        },
        lights: reading.lights.iter().map(|light| light_report(reading, light)).collect(),
        ratios: (reading.ratios().into_iter().flatten())
            .map(|ratio| RatioReport { name: ratio.name, value: ratio.value, stops: ratio.stops() })
            .collect(),
        key: reading.key().map(|key| key.name.clone()),
        flash_percent: reading.flash_fraction().map(|share| share * 100.0),
        noise_percent: reading.relative_error().map(|error| error * 100.0),
        paths: result.paths,
        rays: result.rays,
        nonfinite: result.nonfinite.count,
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
        share_stops: reading.stops_over_key(light),
        noise_lux: reading.as_lux(light, light.standard_error),
    }
}

/// Returns the reading as text: a line per light, then the camera settings.
fn table(arguments: &Arguments, point: &MeterPoint, result: &MeterResult) -> String {
    let reading = &result.reading;
    let [p, d] = [point.position, point.facing];
    let to_camera = arguments.facing.is_none() && arguments.at.is_some();
    let towards = if to_camera { "the camera".to_owned() } else { vector(d) };
    let mut text = format!("{} receptor at {} m, facing {towards}\n\n", point.receptor.label(), vector(p));
    let width = reading.lights.iter().map(|l| l.name.chars().count()).max().unwrap_or(0).max(5);
    let _ = writeln!(
        text,
        "{:width$}  {:>10}  {:>10}  {:>10}        {:>10}",
        "light", "direct", "bounced", "total", "to key"
    );
    for light in &reading.lights {
        let unit = if light.flash { "lx s" } else { "lx" };
        let share = reading.stops_over_key(light).map_or("\u{2013}".to_owned(), |s| format!("{s:+.2} stops"));
        let [direct, bounced, sum] = [light.direct, light.bounced, light.sum()].map(digits);
        let _ = writeln!(text, "{:width$}  {direct:>10}  {bounced:>10}  {sum:>10} {unit:<4}  {share:>11}", light.name);
    }
    if reading.total_lux_s() <= 0.0 {
        let missed = reading.missed_lux_s() / reading.shutter_s;
        text += &if missed > 0.0 {
            format!("\nno light was found; mirrors or glass may throw up to {} lx on the meter\n", digits(missed))
        } else {
            "\nno light reaches the meter\n".to_owned()
        };
        return text;
    }
    let (direct, bounced) = reading.total_lux();
    let lux = direct + bounced;
    let _ = writeln!(
        text,
        "\n{} ({:.2}) at ISO {} and {}{}   EV100 {:.2}",
        nearest_third(reading.f_number()),
        reading.f_number(),
        Dial::Iso.label(reading.iso),
        Dial::Shutter.label(reading.shutter_s),
        reading.compensation(),
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
    let share = 100.0 * reading.flash_fraction().unwrap_or(0.0);
    let error = 100.0 * reading.relative_error().unwrap_or(0.0);
    let _ = writeln!(text, "flash {share:.1} %, continuous {:.1} %", 100.0 - share);
    let _ = writeln!(text, "standard error {error:.2} %, {} paths", result.paths);
    text
}

fn vector(v: Vec3) -> String {
    format!("{:.2},{:.2},{:.2}", v.x, v.y, v.z)
}

/// Returns a number with four significant digits, or all digits before the point.
fn digits(value: f32) -> String {
    match value.abs() {
        v if v >= 1000.0 => format!("{value:.0}"),
        v if v >= 100.0 => format!("{value:.1}"),
        v if v >= 10.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}
