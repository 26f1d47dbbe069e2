//! Water that runs in the window.

use super::*;
use catchlight::scene::{Aim, Camera, CellContent, Object, ObjectId, Spring, Tank, Terrain};
use glam::Vec3;

fn tank(app: &App) -> &Tank {
    match &app.document().scene().objects[0].shape {
        Shape::Tank(tank) => tank,
        _ => panic!("the tank is gone"),
    }
}

fn run(window: &mut Window, command: Command) {
    window.state_mut().run(command, None, &egui::Context::default());
    window.run_steps(2);
}

#[test]
fn water_runs_until_it_is_held_and_one_undo_brings_it_back() {
    if !has_adapter() {
        return;
    }
    let spring = Spring::new(Vec3::new(0.0, 0.09, 0.0), 0.05);
    let small = Tank { cells: [12, 10, 12], springs: vec![spring], ..Tank::default() };
    let object = Object::new("Tank", Shape::Tank(Box::new(small)));
    let scene = Scene { objects: vec![object], ..Scene::default() };
    let initial = Some(StudioSource::Memory(Box::new(scene)));
    let mut window = window(EditorOptions { initial, ..EditorOptions::default() });
    run(&mut window, Command::Select(Some(Item::Object(ObjectId(0)))));
    // The window does not come to rest while the water runs
    window.get_by_label("Play").click();
    window.run_steps(2);
    wait_until(&mut window, |app| tank(app).time_s > 0.3);
    click(&mut window, "Pause");
    let held_s = tank(window.state()).time_s;
    window.run_steps(5);
    assert_eq!(tank(window.state()).time_s, held_s, "it is held");
    // The mesh of this time is there: no stand-in, and none of all the times between
    wait_until(&mut window, |app| app.document().wanted_assets().is_empty());
    assert!(window.state().document().assets().iter().count() <= 2);
    click(&mut window, "Step");
    assert!((tank(window.state()).time_s - held_s - 1.0 / 60.0).abs() < 1e-4);
    run(&mut window, Command::Undo);
    assert_eq!(tank(window.state()).time_s, held_s);
    run(&mut window, Command::Undo);
    assert_eq!(tank(window.state()).time_s, 0.0, "the run is one step");
    click(&mut window, "On");
    assert!(!tank(window.state()).springs[0].is_on(0), "the spring is off from the start");
}

#[test]
fn the_brush_paints_cells_in_a_stroke_that_undo_takes_back_and_esc_cancels() {
    if !has_adapter() {
        return;
    }
    let flat = Terrain::Flat { height_m: 0.1 };
    let small = Tank { cells: [24, 20, 24], terrain: flat, water_m: 0.0, time_s: 0.5, ..Tank::default() };
    let object = Object::new("Tank", Shape::Tank(Box::new(small)));
    let camera = Camera { position: Vec3::new(0.0, 0.6, 0.6), aim: Aim::Point(Vec3::Y * 0.1), ..Camera::default() };
    let scene = Scene { objects: vec![object], camera, ..Scene::default() };
    let initial = Some(StudioSource::Memory(Box::new(scene)));
    let mut window = window(EditorOptions { initial, ..EditorOptions::default() });
    run(&mut window, Command::Select(Some(Item::Object(ObjectId(0)))));
    run(&mut window, Command::ShowView(CentralView::Camera));
    wait_until(&mut window, |app| app.document().wanted_assets().is_empty());
    settle(&mut window);
    let before = tank(window.state()).clone();
    let depth = undo_depth(&window);
    click(&mut window, "Paint in the view");
    let middle = window.get_by_label("Viewport").rect().center();
    drag(&mut window, PointerButton::Primary, middle - vec2(40.0, 0.0), middle + vec2(40.0, 0.0));
    let painted = tank(window.state()).clone();
    assert_eq!(
        (painted.strokes.len(), painted.time_s, undo_depth(&window)),
        (1, 0.0, depth + 1),
        "one stroke, one step"
    );
    let stroke = &painted.strokes[0];
    assert_eq!(stroke.content, CellContent::Water);
    assert!(stroke.path_m.len() > 3, "{stroke:?}");
    // It lies on the ground, and runs to the right
    assert!(stroke.path_m.iter().all(|point| (point.y - 0.1).abs() < 0.011), "{stroke:?}");
    assert!(stroke.path_m.windows(2).all(|pair| pair[1].x > pair[0].x), "{stroke:?}");
    run(&mut window, Command::Undo);
    assert_eq!(tank(window.state()), &before);
    run(&mut window, Command::Redo);
    assert_eq!(tank(window.state()), &painted);
    // Esc in the middle of a stroke leaves no trace of it, and once more puts the brush down
    wait_until(&mut window, |app| app.document().wanted_assets().is_empty());
    move_to(&mut window, middle);
    let press_at = |window: &mut Window, pressed| {
        let button = PointerButton::Primary;
        window.event(Event::PointerButton { pos: middle, button, pressed, modifiers: Modifiers::NONE });
        window.step();
    };
    press_at(&mut window, true);
    move_to(&mut window, middle + vec2(0.0, 30.0));
    assert_eq!(tank(window.state()).strokes.len(), 2);
    press(&mut window, Modifiers::NONE, Key::Escape);
    move_to(&mut window, middle + vec2(0.0, 50.0));
    press_at(&mut window, false);
    settle(&mut window);
    assert_eq!((tank(window.state()), undo_depth(&window)), (&painted, depth + 1));
    assert!(window.query_by_label("Put it down").is_some());
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.state().viewport().tool.is_none());
    // Another press: what the cancelled one still does is ignored. The button is below what is shown
    let label = window.get_by_label("Speed").rect().center();
    click_at(&mut window, label, Modifiers::NONE);
    window.get_by_label("Clear strokes").click_accesskit();
    settle(&mut window);
    assert!(tank(window.state()).strokes.is_empty());
}
