//! Which clear bodies a path is inside of: glass in water, a bubble in glass, a drink in a tumbler.
//!
//! The body that was entered last fills the space. Where two overlap (a drink drawn a little wider than the hollow of
//! its tumbler, as it should be, so that no air is between them), leaving the other one changes nothing.

use super::bsdf::{DielectricInterface, TracedMaterial};
use glam::Vec3;

/// Bodies that a path can be inside of at once; beyond, the innermost is replaced.
const DEPTH: usize = 8;

/// Bodies by their material, the innermost last.
#[derive(Clone, Copy, Debug, Default)]
pub struct MediumStack {
    inside: [u32; DEPTH],
    count: u8,
}

impl MediumStack {
    /// The innermost body's material.
    pub fn innermost(&self) -> Option<u32> {
        self.count.checked_sub(1).map(|last| self.inside[usize::from(last)])
    }

    /// What a path meets at the surface of a body, coming from its outside or inside.
    pub fn interface(&self, materials: &[TracedMaterial], material: u32, outside: bool) -> DielectricInterface {
        let ior = |body: Option<u32>| body.map_or(1.0, |m| materials[m as usize].ior());
        let this = materials[material as usize].ior();
        if outside {
            return DielectricInterface { eta: this / ior(self.innermost()), starts_inside: false };
        }
        let mut after = *self;
        let known = after.exit(material);
        let before = if known { ior(self.innermost()) } else { this };
        DielectricInterface { eta: ior(after.innermost()) / before, starts_inside: !known }
    }

    /// Goes through the surface of a body.
    pub fn cross(&mut self, material: u32, outside: bool) {
        if outside {
            let slot = usize::from(self.count).min(DEPTH - 1);
            self.inside[slot] = material;
            self.count = slot as u8 + 1;
        } else {
            self.exit(material);
        }
    }

    /// Leaves the body of this material that was entered last; false when there is none.
    fn exit(&mut self, material: u32) -> bool {
        let count = usize::from(self.count);
        let Some(at) = self.inside[..count].iter().rposition(|&m| m == material) else { return false };
        self.inside.copy_within(at + 1..count, at);
        self.count -= 1;
        true
    }

    /// Share of light left after a distance in the innermost body (Beer and Lambert); all of it in air.
    pub fn transmittance(&self, materials: &[TracedMaterial], distance: f32) -> Vec3 {
        self.innermost().map_or(Vec3::ONE, |m| materials[m as usize].transmittance(distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    fn materials() -> [TracedMaterial; 2] {
        [1.5, 1.33].map(|ior| TracedMaterial::new(&Material { ior, transmission: 1.0, ..Material::default() }, None))
    }

    const GLASS: u32 = 0;
    const WATER: u32 = 1;

    #[test]
    fn water_in_glass_meets_glass_and_not_air() {
        let materials = materials();
        let mut media = MediumStack::default();
        assert_eq!(media.interface(&materials, GLASS, true).eta, 1.5);
        media.cross(GLASS, true);
        // The drink is a little wider than the hollow: entered inside the wall.
        assert_eq!(media.interface(&materials, WATER, true).eta, 1.33 / 1.5);
        media.cross(WATER, true);
        // The wall's inner face lies in the water and is no interface.
        assert_eq!(media.interface(&materials, GLASS, false), DielectricInterface { eta: 1.0, starts_inside: false });
        media.cross(GLASS, false);
        assert_eq!(media.innermost(), Some(WATER));
        // Out through the top.
        assert_eq!(media.interface(&materials, WATER, false).eta, 1.0 / 1.33);
        media.cross(WATER, false);
        assert_eq!(media.innermost(), None);
    }

    #[test]
    fn a_body_that_was_never_entered_ends_in_air() {
        let materials = materials();
        let mut media = MediumStack::default();
        let interface = media.interface(&materials, WATER, false);
        assert!(interface.starts_inside && interface.eta == 1.0 / 1.33);
        media.cross(WATER, false);
        assert_eq!(media.innermost(), None);
    }

    #[test]
    fn too_many_bodies_are_no_reason_to_fail() {
        let mut media = MediumStack::default();
        (0..100).for_each(|body| media.cross(body, true));
        assert_eq!(media.innermost(), Some(99));
        (0..100).rev().for_each(|body| media.cross(body, false));
        assert!(media.count <= DEPTH as u8);
    }
}
