//! The cellular automaton: water falls, spreads and comes to rest level.
//!
//! A step pours what springs give, lets water fall by one cell, and spreads it between neighbours of a layer a few times.
//! What flows between two cells is a function of their state before, equal and opposite for both, and bounded by a
//! quarter of the water of the one and of the room of the other: whatever the order, no unit is lost or made, and
//! mirrored tanks stay mirrored.
//!
//! Water comes to rest: with the level L of each cell, a pass moves at most a fifth of the difference between two
//! neighbours, f <= dL / 5. The sum of all L^2, which is the potential energy, then changes by at most
//! -2 sum(f dL) + 8 sum(f^2) <= -2 sum(f^2) over all faces, since a cell has four of them. It falls as long as anything
//! flows, and it is an integer.

use super::grid::{FULL, Grid};
use super::terrain;
use crate::scene::{Spring, TANK_STEPS_PER_S, Tank, TankLook, Texture};
use rayon::prelude::*;

/// Passes that spread water in a step. More let a wave run further in a second.
const SPREAD_PASSES: usize = 4;
/// Rows of columns that one task spreads at least.
const ROWS_PER_TASK: usize = 8;

/// The water of a tank at some time.
#[derive(Clone, Debug)]
pub struct Simulation {
    recipe: Tank,
    grid: Grid,
    spans: Vec<Span>,
    /// The water after a pass; equal to the grid's outside of each column's last span.
    next: Vec<u16>,
    next_spans: Vec<Span>,
    /// Steps during which each spring was on.
    steps_on: Vec<u32>,
    step: u32,
    poured: u64,
    is_at_rest: bool,
}

/// The layers of a column in which something can move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Span {
    /// Lowest layer that is not full.
    low: u16,
    /// The layer above the highest water.
    top: u16,
    /// Layers in which the two copies of the water may differ.
    changed: (u16, u16),
}

impl Simulation {
    /// Returns a tank at its start. One whose ground is made of a picture needs [`Simulation::with_heights`].
    pub fn new(tank: &Tank) -> Self {
        Simulation::with_heights(tank, None)
    }

    /// Returns a tank at its start, with the picture of its heights.
    pub fn with_heights(tank: &Tank, heights: Option<&Texture>) -> Self {
        Simulation::of_grid(terrain::start(tank, heights), tank)
    }

    /// Returns the simulation of these cells, with the springs of a tank.
    pub(super) fn of_grid(grid: Grid, tank: &Tank) -> Self {
        let ny = grid.size()[1];
        let next = grid.water.clone();
        let spans: Vec<Span> = (0..grid.columns()).map(|column| Span::of(&grid, column * ny, 0, ny)).collect();
        Simulation {
            recipe: tank.clone(),
            next,
            next_spans: spans.clone(),
            spans,
            grid,
            steps_on: vec![0; tank.springs.len()],
            step: 0,
            poured: 0,
            is_at_rest: false,
        }
    }

    /// Returns the cells.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns what the springs have poured so far, in units.
    pub fn poured(&self) -> u64 {
        self.poured
    }

    /// Returns true if nothing moved in the last step.
    pub fn is_at_rest(&self) -> bool {
        self.is_at_rest
    }

    /// Returns true if going on from here leads to the state that a tank shows: it is the same tank at a later time, and
    /// its springs did the same so far.
    pub fn leads_to(&self, tank: &Tank) -> bool {
        let without_springs = |tank: &Tank| Tank { springs: Vec::new(), look: TankLook::Smooth, ..tank.at_start() };
        let did_the_same = |(ours, theirs): (&Spring, &Spring)| {
            let mut steps = ours.switch_steps().chain(theirs.switch_steps()).chain([0]);
            (ours.at_m, ours.litres_per_s) == (theirs.at_m, theirs.litres_per_s)
                && steps.all(|step| step >= self.step || ours.is_on(step) == theirs.is_on(step))
        };
        let springs = &self.recipe.springs;
        self.step <= tank.steps()
            && without_springs(&self.recipe) == without_springs(tank)
            && springs.len() == tank.springs.len()
            && springs.iter().zip(&tank.springs).all(did_the_same)
    }

    /// Goes on to the state that a tank shows, which this one must lead to.
    pub fn run_to(&mut self, tank: &Tank) {
        self.recipe.springs.clone_from(&tank.springs);
        while self.step < tank.steps() {
            let springs = &self.recipe.springs;
            if self.is_at_rest && !springs.iter().any(|spring| spring.is_on(self.step)) {
                // Nothing happens until a spring is switched on
                let switches = springs.iter().flat_map(Spring::switch_steps).filter(|&step| step > self.step);
                self.step = switches.min().unwrap_or(u32::MAX).min(tank.steps());
            } else {
                self.advance();
            }
        }
    }

    /// Makes one step.
    pub fn advance(&mut self) {
        let mut has_moved = self.pour();
        has_moved |= self.fall();
        for _ in 0..SPREAD_PASSES {
            has_moved |= self.spread();
        }
        self.step += 1;
        self.is_at_rest = !has_moved;
    }

    /// Adds the water of the springs. What has no room in the column of a spring is not there.
    fn pour(&mut self) -> bool {
        let [_, ny, _] = self.grid.size();
        let before = self.poured;
        let cell_litres = (f64::from(self.recipe.cell_m) * 10.0).powi(3);
        for (spring, steps_on) in self.recipe.springs.iter().zip(&mut self.steps_on) {
            if !spring.is_on(self.step) {
                continue;
            }
            // Whole units of the flow so far, less those that were poured
            let per_step = f64::from(spring.litres_per_s) / cell_litres * f64::from(FULL) / f64::from(TANK_STEPS_PER_S);
            let total = |steps: u32| (per_step * f64::from(steps)) as u64;
            let mut left = total(*steps_on + 1) - total(*steps_on);
            *steps_on += 1;
            // The first cells with room, from that of the spring upwards
            let at = ((spring.at_m - self.recipe.low_m()) / self.recipe.cell_m).max(glam::Vec3::ZERO).as_usizevec3();
            let limit = self.grid.size();
            let [x, y, z] = [0, 1, 2].map(|axis| at[axis].min(limit[axis] - 1));
            let bottom = self.grid.index([x, 0, z]);
            for layer in y..ny {
                left -= self.grid.add_water(bottom + layer, left);
            }
            self.poured += total(*steps_on) - total(*steps_on - 1) - left;
            let span = &mut self.spans[bottom / ny];
            *span = Span { changed: (span.changed.0.min(y as u16), ny as u16), ..Span::of(&self.grid, bottom, 0, ny) };
        }
        self.poured > before
    }

    /// Lets the water of each column fall by one cell, the lowest first.
    fn fall(&mut self) -> bool {
        let ny = self.grid.size()[1];
        let mut has_moved = false;
        for column in 0..self.grid.columns() {
            let bottom = column * ny;
            let Span { low, top, changed } = self.spans[column];
            for layer in usize::from(low)..usize::from(top).saturating_sub(1) {
                let (below, above) = (bottom + layer, bottom + layer + 1);
                let falls = (FULL - self.grid.level(below)).min(self.grid.water(above));
                self.grid.water[below] += falls;
                self.grid.water[above] -= falls;
                has_moved |= falls > 0;
            }
            if low < top {
                let span = Span::of(&self.grid, bottom, low.into(), top.into());
                self.spans[column] = Span { changed: (changed.0.min(low), changed.1.max(top)), ..span };
            }
        }
        has_moved
    }

    /// Lets water flow between neighbours in each layer. Returns false if nothing did.
    fn spread(&mut self) -> bool {
        let [nx, ny, nz] = self.grid.size();
        let (grid, spans) = (&self.grid, &self.spans);
        let rows = self.next.par_chunks_mut(nx * ny).zip(self.next_spans.par_chunks_mut(nx)).enumerate();
        let spread_row = |(z, (row, row_spans)): (usize, (&mut [u16], &mut [Span]))| {
            let mut has_moved = false;
            for (x, (cells, span)) in row.chunks_mut(ny).zip(row_spans).enumerate() {
                let column = z * nx + x;
                let neighbours = [
                    (x > 0).then(|| column - 1),
                    (x + 1 < nx).then(|| column + 1),
                    (z > 0).then(|| column - nx),
                    (z + 1 < nz).then(|| column + nx),
                ];
                has_moved |= spread_column(grid, spans, column, neighbours, cells, span);
            }
            has_moved
        };
        let has_moved = rows.with_min_len(ROWS_PER_TASK).map(spread_row).reduce(|| false, |a, b| a | b);
        std::mem::swap(&mut self.grid.water, &mut self.next);
        std::mem::swap(&mut self.spans, &mut self.next_spans);
        has_moved
    }
}

impl Span {
    /// Returns the span of the column whose lowest cell is `bottom`, if cells below layer `low` are full and those from
    /// `top` on have no water.
    fn of(grid: &Grid, bottom: usize, low: usize, top: usize) -> Self {
        let ny = grid.size()[1];
        let first_free = (low..ny).find(|layer| grid.level(bottom + layer) < FULL).unwrap_or(ny);
        let highest = (0..top).rev().find(|layer| grid.water(bottom + layer) > 0);
        Span { low: first_free as u16, top: highest.map_or(0, |layer| layer as u16 + 1), changed: (u16::MAX, 0) }
    }
}

/// Computes the water of a column after a pass into `next`, and its span.
fn spread_column(
    grid: &Grid,
    spans: &[Span],
    column: usize,
    neighbours: [Option<usize>; 4],
    next: &mut [u16],
    next_span: &mut Span,
) -> bool {
    let ny = grid.size()[1];
    let bottom = column * ny;
    let own = spans[column];
    // Below all lows the cells are full on both sides of each face, above all tops there is no water
    let near = || neighbours.iter().flatten().map(|&column| spans[column]);
    let low = near().map(|span| span.low).fold(own.low, u16::min);
    let top = near().map(|span| span.top).fold(own.top, u16::max);
    // Bring the other copy up to date where the last pass has changed it
    let stale = usize::from(own.changed.0)..usize::from(own.changed.1).min(ny);
    if stale.start < stale.end {
        next[stale.clone()].copy_from_slice(&grid.water[bottom..][stale]);
    }
    let mut has_moved = false;
    for (layer, units) in next.iter_mut().enumerate().take(top.into()).skip(low.into()) {
        let cell = bottom + layer;
        let inflow: i32 = neighbours.iter().flatten().map(|&other| flow(grid, other * ny + layer, cell, layer)).sum();
        *units = (i32::from(grid.water(cell)) + inflow) as u16;
        has_moved |= inflow != 0;
    }
    let level = |layer: usize| grid.ground(bottom + layer) + next[layer];
    let first_free = (usize::from(low)..ny).find(|&layer| level(layer) < FULL).unwrap_or(ny);
    let highest = (0..usize::from(top.max(own.top))).rev().find(|&layer| next[layer] > 0);
    let changed = if has_moved { (low, top) } else { (u16::MAX, 0) };
    *next_span = Span { low: first_free as u16, top: highest.map_or(0, |layer| layer as u16 + 1), changed };
    has_moved
}

/// Returns the units that flow from a cell to its neighbour in the same layer during a pass, negative for the other way.
/// Water that can fall does not spread.
#[inline]
fn flow(grid: &Grid, from: usize, to: usize, layer: usize) -> i32 {
    let part = (i32::from(grid.level(from)) - i32::from(grid.level(to))) / 5;
    if part == 0 {
        return 0;
    }
    let (giver, taker) = if part > 0 { (from, to) } else { (to, from) };
    if layer > 0 && grid.level(giver - 1) < FULL {
        return 0;
    }
    let amount = part.abs().min(i32::from(grid.water(giver) / 4)).min(i32::from((FULL - grid.level(taker)) / 4));
    amount * part.signum()
}

#[cfg(test)]
mod tests;
