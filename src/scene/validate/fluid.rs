//! Checks the fluid of a water tank: every number, and the bounds of memory and time.

use super::check::{Allowed, Check, SIZE};
use crate::scene::{Drop, Fluid, Jet, Obstacle, ObstacleForm, Tank};
use glam::Vec3;

/// Places in a tank, metres.
const PLACE: Allowed = Allowed::between(-1e5, 1e5, "m");
/// Components of velocities.
const VELOCITY: Allowed = Allowed::between(-100.0, 100.0, "m/s");
/// Speeds of fall.
const SPEED: Allowed = Allowed::between(0.0, 100.0, "m/s");
/// Times.
const TIME: Allowed = Allowed::between(0.0, 1e4, "s");

pub(super) fn check_fluid(fluid: &Fluid, tank: &Tank, check: &mut Check) {
    let Fluid { drops, jets, obstacles, seed: _ } = fluid;
    for (name, count) in [("drops", drops.len()), ("jets", jets.len()), ("obstacles", obstacles.len())] {
        if count > Fluid::MAX_THINGS {
            let message = format!("{count} {name} are too many; at most {} are allowed", Fluid::MAX_THINGS);
            check.error(&format!("shape.fluid.{name}"), message);
        }
    }
    for (index, Drop { at_m, radius_m, velocity_m_s }) in drops.iter().take(Fluid::MAX_THINGS).enumerate() {
        let field = |name: &str| format!("shape.fluid.drops[{index}].{name}");
        check_place(&field("at_m"), *at_m, tank, check);
        check.number(&field("radius_m"), *radius_m, SIZE);
        check.vector(&field("velocity_m_s"), *velocity_m_s, VELOCITY);
    }
    for (index, Jet { at_m, radius_m, velocity_m_s, until_s }) in jets.iter().take(Fluid::MAX_THINGS).enumerate() {
        let field = |name: &str| format!("shape.fluid.jets[{index}].{name}");
        check_place(&field("at_m"), *at_m, tank, check);
        check.number(&field("radius_m"), *radius_m, SIZE);
        check.vector(&field("velocity_m_s"), *velocity_m_s, VELOCITY);
        check.number(&field("until_s"), *until_s, TIME);
    }
    for (index, obstacle) in obstacles.iter().take(Fluid::MAX_THINGS).enumerate() {
        check_obstacle(&format!("shape.fluid.obstacles[{index}]"), obstacle, check);
    }
    if tank.cell_count() > Fluid::MAX_CELLS {
        let (count, most) = (tank.cell_count(), Fluid::MAX_CELLS);
        check.error("shape.cells", format!("{count} cells are too many for a fluid; at most {most} are allowed"));
    }
    if !tank.springs.is_empty() {
        check.warning("shape.springs", "the water of this tank is a fluid; its jets pour, not its springs".to_owned());
    }
    // What is no number has been refused above
    let particles = fluid.particle_bound(tank);
    if particles > Fluid::MAX_PARTICLES as f64 {
        let most = Fluid::MAX_PARTICLES;
        let message = format!(
            "{particles:.0} particles of water are too many; at most {most} are allowed: larger cells have fewer"
        );
        check.error("shape.cell_m", message);
    }
}

fn check_place(field: &str, at_m: Vec3, tank: &Tank, check: &mut Check) {
    check.vector(field, at_m, PLACE);
    let in_tank = at_m - tank.low_m();
    if at_m.is_finite() && (in_tank.cmplt(Vec3::ZERO) | in_tank.cmpgt(tank.size_m())).any() {
        check.warning(field, "it is outside of the tank; there is no water outside".to_owned());
    }
}

fn check_obstacle(field: &str, obstacle: &Obstacle, check: &mut Check) {
    let Obstacle { form, at_m, falls_m_s, stands_s } = *obstacle;
    check.vector(&format!("{field}.at_m"), at_m, PLACE);
    check.number(&format!("{field}.falls_m_s"), falls_m_s, SPEED);
    check.number(&format!("{field}.stands_s"), stands_s, TIME);
    let mut size = |name: &str, value: f32| check.number(&format!("{field}.form.{name}"), value, SIZE);
    match form {
        ObstacleForm::Ball { radius_m } => size("radius_m", radius_m),
        ObstacleForm::Box { size_m } => check.vector(&format!("{field}.form.size_m"), size_m, SIZE),
        ObstacleForm::Cylinder { radius_m, height_m } => {
            size("radius_m", radius_m);
            size("height_m", height_m);
        }
        ObstacleForm::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, drink_m } => {
            size("floor_m", floor_m);
            size("floor_radius_m", floor_radius_m);
            size("rim_m", rim_m);
            size("rim_radius_m", rim_radius_m);
            check.number(&format!("{field}.form.drink_m"), drink_m, Allowed::between(0.0, 1e5, "m"));
            let is_upright = floor_m < rim_m;
            if !is_upright {
                check.error(&format!("{field}.form.rim_m"), "the rim must be above the floor".to_owned());
            }
        }
    }
}
