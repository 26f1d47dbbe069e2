//! The list of gear.

use crate::photo::light::axial_intensity;
use crate::scene::{ColorSource, Emitter, Head, Light, Modifier, NamedModifier, Output};

/// Most pieces of an entry that a user owns.
pub const MOST_OWNED: u32 = 999;

/// A head of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadModel {
    /// Name, dial, and limits of the flash.
    pub head: Head,
    /// Output at full power, bare.
    pub output: Output,
    /// Colour temperature, kelvin.
    pub kelvin: f32,
    /// Luminous surface of a head that takes no modifiers, such as an LED panel.
    pub front: Option<Emitter>,
    /// Weight, kg; none if not known.
    pub weight_kg: Option<f32>,
    /// Where the figures are from: a named source, or `typical`.
    pub source: String,
    /// Number of pieces that the user owns.
    pub owned: u32,
}

impl HeadModel {
    /// Puts a light on this head: dial, output and colour temperature are the head's, and the dial is set to the exposure
    /// that the light had, as far as the head has it. Between flash and continuous light the dial stays.
    pub fn mount(&self, light: &mut Light) {
        let before = (axial_intensity(light, None), light.power.output.is_flash());
        // A measured light was another luminaire, whose distribution is not known here
        let was_measured = light.photometric_file.take().is_some();
        if let Some(front) = self.front {
            (light.emitter, light.modifier) = (front, Modifier::default());
        }
        light.head = Some(self.head.clone());
        light.power.output = self.output;
        light.color.source = ColorSource::Kelvin(self.kelvin);
        let change = (before.0 / axial_intensity(light, None)).log2();
        let is_comparable = before.1 == self.output.is_flash() && change.is_finite() && !was_measured;
        let stops = light.power.dial_stops + if is_comparable { change } else { 0.0 };
        light.power.dial_stops = self.head.dial.nearest(stops);
    }

    /// Returns the text of its full power: `Flash, 400 Ws`.
    pub fn power_text(&self) -> String {
        match self.output {
            Output::Lumens(flux) => format!("Continuous, {flux:.0} lm"),
            Output::Candela(intensity) => format!("Continuous, {intensity:.0} cd"),
            Output::LuxAt { lux, distance_m } => format!("Continuous, {lux:.0} lx at {distance_m:.1} m"),
            Output::Lux(lux) => format!("Continuous, {lux:.0} lx"),
            Output::FlashWs { energy_ws, .. } => format!("Flash, {energy_ws:.0} Ws"),
            Output::FlashGuideNumber(number) => format!("Flash, guide number {number:.0} m"),
        }
    }
}

/// A modifier of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct ModifierModel {
    /// Its name.
    pub name: String,
    /// Luminous surface.
    pub emitter: Emitter,
    /// Loss and beam shape.
    pub modifier: Modifier,
    /// Weight, kg; none if not known.
    pub weight_kg: Option<f32>,
    /// Where the figures are from: a named source, or `typical`.
    pub source: String,
    /// Number of pieces that the user owns.
    pub owned: u32,
}

impl ModifierModel {
    /// Returns true if a light has this modifier.
    pub fn is_on(&self, light: &Light) -> bool {
        self.emitter == light.emitter && self.modifier == light.modifier && light.photometric_file.is_none()
    }
}

impl From<&NamedModifier> for ModifierModel {
    fn from(named: &NamedModifier) -> Self {
        ModifierModel {
            name: named.name.to_owned(),
            emitter: named.emitter,
            modifier: named.modifier,
            weight_kg: None,
            source: "typical".to_owned(),
            owned: 0,
        }
    }
}

/// The kind of a support.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SupportKind {
    /// Stands under its head.
    Stand,
    /// Reaches over the subject, with its stand beside.
    Boom,
}

/// A stand or boom of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: SupportKind,
    /// Greatest height of the head, metres.
    pub reach_m: f32,
    /// Greatest load, kg.
    pub load_kg: f32,
    /// Where the figures are from: a named source, or `typical`.
    pub source: String,
    /// Number of pieces that the user owns.
    pub owned: u32,
}

/// Heads, modifiers, stands and booms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GearList {
    /// The heads.
    pub heads: Vec<HeadModel>,
    /// The modifiers.
    pub modifiers: Vec<ModifierModel>,
    /// Stands and booms.
    pub supports: Vec<Support>,
}

impl GearList {
    /// Returns the list with the entries of another one: they replace those of the same name, and new ones come first.
    pub fn with(&self, own: &GearList) -> GearList {
        GearList {
            heads: joined(&self.heads, &own.heads, |model| &model.head.name),
            modifiers: joined(&self.modifiers, &own.modifiers, |model| &model.name),
            supports: joined(&self.supports, &own.supports, |model| &model.name),
        }
    }

    /// Returns the head of this name.
    pub fn head(&self, name: &str) -> Option<&HeadModel> {
        self.heads.iter().find(|model| model.head.name == name)
    }

    /// Returns the modifier of a light, if it is one of the list.
    pub fn modifier_of(&self, light: &Light) -> Option<&ModifierModel> {
        self.modifiers.iter().find(|model| model.is_on(light))
    }

    /// Returns true if the user owns anything of the list.
    pub fn has_own(&self) -> bool {
        self.heads.iter().any(|model| model.owned > 0)
            || self.modifiers.iter().any(|model| model.owned > 0)
            || self.supports.iter().any(|support| support.owned > 0)
    }
}

fn joined<T: Clone>(base: &[T], own: &[T], name: impl Fn(&T) -> &String) -> Vec<T> {
    let find = |list: &'_ [T], wanted: &T| list.iter().position(|each| name(each) == name(wanted));
    let new = own.iter().filter(|each| find(base, each).is_none());
    let replaced = base.iter().map(|each| find(own, each).map_or(each, |index| &own[index]));
    new.chain(replaced).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{DialScale, HeadDial};

    fn model(name: &str, output: Output) -> HeadModel {
        let dial = HeadDial { scale: DialScale::Number { full: 10.0 }, lowest_stops: -8.0, steps_per_stop: 10 };
        let head = Head { name: name.to_owned(), dial, sync_s: None, hss_loss_stops: None, t01_s: None };
        let source = "typical".to_owned();
        HeadModel { head, output, kelvin: 5600.0, front: None, weight_kg: None, source, owned: 0 }
    }

    fn flash(energy_ws: f32) -> Output {
        Output::FlashWs { energy_ws, efficacy_lm_s_per_ws: 40.0 }
    }

    #[test]
    fn a_light_on_another_head_keeps_its_exposure_within_the_head_s_range() {
        let octa = NamedModifier::named("Octa 120").unwrap();
        let mut light = Light { modifier: octa.modifier, ..Light::new(octa.emitter, flash(400.0)) };
        light.power.dial_stops = -2.0;
        let before = axial_intensity(&light, None);
        model("Large", flash(800.0)).mount(&mut light);
        assert_eq!(light.power.dial_stops, -3.0);
        assert!((axial_intensity(&light, None) / before - 1.0).abs() < 1e-5);
        assert_eq!((light.emitter, light.color.source), (octa.emitter, ColorSource::Kelvin(5600.0)));
        model("Small", flash(50.0)).mount(&mut light);
        assert_eq!(light.power.dial_stops, 0.0, "full power is the most there is");
    }

    #[test]
    fn a_head_with_a_front_of_its_own_brings_it() {
        let octa = NamedModifier::named("Octa 120").unwrap();
        let mut light = Light { modifier: octa.modifier, ..Light::new(octa.emitter, flash(400.0)) };
        let front = Emitter::RectPanel { width_m: 0.3, height_m: 0.3 };
        HeadModel { front: Some(front), ..model("Panel", Output::Lumens(5000.0)) }.mount(&mut light);
        assert_eq!((light.emitter, light.modifier), (front, Modifier::default()));
    }

    #[test]
    fn own_entries_replace_those_of_the_same_name_and_new_ones_come_first() {
        let base = GearList { heads: vec![model("A", flash(100.0)), model("B", flash(200.0))], ..GearList::default() };
        let own = HeadModel { owned: 2, ..model("B", flash(250.0)) };
        let own = GearList { heads: vec![own, model("Mine", flash(300.0))], ..GearList::default() };
        let all = base.with(&own);
        let names: Vec<_> = all.heads.iter().map(|model| model.head.name.as_str()).collect();
        assert_eq!(names, ["Mine", "A", "B"]);
        assert_eq!(all.head("B").map(|model| (model.output, model.owned)), Some((flash(250.0), 2)));
        assert!(all.has_own() && !base.has_own());
    }
}
