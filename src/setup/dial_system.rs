//! Linear equations for the powers of lights.

use super::transport::LightTransport;
use crate::math::{BoundedUnknown, LinearEquation, bounded_least_squares};

/// Weight of the equation that keeps a light at its present power.
const KEEP_WEIGHT: f64 = 1e-2;
/// Greatest excess over a bound that the solver looks at, times the bound.
const MOST_EXCESS: f64 = 1e6;

/// How an exposure compares with the wanted one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// Equal to it.
    Equal,
    /// Not less.
    AtLeast,
    /// Not more.
    AtMost,
}

/// Lights whose powers keep their ratios.
#[derive(Clone, Debug)]
pub struct Group {
    /// Indices of the lights.
    pub members: Vec<usize>,
    /// Powers relative to the strongest.
    pub ratios: Vec<f32>,
    /// Least power of the strongest with which all are within the range of their dials; its own least where there is none.
    least: f32,
    /// Power of the strongest in the studio, 1 for full power.
    present: f32,
    /// It stays as it is where no equation says otherwise.
    is_kept: bool,
}

impl Group {
    /// Returns the group of some of the lights.
    pub fn new(lights: &[LightTransport], is_kept: bool, members: Vec<usize>) -> Self {
        let power = |index: &usize| lights[*index].dial_stops.exp2();
        let present = members.iter().map(power).fold(0.0, f32::max);
        let ratios: Vec<f32> = members.iter().map(|index| power(index) / present).collect();
        let lowest = |index: &usize| lights[*index].dial.lowest_stops.exp2();
        let of_all = members.iter().zip(&ratios).map(|(index, ratio)| lowest(index) / ratio).fold(0.0, f32::max);
        let strongest =
            members.iter().zip(&ratios).find(|(_, ratio)| **ratio == 1.0).map_or(0.0, |(index, _)| lowest(index));
        Group { least: if of_all < 1.0 { of_all } else { strongest }, ratios, present, is_kept, members }
    }
}

/// The equations for the powers of groups of lights.
#[derive(Debug)]
pub struct System<'a> {
    groups: &'a [&'a Group],
    lights: &'a [LightTransport],
    /// The powers of the strongest light of each group, then slack variables of bounds.
    unknowns: Vec<BoundedUnknown>,
    equations: Vec<LinearEquation>,
}

impl<'a> System<'a> {
    /// Returns the system without wishes.
    pub fn new(groups: &'a [&'a Group], lights: &'a [LightTransport]) -> Self {
        let energy = |group: &&Group| -> f32 {
            group.members.iter().zip(&group.ratios).map(|(index, ratio)| lights[*index].energy_lm_s * ratio).sum()
        };
        let most_energy = groups.iter().map(energy).fold(f32::MIN_POSITIVE, f32::max);
        let unknown = |group: &&Group| {
            let cost = if group.is_kept { 0.0 } else { energy(group) / most_energy };
            let initial = f64::from(group.present);
            BoundedUnknown { least: group.least.into(), most: 1.0, initial, cost: cost.into() }
        };
        let unknowns: Vec<BoundedUnknown> = groups.iter().map(unknown).collect();
        let mut equations = Vec::new();
        for (position, group) in groups.iter().enumerate().filter(|(_, group)| group.is_kept) {
            let mut coefficients = vec![0.0; groups.len()];
            coefficients[position] = KEEP_WEIGHT / f64::from(group.present);
            equations.push(LinearEquation { coefficients, value: KEEP_WEIGHT });
        }
        System { groups, lights, unknowns, equations }
    }

    /// Adds the equation of a place, relative to the wanted exposure. `lux_s` holds what each light gives at its present
    /// dial, `constant_lux_s` the sum of what is not to be solved for.
    pub fn add(&mut self, lux_s: &[f32], constant_lux_s: f32, wanted_lux_s: f32, relation: Relation, weight: f32) {
        let at_full = |index: usize| lux_s[index] / self.lights[index].dial_stops.exp2();
        let of_group = |group: &&Group| {
            let members = group.members.iter().zip(&group.ratios);
            f64::from(weight / wanted_lux_s * members.map(|(index, ratio)| at_full(*index) * ratio).sum::<f32>())
        };
        let mut coefficients: Vec<f64> = self.groups.iter().map(of_group).collect();
        coefficients.resize(self.unknowns.len(), 0.0);
        if relation != Relation::Equal {
            self.unknowns.push(BoundedUnknown { least: 0.0, most: MOST_EXCESS, initial: 0.0, cost: 0.0 });
            coefficients.push(if relation == Relation::AtLeast { -1.0 } else { 1.0 });
        }
        let value = f64::from(weight) * f64::from(1.0 - constant_lux_s / wanted_lux_s);
        self.equations.push(LinearEquation { coefficients, value });
    }

    /// Returns the powers of the strongest light of each group.
    pub fn solve(mut self) -> Vec<f64> {
        for equation in &mut self.equations {
            equation.coefficients.resize(self.unknowns.len(), 0.0);
        }
        let mut powers = bounded_least_squares(&self.unknowns, &self.equations);
        powers.truncate(self.groups.len());
        powers
    }
}
