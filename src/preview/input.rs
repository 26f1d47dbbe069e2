//! What the preview is asked to show.

use super::channel::{Channel, Gloss};
use crate::scene::{Assets, CameraFrame, LightId, ObjectId, Scene};
use glam::Vec3;

/// Everything one preview picture depends on.
#[derive(Clone, Debug)]
pub struct PreviewInput<'a> {
    /// The studio.
    pub scene: &'a Scene,
    /// Its meshes and textures.
    pub assets: &'a Assets,
    /// What is framed: the scene's camera or the editor's own.
    pub frame: CameraFrame,
    /// Picture size in pixels; 0 is taken as 1, and too much as the device's largest.
    pub size: (u32, u32),
    /// What is drawn over the lit picture.
    pub overlay: Overlay,
    /// How the picture is lit.
    pub options: Options,
}

impl<'a> PreviewInput<'a> {
    /// What the scene's camera frames, with nothing drawn over it.
    pub fn camera_view(scene: &'a Scene, assets: &'a Assets, size: (u32, u32)) -> Self {
        let aspect = size.0.max(1) as f32 / size.1.max(1) as f32;
        PreviewInput {
            scene,
            assets,
            frame: scene.camera_frame(aspect),
            size,
            overlay: Overlay::default(),
            options: Options::default(),
        }
    }
}

/// Something a click can mean or a selection can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pick {
    /// An object of the scene.
    Object(ObjectId),
    /// A light of the scene.
    Light(LightId),
    /// The scene's camera.
    Camera,
}

/// What is drawn over the lit picture. The default draws nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Metre grid on the floor.
    pub grid: bool,
    /// Balls, cones and outlines where the lights are.
    pub light_gizmos: bool,
    /// Draws the scene's camera with the frame of a picture of this aspect (width / height).
    pub camera_gizmo: Option<f32>,
    /// Outlined things.
    pub selection: Vec<Pick>,
    /// The thing under the pointer, outlined faintly.
    pub hovered: Option<Pick>,
    /// Linear colour where there is nothing at all.
    pub void_color: Vec3,
}

impl Overlay {
    /// Whether something is selected.
    pub fn selects(&self, what: Pick) -> bool {
        self.selection.contains(&what)
    }
}

/// How the picture is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Shadows of objects.
    pub shadows: bool,
    /// Adds an estimate of bounced light: in a room, even light from the lights' total flux and the mean reflectance;
    /// without one, what the backdrops throw back at the subjects. Off, the picture holds direct light alone.
    pub bounce_estimate: bool,
    /// Walls and backdrops mirrored in chrome and glass as six even faces, so that they are not black.
    pub environment_estimate: bool,
    /// Leaves a light out where it falls under 1/256 of display white: in its place many lights cost little.
    pub light_radius: bool,
    /// While something moves: on a rasteriser that runs on the processor, lights one pixel in nine (under more than two
    /// panels or eight lights one in sixteen, under more than 24 one in 25) and spreads the light over the surfaces.
    /// Adapters with a card of their own take no notice.
    pub draft: bool,
    /// Draws only what lies over the picture, on nothing: transparent, colour times coverage. For a picture that comes
    /// from elsewhere. Depth and ids are there all the same, so that things hide each other and can be picked.
    pub overlay_alone: bool,
    /// What is shown at each pixel.
    pub channel: Channel,
    /// Leaves all other lights out.
    pub only_light: Option<LightId>,
    /// How surfaces shine.
    pub gloss: Gloss,
    /// Pixels along each side of a shadow map.
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
            overlay_alone: false,
            channel: Channel::Lit,
            only_light: None,
            gloss: Gloss::Ggx,
            shadow_resolution: 1024,
        }
    }
}

impl Options {
    /// Direct light alone, without estimates: what the tracer's `direct` method computes for matte surfaces.
    pub fn direct_only() -> Self {
        Options { bounce_estimate: false, environment_estimate: false, ..Self::default() }
    }
}
