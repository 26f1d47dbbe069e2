//! The list of gear in the window: the bundled one with the user's own.

use crate::editor::document::catalog;
use crate::gear::{GearList, HeadModel, ModifierModel, SupportKind, gear_use};
use crate::io;
use crate::scene::{Emitter, Light, Modifier, NamedModifier, Scene};
use std::path::{Path, PathBuf};

/// An entry of the list of gear, by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GearEntry {
    /// A head.
    Head(String),
    /// A modifier.
    Modifier(String),
    /// A stand or boom.
    Support(String),
}

/// The list of gear.
#[derive(Debug)]
pub struct GearShelf {
    /// The user's file; none keeps the list in memory.
    path: Option<PathBuf>,
    own: GearList,
    all: GearList,
    /// The reason why the user's file could not be read.
    failure: Option<String>,
}

impl GearShelf {
    /// Reads the user's list from the settings folder.
    pub fn load(settings_folder: Option<&Path>) -> Self {
        let path = settings_folder.map(io::own_gear_path);
        let all = io::bundled_gear().clone();
        let mut shelf = GearShelf { path, own: GearList::default(), all, failure: None };
        shelf.read();
        shelf
    }

    /// Reads the user's file again. One that can't be read leaves the list as it is.
    pub fn read(&mut self) {
        match self.path.as_deref().map(io::read_gear) {
            None => {}
            Some(Err(error)) => self.failure = Some(error.to_string()),
            Some(Ok(own)) => {
                self.failure = None;
                self.set(own);
            }
        }
    }

    fn set(&mut self, own: GearList) {
        self.all = io::bundled_gear().with(&own);
        self.own = own;
    }

    /// Returns the whole list.
    pub fn list(&self) -> &GearList {
        &self.all
    }

    /// Returns the user's file.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Returns the reason why the user's file could not be read.
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// Notes how many pieces of an entry the user owns, and saves the user's file.
    ///
    /// # Errors
    /// If the file on disk can't be read or written; the list is then as it was.
    pub fn set_owned(&mut self, entry: &GearEntry, count: u32) -> Result<(), String> {
        // Another window may have written it
        self.read();
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let mut own = self.own.clone();
        match entry {
            GearEntry::Head(name) => change(
                &mut own.heads,
                &self.all.heads,
                |model| &model.head.name == name,
                |model| {
                    model.owned = count;
                },
            ),
            GearEntry::Modifier(name) => {
                change(
                    &mut own.modifiers,
                    &self.all.modifiers,
                    |model| &model.name == name,
                    |model| {
                        model.owned = count;
                    },
                );
            }
            GearEntry::Support(name) => {
                change(
                    &mut own.supports,
                    &self.all.supports,
                    |support| &support.name == name,
                    |support| {
                        support.owned = count;
                    },
                );
            }
        }
        // What is as bundled need not be in the user's file
        let bundled = io::bundled_gear();
        own.heads.retain(|model| !bundled.heads.contains(model));
        own.modifiers.retain(|model| !bundled.modifiers.contains(model));
        own.supports.retain(|support| !bundled.supports.contains(support));
        if let Some(path) = &self.path {
            io::save_gear(&own, path).map_err(|error| error.to_string())?;
        }
        self.set(own);
        Ok(())
    }

    /// Returns the number of pieces of an entry that a studio leaves unused; negative if it uses more than there are.
    pub fn left(&self, scene: &Scene, name: &str, owned: u32) -> i64 {
        let used = gear_use(scene, &self.all).into_iter().find(|each| each.name == name).map_or(0, |each| each.used);
        i64::from(owned) - i64::from(used)
    }

    /// Returns a light of the catalog on a head, bare or with the head's own front.
    pub fn light_on(model: &HeadModel) -> Light {
        let front = model.front.unwrap_or(Emitter::Sphere { radius_m: 0.04 });
        let mut light = catalog::new_light(&model.head.name, front, Modifier::default(), model.output);
        model.mount(&mut light);
        light
    }

    /// Returns a light of the catalog with a modifier, on the first of the user's heads that the studio leaves free and
    /// that takes modifiers, else on a head that is not named.
    pub fn light_with(&self, scene: &Scene, modifier: &ModifierModel) -> Light {
        let mut light = catalog::new_light(&modifier.name, modifier.emitter, modifier.modifier, catalog::HEAD);
        let takes_modifiers = self.all.heads.iter().filter(|model| model.owned > 0 && model.front.is_none());
        let mut free = takes_modifiers.filter(|model| self.left(scene, &model.head.name, model.owned) > 0);
        if let Some(model) = free.next() {
            model.mount(&mut light);
        }
        light
    }
}

/// Changes the user's entry; one that is bundled alone becomes the user's.
fn change<T: Clone>(own: &mut Vec<T>, all: &[T], is_it: impl Fn(&T) -> bool, set: impl FnOnce(&mut T)) {
    if !own.iter().any(&is_it) {
        own.extend(all.iter().find(|each| is_it(each)).cloned());
    }
    if let Some(entry) = own.iter_mut().find(|each| is_it(each)) {
        set(entry);
    }
}

/// Returns what a support does, for lists.
pub fn support_text(kind: SupportKind, reach_m: f32, load_kg: f32) -> String {
    let kind = match kind {
        SupportKind::Stand => "stand",
        SupportKind::Boom => "boom",
    };
    format!("{kind}, up to {reach_m:.1} m, {load_kg:.1} kg")
}

/// Returns true for the modifier of a bare head, which is no piece of gear.
pub fn is_bare(model: &ModifierModel) -> bool {
    model.name == NamedModifier::BARE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_user_owns_is_kept_and_a_wrong_file_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let mut shelf = GearShelf::load(Some(folder.path()));
        let head = GearEntry::Head("Monolight 400 Ws".to_owned());
        shelf.set_owned(&head, 2).unwrap();
        shelf.set_owned(&GearEntry::Modifier("Octa 120".to_owned()), 1).unwrap();
        shelf.set_owned(&GearEntry::Support("Light stand 2.6 m".to_owned()), 3).unwrap();
        let again = GearShelf::load(Some(folder.path()));
        assert_eq!(again.list(), shelf.list());
        assert_eq!(again.list().head("Monolight 400 Ws").unwrap().owned, 2);
        let file = io::own_gear_path(folder.path());
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("Octa 120") && !text.contains("Octa 90"), "only what is not as bundled: {text}");
        shelf.set_owned(&head, 0).unwrap();
        assert!(!std::fs::read_to_string(&file).unwrap().contains("Monolight"));

        std::fs::write(&file, "(format: 1, heads: [(name").unwrap();
        assert!(shelf.set_owned(&head, 5).is_err() && shelf.failure().is_some());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "(format: 1, heads: [(name", "the user's text is not lost");
        assert_eq!(shelf.list().head("Monolight 400 Ws").unwrap().owned, 0);
    }

    #[test]
    fn a_modifier_of_the_shelf_takes_the_first_free_head() {
        let mut shelf = GearShelf::load(None);
        shelf.set_owned(&GearEntry::Head("Monolight 400 Ws".to_owned()), 1).unwrap();
        shelf.set_owned(&GearEntry::Head("ARRI SkyPanel S60 Pro".to_owned()), 1).unwrap();
        let octa = shelf.list().modifiers.iter().find(|model| model.name == "Octa 120").unwrap();
        let mut scene = Scene::default();
        let light = shelf.light_with(&scene, octa);
        assert_eq!(light.head.as_ref().map(|head| head.name.as_str()), Some("Monolight 400 Ws"));
        assert_eq!((light.emitter, light.modifier), (octa.emitter, octa.modifier));
        scene.lights.push(light);
        assert_eq!(shelf.left(&scene, "Monolight 400 Ws", 1), 0);
        assert!(shelf.light_with(&scene, octa).head.is_none(), "a panel of LEDs takes no octabox");
        let panel = GearShelf::light_on(shelf.list().head("ARRI SkyPanel S60 Pro").unwrap());
        assert_eq!(panel.emitter, Emitter::RectPanel { width_m: 0.645, height_m: 0.3 });
    }
}
