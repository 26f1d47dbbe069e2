//! What a variant may change: camera, lights, and which objects are visible.

use crate::scene::{Camera, Light, ObjectId, Scene, Solo};
use std::collections::HashSet;

/// Camera, lights, hidden objects and solo of one variant.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StudioSetup {
    /// The camera.
    pub camera: Camera,
    /// The lights, in list order.
    pub lights: Vec<Light>,
    /// The objects that are not visible.
    pub hidden: Vec<ObjectId>,
    /// The solo, which the switches of the lights follow.
    pub solo: Option<Solo>,
}

impl StudioSetup {
    /// Returns the set-up that a scene shows.
    pub fn of(scene: &Scene) -> Self {
        let hidden = scene.objects.iter().filter(|object| !object.visible).map(|object| object.id);
        StudioSetup {
            camera: scene.camera.clone(),
            lights: scene.lights.clone(),
            hidden: hidden.collect(),
            solo: scene.solo.clone(),
        }
    }

    /// Returns the set-up after its solo, which differences ignore.
    pub fn without_solo(&self) -> Self {
        let mut setup = self.clone();
        if let Some(solo) = setup.solo.take() {
            solo.end(&mut setup.lights);
        }
        setup
    }

    /// Puts the set-up into a scene.
    pub fn put_into(self, scene: &mut Scene) {
        let hidden: HashSet<ObjectId> = self.hidden.into_iter().collect();
        for object in &mut scene.objects {
            object.visible = !hidden.contains(&object.id);
        }
        (scene.camera, scene.lights, scene.solo) = (self.camera, self.lights, self.solo);
    }
}
