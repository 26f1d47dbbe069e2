//! Mutates every field of a scene and states its class.

use super::*;
use crate::scene::{
    Aim, Alpha, BarnDoors, ColorSource, Cone, Emitter, Facing, Focus, Gel, ObjectId, Orientation, Output, Receptor,
    Role, Sensor, Shape, Subsurface, TextureRef,
};
use crate::scene::{Anisotropy, Bodies, BodyChoice, Clearcoat, Sheen};
use glam::Vec3;

const LIGHT: LightId = LightId(3);

fn scene() -> Scene {
    let object = Object {
        id: ObjectId(1),
        part_materials: vec![("rim".to_owned(), Material::default())],
        ..Object::new("Vase", Shape::Sphere { radius_m: 0.2 })
    };
    let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let light = |id, on| Light { id, on, ..Light::new(panel, Output::Lumens(1000.0)) };
    let meter = Meter { position: Vec3::ZERO, facing: Facing::Camera, receptor: Receptor::Flat };
    Scene {
        room: Some(Room::default()),
        objects: vec![object],
        lights: vec![light(LIGHT, true), light(LightId(4), false)],
        meter: Some(meter),
        solo: Some(Solo { lights: vec![LIGHT], restores: vec![LIGHT] }),
        ..Scene::default()
    }
}

type Edit = fn(&mut Scene);

fn change_by(edit: Edit) -> SceneChange {
    let mut edited = scene();
    edit(&mut edited);
    assert_ne!(edited, scene(), "the edit changes the scene");
    SceneChange::between(&scene(), &edited)
}

fn assert_class(expected: SceneChange, edits: &[(&str, Edit)]) {
    for (field, edit) in edits {
        assert_eq!(change_by(*edit), expected, "{field}");
    }
}

fn room(scene: &mut Scene) -> &mut Room {
    scene.room.as_mut().unwrap()
}

fn meter(scene: &mut Scene) -> &mut Meter {
    scene.meter.as_mut().unwrap()
}

fn solo(scene: &mut Scene) -> &mut Solo {
    scene.solo.as_mut().unwrap()
}

#[test]
fn equal_scenes_have_no_change() {
    let change = SceneChange::between(&scene(), &scene());
    assert_eq!(change, SceneChange::default());
    assert!(!change.needs_redraw());
}

#[test]
fn labels_and_editing_state_need_no_redraw() {
    let labels: &[(&str, Edit)] = &[
        ("name", |s| s.name.push('x')),
        ("description", |s| s.description.push('x')),
        ("objects.name", |s| s.objects[0].name.push('x')),
        ("lights.name", |s| s.lights[0].name.push('x')),
    ];
    assert_class(SceneChange { labels: true, ..SceneChange::default() }, labels);
    let editing: &[(&str, Edit)] = &[
        ("objects.locked", |s| s.objects[0].locked = true),
        ("lights.locked", |s| s.lights[0].locked = true),
        ("lights.muted", |s| s.lights[1].muted = true),
        ("solo", |s| s.solo = None),
        ("solo.lights", |s| solo(s).lights.push(LightId(4))),
        ("solo.restores", |s| solo(s).restores.clear()),
    ];
    assert_class(SceneChange { editing: true, ..SceneChange::default() }, editing);
    for (field, edit) in labels.iter().chain(editing) {
        assert!(!change_by(*edit).needs_redraw(), "{field}");
    }
}

#[test]
fn roles_and_the_meter_redraw_gizmos_alone() {
    assert_class(
        SceneChange { roles: true, ..SceneChange::default() },
        &[("lights.role", |s| s.lights[0].role = Role::Rim)],
    );
    assert_class(
        SceneChange { meter: true, ..SceneChange::default() },
        &[
            ("meter", |s| s.meter = None),
            ("meter.position", |s| meter(s).position.x += 1.0),
            ("meter.facing", |s| meter(s).facing = Facing::Angles { yaw_deg: 0.0, pitch_deg: 0.0 }),
            ("meter.receptor", |s| meter(s).receptor = Receptor::Dome),
        ],
    );
    let moved = change_by(|s| meter(s).position.x += 1.0);
    assert!(moved.needs_redraw() && !moved.needs_development() && !moved.needs_surfaces());
}

#[test]
fn exposure_and_white_balance_need_development() {
    let cases: [(SceneChange, &[(&str, Edit)]); 4] = [
        (
            SceneChange { exposure: true, ..SceneChange::default() },
            &[
                ("iso", |s| s.camera.iso = 400.0),
                ("meter_constant", |s| s.camera.meter_constant = 330.0),
                ("nd_stops", |s| s.camera.nd_stops = 3.0),
            ],
        ),
        (SceneChange { aperture: true, ..SceneChange::default() }, &[("f_number", |s| s.camera.f_number = 11.0)]),
        (SceneChange { shutter: true, ..SceneChange::default() }, &[("shutter_s", |s| s.camera.shutter_s = 0.5)]),
        (
            SceneChange { white_balance: true, ..SceneChange::default() },
            &[("white_balance_k", |s| s.camera.white_balance_k = 3200.0)],
        ),
    ];
    for (expected, edits) in cases {
        assert!(expected.needs_development() && !expected.moves_camera_rays(false));
        assert_class(expected, edits);
    }
}

#[test]
fn framing_and_focus_move_the_camera_rays() {
    let view = SceneChange { view: true, ..SceneChange::default() };
    assert!(view.moves_camera_rays(false));
    assert_class(
        view,
        &[
            ("position", |s| s.camera.position.x += 1.0),
            ("aim", |s| s.camera.aim = Aim::Point(Vec3::X)),
            ("roll_deg", |s| s.camera.roll_deg = 5.0),
            ("sensor", |s| s.camera.sensor = Sensor::ApsC),
            ("orientation", |s| s.camera.orientation = Orientation::Portrait),
            ("focal_length_mm", |s| s.camera.focal_length_mm = 50.0),
            ("depth_of_field", |s| s.camera.depth_of_field = true),
        ],
    );
    let focus = SceneChange { focus: true, ..SceneChange::default() };
    assert!(focus.moves_camera_rays(true) && !focus.moves_camera_rays(false));
    assert_class(focus, &[("focus", |s| s.camera.focus = Focus::Distance(2.0))]);
}

#[test]
fn with_breathing_the_focus_moves_rays_and_needs_development() {
    let breathing = SceneChange { focus: true, view: true, exposure: true, ..SceneChange::default() };
    assert!(breathing.moves_camera_rays(false) && breathing.needs_development());
    assert_class(breathing.clone(), &[("focus_breathing", |s| s.camera.focus_breathing = true)]);
    // The camera focuses on the vase, and the vase moves.
    let focused = |z: f32| {
        let mut scene = scene();
        scene.camera.focus_breathing = true;
        scene.camera.focus = Focus::OnObject { object: ObjectId(1), offset: Vec3::ZERO };
        scene.objects[0].transform.position = Vec3::new(0.0, 1.5, z);
        scene
    };
    let moved = SceneChange::between(&focused(0.0), &focused(1.0));
    assert_eq!(moved, SceneChange { geometry: true, focus: false, ..breathing.clone() });
    let refocused = Scene { camera: Camera { focus: Focus::Distance(1.0), ..focused(0.0).camera }, ..focused(0.0) };
    assert_eq!(SceneChange::between(&focused(0.0), &refocused), breathing);
}

#[test]
fn shapes_and_surfaces_need_preparation() {
    let geometry = SceneChange { geometry: true, ..SceneChange::default() };
    assert!(geometry.needs_surfaces() && !geometry.needs_development());
    assert_class(
        geometry,
        &[
            ("room", |s| s.room = None),
            ("room.size_m", |s| room(s).size_m.x += 1.0),
            ("objects", |s| s.objects.clear()),
            ("objects.id", |s| s.objects[0].id = ObjectId(9)),
            ("objects.shape", |s| s.objects[0].shape = Shape::Sphere { radius_m: 0.3 }),
            ("objects.visible", |s| s.objects[0].visible = false),
            ("objects.position", |s| s.objects[0].transform.position.x += 1.0),
            ("objects.rotation_deg", |s| s.objects[0].transform.rotation_deg.x += 1.0),
            ("objects.scale", |s| s.objects[0].transform.scale.x += 1.0),
            ("bodies", |s| s.bodies = Bodies::InReflections),
            ("lights.body", |s| s.lights[0].body = BodyChoice::On),
            ("lights.body of a light that is off", |s| s.lights[1].body = BodyChoice::InReflections),
        ],
    );
    assert_class(
        SceneChange { materials: true, ..SceneChange::default() },
        &[
            ("room.floor", |s| room(s).floor.ior = 1.1),
            ("room.walls", |s| room(s).walls.ior = 1.1),
            ("room.ceiling", |s| room(s).ceiling.ior = 1.1),
            ("part_materials", |s| s.objects[0].part_materials.clear()),
            ("part_materials.part", |s| s.objects[0].part_materials[0].0.push('x')),
            ("part_materials.material", |s| s.objects[0].part_materials[0].1.ior = 1.1),
            ("base_color", |s| s.objects[0].material.base_color[0] = 0.1),
            ("base_color_texture", |s| s.objects[0].material.textures.base_color = Some(TextureRef::file("a.png"))),
            ("normal_texture", |s| s.objects[0].material.textures.normal = Some(TextureRef::file("a.png"))),
            ("normal_scale", |s| s.objects[0].material.textures.normal_scale = 2.0),
            ("dome_radius", |s| s.objects[0].material.textures.dome_radius = 1.5),
            ("emission_placement", |s| s.objects[0].material.textures.placements[2].nearest = true),
            ("alpha", |s| s.objects[0].material.alpha = Alpha::Mask { cutoff: 0.5 }),
            ("metallic", |s| s.objects[0].material.metallic = 1.0),
            ("roughness", |s| s.objects[0].material.roughness = 0.1),
            ("ior", |s| s.objects[0].material.ior = 1.1),
            ("transmission", |s| s.objects[0].material.transmission = 1.0),
            ("absorption_per_m", |s| s.objects[0].material.absorption_per_m[0] = 1.0),
            ("subsurface", |s| {
                s.objects[0].material.subsurface = Some(Subsurface { mean_free_path_mm: [1.0; 3] });
            }),
            ("emission_cd_m2", |s| s.objects[0].material.emission_cd_m2[0] = 1.0),
            ("clearcoat", |s| s.objects[0].material.clearcoat = Some(Clearcoat::POLISHED)),
            ("sheen", |s| s.objects[0].material.sheen = Some(Sheen { color: [0.5; 3], roughness: 0.5 })),
            ("anisotropy", |s| {
                s.objects[0].material.anisotropy = Some(Anisotropy { strength: 0.5, rotation_deg: 0.0 });
            }),
            ("frosting", |s| s.objects[0].material.frosting = 0.3),
            ("translucency", |s| s.objects[0].material.translucency = 0.3),
        ],
    );
}

#[test]
fn the_body_of_a_moved_light_is_geometry_and_dimming_moves_none() {
    let with_bodies = || Scene { bodies: Bodies::On, ..scene() };
    let is_geometry = |edit: Edit| {
        let mut edited = with_bodies();
        edit(&mut edited);
        SceneChange::between(&with_bodies(), &edited).geometry
    };
    let moved: &[(&str, Edit)] = &[
        ("position", |s| s.lights[0].position.x += 1.0),
        ("position of a light that is off", |s| s.lights[1].position.x += 1.0),
        ("aim", |s| s.lights[0].aim = Aim::Point(Vec3::X)),
        ("roll_deg", |s| s.lights[0].roll_deg = 5.0),
        ("emitter", |s| s.lights[0].emitter = Emitter::Point),
        ("modifier.grid_deg", |s| s.lights[0].modifier.grid_deg = Some(30.0)),
        ("modifier.doors", |s| s.lights[0].modifier.doors = Some(BarnDoors::HALF_OPEN)),
        ("bodies", |s| s.bodies = Bodies::InReflections),
        ("body", |s| s.lights[0].body = BodyChoice::Off),
        ("removed", |s| drop(s.lights.remove(0))),
    ];
    for (field, edit) in moved {
        assert!(is_geometry(*edit), "{field}");
    }
    let dimmed: &[(&str, Edit)] = &[
        ("on", |s| s.lights[0].on = false),
        ("power.dial_stops", |s| s.lights[0].power.dial_stops = -1.0),
        ("color.gel", |s| s.lights[0].color.gel = Gel::Mired(159.0)),
        ("modifier.loss_stops", |s| s.lights[0].modifier.loss_stops = 0.7),
        ("body, said again", |s| s.lights[0].body = BodyChoice::On),
        ("camera", |s| s.camera.position.x += 1.0),
    ];
    for (field, edit) in dimmed {
        assert!(!is_geometry(*edit), "{field}");
    }
}

#[test]
fn lights_are_weighted_or_traced_again_one_by_one() {
    let same = LightChange {
        id: LIGHT,
        was_on: true,
        is_on: true,
        removed: false,
        visible: false,
        weight: false,
        transport: false,
    };
    let change = |light| SceneChange { lights: vec![light], ..SceneChange::default() };
    assert_class(
        change(LightChange { weight: true, ..same }),
        &[
            ("power.output", |s| s.lights[0].power.output = Output::Candela(100.0)),
            ("power.dial_stops", |s| s.lights[0].power.dial_stops = -1.0),
            ("color.source", |s| s.lights[0].color.source = ColorSource::Kelvin(3200.0)),
            ("color.gel", |s| s.lights[0].color.gel = Gel::Mired(159.0)),
            ("modifier.loss_stops", |s| s.lights[0].modifier.loss_stops = 1.0),
            ("modifier.scrim_stops", |s| s.lights[0].modifier.scrim_stops = 1.0),
        ],
    );
    assert_class(change(LightChange { is_on: false, ..same }), &[("on", |s| s.lights[0].on = false)]);
    assert_class(
        change(LightChange { transport: true, ..same }),
        &[
            ("position", |s| s.lights[0].position.x += 1.0),
            ("aim", |s| s.lights[0].aim = Aim::Point(Vec3::X)),
            ("roll_deg", |s| s.lights[0].roll_deg = 5.0),
            ("emitter", |s| s.lights[0].emitter = Emitter::Point),
            ("photometric_file", |s| s.lights[0].photometric_file = Some("lamp.ies".to_owned())),
            ("environment_map", |s| s.lights[0].environment_map = Some("sky.hdr".to_owned())),
            ("modifier.beam", |s| s.lights[0].modifier.beam = Some(Cone { inner_deg: 10.0, outer_deg: 20.0 })),
            ("modifier.grid_deg", |s| s.lights[0].modifier.grid_deg = Some(30.0)),
            ("modifier.doors", |s| s.lights[0].modifier.doors = Some(BarnDoors::HALF_OPEN)),
        ],
    );
    assert_class(
        change(LightChange { transport: true, visible: true, ..same }),
        &[("visible_to_camera", |s| s.lights[0].visible_to_camera = true)],
    );
    let whole = LightChange { weight: true, transport: true, ..same };
    assert_class(
        change(LightChange { is_on: false, removed: true, ..whole }),
        &[("removed", |s| drop(s.lights.remove(0)))],
    );
    assert_class(
        change(LightChange { id: LightId(9), was_on: false, ..whole }),
        &[("added", |s| s.lights.push(Light { id: LightId(9), ..s.lights[0].clone() }))],
    );
}

#[test]
fn a_measured_light_is_traced_again_when_its_power_is_stated_in_another_quantity() {
    let mut lumens = scene();
    lumens.lights[0].photometric_file = Some("lamp.ies".to_owned());
    let class = |output| {
        let mut now = lumens.clone();
        now.lights[0].power.output = output;
        SceneChange::between(&lumens, &now).lights[0].transport
    };
    assert!(class(Output::Candela(500.0)));
    assert!(!class(Output::Lumens(500.0)) && !class(Output::FlashWs { energy_ws: 5.0, efficacy_lm_s_per_ws: 40.0 }));
}
