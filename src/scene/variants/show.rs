//! Shows, adds, removes and exchanges the variants of a scene.

use super::setup::StudioSetup;
use super::{SetupDifference, ShownVariant, VARIANT_LIMIT, Variant, VariantId, Variants};
use crate::scene::{Light, LightId, ObjectId, Scene};
use std::collections::HashMap;

impl Scene {
    /// Shows a variant: camera, lights and visibility become its own. A solo of the studio itself waits for it, that of
    /// another variant ends. Returns false if there is no such variant.
    ///
    /// The eyes of figures do not follow; see [`crate::figures::show_variant`].
    pub fn show_variant(&mut self, id: VariantId) -> bool {
        if id == self.variants.shown() {
            return true;
        }
        if self.variants.name(id).is_none() {
            return false;
        }
        let studio = self.hide_variant();
        match self.variants.others.iter_mut().find(|variant| variant.id == id) {
            Some(variant) => {
                // Cleared, so that scenes with the same variant shown compare equal
                let difference = std::mem::take(&mut variant.difference);
                difference.applied(&studio.without_solo()).put_into(self);
                self.variants.shown = Some(ShownVariant { id, studio: Box::new(studio) });
            }
            None => studio.put_into(self),
        }
        true
    }

    /// Stores what is shown as its variant. Returns the set-up of the studio itself, which the caller has to show or to
    /// store.
    fn hide_variant(&mut self) -> StudioSetup {
        self.update_stored_lights();
        let setup = StudioSetup::of(self);
        let Some(ShownVariant { id, studio }) = self.variants.shown.take() else { return setup };
        if let Some(variant) = self.variants.others.iter_mut().find(|variant| variant.id == id) {
            variant.difference = SetupDifference::between(&studio.without_solo(), &setup.without_solo());
        }
        *studio
    }

    /// Copies what is common to all variants to the stored lights: names and locks.
    fn update_stored_lights(&mut self) {
        let shown: HashMap<LightId, &Light> = self.lights.iter().map(|light| (light.id, light)).collect();
        for light in self.variants.stored_lights_mut() {
            if let Some(shown) = shown.get(&light.id) {
                light.name.clone_from(&shown.name);
                light.locked = shown.locked;
            }
        }
    }

    /// Drops from the differences of variants what does not differ from the studio, and lights that it does not have.
    pub fn drop_equal_parts_of_variants(&mut self) {
        if self.variants.is_empty() {
            return;
        }
        let (shown, studio) = (self.variants.shown(), self.studio_setup());
        for variant in self.variants.others.iter_mut().filter(|variant| variant.id != shown) {
            variant.difference = SetupDifference::between(&studio, &variant.difference.applied(&studio));
        }
    }

    /// Returns the set-up of the studio itself, without a solo.
    fn studio_setup(&self) -> StudioSetup {
        match &self.variants.shown {
            Some(shown) => shown.studio.without_solo(),
            None => StudioSetup::of(self).without_solo(),
        }
    }

    /// Returns the scene with a variant shown, in which the eyes of figures have not followed. None if there is no such
    /// variant.
    pub fn as_variant(&self, id: VariantId) -> Option<Scene> {
        let mut scene = self.clone();
        scene.show_variant(id).then_some(scene)
    }

    /// Returns the scene as it is shown, without its variants.
    pub fn without_variants(&self) -> Scene {
        let Scene { name, description, camera, room, objects, lights, bodies, meter, solo, variants: _ } = self;
        Scene {
            name: name.clone(),
            description: description.clone(),
            camera: camera.clone(),
            room: room.clone(),
            objects: objects.clone(),
            lights: lights.clone(),
            bodies: *bodies,
            meter: *meter,
            solo: solo.clone(),
            variants: Variants::default(),
        }
    }

    /// Returns the scene that shows a variant, without all others. None if there is no such variant.
    pub fn variant_alone(&self, id: VariantId) -> Option<Scene> {
        let mut scene = self.without_variants();
        if id == self.variants.shown() {
            return Some(scene);
        }
        let studio = self.studio_setup();
        let setup =
            if id == self.variants.studio_id { studio } else { self.variants.other(id)?.difference.applied(&studio) };
        setup.put_into(&mut scene);
        Some(scene)
    }

    /// Adds a variant that is equal to the shown one, and shows it. None if there are [`VARIANT_LIMIT`].
    pub fn add_variant(&mut self, name: String) -> Option<VariantId> {
        if self.variants.others.len() >= VARIANT_LIMIT {
            return None;
        }
        let id = self.variants.fresh_id();
        let setup = StudioSetup::of(self).without_solo();
        let studio = self.hide_variant();
        self.variants.others.push(Variant { id, name, difference: SetupDifference::default() });
        self.variants.shown = Some(ShownVariant { id, studio: Box::new(studio) });
        setup.put_into(self);
        Some(id)
    }

    /// Removes a variant; in place of a shown one, the studio itself is shown. Returns false for the studio itself and for
    /// a variant that does not exist.
    pub fn remove_variant(&mut self, id: VariantId) -> bool {
        if self.variants.other(id).is_none() {
            return false;
        }
        if self.variants.shown() == id {
            self.show_variant(self.variants.studio_id);
        }
        self.variants.others.retain(|variant| variant.id != id);
        true
    }

    /// Renames a variant. Returns false if there is none with this id, or another with this name.
    pub fn rename_variant(&mut self, id: VariantId, name: &str) -> bool {
        if self.variants.named(name).is_some_and(|other| other != id) {
            return false;
        }
        let others = self.variants.others.iter_mut();
        match others.into_iter().find(|variant| variant.id == id) {
            Some(variant) => variant.name = name.to_owned(),
            None if id == self.variants.studio_id => self.variants.studio_name = name.to_owned(),
            None => return false,
        }
        true
    }

    /// Makes a variant the studio itself, and shows it. What was the studio takes the variant's place in the list; all
    /// others stay as they look. Returns false if there is no such variant.
    pub fn make_studio(&mut self, id: VariantId) -> bool {
        if id == self.variants.studio_id {
            return self.show_variant(id);
        }
        let Some(place) = self.variants.others.iter().position(|variant| variant.id == id) else { return false };
        self.show_variant(id);
        let new = StudioSetup::of(self).without_solo();
        let old = self.hide_variant().without_solo();
        for variant in &mut self.variants.others {
            let setup = if variant.id == id { old.clone() } else { variant.difference.applied(&old) };
            variant.difference = SetupDifference::between(&new, &setup);
        }
        let former = &mut self.variants.others[place];
        std::mem::swap(&mut former.id, &mut self.variants.studio_id);
        std::mem::swap(&mut former.name, &mut self.variants.studio_name);
        new.put_into(self);
        true
    }

    /// Returns a light of any variant.
    pub fn light_of_any_variant(&self, id: LightId) -> Option<&Light> {
        self.light(id).or_else(|| self.variants.stored_lights().find(|light| light.id == id))
    }

    /// Removes what variants say about an object, before it is deleted.
    pub fn forget_in_variants(&mut self, id: ObjectId) {
        if let Some(shown) = &mut self.variants.shown {
            shown.studio.hidden.retain(|hidden| *hidden != id);
        }
        for variant in &mut self.variants.others {
            variant.difference.hidden.retain(|hidden| *hidden != id);
            variant.difference.visible.retain(|visible| *visible != id);
        }
    }
}
