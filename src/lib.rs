//! Catchlight plans the light of a photo studio: arrange it, see it live, render the picture the camera would take.

pub mod cli;
pub mod color;
pub mod math;
pub mod photo;
pub mod scene;

pub mod io;
pub mod mannequin;
#[cfg(feature = "gui")]
pub mod preview;
pub mod raytrace;

#[cfg(feature = "gui")]
pub mod editor;
