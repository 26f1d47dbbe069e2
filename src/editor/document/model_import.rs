//! Bringing a model into the open studio: what its user is asked, and the change of the scene.

use crate::editor::document::action::Action;
use crate::editor::document::files::ImportedModel;
use crate::io::{self, LoadProgress};
use crate::scene::{Camera, Focus, FocusedLens, Light, Object, Scene};
use glam::Vec3;
use std::sync::Arc;

/// A model or a studio that is read in the background.
#[derive(Clone, Debug)]
pub struct RunningLoad {
    /// Name of the file or the studio.
    pub name: String,
    /// Whether it is a studio.
    pub is_studio: bool,
    /// Time of the window from which on it is shown, seconds: most studios are read by then.
    pub shown_from_s: f64,
    /// How far it is.
    pub progress: Arc<LoadProgress>,
}

/// The choices of the user about a model that comes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelChoice {
    /// Length of the file's unit, metres.
    pub metres: f32,
    /// The lamps of the file come along.
    pub lamps: bool,
    /// The camera moves to that of the file.
    pub camera: bool,
}

impl ModelChoice {
    /// Returns the choice that is offered: the likeliest unit, with the lamps, and the studio's own camera.
    pub fn offered(model: &ImportedModel) -> Self {
        let metres = io::model_unit_m(&model.mesh);
        ModelChoice { metres, lamps: !model.set_up.lights.is_empty(), camera: false }
    }
}

/// Returns true if the user should be asked: the size is in doubt, or the file has a camera.
pub fn is_asked(model: &ImportedModel) -> bool {
    is_size_asked(model) || model.set_up.camera.is_some()
}

/// Returns true if the unit of a model is in doubt.
pub fn is_size_asked(model: &ImportedModel) -> bool {
    io::is_model_size_doubtful(&model.mesh, model.states_metres)
}

/// Returns the change that adds a placed model with what was chosen of its lamps and camera. They stand around it as in
/// its file.
pub fn action(scene: &Scene, object: Object, model: &ImportedModel, choice: ModelChoice) -> Action {
    let (lamps, camera) = model.set_up.around(&object.transform, &model.mesh);
    let lamps = if choice.lamps { lamps } else { Vec::new() };
    let camera = camera.filter(|_| choice.camera).map(|camera| {
        let (low, high) = model.mesh.bounds();
        let middle = object.transform.world_from_object().transform_point3(0.5 * (low + high));
        placed_camera(scene, camera, &lamps, middle)
    });
    if lamps.is_empty() && camera.is_none() {
        return Action::AddObject(Box::new(object));
    }
    let label = format!("Add {}{}", object.name, with_lamps(lamps.len()));
    // The last one is selected: the model
    let camera = camera.map(|camera| Action::SetCamera(Box::new(camera)));
    let lamps = lamps.into_iter().map(|lamp| Action::AddLight(Box::new(lamp)));
    let actions = camera.into_iter().chain(lamps).chain([Action::AddObject(Box::new(object))]).collect();
    Action::Together { label, actions }
}

/// Returns the studio's camera at the place and with the lens of the file's. It is exposed for the lamps where no other
/// light is on.
fn placed_camera(scene: &Scene, file: Camera, lamps: &[Light], middle: Vec3) -> Camera {
    let mut camera = Camera {
        position: file.position,
        aim: file.aim,
        roll_deg: file.roll_deg,
        sensor: file.sensor,
        orientation: file.orientation,
        focal_length_mm: file.focal_length_mm,
        focus: Focus::OnAim,
        ..scene.camera.clone()
    };
    if !scene.lights.iter().any(|light| light.on) {
        let lens = FocusedLens::new(scene, &camera);
        io::expose_for_lamps(&mut camera, &lens, lamps, middle);
    }
    camera
}

/// Returns the end of a sentence about a model with so many lamps.
pub fn with_lamps(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => " with its lamp".to_owned(),
        _ => format!(" with its {count} lamps"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::studio_document::Document;
    use crate::io::ModelSetUp;
    use crate::scene::{Aim, Emitter, Output, Shape, tessellate};

    /// Returns a box of 30 units with a lamp 100 over it and a camera 100 before it.
    fn model() -> (Object, ImportedModel) {
        let shape = Shape::Box { size_m: Vec3::splat(30.0) };
        let mesh = Arc::new(tessellate(&shape).unwrap());
        let lamp = Light { position: Vec3::Y * 100.0, ..Light::new(Emitter::Point, Output::Candela(5e4)) };
        let camera = Camera {
            position: Vec3::Z * 100.0,
            aim: Aim::Point(Vec3::ZERO),
            focal_length_mm: 90.0,
            iso: 6400.0,
            ..Camera::default()
        };
        let set_up = ModelSetUp { lights: vec![lamp], camera: Some(camera) };
        let model = ImportedModel {
            file: "a.glb".into(),
            mesh,
            part_materials: Vec::new(),
            set_up,
            states_metres: true,
            warnings: Vec::new(),
        };
        (Object::new("A", shape), model)
    }

    #[test]
    fn lamps_and_camera_stand_around_the_model_as_in_its_file_in_one_step() {
        let (mut object, model) = model();
        let choice = ModelChoice::offered(&model);
        assert_eq!(choice, ModelChoice { metres: 0.01, lamps: true, camera: false });
        assert!(is_asked(&model) && is_size_asked(&model));
        io::scale_model(&mut object, &model.mesh, choice.metres);
        object.transform.position.x = 2.0;
        let before = Scene::default();
        let mut document = Document::new(before.clone(), Default::default(), None);
        let choice = ModelChoice { camera: true, ..choice };
        document.apply(action(&before, object, &model, choice), None).unwrap();
        let scene = document.scene();
        let [lamp] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
        // The box stands on the floor: its middle is at 15 cm
        assert!(lamp.position.distance(Vec3::new(2.0, 1.15, 0.0)) < 1e-5, "{}", lamp.position);
        assert!(
            matches!(lamp.power.output, Output::Candela(cd) if (cd - 5.0).abs() < 1e-4),
            "the same lux at its surface"
        );
        let camera = &scene.camera;
        assert!(camera.position.distance(Vec3::new(2.0, 0.15, 1.0)) < 1e-5, "{}", camera.position);
        assert_eq!((camera.focal_length_mm, camera.iso), (90.0, before.camera.iso), "the lens of the file");
        // 5 cd at 1 m: N^2 / t = E S / C
        let seconds = camera.meter_constant * camera.f_number.powi(2) / (5.0 * camera.iso);
        assert!((camera.shutter_s / seconds.min(30.0) - 1.0).abs() < 1e-4, "{} s", camera.shutter_s);
        assert_eq!(document.undo().as_deref(), Some("Add A with its lamp"));
        assert_eq!(*document.scene(), before);
    }

    #[test]
    fn without_its_set_up_a_model_is_an_object_and_keeps_the_exposure_of_a_lit_studio() {
        let (object, model) = model();
        let nothing = ModelChoice { metres: 0.01, lamps: false, camera: false };
        assert!(matches!(action(&Scene::default(), object.clone(), &model, nothing), Action::AddObject(_)));
        let lit = Scene { lights: vec![Light::new(Emitter::Point, Output::Lumens(1000.0))], ..Scene::default() };
        let choice = ModelChoice { camera: true, ..nothing };
        let Action::Together { actions, .. } = action(&lit, object, &model, choice) else {
            panic!("camera and object")
        };
        let [Action::SetCamera(camera), Action::AddObject(_)] = &actions[..] else { panic!("{actions:?}") };
        assert_eq!(camera.shutter_s, lit.camera.shutter_s);
    }
}
