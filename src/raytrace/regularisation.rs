//! Path regularisation: gloss that a path meets after a diffuse bounce is blurred (Kaplanyan and Dachsbacher 2013, "Path
//! Space Regularization for Holistic and Robust Light Transport"; pbrt-v4's `regularize`).
//!
//! The gloss of a ball reflects its lamps onto the floor. Of the paths that leave a point of the floor few meet the ball
//! where it does, and bring much light: among things of plastic that is three quarters of the noise.
//! A rougher gloss is met at more points and brings less at each. The blurred gloss reflects as much as the material's
//! own towards every direction, the base is as it was, and what the camera sees directly, in mirrors or in other gloss
//! is sharp: what changes is where such reflections fall, not how much there is of them. Metal, glass, fibres and
//! layered materials stay as they are.
//!
//! The blur decreases from pass to pass, so that a picture converges to that without. The roughness falls as the inverse
//! cube root of the number of samples: the square of the error, which is as the roughness to the power of 2.8 among
//! things of plastic, then falls as the variance does.

use super::bsdf::{BlurredGloss, TracedMaterial};
use super::plan::BLURRED_ROUGHNESS;
use super::render_scene::RenderScene;
use super::sample_pass::SamplePass;
use std::sync::Arc;

/// Samples per pixel from which on it is blurred less.
const FIRST_SAMPLES: f32 = 64.0;
/// Solid angle for which a path's last sample stands, sr, from which on it may meet blurred gloss: that of a matte
/// surface is pi and more.
const MIN_SOLID_ANGLE: f32 = 1.0;

/// The materials of a scene whose gloss is blurred, for one pass.
#[derive(Debug)]
pub struct BlurredMaterials {
    /// Roughness to which smoother gloss is blurred.
    roughness: f32,
    /// By the index of the material; none where nothing changes.
    materials: Vec<Option<TracedMaterial>>,
}

impl BlurredMaterials {
    /// Blurs the gloss of a scene's materials for a pass.
    pub fn new(scene: &RenderScene, pass: SamplePass) -> Self {
        let roughness = roughness_of(pass);
        let mut known: Vec<Arc<BlurredGloss>> = Vec::new();
        let materials = scene.materials.iter().map(|material| {
            material.has_gloss_below(roughness).then(|| {
                let gloss = known.iter().find(|gloss| gloss.ior() == material.ior()).cloned();
                let gloss = gloss.unwrap_or_else(|| {
                    known.push(Arc::new(BlurredGloss::new(material.ior(), roughness)));
                    known[known.len() - 1].clone()
                });
                material.with_blurred_gloss(&gloss)
            })
        });
        BlurredMaterials { roughness, materials: materials.collect() }
    }

    /// Returns a blurred material and its roughness for a path whose last sample stands for a solid angle, sr; none
    /// where nothing changes.
    pub fn material(&self, index: u32, sample_solid_angle: f32) -> Option<(&TracedMaterial, f32)> {
        let is_blurred = sample_solid_angle >= MIN_SOLID_ANGLE;
        let material = if is_blurred { self.materials[index as usize].as_ref() } else { None };
        material.map(|material| (material, self.roughness))
    }
}

/// Returns the roughness to which gloss is blurred in a pass.
fn roughness_of(pass: SamplePass) -> f32 {
    let samples = (pass.first_sample + pass.samples) as f32;
    BLURRED_ROUGHNESS * (FIRST_SAMPLES / samples.max(FIRST_SAMPLES)).cbrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::Picture;
    use crate::raytrace::test_pictures::{blocks, mean};
    use crate::raytrace::{RenderControl, Settings, Shortcut, prepare, render};
    use crate::scene::{
        Aim, Assets, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Scene, Shape, Transform,
    };
    use glam::Vec3;
    use std::ops::ControlFlow;

    fn plastic(color: f32, roughness: f32) -> Material {
        Material { base_color: [color; 3], roughness, ..Material::default() }
    }

    /// A glossy ball on a dark floor, which reflects a panel onto it.
    fn studio() -> Scene {
        let object = |id, position, shape, material| Object {
            id: ObjectId(id),
            transform: Transform::at(position),
            material,
            ..Object::new(format!("Thing {id}"), shape)
        };
        let floor = Shape::Box { size_m: Vec3::new(4.0, 0.1, 4.0) };
        let panel = Light {
            id: LightId(3),
            position: Vec3::new(-0.4, 1.6, 1.2),
            aim: Aim::Point(Vec3::new(0.0, 0.4, 0.0)),
            ..Light::new(Emitter::RectPanel { width_m: 0.6, height_m: 0.6 }, Output::Lumens(8000.0))
        };
        let camera = Camera {
            position: Vec3::new(0.0, 1.2, 2.6),
            aim: Aim::Point(Vec3::new(0.0, 0.2, 0.2)),
            ..Camera::default()
        };
        Scene {
            camera,
            objects: vec![
                object(1, Vec3::new(0.0, -0.05, 0.0), floor, plastic(0.4, 0.7)),
                object(2, Vec3::new(0.0, 0.4, 0.0), Shape::Sphere { radius_m: 0.4 }, plastic(0.3, 0.1)),
            ],
            lights: vec![panel],
            ..Scene::default()
        }
    }

    /// Returns the scene with and without regularisation.
    fn both(scene: &Scene) -> [RenderScene; 2] {
        let [blurred, mut sharp] = [0; 2].map(|_| prepare(scene, &Assets::default()).unwrap());
        sharp.set_plan(sharp.plan().clone().without(Shortcut::Regularisation));
        [blurred, sharp]
    }

    fn picture(prepared: &RenderScene, scene: &Scene, spp: u32, seed: u32) -> Picture {
        let settings = Settings { width: 36, height: 24, spp, seed, ..Settings::default() };
        render(prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(())).develop(scene)
    }

    #[test]
    fn light_that_gloss_throws_has_less_noise_and_falls_nearly_where_it_did() {
        let scene = studio();
        let [blurred, sharp] = both(&scene);
        assert!(blurred.plan().regularisation);
        let reference = picture(&sharp, &scene, 4096, 9);
        // Root mean square of the errors of blocks of so many pixels, relative to the reference
        let error = |prepared, spp, seed, side| {
            let (values, right) = (blocks(&picture(prepared, &scene, spp, seed), side), blocks(&reference, side));
            let least = 0.1 * mean(&right);
            let errors = values.iter().zip(&right).map(|(value, right)| (value - right) / right.hypot(least));
            mean(&errors.map(|error| error * error).collect::<Vec<_>>()).sqrt()
        };
        let [ours, theirs] = [&blurred, &sharp].map(|prepared| error(prepared, 16, 1, 1));
        let [early, late] = [64, 1024].map(|spp| error(&blurred, spp, 2, 6));
        let ratio = mean(&blocks(&picture(&blurred, &scene, 256, 3), 1)) / mean(&blocks(&reference, 1));
        assert!(ours < 0.9 * theirs, "{ours} against {theirs} at 16 samples");
        assert!(early < 0.02, "{early}");
        assert!(
            late < 0.01 && late < 0.7 * early,
            "{late} after {early}: what is left after 64 samples goes away, too"
        );
        assert!((ratio - 1.0).abs() < 0.003, "{ratio}");
    }

    #[test]
    fn gloss_is_blurred_after_diffuse_bounces_alone_and_less_with_every_pass() {
        let [scene, _] = both(&studio());
        let blur = |first_sample, samples| BlurredMaterials::new(&scene, SamplePass { first_sample, samples });
        let early = blur(0, 16);
        let (floor, ball) = (0, 1);
        let matte = std::f32::consts::PI;
        assert_eq!(early.material(ball, matte).map(|(_, roughness)| roughness), Some(BLURRED_ROUGHNESS));
        assert!(early.material(floor, matte).is_none(), "it is as rough as that");
        assert!(early.material(ball, 0.0).is_none(), "seen by the camera or in a mirror");
        assert!(early.material(ball, 0.2).is_none(), "seen in gloss");
        let roughnesses = [(0, 16), (48, 16), (240, 16), (1008, 16), (65_000, 536)]
            .map(|(first, samples)| blur(first, samples).material(ball, matte).map_or(0.0, |(_, roughness)| roughness));
        for (roughness, right) in roughnesses.into_iter().zip([0.5, 0.5, 0.315, 0.198, 0.0]) {
            assert!((roughness - right).abs() < 0.001, "{roughnesses:?}: at last, it is sharper than the ball");
        }
    }

    #[test]
    fn metal_glass_and_pictures_with_hair_or_skin_keep_their_gloss() {
        let with = |material: Material| {
            let mut scene = studio();
            scene.objects[1].material = material;
            prepare(&scene, &Assets::default()).unwrap().plan().regularisation
        };
        let glossy = plastic(0.4, 0.1);
        assert!(with(glossy.clone()));
        assert!(!with(Material { metallic: 1.0, ..glossy.clone() }));
        assert!(!with(Material { transmission: 1.0, ..glossy.clone() }));
        assert!(!with(plastic(0.4, 0.8)));
        assert!(!with(crate::scene::MaterialPreset::SkinLight.material()));
    }
}
