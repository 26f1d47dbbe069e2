//! Choices that commands carry: the central view, the handles, the live view and the way to place a light.

use crate::scene::LightId;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// What the middle of the window shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Centre {
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
pub enum Handle {
    /// Move.
    #[default]
    Move,
    /// Rotate.
    Turn,
    /// Scale.
    Size,
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
pub enum Side {
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

impl Side {
    /// All of them; the three with a key come first.
    pub const ALL: [Side; 6] = [Side::Top, Side::Front, Side::Right, Side::Back, Side::Left, Side::Bottom];

    /// Its name.
    pub fn label(self) -> &'static str {
        match self {
            Side::Top => "Top",
            Side::Front => "Front",
            Side::Right => "Right side",
            Side::Back => "Back",
            Side::Left => "Left side",
            Side::Bottom => "Below",
        }
    }

    /// Unit direction from the target to the eye.
    pub fn away(self) -> Vec3 {
        match self {
            Side::Top => Vec3::Y,
            Side::Front => Vec3::Z,
            Side::Right => Vec3::X,
            Side::Back => Vec3::NEG_Z,
            Side::Left => Vec3::NEG_X,
            Side::Bottom => Vec3::NEG_Y,
        }
    }

    /// Yaw and pitch, radians.
    pub fn angles(self) -> (f32, f32) {
        match self {
            Side::Top => (0.0, FRAC_PI_2),
            Side::Front => (0.0, 0.0),
            Side::Right => (FRAC_PI_2, 0.0),
            Side::Back => (PI, 0.0),
            Side::Left => (-FRAC_PI_2, 0.0),
            Side::Bottom => (0.0, -FRAC_PI_2),
        }
    }
}

/// What is put on the point of a surface that the pointer shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swing {
    /// The highlight: the mirror image of the light, as the camera sees it.
    Highlight,
    /// The light itself: it falls on the point straight on.
    Light,
    /// The shadow of the point that it is aimed at: of a nose on a cheek, of a head on the paper.
    Shadow,
}

impl Swing {
    /// All of them, in menu order.
    pub const ALL: [Swing; 3] = [Swing::Highlight, Swing::Light, Swing::Shadow];

    /// What a menu calls it.
    pub fn label(self) -> &'static str {
        match self {
            Swing::Highlight => "Place its highlight",
            Swing::Light => "Place its light",
            Swing::Shadow => "Place its shadow",
        }
    }

    /// What a tip says of it.
    pub fn tip(self) -> &'static str {
        match self {
            Swing::Highlight => "Drag over a face: the light swings round so that the camera sees its highlight there",
            Swing::Light => "Drag over a face: the light swings round so that it falls there straight on",
            Swing::Shadow => {
                "Drag to where the shadow of the point that it is aimed at shall fall: of a nose on a cheek, of a head on \
                 the paper"
            }
        }
    }

    /// What the mouse does, for a light of this name.
    pub fn hint(self, light: &str) -> String {
        let what = match self {
            Swing::Highlight => "where the camera shall see the highlight of",
            Swing::Light => "where straight light shall fall from",
            Swing::Shadow => "where the shadow of its aim shall fall from",
        };
        format!("Press or drag on a surface {what} {light}.    Esc ends")
    }
}
