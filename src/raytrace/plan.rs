//! The render plan: the parts of the full model that a scene needs, with the reasons.

use super::bsdf::TracedMaterial;
use super::lens::Lens;
use super::lights::TracedLight;
use crate::math::simd::LANES;
use crate::scene::{Alpha, TextureSlot};
use std::fmt;

/// Part of the light after which further bounces are cut.
const NEGLIGIBLE: f32 = 1.0 / 512.0;
/// Paths from the first non-specular vertex, which share the path up to it. Most noise is that of indirect light.
/// Variance times seconds at 16 samples a pixel is the same with eight on plastic and in a matte room with a cache, whose
/// first picture takes 1.6 times as long then; with mirrors and glass, whose noise is theirs, it is 1.25 times as much.
const SPLIT_FACTOR: u32 = 4;
/// The same where each path samples one of many lights: variance times seconds is 0.8 of that of four paths under 60.
const SPLIT_FACTOR_WITH_MANY_LIGHTS: u32 = 8;
/// The paths that leave a vertex are sampled at once, one a lane.
const _: () = assert!(SPLIT_FACTOR_WITH_MANY_LIGHTS as usize <= LANES);
/// Paths from the first non-specular vertex where there is hair or skin: most noise is that of the first vertices (which
/// fibre, where a walk comes out, which of two surfaces in a pixel). Variance times rays at 4 samples a pixel, against
/// two paths: 0.70 to 0.80 in the five studios three_point, rembrandt, high_key, group and butterfly; 1.13 to 1.5 in
/// scenes without hair and skin.
const NO_SPLIT: u32 = 1;
/// Largest reflectance from which on an irradiance cache may pay.
const MIN_CACHED_ALBEDO: f32 = 0.5;
/// Roughness to which regularisation blurs smoother gloss in the first passes.
pub const BLURRED_ROUGHNESS: f32 = 0.5;
/// Maximum depth in the whitest room: what the largest reflectance (0.999) needs. Russian roulette ends most paths long
/// before; a lower limit would darken white rooms (at 64, one of 0.95 by 4 %).
const MAX_DEPTH: u32 = 6300;
/// Maximum number of lights that are all sampled at the first hit.
const MAX_LIGHTS_AT_FIRST_HIT: usize = 6;
/// Depth for refraction, beyond that of the largest reflectance.
const REFRACTION_DEPTH: u32 = 8;

/// The shortcuts of the tracer for a scene. A function of the scene alone.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderPlan {
    /// Rays after the first hit may hit emitters: there are area lights or emissive surfaces.
    pub has_area_emitters: bool,
    /// Surfaces refract.
    pub refraction: bool,
    /// Light scatters under surfaces.
    pub subsurface: bool,
    /// Normal maps, or the flat bases of domes, tilt shading normals.
    pub normal_maps: bool,
    /// Brushed surfaces need their tangents.
    pub tangents: bool,
    /// Rays pass masked or blended surfaces.
    pub coverage: bool,
    /// The lens has an aperture.
    pub lens: bool,
    /// All lights are sampled at the first hit, rather than one by its importance.
    pub sample_all_lights: bool,
    /// Caustics come from photons.
    pub photons: bool,
    /// Where paths stay bright, light on matte surfaces after a bounce comes from an irradiance cache.
    pub irradiance_cache: bool,
    /// Paths are regularised: gloss that they meet after a diffuse bounce is blurred.
    pub regularisation: bool,
    /// Number of paths from the first non-specular vertex.
    pub split_factor: u32,
    /// Maximum number of scattering events of a path.
    pub max_depth: u32,
    /// One reason per line.
    pub reasons: Vec<String>,
}

/// A part of the full model that a plan leaves out, or a cheaper technique that it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortcut {
    /// No emitter hits after the first hit.
    NoEmitterHits,
    /// No refraction.
    NoRefraction,
    /// No walks under surfaces.
    NoSubsurface,
    /// No lens samples.
    Pinhole,
    /// All lights are sampled at the first hit.
    AllLights,
    /// The maximum depth follows from the largest reflectance.
    LimitedDepth,
    /// Several paths share the path to the first non-specular vertex.
    PathSplitting,
    /// Caustics come from photons.
    Photons,
    /// Light on matte surfaces after a bounce comes from an irradiance cache.
    IrradianceCache,
    /// Gloss that paths meet after a diffuse bounce is blurred.
    Regularisation,
}

impl Shortcut {
    /// All shortcuts.
    pub const ALL: [Shortcut; 10] = [
        Shortcut::NoEmitterHits,
        Shortcut::NoRefraction,
        Shortcut::NoSubsurface,
        Shortcut::Pinhole,
        Shortcut::AllLights,
        Shortcut::LimitedDepth,
        Shortcut::PathSplitting,
        Shortcut::Photons,
        Shortcut::IrradianceCache,
        Shortcut::Regularisation,
    ];

    /// Name on the chart.
    pub fn label(self) -> &'static str {
        match self {
            Shortcut::NoEmitterHits => "no emitter hits",
            Shortcut::NoRefraction => "no refraction",
            Shortcut::NoSubsurface => "no walks under surfaces",
            Shortcut::Pinhole => "no lens samples",
            Shortcut::AllLights => "every light at the first hit",
            Shortcut::LimitedDepth => "depth from the largest reflectance",
            Shortcut::PathSplitting => "path splitting at the first surface",
            Shortcut::Photons => "caustics from photons",
            Shortcut::IrradianceCache => "bounced light from a cache",
            Shortcut::Regularisation => "blurred gloss after a bounce",
        }
    }
}

impl RenderPlan {
    /// The plan with one shortcut undone.
    pub fn without(mut self, shortcut: Shortcut) -> Self {
        match shortcut {
            Shortcut::NoEmitterHits => self.has_area_emitters = true,
            Shortcut::NoRefraction => self.refraction = true,
            Shortcut::NoSubsurface => self.subsurface = true,
            Shortcut::Pinhole => self.lens = true,
            Shortcut::AllLights => self.sample_all_lights = false,
            Shortcut::LimitedDepth => self.max_depth = MAX_DEPTH,
            Shortcut::PathSplitting => self.split_factor = 1,
            Shortcut::Photons => self.photons = false,
            Shortcut::IrradianceCache => self.irradiance_cache = false,
            Shortcut::Regularisation => self.regularisation = false,
        }
        self
    }

    /// The plan without what blurs light: photons, cache and regularisation. For references.
    pub fn without_blur(self) -> Self {
        self.without(Shortcut::Photons).without(Shortcut::IrradianceCache).without(Shortcut::Regularisation)
    }

    /// Derives the plan from a scene's materials, lights, lens and number of strands.
    pub fn new(materials: &[TracedMaterial], lights: &[TracedLight], lens: &Lens, strands: usize) -> Self {
        let mut reasons = Vec::new();

        // Emitter hits
        let has_area_lights = lights.iter().any(|light| !light.is_delta());
        let has_area_emitters = has_area_lights || materials.iter().any(TracedMaterial::is_emissive);
        reasons.push(match (lights.is_empty(), has_area_lights) {
            (true, _) => "no light is on: only glowing surfaces are traced".to_owned(),
            (false, true) => "area lights: emitter hits and light sampling, weighted (MIS)".to_owned(),
            (false, false) => "point, spot and sharp sun only: no emitter hits, no MIS".to_owned(),
        });

        // Refraction and lens
        let refraction = materials.iter().any(TracedMaterial::transmits);
        reasons.push(if refraction {
            "glass: paths refract and continue through it".to_owned()
        } else {
            "no glass: no refraction".to_owned()
        });
        let subsurface = materials.iter().any(|material| material.extinction_per_m().is_some());
        reasons.push(if subsurface {
            "skin or wax: paths walk under the surface".to_owned()
        } else {
            "nothing soft under its surface: no walks".to_owned()
        });
        let has_relief = |m: &TracedMaterial| m.texture(TextureSlot::Normal).is_some() || m.dome.is_some();
        let normal_maps = materials.iter().any(has_relief);
        if normal_maps {
            reasons.push("normal maps or domes: shading normals are tilted".to_owned());
        }
        let tangents = materials.iter().any(TracedMaterial::is_brushed);
        if tangents {
            reasons.push("brushed surfaces: highlights lie across their grooves".to_owned());
        }
        let coverage = materials.iter().any(|material| material.coverage != Alpha::Opaque);
        reasons.push(if coverage {
            "masked or blended surfaces: rays look up whether a surface is there".to_owned()
        } else {
            "all surfaces are wholly there: no alpha".to_owned()
        });
        let has_aperture = lens.has_aperture();
        reasons.push(if has_aperture {
            "depth of field: rays start on the lens".to_owned()
        } else {
            "pinhole: no lens samples".to_owned()
        });
        reasons.extend(lens.breathing());

        // Hair
        if strands > 0 {
            reasons.push(format!(
                "{strands} strands of hair: light passes through them and scatters from strand to strand"
            ));
        }

        // Caustics
        let sampled = sampled_lights(lights);
        let photons = sampled > 0 && materials.iter().any(TracedMaterial::is_caustic_caster);
        reasons.push(if photons {
            "mirrors or clear glass: caustics from photons".to_owned()
        } else {
            "neither mirror nor clear glass under a light: no photons".to_owned()
        });

        // Light sampling
        let sample_all_lights = sampled <= MAX_LIGHTS_AT_FIRST_HIT;
        reasons.push(match sampled {
            0 => "no light to sample".to_owned(),
            1 => "one light: no light selection".to_owned(),
            n if sample_all_lights => {
                format!("{n} lights: each is sampled; at later hits than the first, one shadow ray serves all")
            }
            n => format!("{n} lights: one is sampled at each hit, by importance"),
        });

        // Depth and path splitting
        let albedo = materials.iter().map(TracedMaterial::max_albedo).fold(0.0, f32::max);
        let max_depth = depth_for(albedo) + if refraction { REFRACTION_DEPTH } else { 0 };
        reasons.push(format!("largest reflectance {albedo:.2}: less than 1/512 is left after {max_depth} bounces"));
        let irradiance_cache = albedo >= MIN_CACHED_ALBEDO;
        if irradiance_cache {
            reasons.push(
                "bright surfaces: where much light is left after a bounce, that of later ones comes from a cache"
                    .to_owned(),
            );
        }
        let split_factor = if strands > 0 || subsurface {
            NO_SPLIT
        } else if sample_all_lights || photons {
            SPLIT_FACTOR
        } else {
            SPLIT_FACTOR_WITH_MANY_LIGHTS
        };
        reasons.push(match split_factor {
            NO_SPLIT => {
                "hair or skin: the noise is that of the first surfaces, one path continues from them".to_owned()
            }
            paths => format!("indirect light is noisier than direct: {paths} paths from the first surface"),
        });
        // What hair and skin reflect after a bounce is less than their noise
        let is_glossy = materials.iter().any(|material| material.has_gloss_below(BLURRED_ROUGHNESS));
        let regularisation = is_glossy && split_factor > 1;
        if regularisation {
            reasons.push("gloss: blurred where light meets it after a bounce, less with every sample".to_owned());
        }
        RenderPlan {
            has_area_emitters,
            refraction,
            subsurface,
            normal_maps,
            tangents,
            coverage,
            lens: has_aperture,
            sample_all_lights,
            photons,
            irradiance_cache,
            regularisation,
            split_factor,
            max_depth,
            reasons,
        }
    }
}

/// Number of lights with light sampling.
fn sampled_lights(lights: &[TracedLight]) -> usize {
    lights.iter().filter(|light| light.is_sampled()).count()
}

/// Number of bounces after which less than 1/512 is left at this reflectance.
fn depth_for(albedo: f32) -> u32 {
    if albedo <= NEGLIGIBLE {
        return 1;
    }
    let bounces = (NEGLIGIBLE.ln() / albedo.min(0.999).ln()).ceil();
    (bounces as u32 + 1).clamp(2, MAX_DEPTH)
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

    /// The plan without any shortcut.
    fn full(plan: &RenderPlan) -> RenderPlan {
        Shortcut::ALL.into_iter().fold(plan.clone(), RenderPlan::without)
    }

    /// A ball in a room under a row of lights.
    fn studio(emitters: &[Emitter], ball: Material) -> Scene {
        let ball = Object {
            id: ObjectId(1),
            transform: Transform::at(Vec3::new(0.0, 1.0, 0.0)),
            material: ball,
            ..Object::new("Ball", Shape::Sphere { radius_m: 0.5 })
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

    /// Mean picture value, and its standard error from eight seeds.
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

    /// Compares the mean of the planned render with that of the full model.
    fn keeps_the_mean(scene: &Scene, most_error: f32) -> RenderPlan {
        let plan = prepare(scene, &Assets::default()).unwrap().plan;
        let ((ours, error), (full, full_error)) = (mean(scene, None), mean(scene, Some(full(&plan))));
        // The light of the bounces that are cut, and four standard errors (one false alarm in 10 000).
        let tolerance = NEGLIGIBLE * full + 4.0 * error.hypot(full_error);
        assert!((ours - full).abs() < tolerance, "{ours} for {full}, within {tolerance}\n{plan}");
        assert!(tolerance < most_error * full, "too noisy for a comparison: {tolerance} of {full}");
        plan
    }

    #[test]
    fn every_shortcut_keeps_the_mean_of_the_full_model() {
        let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
        let spot = Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 };
        for emitters in [[Emitter::Point, spot], [panel, Emitter::Sphere { radius_m: 0.05 }]] {
            let plan = keeps_the_mean(&studio(&emitters, Material::default()), 0.02);
            assert!(!plan.refraction && plan.sample_all_lights && plan.max_depth < MAX_DEPTH, "{plan}");
            assert!(plan.split_factor > 1);
            assert_eq!(plan.has_area_emitters, emitters[0] == panel);
        }
    }

    #[test]
    fn one_of_many_lights_per_path_keeps_the_mean_of_the_full_model() {
        let panel = Emitter::RectPanel { width_m: 0.2, height_m: 0.3 };
        let emitters: Vec<Emitter> = (0..80).map(|i| if i % 2 == 0 { panel } else { Emitter::Point }).collect();
        let plan = keeps_the_mean(&studio(&emitters, Material::default()), 0.02);
        assert!(!plan.sample_all_lights && plan.split_factor > 1);
    }

    #[test]
    fn photons_of_glass_and_mirrors_keep_the_mean_of_the_full_model() {
        let emitters = [Emitter::RectPanel { width_m: 0.8, height_m: 0.8 }, Emitter::Sphere { radius_m: 0.1 }];
        let glass = Material { transmission: 1.0, roughness: 0.0, base_color: [0.9; 3], ..Material::default() };
        let chrome = Material { metallic: 1.0, roughness: 0.0, base_color: [0.9; 3], ..Material::default() };
        for material in [glass, chrome] {
            let plan = keeps_the_mean(&studio(&emitters, material), 0.1);
            assert!(plan.photons && plan.split_factor > 1, "{plan}");
        }
    }

    #[test]
    fn darker_rooms_have_a_smaller_depth() {
        assert_eq!(depth_for(0.0), 1);
        assert_eq!(depth_for(0.18), 5);
        assert!(depth_for(0.5) < depth_for(0.8) && depth_for(0.95) > 120 && depth_for(1.0) <= MAX_DEPTH);
    }
}
