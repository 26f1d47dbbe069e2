//! Choices that commands carry: the central view, the handles, the live view and the way to place a light.

use crate::scene::LightId;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// What the middle of the window shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum CentralView {
    /// The studio from anywhere.
    #[default]
    Studio,
    /// What the camera frames.
    Camera,
    /// What a light sees along its axis.
    Light(LightId),
    /// The rendered picture.
    Picture,
}

/// What the handles in the viewport do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum HandleMode {
    /// Move.
    #[default]
    Move,
    /// Rotate.
    Rotate,
    /// Scale.
    Scale,
}

/// How the live view is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LiveMode {
    /// By the graphics card: at once, with bounced light and mirrors estimated.
    #[default]
    Quick,
    /// By the tracer: as the picture will be, out of grain within moments.
    True,
}

/// A side of the room that the studio is looked at from.
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
    /// All of them; the three with a key come first.
    pub const ALL: [ViewSide; 6] =
        [ViewSide::Top, ViewSide::Front, ViewSide::Right, ViewSide::Back, ViewSide::Left, ViewSide::Bottom];

    /// Its name.
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

    /// Unit direction from the target to the eye.
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

    /// Yaw and pitch, radians.
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

/// What is put on the point of a surface that the pointer shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceLightBy {
    /// The highlight: the mirror image of the light, as the camera sees it.
    Highlight,
    /// The light itself: it falls on the point straight on.
    Light,
    /// The shadow of the point that it is aimed at: of a nose on a cheek, of a head on the paper.
    Shadow,
}

impl PlaceLightBy {
    /// All of them, in menu order.
    pub const ALL: [PlaceLightBy; 3] = [PlaceLightBy::Highlight, PlaceLightBy::Light, PlaceLightBy::Shadow];

    /// What a menu calls it.
    pub fn label(self) -> &'static str {
        match self {
            PlaceLightBy::Highlight => "Place its highlight",
            PlaceLightBy::Light => "Place its light",
            PlaceLightBy::Shadow => "Place its shadow",
        }
    }

    /// What a tip says of it.
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

    /// What the mouse does, for a light of this name.
    pub fn hint(self, light: &str) -> String {
        let what = match self {
            PlaceLightBy::Highlight => "where the camera shall see the highlight of",
            PlaceLightBy::Light => "where straight light shall fall from",
            PlaceLightBy::Shadow => "where the shadow of its aim shall fall from",
        };
        format!("Press or drag on a surface {what} {light}.    Esc ends")
    }
}
