//! Adaptive sampling by `--noise`: more samples where the noise is, without bias.

use crate::people::{coarse_and_hairless, prepared, shipped};
use crate::studio::measure::film_with;
use catchlight::io::presets;
use catchlight::photo::Picture;
use catchlight::raytrace::{self, RenderControl, Settings};
use std::ops::ControlFlow;

fn mean(picture: &Picture) -> f64 {
    picture.rgb.iter().flatten().map(|&x| f64::from(x)).sum::<f64>() / (3 * picture.rgb.len()) as f64
}

#[test]
fn tiles_with_little_noise_stop_early_without_bias() {
    let loaded = coarse_and_hairless(shipped("three_point"));
    let size = Settings { width: 128, height: 96, spp: 512, ..Settings::default() };
    let limit = 0.06;
    let film = film_with(&loaded.scene, &loaded.assets, &Settings { noise_stops: Some(limit), ..size.clone() });
    assert!(film.noise_stops() <= limit);
    assert!(f64::from(film.spp()) < 0.7 * film.mean_spp(), "{} of {}", film.spp(), film.mean_spp());
    let uniform = film_with(&loaded.scene, &loaded.assets, &Settings { spp: 64, seed: 5, ..size });
    // Pixels have an error of up to 4 % (0.06 stops), the mean of 12 288 pixels one of 0.04 %, if stopping early is
    // unbiased.
    let (ours, truth) = (mean(&film.develop(&loaded.scene)), mean(&uniform.develop(&loaded.scene)));
    assert!((ours / truth - 1.0).abs() < 0.002, "{ours} for {truth}");
}

/// Luminance of each pixel, and the estimated noise.
struct Sampled {
    luminance: Vec<f64>,
    noise_stops: f64,
}

#[test]
fn the_estimated_noise_of_every_shipped_studio_is_the_scatter_over_thirty_two_seeds() {
    // It was overstated by 23 to 42 % with 4 samples and by 16 to 28 % with 8. A picture is one tile here. The scatter of
    // 1024 pixels, some of which hold most of it, is known to some 7 %. Of soft skin a sample can be far below zero, which
    // the estimate counts and the picture cuts off: in one of sixteen seeds it would be a third of the noise.
    const SEEDS: u32 = 32;
    const SPP: [u32; 2] = [4, 8];
    let mut ratios = [0.0; SPP.len()];
    for preset in presets() {
        let loaded = shipped(preset.file_name);
        let mut sampled: [Vec<Sampled>; SPP.len()] = Default::default();
        for seed in 0..SEEDS {
            let settings = Settings { width: 32, height: 32, spp: SPP[1], seed, ..Settings::default() };
            raytrace::render(prepared(preset.file_name), &settings, &RenderControl::new(), &mut |film| {
                if let Some(index) = SPP.iter().position(|spp| *spp == film.spp()) {
                    let picture = film.develop(&loaded.scene);
                    let luminance = |[r, g, b]: &[f32; 3]| f64::from(0.2126 * r + 0.7152 * g + 0.0722 * b);
                    let luminance = picture.rgb.iter().map(luminance).collect();
                    sampled[index].push(Sampled { luminance, noise_stops: film.noise_stops().into() });
                }
                ControlFlow::Continue(())
            });
        }
        for ((sampled, spp), sum) in sampled.iter().zip(SPP).zip(&mut ratios) {
            let seeds = f64::from(SEEDS);
            let (mut variance, mut total) = (0.0, 0.0);
            for pixel in 0..1024 {
                let mean = sampled.iter().map(|picture| picture.luminance[pixel]).sum::<f64>() / seeds;
                let squares = sampled.iter().map(|picture| (picture.luminance[pixel] - mean).powi(2)).sum::<f64>();
                variance += squares / (seeds - 1.0);
                total += mean;
            }
            let scatter = (variance * 1024.0).sqrt() / total;
            // The mean square of the estimated relative errors
            let squares = sampled.iter().map(|picture| (picture.noise_stops.exp2() - 1.0).powi(2)).sum::<f64>();
            let ratio = (squares / seeds).sqrt() / scatter;
            assert!((0.8..1.25).contains(&ratio), "{}, {spp} samples: {ratio} of the scatter", preset.file_name);
            *sum += ratio / presets().len() as f64;
        }
    }
    assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.05), "{ratios:?} in the mean of all studios");
}
