//! The preview's direct light against the path tracer's, for each light of each shipped studio alone.
//!
//! Compared are pixels that are lit and unshadowed in the preview. A shadow that the preview misses counts as its
//! error; a false shadow is counted separately. Mirrors and glass are left out, since the preview does not trace
//! reflections; people are hairless, since hair has tests of its own.

use super::*;
use catchlight::raytrace::GeometryCache;
use std::ops::ControlFlow;

/// Longer side of the compared pictures, pixels.
const LONG_EDGE: u32 = 96;
/// Preview pixels per compared pixel along each axis: the tracer's pixels are averages over their area, too.
const SUPERSAMPLES: u32 = 4;
/// Samples per pixel. Leaves a noise of 3 to 6 % in a pixel for a panel, 0.08 stops, whose median is half of the limit,
/// and an eighth of that in a block of 64 pixels.
const SPP: u32 = 24;
/// Samples per pixel where grazing light is noisier, and its rim a pixel wide.
const FINE_SPP: u32 = 96;
/// Darker pixels count as unlit: a twentieth of them would be one code of an 8-bit picture.
const LIT: f32 = 0.005;
/// Rim lights whose lit area is too thin for a block: their pictures are larger, with so many samples per pixel. Where
/// still no block fits, the light is compared from its own side, too.
const RIM_LIGHTS: &[(&str, &str, u32)] = &[
    ("split", "Key strip", SPP),
    ("rim_low_key", "Left strip", FINE_SPP),
    ("rim_low_key", "Right strip", FINE_SPP),
    ("interview", "Tungsten hair light", SPP),
];
/// Longer side of their pictures, pixels.
const FINE_LONG_EDGE: u32 = 240;
/// Azimuth between light and camera at the subject, in a picture from the light's side.
const BESIDE_RAD: f32 = 0.6;
/// Side of a block, pixels.
const BLOCK: usize = 8;

/// Limit of the median where a light grazes edges a pixel wide from behind, stops.
const RIM_MEDIAN: f32 = 0.12;
/// Limits in stops: median over pixels, worst block; and the fraction of pixels with false shadow (edges of shadows).
const LIMITS: (f32, f32, f32) = (0.1, 0.3, 0.02);

/// Luminance pictures of one light.
struct Pictures {
    columns: usize,
    traced: Vec<f32>,
    preview: Vec<f32>,
    unshadowed: Vec<f32>,
    /// False for mirrors and glass.
    rasterable: Vec<bool>,
}

/// The differences between preview and path tracer.
struct Comparison {
    pixels: usize,
    median_stops: f32,
    blocks: usize,
    worst_stops: f32,
    false_shadow: f32,
}

#[test]
fn each_light_alone_equals_the_traced_direct_light() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut wrong = Vec::new();
    for preset in catchlight::io::presets() {
        let studio = preset.file_name.trim_end_matches(".ron");
        let mut loaded = coarse_and_hairless(shipped(preset.file_name));
        let blases = GeometryCache::default();
        loaded.scene.lights.iter_mut().for_each(|light| light.on = true);
        for (id, name, layer) in traced_lights(&loaded, &blases) {
            loaded.scene.lights.iter_mut().for_each(|light| light.on = light.id == id);
            let rim_spp = RIM_LIGHTS.iter().find(|rim| (rim.0, rim.1) == (studio, name.as_str())).map(|rim| rim.2);
            let c = if let Some(spp) = rim_spp {
                compare(&draw(&mut renderer, &loaded, &blases, FINE_LONG_EDGE, spp))
            } else {
                compare(&draw_beside(layer, &mut renderer, &loaded, LONG_EDGE))
            };
            wrong.extend(c.report(studio, &name));
            if rim_spp.is_some() && c.blocks == 0 {
                let beside = from_beside(&loaded.scene, id);
                let camera = std::mem::replace(&mut loaded.scene.camera, beside);
                let c = compare(&draw(&mut renderer, &loaded, &blases, LONG_EDGE, SPP));
                loaded.scene.camera = camera;
                assert!(c.blocks > 0, "{studio}, {name}: no block to compare");
                wrong.extend(c.report(studio, &format!("{name}, from beside")));
            }
        }
    }
    assert!(wrong.is_empty(), "too far from the tracer:\n{}", wrong.join("\n"));
}

/// Cases where one shadow map or one representative point per emitter is not enough: large emitters close to the
/// subject, behind it, edge-on, near a wall. The man of the split studio is at the origin and faces +Z.
#[test]
fn lights_in_difficult_positions_equal_the_traced_direct_light() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut loaded = coarse_and_hairless(shipped("split"));
    loaded.scene.camera.position = Vec3::new(0.3, 1.6, 1.96);
    let (strip, horizontal) =
        (Emitter::RectPanel { width_m: 0.3, height_m: 1.4 }, Emitter::RectPanel { width_m: 1.4, height_m: 0.3 });
    let (window, octa) = (Emitter::RectPanel { width_m: 1.5, height_m: 2.0 }, Emitter::RoundPanel { diameter_m: 1.5 });
    let (sphere, sun) = (Emitter::Sphere { radius_m: 0.15 }, Emitter::Sun { angular_diameter_deg: 0.53 });
    let face = Vec3::new(0.0, 1.6, 0.1);
    let cases = [
        ("strip 0.3 m beside the body", strip, Vec3::new(0.55, 1.4, 0.1), Vec3::new(0.0, 1.4, 0.1)),
        ("strip edge-on", strip, Vec3::new(0.9, 1.6, 0.6), Vec3::new(0.9, 1.6, -3.0)),
        ("horizontal strip behind the head", horizontal, Vec3::new(0.0, 2.3, -1.0), face),
        ("octa near the wall", octa, Vec3::new(0.9, 1.6, -1.2), Vec3::new(0.3, 1.5, -1.9)),
        ("octa close to the face", octa, Vec3::new(0.5, 1.9, 0.8), face),
        ("window beside", window, Vec3::new(1.3, 1.5, 0.1), face),
        ("window behind", window, Vec3::new(1.3, 1.5, -0.8), face),
        ("sphere behind", sphere, Vec3::new(0.5, 1.8, -0.5), face),
        ("sun", sun, Vec3::new(1.0, 3.0, 1.0), face),
    ];
    let blases = GeometryCache::default();
    let mut wrong = Vec::new();
    for (name, emitter, position, target) in cases {
        let output = if emitter == sun { Output::Lux(20_000.0) } else { Output::Lumens(60_000.0) };
        loaded.scene.lights = vec![light(0, position, target, emitter, output)];
        let c = compare(&draw(&mut renderer, &loaded, &blases, LONG_EDGE, FINE_SPP));
        assert!(c.pixels > 100, "{name} lights {} pixels", c.pixels);
        let limit = if name.ends_with("behind the head") { RIM_MEDIAN } else { LIMITS.0 };
        wrong.extend(c.report_with(limit, "difficult position", name));
    }
    assert!(wrong.is_empty(), "too far from the tracer:\n{}", wrong.join("\n"));
}

impl Comparison {
    /// Prints the comparison, and returns it if it exceeds a limit.
    fn report(&self, studio: &str, name: &str) -> Option<String> {
        self.report_with(LIMITS.0, studio, name)
    }

    /// As `report`, with a limit of the median of its own.
    fn report_with(&self, median: f32, studio: &str, name: &str) -> Option<String> {
        let (_, worst, false_shadow) = LIMITS;
        let line = format!(
            "{studio:20} {name:34} median {:.3} over {:5} pixels, worst {:.3} of {:3} blocks, {:.2} % false shadow",
            self.median_stops,
            self.pixels,
            self.worst_stops,
            self.blocks,
            self.false_shadow * 100.0
        );
        let is_wrong = self.median_stops > median || self.worst_stops > worst || self.false_shadow > false_shadow;
        println!("{line}");
        is_wrong.then_some(line)
    }
}

/// Returns the scene's camera, rotated about its target to a position beside a light.
fn from_beside(scene: &Scene, id: LightId) -> Camera {
    let camera = &scene.camera;
    let target = scene.aim_point(&camera.aim, camera.position);
    let light = scene.lights.iter().find(|light| light.id == id).unwrap();
    let to_light = (light.position - target).with_y(0.0).normalize();
    let away = glam::Quat::from_rotation_y(BESIDE_RAD) * to_light * camera.position.distance(target);
    Camera { position: target + away, aim: Aim::Point(target), ..camera.clone() }
}

/// Returns the lights of a studio, each with the luminances of its layer.
fn traced_lights(loaded: &Loaded, blases: &GeometryCache) -> Vec<(LightId, String, Vec<f32>)> {
    let size = loaded.scene.camera.picture_size(LONG_EDGE);
    let layers = film_with(loaded, blases, size, SPP, raytrace::Method::Direct).develop_layers(&loaded.scene);
    let of_light = |light: &Light| {
        let (name, layer) = layers.iter().find(|(name, _)| *name == light.name).unwrap();
        (light.id, name.clone(), luminances(layer))
    };
    loaded.scene.lights.iter().map(of_light).collect()
}

fn draw(renderer: &mut PreviewRenderer, loaded: &Loaded, blases: &GeometryCache, long_edge: u32, spp: u32) -> Pictures {
    let size = loaded.scene.camera.picture_size(long_edge);
    let traced = traced_with(loaded, blases, size, spp, raytrace::Method::Direct);
    draw_beside(traced, renderer, loaded, long_edge)
}

/// Draws a studio for the comparison with the luminances of a traced picture.
fn draw_beside(traced: Vec<f32>, renderer: &mut PreviewRenderer, loaded: &Loaded, long_edge: u32) -> Pictures {
    let scene = &loaded.scene;
    let (width, height) = scene.camera.picture_size(long_edge);
    let fine = (width * SUPERSAMPLES, height * SUPERSAMPLES);
    let mut input =
        PreviewInput { options: Options::direct_only(), ..PreviewInput::camera_view(scene, &loaded.assets, fine) };
    let preview = reduced(&renderer.linear_picture(&input).unwrap());
    let objects = renderer.object_mask().unwrap().objects;
    input.options.shadows = false;
    let unshadowed = reduced(&renderer.linear_picture(&input).unwrap());
    let rasterable = (0..width * height).map(|i| {
        let (x, y) = (i % width * SUPERSAMPLES, i / width * SUPERSAMPLES);
        let of_pixel = |k: u32| ((y + k / SUPERSAMPLES) * fine.0 + x + k % SUPERSAMPLES) as usize;
        (0..SUPERSAMPLES * SUPERSAMPLES).all(|k| objects[of_pixel(k)].is_none_or(|id| is_rasterable(scene, id)))
    });
    Pictures { columns: width as usize, traced, preview, unshadowed, rasterable: rasterable.collect() }
}

pub fn is_rasterable(scene: &Scene, id: ObjectId) -> bool {
    let is_mirror = |m: &Material| m.transmission > 0.0 || (m.metallic > 0.5 && m.roughness < 0.2);
    scene.object(id).is_none_or(|object| {
        !is_mirror(&object.material) && !object.part_materials.iter().any(|(_, material)| is_mirror(material))
    })
}

/// Returns the luminances of a traced picture.
pub fn traced_with(
    loaded: &Loaded,
    blases: &GeometryCache,
    size: (u32, u32),
    spp: u32,
    method: raytrace::Method,
) -> Vec<f32> {
    luminances(&film_with(loaded, blases, size, spp, method).develop(&loaded.scene))
}

fn film_with(
    loaded: &Loaded,
    blases: &GeometryCache,
    (width, height): (u32, u32),
    spp: u32,
    method: raytrace::Method,
) -> raytrace::Film {
    let prepared = raytrace::prepare_kept(&loaded.scene, &loaded.assets, blases).unwrap();
    let settings = raytrace::Settings { width, height, spp, method, ..raytrace::Settings::default() };
    raytrace::render(&prepared, &settings, &raytrace::RenderControl::new(), &mut |_| ControlFlow::Continue(()))
}

fn luminances(picture: &Picture) -> Vec<f32> {
    picture.rgb.iter().map(|rgb| color::luminance((*rgb).into())).collect()
}

/// Returns the mean luminance of each compared pixel.
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
    let unshadowed = |i: usize| p.preview[i] > 0.97 * p.unshadowed[i];
    let stops = |preview: f32, traced: f32| (preview.max(1e-6) / traced.max(1e-6)).log2().abs();
    let mut errors: Vec<f32> =
        (0..count).filter(|&i| lit(i) && unshadowed(i)).map(|i| stops(p.preview[i], p.traced[i])).collect();
    errors.sort_by(f32::total_cmp);
    let blocks = block_errors(p, |i| lit(i) && unshadowed(i), stops);
    let false_shadow =
        (0..count).filter(|&i| lit(i) && p.preview[i] < 0.5 * p.unshadowed[i] && p.traced[i] > 0.8 * p.unshadowed[i]);
    Comparison {
        pixels: errors.len(),
        median_stops: errors.get(errors.len() / 2).copied().unwrap_or(0.0),
        blocks: blocks.len(),
        worst_stops: blocks.into_iter().fold(0.0, f32::max),
        false_shadow: false_shadow.count() as f32 / (0..count).filter(|&i| lit(i)).count().max(1) as f32,
    }
}

/// Returns the errors of the blocks whose pixels, and two pixels around them, all satisfy `counts`.
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
            errors.push(stops(sum(&p.preview), sum(&p.traced)));
        }
    }
    errors
}
