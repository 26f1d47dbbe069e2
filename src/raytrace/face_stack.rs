//! The transmittance of clear faces, one behind the other, for unpolarised light.
//!
//! Faces that are parallel share their planes of polarisation, s and p, and are summed for each of both. Between groups
//! of parallel faces the polarisation is carried on as a Stokes vector. Reflections between parallel faces are summed by
//! adding one face after the other (Stokes 1862, "On the intensity of the light reflected from or transmitted through a
//! pile of plates"): always inside of a body, and between bodies where no other technique finds them.

use super::bsdf::TransmittedLight;
use super::straight_path::are_parallel;
use glam::Vec3;

/// A clear face on the way of light.
#[derive(Clone, Copy, Debug)]
pub struct ClearFace {
    /// Unit normal, on either side.
    pub normal: Vec3,
    /// Reflectances for s and p polarisation.
    pub reflectance: [f32; 2],
    /// Further factor on the transmitted light.
    pub transmission: Vec3,
}

/// Sums faces along a direction.
#[derive(Clone, Debug)]
pub struct FaceStack {
    direction: Vec3,
    /// Reflections between bodies are included.
    between_bodies: bool,
    /// What the groups before the last one transmit.
    light: TransmittedLight,
    group: Option<Group>,
}

/// Faces that are parallel.
#[derive(Clone, Debug)]
struct Group {
    normal: Vec3,
    /// For s and p polarisation.
    layers: [Layer; 2],
}

/// Parallel faces for one polarisation.
#[derive(Clone, Copy, Debug)]
struct Layer {
    transmittance: Vec3,
    /// Reflectance from behind.
    reflectance: Vec3,
}

impl FaceStack {
    /// No faces along a unit direction.
    pub fn new(direction: Vec3, between_bodies: bool) -> Self {
        FaceStack { direction, between_bodies, light: TransmittedLight::UNPOLARISED, group: None }
    }

    /// Adds a face behind a gap of this transmittance, which is inside of a body or not.
    pub fn push(&mut self, face: &ClearFace, gap: Vec3, is_inside: bool) {
        let with_reflections = is_inside || self.between_bodies;
        if let Some(group) = self.group.as_mut().filter(|group| are_parallel(group.normal, face.normal)) {
            for (layer, reflectance) in group.layers.iter_mut().zip(face.reflectance) {
                layer.push(reflectance, face.transmission, gap, with_reflections);
            }
            return;
        }
        self.close_group();
        self.light.absorb(gap);
        let layer = |reflectance: f32| Layer {
            transmittance: face.transmission * (1.0 - reflectance),
            reflectance: Vec3::splat(reflectance),
        };
        self.group = Some(Group { normal: face.normal, layers: face.reflectance.map(layer) });
    }

    /// Returns the transmittance of all faces and of a gap behind them.
    pub fn transmittance(mut self, gap: Vec3) -> Vec3 {
        self.close_group();
        self.light.intensity() * gap
    }

    fn close_group(&mut self) {
        if let Some(Group { normal, layers }) = self.group.take() {
            self.light.transmit(normal, self.direction, layers.map(|layer| layer.transmittance));
        }
    }
}

impl Layer {
    fn push(&mut self, reflectance: f32, transmission: Vec3, gap: Vec3, with_reflections: bool) {
        let passed = transmission * (1.0 - reflectance);
        let before = if with_reflections { self.reflectance * gap * gap } else { Vec3::ZERO };
        let series = (Vec3::ONE - before * reflectance).max(Vec3::splat(f32::EPSILON)).recip();
        self.transmittance *= gap * passed * series;
        self.reflectance = Vec3::splat(reflectance) + before * passed * passed * series;
    }
}

#[cfg(test)]
mod tests {
    use super::super::bsdf::fresnel;
    use super::*;

    fn faces(cos: f32, n: f32, normal: Vec3, count: usize) -> Vec<ClearFace> {
        let (s, p) = fresnel::amplitudes(cos, n);
        vec![ClearFace { normal, reflectance: [s * s, p * p], transmission: Vec3::ONE }; count]
    }

    #[test]
    fn parallel_faces_give_the_pile_of_plates() {
        // Stokes 1862: m faces of reflectance R transmit (1 - R) / (1 + (m - 1) R), for each polarisation.
        for cos in [1.0_f32, 0.5, 0.2, 0.05] {
            for count in [2, 4, 10] {
                let mut stack = FaceStack::new(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos), true);
                faces(cos, 1.5, Vec3::Z, count).iter().for_each(|face| stack.push(face, Vec3::ONE, false));
                let (s, p) = fresnel::amplitudes(cos, 1.5);
                let pile = |r: f32| (1.0 - r) / (1.0 + (count - 1) as f32 * r);
                let expected = 0.5 * (pile(s * s) + pile(p * p));
                let ours = stack.transmittance(Vec3::ONE).x;
                assert!((ours - expected).abs() < 2e-6, "{count} faces, cos {cos}: {ours} for {expected}");
            }
        }
    }

    #[test]
    fn without_reflections_faces_transmit_the_product_for_each_polarisation() {
        let cos = 0.3_f32;
        let mut stack = FaceStack::new(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos), false);
        faces(cos, 1.5, Vec3::Z, 4).iter().for_each(|face| stack.push(face, Vec3::splat(0.9), false));
        let (s, p) = fresnel::amplitudes(cos, 1.5);
        let expected = 0.5 * ((1.0 - s * s).powi(4) + (1.0 - p * p).powi(4)) * 0.9_f32.powi(5);
        assert!((stack.transmittance(Vec3::splat(0.9)).x - expected).abs() < 1e-6);
    }

    #[test]
    fn bodies_include_their_inner_reflections_and_not_those_between_them() {
        let cos = 0.4_f32;
        let mut stack = FaceStack::new(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos), false);
        for (index, face) in faces(cos, 1.5, Vec3::Z, 4).iter().enumerate() {
            stack.push(face, Vec3::ONE, index % 2 == 1);
        }
        let (s, p) = fresnel::amplitudes(cos, 1.5);
        let two_panes = |r: f32| ((1.0 - r) / (1.0 + r)).powi(2);
        let expected = 0.5 * (two_panes(s * s) + two_panes(p * p));
        assert!((stack.transmittance(Vec3::ONE).x - expected).abs() < 1e-6);
    }

    #[test]
    fn crossed_polarisers_block() {
        // At Brewster's angle and many faces only p passes; the second pile stands at right angles.
        let brewster = 1.5_f32.atan();
        let direction = Vec3::Z;
        let tilted = |axis: Vec3| Vec3::Z * brewster.cos() + axis * brewster.sin();
        let pile = |second: Vec3| {
            let mut stack = FaceStack::new(direction, false);
            for normal in [tilted(Vec3::X), tilted(second)] {
                faces(brewster.cos(), 1.5, normal, 60).iter().for_each(|face| stack.push(face, Vec3::ONE, false));
            }
            stack.transmittance(Vec3::ONE).x
        };
        assert!(pile(Vec3::Y) < 1e-3);
        assert!((pile(Vec3::NEG_X) - 0.5).abs() < 1e-3, "{}", pile(Vec3::NEG_X));
        let diagonal = pile(Vec3::new(1.0, 1.0, 0.0).normalize());
        assert!((diagonal - 0.25).abs() < 1e-3, "Malus: {diagonal}");
    }
}
