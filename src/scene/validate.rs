//! What is wrong or odd with a scene, in words a photographer understands.

use super::Scene;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The scene can be rendered but probably is not what was meant.
    Warning,
    /// The scene cannot be used.
    Error,
}

/// One thing that is wrong or odd.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// Where, as in the file: `lights[2] "Key" power`.
    pub place: String,
    /// What, with the value.
    pub message: String,
}

/// Every error and warning of a scene, in file order. No errors means that every renderer can take it.
pub fn validate(_scene: &Scene) -> Vec<Finding> {
    Vec::new()
}
