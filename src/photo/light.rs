//! Photometric lights: a light of the scene in physical units.
//!
//! [`PhotometricLight`] is the only conversion from a [`Light`] to physics; the path tracer, the z-buffer renderer, the
//! preview, the light meter and the editor's read-outs repack it.
//!
//! To add an emitter, add a variant to [`EmitterShape`] and its arms in `photo/emitter.rs`. A measured luminous intensity
//! distribution is part of the [`Beam`]. To add another distribution by formula, add a variant to
//! [`super::emitter::IntensityDistribution`] in the same file. The compiler then reports one missing arm per renderer:
//! `TracedLight::new` (`raytrace/lights/traced_light.rs`), `RasterLights::add` (`raster/lights.rs`), `gpu_light`
//! (`preview/lights/light_table.rs`); and, for a new shape only, `TracedLight`'s sampling, `LightBounds::of`
//! (`raytrace/lights/light_bounds.rs`), `irradiance_per_color` (`preview/lights/environment.rs`), `add_emitters`
//! (`preview/geometry/draw_list.rs`) and the read-out `on_axis` (`editor/document/readout.rs`).

use super::beam::{self, Beam};
use super::emitter::{EmitterShape, IntensityDistribution};
use super::environment_light::EnvironmentLight;
use super::light_color::light_rgb;
use super::measured_beam::MeasuredBeam;
use crate::scene::{Assets, Camera, Emitter, IntensityTable, Light, Modifier, Output, Scene};
use glam::{Affine3A, Quat, Vec3};
use std::sync::Arc;

/// The output of a light with its dial and the losses of modifier and gel, in the quantity in which it is stated. The unit is a
/// photometric one for continuous light and the same with seconds for flash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Strength {
    /// Luminous flux of the bare emitter, lm; or lm s.
    Flux(f32),
    /// Luminous intensity on the axis, cd; or cd s. Of a measured light, its largest intensity.
    AxialIntensity(f32),
    /// Illuminance normal to a sun's direction, or on a plane that faces half of a surround, lx.
    Illuminance(f32),
}

impl Strength {
    /// Converts a light's power. The flux that a grid or a snoot cuts off beside the axis is not subtracted.
    pub fn new(light: &Light) -> Self {
        let dial = (light.power.dial_stops - light.color.loss_stops()).exp2() * transmittance(&light.modifier);
        match light.power.output {
            Output::Lumens(flux) => Strength::Flux(flux * dial),
            Output::Candela(intensity) => Strength::AxialIntensity(intensity * dial),
            Output::LuxAt { lux, distance_m } => Strength::AxialIntensity(lux * distance_m * distance_m * dial),
            Output::Lux(lux) => Strength::Illuminance(lux * dial),
            Output::FlashWs { energy_ws, efficacy_lm_s_per_ws } => {
                Strength::Flux(energy_ws * efficacy_lm_s_per_ws * dial)
            }
            // A guide number is stated for C = 250 lux s at ISO 100: H(1 m) = 2.5 GN^2.
            Output::FlashGuideNumber(guide_number) => {
                Strength::AxialIntensity(2.5 * guide_number * guide_number * dial)
            }
        }
    }
}

/// A light of the scene in physical units.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotometricLight {
    /// Shape of the emitter, with the luminous intensity distribution of a point source.
    pub shape: EmitterShape,
    /// Rigid frame: right, up, back (the light shines along -Z), and the centre of the emitter.
    pub world_from_light: Affine3A,
    /// Angular transmission of the modifier, times the measured distribution; none where all directions are alike.
    pub beam: Option<Beam>,
    /// Luminance and colour by direction of a surround with an environment map.
    pub environment: Option<EnvironmentLight>,
    /// Output.
    pub strength: Strength,
    /// Linear RGB of luminance 1, relative to the camera's white balance.
    pub tint: Vec3,
    /// Time by which its luminance counts in the exposure, seconds: the shutter for continuous light, 1 for flash.
    pub exposure_time_s: f32,
    /// Flash; continuous light otherwise.
    pub is_flash: bool,
    /// True if camera rays see the emitter.
    pub visible_to_camera: bool,
    /// Switched on.
    pub on: bool,
}

impl PhotometricLight {
    /// Converts a light of a scene, whose measured distribution is among the assets.
    pub fn new(scene: &Scene, assets: &Assets, light: &Light) -> Self {
        let photometric = Self::in_frame(light, assets.intensity_table(light), scene.light_frame(light), &scene.camera);
        let environment = assets.environment(light).map(|map| EnvironmentLight::new(map, light.roll_deg));
        PhotometricLight { environment, ..photometric }
    }

    /// Converts a light with a given measured distribution and frame.
    pub fn in_frame(
        light: &Light,
        table: Option<Arc<IntensityTable>>,
        world_from_light: Affine3A,
        camera: &Camera,
    ) -> Self {
        let table = table.filter(|_| !light.emitter.is_infinite());
        let shape = match light.emitter {
            // The measured distribution takes the place of the cone
            Emitter::Spot { .. } if table.is_some() => EmitterShape::Point(IntensityDistribution::Isotropic),
            ref emitter => EmitterShape::new(emitter),
        };
        let measured = table.map(|table| MeasuredBeam::new(table, &light.emitter));
        PhotometricLight {
            shape,
            world_from_light,
            beam: Beam::with_measured(&light.modifier, measured),
            environment: None,
            strength: Strength::new(light),
            tint: light_rgb(&light.color, camera.white_balance_k),
            exposure_time_s: integration_time_s(&light.power.output, camera),
            is_flash: light.power.output.is_flash(),
            visible_to_camera: light.visible_to_camera,
            on: light.on,
        }
    }

    /// Returns the sun of its environment map as a light of its own; none without such a map.
    pub fn sun_of_environment(&self) -> Option<PhotometricLight> {
        let sun = self.environment.as_ref()?.sun()?;
        let Strength::Illuminance(lux) = self.strength else { return None };
        Some(PhotometricLight {
            shape: EmitterShape::Sun { half_angle_rad: sun.half_angle_rad },
            world_from_light: Affine3A::from_quat(Quat::from_rotation_arc(Vec3::Z, sun.direction)),
            environment: None,
            strength: Strength::Illuminance(lux * sun.illuminance_part),
            tint: self.tint * sun.color,
            ..self.clone()
        })
    }

    /// Returns the centre of the emitter, metres.
    pub fn position(&self) -> Vec3 {
        self.world_from_light.translation.into()
    }

    /// Returns the unit direction in which it shines, in world space.
    pub fn axis(&self) -> Vec3 {
        -Vec3::from(self.world_from_light.matrix3.z_axis)
    }

    /// Returns the luminous intensity on the axis, cd (cd s for flash); 0 for distant lights. Of a measured light it is
    /// the largest intensity, to which [`Beam::transmission`] is relative.
    pub fn axial_intensity(&self) -> f32 {
        self.axial(self.strength)
    }

    /// Returns the measured distribution.
    pub fn measured(&self) -> Option<&MeasuredBeam> {
        self.beam.as_ref()?.measured.as_ref()
    }

    /// Returns axial intensity over flux, 1/sr; none for distant lights. The flux of a measured light is that of its
    /// file, whatever the shape of its emitter.
    pub fn intensity_per_flux(&self) -> Option<f32> {
        match self.measured() {
            Some(measured) => Some(1.0 / measured.table().solid_angle_sr()),
            None => self.shape.intensity_per_flux(),
        }
    }

    /// Returns the illuminance of a distant light, lx; 0 for others.
    pub fn illuminance(&self) -> f32 {
        if let Strength::Illuminance(lux) = self.strength { lux } else { 0.0 }
    }

    /// Returns the axial intensity, cd, or the illuminance of a distant light, lx; with seconds for flash.
    pub fn axial_intensity_or_illuminance(&self) -> f32 {
        if self.shape.is_distant() { self.illuminance() } else { self.axial_intensity() }
    }

    /// Returns the luminous flux that leaves the modifier, lm (lm s for flash); 0 for distant lights.
    pub fn flux(&self) -> f32 {
        let bare = self.intensity_per_flux().map_or(0.0, |per_flux| self.axial_intensity() / per_flux);
        bare * beam::transmitted_flux_fraction(&self.shape, self.beam.as_ref())
    }

    fn axial(&self, strength: Strength) -> f32 {
        let in_place = self.measured().map_or(1.0, |measured| measured.tilt_factor(self.axis()));
        in_place
            * match strength {
                Strength::Flux(flux) => flux * self.intensity_per_flux().unwrap_or(0.0),
                Strength::AxialIntensity(intensity) => intensity,
                Strength::Illuminance(_) => 0.0,
            }
    }
}

/// Returns the output of a light over an earlier one of it; exactly 1 where it did not change. Both outputs of a light
/// with a photometric file must be in one quantity, flux or intensity: their ratio is then that of any distribution.
pub fn output_ratio(light: &Light, earlier: Strength) -> f32 {
    let now = Strength::new(light);
    let per_flux = EmitterShape::new(&light.emitter).intensity_per_flux().unwrap_or(0.0);
    let axial = |strength| match strength {
        Strength::Illuminance(amount) | Strength::AxialIntensity(amount) => amount,
        Strength::Flux(flux) => flux * per_flux,
    };
    if now == earlier { 1.0 } else { axial(now) / axial(earlier) }
}

/// Returns the luminous intensity of a light on its axis, or the largest of a measured one, cd (cd s for flash); dial,
/// modifier and gel included, without the tilt of the lamp. 0 for distant lights.
pub fn axial_intensity(light: &Light, table: Option<&Arc<IntensityTable>>) -> f32 {
    // Straight down, where the output of a lamp is measured
    let down = Affine3A::from_rotation_x(-0.5 * std::f32::consts::PI);
    PhotometricLight::in_frame(light, table.cloned(), down, &Camera::default()).axial_intensity()
}

/// Returns the transmittance of a modifier's cloth, dish and scrim, the same in all directions, 0 to 1.
pub fn transmittance(modifier: &Modifier) -> f32 {
    (-(modifier.loss_stops + modifier.scrim_stops)).exp2()
}

/// Returns the time by which a light counts in the exposure, seconds: the shutter for continuous light, 1 for flash
/// (whose unit holds the seconds: lm s, cd s, lux s).
pub fn integration_time_s(output: &Output, camera: &Camera) -> f32 {
    if output.is_flash() { 1.0 } else { camera.shutter_s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cone, Emitter, Gel};

    #[test]
    fn the_output_ratio_follows_the_dial_in_every_unit() {
        let cone = Cone { inner_deg: 20.0, outer_deg: 40.0 };
        let spot = Emitter::Spot { inner_deg: cone.inner_deg, outer_deg: cone.outer_deg };
        let cases = [
            (spot, Output::Lumens(800.0)),
            (Emitter::RoundPanel { diameter_m: 0.9 }, Output::FlashGuideNumber(40.0)),
            (Emitter::Sun { angular_diameter_deg: 0.5 }, Output::Lux(20_000.0)),
        ];
        for (emitter, output) in cases {
            let mut light = Light::new(emitter, output);
            let before = Strength::new(&light);
            assert_eq!(output_ratio(&light, before), 1.0);
            light.power.dial_stops = -1.0;
            assert!((output_ratio(&light, before) - 0.5).abs() < 1e-6, "{emitter:?}");
        }
    }

    #[test]
    fn a_mounted_gel_takes_its_loss_and_a_compensated_one_none() {
        let mut light = Light::new(Emitter::RoundPanel { diameter_m: 0.9 }, Output::Lumens(1000.0));
        let bare = axial_intensity(&light, None);
        light.color.gel = Gel::Mired(159.0);
        assert!((axial_intensity(&light, None) / bare - (-0.85_f32).exp2()).abs() < 1e-6);
        light.color.gel_loss_counts = false;
        assert_eq!(axial_intensity(&light, None), bare);
    }

    #[test]
    fn a_beam_cuts_flux_and_leaves_the_axis() {
        let scene = Scene::default();
        let mut light = Light::new(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, Output::Lumens(1000.0));
        let bare = PhotometricLight::new(&scene, &Assets::default(), &light);
        assert!((bare.flux() - 1000.0).abs() < 0.01 && bare.beam.is_none());
        light.modifier.grid_deg = Some(40.0);
        let gridded = PhotometricLight::new(&scene, &Assets::default(), &light);
        assert_eq!(gridded.axial_intensity(), bare.axial_intensity());
        assert!(gridded.flux() < 0.2 * bare.flux(), "{} lm", gridded.flux());
    }
}
