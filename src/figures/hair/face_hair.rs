//! Brows, lashes and beards.

use super::hair_body::HairBody;
use super::in_parallel;
use super::roots::{Root, scatter};
use super::style::{BROW, Style, beard_density};
use crate::figures::random::Random;
use crate::scene::{Figure, StrandPoint, Strands};
use glam::Vec3;

/// Inner end of a brow, metres from the middle of the face.
const INNER_M: f32 = 0.0105;
/// Highest point of a brow, metres from the middle of the face.
const ARCH_M: f32 = 0.042;
/// Height of the eyes over the chin, where a beard is longest, metres.
const CHIN_M: f32 = 0.11;
/// Hairs of both brows.
const BROW_HAIRS: usize = 1000;
/// Lashes of an upper and of a lower lid. Typical.
const UPPER_LASHES: usize = 180;
const LOWER_LASHES: usize = 60;

/// Grows a beard: down and out of the skin.
pub fn grow_beard(body: &HairBody, figure: &Figure, style: &Style, strands: &mut Strands) {
    let roots = scatter(body, style.strands, figure.seed.wrapping_add(1), &beard_density);
    let hairs = in_parallel(&roots, |index, root| {
        let mut random = Random::new(figure.seed, 300_000 + index as u32);
        let length = beard_length(style, root.place) * (0.7 + 0.5 * random.unit());
        let comb = Vec3::new(0.0, -1.0, 0.15);
        bent(body, root, comb, length, style, &mut random)
    });
    strands.append_all(&hairs);
}

/// Returns the mean length of a beard's hairs at a place of the face, metres: short at the sideburns, so that it lies
/// close to the cheek, and longest at the chin.
fn beard_length(style: &Style, place: Vec3) -> f32 {
    let [chin, sideburn] = style.length_m;
    let down = (-place.y / CHIN_M).clamp(0.0, 1.0);
    sideburn + (chin - sideburn) * down * down
}

/// Grows both brows: from the nose outwards, along the arch.
pub fn grow_brows(body: &HairBody, figure: &Figure, strands: &mut Strands) {
    let roots = scatter(body, BROW_HAIRS, figure.seed.wrapping_add(2), &|place| brow_density(place, figure.body.sex));
    let hairs = in_parallel(&roots, |index, root| {
        let mut random = Random::new(figure.seed, 400_000 + index as u32);
        let outwards = root.place.x.signum();
        // Hairs at the inner end stand up.
        let inner = (1.0 - (root.place.x.abs() - 0.012) / 0.02).clamp(0.0, 1.0);
        let comb = Vec3::new(outwards * (1.0 - 0.6 * inner), 0.25 + 0.7 * inner, -0.2);
        let length = 0.009 * (0.7 + 0.4 * random.unit());
        bent(body, root, comb, length, &BROW, &mut random)
    });
    strands.append_all(&hairs);
}

/// Returns how much brow grows at a place of the face (from between the eyes, metres on the base mesh), 0 to 1, for a
/// `sex` of 0 (woman) to 1 (man). Typical shapes: women's brows rise to an arch, men's are straighter, lower and
/// thicker.
pub fn brow_density(place: Vec3, sex: f32) -> f32 {
    let x = place.x.abs();
    let between = |woman: f32, man: f32| woman + (man - woman) * sex;
    // The arch rises to two thirds of its length and falls to the tail.
    let slope = if x < ARCH_M { between(0.15, 0.11) } else { between(-0.42, -0.34) };
    let middle = between(0.0251, 0.0231) + slope * (x - ARCH_M);
    // It begins thin and sparse beside the nose, is widest under the arch and thins out to the tail
    let inner = ((x - INNER_M) / 0.012).clamp(0.0, 1.0);
    let half = between(0.78, 1.0) * (0.0027 + 0.0015 * inner - 0.0024 * ((x - 0.03) / 0.028).clamp(0.0, 1.0));
    let is_brow = (INNER_M..0.0575).contains(&x) && place.z > -0.03;
    let fade = (0.15 + 1.6 * inner).min(1.0);
    if is_brow { fade * (1.6 * (1.0 - (place.y - middle).abs() / half)).clamp(0.0, 1.0) } else { 0.0 }
}

/// Returns a short hair that leaves the skin and bends towards the comb.
fn bent(body: &HairBody, root: &Root, comb: Vec3, length: f32, style: &Style, random: &mut Random) -> Vec<StrandPoint> {
    const STEPS: usize = 5;
    let along = (comb - root.normal * comb.dot(root.normal)).normalize_or(Vec3::NEG_Y);
    let jitter = Vec3::new(random.bell(), random.bell(), random.bell()) * style.frizz;
    let mut direction = (root.normal * style.lift + along * (1.0 - style.lift) + jitter).normalize_or(along);
    let mut position = root.position;
    let mut points = Vec::with_capacity(STEPS + 1);
    for k in 0..=STEPS {
        let t = k as f32 / STEPS as f32;
        let radius_m = style.radius_m * (1.0 - 0.75 * t);
        points.push(StrandPoint { position: body.head.transform_point3(position), radius_m });
        position += direction * length / STEPS as f32;
        direction = (direction + along * 0.12 + Vec3::NEG_Y * style.weight * 0.3).normalize_or(along);
    }
    points
}

/// Grows the lashes along the edges of the lids, which the body data mark by strips of quads.
pub fn grow_lashes(body: &HairBody, figure: &Figure, strands: &mut Strands) {
    let to_head = body.head.inverse();
    for (side, eye) in ["l", "r"].into_iter().zip(body.eyes) {
        let eye = to_head.transform_point3(eye);
        for (quads, is_upper) in body.data.lash_quads(side).into_iter().zip([false, true]) {
            let point = |v: u16| to_head.transform_point3(body.positions[usize::from(v)]);
            // The lid's edge: the corners of a strip that lie nearest to the eyeball
            let mut rims: Vec<[Vec3; 2]> = quads
                .iter()
                .map(|quad| {
                    let mut corners = quad.map(point);
                    corners.sort_by(|a, b| a.distance(eye).total_cmp(&b.distance(eye)));
                    [corners[0], corners[1]]
                })
                .collect();
            let nearest = rims.iter().map(|[a, _]| a.distance(eye)).fold(f32::INFINITY, f32::min);
            rims.retain(|[a, b]| a.distance(eye).max(b.distance(eye)) < nearest + 0.0022);
            if rims.is_empty() {
                continue;
            }
            let (count, length) = if is_upper { (UPPER_LASHES, 0.0105) } else { (LOWER_LASHES, 0.0055) };
            let mut random = Random::new(figure.seed, 500_000 + u32::from(is_upper) * 2 + u32::from(side == "r"));
            for _ in 0..count {
                let [a, b] = rims[((random.unit() * rims.len() as f32) as usize).min(rims.len() - 1)];
                let root = a.lerp(b, random.unit());
                strands.push(lash(body, root, eye, is_upper, length * (0.75 + 0.4 * random.unit()), &mut random));
            }
        }
    }
}

/// Returns a lash: out of the lid, curved up for the upper and down for the lower lid.
fn lash(body: &HairBody, root: Vec3, eye: Vec3, is_upper: bool, length: f32, random: &mut Random) -> Vec<StrandPoint> {
    const STEPS: usize = 6;
    let up = if is_upper { 1.0 } else { -0.8 };
    let fan = (root.x - eye.x) * 22.0;
    let droop = if is_upper { 0.35 } else { 0.1 };
    let mut direction = Vec3::new(fan + 0.12 * random.bell(), 0.1 * random.bell() - droop, 1.0).normalize_or(Vec3::Z);
    let mut position = root;
    let mut points = Vec::with_capacity(STEPS + 1);
    for k in 0..=STEPS {
        let t = k as f32 / STEPS as f32;
        let radius_m = if is_upper { 70e-6 } else { 32e-6 } * (1.0 - 0.8 * t);
        points.push(StrandPoint { position: body.head.transform_point3(position), radius_m });
        position += direction * length / STEPS as f32;
        direction = (direction + Vec3::Y * up * 0.22).normalize_or(Vec3::Z);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brows_of_women_are_finer_and_more_arched_than_those_of_men() {
        const STEP_M: f32 = 1e-4;
        // Area of a brow, its greatest thickness, and how high its arch lies over its beginning and its tail, metres
        let measured = |sex: f32| {
            let at = |x: f32| {
                let heights = (0..400).map(|k| k as f32 * STEP_M);
                let sums = heights.map(|y| (brow_density(Vec3::new(x, y, 0.0), sex), y));
                let (width, moment) = sums.fold((0.0, 0.0), |(w, m), (d, y)| (w + d * STEP_M, m + d * y * STEP_M));
                (width, moment / width)
            };
            let columns: Vec<(f32, f32)> = (115..570).map(|k| at(k as f32 * STEP_M)).collect();
            let area: f32 = columns.iter().map(|(width, _)| width * STEP_M).sum();
            let widest = columns.iter().map(|(width, _)| *width).fold(0.0, f32::max);
            let arch = at(ARCH_M).1;
            [area, widest, arch - at(0.012).1, arch - at(0.056).1]
        };
        let ([woman_area, woman_widest, woman_rise, woman_fall], [man_area, man_widest, man_rise, man_fall]) =
            (measured(0.0), measured(1.0));
        assert!(woman_area < 0.85 * man_area && woman_widest < 0.85 * man_widest, "{woman_area} {man_area} m2");
        assert!((0.003..0.006).contains(&man_rise) && man_rise < woman_rise && woman_rise < 0.006, "{woman_rise} m");
        assert!((0.003..0.008).contains(&man_fall) && man_fall < woman_fall && woman_fall < 0.008, "{woman_fall} m");
        assert!((0.004..0.009).contains(&man_widest), "{man_widest} m");
    }

    #[test]
    fn the_edge_of_a_beard_has_no_step_on_the_cheek() {
        // Height of the upper edge, where the beard begins to grow
        let edge = |x: f32| {
            let heights = (0..900).map(|k| 0.01 - k as f32 * 1e-4);
            heights.clone().find(|y| beard_density(Vec3::new(x, *y, 0.0)) > 0.0).unwrap()
        };
        let edges: Vec<f32> = (30..70).map(|k| edge(k as f32 * 1e-3)).collect();
        let steepest = edges.windows(2).map(|e| (e[1] - e[0]).abs()).fold(0.0, f32::max);
        assert!(steepest < 0.005, "{steepest} m a millimetre");
        assert!(edges[0] < -0.035 && edges[39] > 0.0, "{edges:?}");
    }
}
