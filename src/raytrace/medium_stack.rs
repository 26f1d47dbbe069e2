//! The medium stack: the clear bodies that a path is inside of, such as glass in water, or a drink in a tumbler.
//!
//! The body that was entered last is the current medium. Where two bodies overlap (a drink is modelled slightly wider
//! than the hollow of its tumbler, so that there is no air between them), exiting the other one does not change the
//! medium. Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images", give bodies priorities instead.

use super::bsdf::{DielectricInterface, TracedMaterial};
use super::geometry::SurfaceInteraction;
use glam::Vec3;

/// Capacity of the stack; a body beyond it replaces the innermost one.
const CAPACITY: usize = 8;

/// The bodies that a path is inside of, as indices of their materials, the innermost last.
#[derive(Clone, Copy, Debug, Default)]
pub struct MediumStack {
    bodies: [u32; CAPACITY],
    count: u8,
}

impl MediumStack {
    /// Returns the material of the current medium; none in air.
    pub fn innermost(&self) -> Option<u32> {
        self.count.checked_sub(1).map(|last| self.bodies[usize::from(last)])
    }

    /// Returns the interface at the surface of a body, for a path that comes from its outside or inside.
    pub fn interface(&self, materials: &[TracedMaterial], material: u32, from_outside: bool) -> DielectricInterface {
        let ior = |body: Option<u32>| body.map_or(1.0, |m| materials[m as usize].ior());
        let body_ior = materials[material as usize].ior();
        // Entering: from the current medium into the body
        if from_outside {
            return DielectricInterface { eta: body_ior / ior(self.innermost()), starts_inside: false };
        }
        // Exiting: into the medium that is current without the body; a path that started inside never entered it
        let mut after = *self;
        let was_entered = after.exit(material);
        let before = if was_entered { ior(self.innermost()) } else { body_ior };
        DielectricInterface { eta: ior(after.innermost()) / before, starts_inside: !was_entered }
    }

    /// Updates the stack for a path that crosses the surface of a body from outside or inside.
    pub fn cross(&mut self, material: u32, from_outside: bool) {
        if from_outside {
            let slot = usize::from(self.count).min(CAPACITY - 1);
            self.bodies[slot] = material;
            self.count = slot as u8 + 1;
        } else {
            self.exit(material);
        }
    }

    /// Removes the innermost body of this material. Returns false if there is none.
    fn exit(&mut self, material: u32) -> bool {
        let count = usize::from(self.count);
        let Some(at) = self.bodies[..count].iter().rposition(|&m| m == material) else { return false };
        self.bodies.copy_within(at + 1..count, at);
        self.count -= 1;
        true
    }

    /// Returns the transmittance over the distance to a surface, metres (Beer-Lambert law). A path that arrives at the
    /// inner side of a body and is in no medium started inside of that body.
    pub fn transmittance_to(
        &self,
        materials: &[TracedMaterial],
        surface: &SurfaceInteraction,
        outside: bool,
        distance: f32,
    ) -> Vec3 {
        let material = &materials[surface.material as usize];
        let starts_inside = self.innermost().is_none() && material.transmits() && !outside && !surface.is_thin;
        if starts_inside { material.transmittance(distance) } else { self.transmittance(materials, distance) }
    }

    /// Returns the transmittance over a distance in the current medium, metres (Beer-Lambert law); 1 in air.
    pub fn transmittance(&self, materials: &[TracedMaterial], distance: f32) -> Vec3 {
        self.innermost().map_or(Vec3::ONE, |m| materials[m as usize].transmittance(distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    fn materials() -> [TracedMaterial; 2] {
        [1.5, 1.33].map(|ior| TracedMaterial::new(&Material { ior, transmission: 1.0, ..Material::default() }))
    }

    const GLASS: u32 = 0;
    const WATER: u32 = 1;

    #[test]
    fn water_in_a_glass_has_an_interface_with_glass_and_not_with_air() {
        let materials = materials();
        let mut media = MediumStack::default();
        assert_eq!(media.interface(&materials, GLASS, true).eta, 1.5);
        media.cross(GLASS, true);
        // The drink is slightly wider than the hollow: it is entered inside the wall.
        assert_eq!(media.interface(&materials, WATER, true).eta, 1.33 / 1.5);
        media.cross(WATER, true);
        // The inner face of the wall is inside the water: no interface.
        assert_eq!(media.interface(&materials, GLASS, false), DielectricInterface { eta: 1.0, starts_inside: false });
        media.cross(GLASS, false);
        assert_eq!(media.innermost(), Some(WATER));
        // The path exits at the top.
        assert_eq!(media.interface(&materials, WATER, false).eta, 1.0 / 1.33);
        media.cross(WATER, false);
        assert_eq!(media.innermost(), None);
    }

    #[test]
    fn a_body_that_was_never_entered_is_exited_into_air() {
        let materials = materials();
        let mut media = MediumStack::default();
        let interface = media.interface(&materials, WATER, false);
        assert!(interface.starts_inside && interface.eta == 1.0 / 1.33);
        media.cross(WATER, false);
        assert_eq!(media.innermost(), None);
    }

    #[test]
    fn a_full_stack_does_not_fail() {
        let mut media = MediumStack::default();
        (0..100).for_each(|body| media.cross(body, true));
        assert_eq!(media.innermost(), Some(99));
        (0..100).rev().for_each(|body| media.cross(body, false));
        assert!(media.count <= CAPACITY as u8);
    }
}
