//! The light buffer: photometric lights packed for the shaders in picture units (exposure, shutter and white balance
//! folded in), so that a shader's sum is the scene-linear pixel.

use super::intensity_tables::MAX_TABLES;
use crate::math::orthonormal_basis;
use crate::photo::EnvironmentLight;
use crate::photo::beam::Beam;
use crate::photo::emitter::{EmitterShape, IntensityDistribution};
use crate::photo::{MeasuredBeam, PhotometricLight, exposure};
use crate::scene::{Assets, Cone, IntensityTable, LightId, Material, Room, Scene};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// Maximum number of lights; further lights are not shown.
pub(crate) const MAX_LIGHTS: usize = 256;
/// Radiance below which a light is culled: 1/256 of display white.
const CULL_RADIANCE: f32 = 1.0 / 256.0;
/// Smallest side of a panel and radius of a sphere, metres, which keeps the luminance of a light without size finite.
const MIN_SIZE_M: f32 = 1e-3;

/// The kind of a `GpuLight`; the values are repeated in `light.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum LightKind {
    Point = 0,
    Spot = 1,
    Sphere = 2,
    Rect = 3,
    Disc = 4,
    Sun = 5,
}

/// A light in the uniform buffer; twin of `Light` in `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuLight {
    pub position: [f32; 3],
    pub kind: u32,
    /// Half width vector of a panel; unit otherwise.
    pub right: [f32; 3],
    /// Half angle of a spot's inner cone, radians.
    pub inner_rad: f32,
    /// Half height vector of a panel; unit otherwise.
    pub up: [f32; 3],
    /// Half angle of a spot's outer cone, radians.
    pub outer_rad: f32,
    /// Unit direction of emission.
    pub axis: [f32; 3],
    /// Radius of a sphere, metres; tangent of a sun's half angle.
    pub radius: f32,
    /// Intensity (point, spot), radiance (sphere, panels) or normal irradiance (sun), picture units.
    pub color: [f32; 3],
    /// Distance at which a white surface falls under 1/256 of display white, metres; 0 for a sun, which is never
    /// culled.
    pub cull_radius_m: f32,
    /// Half angles of the beam, radians: inner, outer, and the cutoff of a grid.
    pub beam_rad: [f32; 3],
    /// 0 if all directions are alike; else 1, and twice the layer of the measured distribution plus one, where there is
    /// one.
    pub has_beam: u32,
    /// Angles of the barn doors from the axis, radians: left, right, top, bottom.
    pub doors_rad: [f32; 4],
}

/// Angle of a cone, grid or door without effect, radians: beyond pi, and so large that the slope of a grid's falloff
/// vanishes.
const OPEN_RAD: f32 = 1e9;

/// Sets the angles of a modifier.
fn set_beam(gpu: &mut GpuLight, beam: &Beam) {
    let half = |full_deg: f32| (0.5 * full_deg).to_radians();
    let cone = beam.cone.map(|cone| [half(cone.inner_deg.min(cone.outer_deg)), half(cone.outer_deg)]);
    let [inner, outer] = cone.unwrap_or([OPEN_RAD; 2]);
    gpu.has_beam = 1;
    gpu.beam_rad = [inner, outer, beam.grid_deg.map_or(OPEN_RAD, half)];
    gpu.doors_rad = beam.doors.map_or([OPEN_RAD; 4], |doors| {
        [doors.left_deg, doors.right_deg, doors.top_deg, doors.bottom_deg].map(f32::to_radians)
    });
}

impl GpuLight {
    /// Returns the group of kinds that one loop of the lighting pass shades: 0 points, spots and suns, 1 spheres,
    /// 2 rectangles, 3 discs.
    pub fn kind_group(&self) -> usize {
        match self.kind {
            kind if kind == LightKind::Sphere as u32 => 1,
            kind if kind == LightKind::Rect as u32 => 2,
            kind if kind == LightKind::Disc as u32 => 3,
            _ => 0,
        }
    }

    /// Returns the area of a panel, or of a sphere's disc, m2.
    pub fn area_m2(&self) -> f32 {
        match self.kind_group() {
            2 => 4.0 * Vec3::from(self.right).length() * Vec3::from(self.up).length(),
            3 => PI * Vec3::from(self.right).length_squared(),
            _ => PI * self.radius * self.radius,
        }
    }

    /// Returns the half axes of the emitter that determine the penumbra: metres, for a sun tangents.
    pub fn softness(&self) -> Vec2 {
        match self.kind_group() {
            // The filter kernel is an ellipse: give it the area of the rectangle
            2 => Vec2::new(Vec3::from(self.right).length(), Vec3::from(self.up).length()) * (4.0 / PI).sqrt(),
            3 => Vec2::splat(Vec3::from(self.right).length()),
            _ => Vec2::splat(self.radius),
        }
    }
}

/// Directions of the mean of an environment map about another.
const CONE_RAYS: u32 = 64;

/// Ambient light, picture units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ambient {
    /// Irradiance from a surround.
    pub irradiance: Vec3,
    /// Irradiance from the bounces in a room, estimated.
    pub bounced: Vec3,
    /// Radiance of even surrounds.
    pub surround_radiance: Vec3,
    /// Radiance of the surrounds that are visible to the camera.
    pub void_radiance: Vec3,
}

/// The lights that are on, sorted by group.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightTable {
    pub lights: Vec<GpuLight>,
    /// Scene ids of `lights`.
    pub ids: Vec<LightId>,
    /// The photometric lights from which `lights` were packed.
    pub photometric: Vec<PhotometricLight>,
    /// The measured distributions of `lights`, in the order of the texture's layers.
    pub tables: Vec<Arc<IntensityTable>>,
    /// One past the last light of each group.
    pub ends: [u32; 4],
    pub ambient: Ambient,
    /// Environment maps, with the radiance of an even surround of their illuminance.
    pub environments: Vec<(EnvironmentLight, Vec3)>,
}

impl LightTable {
    /// Packs the lights of a scene, or one of them alone.
    pub fn new(scene: &Scene, assets: &Assets, bounce_estimate: bool, only: Option<LightId>) -> Self {
        let mut table = LightTable::default();
        let mut lights: Vec<(GpuLight, LightId, PhotometricLight)> = Vec::new();
        let mut flux = Vec3::ZERO;
        for light in scene.lights.iter().filter(|light| light.on && only.is_none_or(|id| id == light.id)) {
            let (id, light) = (light.id, PhotometricLight::new(scene, assets, light));
            if light.shape.is_distant() && scene.room.is_some() {
                // A closed room blocks suns and surrounds
                continue;
            }
            let scale = picture_scale(&light, scene);
            let Some(mut gpu) = gpu_light(&light, scale) else {
                // The sun of a map casts shadows, as a light of its own
                if let Some(sun) = light.sun_of_environment().filter(|_| lights.len() < MAX_LIGHTS) {
                    let packed = gpu_light(&sun, picture_scale(&sun, scene)).filter(is_usable);
                    lights.extend(packed.map(|gpu| (gpu, id, sun)));
                }
                table.add_surround(light, scale);
                continue;
            };
            if !is_usable(&gpu) || lights.len() == MAX_LIGHTS {
                continue;
            }
            if let Some(measured) = light.measured() {
                gpu.has_beam |= 2 * table.layer_of(measured.table());
            }
            flux += scale * light.flux();
            lights.push((gpu, id, light));
        }
        lights.sort_by_key(|(light, _, _)| light.kind_group());
        for (gpu, id, light) in lights {
            table.lights.push(gpu);
            table.ids.push(id);
            table.photometric.push(light);
        }
        table.ends =
            std::array::from_fn(|group| table.lights.partition_point(|light| light.kind_group() <= group) as u32);
        let maps = table.environments.iter().map(|(map, even)| map.mean_relative_radiance_without_sun() * *even);
        table.ambient.surround_radiance = table.ambient.irradiance / PI - maps.sum::<Vec3>();
        if let Some(room) = scene.room.as_ref().filter(|_| bounce_estimate) {
            table.ambient.bounced = bounced_irradiance(room, flux);
        }
        table
    }
}

impl LightTable {
    /// Adds a surround: an even one, or a map without its sun.
    fn add_surround(&mut self, light: PhotometricLight, scale: Vec3) {
        let mut irradiance = scale * light.illuminance();
        if let Some(environment) = light.environment {
            let mean = environment.mean_relative_radiance_without_sun();
            self.environments.push((environment, irradiance / PI));
            irradiance *= mean;
        }
        self.ambient.irradiance += irradiance;
        self.ambient.void_radiance += if light.visible_to_camera { irradiance / PI } else { Vec3::ZERO };
    }

    /// Returns the layer of a measured distribution plus one; 0 beyond [`MAX_TABLES`].
    fn layer_of(&mut self, table: &Arc<IntensityTable>) -> u32 {
        let known = self.tables.iter().position(|known| Arc::ptr_eq(known, table));
        let layer = known.unwrap_or(self.tables.len());
        if known.is_none() && layer < MAX_TABLES {
            self.tables.push(table.clone());
        }
        if layer < MAX_TABLES { layer as u32 + 1 } else { 0 }
    }

    /// Returns the radiance of surrounds and environment maps from a direction; of maps, the mean of a wide cone about it,
    /// for reflections in a box of six faces.
    pub fn surround_radiance(&self, direction: Vec3) -> Vec3 {
        let (u, v) = orthonormal_basis(direction);
        let around = |i: u32| {
            // A golden spiral over a cone of 45 degrees
            let height = 1.0 - 0.293 * (i as f32 + 0.5) / CONE_RAYS as f32;
            let turn = Vec2::from_angle(i as f32 * 2.399_963_2) * (1.0 - height * height).sqrt();
            (u * turn.x + v * turn.y + direction * height).normalize_or(direction)
        };
        let mean = |(map, even): &(EnvironmentLight, Vec3)| {
            (0..CONE_RAYS).map(|i| map.relative_radiance_without_sun(around(i))).sum::<Vec3>() * *even
                / CONE_RAYS as f32
        };
        self.ambient.surround_radiance + self.environments.iter().map(mean).sum::<Vec3>()
    }

    /// Returns true for the groups that have lights.
    pub fn groups_present(&self) -> [bool; 4] {
        let [delta, spheres, rects, discs] = self.ends;
        [delta > 0, spheres > delta, rects > spheres, discs > rects]
    }
}

/// Returns the picture value of one unit of a light, per channel.
pub(crate) fn picture_scale(light: &PhotometricLight, scene: &Scene) -> Vec3 {
    light.tint * exposure::pixel_per_cd_s_m2(scene) * light.exposure_time_s
}

/// Returns the picture value of a surface's emission.
pub(crate) fn emission(material: &Material, scene: &Scene) -> Vec3 {
    Vec3::from(material.emission_cd_m2) * exposure::pixel_per_cd_s_m2(scene) * scene.camera.shutter_s
}

/// Returns true if all values are finite and the light is not black.
fn is_usable(light: &GpuLight) -> bool {
    bytemuck::cast_slice::<GpuLight, f32>(std::slice::from_ref(light)).iter().all(|x| x.is_finite())
        && light.color.iter().any(|c| *c > 0.0)
}

/// Packs a light, scaled by the picture value of one unit of it; none for a surround.
fn gpu_light(light: &PhotometricLight, scale: Vec3) -> Option<GpuLight> {
    let axes = light.world_from_light.matrix3;
    let intensity = light.axial_intensity();
    let mut gpu = GpuLight {
        position: light.position().into(),
        right: Vec3::from(axes.x_axis).into(),
        up: Vec3::from(axes.y_axis).into(),
        axis: light.axis().into(),
        color: (scale * intensity).into(),
        beam_rad: [OPEN_RAD; 3],
        doors_rad: [OPEN_RAD; 4],
        ..GpuLight::zeroed()
    };
    let largest = intensity * light.measured().map_or(1.0, MeasuredBeam::largest_factor);
    gpu.cull_radius_m = (scale.max_element() * largest / (PI * CULL_RADIANCE)).max(0.0).sqrt();
    match light.shape {
        EmitterShape::Point(IntensityDistribution::Isotropic) => gpu.kind = LightKind::Point as u32,
        EmitterShape::Point(IntensityDistribution::Cone(Cone { inner_deg, outer_deg })) => {
            gpu.kind = LightKind::Spot as u32;
            gpu.outer_rad = (0.5 * outer_deg).to_radians();
            gpu.inner_rad = (0.5 * inner_deg.min(outer_deg)).to_radians();
        }
        EmitterShape::Sphere { radius_m } => {
            let radius = radius_m.max(MIN_SIZE_M);
            gpu.kind = LightKind::Sphere as u32;
            gpu.radius = radius;
            gpu.color = (scale * intensity / (PI * radius * radius)).into();
        }
        EmitterShape::Rect { half_size_m } => {
            panel(&mut gpu, LightKind::Rect, half_size_m.max(Vec2::splat(0.5 * MIN_SIZE_M)), scale * intensity);
        }
        EmitterShape::Disc { radius_m } => {
            panel(&mut gpu, LightKind::Disc, Vec2::splat(radius_m.max(0.5 * MIN_SIZE_M)), scale * intensity);
        }
        EmitterShape::Sun { half_angle_rad } => {
            gpu.kind = LightKind::Sun as u32;
            gpu.radius = half_angle_rad.clamp(0.0, 0.25 * PI).tan();
            gpu.color = (scale * light.illuminance()).into();
            gpu.cull_radius_m = 0.0;
        }
        EmitterShape::Surround => return None,
    }
    if let Some(beam) = &light.beam {
        set_beam(&mut gpu, beam);
    }
    Some(gpu)
}

/// Sets the kind, half axes and radiance of a panel.
fn panel(gpu: &mut GpuLight, kind: LightKind, half: Vec2, intensity: Vec3) {
    gpu.kind = kind as u32;
    gpu.right = (Vec3::from(gpu.right) * half.x).into();
    gpu.up = (Vec3::from(gpu.up) * half.y).into();
    gpu.color = (intensity / gpu.area_m2()).into();
}

/// Returns the bounced irradiance in a closed diffuse box, per channel: E = F r / (S (1 - r)) with the mean reflectance
/// r (integrating sphere).
fn bounced_irradiance(room: &Room, flux: Vec3) -> Vec3 {
    let size = room.size_m.max(Vec3::splat(0.1));
    let (floor, walls) = (size.x * size.z, 2.0 * size.y * (size.x + size.z));
    let surface = 2.0 * floor + walls;
    let albedo = |material: &Material| Vec3::from(material.base_color).clamp(Vec3::ZERO, Vec3::splat(0.98));
    let mean = (albedo(&room.floor) * floor + albedo(&room.ceiling) * floor + albedo(&room.walls) * walls) / surface;
    flux * mean / (surface * (Vec3::ONE - mean))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aim, Camera, Emitter, Light, Output};
    use glam::Affine3A;

    fn light(emitter: Emitter, output: Output) -> Light {
        Light { position: Vec3::Y * 2.0, aim: Aim::Point(Vec3::ZERO), ..Light::new(emitter, output) }
    }

    #[test]
    fn the_shutter_scales_continuous_light_and_not_flash() {
        let flash = light(Emitter::Point, Output::FlashWs { energy_ws: 100.0, efficacy_lm_s_per_ws: 40.0 });
        let lamp = light(Emitter::Point, Output::Lumens(1000.0));
        let scale = |light: &Light, shutter_s: f32| {
            let scene = Scene { camera: Camera { shutter_s, ..Camera::default() }, ..Scene::default() };
            picture_scale(&PhotometricLight::in_frame(light, None, Affine3A::IDENTITY, &scene.camera), &scene)
        };
        let (slow, fast) = (1.0 / 60.0, 1.0 / 120.0);
        assert_eq!(scale(&flash, slow), scale(&flash, fast));
        assert!((scale(&lamp, slow) / scale(&lamp, fast) - 2.0).abs().max_element() < 1e-6);
    }

    #[test]
    fn a_closed_box_has_the_tabulated_irradiance() {
        // light_and_camera.md: a 4 m cube with 10 000 lm.
        for (r, mean) in [(0.0, 104.17), (0.2, 130.21), (0.5, 208.33), (0.8, 520.83), (0.9, 1041.67)] {
            let paint = Material { base_color: [r; 3], ..Material::default() };
            let room = Room { size_m: Vec3::splat(4.0), floor: paint.clone(), walls: paint.clone(), ceiling: paint };
            // The table includes the direct light: 10 000 lm over 96 m2.
            let total = 10_000.0 / 96.0 + bounced_irradiance(&room, Vec3::splat(10_000.0)).x;
            assert!((total / mean - 1.0).abs() < 1e-4, "r = {r}: {total}");
        }
    }

    #[test]
    fn lights_that_are_off_are_left_out_and_lights_without_size_stay_finite() {
        let mut scene = Scene { lights: vec![light(Emitter::Point, Output::Lumens(1000.0))], ..Scene::default() };
        scene.lights[0].on = false;
        assert!(LightTable::new(&scene, &Assets::default(), true, None).lights.is_empty());
        scene.lights[0] = light(Emitter::RectPanel { width_m: 0.0, height_m: 0.0 }, Output::Lumens(1000.0));
        assert_eq!(LightTable::new(&scene, &Assets::default(), true, None).lights.len(), 1);
        scene.lights[0].power.dial_stops = f32::NAN;
        assert!(LightTable::new(&scene, &Assets::default(), true, None).lights.is_empty());
    }
}
