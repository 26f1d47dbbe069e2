//! The preview's bounced light, and all its light, against the path tracer's, in each shipped studio.
//!
//! Compared are blocks of pixels without mirrors and glass, which the preview shows roughly, and without hair, see
//! `hair`. The error of the bounced light is that of the whole picture if its direct light were the tracer's; direct
//! light is compared in `each_light`.

use super::each_light::{is_rasterable, traced_with};
use super::*;
use catchlight::jobs::trace_bounced_light;
use catchlight::raytrace::{GeometryCache, Method};

/// Longer side of the compared pictures, pixels.
const LONG_EDGE: u32 = 96;
/// The studio whose lit areas are thin rims: its picture is larger, and the limit of all its light is that of direct
/// light, which grazes edges there.
const RIM_STUDIO: &str = "rim_low_key";
const RIM_LIMIT: f32 = 0.15;
/// Longer side of its picture, pixels.
const FINE_LONG_EDGE: u32 = 288;
/// Preview pixels per compared pixel along each axis.
const SUPERSAMPLES: u32 = 2;
/// Side of a compared block, pixels.
const BLOCK: u32 = 4;
/// Samples per pixel: 128 a block, which leaves a noise of some 0.04 stop in a block, far less in the median of blocks.
const SPP: u32 = 8;
/// As many of the studio of rims.
const RIM_SPP: u32 = 16;
/// Darker blocks are black to the eye.
const LIT: f32 = 0.01;
/// Largest median errors, stops: of the bounced light, of all light, and of all light with the estimate that is shown
/// until the traced bounced light is there.
const LIMITS: (f32, f32, f32) = (0.1, 0.1, 0.2);

/// The luminances of a block.
struct Block {
    preview: f32,
    estimate: f32,
    direct: f32,
    traced: f32,
    traced_direct: f32,
}

/// Returns the errors of all blocks in stops, sorted.
fn errors(blocks: &[Block], shown: impl Fn(&Block) -> f32) -> Vec<f32> {
    let stops = |block: &Block| (shown(block).max(1e-6) / block.traced).log2().abs();
    let mut errors: Vec<f32> = blocks.iter().map(stops).collect();
    errors.sort_by(f32::total_cmp);
    errors
}

#[test]
fn bounced_and_direct_light_of_each_shipped_studio_are_within_a_tenth_of_a_stop() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut wrong = Vec::new();
    for preset in catchlight::io::presets() {
        let name = preset.file_name.trim_end_matches(".ron");
        let is_rim = name == RIM_STUDIO;
        let long_edge = if is_rim { FINE_LONG_EDGE } else { LONG_EDGE };
        let spp = if is_rim { RIM_SPP } else { SPP };
        let blocks = compared_blocks(&mut renderer, &coarse_and_hairless(shipped(preset.file_name)), long_edge, spp);
        assert!(blocks.len() > 100, "{name}: {} blocks to compare", blocks.len());
        let [bounced, shown, estimate] = [
            errors(&blocks, |block| block.traced_direct + block.preview - block.direct),
            errors(&blocks, |block| block.preview),
            errors(&blocks, |block| block.estimate),
        ];
        let (middle, tenth) = (blocks.len() / 2, blocks.len() * 9 / 10);
        let line = format!(
            "{name:20} median of the bounced light {:.3}, of all light {:.3}, worst tenth {:.3} stops over {} blocks; with \
             the estimate {:.3}",
            bounced[middle],
            shown[middle],
            shown[tenth],
            blocks.len(),
            estimate[middle],
        );
        println!("{line}");
        let limit = if is_rim { RIM_LIMIT } else { LIMITS.1 };
        if bounced[middle] > LIMITS.0 || shown[middle] > limit || estimate[middle] > LIMITS.2 {
            wrong.push(line);
        }
    }
    assert!(wrong.is_empty(), "too far from the tracer:\n{}", wrong.join("\n"));
}

fn compared_blocks(renderer: &mut PreviewRenderer, loaded: &Loaded, long_edge: u32, spp: u32) -> Vec<Block> {
    let scene = &loaded.scene;
    let (width, height) = scene.camera.picture_size(long_edge);
    let fine = (width * SUPERSAMPLES, height * SUPERSAMPLES);
    let mut input = PreviewInput::camera_view(scene, &loaded.assets, fine);
    let estimate = renderer.linear_picture(&input).unwrap();
    let objects = renderer.object_mask().unwrap().objects;
    let bounced_light = trace_bounced_light(scene, &loaded.assets, None).unwrap();
    input.bounced_light = bounced_light.as_ref();
    let preview = renderer.linear_picture(&input).unwrap();
    input.options = Options::direct_only();
    let direct = renderer.linear_picture(&input).unwrap();
    let [traced, traced_direct] = [Method::Path, Method::Direct]
        .map(|method| traced_with(loaded, &GeometryCache::default(), (width, height), spp, method));

    let side = BLOCK * SUPERSAMPLES;
    let blocks = (0..height / BLOCK).flat_map(|y| (0..width / BLOCK).map(move |x| (x, y)));
    let compared = blocks.filter_map(|(x, y)| {
        let fine_pixels = || (0..side * side).map(move |k| (x * side + k % side, y * side + k / side));
        let is_compared = fine_pixels().all(|(x, y)| {
            let object = objects[(y * fine.0 + x) as usize];
            object.is_none_or(|id| is_rasterable(scene, id))
        });
        let fine_mean = |picture: &Picture| -> f32 {
            fine_pixels().map(|(x, y)| color::luminance(picture.at(x, y).into())).sum::<f32>() / (side * side) as f32
        };
        let mean = |values: &[f32]| -> f32 {
            let pixel = |k: u32| values[((y * BLOCK + k / BLOCK) * width + x * BLOCK + k % BLOCK) as usize];
            (0..BLOCK * BLOCK).map(pixel).sum::<f32>() / (BLOCK * BLOCK) as f32
        };
        let block = Block {
            preview: fine_mean(&preview),
            estimate: fine_mean(&estimate),
            direct: fine_mean(&direct),
            traced: mean(&traced),
            traced_direct: mean(&traced_direct),
        };
        (is_compared && block.traced > LIT).then_some(block)
    });
    compared.collect()
}
