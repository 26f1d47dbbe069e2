//! Selections of several items: made in viewport and list; moved, deleted, copied, mirrored.

use super::*;
use glam::Vec3;

fn lights(window: &Window) -> Vec<Item> {
    scene(window).lights.iter().map(|l| Item::Light(l.id)).collect()
}

#[test]
fn lights_gathered_in_the_view_move_together_in_one_step() {
    let Some(mut window) = preset_window() else { return };
    let before = scene(&window).clone();
    let both = [before.lights[0].position, before.lights[1].position];
    let places = both.map(|point| shown_at(&window, point));
    click_at(&mut window, places[0], Modifiers::NONE);
    click_at(&mut window, places[1], Modifiers::SHIFT);
    assert_eq!(window.state().selection().items(), &lights(&window)[..2]);
    let centre = shown_at(&window, 0.5 * (both[0] + both[1]));
    drag(&mut window, PointerButton::Primary, centre, centre + vec2(50.0, -30.0));
    let moved = [0, 1].map(|i| scene(&window).lights[i].position - before.lights[i].position);
    assert!(moved[0].length() > 0.1 && (moved[0] - moved[1]).length() < 1e-5, "{moved:?}");
    assert_eq!((undo_depth(&window), scene(&window).lights[2].position), (1, before.lights[2].position));
    assert!(window.query_all_by_label("2 lights selected").next().is_some());
    let now = shown_at(&window, both[1] + moved[1]);
    click_at(&mut window, now, Modifiers::COMMAND);
    assert_eq!(window.state().selection().items(), &lights(&window)[..1]);
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.state().selection().is_empty());
}

#[test]
fn a_box_and_ctrl_a_select_what_is_there_and_not_locked() {
    let Some(mut window) = preset_window() else { return };
    let view = window.get_by_label("Viewport").rect().shrink(6.0);
    let inside: Vec<Item> = scene(&window)
        .lights
        .iter()
        .filter(|l| view.contains(shown_at(&window, l.position)))
        .map(|l| Item::Light(l.id))
        .collect();
    assert!(inside.len() > 1, "the preset shows its lights");
    run(&mut window, Command::Apply(Action::Lock(vec![inside[0]], true)));
    drag(&mut window, PointerButton::Primary, view.left_bottom(), view.right_top() - vec2(110.0, -130.0));
    let boxed = window.state().selection().clone();
    let by_hand = scene(&window).lights.iter().filter(|l| {
        let place = shown_at(&window, l.position);
        !l.locked && view.contains(place) && place.x < view.right() - 110.0 && place.y > view.top() + 130.0
    });
    let by_hand: Vec<_> = by_hand.map(|l| l.id).collect();
    assert_eq!(boxed.lights(), by_hand);
    assert!(!boxed.contains(inside[0]), "what is locked is passed over");
    press(&mut window, Modifiers::COMMAND, Key::A);
    let (all, things) = (window.state().selection(), scene(&window));
    let free = things.objects.iter().filter(|o| o.visible && !o.locked).count() + things.lights.len() - 1;
    assert_eq!(all.len(), free);
}

#[test]
fn several_are_deleted_and_copied_in_one_step() {
    let Some(mut window) = preset_window() else { return };
    let before = scene(&window).clone();
    let two = lights(&window)[..2].to_vec();
    select(&mut window, &two);
    press(&mut window, Modifiers::COMMAND, Key::D);
    assert_eq!((scene(&window).lights.len(), undo_depth(&window)), (before.lights.len() + 2, 1));
    assert_eq!(window.state().selection().len(), 2, "the copies are selected");
    press(&mut window, Modifiers::NONE, Key::Delete);
    assert_eq!(scene(&window).lights, before.lights);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!((scene(&window), undo_depth(&window)), (&before, 0));
}

#[test]
fn the_list_toggles_with_ctrl_and_selects_ranges_with_shift() {
    let Some(mut window) = preset_window() else { return };
    let names: Vec<String> = scene(&window).lights.iter().map(|l| l.name.clone()).collect();
    assert!(names.len() >= 3);
    let mut at = |name: &str, modifiers| {
        let place = window.get_by_label(name).rect().center();
        click_at(&mut window, place, modifiers);
        window.state().selection().lights().len()
    };
    assert_eq!(at(&names[0], Modifiers::NONE), 1);
    assert_eq!(at(&names[2], Modifiers::SHIFT), 3);
    assert_eq!(at(&names[1], Modifiers::COMMAND), 2);
    assert_eq!(at(&names[1], Modifiers::NONE), 1);
}

#[test]
fn a_typed_number_is_the_exact_move_and_esc_cancels_a_drag() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(light.id)]);
    let from = shown_at(&window, light.position);
    let begin = |window: &mut Window| {
        move_to(window, from);
        button(window, from, true);
        move_to(window, from + vec2(40.0, 10.0));
    };
    begin(&mut window);
    type_number(&mut window, "1.5");
    window.key_press(Key::Enter);
    window.step();
    move_to(&mut window, from + vec2(90.0, 60.0));
    button(&mut window, from + vec2(90.0, 60.0), false);
    settle(&mut window);
    let moved = (scene(&window).lights[0].position - light.position).length();
    assert!((moved - 1.5).abs() < 1e-4, "{moved} m");
    assert_eq!(
        (undo_depth(&window), window.state().central_view()),
        (1, CentralView::Studio),
        "the 1 was no key of its own"
    );
    press(&mut window, Modifiers::COMMAND, Key::Z);
    begin(&mut window);
    assert_ne!(scene(&window).lights[0], light);
    window.key_press(Key::Escape);
    window.step();
    button(&mut window, from, false);
    settle(&mut window);
    assert_eq!((&scene(&window).lights[0], undo_depth(&window)), (&light, 0));
    assert!(!window.state().selection().is_empty(), "Esc ended the drag, not the selection");
}

#[test]
fn a_mirrored_copy_is_on_the_other_side_of_the_face() {
    let Some(mut window) = figure_window() else { return };
    let key = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(key.id)]);
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::D);
    let copy = scene(&window).lights.last().unwrap().clone();
    assert_eq!(window.state().selection().items(), [Item::Light(copy.id)]);
    let subject = scene(&window).objects.iter().find(|o| matches!(o.shape, Shape::Figure(_))).unwrap();
    let own = subject.transform.world_from_object().inverse();
    let [original, mirrored] = [key.position, copy.position].map(|p| own.transform_point3(p));
    let flip = Vec3::new(-1.0, 1.0, 1.0);
    assert!((mirrored - original * flip).length() < 1e-4, "{mirrored} of {original}");
}

#[test]
fn a_right_click_on_a_light_in_the_viewport_opens_its_menu() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[1].clone();
    let at = shown_at(&window, light.position);
    move_to(&mut window, at);
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
        window.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        window.step();
    }
    settle(&mut window);
    assert_eq!(window.state().selection().items(), [Item::Light(light.id)]);
    window.get_by_label_contains("Place its highlight").click();
    settle(&mut window);
    assert!(window.state().viewport().tool.is_some());
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.state().viewport().tool.is_none());
}

#[test]
fn esc_cancels_a_selection_box_and_other_keys_are_ignored_during_it() {
    let Some(mut window) = preset_window() else { return };
    let view = window.get_by_label("Viewport").rect().shrink(6.0);
    let to = view.right_top() + vec2(-120.0, 140.0);
    for keys in [&[Key::Num1][..], &[Key::Num1, Key::Escape]] {
        select(&mut window, &[]);
        move_to(&mut window, view.left_bottom());
        button(&mut window, view.left_bottom(), true);
        for part in [0.5, 1.0] {
            move_to(&mut window, view.left_bottom().lerp(to, part));
        }
        for key in keys {
            window.key_press(*key);
            window.step();
        }
        button(&mut window, to, false);
        settle(&mut window);
        assert_eq!(window.state().central_view(), CentralView::Studio);
        assert_eq!(window.state().selection().is_empty(), keys.contains(&Key::Escape));
    }
}

#[test]
fn a_copy_is_beside_its_original_and_undo_and_redo_remove_and_restore_it() {
    let Some(mut window) = preset_window() else { return };
    let before = scene(&window).clone();
    let (figure, key) = (before.objects[0].clone(), before.lights[0].clone());
    let originals = [Item::Object(figure.id), Item::Light(key.id)];
    select(&mut window, &originals);
    press(&mut window, Modifiers::COMMAND, Key::D);
    let copies = window.state().selection().items().to_vec();
    for (copy, original) in copies.iter().zip(originals) {
        let apart = copy.position(scene(&window)).unwrap() - original.position(&before).unwrap();
        assert!(apart.length() > 0.2 && apart.y == 0.0, "{apart}");
    }
    assert_eq!((scene(&window).objects.first(), scene(&window).lights.first()), (Some(&figure), Some(&key)));
    let with_copies = scene(&window).clone();
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!((scene(&window), window.state().selection().is_empty()), (&before, true));
    press(&mut window, Modifiers::COMMAND, Key::Y);
    assert_eq!((scene(&window), window.state().selection().items()), (&with_copies, &copies[..]));
}

#[test]
fn undo_selects_what_it_restores_and_deselects_what_it_removes() {
    let Some(mut window) = preset_window() else { return };
    let two = lights(&window)[1..3].to_vec();
    let other = lights(&window)[0];
    select(&mut window, &two);
    press(&mut window, Modifiers::NONE, Key::Delete);
    assert!(window.state().selection().is_empty());
    select(&mut window, &[other]);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.state().selection().items(), two);
    // A step that neither brings nor takes things leaves the selection alone.
    press(&mut window, Modifiers::NONE, Key::X);
    select(&mut window, &[other]);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.state().selection().items(), [other]);
    press(&mut window, Modifiers::COMMAND, Key::Y);
    assert_eq!(window.state().selection().items(), [other]);
}

#[test]
fn lights_are_mirrored_about_the_face_of_a_figure_that_is_turned_or_hidden() {
    let Some(mut window) = preset_window() else { return };
    let key = scene(&window).lights[0].clone();
    let Aim::Object { object, .. } = key.aim else { panic!("the preset's key is aimed at its subject") };
    let mut subject = scene(&window).object(object).unwrap().clone();
    subject.transform.rotation_deg.y += 70.0;
    subject.visible = false;
    run(&mut window, Command::Apply(Action::SetObject(Box::new(subject.clone()))));
    select(&mut window, &[Item::Light(key.id)]);
    press(&mut window, Modifiers::NONE, Key::X);
    let own = subject.transform.world_from_object().inverse();
    let [before, after] = [key.position, scene(&window).lights[0].position].map(|p| own.transform_point3(p));
    assert!((after - before * Vec3::new(-1.0, 1.0, 1.0)).length() < 1e-4, "{after} of {before}");
    // Without any figure there is no face; the user is told and nothing moves.
    let all = scene(&window).objects.iter().map(|o| Item::Object(o.id)).collect();
    run(&mut window, Command::Apply(Action::Delete(all)));
    let before = scene(&window).clone();
    press(&mut window, Modifiers::NONE, Key::X);
    assert_eq!(*scene(&window), before);
    assert_eq!(window.state().toasts().texts(ToastKind::Info).len(), 1);
}

#[test]
fn what_is_copied_is_pasted_into_another_studio_in_one_step() {
    let Some(mut window) = preset_window() else { return };
    let (figure, light) = (scene(&window).objects[0].clone(), scene(&window).lights[0].clone());
    select(&mut window, &[Item::Object(figure.id), Item::Light(light.id)]);
    let text = copied_text(&mut window);
    press(&mut window, Modifiers::COMMAND, Key::N);
    click(&mut window, "Empty studio");
    window.event(Event::Paste(text));
    settle(&mut window);
    let pasted = scene(&window);
    assert_eq!((pasted.objects[0].name.as_str(), pasted.lights[0].name.as_str()), (&*figure.name, &*light.name));
    assert_eq!(pasted.lights[0].position, light.position);
    assert!(matches!(pasted.lights[0].aim, Aim::Object { object, .. } if object == pasted.objects[0].id));
    assert_eq!((window.state().selection().items().len(), undo_depth(&window)), (2, 1));
    // A cut is one step, too, and a text that is no studio adds nothing.
    window.event(Event::Cut);
    settle(&mut window);
    assert!(scene(&window).objects.is_empty() && undo_depth(&window) == 2);
    window.event(Event::Paste("a letter".to_owned()));
    settle(&mut window);
    assert_eq!(window.state().toasts().texts(ToastKind::Info).len(), 1);
    assert_eq!(undo_depth(&window), 2);
}

#[test]
fn a_name_that_is_typed_stays_when_a_control_beside_it_is_clicked() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    window.state_mut().run(Command::Select(Some(Item::Light(light.id))), None, &egui::Context::default());
    settle(&mut window);
    panels::search(&mut window, "Name", "Window light");
    // The click ends the typing and switches the light in one frame
    let off = window.get_by_label("Off").rect().center();
    click_at(&mut window, off, Modifiers::NONE);
    let now = &scene(&window).lights[0];
    assert_eq!((&*now.name, now.on), ("Window light", false));
}
