//! Renders every studio preset: finite, lit, the same bits for any number of threads.

use crate::people::{coarse_and_hairless, prepared, shipped};
use crate::studio::measure::film_with;
use catchlight::color::{display_srgb8, srgb_decode, srgb_encode};
use catchlight::io::{self, PresetGroup};
use catchlight::raytrace::{self, Film, Method, RenderControl, RenderScene, Settings};
use std::ops::ControlFlow;

fn render(scene: &RenderScene, settings: &Settings, threads: usize) -> Film {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| raytrace::render(scene, settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(())))
}

/// Returns four by four blocks of a picture, by channel: their mean light, as bytes.
fn blocks(rgb: &[[u8; 3]], width: u32) -> Vec<f32> {
    let (width, height) = (width as usize, rgb.len() / width as usize);
    let (mut sums, mut counts) = ([[0.0; 3]; 16], [0.0; 16]);
    for (index, pixel) in rgb.iter().enumerate() {
        let block = index / width * 4 / height * 4 + index % width * 4 / width;
        counts[block] += 1.0;
        sums[block].iter_mut().zip(pixel).for_each(|(sum, byte)| *sum += srgb_decode(f32::from(*byte) / 255.0));
    }
    let byte = |mean: f32| 255.0 * srgb_encode(mean);
    sums.iter().zip(counts).flat_map(|(sums, count)| sums.map(|sum| byte(sum / count))).collect()
}

#[test]
fn every_preset_renders_finite_and_lit() {
    assert!(io::presets().len() >= 8);
    for preset in io::presets() {
        let loaded = shipped(preset.file_name);
        assert!(loaded.warnings.is_empty(), "{}: {:?}", preset.file_name, loaded.warnings);
        let (width, height) = loaded.scene.camera.picture_size(48);
        let film = render(prepared(preset.file_name), &Settings { width, height, spp: 4, ..Settings::default() }, 2);
        assert_eq!(film.nonfinite().count, 0, "{}: first at {:?}", preset.file_name, film.nonfinite().first);
        let picture = film.develop(&loaded.scene);
        assert!(picture.rgb.iter().flatten().all(|c| c.is_finite() && *c >= 0.0), "{}", preset.file_name);
        let brightest = picture.rgb.iter().map(|p| p[1]).fold(0.0, f32::max);
        // A low-key picture, too, has an edge of a face near middle grey.
        assert!(brightest > 0.15, "{}: the brightest pixel is {brightest}", preset.file_name);

        // The picture in the list of studios shows the same
        let shown = preset.picture().unwrap();
        let traced: Vec<[u8; 3]> = picture.rgb.iter().map(|rgb| display_srgb8(*rgb)).collect();
        let (shown, traced) = (blocks(&shown.rgb, shown.width), blocks(&traced, width));
        let difference = shown.iter().zip(&traced).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // What glass and water focus is brighter than white in few of four samples
        let bound = if preset.group == PresetGroup::Product { 24.0 } else { 12.0 };
        assert!(difference < bound, "{}: off by {difference} of 255: make.sh makes it anew", preset.file_name);
    }
}

#[test]
fn one_thread_and_many_give_the_same_bits() {
    for (name, method) in
        [("three_point", Method::Path), ("product_still_life", Method::Path), ("split", Method::Direct)]
    {
        let loaded = shipped(name);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
        let prepared_alone = one.install(|| raytrace::prepare(&loaded.scene, &loaded.assets)).unwrap();
        let settings = Settings { width: 77, height: 45, spp: 3, method, ..Settings::default() };
        let reference = render(&prepared_alone, &settings, 1).develop(&loaded.scene);
        for threads in [2, 5] {
            let bits =
                |p: &catchlight::photo::Picture| -> Vec<u32> { p.rgb.iter().flatten().map(|c| c.to_bits()).collect() };
            let picture = render(&prepared, &settings, threads).develop(&loaded.scene);
            assert!(bits(&reference) == bits(&picture), "{name} differs with {threads} threads");
        }
    }
}

#[test]
fn a_seed_changes_only_the_noise() {
    let loaded = coarse_and_hairless(shipped("three_point"));
    let picture = |seed| {
        let settings = Settings { width: 32, height: 32, spp: 64, seed, ..Settings::default() };
        film_with(&loaded.scene, &loaded.assets, &settings).develop(&loaded.scene)
    };
    let (a, b) = (picture(1), picture(2));
    assert_ne!(a, b);
    let mean = |p: &catchlight::photo::Picture| p.rgb.iter().map(|c| c[1]).sum::<f32>() / p.rgb.len() as f32;
    // With 65536 samples, and no highlights of single hairs, the standard error of the mean is far below 1 %.
    assert!((mean(&a) / mean(&b) - 1.0).abs() < 0.01);
}

#[test]
fn a_cancelled_render_keeps_its_complete_passes() {
    let loaded = shipped("three_point");
    let prepared = prepared("three_point");
    let settings = Settings { width: 40, height: 40, spp: 64, ..Settings::default() };
    let control = RenderControl::new();
    let film = raytrace::render(prepared, &settings, &control, &mut |film| {
        if film.spp() == 4 {
            control.cancel();
        }
        ControlFlow::Continue(())
    });
    assert_eq!(film.spp(), 4);
    let reference = render(prepared, &Settings { spp: 4, ..settings }, 2);
    assert_eq!(film.develop(&loaded.scene), reference.develop(&loaded.scene));
}

#[test]
fn a_render_ends_at_its_noise_target() {
    let loaded = coarse_and_hairless(shipped("three_point"));
    let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
    let settings = Settings { width: 64, height: 64, spp: 4096, noise_stops: Some(0.1), ..Settings::default() };
    let film = render(&prepared, &settings, 2);
    assert!(film.spp() < 4096 && film.noise_stops() <= 0.1, "{} stops at {} samples", film.noise_stops(), film.spp());
}
