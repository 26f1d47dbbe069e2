use super::*;
use crate::scene::{Aim, BarnDoors, Emitter, NamedModifier, Output};

const KINDS: [ModifierKind; 11] = [
    ModifierKind::Bare,
    ModifierKind::Softbox,
    ModifierKind::Octa,
    ModifierKind::Umbrella,
    ModifierKind::ShootThrough,
    ModifierKind::Dish,
    ModifierKind::Reflector,
    ModifierKind::Snoot,
    ModifierKind::Projector,
    ModifierKind::Frame,
    ModifierKind::Lantern,
];

/// Kinds with what hangs before their front on the set, too.
fn reaches_ahead(shape: &ModifierShape) -> bool {
    shape.has_grid || shape.doors.is_some() || shape.kind == ModifierKind::Umbrella
}

fn named(modifier: &NamedModifier) -> Light {
    let light = Light::new(modifier.emitter, Output::Lumens(1000.0));
    Light { modifier: modifier.modifier, ..light }
}

fn scene(light: Light) -> Scene {
    Scene { lights: vec![light], bodies: Bodies::On, ..Scene::default() }
}

/// Returns six times the volume of a mesh: positive if its front faces are outside.
fn volume(mesh: &Mesh) -> f64 {
    let corners = (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle).map(|corner| corner.as_dvec3()));
    corners.map(|[a, b, c]| a.dot(b.cross(c))).sum()
}

#[test]
fn every_body_is_closed_finite_and_compact_from_nothing_to_ten_metres() {
    for kind in KINDS {
        for size in [0.0, 1e-3, 0.18, 0.6, 1.2, 10.0] {
            for (has_grid, doors) in [(false, None), (true, Some(BarnDoors::HALF_OPEN))] {
                let shape = ModifierShape { kind, front_m: Vec2::new(size, 1.5 * size), has_grid, doors };
                let mesh = PieceShape::Modifier(shape).mesh();
                let name = format!("{kind:?} of {size} m");
                let numbers = mesh.positions.iter().chain(&mesh.normals);
                assert!(numbers.into_iter().all(|vector| vector.is_finite()), "{name}");
                assert!(mesh.is_closed(), "{name}");
                let count = mesh.triangles.len();
                assert!((12..2500).contains(&count) || size == 0.0, "{name}: {count}");
                assert!(volume(&mesh) > 0.0 || size == 0.0, "{name}: {}", volume(&mesh));
                assert_eq!(mesh.parts.last().unwrap().triangles.end as usize, mesh.triangles.len(), "{name}");
                assert!(mesh.parts.windows(2).all(|pair| pair[0].triangles.end == pair[1].triangles.start), "{name}");
            }
        }
    }
    for (height_m, boom_m) in [(0.0, 0.0), (1e-3, 1e-3), (2.0, 0.0), (4.0, 1.5), (1000.0, 1000.0)] {
        let mesh = PieceShape::Stand { height_m, boom_m }.mesh();
        assert!(mesh.is_closed() && mesh.positions.iter().all(|p| p.is_finite()), "{height_m} m");
    }
}

#[test]
fn no_body_reaches_before_its_emitter_but_what_hangs_there_on_the_set() {
    for modifier in &NamedModifier::ALL {
        let shape = ModifierShape::of(&named(modifier)).unwrap();
        let (low, _) = PieceShape::Modifier(shape).mesh().bounds();
        let is_round = matches!(modifier.emitter, Emitter::Sphere { .. });
        let front_m = if is_round { -0.5 * shape.front_m.x } else { 0.5e-3 };
        assert_eq!(low.z < front_m, reaches_ahead(&shape), "{}: {}", modifier.name, low.z);
        // All of the luminous front lies over the body's own
        let (low, high) = PieceShape::Modifier(ModifierShape { has_grid: false, doors: None, ..shape }).mesh().bounds();
        let half = 0.5 * shape.front_m;
        let covers = low.truncate().cmple(-half + 2e-3).all() && high.truncate().cmpge(half - 2e-3).all();
        assert!(covers, "{}: {low} {high}", modifier.name);
    }
}

#[test]
fn equal_keys_mean_equal_meshes() {
    let shapes: Vec<PieceShape> = NamedModifier::ALL
        .iter()
        .filter_map(|modifier| ModifierShape::of(&named(modifier)))
        .map(PieceShape::Modifier)
        .chain([(1.0, 0.0), (1.0, 1.5), (2.0, 0.0)].map(|(height_m, boom_m)| PieceShape::Stand { height_m, boom_m }))
        .collect();
    for a in &shapes {
        for b in &shapes {
            assert_eq!(a.key() == b.key(), a.mesh() == b.mesh(), "{a:?} {b:?}");
        }
    }
}

#[test]
fn a_stand_reaches_from_the_floor_to_the_head_and_a_steep_softbox_hangs_on_a_boom() {
    let mut light = named(NamedModifier::named("Softbox 60 x 90").unwrap());
    (light.position, light.aim) = (Vec3::new(1.0, 2.0, 1.0), Aim::Point(Vec3::new(0.0, 1.5, 0.0)));
    let body = scene(light.clone()).light_body(&light).unwrap();
    assert!(!body.has_boom() && body.is_seen);
    let [modifier, stand] = body.pieces()[..] else { panic!("{:?}", body.pieces()) };
    let hold = modifier.world_from_piece.transform_point3(Vec3::Z * 0.3);
    let (low, high) = stand.shape.mesh().bounds();
    let foot = stand.world_from_piece.transform_point3(Vec3::ZERO);
    assert!((foot - hold.with_y(0.0)).length() < 1e-5 && (high.y - hold.y).abs() < 1e-5 && low.y > -0.01);

    // Straight down over the middle of a small room: the foot is beside what is lit, and in the room
    (light.position, light.aim) = (Vec3::new(0.0, 2.4, 0.0), Aim::Point(Vec3::ZERO));
    let mut scene = scene(light.clone());
    scene.room = Some(Room { size_m: Vec3::new(3.0, 3.0, 2.0), ..Room::default() });
    let body = scene.light_body(&light).unwrap();
    assert!(body.has_boom());
    let stand = body.pieces()[1];
    let foot = stand.world_from_piece.transform_point3(Vec3::ZERO);
    let PieceShape::Stand { boom_m, height_m } = stand.shape else { panic!() };
    let head = stand.world_from_piece.transform_point3(Vec3::new(boom_m, height_m, 0.0));
    assert!(foot.x.abs() <= 1.06 && foot.z.abs() <= 0.56 && foot.length() > 0.5, "{foot}");
    assert!((head - Vec3::new(0.0, 2.7, 0.0)).length() < 1e-4, "{head}");

    (light.position.y, light.aim) = (0.1, Aim::Point(Vec3::new(5.0, 0.1, 0.0)));
    assert_eq!(scene.light_body(&light).unwrap().pieces().len(), 1, "it lies on the floor");
}

#[test]
fn a_light_may_differ_from_the_studio_and_a_sun_has_no_body() {
    let mut light = named(NamedModifier::named("Octa 120").unwrap());
    let mut scene = scene(light.clone());
    for (studio, own, seen) in [
        (Bodies::Off, BodyChoice::AsStudio, None),
        (Bodies::On, BodyChoice::AsStudio, Some(true)),
        (Bodies::InReflections, BodyChoice::AsStudio, Some(false)),
        (Bodies::Off, BodyChoice::On, Some(true)),
        (Bodies::On, BodyChoice::InReflections, Some(false)),
        (Bodies::On, BodyChoice::Off, None),
    ] {
        (scene.bodies, light.body) = (studio, own);
        assert_eq!(scene.light_body(&light).map(|body| body.is_seen), seen, "{studio:?} {own:?}");
    }
    light.body = BodyChoice::On;
    light.emitter = Emitter::Surround;
    assert_eq!(scene.light_body(&light), None);
}

#[test]
fn the_number_of_bodies_is_bounded() {
    let light = named(NamedModifier::named("Octa 120").unwrap());
    let scene = Scene { lights: vec![light; 1000], bodies: Bodies::On, ..Scene::default() };
    assert_eq!(scene.light_bodies().count(), MOST_BODIES);
}

#[test]
fn a_body_before_the_camera_is_warned_of_until_it_is_hidden() {
    let mut light = named(NamedModifier::named("Octa 120").unwrap());
    let mut scene = scene(light.clone());
    let camera = &scene.camera;
    let ahead = (scene.aim_point(&camera.aim, camera.position) - camera.position).normalize();
    light.position = camera.position + 3.0 * ahead;
    let warnings = |scene: &Scene| {
        let findings = crate::scene::placement(scene, &crate::scene::Assets::default());
        findings.into_iter().filter(|finding| finding.message.contains("stands in the picture")).count()
    };
    scene.lights = vec![light.clone()];
    assert_eq!(warnings(&scene), 1);
    // Also one that is off stands there; one behind the camera does not
    scene.lights[0].on = false;
    assert_eq!(warnings(&scene), 1);
    scene.lights[0].position = scene.camera.position - 3.0 * ahead;
    assert_eq!(warnings(&scene), 0);
    light.visible_to_camera = true;
    light.hide_from_camera();
    scene.lights = vec![light.clone()];
    assert!(warnings(&scene) == 0 && !scene.camera_sees_light(&light) && scene.light_body(&light).is_some());
}
