//! Learning of the density of starts from the photons that arrive on visible surfaces.

use super::start_density::{SECTIONS, StartDensity};
use crate::raytrace::render_scene::RenderScene;
use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Weight of the mean importance of its neighbours in that of a section: more sections may matter than were found.
const NEIGHBOUR_WEIGHT: f64 = 0.3;
/// Neighbours of a section at most: on folded surfaces there would be thousands.
const MAX_NEIGHBOURS: usize = 64;
/// Radius of the neighbourhood of a section, in widths of a section.
const NEIGHBOUR_WIDTHS: f32 = 3.0;

/// Counts photons by the section of the casters' curve in which they start.
#[derive(Debug)]
pub struct StartLearner {
    /// Sections near each section.
    neighbours: Vec<Vec<u16>>,
    /// Photons that arrived on visible surfaces.
    arrived: Vec<u32>,
    /// Expected number of photons that started.
    started: Vec<f64>,
}

impl StartLearner {
    /// A learner without photons.
    pub fn new(scene: &RenderScene) -> Self {
        let centres = scene.casters.section_centres(&scene.aggregate, SECTIONS);
        let width = (scene.casters.area() / SECTIONS as f32).sqrt();
        let neighbours = neighbours(&centres, (NEIGHBOUR_WIDTHS * width).max(f32::MIN_POSITIVE));
        StartLearner { neighbours, arrived: vec![0; SECTIONS], started: vec![0.0; SECTIONS] }
    }

    /// Forgets all photons.
    pub fn clear(&mut self) {
        self.arrived.fill(0);
        self.started.fill(0.0);
    }

    /// Adds so many photons that started with a density; `arrived` are the sections of those that arrived.
    pub fn add(&mut self, starts: &StartDensity, photons: u32, arrived: &[u16]) {
        arrived.iter().for_each(|&section| self.arrived[usize::from(section)] += 1);
        for (section, started) in (0..).zip(&mut self.started) {
            *started += f64::from(photons) * starts.section_probability(section);
        }
    }

    /// Returns the density of starts for which the number of arriving photons has the least variance: in proportion to
    /// the root of the probability to arrive.
    pub fn density(&self) -> StartDensity {
        let counts = self.arrived.iter().zip(&self.started);
        let importances: Vec<f64> = counts.map(|(&arrived, started)| (f64::from(arrived) / started).sqrt()).collect();
        let mean = |near: &[u16]| {
            near.iter().map(|&section| importances[usize::from(section)]).sum::<f64>() / near.len().max(1) as f64
        };
        let spread = self.neighbours.iter().zip(&importances).map(|(near, own)| own + NEIGHBOUR_WEIGHT * mean(near));
        StartDensity::new(&spread.collect::<Vec<f64>>())
    }
}

/// Returns the indices of the points within a radius of each.
fn neighbours(points: &[Vec3], radius: f32) -> Vec<Vec<u16>> {
    let cell = |position: Vec3| (position / radius).floor().as_ivec3();
    let mut cells: HashMap<IVec3, Vec<u16>> = HashMap::new();
    (0..).zip(points).for_each(|(index, point)| cells.entry(cell(*point)).or_default().push(index));
    let near = |point: &Vec3| {
        let middle = cell(*point);
        let around = (0..27).map(|i| middle.wrapping_add(IVec3::new(i % 3, i / 3 % 3, i / 9) - 1));
        let candidates = around.filter_map(|cell| cells.get(&cell)).flatten().copied();
        let near = candidates.filter(|index| points[usize::from(*index)].distance(*point) < radius);
        near.take(MAX_NEIGHBOURS).collect()
    };
    points.par_iter().map(near).collect()
}
