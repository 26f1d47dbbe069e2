//! Which clear bodies a path is inside of: glass in water, a bubble in glass, a drink in a tumbler.
//!
//! The body that was entered last fills the space. Where two overlap (a drink drawn a little wider than the hollow of
//! its tumbler, as it should be, so that no air is between them), leaving the other one changes nothing.

use super::bsdf::Surfacing;
use glam::Vec3;

/// Bodies that a path can be inside of at once; beyond, the innermost is replaced.
const DEPTH: usize = 8;

/// Bodies by their material, the innermost last.
#[derive(Clone, Copy, Debug, Default)]
pub struct Media {
    inside: [u32; DEPTH],
    count: u8,
}

/// The clear substances on both sides of a surface, as a path comes to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// Index of refraction behind over the one before.
    pub eta: f32,
    /// The path began inside this body: it is the camera's own air that ends here, and radiance is not scaled.
    pub unknown: bool,
}

impl Media {
    /// The innermost body's material.
    pub fn innermost(&self) -> Option<u32> {
        self.count.checked_sub(1).map(|last| self.inside[usize::from(last)])
    }

    /// What a path meets at the surface of a body, coming from its outside or inside.
    pub fn interface(&self, materials: &[Surfacing], material: u32, outside: bool) -> Interface {
        let ior = |body: Option<u32>| body.map_or(1.0, |m| materials[m as usize].ior());
        let this = materials[material as usize].ior();
        if outside {
            return Interface { eta: this / ior(self.innermost()), unknown: false };
        }
        let mut after = *self;
        let known = after.leave(material);
        let before = if known { ior(self.innermost()) } else { this };
        Interface { eta: ior(after.innermost()) / before, unknown: !known }
    }

    /// Goes through the surface of a body.
    pub fn cross(&mut self, material: u32, outside: bool) {
        if outside {
            let slot = usize::from(self.count).min(DEPTH - 1);
            self.inside[slot] = material;
            self.count = slot as u8 + 1;
        } else {
            self.leave(material);
        }
    }

    /// Leaves the body of this material that was entered last; false when there is none.
    fn leave(&mut self, material: u32) -> bool {
        let count = usize::from(self.count);
        let Some(at) = self.inside[..count].iter().rposition(|&m| m == material) else { return false };
        self.inside.copy_within(at + 1..count, at);
        self.count -= 1;
        true
    }

    /// Share of light left after a distance in the innermost body (Beer and Lambert); all of it in air.
    pub fn transmittance(&self, materials: &[Surfacing], distance: f32) -> Vec3 {
        self.innermost().map_or(Vec3::ONE, |m| materials[m as usize].transmittance(distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    fn materials() -> [Surfacing; 2] {
        [1.5, 1.33].map(|ior| Surfacing::new(&Material { ior, transmission: 1.0, ..Material::default() }, None))
    }

    const GLASS: u32 = 0;
    const WATER: u32 = 1;

    #[test]
    fn water_in_glass_meets_glass_and_not_air() {
        let materials = materials();
        let mut media = Media::default();
        assert_eq!(media.interface(&materials, GLASS, true).eta, 1.5);
        media.cross(GLASS, true);
        // The drink is a little wider than the hollow: entered inside the wall.
        assert_eq!(media.interface(&materials, WATER, true).eta, 1.33 / 1.5);
        media.cross(WATER, true);
        // The wall's inner face lies in the water and is no interface.
        assert_eq!(media.interface(&materials, GLASS, false), Interface { eta: 1.0, unknown: false });
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
        let mut media = Media::default();
        let interface = media.interface(&materials, WATER, false);
        assert!(interface.unknown && interface.eta == 1.0 / 1.33);
        media.cross(WATER, false);
        assert_eq!(media.innermost(), None);
    }

    #[test]
    fn too_many_bodies_are_no_reason_to_fail() {
        let mut media = Media::default();
        (0..100).for_each(|body| media.cross(body, true));
        assert_eq!(media.innermost(), Some(99));
        (0..100).rev().for_each(|body| media.cross(body, false));
        assert!(media.count <= DEPTH as u8);
    }
}
