//! Writes a table as an IES LM-63-2002 file with absolute photometry.

use crate::scene::{Emitter, IntensityTable};
use std::fmt::Write;

/// Values of a line: LM-63 allows 132 characters.
const PER_LINE: usize = 10;

/// Returns the text of the file.
pub(super) fn lm63(table: &IntensityTable) -> String {
    let mut text = String::from("IESNA:LM-63-2002\r\n[TEST] written by Catchlight\r\n");
    let name: String = table.luminaire.chars().filter(|c| c.is_ascii() && !c.is_control()).collect();
    let _ = write!(text, "[LUMINAIRE] {name}\r\n");
    if table.tilt.is_empty() {
        text.push_str("TILT=NONE\r\n");
    } else {
        let _ = write!(text, "TILT=INCLUDE\r\n1\r\n{}\r\n", table.tilt.len());
        push_lines(&mut text, table.tilt.iter().map(|pair| pair[0]));
        push_lines(&mut text, table.tilt.iter().map(|pair| pair[1]));
    }
    let (vertical, horizontal) = (table.vertical_deg(), table.horizontal_deg());
    let (width, length, height) = match table.opening {
        Emitter::RectPanel { width_m, height_m } => (width_m, height_m, 0.0),
        Emitter::RoundPanel { diameter_m } => (-diameter_m, -diameter_m, 0.0),
        Emitter::Sphere { radius_m } => (-2.0 * radius_m, -2.0 * radius_m, -2.0 * radius_m),
        Emitter::Point | Emitter::Spot { .. } | Emitter::Sun { .. } | Emitter::Surround => (0.0, 0.0, 0.0),
    };
    let counts = format!("{} {}", vertical.len(), horizontal.len());
    let _ = write!(text, "1 -1 1 {counts} 1 2 {width} {length} {height}\r\n1 1 0\r\n");
    push_lines(&mut text, vertical.iter().copied());
    push_lines(&mut text, horizontal.iter().copied());
    (0..horizontal.len()).for_each(|plane| push_lines(&mut text, table.plane(plane).iter().copied()));
    text
}

/// Adds lines of numbers.
fn push_lines(text: &mut String, numbers: impl Iterator<Item = f32>) {
    let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    for line in numbers.chunks(PER_LINE) {
        text.push_str(&line.join(" "));
        text.push_str("\r\n");
    }
}
