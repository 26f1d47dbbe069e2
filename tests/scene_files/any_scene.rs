//! Property tests: random scenes round-trip, random text and changed bytes never panic.

use super::any_tank::tank;
use super::preset_text;
use catchlight::figures::{NamedPose, READY, randomised};
use catchlight::io::{parse_scene, write_scene};
use catchlight::scene::*;
use glam::Vec3;
use proptest::prelude::*;

pub(super) fn number(low: f32, high: f32) -> impl Strategy<Value = f32> {
    prop_oneof![3 => low..=high, 1 => Just(low), 1 => Just(high), 1 => (low..=high).prop_map(f32::round)]
        .prop_map(move |x| x.clamp(low, high))
}

pub(super) fn vector(low: f32, high: f32) -> impl Strategy<Value = Vec3> {
    [number(low, high), number(low, high), number(low, high)].prop_map(Vec3::from)
}

fn color(high: f32) -> impl Strategy<Value = [f32; 3]> {
    // Never black: that is no colour of light.
    [number(0.001, high), number(0.001, high), number(0.001, high)]
}

fn texture() -> impl Strategy<Value = TextureRef> {
    prop_oneof![
        "[a-z]{1,8}/[a-z ]{1,8}\\.png".prop_map(TextureRef::File),
        ("[a-z]{1,8}\\.glb", 0..9_u32).prop_map(|(model, image)| TextureRef::Embedded { model, image }),
    ]
}

fn fibre() -> impl Strategy<Value = Fibre> {
    let melanin =
        (number(0.0, 1.0), number(0.0, 1.0)).prop_map(|(melanin, redness)| FibreColor::Melanin { melanin, redness });
    let fibre_color = prop_oneof![melanin, color(0.999).prop_map(FibreColor::Dye)];
    (fibre_color, number(0.05, 1.0), number(0.05, 1.0)).prop_map(|(color, roughness_along, roughness_around)| Fibre {
        color,
        roughness_along,
        roughness_around,
    })
}

fn placement() -> impl Strategy<Value = TexturePlacement> {
    let pair = || (number(-100.0, 100.0), number(-100.0, 100.0));
    let wrap = || (0..3_usize).prop_map(|index| Wrap::ALL[index]);
    (pair(), number(-360.0, 360.0), pair(), (wrap(), wrap()), any::<bool>(), any::<bool>()).prop_map(
        |(offset, rotation_deg, scale, wrap, nearest, second_uvs)| TexturePlacement {
            offset: offset.into(),
            rotation_deg,
            scale: scale.into(),
            wrap: wrap.into(),
            nearest,
            second_uvs,
        },
    )
}

fn textures() -> BoxedStrategy<MaterialTextures> {
    let slots = proptest::array::uniform4((proptest::option::of(texture()), proptest::option::of(placement().boxed())));
    let dome_radius = prop_oneof![Just(0.0), number(1.0, 1000.0)];
    (slots, number(-16.0, 16.0), dome_radius)
        .prop_map(|(slots, normal_scale, dome_radius)| {
            let mut textures = MaterialTextures { normal_scale, dome_radius, ..MaterialTextures::default() };
            for (slot, (texture, placement)) in TextureSlot::ALL.into_iter().zip(slots) {
                *textures.get_mut(slot) = texture;
                textures.placements[slot as usize] = placement.unwrap_or_default();
            }
            textures
        })
        .boxed()
}

fn alpha() -> impl Strategy<Value = Alpha> {
    prop_oneof![
        Just(Alpha::Opaque),
        number(0.0, 1.0).prop_map(|cutoff| Alpha::Mask { cutoff }),
        number(0.0, 1.0).prop_map(|opacity| Alpha::Blend { opacity }),
    ]
}

/// Lacquer, sheen, brushing, frosting and translucency.
type Layers = (Option<Clearcoat>, Option<Sheen>, Option<Anisotropy>, f32, f32);

fn layers() -> BoxedStrategy<Layers> {
    let unit = || number(0.0, 1.0);
    let clearcoat = (unit(), unit()).prop_map(|(amount, roughness)| Clearcoat { amount, roughness });
    let sheen = (color(1.0), unit()).prop_map(|(color, roughness)| Sheen { color, roughness });
    let anisotropy =
        (unit(), number(-360.0, 360.0)).prop_map(|(strength, rotation_deg)| Anisotropy { strength, rotation_deg });
    (
        proptest::option::of(clearcoat),
        proptest::option::of(sheen),
        proptest::option::of(anisotropy),
        prop_oneof![Just(0.0), unit()],
        prop_oneof![Just(0.0), unit()],
    )
        .boxed()
}

fn material() -> impl Strategy<Value = Material> {
    let custom = (
        color(0.999),
        (textures(), alpha(), layers()),
        number(0.0, 1.0),
        number(0.0, 1.0),
        number(1.0, 4.0),
        color(1e6),
        proptest::option::of(vector(0.01, 1000.0)),
        color(1e9),
        proptest::option::of(fibre()),
    )
        .prop_map(
            |(
                base_color,
                (textures, alpha, (clearcoat, sheen, anisotropy, frosting, translucency)),
                metallic,
                roughness,
                ior,
                absorption_per_m,
                free_path,
                emission_cd_m2,
                fibre,
            )| {
                Material {
                    base_color,
                    textures,
                    metallic,
                    roughness,
                    ior,
                    transmission: if metallic > 0.0 || fibre.is_some() { 0.0 } else { 0.7 },
                    absorption_per_m,
                    subsurface: free_path
                        .map(|mean_free_path_mm| Subsurface { mean_free_path_mm: mean_free_path_mm.into() }),
                    emission_cd_m2,
                    fibre,
                    alpha,
                    clearcoat,
                    sheen,
                    anisotropy,
                    frosting,
                    translucency,
                }
            },
        );
    // Boxed: a scene of several materials would overflow a test's stack.
    prop_oneof![(0..MaterialPreset::ALL.len()).prop_map(|i| MaterialPreset::ALL[i].material()), custom].boxed()
}

fn shape() -> impl Strategy<Value = Shape> {
    let size = || number(1e-5, 1e5);
    prop_oneof![
        "[a-z]{1,8}\\.obj".prop_map(|path| Shape::MeshFile { path }),
        (0..READY.len(), 0..NamedPose::ALL.len()).prop_map(|(f, p)| {
            let model = READY[f].figure();
            let pose = NamedPose::ALL[p].pose();
            Shape::Figure(Box::new(Figure { pose, ..randomised(&model, p as u32) }))
        }),
        (size(), size()).prop_map(|(width_m, depth_m)| Shape::Plane { width_m, depth_m }),
        vector(1e-5, 1e5).prop_map(|size_m| Shape::Box { size_m }),
        size().prop_map(|radius_m| Shape::Sphere { radius_m }),
        tank().prop_map(|tank| Shape::Tank(Box::new(tank))),
        (size(), size()).prop_map(|(radius_m, height_m)| Shape::Cylinder { radius_m, height_m }),
        (0..PropModel::ALL.len()).prop_map(|index| Shape::Prop(PropModel::ALL[index])),
        (size(), size(), number(5.0, 180.0)).prop_map(|(wing_m, height_m, angle_deg)| Shape::VFlat {
            wing_m,
            height_m,
            angle_deg
        }),
        (size(), size(), size(), number(0.0, 1e5)).prop_map(|(width_m, height_m, depth_m, radius_m)| Shape::Sweep {
            width_m,
            height_m,
            depth_m,
            radius_m
        }),
    ]
}

/// Names with everything that could upset a text format.
fn name() -> impl Strategy<Value = String> {
    prop_oneof!["[A-Z][a-z]{1,8}", "\\PC{1,12}", "[\"\\\\/(),:\\[\\]{}#r'\n\t ]{0,6}x"]
}

fn aim(objects: usize) -> impl Strategy<Value = Aim> {
    let angles = (number(-1e5, 1e5), number(-90.0, 90.0))
        .prop_map(|(yaw_deg, pitch_deg)| Aim::Angles { yaw_deg, pitch_deg })
        .boxed();
    // Places are taken from 10 m around, aims from 20 m away, so that nothing aims at itself.
    let point = vector(20.0, 1e6).prop_map(Aim::Point);
    if objects == 0 {
        return prop_oneof![angles, point].boxed();
    }
    let object =
        (0..objects, vector(20.0, 1e6)).prop_map(|(i, offset)| Aim::Object { object: ObjectId(i as u32), offset });
    prop_oneof![angles, point, object].boxed()
}

fn object() -> impl Strategy<Value = Object> {
    let transform = (vector(-10.0, 10.0), vector(-360.0, 360.0), prop_oneof![Just(Vec3::ONE), vector(0.5, 2.0)])
        .prop_map(|(position, rotation_deg, scale)| Transform { position, rotation_deg, scale });
    let parts = proptest::collection::btree_map(name(), material(), 0..3).prop_map(|m| m.into_iter().collect());
    (name(), transform, shape(), material(), parts, any::<bool>(), any::<bool>()).prop_map(
        |(name, transform, shape, material, part_materials, visible, locked)| Object {
            id: ObjectId(0),
            name,
            transform,
            shape,
            material,
            part_materials,
            visible,
            locked,
        },
    )
}

fn emitter_and_output() -> impl Strategy<Value = (Emitter, Output)> {
    let size = || number(1e-5, 1e5);
    let emitter = prop_oneof![
        Just(Emitter::Point),
        size().prop_map(|radius_m| Emitter::Sphere { radius_m }),
        (number(0.1, 180.0), number(0.0, 1.0))
            .prop_map(|(outer_deg, share)| Emitter::Spot { inner_deg: outer_deg * share, outer_deg }),
        (size(), size()).prop_map(|(width_m, height_m)| Emitter::RectPanel { width_m, height_m }),
        size().prop_map(|diameter_m| Emitter::RoundPanel { diameter_m }),
        number(0.0, 90.0).prop_map(|angular_diameter_deg| Emitter::Sun { angular_diameter_deg }),
        Just(Emitter::Surround),
    ];
    (emitter, number(0.0, 1e4), number(0.01, 600.0), 0..5_usize).prop_map(|(emitter, a, b, kind)| {
        let finite = [
            Output::Lumens(a),
            Output::Candela(a),
            Output::LuxAt { lux: a, distance_m: b },
            Output::FlashWs { energy_ws: a, efficacy_lm_s_per_ws: b },
            Output::FlashGuideNumber(a),
        ];
        (emitter, if emitter.is_infinite() { Output::Lux(a) } else { finite[kind] })
    })
}

/// On the heap: the nested strategies are too large for the stack of a test in a build without optimisation.
fn light(objects: usize) -> BoxedStrategy<Light> {
    let source =
        prop_oneof![number(1000.0, 25_000.0).prop_map(ColorSource::Kelvin), color(1000.0).prop_map(ColorSource::Rgb)];
    let gel =
        prop_oneof![Just(Gel::None), number(-1000.0, 1000.0).prop_map(Gel::Mired), color(1.0).prop_map(Gel::Tint)];
    let power = (emitter_and_output(), prop_oneof![Just(0.0), number(-20.0, 10.0)]);
    (
        (name(), 0..Role::ALL.len(), vector(-10.0, 10.0), aim(objects), number(-180.0, 180.0)),
        (power, source, gel, any::<[bool; 5]>(), proptest::option::of(head())),
        (modifier(), 0..4_usize, proptest::option::of(Just("lamps/down light.ies".to_owned()))),
    )
        .prop_map(
            |(
                (name, role, position, aim, roll_deg),
                (((emitter, output), dial_stops), source, gel, [on, seen, muted, locked, gel_loss_counts], head),
                (modifier, body, photometric_file),
            )| Light {
                id: LightId(0),
                name,
                role: Role::ALL[role],
                position,
                aim,
                roll_deg,
                emitter,
                environment_map: photometric_file.clone().filter(|_| emitter == Emitter::Surround),
                photometric_file: photometric_file.filter(|_| !emitter.is_infinite()),
                // Light from infinity can only be weakened.
                modifier: if emitter.is_infinite() { Modifier::loss(modifier.loss_stops) } else { modifier },
                head,
                power: Power { output, dial_stops },
                color: LightColor { source, gel, gel_loss_counts },
                on,
                visible_to_camera: seen,
                body: [BodyChoice::AsStudio, BodyChoice::On, BodyChoice::InReflections, BodyChoice::Off][body],
                muted,
                locked,
            },
        )
        .boxed()
}

fn head() -> impl Strategy<Value = Head> {
    let scale = prop_oneof![
        Just(DialScale::Fractions),
        number(0.0, 10.0).prop_map(|full| DialScale::Number { full }),
        number(1.0, 5000.0).prop_map(|full| DialScale::WattSeconds { full }),
        Just(DialScale::PerCent)
    ];
    let time = || proptest::option::of(number(1e-5, 0.1));
    (name(), scale, number(-12.0, 0.0), 1..=10_u8, (time(), proptest::option::of(number(0.0, 5.0)), time())).prop_map(
        |(name, scale, lowest_stops, steps_per_stop, (sync_s, hss_loss_stops, t01_s))| Head {
            name,
            dial: HeadDial { scale, lowest_stops, steps_per_stop },
            sync_s,
            hss_loss_stops,
            t01_s,
        },
    )
}

fn modifier() -> impl Strategy<Value = Modifier> {
    let cone = (0.0..60.0_f32, 60.0..180.0_f32).prop_map(|(inner_deg, outer_deg)| Cone { inner_deg, outer_deg });
    let doors = prop::array::uniform4(0.0..90.0_f32).prop_map(|[left_deg, right_deg, top_deg, bottom_deg]| BarnDoors {
        left_deg,
        right_deg,
        top_deg,
        bottom_deg,
    });
    let (beam, grid, doors) = (prop::option::of(cone), prop::option::of(1.0..90.0_f32), prop::option::of(doors));
    let all =
        (0.0..3.0_f32, 0.0..3.0_f32, beam, grid, doors).prop_map(|(loss_stops, scrim_stops, beam, grid_deg, doors)| {
            Modifier { loss_stops, scrim_stops, beam, grid_deg, doors }
        });
    prop_oneof![Just(Modifier::default()), all]
}

fn camera(objects: usize) -> impl Strategy<Value = Camera> {
    let sensor = prop_oneof![
        (0..5_usize).prop_map(|i| Sensor::NAMED[i].1),
        (number(1.0, 100.0), number(1.0, 100.0))
            .prop_map(|(width_mm, height_mm)| Sensor::Custom { width_mm, height_mm }),
    ];
    let orientation = prop_oneof![Just(Orientation::Landscape), Just(Orientation::Portrait)];
    let focus = (0..=objects, vector(-1.0, 1.0), number(0.1, 100.0)).prop_map(move |(i, offset, distance)| {
        if i < objects {
            Focus::OnObject { object: ObjectId(i as u32), offset }
        } else if distance > 50.0 {
            Focus::OnAim
        } else {
            Focus::Distance(distance)
        }
    });
    (
        (vector(-10.0, 10.0), aim(objects), number(-180.0, 180.0), sensor, orientation, focus, any::<(bool, bool)>()),
        (
            number(1.0, 800.0),
            number(0.5, 64.0),
            number(1e-4, 30.0),
            number(1.0, 1e5),
            number(1e3, 25e3),
            number(240.0, 340.0),
            prop_oneof![Just(0.0), number(0.0, 30.0)],
        ),
    )
        .prop_map(
            |((position, aim, roll_deg, sensor, orientation, focus, lens), (mm, n, t, s, k, c, nd_stops))| Camera {
                position,
                aim,
                roll_deg,
                sensor,
                orientation,
                focal_length_mm: mm,
                f_number: n,
                shutter_s: t,
                iso: s,
                white_balance_k: k,
                nd_stops,
                focus,
                depth_of_field: lens.0,
                focus_breathing: lens.1,
                meter_constant: c,
            },
        )
}

fn room() -> impl Strategy<Value = Room> {
    (vector(0.1, 1e4), material(), material(), material()).prop_map(|(size_m, floor, walls, ceiling)| Room {
        size_m,
        floor,
        walls,
        ceiling,
    })
}

/// Name, camera and lights of a variant.
type VariantParts = (String, Camera, Vec<Light>);

fn variant(objects: usize) -> impl Strategy<Value = VariantParts> {
    (name(), camera(objects), proptest::collection::vec(light(objects), 0..4))
}

/// Adds a variant with another camera, other or fewer lights, one more, and another visibility. The studio is shown.
fn with_variant(mut scene: Scene, (name, camera, lights): VariantParts) -> Scene {
    let count = scene.lights.len();
    let studio = scene.variants.shown();
    assert!(scene.add_variant(format!("{name} v")).is_some());
    scene.camera = camera;
    scene.lights.truncate(lights.len());
    for (index, light) in lights.into_iter().enumerate() {
        match scene.lights.get_mut(index) {
            Some(old) => *old = Light { id: old.id, name: old.name.clone(), locked: old.locked, ..light },
            None => {
                let id = LightId((count + scene.lights.len() - index) as u32);
                scene.lights.push(Light { id, name: format!("{} v{index}", light.name), ..light });
                break;
            }
        }
    }
    scene.objects.iter_mut().for_each(|object| object.visible = !object.visible);
    scene.show_variant(studio);
    scene.drop_equal_parts_of_variants();
    scene
}

fn scene() -> impl Strategy<Value = Scene> {
    (0..4_usize).prop_flat_map(|objects| {
        (
            name(),
            name(),
            // Boxed, as materials are
            camera(objects).boxed(),
            proptest::option::of(room()).boxed(),
            proptest::collection::vec(object(), objects).boxed(),
            proptest::collection::vec(light(objects), 0..4).boxed(),
            (any::<(bool, bool, bool)>(), 0..Bodies::ALL.len()),
            proptest::option::of(variant(objects)).boxed(),
        )
            .prop_map(
                |(
                    name,
                    description,
                    camera,
                    room,
                    mut objects,
                    mut lights,
                    ((has_meter, on_camera, has_solo), bodies),
                    variant,
                )| {
                    // As after loading: ids in list order, names unique.
                    for (i, object) in objects.iter_mut().enumerate() {
                        object.id = ObjectId(i as u32);
                        object.name.push_str(&format!(" o{i}"));
                    }
                    for (i, light) in lights.iter_mut().enumerate() {
                        light.id = LightId(i as u32);
                        light.name.push_str(&format!(" l{i}"));
                    }
                    let facing = match on_camera {
                        true => Facing::Camera,
                        false => Facing::Angles { yaw_deg: camera.roll_deg, pitch_deg: 12.5 },
                    };
                    let meter =
                        has_meter.then_some(Meter { position: camera.position, facing, receptor: Receptor::Dome });
                    let ids = |on| lights.iter().filter(|l| l.on == on).map(|l| l.id).collect();
                    let solo = has_solo.then(|| Solo { lights: ids(true), restores: ids(false) });
                    let variants = Variants::default();
                    let bodies = Bodies::ALL[bodies];
                    let scene =
                        Scene { name, description, camera, room, objects, lights, bodies, meter, solo, variants };
                    variant.into_iter().fold(scene, with_variant)
                },
            )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_scene_is_unchanged_by_a_round_trip(scene in scene()) {
        let text = write_scene(&scene);
        let (read, _) = parse_scene(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        prop_assert_eq!(&read, &scene, "{}", text);
        prop_assert_eq!(write_scene(&read), text);
    }

    #[test]
    fn any_text_is_an_error_or_a_scene(text in "\\PC{0,200}", bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse_scene(&text);
        let _ = parse_scene(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_change_of_one_byte_is_an_error_or_a_scene(at in 0..10_000_usize, byte in 0x20..0x7f_u8) {
        let mut bytes = preset_text().as_bytes().to_vec();
        let at = at % bytes.len();
        bytes[at] = byte;
        if let Ok(text) = String::from_utf8(bytes) {
            let _ = parse_scene(&text);
        }
    }
}
