//! What a variant may change: camera, lights, and which objects are visible.

use crate::scene::{Camera, Light, ObjectId, Scene};
use std::collections::HashSet;

/// Camera, lights and hidden objects of one variant.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StudioSetup {
    /// The camera.
    pub camera: Camera,
    /// The lights, in list order.
    pub lights: Vec<Light>,
    /// The objects that are not visible.
    pub hidden: Vec<ObjectId>,
}

impl StudioSetup {
    /// Returns the set-up that a scene shows.
    pub fn of(scene: &Scene) -> Self {
        let hidden = scene.objects.iter().filter(|object| !object.visible).map(|object| object.id);
        StudioSetup { camera: scene.camera.clone(), lights: scene.lights.clone(), hidden: hidden.collect() }
    }

    /// Puts the set-up into a scene.
    pub fn put_into(self, scene: &mut Scene) {
        let hidden: HashSet<ObjectId> = self.hidden.into_iter().collect();
        for object in &mut scene.objects {
            object.visible = !hidden.contains(&object.id);
        }
        (scene.camera, scene.lights) = (self.camera, self.lights);
    }
}
