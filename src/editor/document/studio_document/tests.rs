use super::*;
use crate::editor::document::catalog;
use crate::scene::{Aim, Camera, Figure, Focus, Gaze, Object};
use glam::Vec3;
use std::sync::Arc;

fn with_a_light() -> (Document, crate::scene::Light) {
    let mut document = Document::default();
    let light = catalog::light_named("Octa 120").unwrap();
    document.apply(Action::AddLight(Box::new(light)), None).unwrap();
    let light = document.scene().lights[0].clone();
    (document, light)
}

#[test]
fn a_drag_is_one_step_and_dirty_ends_where_it_began() {
    let (mut document, mut light) = with_a_light();
    document.mark_saved("a.ron".into());
    for i in 0..20 {
        light.position.x = i as f32 * 0.1;
        document.apply(Action::SetLight(Box::new(light.clone())), Some(7)).unwrap();
    }
    assert!(document.is_dirty());
    assert_eq!(document.undo().as_deref(), Some("Move Octa 120"));
    assert!(!document.is_dirty());
    document.redo();
    assert_eq!(document.scene().lights[0].position.x, 1.9);
}

#[test]
fn a_deleted_object_and_a_deleted_light_are_forgotten_in_all_variants() {
    let (mut document, id) = with_a_person();
    let light = catalog::light_named("Octa 120").unwrap();
    document.apply(Action::AddLight(Box::new(light.clone())), None).unwrap();
    let a = document.scene().variants.shown();
    document.apply(Action::AddVariant("B".to_owned()), None).unwrap();
    let b = document.scene().variants.shown();
    // In B, the light and the camera follow the person, the light is dim and the person hidden
    let at = Aim::Object { object: id, offset: Vec3::Y };
    let mut dim = document.scene().lights[0].clone();
    (dim.aim, dim.power.dial_stops) = (at, -7.0);
    let focus = Focus::OnObject { object: id, offset: Vec3::Y };
    let camera = Camera { aim: at, focus, ..document.scene().camera.clone() };
    document.apply(Action::SetLight(Box::new(dim)), None).unwrap();
    document.apply(Action::SetCamera(Box::new(camera)), None).unwrap();
    let mut person = document.scene().objects[0].clone();
    (person.visible, person.transform.position.x) = (false, 2.0);
    document.apply(Action::SetObject(Box::new(person)), None).unwrap();
    document.show_variant(a);
    document.apply(Action::Delete(vec![Item::Object(id)]), None).unwrap();
    let of_b = document.scene().variant_alone(b).unwrap();
    assert_eq!(of_b.lights[0].aim, Aim::Point(Vec3::new(2.0, 1.0, 0.0)));
    assert_eq!((of_b.camera.aim, of_b.camera.focus), (of_b.lights[0].aim, Focus::OnAim));
    // A new light may get the id of the deleted one, and must not get its difference
    let old = document.scene().lights[0].id;
    document.apply(Action::Delete(vec![Item::Light(old)]), None).unwrap();
    document.apply(Action::AddLight(Box::new(light)), None).unwrap();
    assert_ne!(document.scene().variant_alone(b).unwrap().lights[0].power.dial_stops, -7.0);
}

#[test]
fn names_that_a_variant_gives_up_are_free_at_once() {
    let (mut document, light) = with_a_light();
    document.apply(Action::AddVariant("B".to_owned()), None).unwrap();
    let old = light.name.clone();
    document.apply(Action::Rename(Item::Light(light.id), "Main".to_owned()), None).unwrap();
    document.apply(Action::AddLight(Box::new(light)), None).unwrap();
    assert_eq!(document.scene().lights[1].name, old);
}

#[test]
fn showing_variants_is_no_change_and_undo_and_redo_stay_in_theirs() {
    let (mut document, light) = with_a_light();
    document.apply(Action::Solo(vec![light.id]), None).unwrap();
    let a = document.scene().variants.shown();
    document.apply(Action::AddVariant("B".to_owned()), None).unwrap();
    let b = document.scene().variants.shown();
    let dimmed = |stops| {
        let mut light = light.clone();
        light.power.dial_stops = stops;
        Action::SetLight(Box::new(light))
    };
    document.apply(dimmed(-6.0), Some(1)).unwrap();
    document.mark_saved("a.ron".into());
    for id in [a, b, a] {
        document.show_variant(id);
        assert!(!document.is_dirty());
    }
    assert!(document.scene().solo.is_some());
    for _ in 0..2 {
        document.undo();
        assert_eq!(document.scene().variants.shown(), b);
        document.show_variant(a);
        document.redo();
        assert_eq!((document.scene().variants.shown(), document.scene().lights[0].power.dial_stops), (b, -6.0));
    }
    // One press in two variants is two steps
    document.show_variant(a);
    document.apply(dimmed(-1.0), Some(1)).unwrap();
    document.undo();
    assert_eq!(document.scene().variant_alone(b).unwrap().lights[0].power.dial_stops, -6.0);
}

fn with_a_person() -> (Document, ObjectId) {
    let mut document = Document::default();
    let object = Object::new("Person", Shape::Figure(Box::default()));
    document.apply(Action::AddObject(Box::new(object)), None).unwrap();
    let id = document.scene().objects[0].id;
    (document, id)
}

fn change_figure(document: &mut Document, id: ObjectId, change: impl FnOnce(&mut Figure)) {
    let mut object = document.scene().object(id).unwrap().clone();
    if let Shape::Figure(figure) = &mut object.shape {
        change(figure);
    }
    document.apply(Action::SetObject(Box::new(object)), None).unwrap();
}

fn gaze(document: &Document) -> [f32; 2] {
    let Shape::Figure(figure) = &document.scene().objects[0].shape else { panic!("a person") };
    [figure.pose.torso.gaze_yaw_deg, figure.pose.torso.gaze_pitch_deg]
}

#[test]
fn eyes_follow_the_camera_until_the_light_that_they_follow_is_deleted() {
    let (mut document, id) = with_a_person();
    let mut camera = document.scene().camera.clone();
    camera.position = Vec3::new(0.6, 1.6, 2.5);
    document.apply(Action::SetCamera(Box::new(camera.clone())), None).unwrap();
    assert_eq!(gaze(&document), [0.0; 2]);
    change_figure(&mut document, id, |figure| figure.gaze = Gaze::Camera);
    assert!((gaze(&document)[0] - 13.75).abs() < 1.0, "{:?}", gaze(&document));
    camera.position.x = -0.6;
    document.apply(Action::SetCamera(Box::new(camera)), None).unwrap();
    assert!((gaze(&document)[0] + 13.75).abs() < 1.0, "{:?}", gaze(&document));
    document.undo();
    assert!(gaze(&document)[0] > 12.0);
    let light = catalog::light_named("Octa 120").unwrap();
    document.apply(Action::AddLight(Box::new(light)), None).unwrap();
    let light = document.scene().lights[0].id;
    change_figure(&mut document, id, |figure| figure.gaze = Gaze::Light(light));
    let at_light = gaze(&document);
    document.apply(Action::Delete(vec![Item::Light(light)]), None).unwrap();
    let Shape::Figure(figure) = &document.scene().objects[0].shape else { panic!("a person") };
    assert_eq!((figure.gaze, gaze(&document)), (Gaze::Pose, at_light));
}

#[test]
fn a_changed_figure_keeps_its_meshes_until_the_new_ones_are_built() {
    let (mut document, id) = with_a_person();
    let first = document.wanted_assets();
    let load = |document: &Document| {
        let mut assets = document.finished_assets();
        assert_eq!(io::load_assets(document.scene(), None, &mut assets), []);
        assets
    };
    let shown = |document: &Document| document.assets().mesh_of(&document.scene().objects[0].shape).unwrap();
    document.insert_assets(load(&document), &first);
    assert!(document.wanted_assets().is_empty());
    let before = shown(&document);
    for teeth in [0.2, 0.4] {
        change_figure(&mut document, id, |figure| figure.expression.teeth = teeth);
        assert!(Arc::ptr_eq(&shown(&document), &before), "the older mesh is shown");
        assert_eq!(document.wanted_assets().len(), 1, "the new one is wanted");
        let figure = &document.scene().objects[0].shape;
        assert!(document.finished_assets().mesh_of(figure).is_none(), "a render does not get the older one");
    }
    // What was built for a state that the slider has left is shown until the newest is there
    let (late, wanted) = (load(&document), document.wanted_assets());
    change_figure(&mut document, id, |figure| figure.expression.teeth = 0.6);
    document.insert_assets(late, &wanted);
    let between = shown(&document);
    assert!(!Arc::ptr_eq(&between, &before));
    let wanted = document.wanted_assets();
    assert_eq!(wanted.len(), 1);
    document.insert_assets(load(&document), &wanted);
    assert!(!Arc::ptr_eq(&shown(&document), &between) && document.wanted_assets().is_empty());
}

#[test]
fn two_studios_are_never_at_the_same_revision() {
    // Regression: the meter kept the reading of the previous studio, since both were at their first revision.
    let open = || Document::new(Scene::default(), Assets::default(), None);
    assert_ne!(open().revision(), open().revision());
    assert_ne!(open().revision(), Document::default().revision());
}

#[test]
fn a_rejected_action_changes_nothing() {
    let (mut document, _) = with_a_light();
    let (revision, depth) = (document.revision(), document.history().depth());
    assert!(document.apply(Action::Rename(Item::Camera, "Eye".into()), None).is_err());
    let same = document.scene().camera.clone();
    document.apply(Action::SetCamera(Box::new(same)), None).unwrap();
    assert_eq!((revision, depth), (document.revision(), document.history().depth()));
}

#[test]
fn imported_files_get_relative_names_that_do_not_clash() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("props")).unwrap();
    std::fs::write(folder.path().join("props/chair.obj"), "").unwrap();
    let path = Some(folder.path().join("a.ron"));
    let mut document = Document::new(Scene::default(), Assets::default(), path);
    assert_eq!(document.asset_path_for(&folder.path().join("props/chair.obj"), "models"), "props/chair.obj");
    let outside = Path::new("/somewhere/chair.obj");
    assert_eq!(document.asset_path_for(outside, "models"), "models/chair.obj");
    document.note_import("models/chair.obj".into(), "/elsewhere/chair.obj".into());
    assert_eq!(document.asset_path_for(outside, "models"), "models/chair-2.obj");
}
