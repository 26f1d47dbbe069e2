//! Maps of roughness and metal, normals, glow and alpha: each renderer shows what constants, tilted geometry and
//! holes in the mesh would show.

use super::*;
use catchlight::raytrace::Method;
use catchlight::scene::{Alpha, Mesh, tessellate};

const SIZE: (u32, u32) = (96, 96);
/// Codes of the maps: of metal across, of roughness down.
const METALLIC: [u8; 3] = [0, 128, 255];
const ROUGHNESS: [u8; 3] = [64, 128, 255];

/// The three renderers' scene-linear pictures of a scene.
fn pictures(renderer: &mut PreviewRenderer, scene: &Scene, assets: &Assets, spp: u32) -> [(&'static str, Picture); 3] {
    pictures_with(renderer, scene, assets, spp, Options::direct_only())
}

/// As [`pictures`], with options of the preview.
fn pictures_with(
    renderer: &mut PreviewRenderer,
    scene: &Scene,
    assets: &Assets,
    spp: u32,
    options: Options,
) -> [(&'static str, Picture); 3] {
    let input = PreviewInput { options, ..PreviewInput::camera_view(scene, assets, SIZE) };
    let preview = renderer.linear_picture(&input).unwrap();
    let raster = catchlight::raster::draw(scene, assets, &input.frame, SIZE, Default::default()).picture;
    [("preview", preview), ("raster", raster), ("tracer", traced(scene, assets, spp))]
}

fn traced(scene: &Scene, assets: &Assets, spp: u32) -> Picture {
    let prepared = raytrace::prepare(scene, assets).unwrap();
    let settings =
        raytrace::Settings { width: SIZE.0, height: SIZE.1, spp, method: Method::Direct, ..Default::default() };
    let film = raytrace::render(&prepared, &settings, &raytrace::RenderControl::new(), &mut |_| {
        std::ops::ControlFlow::Continue(())
    });
    film.develop(scene)
}

/// Returns the mean of the absolute difference, and the mean of the first picture.
fn difference(a: &Picture, b: &Picture) -> (f32, f32) {
    let count = (a.rgb.len() * 3) as f32;
    let pairs = a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
    let off = pairs.map(|(a, b)| (a - b).abs()).sum::<f32>();
    (off / count, a.rgb.iter().flatten().sum::<f32>() / count)
}

/// A camera in front of the XY plane that sees 1.5 m of it.
fn camera() -> Camera {
    Camera {
        position: Vec3::Z * 6.0,
        aim: Aim::Point(Vec3::ZERO),
        sensor: catchlight::scene::Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 96.0,
        shutter_s: 0.02,
        ..Camera::default()
    }
}

/// A scene of one mesh file with a material, under two lamps.
fn scene_of(material: Material, mesh: Mesh, assets: &mut Assets) -> Scene {
    assets.insert_mesh("mesh.glb", Arc::new(mesh.with_single_part("mesh")));
    let lamps = [
        light(0, Vec3::new(2.0, 2.0, 4.0), Vec3::ZERO, Emitter::Sphere { radius_m: 0.3 }, Output::Lumens(40_000.0)),
        light(1, Vec3::new(-3.0, 1.0, 2.0), Vec3::ZERO, Emitter::Point, Output::Candela(2000.0)),
    ];
    let object = object(0, Shape::MeshFile { path: "mesh.glb".into() }, Vec3::ZERO, material);
    Scene { camera: camera(), objects: vec![object], lights: lamps.into(), ..Scene::default() }
}

fn centre(column: usize, row: usize) -> Vec3 {
    Vec3::new(column as f32 - 1.0, 1.0 - row as f32, 0.0) * 0.45
}

/// Nine spheres in one mesh; the texture coordinates of each are next to the centre of its third of a map. Equal
/// ones have no derivatives, by which a GPU chooses the mip level.
fn grid() -> Mesh {
    let mut grid = Mesh::default();
    for (column, row) in (0..9).map(|i| (i % 3, i / 3)) {
        let mut sphere = tessellate(&Shape::Sphere { radius_m: 0.2 }).unwrap();
        sphere.positions.iter_mut().for_each(|position| *position += centre(column, row));
        let uv = Vec2::new(column as f32 + 0.5, 2.5 - row as f32) / 3.0;
        let near = |position: &Vec3| uv + 1e-3 * (position - centre(column, row)).truncate();
        sphere.uvs = sphere.positions.iter().map(near).collect();
        grid.append(&sphere);
    }
    grid
}

#[test]
fn a_grid_of_spheres_by_a_map_is_the_grid_by_constants_in_every_renderer() {
    let Some(mut renderer) = shared_renderer() else { return };
    // A square of pixels a sphere: Mesa's software rasteriser blurs what is enlarged with its neighbours
    const SQUARE: usize = 8;
    let side = 3 * SQUARE;
    let code = |i: usize| [7, ROUGHNESS[i / side / SQUARE], METALLIC[i % side / SQUARE]];
    let codes = (0..side * side).map(code).collect();
    let map = TextureRef::file("gloss.png");
    let base = Material { base_color: [0.8, 0.5, 0.3], roughness: 0.8, metallic: 1.0, ..Material::default() };
    let textures = MaterialTextures { metallic_roughness: Some(map.clone()), ..MaterialTextures::default() };
    let mut assets = Assets::default();
    assets.insert_texture(map, Arc::new(Texture::opaque(side as u32, side as u32, codes)));
    let textured = scene_of(Material { textures, ..base.clone() }, grid(), &mut assets);
    let mut constant = textured.clone();
    assets.insert_mesh("ball.glb", Arc::new(tessellate(&Shape::Sphere { radius_m: 0.2 }).unwrap()));
    constant.objects = (0..9)
        .map(|i| {
            let (roughness, metallic) = (0.8 * f32::from(ROUGHNESS[i / 3]) / 255.0, f32::from(METALLIC[i % 3]) / 255.0);
            let material = Material { roughness, metallic, ..base.clone() };
            object(i as u32, Shape::MeshFile { path: "ball.glb".into() }, centre(i % 3, i / 3), material)
        })
        .collect();
    // Without shadows: those of one mesh are finer or coarser than those of nine
    let options = Options { shadows: false, ..Options::direct_only() };
    let [ours, truth] = [&textured, &constant].map(|scene| pictures_with(&mut renderer, scene, &assets, 64, options));
    for ((name, ours), (_, truth)) in ours.iter().zip(&truth) {
        let (off, mean) = difference(ours, truth);
        // The preview packs roughness in twelve bits; the tracer interpolates albedos, and its noise is that of other rays.
        let tolerance = if *name == "tracer" { 0.03 } else { 0.005 };
        println!("{name}: off by {:.3} % of the mean {mean}", 100.0 * off / mean);
        assert!(mean > 0.003 && off < tolerance * mean, "{name}: off by {off} of {mean}");
    }
}

/// A square from -0.7 to 0.7 that faces +Z, with the whole picture on it.
fn square() -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    Mesh {
        positions: corners.map(|(x, y)| Vec3::new(0.7 * x, 0.7 * y, 0.0)).to_vec(),
        normals: vec![Vec3::Z; 4],
        uvs: corners.map(|(x, y)| Vec2::new(0.5 + 0.5 * x, 0.5 + 0.5 * y)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// Adds a normal map of one tilt, 0.48 along +U and 0.36 along +V, and returns it with the tilt.
fn tilted_map(assets: &mut Assets) -> (TextureRef, Vec3) {
    let code = |value: f32| ((value * 0.5 + 0.5) * 255.0).round() as u8;
    let (map, tilt) = (TextureRef::file("normals.png"), Vec3::new(0.48, 0.36, 0.8));
    assets.insert_texture(map.clone(), Arc::new(Texture::opaque(1, 1, vec![tilt.to_array().map(code)])));
    (map, tilt)
}

#[test]
fn a_normal_map_of_one_tilt_is_a_mesh_with_tilted_normals_in_every_renderer() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut assets = Assets::default();
    let (map, tilt) = tilted_map(&mut assets);
    let plain = Material { roughness: 0.5, ..Material::default() };
    for (turn, mirror) in [(0.0, 1.0), (90.0, 1.0), (30.0, -1.0)] {
        // The picture turned and mirrored on the square: U and V run elsewhere
        let mut mesh = square();
        let rotation = Vec2::from_angle(f32::to_radians(turn));
        mesh.uvs.iter_mut().for_each(|uv| *uv = rotation.rotate(*uv) * Vec2::new(mirror, 1.0));
        let inverse = Vec2::from_angle(f32::to_radians(-turn));
        let along = inverse.rotate(Vec2::new(tilt.x * mirror, tilt.y));
        let textures = MaterialTextures { normal: Some(map.clone()), ..MaterialTextures::default() };
        let mapped = scene_of(Material { textures, ..plain.clone() }, mesh, &mut assets);
        let ours = pictures(&mut renderer, &mapped, &assets, 16);
        let normals = vec![along.extend(tilt.z).normalize(); 4];
        let tilted = scene_of(plain.clone(), Mesh { normals, ..square() }, &mut assets);
        let truth = pictures(&mut renderer, &tilted, &assets, 16);
        for ((name, ours), (_, truth)) in ours.iter().zip(&truth) {
            let (off, mean) = difference(ours, truth);
            println!("{name} turned by {turn}: off by {:.3} % of {mean}", 100.0 * off / mean);
            // The map has eight bits: half a step tilts by 0.2 degrees. The shadow terminator of the tracer sees the normals
            // of the mesh alone.
            assert!(mean > 0.003 && off < 0.02 * mean, "{name} turned by {turn}: off by {off} of {mean}");
        }
    }
}

#[test]
fn a_smooth_gloss_lies_over_the_relief_of_its_normal_map() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut assets = Assets::default();
    let (map, tilt) = tilted_map(&mut assets);
    // The gloss alone has the normal of the mesh, what is below it that of the map
    let gloss = Material { base_color: [0.0; 3], roughness: 0.3, ..Material::default() };
    let matte = Material { ior: 1.0, ..Material::default() };
    for (part, plain, normal) in [("gloss", gloss, Vec3::Z), ("matte", matte, tilt.normalize())] {
        let textures =
            MaterialTextures { normal: Some(map.clone()), smooth_gloss: true, ..MaterialTextures::default() };
        let mapped = scene_of(Material { textures, ..plain.clone() }, square(), &mut assets);
        let ours = pictures(&mut renderer, &mapped, &assets, 64);
        let truth = scene_of(plain, Mesh { normals: vec![normal; 4], ..square() }, &mut assets);
        let truth = pictures(&mut renderer, &truth, &assets, 64);
        // The rasteriser has one normal
        for ((name, ours), (_, truth)) in ours.iter().zip(&truth).filter(|((name, _), _)| *name != "raster") {
            let (off, mean) = difference(ours, truth);
            println!("{name}, {part}: off by {:.3} % of {mean}", 100.0 * off / mean);
            assert!(mean > 1e-4 && off < 0.02 * mean, "{name}, {part}: off by {off} of {mean}");
        }
    }
}

/// A cap of a sphere of a radius, in radii of its base, over the inscribed disc of [`square`], with its texture coordinates.
fn cap(radius: f32) -> Mesh {
    const RINGS: u32 = 48;
    const AROUND: u32 = 96;
    let mut mesh = Mesh::default();
    for (ring, k) in (0..=RINGS).flat_map(|ring| (0..AROUND).map(move |k| (ring, k))) {
        let angle = (1.0 / radius).asin() * ring as f32 / RINGS as f32;
        let (sin, cos) = angle.sin_cos();
        let around = Vec2::from_angle(std::f32::consts::TAU * k as f32 / AROUND as f32);
        let normal = (around * sin).extend(cos);
        mesh.positions.push((normal * radius - Vec3::Z * (radius * radius - 1.0).sqrt()) * 0.7);
        mesh.normals.push(normal);
        mesh.uvs.push((normal.truncate() * radius + Vec2::ONE) / 2.0);
    }
    let corner = |ring: u32, k: u32| ring * AROUND + k % AROUND;
    for (ring, k) in (0..RINGS).flat_map(|ring| (0..AROUND).map(move |k| (ring, k))) {
        let [a, b, c, d] = [(ring, k), (ring + 1, k), (ring + 1, k + 1), (ring, k + 1)].map(|(r, k)| corner(r, k));
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

#[test]
fn a_dome_without_refraction_shows_the_flat_picture_below_it_in_every_renderer() {
    let Some(mut renderer) = shared_renderer() else { return };
    // Stripes that fade to black before the edge: beyond its base a dome shows the edge
    const SIDE: usize = 128;
    let code = |i: usize| {
        let point = Vec2::new((i % SIDE) as f32, (i / SIDE) as f32) * (2.0 / SIDE as f32) - Vec2::ONE;
        let fade = (1.0 - point.length() / 0.9).clamp(0.0, 1.0).sqrt();
        let stripe = 0.5 + 0.5 * (point.x * 9.0 + point.y * 4.0).sin();
        [(255.0 * fade * stripe) as u8, (200.0 * fade) as u8, (200.0 * fade * (1.0 - stripe)) as u8]
    };
    let mut assets = Assets::default();
    let picture = Texture::opaque(SIDE as u32, SIDE as u32, (0..SIDE * SIDE).map(code).collect());
    let (map, tilt) = tilted_map(&mut assets);
    assets.insert_texture(TextureRef::file("stripes.png"), Arc::new(picture));
    for (degrees, normal) in [(0.0, Vec3::Z), (45.0, Vec3::Z), (-30.0, tilt)] {
        let mut textures = MaterialTextures::with_base_color(TextureRef::file("stripes.png"));
        textures.normal = (normal != Vec3::Z).then(|| map.clone());
        let turned = |dome_radius, mesh: Mesh, assets: &mut Assets| {
            let textures = MaterialTextures { dome_radius, ..textures.clone() };
            let mut scene = scene_of(Material { ior: 1.0, textures, ..Material::default() }, mesh, assets);
            scene.objects[0].transform.rotation_deg = Vec3::Y * degrees;
            // Far away, so that the height of the dome is nothing to the light
            scene.lights.iter_mut().for_each(|light| light.position *= 10.0);
            scene.lights.iter_mut().for_each(|light| light.power.output = Output::Candela(100_000.0));
            scene
        };
        let shown =
            |renderer: &mut PreviewRenderer, scene: &Scene, assets: &Assets| pictures(renderer, scene, assets, 64);
        let scene = turned(1.4, cap(1.4), &mut assets);
        let ours = shown(&mut renderer, &scene, &assets);
        let scene = turned(0.0, cap(1.4), &mut assets);
        let painted = shown(&mut renderer, &scene, &assets);
        let scene = turned(0.0, square(), &mut assets);
        let truth = shown(&mut renderer, &scene, &assets);
        for (((name, ours), (_, painted)), (_, truth)) in ours.iter().zip(&painted).zip(&truth) {
            let (off, mean) = difference(ours, truth);
            let (without, _) = difference(painted, truth);
            println!(
                "{name} at {degrees}: off by {:.2} %, painted {:.2} % of {mean}",
                100.0 * off / mean,
                100.0 * without / mean
            );
            assert!(mean > 1e-4 && off < 0.03 * mean, "{name} at {degrees}: off by {off} of {mean}");
            assert!(degrees == 0.0 || without > 0.2 * mean, "{name} at {degrees}: {without} of {mean}");
        }
    }
}

#[test]
fn a_map_of_glow_has_its_luminance_in_every_renderer() {
    let Some(mut renderer) = shared_renderer() else { return };
    // The left half glows red, the right half at an eighth in green: sRGB code 99 is 0.125
    let mut assets = Assets::default();
    let map = TextureRef::file("glow.png");
    assets.insert_texture(map.clone(), Arc::new(Texture::opaque(2, 1, vec![[255, 0, 0], [0, 99, 0]])));
    let mut textures = MaterialTextures { emission: Some(map), ..MaterialTextures::default() };
    textures.placements[2].nearest = true;
    let emission_cd_m2 = [40.0; 3];
    let glowing = Material { base_color: [0.0; 3], ior: 1.0, emission_cd_m2, textures, ..Material::default() };
    let mut scene = scene_of(glowing, square(), &mut assets);
    scene.lights.clear();
    let full = 40.0 * scene.camera.shutter_s * exposure::pixel_per_cd_s_m2(&scene);
    for (name, picture) in pictures(&mut renderer, &scene, &assets, 4) {
        for ((x, y), expected) in [((24, 48), Vec3::X), ((72, 30), Vec3::Y * 0.125)] {
            let shown = Vec3::from(picture.at(x, y)) / full;
            // The preview has six bits of square roots: a step at an eighth is 0.011
            assert!((shown - expected).abs().max_element() < 0.012, "{name}: {shown} instead of {expected}");
        }
    }
}

/// A square whose left half is cut out of its texture, and the same as a mesh.
fn half_there(assets: &mut Assets, alpha: Alpha) -> (Scene, Scene) {
    let texture = Texture { alpha: vec![20, 255], ..Texture::opaque(2, 1, vec![[255; 3]; 2]) };
    assets.insert_texture(TextureRef::file("holes.png"), Arc::new(texture));
    let mut textures = MaterialTextures::with_base_color(TextureRef::file("holes.png"));
    textures.placements[0].nearest = true;
    let masked = scene_of(Material { textures, alpha, ..grey_card() }, square(), assets);
    let mut half = square();
    half.positions.iter_mut().for_each(|position| position.x = position.x.max(0.0));
    assets.insert_mesh("half.glb", Arc::new(half.with_single_part("half")));
    let mut cut = masked.clone();
    cut.objects[0].material = grey_card();
    cut.objects[0].shape = Shape::MeshFile { path: "half.glb".into() };
    (masked, cut)
}

#[test]
fn a_masked_surface_is_a_mesh_with_a_hole_and_casts_the_shadow_of_one() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut assets = Assets::default();
    let (mut masked, mut cut) = half_there(&mut assets, Alpha::Mask { cutoff: 0.5 });
    for scene in [&mut masked, &mut cut] {
        // A wall behind it, on which the shadows of the two lamps fall
        let mut wall = object(1, Shape::Plane { width_m: 6.0, depth_m: 6.0 }, Vec3::Z * -0.8, grey_card());
        wall.transform.rotation_deg = Vec3::X * 90.0;
        scene.objects.push(wall);
    }
    let [ours, truth] = [&masked, &cut].map(|scene| pictures(&mut renderer, scene, &assets, 64));
    for ((name, ours), (_, truth)) in ours.iter().zip(&truth) {
        let (off, mean) = difference(ours, truth);
        println!("{name}: off by {:.3} % of {mean}", 100.0 * off / mean);
        assert!(mean > 0.003 && off < 0.015 * mean, "{name}: off by {off} of {mean}");
    }
    // The same bits for any number of threads: the choice is a hash of the ray
    let threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        let (blended, _) = half_there(&mut Assets::clone(&assets), Alpha::Blend { opacity: 0.5 });
        pool.install(|| traced(&blended, &assets, 4))
    };
    assert!(threads(1).rgb == threads(3).rgb);
}

#[test]
fn a_blended_surface_lets_its_part_of_the_light_pass() {
    // A wall behind a veil that covers 40 %: seen through it and lit through it by a sun along the view, the wall has 0.6
    // squared of its light; the veil itself adds 0.4 of its own.
    let mut assets = Assets::default();
    let veil = Material { base_color: [0.0; 3], alpha: Alpha::Blend { opacity: 0.4 }, ..grey_card() };
    let mut scene = scene_of(veil, square(), &mut assets);
    let mut wall = object(1, Shape::Plane { width_m: 6.0, depth_m: 6.0 }, Vec3::Z * -0.3, grey_card());
    wall.transform.rotation_deg = Vec3::X * 90.0;
    scene.objects.push(wall);
    let sun = Emitter::Sun { angular_diameter_deg: 0.0 };
    scene.lights = vec![light(0, Vec3::Z * 9.0, Vec3::ZERO, sun, Output::Lux(3000.0))];
    let picture = traced(&scene, &assets, 256);
    let lit = 3000.0 * 0.18 / PI * scene.camera.shutter_s * exposure::pixel_per_cd_s_m2(&scene);
    let middle = (30..66).flat_map(|y| (30..66).map(move |x| (x, y)));
    let mean = middle.map(|(x, y)| picture.at(x, y)[1]).sum::<f32>() / (36.0 * 36.0);
    // 331776 camera rays pass with probability 0.6: a standard error of 0.14 %
    assert_close(mean / lit, 0.6 * 0.6, 0.007, "through a veil");
}
