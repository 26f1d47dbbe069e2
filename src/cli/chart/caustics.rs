//! `catchlight chart --caustics`: blur and error of caustics in close-ups, against a closed form.
//!
//! A bulb stands before an upright mirror. Its image lights a sharp-edged strip of the floor. Close-ups of the strip's far
//! edge, from straight above it, are compared with the illuminance of bulb and image.

use crate::cli::failure::Failure;
use crate::cli::terminal;
use crate::color::luminance;
use crate::photo::Picture;
use crate::raytrace::{self, RenderControl, Settings};
use crate::scene::{
    Aim, Assets, Camera, CameraFrame, Emitter, Focus, Light, LightId, Material, Object, ObjectId, Output, Scene, Shape,
    Transform,
};
use anyhow::Context;
use glam::{Vec2, Vec3};
use serde::Serialize;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::time::Instant;

/// Height of the mirror, metres, and width of a pixel, millimetres.
const CLOSE_UPS: [(f32, f32); 5] = [(0.5, 4.0), (0.5, 1.0), (0.5, 0.25), (0.5, 0.06), (0.02, 0.45)];
/// Position of the bulb; the mirror is the plane x = 0.
const BULB: Vec3 = Vec3::new(1.0, 1.5, 0.0);
/// Height of the camera over the floor, metres.
const CAMERA_M: f32 = 1.0;
/// Picture size.
const SIZE: (u32, u32) = (160, 120);
/// Distance from an edge up to which its blur is measured, pixels.
const EDGE_PX: f32 = 40.0;

/// A close-up with a number of samples.
#[derive(Debug, Serialize)]
struct CausticRow {
    /// Width of the strip of light, millimetres.
    strip_mm: f32,
    /// Width of a pixel, millimetres.
    pixel_mm: f32,
    /// Samples per pixel.
    spp: u32,
    /// Time of the render and of the measurements so far, seconds.
    seconds: f64,
    /// Distance over which the far edge rises from 20 to 80 % of the strip's light, pixels. The picture's own pixels
    /// are 0.6 of it. None if it is wider than what is measured.
    edge_px: Option<f32>,
    /// Mean of the strip's light in its middle half, over the closed form.
    mean: f64,
    /// Root mean square error of a pixel there, relative to the closed form.
    error: f64,
}

/// Measures and prints, for 1, 4, 16 ... samples up to `spp`.
pub fn run(spp: u32, json: bool) -> Result<(), Failure> {
    let mut rows = Vec::new();
    for (mirror_m, pixel_mm) in CLOSE_UPS {
        terminal::progress(format_args!("{pixel_mm} mm a pixel ..."));
        rows.extend(measure(mirror_m, pixel_mm, spp)?);
    }
    if json {
        terminal::result(serde_json::to_string(&rows).context("can't write the results")?);
    } else {
        terminal::result(table(&rows).trim_end());
    }
    Ok(())
}

fn measure(mirror_m: f32, pixel_mm: f32, spp: u32) -> Result<Vec<CausticRow>, Failure> {
    let strip = Strip::of_mirror(mirror_m);
    let scene = strip.close_up(pixel_mm * 1e-3);
    let frame = scene.focused_lens().frame(&scene.camera, SIZE.0 as f32 / SIZE.1 as f32);
    let prepared = raytrace::prepare(&scene, &Assets::default())?;
    let settings = Settings { width: SIZE.0, height: SIZE.1, spp, ..Settings::default() };
    let mut rows = Vec::new();
    let began = Instant::now();
    raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |film| {
        // 1, 4, 16 ...
        if film.spp().is_power_of_two() && film.spp().trailing_zeros() % 2 == 0 {
            let light = StripLight::measure(&film.develop(&scene), &frame, &strip, pixel_mm * 1e-3);
            let (mean, error) = light.mean_and_error();
            rows.push(CausticRow {
                strip_mm: (strip.end - strip.start) * 1e3,
                pixel_mm,
                spp: film.spp(),
                seconds: began.elapsed().as_secs_f64(),
                edge_px: light.edge_px(),
                mean,
                error,
            });
        }
        ControlFlow::Continue(())
    });
    Ok(rows)
}

/// The strip of floor that the mirror lights.
struct Strip {
    /// Distances of its edges from the plane of the mirror, metres.
    start: f32,
    end: f32,
    /// Heights of the mirror's edges, metres.
    mirror: [f32; 2],
}

impl Strip {
    /// The strip of a mirror with this height, whose upper edge is always in the same place.
    fn of_mirror(height_m: f32) -> Self {
        const TOP_M: f32 = 0.5;
        let mirror = [TOP_M - height_m, TOP_M];
        // The ray from the bulb's image through an edge of the mirror
        let [start, end] = mirror.map(|y| BULB.x * y / (BULB.y - y));
        Strip { start, end, mirror }
    }

    /// The studio with a camera over the strip's far edge, or over its middle if all of it is in the picture.
    fn close_up(&self, pixel_m: f32) -> Scene {
        let [low, high] = self.mirror;
        let mirror = Object {
            id: ObjectId(1),
            transform: Transform {
                position: Vec3::Y * (0.5 * (low + high)),
                rotation_deg: Vec3::NEG_Z * 90.0,
                ..Transform::default()
            },
            material: Material { metallic: 1.0, roughness: 0.0, base_color: [0.999; 3], ..Material::default() },
            ..Object::new("Mirror", Shape::Plane { width_m: high - low, depth_m: 2.0 })
        };
        let floor = Object {
            id: ObjectId(2),
            // Without a specular lobe
            material: Material { ior: 1.0, roughness: 1.0, ..Material::default() },
            ..Object::new("Floor", Shape::Plane { width_m: 4.0, depth_m: 4.0 })
        };
        let bulb = Light {
            id: LightId(3),
            position: BULB,
            aim: Aim::Point(Vec3::ZERO),
            ..Light::new(Emitter::Point, Output::Lumens(2000.0))
        };
        // Turned against the edge, so that its profile has values between the pixels (ISO 12233's slanted edge)
        let position = Vec3::new(self.end + 0.002, CAMERA_M, 0.01);
        let aim = Aim::Point(Vec3::X * self.end);
        // Focused far away, so that the focal length alone gives the field of view
        let focus = Focus::Distance(1e6);
        let camera = Camera { position, aim, focus, depth_of_field: false, ..Camera::default() };
        let aspect = SIZE.0 as f32 / SIZE.1 as f32;
        let scene = Scene { objects: vec![mirror, floor], lights: vec![bulb], camera, ..Scene::default() };
        let half = scene.focused_lens().frame(&scene.camera, aspect).half_extent.x;
        let wanted = 0.5 * pixel_m * SIZE.0 as f32 / CAMERA_M;
        let focal_length_mm = scene.camera.focal_length_mm * half / wanted;
        Scene { camera: Camera { focal_length_mm, ..scene.camera }, ..scene }
    }
}

/// Illuminance on the floor by a bulb, in any unit.
fn illuminance(bulb: Vec3, point: Vec3) -> f64 {
    let to_bulb = bulb - point;
    f64::from(to_bulb.y / to_bulb.length().powi(3))
}

/// The light of the strip in a picture.
struct StripLight {
    /// For each pixel its distance into the strip from the far edge, pixels; and the strip's light over the closed form.
    pixels: Vec<(f32, f64)>,
    /// Width of the strip, pixels.
    width: f32,
}

impl StripLight {
    fn measure(picture: &Picture, frame: &CameraFrame, strip: &Strip, pixel_m: f32) -> Self {
        let size = Vec2::new(SIZE.0 as f32, SIZE.1 as f32);
        let point_of = |(x, y): (u32, u32)| {
            let direction = frame.direction((Vec2::new(x as f32, y as f32) + 0.5) / size);
            frame.position() - direction * (frame.position().y / direction.y)
        };
        let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
        let values: Vec<(Vec3, f64)> =
            pixels.map(point_of).zip(&picture.rgb).map(|(at, rgb)| (at, f64::from(luminance((*rgb).into())))).collect();
        // Beyond the strip, the bulb alone lights the floor: its exposure
        let beyond = |point: Vec3| point.x > strip.end + EDGE_PX * pixel_m;
        let alone: Vec<f64> =
            values.iter().filter(|(at, _)| beyond(*at)).map(|(at, value)| value / illuminance(BULB, *at)).collect();
        let exposure = alone.iter().sum::<f64>() / alone.len().max(1) as f64;
        let image = BULB * Vec3::new(-1.0, 1.0, 1.0);
        let share = |(at, value): (Vec3, f64)| {
            let share = (value / exposure - illuminance(BULB, at)) / illuminance(image, at);
            ((strip.end - at.x) / pixel_m, share)
        };
        StripLight { pixels: values.into_iter().map(share).collect(), width: (strip.end - strip.start) / pixel_m }
    }

    /// Mean over the middle half of the strip, as far as it is in the picture, and root mean square error of a pixel.
    fn mean_and_error(&self) -> (f64, f64) {
        let visible = self.width.min(0.5 * SIZE.0 as f32);
        let inside = |(depth, _): &&(f32, f64)| *depth > 0.25 * visible && *depth < 0.75 * visible;
        let shares: Vec<f64> = self.pixels.iter().filter(inside).map(|(_, share)| *share).collect();
        let count = shares.len().max(1) as f64;
        let squares: f64 = shares.iter().map(|share| (share - 1.0).powi(2)).sum();
        (shares.iter().sum::<f64>() / count, (squares / count).sqrt())
    }

    /// Distance over which the far edge rises from 20 to 80 %, pixels.
    fn edge_px(&self) -> Option<f32> {
        const BINS_PER_PX: f32 = 4.0;
        let bin = |(depth, _): &(f32, f64)| (depth * BINS_PER_PX).floor();
        let mut near: Vec<(f32, f64)> =
            self.pixels.iter().filter(|(depth, _)| depth.abs() < EDGE_PX).copied().collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        // From the dark into the strip
        let rises_above = |level: f64| {
            let mut bins = near.chunk_by(|a, b| bin(a) == bin(b));
            let mean = |pixels: &[(f32, f64)]| pixels.iter().map(|(_, share)| share).sum::<f64>() / pixels.len() as f64;
            bins.find(|pixels| mean(pixels) > level)?.first().map(bin)
        };
        Some((rises_above(0.8)? - rises_above(0.2)?) / BINS_PER_PX)
    }
}

fn table(rows: &[CausticRow]) -> String {
    let mut text = "| strip, mm | mm a pixel | samples | s | edge, pixels | mean | error, % |\n\
                    |---|---|---|---|---|---|---|\n"
        .to_owned();
    for CausticRow { strip_mm, pixel_mm, spp, seconds, edge_px, mean, error } in rows {
        let edge = edge_px.map_or("wider".to_owned(), |edge| format!("{edge:.1}"));
        let error = 100.0 * error;
        let _ =
            writeln!(text, "| {strip_mm:.0} | {pixel_mm} | {spp} | {seconds:.2} | {edge} | {mean:.3} | {error:.1} |");
    }
    for close_up in rows.chunk_by(|a, b| (a.strip_mm, a.pixel_mm) == (b.strip_mm, b.pixel_mm)) {
        if let [first, .., last] = close_up {
            let order = (last.error / first.error).ln() / f64::from(last.spp / first.spp).ln();
            let _ = write!(text, "\nstrip of {:.0} mm, {} mm a pixel: ", first.strip_mm, first.pixel_mm);
            let _ = write!(text, "error ~ samples^{order:.2}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caustics_in_close_ups_are_sharp_and_have_the_light_of_the_closed_form() {
        // Widest edge in pixels and error of the mean, at 16 samples. The blur of two pixels and the pixels themselves
        // are the first; closer, as many photons as possible arrive in the picture, and they are few.
        let limits = [(3.0, 0.03), (3.0, 0.03), (9.0, 0.05), (30.0, 0.15), (3.0, 0.03)];
        for ((mirror_m, pixel_mm), (widest_px, off)) in CLOSE_UPS.into_iter().zip(limits) {
            let rows = measure(mirror_m, pixel_mm, 16).unwrap();
            let [first, .., last] = &rows[..] else { panic!("{rows:?}") };
            assert!(last.edge_px.is_some_and(|edge| edge > 0.3 && edge < widest_px), "{last:?}");
            assert!((last.mean - 1.0).abs() < off, "{last:?}");
            assert!(last.error < 0.6 * first.error, "{first:?}, {last:?}");
        }
    }
}
