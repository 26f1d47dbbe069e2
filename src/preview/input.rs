//! The input of a preview picture: scene, camera, overlay and options.

use super::channel::{Channel, Gloss};
use crate::photo::irradiance_grid::IrradianceGrid;
use crate::scene::{Assets, CameraFrame, LightId, ObjectId, Scene};
use glam::{Affine3A, Vec2, Vec3};

/// Everything that a preview picture depends on.
#[derive(Clone, Debug)]
pub struct PreviewInput<'a> {
    /// The studio.
    pub scene: &'a Scene,
    /// Its meshes and textures.
    pub assets: &'a Assets,
    /// The camera: the scene's or the editor's own.
    pub frame: CameraFrame,
    /// Picture size in pixels, clamped to 1 and to the device's largest texture.
    pub size: (u32, u32),
    /// Traced bounced light, which replaces the estimate of it.
    pub bounced_light: Option<&'a IrradianceGrid>,
    /// Gizmos and outlines over the picture.
    pub overlay: Overlay,
    /// Shadows, estimates, channel and quality.
    pub options: Options,
}

impl<'a> PreviewInput<'a> {
    /// Returns the view of the scene's camera without overlay.
    pub fn camera_view(scene: &'a Scene, assets: &'a Assets, size: (u32, u32)) -> Self {
        let aspect = size.0.max(1) as f32 / size.1.max(1) as f32;
        PreviewInput {
            scene,
            assets,
            frame: scene.camera_frame(aspect),
            size,
            bounced_light: None,
            overlay: Overlay::default(),
            options: Options::default(),
        }
    }
}

impl PreviewInput<'_> {
    /// Returns true if the picture has the work light.
    pub(crate) fn has_work_light(&self) -> bool {
        self.overlay.work_light && self.options.channel == Channel::Lit && is_dark(self.scene)
    }

    /// Returns the camera of the sample: turned by less than half a pixel along each axis.
    pub(crate) fn sample_frame(&self) -> CameraFrame {
        if self.options.sample == 0 {
            return self.frame;
        }
        let offset_px = sample_point(self.options.sample) - 0.5;
        let pixel = 2.0 * self.frame.half_extent / Vec2::new(self.size.0.max(1) as f32, self.size.1.max(1) as f32);
        let [right, down] = (offset_px * pixel).to_array().map(f32::atan);
        let turn = Affine3A::from_rotation_y(-right) * Affine3A::from_rotation_x(-down);
        CameraFrame { world_from_camera: self.frame.world_from_camera * turn, ..self.frame }
    }
}

/// Returns true if no light of the scene is on.
pub fn is_dark(scene: &Scene) -> bool {
    scene.lights.iter().all(|light| !light.on)
}

/// Returns point number `index` of the sequence R2 (Roberts 2018), from (0.5, 0.5) on: 0 to 1 along each axis.
pub(crate) fn sample_point(index: u32) -> Vec2 {
    const STEP: Vec2 = Vec2::new(0.754_877_7, 0.569_840_3);
    (Vec2::splat(0.5) + STEP * index as f32).fract()
}

/// A thing that can be clicked and selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pick {
    /// An object of the scene.
    Object(ObjectId),
    /// A light of the scene.
    Light(LightId),
    /// The scene's camera.
    Camera,
}

/// Gizmos and outlines over the picture. The default has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Draws a metre grid on the floor.
    pub grid: bool,
    /// Draws the gizmos of the lights.
    pub light_gizmos: bool,
    /// Draws the scene's camera with the frame of a picture of this aspect (width / height).
    pub camera_gizmo: Option<f32>,
    /// Things with a selection outline.
    pub selection: Vec<Pick>,
    /// The thing under the pointer, which has a faint outline.
    pub hovered: Option<Pick>,
    /// Scene-linear colour of the background.
    pub void_color: Vec3,
    /// Shows a studio in which no light is on in an even work light.
    pub work_light: bool,
}

impl Overlay {
    /// Returns true if a thing is selected.
    pub fn selects(&self, thing: Pick) -> bool {
        self.selection.contains(&thing)
    }
}

/// Shadows, estimates, channel and quality of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Draws shadows of objects.
    pub shadows: bool,
    /// Adds bounced light: [`PreviewInput::bounced_light`], or an estimate: in a room, ambient light from the lights'
    /// total flux and the mean reflectance; without one, light bounced from the backdrops to the subjects. Without it
    /// the picture has direct light alone.
    pub bounce_estimate: bool,
    /// Reflects walls and backdrops in chrome and glass, as a box of six uniform faces.
    pub environment_estimate: bool,
    /// Culls each light beyond the radius at which it falls under 1/256 of display white, so that many lights stay
    /// cheap.
    pub light_radius: bool,
    /// Draft quality while something moves. On a CPU rasteriser the lighting pass shades one pixel in nine (one in 16
    /// under more than two panels or eight lights, one in 25 under more than 24) and upsamples the result. GPUs ignore
    /// it.
    pub draft: bool,
    /// Number of the sample of a still picture. Samples 0, 1, 2 ... of one view, drawn one after the other, are averaged:
    /// each is through other points of the pixels and has other strands. Sample 0 is through the pixels' centres.
    pub sample: u32,
    /// Draws the overlay alone on a transparent picture, premultiplied, to be composited over a picture from elsewhere.
    /// Depth and ids are drawn for occlusion and picking.
    pub overlay_alone: bool,
    /// The displayed channel.
    pub channel: Channel,
    /// Shows this light alone.
    pub only_light: Option<LightId>,
    /// The specular model.
    pub gloss: Gloss,
    /// Width and height of a shadow map, texels.
    pub shadow_resolution: u32,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            shadows: true,
            bounce_estimate: true,
            environment_estimate: true,
            light_radius: true,
            draft: false,
            sample: 0,
            overlay_alone: false,
            channel: Channel::Lit,
            only_light: None,
            gloss: Gloss::Ggx,
            shadow_resolution: 1024,
        }
    }
}

impl Options {
    /// Returns options for direct light without estimates, comparable with the path tracer's `direct` method.
    pub fn direct_only() -> Self {
        Options { bounce_estimate: false, environment_estimate: false, ..Self::default() }
    }
}
