//! Layout, direct light, metals and glass of the shipped studios against the path tracer.

use super::*;

#[test]
fn every_shipped_studio_has_the_layout_of_the_tracer_and_is_not_black() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    for preset in catchlight::io::presets() {
        let name = preset.file_name;
        let loaded = hairless(shipped(preset.file_name));
        let (width, height) = loaded.scene.camera.picture_size(300);
        let input = PreviewInput::camera_view(&loaded.scene, &loaded.assets, (width, height));
        let picture = renderer.picture(&input).unwrap();
        let bright = picture.pixels().filter(|p| p.0.iter().any(|c| *c > 24)).count();
        assert!(bright as f32 > 0.02 * (width * height) as f32, "{name} is black but for {bright} pixels");

        let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
        let traced = raytrace::primary_objects(&prepared, width, height);
        let mask = renderer.object_mask().unwrap();
        let id_of = |index: &u32| loaded.scene.objects.get(*index as usize).map(|object| object.id);
        let pairs: Vec<_> = mask.objects.iter().copied().zip(traced.iter().map(id_of)).collect();
        for object in &loaded.scene.objects {
            let count = |a: bool, b: bool| {
                let is = |id: Option<ObjectId>| id == Some(object.id);
                pairs.iter().filter(|(ours, theirs)| is(*ours) == a && is(*theirs) == b).count()
            };
            let (both, either) = (count(true, true), count(true, true) + count(true, false) + count(false, true));
            // Outlines may differ by rounding: small objects are mostly outline.
            let allowed = (0.02 * either as f32).max(6.0);
            assert!((either - both) as f32 <= allowed, "{name}: {} overlaps by {both} of {either}", object.name);
        }
    }
}

#[test]
fn direct_light_on_a_figure_agrees_with_the_tracer() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    // Limits in stops: median and 90th percentile. A twentieth of a stop is invisible; penumbras deviate more. Rim
    // light alone is compared light by light, see `each_light`.
    let studios = [
        ("three_point", 0.03, 0.15),
        ("rembrandt", 0.03, 0.2),
        ("product_still_life", 0.03, 0.3),
        ("window_light", 0.03, 0.2),
        ("split", 0.08, 0.45),
    ];
    for (name, median_limit, tenth_limit) in studios {
        let mut loaded = hairless(shipped(name));
        // Replace mirrors and glass, since the preview does not trace reflections, and skin, which has a test of its own
        for object in &mut loaded.scene.objects {
            // Clear glass may be white, other surfaces not.
            let base_color = object.material.base_color.map(|c| c.min(0.95));
            let hard = Material { subsurface: None, ..object.material.clone() };
            let matte = Material { metallic: 0.0, transmission: 0.0, roughness: 0.7, ..hard };
            object.material = Material { base_color, ..matte };
            object.part_materials.clear();
        }
        let (width, height) = loaded.scene.camera.picture_size(96);
        let input = PreviewInput {
            options: Options::direct_only(),
            ..PreviewInput::camera_view(&loaded.scene, &loaded.assets, (width, height))
        };
        let ours = blocks(&renderer.linear_picture(&input).unwrap());
        let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
        let settings = raytrace::Settings {
            width,
            height,
            spp: 32,
            method: raytrace::Method::Direct,
            ..raytrace::Settings::default()
        };
        let film = raytrace::render(&prepared, &settings, &raytrace::RenderControl::new(), &mut |_| {
            std::ops::ControlFlow::Continue(())
        });
        let theirs = blocks(&film.develop(&loaded.scene));
        let mut errors: Vec<f32> = ours
            .iter()
            .zip(&theirs)
            .filter(|(_, traced)| **traced > 0.02)
            .map(|(preview, traced)| (preview / traced).log2().abs())
            .collect();
        errors.sort_by(f32::total_cmp);
        let (median, tenth_worst) = (errors[errors.len() / 2], errors[errors.len() * 9 / 10]);
        println!("{name}: median {median:.3} stops, 90 % within {tenth_worst:.3}");
        assert!(median < median_limit && tenth_worst < tenth_limit, "{name}: {median} and {tenth_worst} stops");
    }
}

#[test]
fn chrome_gold_and_glass_are_close_to_the_traced_picture() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let loaded = shipped("product_still_life");
    let (width, height) = (192, 108);
    let input = PreviewInput::camera_view(&loaded.scene, &loaded.assets, (width, height));
    let ours = renderer.linear_picture(&input).unwrap();
    let mask = renderer.object_mask().unwrap();
    let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
    let settings = raytrace::Settings { width, height, spp: 32, ..raytrace::Settings::default() };
    let film = raytrace::render(&prepared, &settings, &raytrace::RenderControl::new(), &mut |_| {
        std::ops::ControlFlow::Continue(())
    });
    let theirs = film.develop(&loaded.scene);
    // Limits of the median in stops. Missing are reflections and refractions of objects, and shadows in reflections.
    for (preset, limit) in LOOKS {
        let object = loaded.scene.objects.iter().find(|o| o.material == preset.material()).unwrap();
        let display_luminance = |picture: &Picture, i: usize| {
            // Differences above white and below black are invisible
            color::luminance(picture.rgb[i].into()).clamp(0.02, 1.0)
        };
        let pixels = (0..mask.objects.len()).filter(|i| mask.objects[*i] == Some(object.id));
        let mut errors: Vec<f32> =
            pixels.map(|i| (display_luminance(&ours, i) / display_luminance(&theirs, i)).log2().abs()).collect();
        errors.sort_by(f32::total_cmp);
        let median = errors[errors.len() / 2];
        println!("{preset:?}: median {median:.3} stops over {} pixels", errors.len());
        assert!(median < limit, "{preset:?}: {median} stops");
    }
}

/// Materials of the still life and the limits of their median error, stops.
const LOOKS: [(MaterialPreset, f32); 3] =
    [(MaterialPreset::Chrome, 0.28), (MaterialPreset::Gold, 0.36), (MaterialPreset::ClearGlass, 0.5)];

/// Returns the mean luminance of blocks of 4 x 4 pixels.
fn blocks(picture: &Picture) -> Vec<f32> {
    let (columns, rows) = (picture.width / 4, picture.height / 4);
    let mean = |block: u32| {
        let (x, y) = (block % columns * 4, block / columns * 4);
        let pixel = |i: u32| color::luminance(picture.at(x + i % 4, y + i / 4).into());
        (0..16).map(pixel).sum::<f32>() / 16.0
    };
    (0..columns * rows).map(mean).collect()
}
