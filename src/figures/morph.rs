//! The shape of a body: the base mesh with targets weighed by sex, age, ethnicity, muscle, weight and height.
//!
//! MakeHuman's targets lie on a grid of body measures: one for each ethnicity, sex and age, and one for each sex, age,
//! muscle and weight. A body between them gets each target with the product of its linear weights.

use super::body_data::BodyData;
use super::face::{expression_weights, face_weights};
use crate::scene::{Body, Figure};
use glam::Vec3;

/// Ages of the targets, years: their names say baby, child, young and old.
const AGES: [(&str, f32); 4] = [("baby", 1.0), ("child", 10.0), ("young", 25.0), ("old", 90.0)];
const SEXES: [(&str, f32); 2] = [("female", 0.0), ("male", 1.0)];
const MUSCLES: [(&str, f32); 3] = [("minmuscle", 0.0), ("averagemuscle", 0.5), ("maxmuscle", 1.0)];
const WEIGHTS: [(&str, f32); 3] = [("minweight", 0.0), ("averageweight", 0.5), ("maxweight", 1.0)];
/// The targets of height are used up to this strength; a factor on all lengths does the rest.
const MAX_HEIGHT_WEIGHT: f32 = 0.6;

/// Returns the positions of all vertices in the rest pose, metres, floor at height 0.
pub fn rest_positions(data: &BodyData, figure: &Figure) -> Vec<Vec3> {
    // Body measures
    let mut positions = data.positions.clone();
    for (name, weight) in macro_weights(&figure.body) {
        add_target(data, &mut positions, &name, weight);
    }
    // Height: its targets change proportions, a factor does the rest
    let stature = |positions: &[Vec3]| height_range(data, positions);
    let (low, high) = stature(&positions);
    let wanted = figure.body.height_m / (high - low);
    let grows = wanted > 1.0;
    let extreme = if grows { "maxheight" } else { "minheight" };
    let mut tall = positions.clone();
    for (age, sex, weight) in ages_and_sexes(&figure.body) {
        add_target(data, &mut tall, &format!("{sex}-{age}-averagemuscle-averageweight-{extreme}"), weight);
    }
    let (tall_low, tall_high) = stature(&tall);
    let reach = (tall_high - tall_low) / (high - low) - 1.0;
    let strength = if reach.abs() > 1e-4 { ((wanted - 1.0) / reach).clamp(0.0, MAX_HEIGHT_WEIGHT) } else { 0.0 };
    for (position, tall) in positions.iter_mut().zip(&tall) {
        *position = position.lerp(*tall, strength);
    }
    // Face and expression
    for (name, weight) in face_weights(&figure.face).into_iter().chain(expression_weights(&figure.expression)) {
        add_target(data, &mut positions, name, weight);
    }
    let (low, high) = stature(&positions);
    let scale = figure.body.height_m / (high - low).max(0.1);
    positions.iter().map(|p| (*p - Vec3::Y * low) * scale).collect()
}

/// Returns the heights of soles and crown, metres.
fn height_range(data: &BodyData, positions: &[Vec3]) -> (f32, f32) {
    let heights = data.quads("body").iter().flatten().map(|&v| positions[usize::from(v)].y);
    heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)))
}

fn add_target(data: &BodyData, positions: &mut [Vec3], name: &str, weight: f32) {
    if weight == 0.0 {
        return;
    }
    // Targets without offsets are not stored: the base mesh has the mean muscle and weight.
    for &(vertex, offset) in data.targets.get(name).into_iter().flat_map(|target| &target.offsets) {
        positions[usize::from(vertex)] += offset * weight;
    }
}

/// Returns the targets of body measures other than height, with their weights.
fn macro_weights(body: &Body) -> Vec<(String, f32)> {
    let shares = [("african", body.african), ("asian", body.asian), ("caucasian", body.european)];
    let sum: f32 = shares.iter().map(|(_, share)| share).sum();
    let mut weights = Vec::new();
    for (age, sex, weight) in ages_and_sexes(body) {
        for (ethnicity, share) in shares {
            let share = if sum > 0.0 { share / sum } else { 1.0 / 3.0 };
            weights.push((format!("{ethnicity}-{sex}-{age}"), weight * share));
        }
        for (muscle, muscle_weight) in linear_weights(&MUSCLES, body.muscle) {
            for (heaviness, heaviness_weight) in linear_weights(&WEIGHTS, body.weight) {
                let name = format!("universal-{sex}-{age}-{muscle}-{heaviness}");
                weights.push((name, weight * muscle_weight * heaviness_weight));
            }
        }
    }
    weights
}

/// Returns the combinations of age and sex with their weights.
fn ages_and_sexes(body: &Body) -> Vec<(&'static str, &'static str, f32)> {
    let mut combinations = Vec::new();
    for (age, age_weight) in linear_weights(&AGES, body.age_years) {
        for (sex, sex_weight) in linear_weights(&SEXES, body.sex) {
            combinations.push((age, sex, age_weight * sex_weight));
        }
    }
    combinations
}

/// Returns the neighbours of a value among ascending knots, with the weights of linear interpolation.
fn linear_weights(knots: &[(&'static str, f32)], value: f32) -> Vec<(&'static str, f32)> {
    let upper = knots.iter().position(|(_, at)| *at >= value).unwrap_or(knots.len() - 1).max(1);
    let ((low_name, low), (high_name, high)) = (knots[upper - 1], knots[upper]);
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    [(low_name, 1.0 - t), (high_name, t)].into_iter().filter(|(_, weight)| *weight > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_body_measures_sum_to_one() {
        for age_years in [3.0, 6.0, 10.0, 17.0, 34.0, 90.0] {
            let body = Body { sex: 0.3, age_years, african: 0.2, asian: 0.7, ..Body::default() };
            let weights = macro_weights(&body);
            let sum = |prefix: &str| -> f32 {
                weights.iter().filter(|(n, _)| n.starts_with(prefix) == (prefix == "universal")).map(|(_, w)| w).sum()
            };
            assert!((sum("universal") - 1.0).abs() < 1e-6, "{age_years}");
            let ethnic: f32 = weights.iter().filter(|(n, _)| !n.starts_with("universal")).map(|(_, w)| w).sum();
            assert!((ethnic - 1.0).abs() < 1e-6, "{age_years}");
        }
    }

    #[test]
    fn a_body_has_its_height_at_every_age() {
        let data = BodyData::shipped();
        for (age_years, height_m) in [(3.0, 0.95), (6.0, 1.15), (12.0, 1.5), (34.0, 1.6), (34.0, 1.95), (75.0, 1.7)] {
            let figure = Figure { body: Body { age_years, height_m, ..Body::default() }, ..Figure::default() };
            let (low, high) = height_range(data, &rest_positions(data, &figure));
            assert!(low.abs() < 1e-4 && (high - height_m).abs() < 1e-4, "{age_years}: {low} {high}");
        }
    }

    /// Children have large heads: 1/8 of an adult's height, more than 1/7 of a child's of six (Richer 1890).
    #[test]
    fn heads_of_children_are_larger_against_their_height() {
        let data = BodyData::shipped();
        let head_share = |age_years, height_m| {
            let figure = Figure { body: Body { age_years, height_m, ..Body::default() }, ..Figure::default() };
            let positions = rest_positions(data, &figure);
            let neck = data.bones[data.bone("head").unwrap()].head;
            (height_m - positions[usize::from(neck)].y) / height_m
        };
        let (child, adult) = (head_share(6.0, 1.15), head_share(30.0, 1.7));
        assert!(child > 1.25 * adult, "{child} {adult}");
    }
}
