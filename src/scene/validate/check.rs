//! Checks of single values.

use super::finding::{Finding, Severity};
use crate::scene::path_complaint;
use glam::Vec3;

/// The range of a field's values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Allowed {
    low: f32,
    high: f32,
    unit: &'static str,
}

impl Allowed {
    /// Returns the range from `low` to `high`, inclusive. The unit is for the message.
    pub const fn between(low: f32, high: f32, unit: &'static str) -> Self {
        Allowed { low, high, unit }
    }

    /// Returns the error message of a value outside of the range; NaN is outside.
    fn complaint(self, value: f32) -> Option<String> {
        let Allowed { low, high, unit } = self;
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        if !value.is_finite() {
            Some(format!("{value} is no usable number; it must be from {low} to {high}{unit}"))
        } else if value >= low && value <= high {
            None
        } else {
            Some(format!("{value}{unit} is not allowed; it must be from {low} to {high}{unit}"))
        }
    }
}

/// Positions and aims, metres from the origin.
pub(super) const POSITION: Allowed = Allowed::between(-1e6, 1e6, "m");
/// Sizes, metres.
pub(super) const SIZE: Allowed = Allowed::between(1e-5, 1e5, "m");
/// Rotations, degrees.
pub(super) const TURN: Allowed = Allowed::between(-1e5, 1e5, "degrees");

/// Collects findings, with the place of each.
#[derive(Debug, Default)]
pub(super) struct Check {
    findings: Vec<Finding>,
    /// Prefix of the field: `camera.` or `lights[2] "Key" `.
    place: String,
}

impl Check {
    /// Sets the prefix of the fields that follow.
    pub fn enter(&mut self, place: String) {
        self.place = place;
    }

    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    pub fn has_findings(&self) -> bool {
        !self.findings.is_empty()
    }

    pub fn finish(self) -> Vec<Finding> {
        self.findings
    }

    pub fn error(&mut self, field: &str, message: String) {
        self.push(Severity::Error, field, message);
    }

    pub fn warning(&mut self, field: &str, message: String) {
        self.push(Severity::Warning, field, message);
    }

    fn push(&mut self, severity: Severity, field: &str, message: String) {
        self.findings.push(Finding {
            severity,
            place: format!("{}{field}", self.place).trim_end().to_owned(),
            message,
        });
    }

    pub fn number(&mut self, field: &str, value: f32, allowed: Allowed) {
        if let Some(complaint) = allowed.complaint(value) {
            self.error(field, complaint);
        }
    }

    /// Checks every component; the message names the first that is out of range.
    pub fn vector(&mut self, field: &str, value: Vec3, allowed: Allowed) {
        self.triple(field, ["x", "y", "z"], value.to_array(), allowed);
    }

    /// Checks every channel of a colour.
    pub fn color(&mut self, field: &str, value: [f32; 3], allowed: Allowed) {
        self.triple(field, ["red", "green", "blue"], value, allowed);
    }

    fn triple(&mut self, field: &str, names: [&str; 3], values: [f32; 3], allowed: Allowed) {
        let complaint = names.iter().zip(values).find_map(|(name, v)| allowed.complaint(v).map(|c| (name, c)));
        if let Some((name, complaint)) = complaint {
            self.error(field, format!("{name} {complaint}"));
        }
    }

    pub fn text(&mut self, field: &str, value: &str, limit: usize) {
        let length = value.chars().count();
        if length > limit {
            self.error(field, format!("{length} characters are too many; at most {limit} are allowed"));
        }
    }

    /// Checks a path to an asset: relative, `/` between folders, inside the scene's folder.
    pub fn asset_path(&mut self, field: &str, path: &str) {
        if let Some(reason) = path_complaint(path) {
            self.error(field, format!("{path:?}: {reason}"));
        }
    }
}
