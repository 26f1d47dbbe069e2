//! Compares readings of the light meter and of rendered pictures with closed forms.
//!
//! `catchlight truth` prints the table in the README. A test holds every row to its tolerance, and the README to the
//! table.

mod cases;
pub mod closed_forms;

use std::fmt::Write;

/// A row of the table: one set-up.
#[derive(Clone, Debug, PartialEq)]
pub struct TruthRow {
    /// The set-up in words.
    pub case: String,
    /// Unit of both values; empty for ratios.
    pub unit: &'static str,
    /// The exact value.
    pub closed_form: f64,
    /// The measured value.
    pub measured: f64,
    /// Largest relative difference that sampling and tessellation explain.
    pub tolerance: f64,
}

impl TruthRow {
    /// Returns the difference relative to the closed form.
    pub fn difference(&self) -> f64 {
        self.measured / self.closed_form - 1.0
    }
}

/// Measures all rows. Takes some seconds.
pub fn rows() -> Vec<TruthRow> {
    cases::all()
}

/// Returns the rows as a Markdown table.
pub fn markdown(rows: &[TruthRow]) -> String {
    let mut text = "| case | closed form | Catchlight | difference |\n|---|---|---|---|\n".to_owned();
    for row in rows {
        let [closed, measured] = [row.closed_form, row.measured].map(five_digits);
        let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
        let difference = format!("{:+.2} %", 100.0 * row.difference()).replace("-0.00", "+0.00");
        let _ = writeln!(text, "| {} | {closed}{unit} | {measured}{unit} | {difference} |", row.case);
    }
    text
}

/// Formats a value with five significant digits.
fn five_digits(value: f64) -> String {
    let before = value.abs().max(1e-9).log10().floor() as i32;
    let after = usize::try_from(4 - before).unwrap_or(0).min(6);
    format!("{value:.after$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_five_digits() {
        assert_eq!(
            [18603.4, 729.523, 0.18, 1.0, -2.643].map(five_digits),
            ["18603", "729.52", "0.18000", "1.0000", "-2.6430"]
        );
    }
}
