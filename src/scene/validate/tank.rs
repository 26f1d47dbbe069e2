//! Checks a water tank: every number, and the bounds of memory and time.

use super::check::{Allowed, Check, SIZE};
use super::fluid::check_fluid;
use crate::scene::{BrushStroke, Spring, Tank, Terrain};

/// Heights in a tank, metres.
const HEIGHT: Allowed = Allowed::between(0.0, 1e5, "m");

/// Coordinates of a point of a stroke, metres.
const POINT: Allowed = Allowed::between(-1e5, 1e5, "m");

pub(super) fn check_tank(tank: &Tank, check: &mut Check) {
    check_cells(tank, check);
    check.number("shape.cell_m", tank.cell_m, SIZE);
    check.number("shape.water_m", tank.water_m, HEIGHT);
    check_terrain(&tank.terrain, check);
    if tank.blocks.len() > Tank::MAX_BLOCKS {
        let count = tank.blocks.len();
        check.error("shape.blocks", format!("{count} blocks are too many; at most {} are allowed", Tank::MAX_BLOCKS));
    }
    for (index, block) in tank.blocks.iter().take(Tank::MAX_BLOCKS).enumerate() {
        if block.from.iter().zip(&block.to).any(|(from, to)| from > to) {
            check.error(&format!("shape.blocks[{index}].to"), "a block must not end before it begins".to_owned());
        }
    }
    check_strokes(tank, check);
    if tank.springs.len() > Tank::MAX_SPRINGS {
        let count = tank.springs.len();
        check
            .error("shape.springs", format!("{count} springs are too many; at most {} are allowed", Tank::MAX_SPRINGS));
    }
    for (index, spring) in tank.springs.iter().take(Tank::MAX_SPRINGS).enumerate() {
        check_spring(&format!("shape.springs[{index}]"), spring, tank, check);
    }
    check.number("shape.time_s", tank.time_s, Allowed::between(0.0, tank.longest_s(), "s, for so many cells"));
    if let Some(fluid) = &tank.fluid {
        check_fluid(fluid, tank, check);
    }
}

fn check_strokes(tank: &Tank, check: &mut Check) {
    let (count, points) = (tank.strokes.len(), tank.stroke_points());
    if count > Tank::MAX_STROKES || points > Tank::MAX_STROKE_POINTS {
        let (strokes, most) = (Tank::MAX_STROKES, Tank::MAX_STROKE_POINTS);
        let message =
            format!("{count} strokes of {points} points are too many; at most {strokes} of {most} are allowed");
        check.error("shape.strokes", message);
        return;
    }
    let largest_m = BrushStroke::MAX_RADIUS_CELLS * tank.cell_m;
    for (index, stroke) in tank.strokes.iter().enumerate() {
        let place = format!("shape.strokes[{index}]");
        check.number(&format!("{place}.radius_m"), stroke.radius_m, Allowed::between(0.0, largest_m, "m, 16 cells"));
        for (index, point) in stroke.path_m.iter().enumerate() {
            check.vector(&format!("{place}.path_m[{index}]"), *point, POINT);
        }
    }
}

fn check_cells(tank: &Tank, check: &mut Check) {
    let range = 1..=Tank::MAX_SIDE;
    if let Some(side) = tank.cells.iter().find(|side| !range.contains(side)) {
        let message = format!("{side} cells along an axis are not allowed; there must be 1 to {}", Tank::MAX_SIDE);
        check.error("shape.cells", message);
    } else if tank.cell_count() > Tank::MAX_CELLS {
        let message = format!("{} cells are too many; at most {} are allowed", tank.cell_count(), Tank::MAX_CELLS);
        check.error("shape.cells", message);
    }
}

fn check_terrain(terrain: &Terrain, check: &mut Check) {
    match *terrain {
        Terrain::Picture { ref path, low_m, high_m } => {
            check.asset_path("shape.terrain.path", path);
            check.number("shape.terrain.low_m", low_m, HEIGHT);
            check.number("shape.terrain.high_m", high_m, HEIGHT);
        }
        Terrain::Flat { height_m } => check.number("shape.terrain.height_m", height_m, HEIGHT),
        Terrain::Basin { floor_m, rim_m } => {
            check.number("shape.terrain.floor_m", floor_m, HEIGHT);
            check.number("shape.terrain.rim_m", rim_m, HEIGHT);
        }
        Terrain::Hills { seed: _, low_m, high_m, period_m } => {
            check.number("shape.terrain.low_m", low_m, HEIGHT);
            check.number("shape.terrain.high_m", high_m, HEIGHT);
            check.number("shape.terrain.period_m", period_m, SIZE);
        }
    }
}

fn check_spring(field: &str, spring: &Spring, tank: &Tank, check: &mut Check) {
    check.vector(&format!("{field}.at_m"), spring.at_m, Allowed::between(-1e5, 1e5, "m"));
    check.number(&format!("{field}.litres_per_s"), spring.litres_per_s, Allowed::between(0.0, 1e6, "l/s"));
    let in_tank = spring.at_m - tank.low_m();
    if spring.at_m.is_finite() && (in_tank.cmplt(glam::Vec3::ZERO) | in_tank.cmpgt(tank.size_m())).any() {
        check.warning(
            &format!("{field}.at_m"),
            "it is outside of the tank; its water is poured at the nearest cell".to_owned(),
        );
    }
    let switches = &spring.switches_s;
    if switches.len() > Spring::MAX_SWITCHES {
        let message = format!("{} switches are too many; at most {} are allowed", switches.len(), Spring::MAX_SWITCHES);
        check.error(&format!("{field}.switches_s"), message);
        return;
    }
    for time_s in switches {
        check.number(&format!("{field}.switches_s"), *time_s, Allowed::between(0.0, 1e4, "s"));
    }
    if switches.windows(2).any(|pair| pair[0] > pair[1]) {
        check.error(&format!("{field}.switches_s"), "the times must be in order".to_owned());
    }
}
