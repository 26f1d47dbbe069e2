//! Shadows of a few pixels' width, in pictures of several sizes.

use super::*;

/// Returns thin posts on a floor under a small light, with the camera at the side.
fn posts(post_m: f32, emitter: Emitter) -> Scene {
    let mut scene = floor_under(light(0, Vec3::new(-1.5, 4.0, -3.0), Vec3::ZERO, emitter, Output::Lumens(60_000.0)));
    for i in 0..5 {
        let size_m = Vec3::new(post_m, 1.5, post_m);
        let place = Vec3::new(0.8 * i as f32 - 1.6, 0.75, -0.5);
        scene.objects.push(object(i + 1, Shape::Box { size_m }, place, grey_card()));
    }
    scene.camera.focal_length_mm = 50.0;
    scene
}

/// Returns the points on the floor in the middle of the posts' shadows.
fn shadow_middles(scene: &Scene) -> Vec<Vec3> {
    let light = scene.lights[0].position;
    let posts = scene.objects.iter().skip(1).map(|object| object.transform.position);
    posts
        .flat_map(|post| {
            (2..12).map(move |step| {
                // The shadow of a point of the post's axis.
                let height = 0.1 * step as f32;
                let top = post.with_y(height);
                top + (top - light) * (height / (light.y - height))
            })
        })
        .collect()
}

/// Returns the median of the light that is left in the middle of the shadows, relative to the light without shadows.
fn light_left(renderer: &mut PreviewRenderer, scene: &Scene, width: u32) -> f32 {
    let mut input = direct(scene, (width, width * 2 / 3));
    let shadowed = renderer.linear_picture(&input).unwrap();
    input.options.shadows = false;
    let open = renderer.linear_picture(&input).unwrap();
    let size = Vec2::new(width as f32, (width * 2 / 3) as f32);
    let mut left: Vec<f32> = shadow_middles(scene)
        .into_iter()
        .filter_map(|point| {
            let pixel = (input.frame.project(point)? * size).as_uvec2();
            (pixel.x < width && pixel.y < width * 2 / 3)
                .then(|| shadowed.at(pixel.x, pixel.y)[1] / open.at(pixel.x, pixel.y)[1])
        })
        .collect();
    assert!(left.len() > 30, "{} points are in the picture", left.len());
    left.sort_by(f32::total_cmp);
    left[left.len() / 2]
}

#[test]
fn thin_shadows_are_dark_in_small_pictures() {
    let Some(mut renderer) = shared_renderer() else { return };
    // Masks of half the picture's size left a fifth of the light in small pictures. The blur of the mask spans three
    // pixels: it leaves some of the light in a shadow of 3.5 pixels, which 5 cm are at 300 pixels, and none in wider
    // ones.
    for emitter in [Emitter::Point, Emitter::Sphere { radius_m: 0.01 }] {
        for (post_m, width, limit) in [(0.05, 300, 0.08), (0.05, 480, 0.01), (0.05, 720, 0.01), (0.08, 300, 0.01)] {
            let left = light_left(&mut renderer, &posts(post_m, emitter), width);
            assert!(left < limit, "{emitter:?}, posts of {post_m} m, {width} px: {left:.3} of the light is left");
        }
    }
}
