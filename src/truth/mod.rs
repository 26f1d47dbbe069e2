//! How true is it: readings of the meter and of rendered pictures beside the closed forms that they should match.
//!
//! `catchlight truth` prints the table that stands in the README; a test holds every row to its tolerance, and the README
//! to the table.

mod cases;
pub mod forms;

use std::fmt::Write;

/// One line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What was set up.
    pub case: String,
    /// What both numbers are in.
    pub unit: &'static str,
    /// What mathematics says.
    pub closed_form: f64,
    /// What Catchlight reads.
    pub ours: f64,
    /// Largest difference, relative, that sampling and tessellation explain.
    pub tolerance: f64,
}

impl Row {
    /// Difference, relative to the closed form.
    pub fn difference(&self) -> f64 {
        self.ours / self.closed_form - 1.0
    }
}

/// All rows, measured now; takes some seconds.
pub fn rows() -> Vec<Row> {
    cases::all()
}

/// The rows as a Markdown table.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = "| case | closed form | Catchlight | difference |\n|---|---|---|---|\n".to_owned();
    for row in rows {
        let [closed, ours] = [row.closed_form, row.ours].map(five_digits);
        let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
        let difference = format!("{:+.2} %", 100.0 * row.difference()).replace("-0.00", "+0.00");
        let _ = writeln!(text, "| {} | {closed}{unit} | {ours}{unit} | {difference} |", row.case);
    }
    text
}

/// Five significant digits.
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
