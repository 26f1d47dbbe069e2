//! `catchlight merge PART... -o OUT`: makes a picture of the parts that `render --samples` wrote.

use super::denoised_output::{Denoise, Output, Written};
use super::failure::Failure;
use super::terminal;
use crate::io::{self, PictureFormat, PictureInfo, PicturePart};
use anyhow::{Context, anyhow};
use serde::Serialize;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Arguments of `merge`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Parts of one picture, in any order.
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// Picture file, whose extension names its format: png, jpg, tif of 16 bits (as shown), exr (scene-linear).
    #[arg(short, long)]
    output: PathBuf,
    /// Write one EXR layer per light beside the whole picture (exr only).
    #[arg(long)]
    layers: bool,
    /// Remove the noise with a neural network; the parts must be rendered with --denoise on or --aovs. An EXR file holds
    /// the noisy picture, too (noisy.R/G/B).
    #[arg(long, value_enum, value_name = "HOW", default_value_t)]
    denoise: Denoise,
    /// Make a picture of fewer samples where parts are missing.
    #[arg(long)]
    incomplete: bool,
    /// Print one JSON object with the statistics.
    #[arg(long)]
    json: bool,
}

/// The object that `--json` prints.
#[derive(Debug, Serialize)]
struct MergeReport {
    output: String,
    studio: String,
    parts: usize,
    /// Samples of each pixel, and those of the complete picture.
    samples: u32,
    of: u32,
    /// At most so much noise.
    noise_stops: Option<f64>,
    /// Time to denoise, seconds; null for a picture that is not denoised.
    denoise_s: Option<f64>,
}

/// Reads the parts, writes the picture and prints the statistics.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let output = &arguments.output;
    io::check_picture_file(output)?;
    let is_exr = PictureFormat::of(output)? == PictureFormat::Exr;
    if arguments.layers && !is_exr {
        return Err(Failure::Input(anyhow!("--layers needs a picture that ends in .exr, not {}", output.display())));
    }
    if arguments.parts.contains(output) {
        return Err(Failure::Input(anyhow!("the picture would replace a part: {}", output.display())));
    }
    // Add up the parts
    let merged = merge(&arguments.parts)?;
    let missing = merged.missing();
    if !missing.is_empty() {
        let message = format!("of the samples 0..{}, {} are missing", merged.whole.of, list(&missing));
        if !arguments.incomplete {
            return Err(Failure::Input(anyhow!("{message}; --incomplete makes a picture without them")));
        }
        terminal::warning(message);
    }
    // Write the picture
    let sums = &merged.whole.sums;
    let info = PictureInfo { spp: sums.samples, ..merged.whole.info.clone() };
    let picture = Output {
        path: output,
        size: (sums.width, sums.height),
        picture: sums.develop(),
        layers: if arguments.layers { sums.lazy_layers() } else { Vec::new() },
        aovs: sums.develop_aovs(),
        info,
    };
    let Written { picture: written, denoise_s } = picture.write(arguments.denoise)?;
    let report = MergeReport {
        output: written.path.display().to_string(),
        studio: merged.whole.studio.clone(),
        parts: arguments.parts.len(),
        samples: sums.samples,
        of: merged.whole.of,
        noise_stops: sums.noise_stops(),
        denoise_s,
    };
    report.print(arguments.json)?;
    written.finish()
}

impl MergeReport {
    fn print(&self, json: bool) -> anyhow::Result<()> {
        if json {
            terminal::result(serde_json::to_string(self).context("can't write the statistics")?);
            return Ok(());
        }
        let noise = self.noise_stops.map_or(String::new(), |noise| format!(", noise at most {noise:.2} stops"));
        let MergeReport { output, parts, samples, .. } = self;
        terminal::progress(format_args!("{output}: {samples} samples a pixel of {parts} parts{noise}"));
        Ok(())
    }
}

/// The sum of some parts.
struct Merged<'a> {
    /// As the first part, with the sums of all.
    whole: PicturePart,
    /// The samples of each part.
    ranges: Vec<(Range<u32>, &'a Path)>,
}

/// Reads and adds the parts one by one.
fn merge(paths: &[PathBuf]) -> anyhow::Result<Merged<'_>> {
    let (first, others) = paths.split_first().ok_or_else(|| anyhow!("there are no parts"))?;
    let whole = read(first)?;
    let mut merged = Merged { ranges: vec![(whole.samples.clone(), first)], whole };
    others.iter().try_for_each(|path| merged.add(path, &read(path)?))?;
    Ok(merged)
}

fn read(path: &Path) -> anyhow::Result<PicturePart> {
    io::read_part(path).map_err(|why| anyhow!("can't read the part: {why}: {}", path.display()))
}

impl<'a> Merged<'a> {
    fn add(&mut self, path: &'a Path, part: &PicturePart) -> anyhow::Result<()> {
        let first = self.ranges[0].1.display();
        let is_same = (self.whole.render, self.whole.of) == (part.render, part.of);
        anyhow::ensure!(
            is_same && self.whole.sums.merge(&part.sums),
            "this part is of another studio ({}), of other settings or of another version than {first} ({}): {}",
            part.studio,
            self.whole.studio,
            path.display()
        );
        let Range { start, end } = part.samples;
        let twice = self.ranges.iter().find(|(other, _)| other.start < end && start < other.end);
        if let Some((other, other_path)) = twice {
            let (a, b) = (other_path.display(), path.display());
            return Err(anyhow!(
                "two parts have the same samples: {}..{} and {start}..{end}: {a} and {b}",
                other.start,
                other.end
            ));
        }
        self.ranges.push((part.samples.clone(), path));
        Ok(())
    }

    /// Returns the samples of the whole picture that no part has.
    fn missing(&self) -> Vec<Range<u32>> {
        let mut ranges: Vec<Range<u32>> = self.ranges.iter().map(|(range, _)| range.clone()).collect();
        ranges.sort_unstable_by_key(|range| range.start);
        let ends = std::iter::once(0).chain(ranges.iter().map(|range| range.end));
        let starts = ranges.iter().map(|range| range.start).chain([self.whole.of]);
        ends.zip(starts).map(|(end, start)| end..start).filter(|gap| !gap.is_empty()).collect()
    }
}

fn list(ranges: &[Range<u32>]) -> String {
    ranges.iter().map(|range| format!("{}..{}", range.start, range.end)).collect::<Vec<_>>().join(", ")
}
