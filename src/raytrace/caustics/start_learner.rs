//! Learning of the density of starts from the photons that arrive on visible surfaces.

use super::grid::{HashGrid, Positioned};
use super::start_density::{SECTIONS, StartDensity};
use crate::raytrace::render_scene::RenderScene;
use glam::Vec3;
use rayon::prelude::*;

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

/// The centre of a section.
#[derive(Clone, Copy, Debug)]
struct SectionCentre {
    position: Vec3,
    section: u16,
}

impl Positioned for SectionCentre {
    fn position(&self) -> Vec3 {
        self.position
    }
}

/// Returns sections within a radius of the centre of each, [`MAX_NEIGHBOURS`] at most.
fn neighbours(centres: &[Vec3], radius: f32) -> Vec<Vec<u16>> {
    let centres: Vec<SectionCentre> =
        (0..).zip(centres).map(|(section, &position)| SectionCentre { position, section }).collect();
    let grid = HashGrid::new(&centres, radius);
    let near = |centre: &SectionCentre| {
        grid.near(centre.position, radius).map(|(near, _)| near.section).take(MAX_NEIGHBOURS).collect()
    };
    centres.par_iter().map(near).collect()
}
