//! Springs: sources of water that are switched on and off at known times.

use super::TANK_STEPS_PER_S;
use glam::Vec3;

/// A spring. In the ground its water rises to the first cell that has room for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Position in the tank's space, metres.
    pub at_m: Vec3,
    /// Its flow, litres per second.
    pub litres_per_s: f32,
    /// The times at which it is switched on, off, on ..., seconds, in order.
    pub switches_s: Vec<f32>,
}

impl Spring {
    /// Largest number of switches.
    pub const MAX_SWITCHES: usize = 64;

    /// Returns a spring that is on from the start.
    pub fn new(at_m: Vec3, litres_per_s: f32) -> Self {
        Spring { at_m, litres_per_s, switches_s: vec![0.0] }
    }

    /// Returns the steps of the simulation before which it is switched, in order.
    pub fn switch_steps(&self) -> impl Iterator<Item = u32> {
        self.switches_s.iter().map(|&time_s| step_at(time_s))
    }

    /// Returns true if it is on during a step of the simulation.
    pub fn is_on(&self, step: u32) -> bool {
        self.switch_steps().filter(|&switch| switch <= step).count() % 2 == 1
    }

    /// Switches it at a time: what it would have done from then on is forgotten. Returns false if it has been switched
    /// too often.
    pub fn switch(&mut self, time_s: f32) -> bool {
        let step = step_at(time_s);
        let was_on = self.is_on(step);
        self.switches_s.retain(|&switch| step_at(switch) < step);
        // The switch of this very time may be among those forgotten
        if (self.switches_s.len() % 2 == 1) == was_on {
            if self.switches_s.len() >= Self::MAX_SWITCHES {
                return false;
            }
            self.switches_s.push(time_s);
        }
        true
    }
}

/// Returns the step of the simulation that begins at a time.
fn step_at(time_s: f32) -> u32 {
    (time_s * TANK_STEPS_PER_S).round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spring_that_is_switched_keeps_its_past_and_forgets_its_future() {
        let mut spring = Spring::new(Vec3::ZERO, 1.0);
        assert!(spring.is_on(0) && spring.is_on(6000));
        assert!(spring.switch(2.0));
        assert_eq!(spring.switches_s, [0.0, 2.0]);
        assert!(spring.is_on(119) && !spring.is_on(120) && !spring.is_on(500));
        assert!(spring.switch(3.0));
        assert!(!spring.is_on(179) && spring.is_on(180));
        // Back in time: the switches after it are gone
        assert!(spring.switch(1.0));
        assert_eq!(spring.switches_s, [0.0, 1.0]);
        // Switched twice at the same time
        assert!(spring.switch(1.0));
        assert!(spring.is_on(60) && spring.is_on(500), "{spring:?}");
        assert!(spring.switch(0.0));
        assert!(!spring.is_on(0), "{spring:?}");
        let full: Vec<f32> = (0..Spring::MAX_SWITCHES).map(|i| i as f32).collect();
        let mut full = Spring { switches_s: full, ..spring };
        assert!(!full.switch(100.0));
    }
}
