//! Choices that commands carry: the central view, the handles, the live view and the way to place a light.

use crate::scene::{CellContent, LightId, ObjectId, Tank, VariantId};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// The view in the middle of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum CentralView {
    /// The studio from a free viewpoint.
    #[default]
    Studio,
    /// The camera's frame.
    Camera,
    /// The view along the axis of a light.
    Light(LightId),
    /// The rendered picture.
    Picture,
}

/// The kind of transform handles in the viewport.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum HandleMode {
    /// Move.
    #[default]
    Move,
    /// Rotate.
    Rotate,
    /// Scale.
    Scale,
    /// The joints of a figure; other things move.
    Pose,
}

/// The renderer of the live view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LiveMode {
    /// The GPU preview: immediate, with estimated indirect light and reflections.
    #[default]
    Quick,
    /// The path tracer: as the picture will be; the noise clears within moments.
    True,
}

/// How the shown picture is compared with that of another variant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CompareMode {
    /// Not at all.
    #[default]
    Off,
    /// The other picture on the left of a line that can be dragged.
    Wipe,
    /// Both pictures, the other one on the left.
    SideBySide,
    /// The difference in stops.
    Difference,
}

/// A comparison with the picture of a variant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// How.
    pub mode: CompareMode,
    /// The other variant; none for the first that has a picture.
    pub with: Option<VariantId>,
}

/// A side of the room from which the studio is viewed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ViewSide {
    /// From above; the back of the room is up.
    Top,
    /// From the front (+Z).
    Front,
    /// From the right (+X).
    Right,
    /// From the back.
    Back,
    /// From the left.
    Left,
    /// From below.
    Bottom,
}

impl ViewSide {
    /// All sides; the three with a shortcut come first.
    pub const ALL: [ViewSide; 6] =
        [ViewSide::Top, ViewSide::Front, ViewSide::Right, ViewSide::Back, ViewSide::Left, ViewSide::Bottom];

    /// Returns the name in menus.
    pub fn label(self) -> &'static str {
        match self {
            ViewSide::Top => "Top",
            ViewSide::Front => "Front",
            ViewSide::Right => "Right side",
            ViewSide::Back => "Back",
            ViewSide::Left => "Left side",
            ViewSide::Bottom => "Below",
        }
    }

    /// Returns the unit direction from the target to the eye, world space.
    pub fn away(self) -> Vec3 {
        match self {
            ViewSide::Top => Vec3::Y,
            ViewSide::Front => Vec3::Z,
            ViewSide::Right => Vec3::X,
            ViewSide::Back => Vec3::NEG_Z,
            ViewSide::Left => Vec3::NEG_X,
            ViewSide::Bottom => Vec3::NEG_Y,
        }
    }

    /// Returns yaw and pitch, radians.
    pub fn angles(self) -> (f32, f32) {
        match self {
            ViewSide::Top => (0.0, FRAC_PI_2),
            ViewSide::Front => (0.0, 0.0),
            ViewSide::Right => (FRAC_PI_2, 0.0),
            ViewSide::Back => (PI, 0.0),
            ViewSide::Left => (-FRAC_PI_2, 0.0),
            ViewSide::Bottom => (0.0, -FRAC_PI_2),
        }
    }
}

/// The feature of a light's effect that is put on the surface point under the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceLightBy {
    /// The specular highlight, as the camera sees it.
    Highlight,
    /// The light at normal incidence.
    Light,
    /// The shadow of the aim point: of a nose on a cheek, of a head on the paper.
    Shadow,
}

impl PlaceLightBy {
    /// All features, in menu order.
    pub const ALL: [PlaceLightBy; 3] = [PlaceLightBy::Highlight, PlaceLightBy::Light, PlaceLightBy::Shadow];

    /// Returns the label in menus.
    pub fn label(self) -> &'static str {
        match self {
            PlaceLightBy::Highlight => "Place its highlight",
            PlaceLightBy::Light => "Place its light",
            PlaceLightBy::Shadow => "Place its shadow",
        }
    }

    /// Returns the tooltip.
    pub fn tip(self) -> &'static str {
        match self {
            PlaceLightBy::Highlight => {
                "Drag over a face: the light swings round so that the camera sees its highlight there"
            }
            PlaceLightBy::Light => "Drag over a face: the light swings round so that it falls there straight on",
            PlaceLightBy::Shadow => {
                "Drag to where the shadow of the point that it is aimed at shall fall: of a nose on a cheek, of a head on \
                 the paper"
            }
        }
    }

    /// Returns the line of help in the view, for a light of this name.
    pub fn hint(self, light: &str) -> String {
        let what = match self {
            PlaceLightBy::Highlight => "where the camera shall see the highlight of",
            PlaceLightBy::Light => "where straight light shall fall from",
            PlaceLightBy::Shadow => "where the shadow of its aim shall fall from",
        };
        format!("Press or drag on a surface {what} {light}.    Esc ends")
    }
}

/// A brush for a tank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brush {
    /// The tank.
    pub tank: ObjectId,
    /// What it fills cells with.
    pub content: CellContent,
    /// Its radius, metres.
    pub radius_m: f32,
}

impl Brush {
    /// Returns the brush that a tank has at first: water, two cells wide.
    pub fn new(id: ObjectId, tank: &Tank) -> Self {
        Brush { tank: id, content: CellContent::Water, radius_m: 2.0 * tank.cell_m }
    }
}
