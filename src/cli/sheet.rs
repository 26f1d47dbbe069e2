//! `catchlight sheet SCENE`: writes the set-up sheet of a studio, or a lesson sheet.

use super::failure::Failure;
use super::input::{self, StudioArguments};
use super::terminal;
use crate::io::{self, Loaded};
use crate::raytrace::{GeometryCache, RenderControl};
use crate::scene::LightId;
use crate::sheet::{
    Lesson, LessonCell, LessonError, LessonFormat, LessonSeries, LessonSheet, SheetContent, SheetFormat, Units,
    draft_picture, write_lesson, write_sheet,
};
use anyhow::anyhow;
use clap::ValueEnum;
use std::path::PathBuf;

/// The choices of `--units`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum UnitsArgument {
    /// Metres, and centimetres for modifiers.
    #[default]
    M,
    /// Feet and inches.
    Ft,
}

/// The choices of `--series`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SeriesArgument {
    /// One light swung round the subject and up, at one distance and power.
    Azimuth,
    /// One light near and far, at one exposure.
    Distance,
    /// Modifiers on one light, at one exposure.
    Modifier,
    /// A black, a grey and a white room around the set-up.
    Room,
}

/// Arguments of `sheet`.
///
/// One page to build the studio again from: the picture, a plan and an elevation to scale, camera and exposure, and for
/// each light its modifier, dial, distance, height, direction and meter reading; what to bring, and what to check on the
/// set. The meter is held where the studio's meter stands, else where the camera aims.
///
/// With --series a lesson sheet, as .png or .html: pictures side by side in which one thing changes, with captions of
/// what the meter says.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    #[command(flatten)]
    studio: StudioArguments,
    /// File of the sheet, whose extension names its format: pdf, svg, html; png or html with --series.
    #[arg(short, long)]
    output: PathBuf,
    /// Units of lengths.
    #[arg(long, value_enum, default_value_t)]
    units: UnitsArgument,
    /// Your list of gear, with which the sheet compares the studio: heads used twice, stands that are missing. See
    /// catchlight gear.
    #[arg(long, value_name = "FILE", conflicts_with = "series")]
    gear: Option<PathBuf>,
    /// Write a lesson sheet of this series.
    #[arg(long, value_enum)]
    series: Option<SeriesArgument>,
    /// The light of the lesson: its name, or a part of it [default: the strongest key light].
    #[arg(long, value_name = "NAME", requires = "series")]
    light: Option<String>,
    /// Samples per pixel of the pictures on the sheet, which are denoised.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    spp: u32,
    /// Number of threads [default: all cores]. The sheet is the same for any number.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Renders the picture, reads the meter and writes the sheet.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(series) = arguments.series {
        return write_series(arguments, series);
    }
    SheetFormat::of(&arguments.output)?;
    io::check_file(&arguments.output)?;
    let units = match arguments.units {
        UnitsArgument::M => Units::Metres,
        UnitsArgument::Ft => Units::Feet,
    };
    let own = arguments.gear.as_deref().map(super::gear::read_list).transpose()?.unwrap_or_default();
    let gear = io::bundled_gear().with(&own);
    let pool = input::thread_pool(arguments.threads.unwrap_or(0).into())?;
    let loaded = pool.install(|| arguments.studio.load())?;
    let (scene, assets) = (&loaded.scene, &loaded.assets);
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    let content = pool.install(|| -> Result<Option<SheetContent>, Failure> {
        let Some(picture) = draft_picture(scene, assets, arguments.spp, &cache, &control)? else { return Ok(None) };
        Ok(SheetContent::new(scene, assets, picture, units, &gear, &cache, &control)?)
    })?;
    write_sheet(&arguments.output, &content.ok_or(Failure::Interrupted)?)?;
    terminal::progress(format_args!("the sheet is written to {}", arguments.output.display()));
    Ok(())
}

/// Renders and writes a lesson sheet.
fn write_series(arguments: &Arguments, series: SeriesArgument) -> Result<(), Failure> {
    LessonFormat::of(&arguments.output)?;
    io::check_file(&arguments.output)?;
    let series = match series {
        SeriesArgument::Azimuth => LessonSeries::Azimuth,
        SeriesArgument::Distance => LessonSeries::Distance,
        SeriesArgument::Modifier => LessonSeries::Modifier,
        SeriesArgument::Room => LessonSeries::Room,
    };
    let pool = input::thread_pool(arguments.threads.unwrap_or(0).into())?;
    let loaded = pool.install(|| arguments.studio.load())?;
    let light = arguments.light.as_deref().map(|name| light_named(&loaded, name)).transpose()?;
    let sheet = pool.install(|| -> Result<LessonSheet, LessonError> {
        let (cache, control) = (GeometryCache::default(), RenderControl::new());
        let lesson = Lesson::new(series, &loaded.scene, &loaded.assets, light, &cache, &control)?;
        let count = lesson.cells.len();
        let mut observe = |index: usize, cell: &LessonCell| {
            let note = if cell.note.is_empty() { String::new() } else { format!(", {}", cell.note) };
            terminal::progress(format_args!("{} of {count}: {}{note}", index + 1, cell.caption));
        };
        LessonSheet::render(lesson, &loaded.assets, arguments.spp, &cache, &control, &mut observe)
    })?;
    write_lesson(&arguments.output, &sheet)?;
    terminal::progress(format_args!("the sheet is written to {}", arguments.output.display()));
    Ok(())
}

/// Returns the light of a name, or the only one whose name has such a part.
fn light_named(loaded: &Loaded, name: &str) -> anyhow::Result<LightId> {
    let lights = &loaded.scene.lights;
    let lower = name.to_lowercase();
    let exact = lights.iter().find(|light| light.name.to_lowercase() == lower);
    let mut parts = lights.iter().filter(|light| light.name.to_lowercase().contains(&lower));
    match (exact, parts.next(), parts.next()) {
        (Some(light), ..) | (None, Some(light), None) => Ok(light.id),
        _ => {
            let names: Vec<&str> = lights.iter().map(|light| light.name.as_str()).collect();
            Err(anyhow!("{name:?} is not one light of this studio: it has {}", names.join(", ")))
        }
    }
}
