//! Lets the water of a tank run in the studio.
//!
//! The time of a tank is a part of the studio. While it runs, each frame that finds the mesh of the last one built moves
//! the time on, so that the window stays fluid however long the water takes. All of a run is one undo step.

use super::action::Action;
use crate::scene::{ObjectId, Scene, Shape};

/// Longest time by which a frame moves the water on, seconds: after a pause it does not leap.
const LONGEST_FRAME_S: f64 = 0.1;

/// The tank that runs, if one does.
#[derive(Debug)]
pub struct TankPlayer {
    run: Option<Run>,
    speed: f32,
    runs: u64,
}

#[derive(Debug)]
struct Run {
    tank: ObjectId,
    /// The time that it has set last, seconds.
    shown_s: f32,
    /// The time that it has reached, which is not a whole number of steps.
    time_s: f64,
    /// The clock at its last frame.
    clock_s: Option<f64>,
}

impl Default for TankPlayer {
    fn default() -> Self {
        TankPlayer { run: None, speed: 1.0, runs: 0 }
    }
}

impl TankPlayer {
    /// Returns true while this tank runs.
    pub fn is_playing(&self, id: ObjectId) -> bool {
        self.run.as_ref().is_some_and(|run| run.tank == id)
    }

    /// Returns true while a tank runs.
    pub fn is_running(&self) -> bool {
        self.run.is_some()
    }

    /// Returns the speed of the water as a multiple of nature's.
    pub fn speed(&self) -> f32 {
        self.speed
    }

    /// Sets the speed.
    pub fn set_speed(&mut self, speed: f32) {
        self.speed = speed;
    }

    /// Lets a tank run from its time on; none holds the water.
    pub fn play(&mut self, scene: &Scene, tank: Option<ObjectId>) {
        self.runs += 1;
        self.run = tank.and_then(|tank| {
            let time_s = time_of(scene, tank)?;
            Some(Run { tank, shown_s: time_s, time_s: time_s.into(), clock_s: None })
        });
    }

    /// Holds the water.
    pub fn hold(&mut self) {
        self.run = None;
    }

    /// Returns the number that merges the changes of this run into one undo step. No press of the mouse has it.
    pub fn merge_id(&self) -> u64 {
        u64::MAX - self.runs
    }

    /// Returns the change of the next frame, at a time of the clock. None while the water waits, `is_built` for the mesh
    /// of the last change.
    pub fn advance(&mut self, scene: &Scene, clock_s: f64, is_built: bool) -> Option<Action> {
        let run = self.run.as_mut()?;
        let elapsed_s = clock_s - run.clock_s.replace(clock_s).unwrap_or(clock_s);
        let Some(mut object) = scene.object(run.tank).cloned() else {
            self.run = None;
            return None;
        };
        let Shape::Tank(tank) = &mut object.shape else {
            self.run = None;
            return None;
        };
        // Whoever sets the time by hand, or undoes, holds the water
        if tank.time_s != run.shown_s || tank.time_s >= tank.longest_s() {
            self.run = None;
            return None;
        }
        if !is_built {
            return None;
        }
        run.time_s += elapsed_s.clamp(0.0, LONGEST_FRAME_S) * f64::from(self.speed);
        let step = (run.time_s * f64::from(tank.steps_per_s())) as u32;
        if step <= tank.steps() {
            return None;
        }
        tank.time_s = (step as f32 / tank.steps_per_s()).min(tank.longest_s());
        run.shown_s = tank.time_s;
        Some(Action::SetObject(Box::new(object)))
    }
}

fn time_of(scene: &Scene, id: ObjectId) -> Option<f32> {
    match &scene.object(id)?.shape {
        Shape::Tank(tank) => Some(tank.time_s),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::studio_document::Document;
    use crate::scene::{Assets, Object, Tank};

    fn tank_time(document: &Document) -> f32 {
        time_of(document.scene(), ObjectId(0)).unwrap()
    }

    #[test]
    fn a_run_moves_the_time_by_whole_steps_as_one_undo_step_and_waits_for_the_mesh() {
        let mut scene = Scene::default();
        scene.objects.push(Object::new("Tank", Shape::Tank(Box::default())));
        let mut document = Document::new(scene, Assets::default(), None);
        let mut player = TankPlayer::default();
        player.play(document.scene(), Some(ObjectId(0)));
        let frame = |player: &mut TankPlayer, document: &mut Document, clock_s: f64, is_built: bool| {
            let action = player.advance(document.scene(), clock_s, is_built);
            action.map(|action| document.apply(action, Some(player.merge_id())).unwrap()).is_some()
        };
        assert!(!frame(&mut player, &mut document, 10.0, true), "the first frame starts the clock");
        assert!(frame(&mut player, &mut document, 10.05, true));
        assert_eq!(tank_time(&document), 3.0 / 60.0);
        assert!(!frame(&mut player, &mut document, 10.1, false), "it waits for the mesh");
        assert!(!frame(&mut player, &mut document, 10.105, true), "not a whole step");
        assert!(frame(&mut player, &mut document, 10.15, true));
        assert!(frame(&mut player, &mut document, 99.0, true));
        assert!(tank_time(&document) < 0.3, "no leap after a pause: {}", tank_time(&document));
        player.set_speed(4.0);
        let before = tank_time(&document);
        assert!(frame(&mut player, &mut document, 99.05, true));
        assert!((tank_time(&document) - before - 0.2).abs() < 0.02);
        // One undo step, after which the water stands still
        document.undo();
        assert_eq!((tank_time(&document), document.history().undo_label()), (0.0, None));
        assert!(!frame(&mut player, &mut document, 99.2, true) && !player.is_running());
    }

    #[test]
    fn a_fluid_runs_by_its_frames() {
        let mut scene = Scene::default();
        let fluid = Tank { fluid: Some(Box::default()), ..Tank::default() };
        scene.objects.push(Object::new("Tank", Shape::Tank(Box::new(fluid))));
        let mut player = TankPlayer::default();
        player.play(&scene, Some(ObjectId(0)));
        player.advance(&scene, 0.0, true);
        player.advance(&scene, 0.013, true).unwrap().apply(&mut scene).unwrap();
        assert_eq!(time_of(&scene, ObjectId(0)), Some(3.0 / 240.0));
    }

    #[test]
    fn a_run_ends_at_the_longest_time_and_with_its_tank() {
        let mut scene = Scene::default();
        let late = Tank::default().longest_s() - 0.01;
        scene.objects.push(Object::new("Tank", Shape::Tank(Box::new(Tank { time_s: late, ..Tank::default() }))));
        let mut player = TankPlayer::default();
        player.play(&scene, Some(ObjectId(0)));
        player.advance(&scene, 0.0, true);
        let last = player.advance(&scene, 0.1, true).unwrap();
        last.apply(&mut scene).unwrap();
        assert_eq!(time_of(&scene, ObjectId(0)), Some(Tank::default().longest_s()));
        assert!(player.advance(&scene, 0.2, true).is_none() && !player.is_running());
        player.play(&scene, Some(ObjectId(0)));
        assert!(player.is_playing(ObjectId(0)));
        scene.objects.clear();
        assert!(player.advance(&scene, 0.3, true).is_none() && !player.is_running());
        player.play(&scene, Some(ObjectId(3)));
        assert!(!player.is_running());
    }
}
