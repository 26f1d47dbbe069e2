//! The partition of light paths through clear bodies: which technique finds which light.
//!
//! Between a light and a non-specular surface, light meets specular surfaces only. Such a path is *straight* if it
//! leaves every body through a flat face parallel to the one by which it entered, on the far side, and all faces that it
//! meets inside are parallel to them: Snell's law then gives it back its direction, also after inner reflections. Thin
//! panes, whose inner reflections are part of their transmittance, keep the direction, too. All other paths are
//! *caustic*: reflections outside of bodies, curved faces, wedges, and surfaces between the light and the inside of a
//! body.
//!
//! | path | light without extent | light with extent |
//! |---|---|---|
//! | straight | light sampling | light sampling and emitter hits, weighted (MIS) |
//! | caustic, with photons | photons | photons and emitter hits, weighted (MIS) |
//! | caustic, without photons | approximated by light sampling (`connection`) | emitter hits |
//!
//! Light sampling, emitter hits and photons all follow the faces with a [`StraightPath`], so that each path belongs to
//! exactly one row. The classes are the same for both directions of a path.

use super::geometry::SurfaceInteraction;
use glam::Vec3;

/// Bodies inside one another that a straight path may cross; deeper ones are caustic.
const MAX_NESTED: usize = 3;

/// The state of a path since its last non-specular vertex, or since its light.
#[derive(Clone, Copy, Debug, Default)]
pub struct StraightPath {
    /// Materials of the bodies that were entered and not left, the innermost last.
    open: [u32; MAX_NESTED],
    count: u8,
    is_caustic: bool,
    crosses_body: bool,
    /// Normal of the face by which the outermost open body was entered.
    normal: Vec3,
}

impl StraightPath {
    /// Continues by specular scattering at a surface from outside or inside, but for transmission by a thin pane.
    pub fn scatter(&mut self, surface: &SurfaceInteraction, from_outside: bool, is_transmission: bool) {
        if is_transmission { self.transmit(surface, from_outside) } else { self.reflect(surface) }
    }

    /// Continues by reflection at a surface.
    fn reflect(&mut self, surface: &SurfaceInteraction) {
        self.is_caustic |= self.count == 0 || !self.is_parallel_face(surface);
    }

    /// Continues by transmission at the face of a body, from outside or inside.
    pub fn transmit(&mut self, surface: &SurfaceInteraction, from_outside: bool) {
        self.crosses_body = true;
        let count = usize::from(self.count);
        if from_outside {
            if count == 0 {
                self.normal = surface.normal;
            }
            if count == MAX_NESTED || !self.is_parallel_face(surface) {
                self.is_caustic = true;
                return;
            }
            self.open[count] = surface.material;
            self.count += 1;
            return;
        }
        let is_innermost = count > 0 && self.open[count - 1] == surface.material;
        // The outermost body is left on the far side, with the direction of before.
        let turns_back = count == 1 && surface.normal.dot(self.normal) > 0.0;
        if !is_innermost || turns_back || !self.is_parallel_face(surface) {
            self.is_caustic = true;
            return;
        }
        self.count -= 1;
    }

    /// Returns true for a flat face parallel to that by which the outermost open body was entered.
    fn is_parallel_face(&self, surface: &SurfaceInteraction) -> bool {
        is_flat(surface) && are_parallel(self.normal, surface.normal)
    }

    /// Returns true if the path is straight so far: it is outside of all bodies that it crossed.
    pub fn is_straight(&self) -> bool {
        !self.is_caustic && self.count == 0
    }

    /// Returns true if the path is caustic, whatever follows.
    pub fn is_caustic(&self) -> bool {
        self.is_caustic
    }

    /// Returns true if the path met a body.
    pub fn crosses_body(&self) -> bool {
        self.crosses_body
    }

    /// Returns the normal of the parallel faces between which the path is; none outside of all bodies.
    pub fn open_normal(&self) -> Option<Vec3> {
        (self.count > 0).then_some(self.normal)
    }
}

/// Returns true if directions are parallel but for rounding (3 microradians).
pub fn are_parallel(a: Vec3, b: Vec3) -> bool {
    a.cross(b).length_squared() < 1e-11
}

/// Returns true if the shading normal is that of the triangle, to 1 milliradian: normals in files are rounded.
fn is_flat(surface: &SurfaceInteraction) -> bool {
    surface.normal.cross(surface.geometric_normal).length_squared() < 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;

    const GLASS: u32 = 0;
    const WATER: u32 = 1;

    fn face(material: u32, normal: Vec3) -> SurfaceInteraction {
        SurfaceInteraction {
            position: Vec3::ZERO,
            position_error: Vec3::ZERO,
            smooth_offset: Vec3::ZERO,
            geometric_normal: normal,
            normal,
            relief_normal: normal,
            second_uv: glam::Vec2::ZERO,
            uv: glam::Vec2::ZERO,
            color: Vec3::ONE,
            material,
            strand: None,
            tangent: Vec3::ZERO,
            is_thin: false,
        }
    }

    /// An event on the way, at a face of this normal: a reflection, or a transmission into or out of this material.
    #[derive(Clone, Copy)]
    enum Event {
        Reflect(Vec3),
        Enter(u32, Vec3),
        Leave(u32, Vec3),
    }
    use Event::{Enter, Leave, Reflect};

    fn class(events: impl IntoIterator<Item = Event>) -> bool {
        let mut path = StraightPath::default();
        for event in events {
            match event {
                Reflect(normal) => path.reflect(&face(GLASS, normal)),
                Enter(material, normal) => path.transmit(&face(material, normal), true),
                Leave(material, normal) => path.transmit(&face(material, normal), false),
            }
        }
        path.is_straight()
    }

    /// The same path from the other end.
    fn reversed(events: &[Event]) -> Vec<Event> {
        let turned = |event: &Event| match *event {
            Reflect(normal) => Reflect(normal),
            Enter(material, normal) => Leave(material, normal),
            Leave(material, normal) => Enter(material, normal),
        };
        events.iter().rev().map(turned).collect()
    }

    #[test]
    fn the_partition_names_straight_paths_and_agrees_from_both_ends() {
        let (z, tilted) = (Vec3::Z, Vec3::new(0.0, 0.1, 1.0).normalize());
        let pane = [Enter(GLASS, z), Leave(GLASS, -z)];
        let tilted_pane = [Enter(GLASS, tilted), Leave(GLASS, -tilted)];
        let tank = [Enter(GLASS, z), Enter(WATER, z), Leave(WATER, -z), Leave(GLASS, -z)];
        let straight: [&[Event]; 8] = [
            &[],
            &pane,
            &[pane, pane].concat(),
            &[pane, tilted_pane, pane].concat(),
            // Water between two walls, modelled inside of a body of glass.
            &tank,
            &[tilted_pane, tilted_pane, tilted_pane].concat(),
            // Inner reflections.
            &[Enter(GLASS, z), Reflect(-z), Reflect(z), Leave(GLASS, -z)],
            &[
                Enter(GLASS, z),
                Enter(WATER, z),
                Reflect(-z),
                Leave(WATER, z),
                Reflect(z),
                Enter(WATER, z),
                tank[2],
                tank[3],
            ],
        ];
        let caustic: [&[Event]; 11] = [
            &[Reflect(z)],
            // Out by the face of before, after one reflection.
            &[Enter(GLASS, z), Reflect(-z), Leave(GLASS, z)],
            // Reflections between two panes, and at the side of a pane.
            &[pane.as_slice(), &[Reflect(z), Reflect(-z)], &pane].concat(),
            &[Enter(GLASS, z), Reflect(Vec3::X), Reflect(-Vec3::X), Leave(GLASS, -z)],
            // Into or out of a body.
            &[Enter(WATER, z)],
            &[Leave(WATER, -z)],
            // A wedge.
            &[Enter(GLASS, z), Leave(GLASS, -tilted)],
            // A tilted pane inside of a tank.
            &[&[Enter(WATER, z)], tilted_pane.as_slice(), &[Leave(WATER, -z)]].concat(),
            // Bodies that overlap.
            &[Enter(GLASS, z), Enter(WATER, z), Leave(GLASS, -z), Leave(WATER, -z)],
            &[Leave(GLASS, z), Enter(GLASS, -z)],
            &[Reflect(z), pane[0], pane[1]],
        ];
        for (paths, expected) in [(straight.as_slice(), true), (caustic.as_slice(), false)] {
            for (index, path) in paths.iter().enumerate() {
                assert_eq!(class(path.iter().copied()), expected, "path {index}");
                assert_eq!(class(reversed(path)), expected, "path {index}, from the other end");
            }
        }
    }

    #[test]
    fn curved_faces_are_caustic_also_where_their_normals_are_parallel() {
        let mut path = StraightPath::default();
        let curved =
            SurfaceInteraction { geometric_normal: Vec3::new(0.05, 0.0, 1.0).normalize(), ..face(GLASS, Vec3::Z) };
        path.transmit(&curved, true);
        assert!(path.is_caustic());
        let mut rounded = StraightPath::default();
        let in_a_file =
            SurfaceInteraction { geometric_normal: Vec3::new(1e-4, 0.0, 1.0).normalize(), ..face(GLASS, Vec3::Z) };
        rounded.transmit(&in_a_file, true);
        assert!(!rounded.is_caustic() && rounded.open_normal() == Some(Vec3::Z));
    }
}
