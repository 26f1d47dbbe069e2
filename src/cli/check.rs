//! `catchlight check SCENE`: reports what is wrong or odd with a studio, and the light on faces.

use super::failure::Failure;
use super::{input, terminal};
use crate::jobs;
use crate::raytrace::{GeometryCache, RenderControl};
use crate::scene::{Assets, Scene};
use anyhow::Context;
use std::path::PathBuf;

/// Arguments of `check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Studio: a .ron file, or the name of a shipped one.
    scene: PathBuf,
}

/// Prints a summary and the patterns on faces; fails if the studio cannot be used.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let loaded = input::load_studio(&arguments.scene)?;
    let scene = &loaded.scene;
    let verdict = match loaded.warnings.len() {
        0 => "nothing odd".to_owned(),
        1 => "1 warning".to_owned(),
        n => format!("{n} warnings"),
    };
    terminal::result(format_args!(
        "{}: {} objects, {} lights, {verdict}",
        if scene.name.is_empty() { "studio" } else { &scene.name },
        scene.objects.len(),
        scene.lights.len(),
    ));
    print_patterns(scene, &loaded.assets)
}

/// Prints the portrait lighting pattern on the face of every person in view, and the catchlights.
fn print_patterns(scene: &Scene, assets: &Assets) -> Result<(), Failure> {
    let faces = jobs::check_patterns(
        scene,
        assets,
        &jobs::faces_in_view(scene),
        &GeometryCache::default(),
        &RenderControl::new(),
    );
    for face in faces.context("the light on faces")?.unwrap_or_default() {
        let name = scene.object(face.object).map_or("", |object| object.name.as_str());
        terminal::result(format_args!("{name}: {}; catchlights: {}", face.lighting, face.catchlight_line()));
    }
    Ok(())
}
