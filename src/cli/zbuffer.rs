//! The CPU z-buffer on the command line: `preview --cpu` and `render --method zbuffer`.

use super::failure::Failure;
use super::frame_times::FrameTimeReport;
use super::percentile::percentile;
use crate::io::{self, Loaded, PictureInfo};
use crate::photo::Picture;
use crate::raster::{Framebuffer, Rasterizer, Shading};
use glam::{Affine3A, Quat, Vec3};
use std::path::Path;
use std::time::Instant;

/// Angle by which the camera turns from one timed frame to the next, radians.
const TURN_RAD: f32 = 0.004;
/// Distance from the camera to the point that it turns about, metres.
const PIVOT_M: f32 = 2.0;

/// Draws a studio with `side` x `side` subpixels per pixel. Returns the picture and the number of triangles.
pub fn picture(loaded: &Loaded, (width, height): (u32, u32), side: u32) -> (Picture, u64) {
    let camera = loaded.scene.camera_frame(width as f32 / height as f32);
    let mut rasterizer = Rasterizer::new(&loaded.scene, &loaded.assets);
    let fine = (width * side, height * side);
    let mut drawing = Framebuffer::default();
    rasterizer.draw(&loaded.scene, &loaded.assets, &camera, fine, Shading::default(), &mut drawing);
    let picture = if side == 1 { drawing.picture } else { reduced(&drawing.picture, side) };
    (picture, rasterizer.triangle_count())
}

/// Returns the means over squares of `side` x `side` pixels.
fn reduced(fine: &Picture, side: u32) -> Picture {
    let mut picture = Picture::new(fine.width / side, fine.height / side);
    let weight = 1.0 / (side * side) as f32;
    for (i, pixel) in (0_u32..).zip(picture.rgb.iter_mut()) {
        let (x, y) = (i % picture.width * side, i / picture.width * side);
        let sum: Vec3 = (0..side * side).map(|k| Vec3::from(fine.at(x + k % side, y + k / side))).sum();
        *pixel = (sum * weight).into();
    }
    picture
}

/// Draws and writes the preview.
pub fn write(loaded: &Loaded, size: (u32, u32), output: &Path) -> Result<(), Failure> {
    let (picture, _) = picture(loaded, size, 1);
    Ok(io::export_picture(output, &picture, &PictureInfo::new(&loaded.scene, "zbuffer", 1, 0))?)
}

/// Measures frame times with a turning camera.
pub fn time(loaded: &Loaded, (width, height): (u32, u32), frames: u32) -> FrameTimeReport {
    let mut rasterizer = Rasterizer::new(&loaded.scene, &loaded.assets);
    let mut drawing = Framebuffer::default();
    let camera = loaded.scene.camera_frame(width as f32 / height as f32);
    let pivot = camera.world_from_camera.transform_point3(Vec3::NEG_Z * PIVOT_M);
    let mut times: Vec<f64> = (0..=frames)
        .map(|step| {
            let mut moved = camera;
            let turn = Affine3A::from_quat(Quat::from_rotation_y(step as f32 * TURN_RAD));
            moved.world_from_camera = Affine3A::from_translation(pivot)
                * turn
                * Affine3A::from_translation(-pivot)
                * camera.world_from_camera;
            let began = Instant::now();
            rasterizer.draw(&loaded.scene, &loaded.assets, &moved, (width, height), Shading::default(), &mut drawing);
            std::hint::black_box(&drawing);
            began.elapsed().as_secs_f64() * 1e3
        })
        .skip(1)
        .collect();
    times.sort_by(f64::total_cmp);
    FrameTimeReport {
        scene: loaded.scene.name.clone(),
        width,
        height,
        adapter: format!("z-buffer on {} threads", rayon::current_num_threads()),
        triangles: Some(rasterizer.triangle_count()),
        lights: loaded.scene.lights.iter().filter(|light| light.on).count(),
        light_radius: false,
        draft: false,
        frames: times.len(),
        median_ms: percentile(&times, 50),
        ninety_percent_ms: percentile(&times, 90),
        full_median_ms: percentile(&times, 50),
    }
}
