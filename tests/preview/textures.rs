//! Texture filtering at a distance and at grazing angles.

use super::*;
use catchlight::preview::Channel;
use catchlight::scene::Mesh;

const SIZE: (u32, u32) = (300, 200);
/// Texels along each side of a texture that covers 12 m of floor.
const TEXELS: u32 = 1024;

/// Draws a textured floor from half a metre above, looking along it. Returns the floor point of each pixel, and its
/// base colour relative to the material's.
fn grazing_floor(renderer: &mut PreviewRenderer, is_white: impl Fn(u32, u32) -> bool) -> Vec<(Vec3, f32)> {
    let mut assets = Assets::default();
    let code = |i: u32| if is_white(i % TEXELS, i / TEXELS) { [255; 3] } else { [0; 3] };
    let rgb = (0..TEXELS * TEXELS).map(code).collect();
    assets.insert_texture(TextureRef::file("floor.png"), Arc::new(Texture::opaque(TEXELS, TEXELS, rgb)));
    let lamp = light(0, Vec3::Y * 3.0, Vec3::ZERO, Emitter::Point, Output::Candela(10.0));
    let mut scene = floor_under(lamp);
    scene.objects[0].material.textures.base_color = Some(TextureRef::file("floor.png"));
    let position = Vec3::new(0.0, 0.5, 6.0);
    scene.camera = Camera { position, aim: Aim::Point(position - Vec3::Z), ..scene.camera };
    let options = Options { channel: Channel::BaseColor, ..Options::direct_only() };
    let input = PreviewInput { options, ..PreviewInput::camera_view(&scene, &assets, SIZE) };
    let picture = renderer.linear_picture(&input).unwrap();
    let pixels = (0..SIZE.0 * SIZE.1).filter_map(|i| {
        let (x, y) = (i % SIZE.0, i / SIZE.0);
        let point = floor_at(&input.frame, SIZE, (x, y))?;
        let inside = point.x.abs() < 5.5 && point.z.abs() < 5.5;
        inside.then(|| (point, picture.at(x, y)[1] / grey_card().base_color[1]))
    });
    pixels.collect()
}

#[test]
fn a_fine_checkerboard_at_a_distance_is_uniform_grey() {
    let Some(mut renderer) = shared_renderer() else { return };
    // Squares of one texel, 12 mm: from 6 m on a pixel covers 30 mm across and ten times that along.
    let far: Vec<f32> = grazing_floor(&mut renderer, |x, y| (x + y) % 2 == 0)
        .into_iter()
        .filter_map(|(point, shown)| (point.z < 0.0).then_some(shown))
        .collect();
    assert!(far.len() > 1000, "{} pixels", far.len());
    // The colour of the G-buffer has ten bits of square roots.
    for shown in far {
        assert!((shown - 0.5).abs() < 0.01, "{shown} instead of half the light");
    }
}

#[test]
fn stripes_along_the_view_are_resolved_at_a_grazing_angle() {
    let Some(mut renderer) = shared_renderer() else { return };
    // Stripes of 0.38 m. At 8 m a pixel covers 4 cm across and 0.65 m along: an isotropic filter would blur them
    // to grey.
    let stripes = grazing_floor(&mut renderer, |x, _| x / 32 % 2 == 0);
    let row = stripes.iter().filter(|(point, _)| (point.z + 2.0).abs() < 0.4 && point.x.abs() < 3.0);
    let (low, high) = row.fold((f32::MAX, 0.0_f32), |(low, high), (_, shown)| (low.min(*shown), high.max(*shown)));
    assert!(low < 0.15 && high > 0.85, "{low} to {high} of the base colour");
}

/// A square of 8 x 8 quads from (-1, -1) to (1, 1) that faces +Z, whose red rises to the right and whose green rises
/// upwards.
fn coloured_square() -> Mesh {
    let mut mesh = Mesh::default();
    for (x, y) in (0..9).flat_map(|y| (0..9).map(move |x| (x as f32 / 8.0, y as f32 / 8.0))) {
        mesh.positions.push(Vec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, 0.0));
        mesh.colors.push(Vec3::new(x, y, 0.25));
    }
    for v in (0..8).flat_map(|y| (0..8).map(move |x| y * 9 + x)) {
        mesh.triangles.extend([[v, v + 1, v + 10], [v, v + 10, v + 9]]);
    }
    mesh.with_single_part("square")
}

#[test]
fn vertex_colors_are_factors_of_the_base_color_in_every_renderer() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut assets = Assets::default();
    assets.insert_mesh("square.obj", Arc::new(coloured_square()));
    let square = object(0, Shape::MeshFile { path: "square.obj".into() }, Vec3::ZERO, grey_card());
    let camera = Camera {
        position: Vec3::Z * 4.0,
        aim: Aim::Point(Vec3::ZERO),
        focal_length_mm: 100.0,
        shutter_s: 0.02,
        ..Camera::default()
    };
    let sun = light(0, Vec3::Z * 3.0, Vec3::ZERO, Emitter::Sun { angular_diameter_deg: 0.0 }, Output::Lux(5000.0));
    let scene = Scene { camera, objects: vec![square], lights: vec![sun], ..Scene::default() };
    let size = (96, 64);
    let input = PreviewInput { options: Options::direct_only(), ..PreviewInput::camera_view(&scene, &assets, size) };
    let preview = renderer.linear_picture(&input).unwrap();
    let prepared = raytrace::prepare(&scene, &assets).unwrap();
    let settings =
        raytrace::Settings { width: 96, height: 64, spp: 16, method: raytrace::Method::Direct, ..Default::default() };
    let film = raytrace::render(&prepared, &settings, &raytrace::RenderControl::new(), &mut |_| {
        std::ops::ControlFlow::Continue(())
    });
    let traced = film.develop(&scene);
    let raster = catchlight::raster::draw(&scene, &assets, &input.frame, size, Default::default()).picture;
    let white = 0.18 * 5000.0 / PI * scene.camera.shutter_s * exposure::pixel_per_cd_s_m2(&scene);
    for (x, y) in [(48, 32), (40, 24), (56, 40), (60, 24)] {
        let at = input.frame.direction(Vec2::new((x as f32 + 0.5) / 96.0, (y as f32 + 0.5) / 64.0));
        let point = at * (4.0 / -at.z);
        let expected = Vec3::new((point.x + 1.0) / 2.0, (point.y + 1.0) / 2.0, 0.25) * white;
        // The CPU raster shows the mean colour of a triangle: an eighth wide, off by a 24th at its corners.
        for (name, picture, tolerance) in
            [("preview", &preview, 0.006), ("tracer", &traced, 0.006), ("raster", &raster, 0.06)]
        {
            let off = (Vec3::from(picture.at(x, y)) - expected).abs() / white;
            assert!(off.max_element() < tolerance, "{name} at {x}, {y}: off by {off} of white, {expected}");
        }
    }
}
