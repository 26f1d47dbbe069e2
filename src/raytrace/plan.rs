//! What a scene needs of the tracer, and why: "model no more than a scene needs".

use super::bsdf::TracedMaterial;
use super::lights::TracedLight;
use std::fmt;

/// Bounces are cut where what is left of the light falls under this share.
const NEGLIGIBLE: f32 = 1.0 / 512.0;
/// Ways on from the first surface that scatters widely, where bounced light is nearly all of the noise (points without
/// penumbra, caustics) or each way asks a light of its own: the way to the surface is paid once.
const MANY_WAYS: u32 = 4;
/// The same where direct light has noise of its own.
const FEW_WAYS: u32 = 2;
/// Never more bounces than this, however white the room: what the whitest surface (0.999) needs. Roulette ends most paths
/// long before; a lower limit would darken white rooms (at 64, one of 0.95 by 4 %).
const MAX_BOUNCES: u32 = 6300;
/// Up to this many lights, the first hit samples each of them.
const SAMPLE_ALL: usize = 6;

/// What the tracer does for this scene. Derived from the scene alone.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderPlan {
    /// Rays after the first hit may meet emitters: some light has a size, or a surface glows.
    pub emitters_have_size: bool,
    /// Surfaces refract.
    pub refraction: bool,
    /// The lens has an aperture.
    pub lens: bool,
    /// All lights are sampled at the first hit (otherwise one, chosen by what it gives there).
    pub sample_all_lights: bool,
    /// Photons bring the light that comes by mirrors and glass.
    pub photons: bool,
    /// Ways that are followed from the first surface that scatters widely.
    pub branches: u32,
    /// Scattering events a path at most.
    pub max_bounces: u32,
    /// A reason a line.
    pub reasons: Vec<String>,
}

/// Something of the full model that a plan leaves out, or does in a cheaper way, for its reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortcut {
    /// Rays do not look for emitters after the first hit.
    EmittersNotMet,
    /// No ray refracts.
    NoRefraction,
    /// Rays start at one point.
    Pinhole,
    /// No choice between lights at the first hit.
    EveryLight,
    /// Paths end at a depth that the largest reflectance gives.
    FewBounces,
    /// Several ways share the way to the first surface.
    SharedWay,
    /// Photons bring caustics to paths that would find them by luck.
    Photons,
}

impl Shortcut {
    /// All there are.
    pub const ALL: [Shortcut; 7] = [
        Shortcut::EmittersNotMet,
        Shortcut::NoRefraction,
        Shortcut::Pinhole,
        Shortcut::EveryLight,
        Shortcut::FewBounces,
        Shortcut::SharedWay,
        Shortcut::Photons,
    ];

    /// Its name on the chart.
    pub fn label(self) -> &'static str {
        match self {
            Shortcut::EmittersNotMet => "no rays towards emitters",
            Shortcut::NoRefraction => "no refraction",
            Shortcut::Pinhole => "no lens samples",
            Shortcut::EveryLight => "every light at the first hit",
            Shortcut::FewBounces => "depth from the largest reflectance",
            Shortcut::SharedWay => "several ways on from the first surface",
            Shortcut::Photons => "caustics from photons",
        }
    }
}

impl RenderPlan {
    /// The same plan with one shortcut undone.
    pub fn without(mut self, shortcut: Shortcut) -> Self {
        match shortcut {
            Shortcut::EmittersNotMet => self.emitters_have_size = true,
            Shortcut::NoRefraction => self.refraction = true,
            Shortcut::Pinhole => self.lens = true,
            Shortcut::EveryLight => self.sample_all_lights = false,
            Shortcut::FewBounces => self.max_bounces = MAX_BOUNCES,
            Shortcut::SharedWay => self.branches = 1,
            Shortcut::Photons => self.photons = false,
        }
        self
    }

    /// Looks at what is there.
    pub fn new(materials: &[TracedMaterial], lights: &[TracedLight], lens: bool) -> Self {
        let mut reasons = Vec::new();
        let glow = materials.iter().any(TracedMaterial::is_emissive);
        let sized_lights = lights.iter().any(|light| !light.is_delta());
        let emitters_have_size = sized_lights || glow;
        reasons.push(match (lights.is_empty(), sized_lights) {
            (true, _) => "no light is on: only glowing surfaces are traced".to_owned(),
            (false, true) => "some light has a size: lights are met by rays as well as sampled (MIS)".to_owned(),
            (false, false) => "point, spot and sharp sun only: no rays towards emitters, no MIS".to_owned(),
        });
        let refraction = materials.iter().any(TracedMaterial::transmits);
        reasons.push(if refraction {
            "glass: paths refract, and go on through it".to_owned()
        } else {
            "no glass: no refraction".to_owned()
        });
        reasons.push(if lens {
            "depth of field: rays start on the lens".to_owned()
        } else {
            "pinhole: no lens samples".to_owned()
        });
        let photons = sampled_lights(lights) > 0 && materials.iter().any(TracedMaterial::is_caustic_caster);
        reasons.push(if photons {
            "mirrors or clear glass: what they throw on surfaces is gathered from photons".to_owned()
        } else {
            "neither mirror nor clear glass under a light: no photons".to_owned()
        });
        let sampled = sampled_lights(lights);
        let sample_all_lights = sampled <= SAMPLE_ALL;
        reasons.push(match sampled {
            0 => "no light to choose from".to_owned(),
            1 => "one light: no choice between lights".to_owned(),
            n if sample_all_lights => format!("{n} lights: each is sampled at the first hit, one after it"),
            n => format!("{n} lights: one is chosen a hit, by what it gives there"),
        });
        let albedo = materials.iter().map(TracedMaterial::max_albedo).fold(0.0, f32::max);
        let max_bounces = bounces_for(albedo) + if refraction { 8 } else { 0 };
        reasons.push(format!("largest reflectance {albedo:.2}: at most {max_bounces} bounces leave less than 1/512"));
        let caustics = sized_lights && materials.iter().any(TracedMaterial::is_nearly_specular);
        let direct_is_noisy = sized_lights && sample_all_lights && !caustics;
        let branches = if direct_is_noisy { FEW_WAYS } else { MANY_WAYS };
        reasons.push(format!("bounced light is noisier than direct: {branches} ways on from the first surface"));
        RenderPlan { emitters_have_size, refraction, lens, sample_all_lights, photons, branches, max_bounces, reasons }
    }
}

/// Lights that are sampled by choosing points on them.
fn sampled_lights(lights: &[TracedLight]) -> usize {
    lights.iter().filter(|light| light.is_sampled()).count()
}

/// Bounces after which less than 1/512 is left at this reflectance.
fn bounces_for(albedo: f32) -> u32 {
    if albedo <= NEGLIGIBLE {
        return 1;
    }
    let bounces = (NEGLIGIBLE.ln() / albedo.min(0.999).ln()).ceil();
    (bounces as u32 + 1).clamp(2, MAX_BOUNCES)
}

impl fmt::Display for RenderPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.reasons.iter().try_for_each(|reason| writeln!(f, "- {reason}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{RenderControl, Settings, prepare, render};
    use crate::scene::{
        Aim, Assets, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Room, Scene, Shape, Transform,
    };
    use glam::Vec3;
    use std::ops::ControlFlow;

    /// Everything on.
    fn full(plan: &RenderPlan) -> RenderPlan {
        Shortcut::ALL.into_iter().fold(plan.clone(), RenderPlan::without)
    }

    /// A ball in a room under lights in a row.
    fn studio(emitters: &[Emitter], ball: Material) -> Scene {
        let ball = Object {
            id: ObjectId(1),
            name: "Ball".into(),
            transform: Transform { position: Vec3::new(0.0, 1.0, 0.0), ..Transform::default() },
            shape: Shape::Sphere { radius_m: 0.5 },
            material: ball,
            part_materials: Vec::new(),
            visible: true,
            locked: false,
        };
        let step = 3.0 / (emitters.len() - 1) as f32;
        let light = |(i, &emitter)| Light {
            id: LightId(2 + i as u32),
            name: format!("Light {i}"),
            position: Vec3::new(1.5 - step * i as f32, 2.5, 1.0),
            aim: Aim::Point(Vec3::Y),
            ..Light::new(emitter, Output::Lumens(8000.0))
        };
        let lights = emitters.iter().enumerate().map(light).collect();
        let camera = Camera { position: Vec3::new(0.0, 1.4, 3.0), aim: Aim::Point(Vec3::Y), ..Camera::default() };
        Scene { camera, room: Some(Room::default()), objects: vec![ball], lights, ..Scene::default() }
    }

    /// Mean picture value, and its standard error from the scatter of eight seeds.
    fn mean(scene: &Scene, plan: Option<RenderPlan>) -> (f32, f32) {
        let mut prepared = prepare(scene, &Assets::default()).unwrap();
        if let Some(plan) = plan {
            prepared.set_plan(plan);
        }
        let value = |seed| {
            let settings = Settings { width: 24, height: 16, spp: 64, seed, ..Settings::default() };
            let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
            let picture = film.develop(scene);
            picture.rgb.iter().flatten().sum::<f32>() / (3 * picture.rgb.len()) as f32
        };
        let values: Vec<f32> = (0..8).map(value).collect();
        let mean = values.iter().sum::<f32>() / 8.0;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / 7.0;
        (mean, (variance / 8.0).sqrt())
    }

    /// Holds what is rendered as the scene is planned to the mean of the full model.
    fn keeps_the_mean(scene: &Scene, most_error: f32) -> RenderPlan {
        let plan = prepare(scene, &Assets::default()).unwrap().plan;
        let ((ours, error), (full, full_error)) = (mean(scene, None), mean(scene, Some(full(&plan))));
        // What the bounces that are cut off leave, and four standard errors (one false alarm in 10 000).
        let tolerance = NEGLIGIBLE * full + 4.0 * error.hypot(full_error);
        assert!((ours - full).abs() < tolerance, "{ours} for {full}, within {tolerance}\n{plan}");
        assert!(tolerance < most_error * full, "too noisy to say anything: {tolerance} of {full}");
        plan
    }

    #[test]
    fn every_shortcut_keeps_the_mean_of_the_full_model() {
        let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
        let spot = Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 };
        for emitters in [[Emitter::Point, spot], [panel, Emitter::Sphere { radius_m: 0.05 }]] {
            let plan = keeps_the_mean(&studio(&emitters, Material::default()), 0.02);
            assert!(!plan.refraction && plan.sample_all_lights && plan.max_bounces < MAX_BOUNCES, "{plan}");
            assert!(plan.branches > 1);
            assert_eq!(plan.emitters_have_size, emitters[0] == panel);
        }
    }

    #[test]
    fn one_of_many_lights_a_way_keeps_the_mean_of_the_full_model() {
        let panel = Emitter::RectPanel { width_m: 0.2, height_m: 0.3 };
        let emitters: Vec<Emitter> = (0..80).map(|i| if i % 2 == 0 { panel } else { Emitter::Point }).collect();
        let plan = keeps_the_mean(&studio(&emitters, Material::default()), 0.02);
        assert!(!plan.sample_all_lights && plan.branches > 1);
    }

    #[test]
    fn photons_of_glass_and_mirrors_keep_the_mean_of_the_full_model() {
        let emitters = [Emitter::RectPanel { width_m: 0.8, height_m: 0.8 }, Emitter::Sphere { radius_m: 0.1 }];
        let glass = Material { transmission: 1.0, roughness: 0.0, base_color: [0.9; 3], ..Material::default() };
        let chrome = Material { metallic: 1.0, roughness: 0.0, base_color: [0.9; 3], ..Material::default() };
        for material in [glass, chrome] {
            let plan = keeps_the_mean(&studio(&emitters, material), 0.1);
            assert!(plan.photons && plan.branches > 1, "{plan}");
        }
    }

    #[test]
    fn darker_rooms_need_fewer_bounces() {
        assert_eq!(bounces_for(0.0), 1);
        assert_eq!(bounces_for(0.18), 5);
        assert!(bounces_for(0.5) < bounces_for(0.8) && bounces_for(0.95) > 120 && bounces_for(1.0) <= MAX_BOUNCES);
    }
}
