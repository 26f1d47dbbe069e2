//! What a studio uses of the user's gear, and what is missing.

use super::list::{GearList, Support, SupportKind};
use crate::scene::{Light, NamedModifier, Scene};

/// Weight of a head that is not known, kg: typical of a monolight.
const HEAD_KG: f32 = 3.0;
/// Weight of a modifier that is not known, kg: typical of a softbox.
const MODIFIER_KG: f32 = 1.0;

/// The use of an entry of the list in a studio.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GearUse {
    /// Its name.
    pub name: String,
    /// Number of pieces in the studio.
    pub used: u32,
    /// Number of pieces that the user owns.
    pub owned: u32,
}

impl GearUse {
    /// Returns a sentence if more pieces are used than there are.
    pub fn shortage(&self) -> Option<String> {
        let GearUse { name, used, owned } = self;
        (used > owned).then(|| match owned {
            0 => format!("{name}: used {}, you own none.", times(*used)),
            _ => format!("{name}: used {}, you own {owned}.", times(*used)),
        })
    }
}

fn times(count: u32) -> String {
    match count {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        _ => format!("{count} times"),
    }
}

/// Returns the heads and modifiers of a studio's lights with how many there are of each, in the order of the lights. Lights
/// without a head of the list count with their modifier alone.
pub fn gear_use(scene: &Scene, gear: &GearList) -> Vec<GearUse> {
    let mut uses: Vec<GearUse> = Vec::new();
    let mut add = |name: &str, owned: u32| match uses.iter_mut().find(|each| each.name == name) {
        Some(each) => each.used += 1,
        None => uses.push(GearUse { name: name.to_owned(), used: 1, owned }),
    };
    for light in placed(scene) {
        if let Some(head) = &light.head {
            add(&head.name, gear.head(&head.name).map_or(0, |model| model.owned));
        }
    }
    for light in placed(scene) {
        if let Some(model) = gear.modifier_of(light).filter(|model| model.name != NamedModifier::BARE) {
            add(&model.name, model.owned);
        }
    }
    uses
}

/// Returns a sentence for each thing that the studio needs more of than the user owns: heads, modifiers, stands. Kinds of
/// which the user owns nothing are not compared. `on_booms` are the lights, by their place in the list, whose stand must
/// not be under them.
pub fn shortages(scene: &Scene, gear: &GearList, on_booms: &[usize]) -> Vec<String> {
    let has_heads = gear.heads.iter().any(|model| model.owned > 0);
    let has_modifiers = gear.modifiers.iter().any(|model| model.owned > 0);
    let is_compared = |each: &GearUse| if gear.head(&each.name).is_some() { has_heads } else { has_modifiers };
    let uses = gear_use(scene, gear);
    let mut texts: Vec<String> = uses.iter().filter(|each| is_compared(each)).filter_map(GearUse::shortage).collect();
    texts.extend(missing_supports(scene, gear, on_booms));
    texts
}

/// What carries a light must do.
struct Load<'a> {
    light: &'a Light,
    needs_boom: bool,
    height_m: f32,
    weight_kg: f32,
}

impl Load<'_> {
    fn fits(&self, support: &Support) -> bool {
        let is_kind = support.kind == SupportKind::Boom || !self.needs_boom;
        is_kind && support.reach_m >= self.height_m && support.load_kg >= self.weight_kg
    }
}

/// Returns a sentence for each light that none of the user's supports is left for. The most demanding lights choose first,
/// each the least support that carries it.
fn missing_supports(scene: &Scene, gear: &GearList, on_booms: &[usize]) -> Vec<String> {
    let mut free: Vec<(&Support, u32)> =
        gear.supports.iter().filter(|support| support.owned > 0).map(|support| (support, support.owned)).collect();
    if free.is_empty() {
        return Vec::new();
    }
    free.sort_by(|(a, _), (b, _)| {
        let rank = |support: &Support| (support.kind == SupportKind::Boom, support.reach_m, support.load_kg);
        rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal)
    });
    let lights = scene.lights.iter().enumerate().filter(|(_, light)| !light.emitter.is_infinite());
    let mut loads: Vec<Load<'_>> = lights
        .map(|(index, light)| {
            let model = light.head.as_ref().and_then(|head| gear.head(&head.name));
            let is_bare = NamedModifier::of(&light.emitter, &light.modifier).is_some_and(NamedModifier::is_bare);
            let has_front = model.is_some_and(|model| model.front.is_some());
            let modifier_kg = gear.modifier_of(light).and_then(|model| model.weight_kg).unwrap_or(MODIFIER_KG);
            let head_kg = model.and_then(|model| model.weight_kg).unwrap_or(HEAD_KG);
            Load {
                light,
                needs_boom: on_booms.contains(&index),
                height_m: light.position.y,
                weight_kg: head_kg + if is_bare || has_front { 0.0 } else { modifier_kg },
            }
        })
        .collect();
    loads.sort_by(|a, b| b.needs_boom.cmp(&a.needs_boom).then(b.height_m.total_cmp(&a.height_m)));
    let mut texts = Vec::new();
    for load in loads {
        match free.iter_mut().find(|(support, left)| *left > 0 && load.fits(support)) {
            Some((_, left)) => *left -= 1,
            None => texts.push(format!(
                "No {} of yours is left for {:?}: it is at {:.1} m and weighs about {:.1} kg.",
                if load.needs_boom { "boom" } else { "stand" },
                load.light.name,
                load.height_m,
                load.weight_kg
            )),
        }
    }
    texts
}

/// Returns the lights that are somewhere in the room.
fn placed(scene: &Scene) -> impl Iterator<Item = &Light> {
    scene.lights.iter().filter(|light| !light.emitter.is_infinite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::{HeadModel, ModifierModel};
    use crate::scene::{Head, HeadDial, Output};

    /// Two heads, an octa and a softbox, a low and a high stand.
    fn gear() -> GearList {
        let dial = HeadDial::UNKNOWN;
        let head = Head { name: "Monolight".to_owned(), dial, sync_s: None, hss_loss_stops: None, t01_s: None };
        let output = Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: 40.0 };
        let source = "typical".to_owned();
        let model = HeadModel { head, output, kelvin: 5600.0, front: None, weight_kg: Some(2.0), source, owned: 2 };
        let modifiers = NamedModifier::ALL.iter().map(ModifierModel::from);
        let owned = |mut model: ModifierModel| {
            model.owned = u32::from(["Octa 120", "Softbox 60 x 90"].contains(&model.name.as_str()));
            model
        };
        let support = |name: &str, kind, reach_m| Support {
            name: name.to_owned(),
            kind,
            reach_m,
            load_kg: 4.0,
            source: "typical".to_owned(),
            owned: 1,
        };
        GearList {
            heads: vec![model],
            modifiers: modifiers.map(owned).collect(),
            supports: vec![
                support("Stand", SupportKind::Stand, 2.2),
                support("High stand", SupportKind::Stand, 3.0),
                support("Boom", SupportKind::Boom, 3.0),
            ],
        }
    }

    fn studio(gear: &GearList, lights: &[(&str, f32)]) -> Scene {
        let light = |(modifier, height_m): &(&str, f32)| {
            let named = NamedModifier::named(modifier).unwrap();
            let mut light = Light::new(named.emitter, Output::Lumens(1.0));
            (light.modifier, light.position.y, light.name) = (named.modifier, *height_m, format!("At {height_m}"));
            gear.heads[0].mount(&mut light);
            light
        };
        Scene { lights: lights.iter().map(light).collect(), ..Scene::default() }
    }

    #[test]
    fn double_use_of_a_head_or_a_modifier_is_told() {
        let gear = gear();
        let fits = studio(&gear, &[("Octa 120", 2.0), ("Softbox 60 x 90", 2.5)]);
        assert_eq!(shortages(&fits, &gear, &[]), [""; 0]);
        let scene = studio(&gear, &[("Octa 120", 2.0), ("Octa 120", 2.1), ("Bare bulb", 2.1)]);
        let found = shortages(&scene, &gear, &[]);
        assert_eq!(found, ["Monolight: used 3 times, you own 2.", "Octa 120: used twice, you own 1."]);
        let nothing = GearList { supports: Vec::new(), ..GearList::default() };
        assert_eq!(shortages(&scene, &nothing, &[]), [""; 0], "who owns nothing of a list is not told about it");
    }

    #[test]
    fn missing_stands_and_booms_are_told() {
        let gear = gear();
        let scene = studio(&gear, &[("Octa 120", 2.6), ("Softbox 60 x 90", 1.0)]);
        assert_eq!(shortages(&scene, &gear, &[1]), [""; 0], "the high stand, and the boom");
        let found = shortages(&scene, &gear, &[0, 1]);
        assert_eq!(found, ["No boom of yours is left for \"At 1\": it is at 1.0 m and weighs about 3.0 kg."]);
        let high = studio(&gear, &[("Octa 120", 3.2)]);
        assert_eq!(shortages(&high, &gear, &[]).len(), 1, "none reaches so high");
        let heavy = GearList { heads: vec![HeadModel { weight_kg: Some(9.0), ..gear.heads[0].clone() }], ..gear };
        let scene = studio(&heavy, &[("Bare bulb", 1.5)]);
        assert_eq!(shortages(&scene, &heavy, &[]).len(), 1, "none carries it");
    }
}
