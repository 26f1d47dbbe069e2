//! Reads EULUMDAT files: one value a line, in a fixed order. Intensities are in cd per 1000 lm of the lamps.

use super::PhotometricFile;
use super::numbers::{integer, lines, number, scaled};
use super::symmetry::{Plane, Symmetry, full_circle};
use crate::scene::{Emitter, IntensityTable};

/// Largest number of C-planes, and of intensities a plane.
const MOST_ANGLES: usize = 3600;
/// Largest number of sets of lamps.
const MOST_SETS: usize = 20;
/// Direct ratios, which are not used.
const RATIOS: usize = 10;

/// The lines of a file, one value each.
struct Fields<'a> {
    lines: std::slice::Iter<'a, (usize, String)>,
}

impl<'a> Fields<'a> {
    fn text(&mut self, what: &str) -> Result<(usize, &'a str), String> {
        let line = self.lines.next().ok_or_else(|| format!("the file ends before {what}"))?;
        Ok((line.0, line.1.as_str()))
    }

    /// Returns the next line as a number; the decimal sign may be a comma.
    fn number(&mut self, what: &str) -> Result<f32, String> {
        let (line, text) = self.text(what)?;
        number(&text.replace(',', ".")).ok_or_else(|| format!("line {line}: {what} is {text:?}, not a number"))
    }

    fn count(&mut self, what: &str, least: usize, most: usize) -> Result<usize, String> {
        let (line, text) = self.text(what)?;
        let count = integer(text).filter(|count| (least..=most).contains(count));
        count.ok_or_else(|| format!("line {line}: {what} is {text:?}; it must be from {least} to {most}"))
    }

    fn list(&mut self, what: &str, count: usize) -> Result<Vec<f32>, String> {
        (0..count).map(|_| self.number(what)).collect()
    }

    fn skip(&mut self, what: &str, count: usize) -> Result<(), String> {
        (0..count).try_for_each(|_| self.text(what).map(drop))
    }
}

/// Parses a file.
pub(super) fn parse(bytes: &[u8]) -> Result<PhotometricFile, String> {
    let lines = lines(bytes);
    let mut fields = Fields { lines: lines.iter() };
    let company = fields.text("the company")?.1;
    fields.count("the type of luminaire (line 2)", 0, 3)?;
    let symmetry = symmetry(fields.count("the symmetry (line 3)", 0, 4)?);
    let plane_count = fields.count("the number of C-planes (line 4)", 1, MOST_ANGLES)?;
    fields.number("the distance of the C-planes (line 5)")?;
    let row_count = fields.count("the number of intensities a plane (line 6)", 2, MOST_ANGLES)?;
    fields.number("the distance of the intensities (line 7)")?;
    fields.skip("the report's number (line 8)", 1)?;
    let luminaire = fields.text("the name of the luminaire (line 9)")?.1;
    fields.skip("the names and the date (lines 10 to 12)", 3)?;
    fields.list("the size of the luminaire (lines 13 to 15)", 3)?;
    let opening_mm = fields.list("the size of the luminous area (lines 16 and 17)", 2)?;
    fields.list("the heights of the luminous area (lines 18 to 21)", 4)?;
    fields.number("the downward flux fraction (line 22)")?;
    let light_output_ratio = fields.number("the light output ratio (line 23)")? / 100.0;
    let conversion = fields.number("the conversion factor of intensities (line 24)")?;
    let tilt_deg = fields.number("the tilt during measurement (line 25)")?;
    let mut warnings = Vec::new();
    let lamps = parse_lamps(&mut fields, &mut warnings)?;
    fields.skip("the direct ratios", RATIOS)?;
    let c_deg = fields.list("the C-planes", plane_count)?;
    let gamma_deg = fields.list("the angles gamma", row_count)?;
    let factor = conversion * lamps.flux_lm / 1000.0;
    if !(factor > 0.0 && factor.is_finite()) {
        let flux = lamps.flux_lm;
        return Err(format!(
            "the conversion factor {conversion} and the lamps' {flux} lm give no factor of intensities"
        ));
    }
    let planes = parse_planes(&mut fields, symmetry, &c_deg, row_count, factor)?;
    let (horizontal, candela) = full_circle(&planes, symmetry)?;
    let mut table = IntensityTable::new(gamma_deg, horizontal, candela)?;
    // A number of lamps below 0 marks absolute photometry, whose flux is that of the luminaire
    let stated_lm = lamps.flux_lm * if lamps.is_absolute { 1.0 } else { light_output_ratio };
    let off = table.flux_lm() / stated_lm - 1.0;
    if stated_lm > 0.0 && off.abs() > 0.1 {
        let flux = table.flux_lm();
        warnings
            .push(format!("its intensities give {flux:.0} lm, but its lamps and light output ratio {stated_lm:.0} lm"));
    }
    if tilt_deg != 0.0 {
        warnings.push(format!("it was measured at a tilt of {tilt_deg} degrees, which is not undone"));
    }
    table.opening = opening(opening_mm[0], opening_mm[1]);
    table.luminaire = [company, luminaire].join(" ").trim().chars().filter(|c| !c.is_control()).take(100).collect();
    Ok(PhotometricFile { table, warnings })
}

/// Returns the symmetry of its number.
fn symmetry(number: usize) -> Symmetry {
    match number {
        1 => Symmetry::Axis,
        2 => Symmetry::Plane0,
        3 => Symmetry::Plane90,
        4 => Symmetry::Quadrants,
        _ => Symmetry::None,
    }
}

/// The lamps of a luminaire.
struct Lamps {
    /// Flux of all lamps together, lm.
    flux_lm: f32,
    is_absolute: bool,
}

/// Parses the sets of lamps, which are alternatives, and returns the first.
fn parse_lamps(fields: &mut Fields<'_>, warnings: &mut Vec<String>) -> Result<Lamps, String> {
    let sets = fields.count("the number of sets of lamps (line 26)", 1, MOST_SETS)?;
    if sets > 1 {
        warnings.push(format!("it states {sets} sets of lamps; the first is used"));
    }
    let mut first = None;
    for _ in 0..sets {
        let count = fields.number("the number of lamps")?;
        fields.skip("the type of lamps", 1)?;
        let flux_lm = fields.number("the flux of the lamps")?;
        fields.skip("the colour, rendering group and power of the lamps", 3)?;
        first.get_or_insert(Lamps { flux_lm, is_absolute: count < 0.0 });
    }
    first.ok_or_else(|| "it has no lamps".to_owned())
}

/// Parses the intensities of the planes that the file holds.
fn parse_planes(
    fields: &mut Fields<'_>,
    symmetry: Symmetry,
    c_deg: &[f32],
    rows: usize,
    factor: f32,
) -> Result<Vec<Plane>, String> {
    let count = c_deg.len();
    // Mc1 and Mc2 of the format, from 0: the planes of a symmetric file are part of those that it lists
    let (first, planes) = match symmetry {
        Symmetry::None => (0, count),
        Symmetry::Axis => (0, 1),
        Symmetry::Plane0 => (0, count / 2 + 1),
        Symmetry::Plane90 => (3 * count / 4, count / 2 + 1),
        Symmetry::Quadrants => (0, count / 4 + 1),
    };
    let mut parsed = Vec::new();
    for plane in first..first + planes {
        let degree = c_deg[plane % count];
        let candela = scaled(fields.list("the intensities", rows)?, factor);
        parsed.push((degree, candela.map_err(|message| format!("C-plane {degree}: {message}"))?));
    }
    Ok(parsed)
}

/// Returns the luminous area of a length (along C90) and a width (along C0), millimetres; a width of 0 is round.
fn opening(length_mm: f32, width_mm: f32) -> Emitter {
    let metres = |millimetres: f32| (millimetres * 1e-3).clamp(1e-3, 100.0);
    match (length_mm > 0.0, width_mm > 0.0) {
        (true, true) => Emitter::RectPanel { width_m: metres(width_mm), height_m: metres(length_mm) },
        (true, false) => Emitter::RoundPanel { diameter_m: metres(length_mm) },
        _ => Emitter::Point,
    }
}
