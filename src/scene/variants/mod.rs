//! Variants of a studio: other light, another camera, other things in view, stored as named differences.
//!
//! The fields of a [`Scene`](super::Scene) are those of the shown variant, so that renderers and panels need not know
//! about variants. The studio itself is the first variant. Of each other one only its difference from the studio is
//! stored: a change of the studio shows in all variants that do not differ there. Room, objects, their materials and
//! the light meter are common to all.

mod difference;
mod setup;
mod show;

pub use difference::{CameraDifference, LightDifference, SetupDifference};

use super::{Aim, Focus, Light};
use setup::StudioSetup;

/// Largest number of variants beside the studio itself: one a letter of the alphabet.
pub const VARIANT_LIMIT: usize = 25;

/// The id of a variant while the scene is open. Files refer to variants by their unique name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct VariantId(pub u32);

/// A variant as a named difference from the studio.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Stable while the scene is open.
    pub id: VariantId,
    /// Unique among the variants.
    pub name: String,
    /// The difference; empty while the variant is shown.
    pub difference: SetupDifference,
}

/// The variants of a studio.
#[derive(Clone, Debug, PartialEq)]
pub struct Variants {
    /// Id of the studio itself.
    pub studio_id: VariantId,
    /// Name of the studio itself among the variants.
    pub studio_name: String,
    /// The variants that differ from the studio, in list order.
    pub others: Vec<Variant>,
    /// The shown variant; none while the studio itself is shown.
    shown: Option<ShownVariant>,
}

/// A variant that is shown in place of the studio.
#[derive(Clone, Debug, PartialEq)]
struct ShownVariant {
    id: VariantId,
    /// What the variant hides: the studio's own set-up.
    studio: Box<StudioSetup>,
}

impl Variants {
    /// Name of the studio itself, unless it has another.
    pub const STUDIO_NAME: &str = "A";

    /// Returns the variants of a studio that is shown itself.
    pub fn new(studio_name: String, others: Vec<Variant>) -> Self {
        Variants { studio_id: VariantId::default(), studio_name, others, shown: None }
    }

    /// Returns true if there is only the studio itself.
    pub fn is_empty(&self) -> bool {
        self.others.is_empty()
    }

    /// Returns id and name of all variants, the studio itself first.
    pub fn list(&self) -> impl Iterator<Item = (VariantId, &str)> {
        let others = self.others.iter().map(|variant| (variant.id, variant.name.as_str()));
        std::iter::once((self.studio_id, self.studio_name.as_str())).chain(others)
    }

    /// Returns the shown variant.
    pub fn shown(&self) -> VariantId {
        self.shown.as_ref().map_or(self.studio_id, |shown| shown.id)
    }

    /// Returns the name of a variant.
    pub fn name(&self, id: VariantId) -> Option<&str> {
        self.list().find(|(other, _)| *other == id).map(|(_, name)| name)
    }

    /// Returns the variant of this name.
    pub fn named(&self, name: &str) -> Option<VariantId> {
        self.list().find(|(_, other)| *other == name).map(|(id, _)| id)
    }

    /// Returns the first letter that is no variant's name.
    pub fn next_name(&self) -> String {
        let letters = ('A'..='Z').map(String::from);
        letters.into_iter().find(|letter| self.named(letter).is_none()).unwrap_or_else(|| "Variant".to_owned())
    }

    fn fresh_id(&self) -> VariantId {
        VariantId(self.list().map(|(id, _)| id.0 + 1).max().unwrap_or(0))
    }

    fn other(&self, id: VariantId) -> Option<&Variant> {
        self.others.iter().find(|variant| variant.id == id)
    }

    /// Returns the lights that are stored here instead of in the scene: those of the studio while a variant is shown,
    /// and those that variants add. A light of several variants is listed as often.
    pub fn stored_lights(&self) -> impl Iterator<Item = &Light> {
        let studio = self.shown.iter().flat_map(|shown| &shown.studio.lights);
        studio.chain(self.others.iter().flat_map(|variant| &variant.difference.added_lights))
    }

    /// Returns [`Variants::stored_lights`], to change them.
    pub fn stored_lights_mut(&mut self) -> impl Iterator<Item = &mut Light> {
        let studio = self.shown.iter_mut().flat_map(|shown| &mut shown.studio.lights);
        studio.chain(self.others.iter_mut().flat_map(|variant| &mut variant.difference.added_lights))
    }

    /// Returns every aim that is stored here instead of in the scene, to change it.
    pub fn stored_aims_mut(&mut self) -> impl Iterator<Item = &mut Aim> {
        let studio = self.shown.iter_mut().flat_map(|shown| {
            let StudioSetup { camera, lights, hidden: _, solo: _ } = &mut *shown.studio;
            std::iter::once(&mut camera.aim).chain(lights.iter_mut().map(|light| &mut light.aim))
        });
        let others = self.others.iter_mut().flat_map(|variant| {
            let SetupDifference { camera, lights, added_lights, .. } = &mut variant.difference;
            let changed = lights.iter_mut().filter_map(|(_, light)| light.aim.as_mut());
            camera.aim.iter_mut().chain(changed).chain(added_lights.iter_mut().map(|light| &mut light.aim))
        });
        studio.chain(others)
    }

    /// Returns the path of every photometric file that is stored here instead of in the scene.
    pub fn stored_photometric_files(&self) -> impl Iterator<Item = &str> {
        let lights = self.stored_lights().filter_map(|light| light.photometric_file.as_deref());
        let changed = self.others.iter().flat_map(|variant| &variant.difference.lights);
        lights.chain(changed.filter_map(|(_, light)| light.photometric_file.as_ref()?.as_deref()))
    }

    /// Returns the path of every environment map that is stored here instead of in the scene.
    pub fn stored_environment_maps(&self) -> impl Iterator<Item = &str> {
        let lights = self.stored_lights().filter_map(|light| light.environment_map.as_deref());
        let changed = self.others.iter().flat_map(|variant| &variant.difference.lights);
        lights.chain(changed.filter_map(|(_, light)| light.environment_map.as_ref()?.as_deref()))
    }

    /// Returns every focus that is stored here instead of in the scene, to change it.
    pub fn stored_focuses_mut(&mut self) -> impl Iterator<Item = &mut Focus> {
        let studio = self.shown.iter_mut().map(|shown| &mut shown.studio.camera.focus);
        studio.chain(self.others.iter_mut().filter_map(|variant| variant.difference.camera.focus.as_mut()))
    }
}

impl Default for Variants {
    fn default() -> Self {
        Variants::new(Variants::STUDIO_NAME.to_owned(), Vec::new())
    }
}

#[cfg(test)]
mod tests;
