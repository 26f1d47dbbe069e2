//! `catchlight sheet SCENE`: writes the set-up sheet of a studio.

use super::failure::Failure;
use super::{input, terminal};
use crate::io;
use crate::raytrace::{GeometryCache, RenderControl};
use crate::sheet::{SheetContent, SheetFormat, Units, draft_picture, write_sheet};
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

/// Arguments of `sheet`.
///
/// One page to build the studio again from: the picture, a plan and an elevation to scale, camera and exposure, and for
/// each light its modifier, dial, distance, height, direction and meter reading; what to bring, and what to check on the
/// set. The meter is held where the studio's meter stands, else where the camera aims.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// Studio: a .ron file, or the name of a shipped one.
    scene: PathBuf,
    /// File of the sheet, whose extension names its format: pdf, svg, html.
    #[arg(short, long)]
    output: PathBuf,
    /// Units of lengths.
    #[arg(long, value_enum, default_value_t)]
    units: UnitsArgument,
    /// Samples per pixel of the picture on the sheet, which is denoised.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    spp: u32,
    /// Number of threads [default: all cores]. The sheet is the same for any number.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Renders the picture, reads the meter and writes the sheet.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    SheetFormat::of(&arguments.output)?;
    io::check_file(&arguments.output)?;
    let units = match arguments.units {
        UnitsArgument::M => Units::Metres,
        UnitsArgument::Ft => Units::Feet,
    };
    let pool = input::thread_pool(arguments.threads.unwrap_or(0).into())?;
    let loaded = pool.install(|| input::load_studio(&arguments.scene))?;
    let (scene, assets) = (&loaded.scene, &loaded.assets);
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    let content = pool.install(|| -> Result<Option<SheetContent>, Failure> {
        let Some(picture) = draft_picture(scene, assets, arguments.spp, &cache, &control)? else { return Ok(None) };
        Ok(SheetContent::new(scene, assets, picture, units, &cache, &control)?)
    })?;
    write_sheet(&arguments.output, &content.ok_or(Failure::Interrupted)?)?;
    terminal::progress(format_args!("the sheet is written to {}", arguments.output.display()));
    Ok(())
}
