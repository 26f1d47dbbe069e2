//! Tests of the whole denoiser.

use super::feature_map::{Block, FeatureMap, LEFT};
use super::network::{INPUT_CHANNELS, Network, PERIOD};
use super::simd::InstructionSet;
use super::weight_file::{WeightError, WeightFile};
use super::*;
use rayon::ThreadPoolBuilder;

const BEST_WEIGHTS: &[u8] = include_bytes!("../../assets/denoiser/rt_hdr_alb_nrm.tza");
const FAST_WEIGHTS: &[u8] = include_bytes!("../../assets/denoiser/rt_hdr_alb_nrm_small.tza");

fn never() -> bool {
    false
}

fn fast_network(set: InstructionSet) -> Network {
    Network::new(&WeightFile::parse(FAST_WEIGHTS).unwrap(), set).unwrap()
}

/// Returns pseudo-random numbers from 0 to below 4: `hashed` of tests/denoiser/native.py.
fn noise() -> impl Iterator<Item = f32> {
    let states =
        std::iter::successors(Some(1_u32), |state| Some(state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)));
    states.skip(1).map(|state| (state >> 24) as f32 / 64.0)
}

/// Returns a noisy picture of a disc in front of two grounds: `scene` of tests/denoiser/native.py.
fn disc(width: u32, height: u32) -> (Picture, AovPicture) {
    let (mut picture, mut aovs, mut noise) = (Picture::new(width, height), AovPicture::new(width, height), noise());
    for index in 0..picture.rgb.len() {
        let (x, y) = ((index % width as usize) as f32, (index / width as usize) as f32);
        let is_disc = (x - 30.0).powi(2) + (y - 20.0).powi(2) < 200.0;
        let ground = if x < 40.0 { 0.5 } else { 0.125 };
        let (albedo, light, z) = if is_disc { (0.75, 4.0, 0.5) } else { (ground, 0.25, 1.0) };
        aovs.albedo[index] = [albedo, albedo * 0.5, albedo * 0.25];
        aovs.normal[index] = [(x - 30.0) / 32.0, (20.0 - y) / 32.0, z];
        picture.rgb[index] = aovs.albedo[index].map(|albedo| albedo * light * noise.next().unwrap());
    }
    (picture, aovs.seen_directly())
}

/// Returns a picture of one colour on a wall.
fn flat(width: u32, height: u32, rgb: [f32; 3]) -> (Picture, AovPicture) {
    let pixels = width as usize * height as usize;
    let (albedo, normal) = (vec![[0.5; 3]; pixels], vec![[0.0, 0.0, 1.0]; pixels]);
    let aovs = AovPicture { albedo, normal, ..AovPicture::new(width, height) }.seen_directly();
    (Picture { width, height, rgb: vec![rgb; pixels] }, aovs)
}

#[test]
fn pictures_are_those_of_the_native_library() {
    // The sides are no multiples of 16. Sums of products in another order differ by some 1e-5.
    let (picture, aovs) = disc(61, 45);
    let native = [
        (Quality::Best, include_bytes!("../../tests/denoiser/native_best.f32").as_slice()),
        (Quality::Fast, include_bytes!("../../tests/denoiser/native_fast.f32").as_slice()),
    ];
    for (quality, bytes) in native {
        let expected = bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        // Which continues no picture beyond its borders
        let without_margin = MirroredPicture::new(&picture, &aovs, 0).unwrap();
        let network = quality.network().unwrap();
        let denoised = tiles::denoise(network, without_margin, tiles::MAX_PIXELS, &never).unwrap();
        let values = denoised.rgb.iter().flatten();
        assert_eq!(bytes.len(), 12 * denoised.rgb.len());
        for (value, expected) in values.zip(expected) {
            assert!((value - expected).abs() < 1e-4 * expected, "{quality:?}: {value}, not {expected}");
        }
    }
}

#[test]
fn instruction_sets_agree() {
    let (picture, aovs) = disc(61, 45);
    let mirrored = MirroredPicture::new(&picture, &aovs, MARGIN).unwrap();
    let run = |set| tiles::denoise(&fast_network(set), mirrored, tiles::MAX_PIXELS, &never).unwrap();
    let portable = run(InstructionSet::Portable);
    let mut fused: Option<Picture> = None;
    for set in InstructionSet::supported() {
        let result = run(set);
        for (a, b) in result.rgb.iter().flatten().zip(portable.rgb.iter().flatten()) {
            // Products are rounded or not: as between the native library and this one.
            assert!((a - b).abs() <= 1e-4 * b, "{set:?}: {a}, not {b}");
        }
        if set != InstructionSet::Portable {
            assert_eq!(*fused.get_or_insert(result.clone()), result, "{set:?}");
        }
    }
}

#[test]
fn pictures_have_the_same_bits_for_any_number_of_threads() {
    let (picture, aovs) = disc(80, 100);
    let run = |threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| denoise(&picture, &aovs, Quality::Fast, &never).unwrap())
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn tiles_are_those_of_one_run() {
    let (picture, aovs) = disc(420, 230);
    let network = fast_network(InstructionSet::best());
    let mirrored = MirroredPicture::new(&picture, &aovs, MARGIN).unwrap();
    let run = |max_pixels| tiles::denoise(&network, mirrored, max_pixels, &never).unwrap();
    let whole = run(usize::MAX);
    assert!(whole == run(70_000), "two columns");
    assert!(whole == run(1), "tiles of the smallest size");
}

#[test]
fn a_constant_picture_stays_constant() {
    for rgb in [[0.18; 3], [40.0, 20.0, 10.0], [1e-3, 2e-3, 1e-3]] {
        let (picture, aovs) = flat(96, 96, rgb);
        let denoised = denoise(&picture, &aovs, Quality::Best, &never).unwrap();
        let ratio = |x: u32, y: u32| std::array::from_fn::<f32, 3, _>(|i| denoised.at(x, y)[i] / rgb[i]);
        // Without a margin single pixels at the borders are off by up to two thirds
        for (x, y) in (0..96).flat_map(|y| (0..96).map(move |x| (x, y))) {
            let is_inside = (32..64).contains(&x) && (32..64).contains(&y);
            let most = if is_inside { 4e-3 } else { 6e-3 };
            assert!(ratio(x, y).iter().all(|ratio| (ratio - 1.0).abs() < most), "{:?}", ratio(x, y));
        }
        let all = (0..96).flat_map(|y| (0..96).map(move |x| ratio(x, y)[1]));
        assert!((all.sum::<f32>() / (96.0 * 96.0) - 1.0).abs() < 2e-3);
    }
}

#[test]
fn noise_becomes_less() {
    // The noise is uniform from 0 to 4 times the colour, with a mean near 2: a deviation of 1.15.
    let (mut picture, aovs) = flat(96, 96, [0.1; 3]);
    picture.rgb.iter_mut().flatten().zip(noise()).for_each(|(value, noise)| *value *= noise);
    let denoised = denoise(&picture, &aovs, Quality::Best, &never).unwrap();
    let deviation = |picture: &Picture| {
        let values: Vec<f32> = picture.rgb.iter().map(|rgb| rgb[1]).collect();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        (values.iter().map(|value| (value / mean - 1.0).powi(2)).sum::<f32>() / values.len() as f32).sqrt()
    };
    assert!(deviation(&picture) > 0.5 && deviation(&denoised) < 0.05, "{}", deviation(&denoised));
}

#[test]
fn the_borders_of_a_noisy_picture_are_as_bright_as_its_inside() {
    let (mut picture, aovs) = flat(192, 128, [0.1; 3]);
    picture.rgb.iter_mut().flatten().zip(noise()).for_each(|(value, noise)| *value *= noise);
    let mirrored = |margin| MirroredPicture::new(&picture, &aovs, margin).unwrap();
    let denoised = |margin| {
        let network = Quality::Best.network().unwrap();
        tiles::denoise(network, mirrored(margin), tiles::MAX_PIXELS, &never).unwrap()
    };
    // Root mean square difference of the outermost lines' means from the mean of the inside
    let mean = |picture: &Picture, pixels: &[(u32, u32)]| {
        pixels.iter().map(|&(x, y)| picture.at(x, y)[1]).sum::<f32>() / pixels.len() as f32
    };
    let inside: Vec<(u32, u32)> = (16..112).flat_map(|y| (16..176).map(move |x| (x, y))).collect();
    let lines: Vec<Vec<(u32, u32)>> = (0..2)
        .flat_map(|i| {
            let rows = [i, 127 - i].map(|y| (16..176).map(|x| (x, y)).collect());
            let columns = [i, 191 - i].map(|x| (16..112).map(|y| (x, y)).collect());
            rows.into_iter().chain(columns)
        })
        .collect();
    let error = |picture: &Picture| {
        let of_line = |line: &Vec<(u32, u32)>| (mean(picture, line) / mean(picture, &inside) - 1.0).powi(2);
        (lines.iter().map(of_line).sum::<f32>() / lines.len() as f32).sqrt()
    };
    let (with, without) = (error(&denoised(MARGIN)), error(&denoised(0)));
    assert!(with < 0.01 && with < 0.6 * without, "{with}, without a margin {without}");
}

#[test]
fn pixels_that_are_no_number_do_not_spread() {
    let (mut picture, mut aovs) = disc(61, 45);
    picture.rgb[500] = [f32::NAN, f32::INFINITY, -1.0];
    aovs.seen_albedo[700] = [f32::NAN, f32::INFINITY, -1.0];
    aovs.seen_normal[900] = [f32::NAN, f32::NEG_INFINITY, 7.0];
    let denoised = denoise(&picture, &aovs, Quality::Fast, &never).unwrap();
    assert!(denoised.rgb.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
}

#[test]
fn empty_pictures_and_pictures_without_aovs_are_left_as_they_are() {
    let (picture, _) = disc(20, 20);
    assert_eq!(denoise(&picture, &AovPicture::new(10, 10), Quality::Fast, &never), Ok(picture));
    let empty = Picture::new(0, 0);
    assert_eq!(denoise(&empty, &AovPicture::new(0, 0), Quality::Fast, &never), Ok(empty));
}

#[test]
fn black_stays_black_and_a_black_layer_gets_no_light() {
    // A layer without light had a share of the dark pixels, which did not follow the lights.
    let (picture, aovs) = disc(61, 45);
    let black = Picture::new(61, 45);
    assert_eq!(denoise(&black, &aovs, Quality::Fast, &never).as_ref(), Ok(&black));
    let layers = [picture.clone(), black.clone()];
    let denoised = denoise_layers(&picture, &layers, &aovs, Quality::Fast, &never).unwrap();
    assert_eq!(denoised.layers[1], black);
}

#[test]
fn a_cancelled_picture_is_not_returned() {
    let (picture, aovs) = disc(20, 20);
    assert_eq!(denoise(&picture, &aovs, Quality::Fast, &|| true), Err(Cancelled));
}

#[test]
fn denoised_layers_sum_to_the_denoised_picture() {
    let (key, aovs) = disc(61, 45);
    let fill = Picture { rgb: key.rgb.iter().rev().map(|rgb| rgb.map(|value| 0.3 * value)).collect(), ..key.clone() };
    let add = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|i| a[i] + b[i]);
    let sum = |a: &Picture, b: &Picture| Picture { rgb: a.rgb.iter().zip(&b.rgb).map(add).collect(), ..a.clone() };
    let picture = sum(&key, &fill);
    let denoised = denoise_layers(&picture, &[key.clone(), fill], &aovs, Quality::Fast, &never).unwrap();
    assert_eq!(Ok(&denoised.picture), denoise(&picture, &aovs, Quality::Fast, &never).as_ref());
    let total = sum(&denoised.layers[0], &denoised.layers[1]);
    for (value, expected) in total.rgb.iter().flatten().zip(denoised.picture.rgb.iter().flatten()) {
        // Each layer is rounded twice.
        assert!((value - expected).abs() <= 4.0 * f32::EPSILON * expected, "{value}, not {expected}");
    }
    // Each layer is close to the one that is denoised alone
    let alone = denoise(&key, &aovs, Quality::Fast, &never).unwrap();
    let difference = |(a, b): (&f32, &f32)| (a - b).abs();
    let error: f32 = denoised.layers[0].rgb.iter().flatten().zip(alone.rgb.iter().flatten()).map(difference).sum();
    assert!(error < 0.1 * alone.rgb.iter().flatten().sum::<f32>(), "{error}");
}

#[test]
fn a_picture_without_noise_stays_as_it_is_and_so_do_its_layers() {
    let (picture, mut aovs) = disc(61, 45);
    let scaled = |part: f32| {
        let rgb = picture.rgb.iter().map(|rgb| rgb.map(|value| value * part)).collect();
        Picture { rgb, ..picture.clone() }
    };
    let layers = [scaled(0.25), scaled(0.75)];
    aovs.relative_variance.fill(0.0);
    let denoised = denoise_layers(&picture, &layers, &aovs, Quality::Fast, &never).unwrap();
    assert_eq!(denoised.picture, picture);
    for (denoised, layer) in denoised.layers.iter().zip(&layers) {
        let values = denoised.rgb.iter().flatten().zip(layer.rgb.iter().flatten());
        values.for_each(|(a, b)| assert!((a - b).abs() <= 1e-6 * b, "{a}, not {b}"));
    }
    // Where nothing is known of the noise, the network decides
    aovs.relative_variance.fill(f32::INFINITY);
    assert_ne!(denoise(&picture, &aovs, Quality::Fast, &never), Ok(picture));
}

#[test]
fn the_weights_in_the_program_are_whole() {
    for (quality, weights) in [(Quality::Best, BEST_WEIGHTS), (Quality::Fast, FAST_WEIGHTS)] {
        assert!(quality.network().is_some());
        assert_eq!(WeightFile::parse(&weights[..weights.len() - 1]).err(), Some(WeightError::Truncated));
    }
    // A network whose layers do not fit together is refused
    let name = b"dec_conv1a.bias";
    let at = FAST_WEIGHTS.windows(name.len()).position(|window| window == name).unwrap();
    let mut other = FAST_WEIGHTS.to_vec();
    other[at + name.len() + 1] = 16;
    let error = Network::new(&WeightFile::parse(&other).unwrap(), InstructionSet::Portable).err();
    assert_eq!(error, Some(WeightError::Shape("dec_conv1a.weight".to_owned(), vec![32, 41, 3, 3])));
    other[at] = b'x';
    let error = Network::new(&WeightFile::parse(&other).unwrap(), InstructionSet::Portable).err();
    assert_eq!(error, Some(WeightError::Missing("dec_conv1a.bias".to_owned())));
}

#[test]
fn the_network_is_the_same_for_shifts_by_its_period() {
    // Away from the border, a picture shifted by 32 pixels has features shifted by 32 pixels.
    let network = fast_network(InstructionSet::best());
    let (width, height) = (320, 224);
    let run = |shift: usize| {
        let mut input = FeatureMap::new(width, height, INPUT_CHANNELS);
        let shape = input.shape;
        for (y, row) in input.data_mut().chunks_mut(shape.len()).enumerate() {
            for (x, pixel) in row[LEFT..LEFT + width].iter_mut().enumerate() {
                let place = (x + shift) as f32;
                *pixel = Block(std::array::from_fn(|c| {
                    if c < INPUT_CHANNELS { 0.5 + 0.4 * (place * 0.3 + (y * c) as f32 * 0.1).sin() } else { 0.0 }
                }));
            }
        }
        network.run(&input, &never).unwrap()
    };
    let (here, there) = (run(0), run(PERIOD));
    for y in 96..height - 96 {
        let row = |pixels: &[[f32; 3]], from: usize, to: usize| pixels[y * width + from..y * width + to].to_vec();
        let (first, last) = (96, width - 96);
        assert_eq!(row(&here, first + PERIOD, last), row(&there, first, last - PERIOD), "row {y}");
    }
}
