//! The sizes of a modifier's body, in the light's frame: right, up, back; the light shines along -Z from its emitter in
//! the plane z = 0.
//!
//! Fronts lie [`BEHIND_EMITTER_M`] behind the emitter, and all else farther back, but for what hangs before a front on the
//! set, too: grids, barn doors, the head and shaft of an umbrella. Renderers let a light pass its own body, as its beam
//! and its losses already are those of the modifier.

use crate::scene::modifier_kind::ModifierKind;
use crate::scene::{BarnDoors, Emitter, Light, NamedModifier};
use glam::Vec2;

/// Distance of a front behind the emitter, metres.
pub(super) const BEHIND_EMITTER_M: f32 = 1e-3;
/// Depth of a softbox or a dish behind its front, as a part of its shorter edge, and at most so many metres.
const DEPTH: (f32, f32) = (0.5, 0.45);
/// Length and radius of a head, metres: typical of a monolight.
pub(super) const HEAD_M: (f32, f32) = (0.28, 0.065);
/// Diameter of a standard reflector, metres.
const REFLECTOR_M: f32 = 0.18;
/// Diameter of the end of a snoot, metres.
const SNOOT_M: f32 = 0.07;
/// Diameter of the lens of a projector, metres.
const LENS_M: f32 = 0.12;
/// Longest edge of a panel that can be a softbox, metres. Larger ones are windows and walls of light: no gear.
const LARGEST_PANEL_M: f32 = 2.5;
/// Diameter of a sphere from which it is a lantern rather than a bulb, metres.
const SMALLEST_LANTERN_M: f32 = 0.2;
/// Diameter of a round front up to which it is a dish rather than an octa, metres.
const LARGEST_DISH_M: f32 = 0.45;
/// Full angle up to which a spot comes from a snoot, degrees.
const SNOOT_DEG: f32 = 25.0;

/// The modifier of a light with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModifierShape {
    /// Its kind.
    pub kind: ModifierKind,
    /// Width and height of the front, metres; the diameter twice for round ones.
    pub front_m: Vec2,
    /// A grid is mounted.
    pub has_grid: bool,
    /// Barn doors.
    pub doors: Option<BarnDoors>,
}

impl ModifierShape {
    /// Returns the shape of a light's modifier. None where nothing is on the set: for sun, surround and large panels.
    pub fn of(light: &Light) -> Option<Self> {
        let kind = kind_of(light)?;
        let round = |diameter_m: f32| Vec2::splat(diameter_m);
        let front_m = match light.emitter {
            Emitter::RectPanel { width_m, height_m } => Vec2::new(width_m, height_m),
            Emitter::RoundPanel { diameter_m } => round(diameter_m),
            Emitter::Sphere { radius_m } => round(2.0 * radius_m),
            Emitter::Spot { .. } => round(match kind {
                ModifierKind::Snoot => SNOOT_M,
                ModifierKind::Projector => LENS_M,
                _ => REFLECTOR_M,
            }),
            Emitter::Point => round(0.0),
            Emitter::Sun { .. } | Emitter::Surround => return None,
        };
        let is_panel = matches!(light.emitter, Emitter::RectPanel { .. } | Emitter::RoundPanel { .. });
        let has_front = is_panel || matches!(light.emitter, Emitter::Spot { .. });
        Some(ModifierShape {
            kind,
            front_m,
            has_grid: has_front && light.modifier.grid_deg.is_some(),
            doors: light.modifier.doors.filter(|_| has_front),
        })
    }

    /// Returns the depth of the modifier behind its front, where its head begins, metres.
    pub(super) fn depth_m(&self) -> f32 {
        let edge_m = self.front_m.min_element();
        match self.kind {
            ModifierKind::Bare => 0.5 * edge_m + 0.01,
            ModifierKind::Softbox | ModifierKind::Octa => (DEPTH.0 * edge_m).min(DEPTH.1),
            ModifierKind::Dish => (0.35 * edge_m).min(DEPTH.1),
            ModifierKind::Reflector => 0.13,
            ModifierKind::Snoot => 0.2,
            ModifierKind::Projector => 0.25,
            ModifierKind::Umbrella | ModifierKind::ShootThrough => 0.22 * edge_m,
            ModifierKind::Frame => 0.0,
            ModifierKind::Lantern => 0.5 * edge_m,
        }
    }

    /// Returns the distance of the point behind the emitter at which the stand holds the light, metres; negative before
    /// it.
    pub fn stand_point_m(&self) -> f32 {
        let edge_m = self.front_m.min_element();
        match self.kind {
            ModifierKind::Softbox | ModifierKind::Octa | ModifierKind::Dish => (DEPTH.0 * edge_m).min(DEPTH.1),
            ModifierKind::Bare | ModifierKind::Lantern => 0.5 * edge_m + 0.5 * HEAD_M.0,
            ModifierKind::Reflector | ModifierKind::Snoot | ModifierKind::Projector => HEAD_M.0,
            ModifierKind::Umbrella | ModifierKind::ShootThrough => self.head_m() - 0.5 * HEAD_M.0 * self.head_side(),
            ModifierKind::Frame => 0.0,
        }
    }

    /// Returns the distance behind the emitter of the end of the head from which its light comes, metres.
    pub(super) fn head_m(&self) -> f32 {
        match self.kind {
            // The lamp shines into the canopy from half of its diameter
            ModifierKind::Umbrella => self.depth_m() - 0.5 * self.front_m.min_element(),
            ModifierKind::ShootThrough => 0.5 * self.front_m.min_element(),
            _ => self.depth_m(),
        }
    }

    /// Returns 1 for a head that faces back, into an umbrella, and -1 for one that faces ahead.
    pub(super) fn head_side(&self) -> f32 {
        if self.kind == ModifierKind::Umbrella { 1.0 } else { -1.0 }
    }

    /// Returns the numbers from which the mesh is made: equal ones give equal meshes.
    pub(super) fn key(&self) -> [u32; 8] {
        let doors = self.doors.map_or([f32::NAN; 4], |doors| {
            let BarnDoors { left_deg, right_deg, top_deg, bottom_deg } = doors;
            [left_deg, right_deg, top_deg, bottom_deg]
        });
        let [a, b, c, d] = doors.map(f32::to_bits);
        let flags = self.kind as u32 * 2 + u32::from(self.has_grid);
        [flags, self.front_m.x.to_bits(), self.front_m.y.to_bits(), a, b, c, d, 0]
    }
}

/// Returns the kind of a light's modifier: that of the named one with its emitter and the nearest loss, else by its shape.
fn kind_of(light: &Light) -> Option<ModifierKind> {
    let loss = |named: &&NamedModifier| (named.modifier.loss_stops - light.modifier.loss_stops).abs();
    let is_same = |named: &&NamedModifier| {
        named.emitter == light.emitter && named.modifier.beam.is_some() == light.modifier.beam.is_some()
    };
    let named = NamedModifier::ALL.iter().filter(is_same).min_by(|a, b| loss(a).total_cmp(&loss(b)));
    if let Some(named) = named {
        return Some(named.kind);
    }
    let is_cut = light.modifier.beam.is_some();
    let kind = match light.emitter {
        Emitter::RectPanel { width_m, height_m } if width_m.max(height_m) > LARGEST_PANEL_M => return None,
        Emitter::RoundPanel { diameter_m } if diameter_m > LARGEST_PANEL_M => return None,
        Emitter::RectPanel { .. } => ModifierKind::Softbox,
        Emitter::RoundPanel { diameter_m } if is_cut || diameter_m <= LARGEST_DISH_M => ModifierKind::Dish,
        Emitter::RoundPanel { .. } => ModifierKind::Octa,
        Emitter::Spot { outer_deg, .. } => {
            let cut_deg = light.modifier.beam.map_or(180.0, |beam| beam.outer_deg);
            if cut_deg.min(outer_deg) <= SNOOT_DEG { ModifierKind::Snoot } else { ModifierKind::Reflector }
        }
        Emitter::Sphere { radius_m } if 2.0 * radius_m >= SMALLEST_LANTERN_M => ModifierKind::Lantern,
        Emitter::Sphere { .. } | Emitter::Point => ModifierKind::Bare,
        Emitter::Sun { .. } | Emitter::Surround => return None,
    };
    Some(kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Modifier, Output};

    fn kind(emitter: Emitter, modifier: Modifier) -> Option<ModifierKind> {
        let light = Light { modifier, ..Light::new(emitter, Output::Lumens(1.0)) };
        ModifierShape::of(&light).map(|shape| shape.kind)
    }

    #[test]
    fn every_named_modifier_has_its_body_also_with_another_loss_or_grid() {
        for named in &NamedModifier::ALL {
            assert_eq!(kind(named.emitter, named.modifier), Some(named.kind), "{}", named.name);
            let changed = Modifier { scrim_stops: 1.0, grid_deg: Some(35.0), ..named.modifier };
            assert_eq!(kind(named.emitter, changed), Some(named.kind), "{}", named.name);
        }
    }

    #[test]
    fn other_lights_have_the_body_of_their_shape_and_windows_none() {
        let panel = |width_m, height_m| Emitter::RectPanel { width_m, height_m };
        let none = Modifier::default();
        assert_eq!(kind(panel(0.8, 0.5), none), Some(ModifierKind::Softbox));
        assert_eq!(kind(panel(2.0, 3.0), none), None);
        assert_eq!(kind(Emitter::RoundPanel { diameter_m: 1.1 }, none), Some(ModifierKind::Octa));
        assert_eq!(kind(Emitter::RoundPanel { diameter_m: 0.21 }, none), Some(ModifierKind::Dish));
        assert_eq!(kind(Emitter::Sphere { radius_m: 0.3 }, none), Some(ModifierKind::Lantern));
        assert_eq!(kind(Emitter::Point, none), Some(ModifierKind::Bare));
        assert_eq!(kind(Emitter::Spot { inner_deg: 10.0, outer_deg: 20.0 }, none), Some(ModifierKind::Snoot));
        assert_eq!(kind(Emitter::Sun { angular_diameter_deg: 0.5 }, none), None);
        assert_eq!(kind(Emitter::Surround, none), None);
    }
}
