//! A small studio against stored pictures of each channel.
//!
//! To accept an intended change after inspection: `CATCHLIGHT_ACCEPT=1 cargo test --test preview stored`.

use super::*;
use catchlight::preview::Channel;
use image::RgbImage;
use std::path::Path;

const SIZE: (u32, u32) = (96, 64);
/// Side of a block, pixels.
const BLOCK: u32 = 8;
/// Codes of 255 by which a picture may differ in the mean and in its worst block. Adapters differ in the coverage of
/// edge pixels (a few in a block, each by up to a hundred codes) and in rounding.
const LIMITS: (f32, f32) = (0.5, 6.0);

/// A room with each kind of surface and each kind of light.
fn studio() -> Scene {
    let key = Emitter::RectPanel { width_m: 0.8, height_m: 1.2 };
    let octa = Emitter::RoundPanel { diameter_m: 1.0 };
    let spot = Emitter::Spot { inner_deg: 20.0, outer_deg: 35.0 };
    let gold = Material { base_color: [0.9, 0.6, 0.2], metallic: 1.0, roughness: 0.3, ..Material::default() };
    let red = Material { base_color: [0.6, 0.05, 0.05], roughness: 0.2, ..Material::default() };
    let glass = MaterialPreset::ClearGlass.material();
    let ball = Shape::Sphere { radius_m: 0.4 };
    let column = Shape::Cylinder { radius_m: 0.25, height_m: 1.0 };
    let mut cube = object(2, Shape::Box { size_m: Vec3::splat(0.6) }, Vec3::new(0.9, 0.3, 0.1), red);
    cube.transform.rotation_deg = Vec3::Y * 30.0;
    let lamp = |id: u32, place: Vec3, emitter: Emitter, lumens: f32| {
        light(id, place, Vec3::Y * 0.4, emitter, Output::Lumens(lumens))
    };
    Scene {
        room: Some(Room::default()),
        camera: Camera {
            position: Vec3::new(0.6, 1.4, 3.6),
            aim: Aim::Point(Vec3::Y * 0.4),
            focal_length_mm: 40.0,
            shutter_s: 0.1,
            f_number: 4.0,
            iso: 100.0,
            ..Camera::default()
        },
        objects: vec![
            object(
                0,
                Shape::Sweep { width_m: 3.0, height_m: 2.0, depth_m: 3.0, radius_m: 0.5 },
                Vec3::Z * -1.5,
                grey_card(),
            ),
            object(1, ball, Vec3::new(-0.2, 0.4, 0.0), gold),
            cube,
            object(3, column, Vec3::new(-0.9, 0.5, -0.2), grey_card()),
            object(4, Shape::Sphere { radius_m: 0.2 }, Vec3::new(0.3, 0.2, 0.8), glass),
        ],
        lights: vec![
            lamp(0, Vec3::new(1.8, 2.0, 1.4), key, 20_000.0),
            lamp(1, Vec3::new(-2.0, 1.6, 1.6), octa, 6000.0),
            lamp(2, Vec3::new(-1.0, 2.6, -0.8), spot, 3000.0),
            lamp(3, Vec3::new(1.2, 0.8, -0.8), Emitter::Sphere { radius_m: 0.06 }, 3000.0),
            lamp(4, Vec3::new(0.0, 2.8, 0.5), Emitter::Point, 1500.0),
        ],
        ..Scene::default()
    }
}

#[test]
fn a_small_studio_equals_its_stored_pictures_in_every_channel() {
    let Some(mut renderer) = shared_renderer() else { return };
    let (scene, assets) = (studio(), Assets::default());
    let mut wrong = Vec::new();
    for (channel, name) in [
        (Channel::Lit, "lit"),
        (Channel::BaseColor, "base_color"),
        (Channel::Normal, "normal"),
        (Channel::Depth, "depth"),
        (Channel::Ids, "ids"),
    ] {
        let options = Options { channel, ..Options::default() };
        let input = PreviewInput { options, ..PreviewInput::camera_view(&scene, &assets, SIZE) };
        wrong.extend(compare(name, &renderer.picture(&input).unwrap()));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Compares a picture with the stored one. On a mismatch writes both and their difference, and returns a message.
fn compare(name: &str, actual: &RgbImage) -> Option<String> {
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/preview/stored/{name}.png"));
    if std::env::var_os("CATCHLIGHT_ACCEPT").is_some() {
        actual.save(&stored).unwrap();
        return None;
    }
    let expected = image::open(&stored).unwrap().to_rgb8();
    assert_eq!(actual.dimensions(), expected.dimensions(), "{name}");
    let difference = RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| {
        let (a, b) = (actual.get_pixel(x, y).0, expected.get_pixel(x, y).0);
        image::Rgb(std::array::from_fn(|i| a[i].abs_diff(b[i])))
    });
    let mean_over = |x: u32, y: u32, width: u32, height: u32| {
        let codes = (0..width * height).flat_map(|i| difference.get_pixel(x + i % width, y + i / width).0);
        codes.map(f32::from).sum::<f32>() / (3 * width * height) as f32
    };
    let mean = mean_over(0, 0, SIZE.0, SIZE.1);
    let corners = (0..SIZE.1 / BLOCK).flat_map(|y| (0..SIZE.0 / BLOCK).map(move |x| (x * BLOCK, y * BLOCK)));
    let worst = corners.map(|(x, y)| mean_over(x, y, BLOCK, BLOCK)).fold(0.0, f32::max);
    (mean > LIMITS.0 || worst > LIMITS.1).then(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        for (kind, picture) in [("actual", actual), ("expected", &expected), ("difference", &difference)] {
            picture.save(folder.join(format!("preview_{name}_{kind}.png"))).unwrap();
        }
        format!(
            "{name}: {mean:.2} codes in the mean, {worst:.1} in the worst block; see {}/preview_{name}_*.png. To accept it: \
             CATCHLIGHT_ACCEPT=1 cargo test --test preview stored",
            folder.display()
        )
    })
}
