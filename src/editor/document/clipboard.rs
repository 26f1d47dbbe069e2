//! Lights and objects on the system's clipboard, as the text of a studio. Comments at its head name the files of models,
//! textures and measured lights, for a window whose studio lies in another folder.

use crate::editor::document::item::Item;
use crate::editor::document::{arrange, switches};
use crate::io::{self, AssetFiles};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Start of a comment with the path of an asset in the studio, and its file.
const FILE_COMMENT: &str = "// file of an asset: ";

/// Lights and objects from the clipboard.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipboardContent {
    /// A studio with them.
    pub scene: Scene,
    /// The files of its assets, by the studio's paths.
    pub files: BTreeMap<String, PathBuf>,
}

/// Returns the text of a studio with these lights and objects alone; none without any. Aims at other objects become
/// points of the room; eyes that follow another light keep their pose. A solo ends, so that every light has its switch.
pub fn copied_text(scene: &Scene, items: &[Item], files: AssetFiles<'_>) -> Option<String> {
    let mut part = scene.clone();
    switches::solo(&mut part, Vec::new()).ok()?;
    part.objects.iter_mut().for_each(|object| object.locked = false);
    part.lights.iter_mut().for_each(|light| light.locked = false);
    let objects = part.objects.iter().map(|object| Item::Object(object.id));
    let lights = part.lights.iter().map(|light| Item::Light(light.id));
    let others: Vec<Item> = objects.chain(lights).filter(|item| !items.contains(item)).collect();
    arrange::delete(&mut part, &others).ok()?;
    let part = Scene { objects: part.objects, lights: part.lights, ..Scene::default() };
    let has_any = !(part.objects.is_empty() && part.lights.is_empty());
    has_any.then(|| {
        let comments: String = files.found(&part).iter().filter_map(file_comment).collect();
        comments + &io::write_scene(&part)
    })
}

/// Returns the comment that names the file of an asset; none for one whose name is not Unicode.
fn file_comment((path, file): (&String, &PathBuf)) -> Option<String> {
    let pair = ron::to_string(&(path, file.to_str()?)).ok()?;
    Some(format!("{FILE_COMMENT}{pair}\n"))
}

/// Returns the lights and objects of a text; none if it is no studio, or one without any.
pub fn pasted(text: &str) -> Option<ClipboardContent> {
    let (scene, _) = io::parse_scene(text).ok()?;
    let has_any = !(scene.objects.is_empty() && scene.lights.is_empty());
    has_any.then(|| ClipboardContent { scene, files: text.lines().map_while(named_file).collect() })
}

/// Returns the path and the file that a line names; none for another line, or one that names a file of another kind.
fn named_file(line: &str) -> Option<(String, PathBuf)> {
    let (path, file): (String, PathBuf) = ron::from_str(line.strip_prefix(FILE_COMMENT)?).ok()?;
    (Path::new(&path).extension() == file.extension()).then_some((path, file))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aim, Gaze, Object, Shape};

    fn copied(scene: &Scene, items: &[Item]) -> Option<String> {
        copied_text(scene, items, AssetFiles::in_folder(None))
    }

    #[test]
    fn the_files_of_copied_things_are_named_and_those_of_another_kind_are_not_taken() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("cup.obj");
        std::fs::write(&file, "").unwrap();
        let things = ["cup.obj", "gone.obj"].map(|path| Object::new(path, Shape::MeshFile { path: path.to_owned() }));
        let mut scene = Scene::default();
        let items = things.map(|thing| arrange::add_object(&mut scene, thing));
        let text = copied_text(&scene, &items, AssetFiles::in_folder(Some(folder.path()))).unwrap();
        let files = pasted(&text).unwrap().files;
        assert_eq!(files, BTreeMap::from([("cup.obj".to_owned(), file.canonicalize().unwrap())]));
        let other = text.replace(&*file.to_string_lossy(), "/etc/passwd");
        assert_eq!(pasted(&other).unwrap().files, BTreeMap::new());
        assert_eq!(pasted(&other).unwrap().scene.objects.len(), 2);
    }

    #[test]
    fn a_copied_light_keeps_its_aim_as_a_point_and_with_its_subject_as_an_object() {
        let scene = io::presets()[0].scene().unwrap();
        let (light, object) = (&scene.lights[0], &scene.objects[0]);
        assert!(matches!(light.aim, Aim::Object { object: at, .. } if at == object.id));
        let alone = pasted(&copied(&scene, &[Item::Light(light.id)]).unwrap()).unwrap().scene;
        assert_eq!((alone.lights.len(), alone.objects.len()), (1, 0));
        let Aim::Point(point) = alone.lights[0].aim else { panic!("{:?}", alone.lights[0].aim) };
        assert!(point.distance(scene.aim_point(&light.aim, light.position)) < 1e-3);
        let both = [Item::Light(light.id), Item::Object(object.id)];
        let both = pasted(&copied(&scene, &both).unwrap()).unwrap().scene;
        assert!(matches!(both.lights[0].aim, Aim::Object { object: at, .. } if at == both.objects[0].id));
    }

    #[test]
    fn pasted_items_have_new_names_and_keep_what_they_aim_and_look_at() {
        let mut scene = io::presets()[0].scene().unwrap();
        let (light, object) = (scene.lights[0].id, scene.objects[0].id);
        if let Shape::Figure(figure) = &mut scene.objects[0].shape {
            figure.gaze = Gaze::Light(light);
        }
        let text = copied(&scene, &[Item::Light(light), Item::Object(object)]).unwrap();
        let before = scene.clone();
        let pasted = arrange::paste(&mut scene, &pasted(&text).unwrap().scene);
        let [Item::Object(new_object), Item::Light(new_light)] = pasted[..] else { panic!("{pasted:?}") };
        assert!(new_object != object && new_light != light);
        let (new, old) = (scene.object(new_object).unwrap(), before.object(object).unwrap());
        assert!(new.name != old.name && new.transform.position != old.transform.position, "beside the first one");
        assert!(matches!(&new.shape, Shape::Figure(figure) if figure.gaze == Gaze::Light(new_light)));
        let new = scene.light(new_light).unwrap();
        assert!(matches!(new.aim, Aim::Object { object: at, .. } if at == new_object));
        // A second copy is beside the first one, not in it.
        let again = arrange::paste(&mut scene, &super::pasted(&text).unwrap().scene);
        let position = |item: Item| item.position(&scene).unwrap();
        assert!(position(again[0]).distance(position(Item::Object(new_object))) > 0.3);
        // In another studio they keep their positions.
        let mut empty = Scene::default();
        arrange::paste(&mut empty, &super::pasted(&text).unwrap().scene);
        assert_eq!(empty.objects[0].transform, old.transform);
        assert_eq!(empty.objects[0].name, old.name);
    }

    #[test]
    fn a_light_that_a_solo_switched_off_is_copied_with_its_switch() {
        let mut scene = io::presets()[0].scene().unwrap();
        let [first, second] = [scene.lights[0].id, scene.lights[1].id];
        switches::solo(&mut scene, vec![first]).unwrap();
        assert!(!scene.light(second).unwrap().on);
        let copied = pasted(&copied(&scene, &[Item::Light(second)]).unwrap()).unwrap();
        assert!(copied.scene.lights[0].on);
    }

    #[test]
    fn texts_that_are_no_studio_are_not_pasted() {
        let camera_alone = io::write_scene(&Scene::default());
        for text in ["", "hello", "(format: 1)", &camera_alone] {
            assert_eq!(pasted(text), None, "{text}");
        }
        let scene = io::presets()[0].scene().unwrap();
        assert_eq!(copied(&scene, &[Item::Camera, Item::Room]), None);
    }
}
