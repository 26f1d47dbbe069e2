//! Dial settings against known answers, limits of heads, and the meter.

use super::dial_solver::{DialPlan, solve_dials};
use super::metering::MeteredAt;
use super::room_audit::{RoomAudit, RoomSurface};
use super::transport::{LightTransport, SetupTransport};
use super::wish::{WishError, WishTarget, wishes};
use crate::raytrace::{GeometryCache, LightMeter, MeterEffort, MeterPoint, RenderControl};
use crate::scene::{
    Aim, Assets, Camera, Emitter, Facing, HeadDial, Light, LightId, Material, Meter, Modifier, Object, Output,
    Receptor, Role, Room, Scene, Shape, Transform,
};
use glam::Vec3;

/// f/8 at ISO 100 is 160 lux s.
const F8: f32 = 160.0;

fn light(id: u32, name: &str, role: Role, at: MeteredAt, dial_stops: f32, lux_s: f32) -> LightTransport {
    LightTransport {
        light: LightId(id),
        name: name.to_owned(),
        role,
        is_on: true,
        has_dial: true,
        dial: HeadDial::UNKNOWN,
        dial_stops,
        energy_lm_s: 8000.0,
        at,
        own_lux_s: lux_s,
        subject_lux_s: if at == MeteredAt::Subject { lux_s } else { 0.0 },
        background_lux_s: Vec::new(),
    }
}

/// Key at f/8 and fill two stops under it, both at 1/8 of full power.
fn key_and_fill() -> Vec<LightTransport> {
    vec![
        light(1, "Key softbox", Role::Key, MeteredAt::Subject, -3.0, F8),
        light(2, "Fill umbrella", Role::Fill, MeteredAt::Subject, -3.0, F8 / 4.0),
    ]
}

fn solve(setup: &SetupTransport, text: &str) -> DialPlan {
    solve_dials(setup, &wishes(text, setup).unwrap())
}

fn dials(plan: &DialPlan) -> Vec<f32> {
    plan.dials.iter().map(|dial| dial.to_stops).collect()
}

fn assert_dials(plan: &DialPlan, expected: &[f32]) {
    let dials = dials(plan);
    assert_eq!(dials.len(), expected.len());
    assert!(dials.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4), "{dials:?} for {expected:?}");
    assert!(plan.outcomes.iter().all(|outcome| outcome.missed_stops.is_none()), "{:?}", plan.outcomes);
}

#[test]
fn lights_by_themselves_have_the_dials_of_the_inverse_power() {
    let setup = SetupTransport::of_lights(key_and_fill(), &[]);
    // f/16 is two stops over f/8; -1.5 relative to it is half a stop more than now.
    assert_dials(&solve(&setup, "Key=f/16,Fill=-1.5"), &[-1.0, -0.5]);
    // The order of the wishes does not matter, nor does the key's own wish for the others.
    assert_dials(&solve(&setup, "Fill=-1.5,key=f/16"), &[-1.0, -0.5]);
    assert_dials(&solve(&setup, "umbrella=-1"), &[-2.0]);
    let plan = solve(&setup, "Key=f/8,Fill=-2");
    assert_eq!(plan.changes().count(), 0, "nothing to change: {plan:?}");
    assert_eq!(plan.energy_lm_s, [2000.0; 2]);
}

#[test]
fn the_light_of_all_at_the_subject_adds_up() {
    let setup = SetupTransport::of_lights(key_and_fill(), &[]);
    // Key and fill together f/8, fill two stops under the key: the key is 4/5 of 160 lux s.
    let plan = solve(&setup, "subject=f/8,fill=-2");
    let expected = [0.8_f32, 0.2].map(|share| (share * F8).log2());
    let reached = [F8.log2() + plan.dials[0].to_stops + 3.0, (F8 / 4.0).log2() + plan.dials[1].to_stops + 3.0];
    assert!(reached.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 0.1), "{plan:?}");
    assert!(plan.outcomes.iter().all(|outcome| outcome.missed_stops.is_none()));
    // A fill that is stronger than the key makes the rounds of the solver alternate.
    let plan = solve(&setup, "subject=f/8,fill=+1");
    assert!(plan.outcomes.iter().all(|outcome| outcome.missed_stops.is_none()), "{plan:?}");
}

#[test]
fn wishes_beyond_the_dials_are_missed_by_as_much_and_name_the_head() {
    let setup = SetupTransport::of_lights(key_and_fill(), &[]);
    let plan = solve(&setup, "key=f/32,fill=-1.5");
    // Full power is three stops over f/8: one stop short. The fill follows what the key gives.
    assert_eq!(dials(&plan)[0], 0.0);
    let [key, fill] = plan.outcomes.as_slice() else { panic!("two wishes") };
    assert!((key.missed_stops.unwrap() + 1.0).abs() < 1e-3);
    assert_eq!(key.note().unwrap(), "1.0 stops under: Key softbox is at full power");
    // The fill has to be 1.5 stops under f/22.6, where 2 stops under f/32 would be less: -3 + 3 + 2 - 1.5, beyond its dial.
    assert!((fill.wanted_lux_s / (key.after_lux_s * (-1.5_f32).exp2()) - 1.0).abs() < 1e-5);
    assert_eq!((dials(&plan)[1], fill.note().unwrap().contains("0.5 stops under: Fill umbrella")), (0.0, true));
    let plan = solve(&setup, "key=f/32,fill=-3");
    assert!((dials(&plan)[1] + 1.0).abs() < 1e-4, "a stop under the fill of now, with the key at full power: {plan:?}");
    let faint = solve(&setup, "fill=-12");
    assert_eq!(dials(&faint), [HeadDial::UNKNOWN.lowest_stops]);
    assert_eq!(faint.outcomes[0].note().unwrap(), "4.0 stops over: Fill umbrella is at its lowest setting");
    // A head that goes down to 1/32 only.
    let mut narrow = key_and_fill();
    narrow[1].dial = HeadDial { lowest_stops: -5.0, ..HeadDial::UNKNOWN };
    let plan = solve(&SetupTransport::of_lights(narrow, &[]), "fill=-12");
    assert_eq!(dials(&plan), [-5.0]);
    assert_eq!(plan.outcomes[0].note().unwrap(), "8.0 stops over: Fill umbrella is at its lowest setting");
    // The key reaches its wish even if the fill cannot follow.
    let mut weak = key_and_fill();
    (weak[1].own_lux_s, weak[1].subject_lux_s) = (1.0, 1.0);
    let plan = solve(&SetupTransport::of_lights(weak, &[]), "key=f/11.314,fill=-1.5");
    assert!((dials(&plan)[0] + 2.0).abs() < 1e-4);
    assert!(plan.outcomes[0].missed_stops.is_none() && plan.outcomes[1].missed_stops.is_some());
}

#[test]
fn dials_have_steps_of_a_tenth() {
    let setup = SetupTransport::of_lights(key_and_fill(), &[]);
    for number in [5.0, 6.1, 7.3, 9.7] {
        let plan = solve(&setup, &format!("key=f/{number},fill=-1.73"));
        for (dial, outcome) in plan.dials.iter().zip(&plan.outcomes) {
            assert!((dial.to_stops * 10.0 - (dial.to_stops * 10.0).round()).abs() < 1e-4, "{dial:?}");
            assert!((outcome.after_lux_s / outcome.wanted_lux_s).log2().abs() <= 0.051, "{outcome:?}");
        }
    }
}

/// Two lights on a background of three points, each stronger on its own side, over a key.
fn background_pair() -> Vec<LightTransport> {
    let mut lights = key_and_fill();
    for (id, name, background) in [(3, "Left", [F8, F8 / 2.0, F8 / 4.0]), (4, "Right", [F8 / 4.0, F8 / 2.0, F8])] {
        let mut light = light(id, name, Role::Background, MeteredAt::Aim, -4.0, F8);
        light.background_lux_s = background.to_vec();
        light.subject_lux_s = F8 / 64.0;
        lights.push(light);
    }
    lights[..2].iter_mut().for_each(|light| light.background_lux_s = vec![0.0; 3]);
    lights
}

#[test]
fn a_background_is_lit_evenly_and_white_at_its_darkest_point() {
    let setup = SetupTransport::of_lights(background_pair(), &[0.8; 3]);
    let plan = solve(&setup, "background=+1");
    assert_eq!(plan.dials.len(), 2, "key and fill have no wish: {plan:?}");
    assert!((dials(&plan)[0] - dials(&plan)[1]).abs() < 0.11);
    assert!(plan.outcomes[0].missed_stops.is_none() && plan.outcomes[0].evenness_stops.unwrap() < 0.2);
    let plan = solve(&setup, "background=white");
    let white = setup.white_lux_s().next().unwrap();
    let darkest = (0..3).map(|point| {
        let lights = setup.lights().iter().zip([0.0, 0.0, plan.dials[0].to_stops + 4.0, plan.dials[1].to_stops + 4.0]);
        lights.map(|(light, stops)| light.background_lux_s[point] * stops.exp2()).sum::<f32>()
    });
    let darkest = darkest.fold(f32::INFINITY, f32::min);
    assert!((0.0..0.15).contains(&(darkest / white).log2()), "{darkest} for {white}: not more than needed");
    let black = SetupTransport::of_lights(background_pair(), &[0.0; 3]);
    let mut plan = solve(&black, "background=white");
    assert_eq!(dials(&plan), [-4.0, -4.0], "nothing is set in vain");
    let outcome = plan.outcomes.remove(0);
    assert_eq!(
        (outcome.missed_stops, outcome.note().unwrap().as_str()),
        (Some(f32::NEG_INFINITY), "its surface is black")
    );
}

#[test]
fn a_wish_for_the_background_leaves_lights_on_other_things_alone() {
    let mut lights = background_pair();
    let mut accent = light(5, "Prop spot", Role::Accent, MeteredAt::Aim, -4.0, F8);
    accent.background_lux_s = vec![F8 / 1000.0; 3];
    lights.push(accent);
    for wish in ["background=+1", "background=white", "background=+1,spill=-4"] {
        let plan = solve(&SetupTransport::of_lights(lights.clone(), &[0.8; 3]), wish);
        assert!(plan.dials.iter().all(|dial| dial.name != "Prop spot"), "{wish}: {plan:?}");
    }
    // A light of which nothing arrives is not turned down either
    lights[1].own_lux_s = 0.0;
    let plan = solve(&SetupTransport::of_lights(lights, &[0.8; 3]), "fill=f/8");
    assert_eq!((dials(&plan), plan.outcomes[0].note().unwrap().as_str()), (vec![-3.0], "no light of it arrives"));
}

#[test]
fn spill_is_an_upper_bound() {
    let setup = SetupTransport::of_lights(background_pair(), &[0.8; 3]);
    // Now 160 / 32 lux s of 160: five stops under the key.
    assert_dials(&solve(&setup, "spill=-5"), &[-4.0, -4.0]);
    let plan = solve(&setup, "background=+3,spill=-5");
    assert!(plan.outcomes.iter().any(|outcome| outcome.missed_stops.is_some()), "both can't be had: {plan:?}");
}

#[test]
fn of_two_lights_that_do_the_same_the_one_that_needs_less_energy_is_used() {
    let mut lights = background_pair();
    lights[2].background_lux_s = vec![F8; 3];
    // Four times less light of as much energy
    lights[3].background_lux_s = vec![F8 / 4.0; 3];
    let plan = solve(&SetupTransport::of_lights(lights, &[0.8; 3]), "background=+1");
    assert!(plan.dials[1].to_stops < -8.9 && (plan.dials[0].to_stops + 3.0).abs() < 0.051, "{plan:?}");
    assert!(plan.outcomes[0].missed_stops.is_none());
}

#[test]
fn lights_of_one_wish_keep_their_ratio() {
    let mut lights = key_and_fill();
    // 200 lux s in all, of which 160 are left: a third of a stop less, of both.
    let plan = solve(&SetupTransport::of_lights(lights.clone(), &[]), "subject=f/8");
    assert_dials(&plan, &[-3.3, -3.3]);
    lights[1].role = Role::Key;
    lights[1].dial_stops = -1.0;
    let plan = solve(&SetupTransport::of_lights(lights.clone(), &[]), "key=f/8");
    assert_dials(&plan, &[-3.3, -1.3]);
    // The first head to be at full power limits both.
    let plan = solve(&SetupTransport::of_lights(lights, &[]), "key=f/22.627");
    assert_eq!(dials(&plan), [-2.0, 0.0]);
    assert!(plan.outcomes[0].note().unwrap().contains("Fill umbrella is at full power"));
}

#[test]
fn lights_that_are_off_are_switched_on_by_a_wish_and_stay_off_without_one() {
    let mut lights = key_and_fill();
    lights[1].is_on = false;
    let setup = SetupTransport::of_lights(lights, &[]);
    let plan = solve(&setup, "subject=f/8");
    assert_eq!(plan.dials.iter().map(|dial| dial.name.as_str()).collect::<Vec<_>>(), ["Key softbox"]);
    let plan = solve(&setup, "fill=-2");
    assert!(plan.dials[0].is_change() && !plan.dials[0].was_on);
    assert_eq!((plan.dials[0].to_stops, plan.outcomes[0].before_lux_s), (-3.0, 0.0));
    let mut scene = Scene { lights: vec![Light::new(Emitter::Point, Output::Lumens(1.0))], ..Scene::default() };
    (scene.lights[0].id, scene.lights[0].on, scene.lights[0].muted) = (LightId(2), false, true);
    plan.apply(&mut scene);
    assert_eq!((scene.lights[0].on, scene.lights[0].muted, scene.lights[0].power.dial_stops), (true, false, -3.0));
}

#[test]
fn names_are_lights_roles_or_places_and_errors_say_what_to_write() {
    let mut lights = background_pair();
    lights[3].has_dial = false;
    let setup = SetupTransport::of_lights(lights, &[0.8; 3]);
    let read = |text: &str| wishes(text, &setup);
    let targets = |text: &str| read(text).unwrap().into_iter().map(|wish| wish.target).collect::<Vec<_>>();
    assert_eq!(targets("KEY softbox = F8"), [WishTarget::Lights(vec![LightId(1)])]);
    assert_eq!(
        targets("Face=f/8, background=+1,,spill=\u{2212}4"),
        [WishTarget::Subject, WishTarget::Background, WishTarget::Spill]
    );
    let message = |text: &str| read(text).unwrap_err().to_string();
    assert!(message("key").contains("write NAME=LEVEL"));
    assert!(
        message("kicker=f/8").contains("it has Key softbox, Fill umbrella, Left, Right, subject, spill, background")
    );
    assert!(message("key=8").contains("write f/8, +0.5"));
    for odd in ["key=f/0", "key=f/nan", "key=+inf", "fill=-99", "key=f/", "key="] {
        assert!(matches!(read(odd), Err(WishError::UnknownLevel { .. })), "{odd}");
    }
    assert!(message("l=f/8").contains("\"Fill umbrella\" or \"Left\""));
    assert!(message("key=white").contains("only a background can be white"));
    assert!(message("key=f/8,softbox=f/4").contains("two wishes"));
    assert!(message("right=f/8").contains("no dial"));
    assert!(message("key=+1").contains("is the key"));
    assert!(message("subject=+1").contains("give the key an f-number, too") && read("subject=+1,key=f/8").is_ok());
    assert!(message("=f/8").contains("NAME=LEVEL"));
    // Without a key light, one that is relative is not the key, however strong it is
    let mut pair = key_and_fill();
    pair.iter_mut().for_each(|light| light.role = Role::Accent);
    let pair = SetupTransport::of_lights(pair, &[]);
    assert_dials(&solve(&pair, "umbrella=f/8,softbox=+1"), &[-2.0, -1.0]);
    let mut dark = key_and_fill();
    dark.iter_mut().for_each(|light| light.at = MeteredAt::Rim);
    assert!(matches!(wishes("fill=-1", &SetupTransport::of_lights(dark, &[])), Err(WishError::NoKey { .. })));
}

#[test]
fn a_studio_with_the_planned_dials_has_the_wanted_readings() {
    let softbox = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let flash = |id, name: &str, role, emitter, position: Vec3, aim: Vec3| {
        let output = Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: 20.0 };
        let mut light = Light { aim: Aim::Point(aim), position, ..Light::new(emitter, output) };
        (light.id, light.name, light.role, light.power.dial_stops) = (LightId(id), name.to_owned(), role, -3.0);
        Light { modifier: Modifier::default(), ..light }
    };
    let (subject, behind) = (Vec3::new(0.0, 1.5, 0.13), Vec3::new(0.0, 1.5, -2.0));
    let spot = Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 };
    let object =
        |name: &str, shape, position| Object { transform: Transform::at(position), ..Object::new(name, shape) };
    let mut scene = Scene {
        camera: Camera {
            position: Vec3::new(0.0, 1.5, 2.6),
            aim: Aim::Point(subject),
            f_number: 8.0,
            ..Camera::default()
        },
        objects: vec![
            object("Head", Shape::Sphere { radius_m: 0.12 }, Vec3::new(0.0, 1.5, 0.0)),
            object("Paper", Shape::Box { size_m: Vec3::new(3.0, 3.0, 0.1) }, Vec3::new(0.0, 1.5, -2.05)),
        ],
        lights: vec![
            flash(1, "Key", Role::Key, softbox, Vec3::new(1.0, 2.0, 1.2), subject),
            flash(2, "Fill", Role::Fill, softbox, Vec3::new(-1.4, 1.6, 1.4), subject),
            flash(3, "Hair", Role::Hair, softbox, Vec3::new(-0.4, 2.3, -1.0), Vec3::new(0.0, 1.5, 0.0)),
            flash(4, "Left back", Role::Background, spot, Vec3::new(-1.4, 1.5, -0.8), behind),
            flash(5, "Right back", Role::Background, spot, Vec3::new(1.4, 1.5, -0.8), behind),
        ],
        meter: Some(Meter { position: subject, facing: Facing::Camera, receptor: Receptor::Dome }),
        ..Scene::default()
    };
    scene.lights[4].on = false;
    let measure = |scene: &Scene| {
        let (cache, control) = (GeometryCache::default(), RenderControl::new());
        SetupTransport::measure(scene, &Assets::default(), &cache, &control).unwrap().unwrap()
    };
    let text = "key=f/8,fill=-1.5,hair=+0.5,background=+1,right back=f/9";
    let wanted = wishes(text, &measure(&scene)).unwrap();
    let plan = solve_dials(&measure(&scene), &wanted);
    assert!(plan.changes().count() >= 4 && plan.outcomes[0].before_lux_s != plan.outcomes[0].after_lux_s);
    plan.apply(&mut scene);
    // Metered anew, the wishes are met as they stand
    let metered = solve_dials(&measure(&scene), &wanted);
    for (planned, metered) in plan.outcomes.iter().zip(&metered.outcomes) {
        let off = (planned.after_lux_s / metered.before_lux_s).log2().abs();
        assert!(off < 0.02, "{planned:?}\n{metered:?}");
        let missed = (metered.before_lux_s / metered.wanted_lux_s).log2().abs();
        assert!(missed < 0.1, "{metered:?}");
    }
}

/// A meter in the middle of a room, lit by a bulb on the left as key and one on the right as fill.
fn room(albedos: [f32; 3]) -> Scene {
    let matte = |albedo: f32| Material { base_color: [albedo; 3], ior: 1.0, ..Material::default() };
    let [floor, walls, ceiling] = albedos.map(matte);
    let bulb = |id, name: &str, role, x: f32| {
        let light = Light::new(Emitter::Sphere { radius_m: 0.05 }, Output::Lumens(4000.0));
        Light { id: LightId(id), name: name.to_owned(), role, position: Vec3::new(x, 1.5, 0.5), ..light }
    };
    Scene {
        room: Some(Room { size_m: Vec3::new(4.0, 3.0, 4.0), floor, walls, ceiling }),
        lights: vec![bulb(1, "Key", Role::Key, -1.0), bulb(2, "Fill", Role::Fill, 1.6)],
        meter: Some(Meter { position: Vec3::Y * 1.5, facing: Facing::Camera, receptor: Receptor::Dome }),
        ..Scene::default()
    }
}

fn audit(scene: &Scene) -> RoomAudit {
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    RoomAudit::measure(scene, &Assets::default(), &cache, &control).unwrap().unwrap()
}

#[test]
fn surfaces_add_what_the_meter_loses_without_them() {
    let scene = room([0.2, 0.8, 0.8]);
    let audit = audit(&scene);
    let meter = |scene: &Scene| {
        let around = scene.meter.unwrap();
        let meter = LightMeter::new(scene, &Assets::default(), around.position).unwrap();
        let facing = around.direction(scene);
        let point = MeterPoint { position: around.position, facing, receptor: around.receptor };
        // Another seed: not the same samples
        let effort = MeterEffort { seed: 7, ..MeterEffort::default() };
        meter.read(&point, &effort, &RenderControl::new()).unwrap().reading.total_lux_s()
    };
    let (all, dark_walls) = (meter(&scene), meter(&room([0.2, 0.0, 0.8])));
    assert!((audit.total.lux_s / all - 1.0).abs() < 0.01);
    let walls = audit.total.added_stops(RoomSurface::Walls).unwrap();
    assert!((walls - (all / dark_walls).log2()).abs() < 0.02 && walls > 0.3, "{walls}");
    let of = |surface| audit.total.added_stops(surface).unwrap();
    assert!(of(RoomSurface::Floor) < of(RoomSurface::Ceiling) && of(RoomSurface::Ceiling) < walls);
    assert_eq!(audit.total.added_stops(RoomSurface::Backdrops), None, "there is none");
    // The fill is near a wall
    let [key, fill] = audit.lights.as_slice() else { panic!("two lights") };
    assert!(fill.added_stops(RoomSurface::Walls) > key.added_stops(RoomSurface::Walls));
    let [black, white] = audit.ceilings.as_slice() else { panic!("two ceilings") };
    let [black_stops, white_stops] = [black.stops.unwrap(), white.stops.unwrap()];
    assert!((black_stops + of(RoomSurface::Ceiling)).abs() < 1e-4 && (0.0..0.1).contains(&white_stops));
    assert!(black.key_to_fill > audit.key_to_fill, "less light from everywhere is more contrast");
}

#[test]
fn black_rooms_and_studios_without_a_room_add_nothing() {
    let black = audit(&room([0.0; 3]));
    assert_eq!(black.total.added_stops(RoomSurface::Walls), Some(0.0));
    assert!(black.ceilings[0].stops.unwrap().abs() < 1e-6 && black.ceilings[1].stops.unwrap() > 0.1);
    let open = audit(&Scene { room: None, ..room([0.0; 3]) });
    assert!(open.ceilings.is_empty() && open.total.without_lux_s.is_empty() && open.total.background_lux_s.is_none());
    let mut dark = room([0.5; 3]);
    dark.lights.clear();
    assert_eq!(audit(&dark).total.added_stops(RoomSurface::Floor), None);
}
