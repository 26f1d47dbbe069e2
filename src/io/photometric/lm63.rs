//! Reads IES LM-63 files.

use super::PhotometricFile;
use super::goniometer::{Goniometer, Kind};
use super::numbers::{Numbers, lines, scaled};
use super::symmetry::{Plane, Symmetry, full_circle};
use crate::photo::meter::FOOT_M;
use crate::scene::{Emitter, IntensityTable};

/// Largest number of angles of one axis.
const MOST_ANGLES: usize = 10_000;

/// Parses a file.
pub(super) fn parse(bytes: &[u8]) -> Result<PhotometricFile, String> {
    let lines = lines(bytes);
    let starts_tilt = |line: &String| line.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("TILT="));
    let Some(tilt_at) = lines.iter().position(|(_, line)| starts_tilt(line)) else {
        return Err("there is no line TILT=, which every IES file has".to_owned());
    };
    let (head, rest) = lines.split_at(tilt_at);
    let mut numbers = Numbers::new(rest.get(1..).unwrap_or_default());
    let (tilt_line, tilt_text) = &rest[0];
    let tilt = match tilt_text[5..].trim() {
        text if text.eq_ignore_ascii_case("NONE") => Vec::new(),
        text if text.eq_ignore_ascii_case("INCLUDE") => parse_tilt(&mut numbers)?,
        text => {
            let message = "the tilt data lie in another file; put them into this one (TILT=INCLUDE), or TILT=NONE";
            return Err(format!("line {tilt_line}: TILT={text}: {message}"));
        }
    };
    let mut warnings = Vec::new();
    let mut table = parse_photometry(&mut numbers, is_2019(head), &mut warnings)?;
    if numbers.remaining() > 0 {
        warnings.push(format!("{} numbers after the intensities are not used", numbers.remaining()));
    }
    table.tilt = tilt;
    table.luminaire = luminaire_name(head);
    Ok(PhotometricFile { table, warnings })
}

/// Returns true for LM-63-19, in which the number after the ballast factor is no factor.
fn is_2019(head: &[(usize, String)]) -> bool {
    head.first().is_some_and(|(_, line)| line.contains("LM-63-2019") || line.contains("LM-63-19 "))
}

/// Parses the factors by the tilt of the lamp.
fn parse_tilt(numbers: &mut Numbers<'_>) -> Result<Vec<[f32; 2]>, String> {
    numbers.count("the lamp-to-luminaire geometry", 1, 3)?;
    let count = numbers.count("the number of tilt angles", 1, MOST_ANGLES)?;
    let angles = numbers.angles("the tilt angles", count)?;
    let factors = numbers.list("the tilt factors", count)?;
    if let Some(bad) = factors.iter().find(|factor| !(0.0..=100.0).contains(*factor)) {
        return Err(format!("the tilt factor {bad} is not from 0 to 100"));
    }
    Ok(angles.into_iter().zip(factors).map(|(angle, factor)| [angle, factor]).collect())
}

/// Parses everything after the tilt.
fn parse_photometry(
    numbers: &mut Numbers<'_>,
    is_2019: bool,
    warnings: &mut Vec<String>,
) -> Result<IntensityTable, String> {
    numbers.number("the number of lamps")?;
    let lamp_lm = numbers.number("the lumens per lamp")?;
    let multiplier = numbers.number("the candela multiplier")?;
    let vertical_count = numbers.count("the number of vertical angles", 2, MOST_ANGLES)?;
    let horizontal_count = numbers.count("the number of horizontal angles", 1, MOST_ANGLES)?;
    let kind = numbers.count("the photometric type (1 C, 2 B, 3 A)", 1, 3)?;
    let unit_m = if numbers.count("the unit of lengths (1 feet, 2 metres)", 1, 2)? == 1 { FOOT_M } else { 1.0 };
    let size = numbers.list("the size of the luminous opening", 3)?;
    let ballast = numbers.number("the ballast factor")?;
    // The ballast-lamp photometric factor of 1986 and 1991; 1 in 1995 and 2002; the type of the file in 2019
    let ballast_lamp = numbers.number("the number after the ballast factor")?;
    numbers.number("the input watts")?;
    let factor = multiplier * ballast * if is_2019 { 1.0 } else { ballast_lamp };
    if !(factor > 0.0 && factor.is_finite()) {
        return Err(format!("the candela multiplier {multiplier} and the ballast factors give {factor}, no factor"));
    }
    if vertical_count * horizontal_count > IntensityTable::MOST_VALUES {
        return Err(format!("{vertical_count} x {horizontal_count} intensities are too many"));
    }
    let vertical = numbers.angles("the vertical angles", vertical_count)?;
    let horizontal = numbers.angles("the horizontal angles", horizontal_count)?;
    let mut planes = Vec::with_capacity(horizontal_count);
    for degree in &horizontal {
        let candela = scaled(numbers.list("the intensities", vertical_count)?, factor);
        planes.push(candela.map_err(|message| format!("horizontal angle {degree}: {message}"))?);
    }
    let mut table = match kind {
        1 => type_c(vertical, &horizontal, planes)?,
        2 => across(Kind::B, vertical, horizontal, planes)?,
        _ => across(Kind::A, vertical, horizontal, planes)?,
    };
    table.opening = opening([size[0], size[1], size[2]].map(|length| length * unit_m));
    warn_of_flux(&table, lamp_lm, warnings);
    Ok(table)
}

/// Warns where the luminaire gives more than its lamp.
fn warn_of_flux(table: &IntensityTable, lamp_lm: f32, warnings: &mut Vec<String>) {
    let flux = table.flux_lm();
    if lamp_lm > 0.0 && flux > 20.0 * lamp_lm {
        warnings.push(format!("its intensities give {flux:.0} lm, but its lamp has {lamp_lm:.0} lm"));
    }
}

/// Returns the table of a type C distribution.
fn type_c(vertical: Vec<f32>, horizontal: &[f32], planes: Vec<Vec<f32>>) -> Result<IntensityTable, String> {
    let is = |angle: f32, degree: f32| (angle - degree).abs() < 1e-2;
    let (first, last) = match horizontal {
        [] => return Err("there are no horizontal angles".to_owned()),
        [_] => (0.0, 0.0),
        [first, .., last] => (*first, *last),
    };
    let step = horizontal.windows(2).last().map_or(0.0, |pair| pair[1] - pair[0]);
    let symmetry = match (first, last) {
        (first, last) if is(first, 0.0) && is(last, 0.0) => Symmetry::Axis,
        (first, last) if is(first, 0.0) && is(last, 90.0) => Symmetry::Quadrants,
        (first, last) if is(first, 0.0) && is(last, 180.0) => Symmetry::Plane0,
        (first, last) if is(first, 90.0) && is(last, 270.0) => Symmetry::Plane90,
        (first, last) if is(first, 0.0) && is(last, 360.0) => Symmetry::None,
        // Some programs leave the plane at 360 degrees out, which is that at 0
        (first, last) if is(first, 0.0) && last > 180.0 && last < 360.0 && last + 1.01 * step >= 360.0 => {
            Symmetry::None
        }
        _ => {
            return Err(format!(
                "the horizontal angles go from {first} to {last}; type C has 0 to 0, 90, 180 or 360, or 90 to 270"
            ));
        }
    };
    let planes: Vec<Plane> = horizontal.iter().copied().zip(planes).collect();
    let (horizontal, candela) = full_circle(&planes, symmetry)?;
    IntensityTable::new(vertical, horizontal, candela)
}

/// Returns the table of a type A or B distribution.
fn across(
    kind: Kind,
    vertical_deg: Vec<f32>,
    horizontal_deg: Vec<f32>,
    planes: Vec<Vec<f32>>,
) -> Result<IntensityTable, String> {
    let (vertical_most, horizontal_most) = match kind {
        Kind::A => (90.0, 180.0),
        Kind::B => (180.0, 90.0),
    };
    for (what, angles, most) in
        [("vertical", &vertical_deg, vertical_most), ("horizontal", &horizontal_deg, horizontal_most)]
    {
        if angles.len() < 2 {
            return Err(format!("type {kind:?} needs at least two {what} angles"));
        }
        if let Some(bad) = angles.iter().find(|angle| angle.abs() > most) {
            return Err(format!("the {what} angle {bad} is not from -{most} to {most}, as type {kind:?} has"));
        }
    }
    Goniometer { kind, vertical_deg, horizontal_deg, planes }.table()
}

/// Returns the luminous opening of width (along 0 degrees), length (along 90) and height, metres; negative lengths are
/// round (LM-63-2002, table 1).
fn opening([width, length, height]: [f32; 3]) -> Emitter {
    let size = |metres: f32| metres.abs().clamp(1e-3, 100.0);
    let diameter_m = size(width.abs().max(length.abs()));
    match (width, length) {
        (width, length) if width > 0.0 && length > 0.0 => {
            Emitter::RectPanel { width_m: size(width), height_m: size(length) }
        }
        (width, length) if width < 0.0 && length < 0.0 && height < 0.0 => {
            Emitter::Sphere { radius_m: 0.5 * diameter_m }
        }
        (width, length) if width < 0.0 || length < 0.0 => Emitter::RoundPanel { diameter_m },
        _ => Emitter::Point,
    }
}

/// Returns the name of the luminaire: the keyword LUMINAIRE, or LUMCAT, with that of the manufacturer.
fn luminaire_name(head: &[(usize, String)]) -> String {
    const MOST: usize = 100;
    let keyword = |name: &str| {
        let text = head.iter().find_map(|(_, line)| line.strip_prefix('[')?.strip_prefix(name)?.strip_prefix(']'));
        text.map(str::trim).filter(|text| !text.is_empty())
    };
    let words = [keyword("MANUFAC"), keyword("LUMINAIRE").or_else(|| keyword("LUMCAT"))];
    let name: Vec<&str> = words.into_iter().flatten().collect();
    name.join(" ").chars().filter(|c| !c.is_control()).take(MOST).collect()
}
