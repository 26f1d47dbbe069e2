//! Checks the variants of a studio: their names, and each set-up as if it were shown.

use super::check::Check;
use super::{NAME_LIMIT, validate};
use crate::scene::{Finding, Scene, Severity, VARIANT_LIMIT};
use std::collections::HashSet;

pub(super) fn check_variants(scene: &Scene, check: &mut Check) {
    let variants = &scene.variants;
    if variants.others.len() > VARIANT_LIMIT {
        let message = format!("{} are too many; at most {VARIANT_LIMIT} fit in a studio", variants.others.len());
        return check.error("variants.others", message);
    }
    let mut names = HashSet::new();
    let mut known: HashSet<(String, String)> = check.findings().iter().map(identity).collect();
    for (index, (id, name)) in variants.list().enumerate() {
        let studio = "variants.studio ".to_owned();
        let place = index.checked_sub(1).map_or(studio, |index| format!("variants.others[{index}] {name:?} "));
        check.enter(place);
        check.text("name", name, NAME_LIMIT);
        if name.trim().is_empty() {
            check.error("name", "a name is needed".to_owned());
        }
        if !names.insert(name) {
            check.error("name", "another variant has this name, too".to_owned());
        }
        if id == variants.shown() {
            continue;
        }
        // Findings that the shown variant has, too, are not repeated
        let Some(other) = scene.variant_alone(id) else { continue };
        for finding in validate(&other) {
            if !known.insert(identity(&finding)) {
                continue;
            }
            // The camera's fields have the same path in a variant; those of lights have not
            let (field, message) = match finding.place.as_str() {
                "" => ("", finding.message),
                field if field.starts_with("camera.") => (field, finding.message),
                place => ("", format!("{place}: {}", finding.message)),
            };
            match finding.severity {
                Severity::Error => check.error(field, message),
                Severity::Warning => check.warning(field, message),
            }
        }
    }
    check.enter(String::new());
}

/// Returns place, without list indices, and message of a finding.
fn identity(finding: &Finding) -> (String, String) {
    let place = finding.place.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect();
    (place, finding.message.clone())
}
