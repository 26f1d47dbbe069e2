//! Water that runs in the window.

use super::*;
use catchlight::scene::{Object, ObjectId, Spring, Tank};
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
