//! Makes the names of a scene's objects and lights unique, which files need to refer to them.

use crate::scene::{Finding, LightId, Scene, VARIANT_LIMIT, name_stem};
use std::collections::{HashMap, HashSet};

/// Gives the later of two equal names a number, with a warning each. Aims refer to objects by id, so they are
/// unaffected.
pub(super) fn make_names_unique(scene: &mut Scene) -> Vec<Finding> {
    let mut warnings = Vec::new();
    let lights = scene.lights.iter().chain(scene.variants.stored_lights()).map(|light| &light.name);
    let taken = scene.objects.iter().map(|object| &object.name).chain(lights).cloned().collect();
    let mut names = NameAllocator { taken, seen: HashSet::new(), numbers: HashMap::new() };
    let objects = scene.objects.iter_mut().map(|o| &mut o.name).enumerate().map(|(i, name)| ("objects", i, name));
    let lights = scene.lights.iter_mut().map(|l| &mut l.name).enumerate().map(|(i, name)| ("lights", i, name));
    for (list, i, name) in objects.chain(lights) {
        if names.seen.insert(name.clone()) {
            continue;
        }
        let new = names.fresh(name);
        warnings.push(Finding::warning(format!("{list}[{i}] {name:?} name"), renamed(&new)));
        *name = new;
    }
    warnings.extend(make_names_of_variants_unique(scene, &mut names));
    warnings
}

/// Gives the later of two equal variants a number, and lights of variants that have the name of something in the studio.
/// A light that several variants add is one light.
fn make_names_of_variants_unique(scene: &mut Scene, names: &mut NameAllocator) -> Vec<Finding> {
    let mut warnings = Vec::new();
    let of_studio = names.seen.clone();
    let mut next_id = scene.fresh_light_id().0;
    let mut variant_names = HashSet::from([scene.variants.studio_name.clone()]);
    for (index, variant) in scene.variants.others.iter_mut().take(VARIANT_LIMIT).enumerate() {
        let place = format!("variants.others[{index}] {:?} ", variant.name);
        let stem = variant.name.clone();
        let mut numbers = (2..).map(|number| format!("{stem} {number}"));
        while !variant_names.insert(variant.name.clone()) {
            variant.name = numbers.next().unwrap_or_default();
        }
        if variant.name != stem {
            let message = format!("another variant bears this name, too; this one is now {:?}", variant.name);
            warnings.push(Finding::warning(format!("{place}name"), message));
        }
        let mut of_variant = HashSet::new();
        for (i, light) in variant.difference.added_lights.iter_mut().enumerate() {
            if !of_studio.contains(&light.name) && of_variant.insert(light.name.clone()) {
                continue;
            }
            let new = names.fresh(&light.name);
            warnings.push(Finding::warning(format!("{place}added_lights[{i}].name"), renamed(&new)));
            (light.name, light.id) = (new, LightId(next_id));
            next_id += 1;
        }
    }
    warnings
}

fn renamed(new: &str) -> String {
    format!("another thing bears this name, too; this one is now {new:?}")
}

/// Allocates unused names. Constant time a name, unlike `Scene::unique_name`: a file may hold ten thousand equal names.
struct NameAllocator {
    taken: HashSet<String>,
    seen: HashSet<String>,
    /// The last number given to each stem.
    numbers: HashMap<String, u32>,
}

impl NameAllocator {
    fn fresh(&mut self, name: &str) -> String {
        let stem = name_stem(name, |stem| self.taken.contains(stem));
        let number = self.numbers.entry(stem.to_owned()).or_insert(1);
        loop {
            *number += 1;
            let candidate = format!("{stem} {number}");
            if self.taken.insert(candidate.clone()) {
                self.seen.insert(candidate.clone());
                return candidate;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_tried_once() {
        // Half of the numbers are taken by other names of the file.
        let taken = std::iter::once("Key".to_owned()).chain((1..5_000).map(|i| format!("Key {}", 2 * i)));
        let mut names = NameAllocator { taken: taken.collect(), seen: HashSet::new(), numbers: HashMap::new() };
        let fresh: HashSet<String> = (0..10_000).map(|_| names.fresh("Key")).collect();
        assert!(fresh.len() == 10_000 && fresh.contains("Key 3") && !fresh.contains("Key 4"));
        // The search goes on after the last number given, whatever their order.
        assert_eq!(names.numbers["Key"], 10_000 + 4_999 + 1);
    }
}
