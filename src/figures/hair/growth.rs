//! Grows the hair of a head: guides that follow the comb, and strands between them.

use super::hair_body::HairBody;
use super::in_parallel;
use super::obstacles::{OVER_CLOTHES_M, Obstacles};
use super::roots::{Root, scatter};
use super::style::{Comb, Style};
use super::torso_surface::ShoulderSide;
use crate::figures::random::Random;
use crate::math::{PointSet, atan2, sin_cos_turn};
use crate::scene::{Figure, StrandPoint, Strands};
use glam::{Quat, Vec3, Vec3A};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Least height of hair over the skin, metres.
const CLEARANCE_M: f32 = 0.0006;
/// Number of guides.
const GUIDES: usize = 420;
/// Height over the skull at which the comb holds hair no more, metres.
const HELD_M: f32 = 0.03;
/// Half the width of the face that hair with a parting leaves free, metres; its upper and lower end, from between the
/// eyes; and where the temples are.
const FACE_HALF_WIDTH_M: f32 = 0.064;
const HAIRLINE_M: f32 = 0.075;
const BELOW_JAW_M: f32 = -0.19;
const FACE_FROM_Z: f32 = -0.045;
/// Place of a tie, in half axes of the skull, and its height over the skin, metres.
const TIE: Vec3 = Vec3::new(0.0, 0.15, -1.0);
const TIE_HEIGHT_M: f32 = 0.018;
/// Radius of the tie, metres.
const TIE_RADIUS_M: f32 = 0.011;
/// Part of a tied strand at which it is drawn together with its neighbours, by the tie.
const TIED_AT: f32 = 0.4;
/// Scatter of the directions in which guides leave the tie, radians.
const TAIL_SPREAD: f32 = 0.17;
/// How much tied strands still lie in locks at their ends, 0 to 1.
const LOCKS_OF_TAIL: f32 = 0.3;
/// Scatter of the place from which a strand beside a parting takes its way, metres.
const CROSSING_M: f32 = 0.006;
/// Height over the hairline from which that scatter is whole, metres: strands that cross the parting at the hairline would
/// lie across the forehead.
const CROSSING_FROM_M: f32 = 0.03;
/// Scatter of the lengths of guides, as a part.
const LENGTH_SCATTER: f32 = 0.08;
/// Scatter of the level at which hair is cut, metres.
const CUT_SCATTER_M: f32 = 0.004;
/// Length of a strand that moves along with a point which keeps clear of an obstacle, to each side, metres.
const MOVED_WITH_M: f32 = 0.1;
/// Least displacement of such a point, metres: less bends no strand.
const FAR_MOVE_M: f32 = 0.002;
/// How often the bends of a loose guide are rounded, and of a tied one, which turns at its tie.
const ROUNDINGS: usize = 6;
const TIED_ROUNDINGS: usize = 3;
/// How many times farther from the head a guide may reach than those whose roots are within this distance, metres, do on
/// average.
const MAX_TUFT: f32 = 1.08;
const TUFT_AROUND_M: f32 = 0.04;
/// Segments of a guide.
const STEPS: usize = 24;
/// Segments of a strand: of a turn of its curls, at most, and the longest without curls, metres.
const SEGMENTS_OF_A_TURN: f32 = 14.0;
const MAX_SEGMENTS: f32 = 32.0;
const LONGEST_SEGMENT_M: f32 = 0.025;
/// Longest step in which a guide grows, metres: longer ones would leave the curve of the head.
const LONGEST_STEP_M: f32 = 0.006;

/// Grows the strands of a style, in groups.
pub fn grow_head(body: &HairBody, figure: &Figure, style: &Style) -> Vec<Strands> {
    let roots = scatter(body, style.strands, figure.seed, &|place| style.root_density(place));
    let obstacles = Obstacles::new(body, &roots, matches!(style.comb, Comb::FromParting(_)) && !style.is_short());
    let down = body.head.inverse().transform_vector3(Vec3::NEG_Y).normalize_or(Vec3::NEG_Y);
    let field = CombField { style, obstacles: &obstacles, down };
    let every = (roots.len() / GUIDES).max(1);
    let guide = |(index, root): (usize, &Root)| {
        Guide::new(*root, field.grow(root, Random::new(figure.seed, 100 + index as u32)))
    };
    let mut guides: Vec<Guide> = roots.par_iter().step_by(every).enumerate().map(guide).collect();
    // Other combs lay hair on the head, where shorter guides among longer ones would bend strands at a corner
    if style.comb == Comb::Out {
        trim_tufts(&mut guides, &obstacles);
    }
    let guides = GuidesBySide::new(guides, style);
    let steps = steps_of(style);
    let strand = |index: usize, root: &Root| {
        let random = Random::new(figure.seed, 100_000 + index as u32);
        let points = follow(root, &guides, &steps, &field, random);
        points.into_iter().map(|(p, radius_m)| StrandPoint { position: body.head.transform_point3(p), radius_m })
    };
    in_parallel(&roots, strand)
}

/// A strand that others follow, in the head's frame.
struct Guide {
    root: Root,
    points: Vec<Vec3A>,
    /// Unit vectors across each segment, perpendicular to each other: they bend with the guide and do not turn about it.
    across: Vec<[Vec3; 2]>,
}

impl Guide {
    fn new(root: Root, points: Vec<Vec3>) -> Guide {
        let mut axis = root.normal;
        let across = |ends: &[Vec3]| {
            let tangent = (ends[1] - ends[0]).normalize_or(Vec3::NEG_Y);
            axis = axis.reject_from_normalized(tangent).normalize_or(tangent.any_orthonormal_vector());
            [axis, tangent.cross(axis)]
        };
        let across = points.windows(2).map(across).collect();
        Guide { root, points: points.into_iter().map(Vec3A::from).collect(), across }
    }
}

/// Guides by the side of the parting to which they are combed: right and left. Without a parting all are at the left.
struct GuidesBySide([(Vec<Guide>, PointSet); 2]);

impl GuidesBySide {
    fn new(guides: Vec<Guide>, style: &Style) -> GuidesBySide {
        let is_left = |guide: &Guide| style.side_of_parting(guide.root.position.x) > 0.0;
        let (left, right): (Vec<Guide>, Vec<Guide>) = guides.into_iter().partition(is_left);
        GuidesBySide([right, left].map(|guides| {
            let roots = PointSet::new(guides.iter().map(|guide| guide.root.position));
            (guides, roots)
        }))
    }

    /// Returns the guides of a side and their roots; those of the other one where it has none.
    fn on_side(&self, side: f32) -> (&[Guide], &PointSet) {
        let [right, left] = &self.0;
        let (wanted, other) = if side > 0.0 { (left, right) } else { (right, left) };
        let (guides, roots) = if wanted.0.is_empty() { other } else { wanted };
        (guides, roots)
    }
}

/// Shortens guides that reach more than [`MAX_TUFT`] times as far from the head as those around them do on average: a
/// lock that stands out alone is a tuft.
fn trim_tufts(guides: &mut [Guide], obstacles: &Obstacles) {
    let reach =
        |guide: &Guide| guide.points.iter().map(|p| obstacles.height_over_head((*p).into())).fold(0.0, f32::max);
    let reaches: Vec<f32> = guides.par_iter().map(reach).collect();
    let mean_around = |guide: &Guide| {
        let is_near = |other: &Guide| other.root.position.distance(guide.root.position) < TUFT_AROUND_M;
        let near = guides.iter().zip(&reaches).filter(|(other, _)| is_near(other));
        let (sum, count) = near.fold((0.0, 0.0), |(sum, count), (_, reach)| (sum + reach, count + 1.0));
        sum / count
    };
    let means: Vec<f32> = guides.par_iter().map(mean_around).collect();
    for (guide, (reach, mean)) in guides.iter_mut().zip(reaches.into_iter().zip(means)) {
        let (root, part) = (Vec3A::from(guide.root.position), MAX_TUFT * mean / reach);
        if part < 1.0 {
            guide.points.iter_mut().for_each(|p| *p = root.lerp(*p, part));
        }
    }
}

/// The directions in which the hair of a style grows.
struct CombField<'a> {
    style: &'a Style,
    obstacles: &'a Obstacles,
    /// Direction of gravity in the head's frame.
    down: Vec3,
}

impl CombField<'_> {
    /// Grows a guide in equal steps.
    fn grow(&self, root: &Root, mut random: Random) -> Vec<Vec3> {
        // A lock that is much longer than its neighbours stands out
        let length = self.length(root) * (1.0 + LENGTH_SCATTER * random.bell().min(1.0));
        let jitter = Vec3::new(random.bell(), random.bell(), random.bell());
        if self.style.comb == Comb::ToTie { self.tied(root, length, jitter) } else { self.loose(root, length, jitter) }
    }

    /// Grows a guide along the head to the tie, and from there as a tail.
    fn tied(&self, root: &Root, length: f32, jitter: Vec3) -> Vec<Vec3> {
        let (centre, step) = (self.obstacles.skull_centre(), length / STEPS as f32);
        let tie = self.obstacles.above_head(centre + self.obstacles.skull_radii() * TIE, TIE_HEIGHT_M);
        let start = (root.position - centre).normalize_or(Vec3::Y);
        // Hair keeps its order in the tie: that from above lies on top
        let tie = tie + start.with_z(0.0) * TIE_RADIUS_M;
        let end = (tie - centre).normalize_or(Vec3::NEG_Z);
        let turn = Quat::from_rotation_arc(start, end);
        let to_tie_m = start.angle_between(end) * root.position.distance(centre);
        let mut direction = (Vec3::NEG_Z + jitter * TAIL_SPREAD).normalize_or(Vec3::NEG_Z);
        let mut position = tie;
        let point = |k: usize| {
            let along_m = k as f32 * step;
            if along_m < to_tie_m {
                let t = along_m / to_tie_m;
                let ray = Quat::IDENTITY.slerp(turn, t) * start;
                // Hair lies close, and rises to the tie
                let height =
                    self.style.volume_m * (t * 8.0).min(1.0) + (TIE_HEIGHT_M - self.style.volume_m) * t * t * t;
                return self.obstacles.above_head(centre + ray * 0.01, height);
            }
            direction = (direction + self.down * self.style.weight).normalize_or(self.down);
            let from_tie = direction * step.min(along_m - to_tie_m);
            position = self.obstacles.pushed_out(position + from_tie, 0.0, ShoulderSide::Back);
            position
        };
        rounded(std::iter::once(root.position).chain((1..=STEPS).map(point)).collect(), TIED_ROUNDINGS)
    }

    /// Grows a guide that follows comb and gravity.
    fn loose(&self, root: &Root, length: f32, jitter: Vec3) -> Vec<Vec3> {
        let style = self.style;
        let steps_per_segment = (length / STEPS as f32 / LONGEST_STEP_M).ceil().max(1.0) as usize;
        let steps = STEPS * steps_per_segment;
        let step = length / steps as f32;
        let jitter = jitter * style.frizz;
        let side = self.shoulder_side(root);
        let mut direction =
            (root.normal * style.lift + self.comb(root.position, root, root.normal) * (1.0 - style.lift) + jitter)
                .normalize();
        let mut position = root.position;
        let mut points = vec![position];
        for k in 0..steps {
            let along = k as f32 / steps as f32;
            let outwards = (position - self.obstacles.skull_centre()).normalize_or(Vec3::Y);
            // The comb holds what lies on the head; below, hair falls.
            let held = 1.0 - self.obstacles.height_over_head(position) / HELD_M;
            let grip = style.grip * held.clamp(0.0, 1.0);
            let pull = self.comb(position, root, outwards) * grip + self.down * style.weight * (0.25 + along);
            direction = (direction + pull).normalize_or(self.down);
            // Hair lies on the hair below it: the volume builds up over the first centimetres.
            let margin = style.volume_m * (along * length / 0.03).min(1.0);
            let next = self.beside_face(position + direction * step, root);
            let next = self.obstacles.pushed_out(next, margin, side);
            direction = (next - position).normalize_or(direction);
            position += direction * step;
            if (k + 1) % steps_per_segment == 0 {
                points.push(position);
            }
        }
        rounded(points, ROUNDINGS)
    }

    /// Returns the side of the shoulders on which hair from a root falls: before the ears over the chest.
    fn shoulder_side(&self, root: &Root) -> ShoulderSide {
        let is_front = self.style.comb != Comb::ToTie && root.position.z > self.obstacles.skull_centre().z;
        if is_front { ShoulderSide::Front } else { ShoulderSide::Back }
    }

    /// Returns a point of hair with a parting moved aside from the face, to the side where its root is combed.
    fn beside_face(&self, p: Vec3, root: &Root) -> Vec3 {
        let Comb::FromParting(left) = self.style.comb else { return p };
        let side = self.style.side_of_parting(root.position.x);
        // From the parting at the hairline to the temples, over the height of a forehead, and as far as the jaw
        let widening = ((HAIRLINE_M - p.y) / 0.05).min((p.y - BELOW_JAW_M) / 0.08).clamp(0.0, 1.0);
        let edge = left + (FACE_HALF_WIDTH_M * side - left) * widening;
        let is_before_face = p.z > FACE_FROM_Z && (p.x - edge) * side < 0.0;
        // Above the hairline strands may cross the parting, or they would all lie on one line there
        let moved = (4.0 * widening).min(1.0);
        if is_before_face { p.with_x(p.x + (edge - p.x) * moved) } else { p }
    }

    /// Returns the length of the hair at a root: between that of the sides and that of the top.
    fn length(&self, root: &Root) -> f32 {
        let [top, side] = self.style.length_m;
        // From the temples, 3.5 cm over the eyes, to the front of the crown
        let height = ((root.place.y - 0.035) / 0.06).clamp(0.0, 1.0);
        side + (top - side) * height * height * (3.0 - 2.0 * height)
    }

    /// Returns the direction of the comb at a point of the hair from a root, along the head.
    fn comb(&self, p: Vec3, root: &Root, outwards: Vec3) -> Vec3 {
        let centre = self.obstacles.skull_centre();
        let radii = self.obstacles.skull_radii();
        let whorl = centre + radii * Vec3::new(-0.15, 0.85, -0.55);
        let wanted = match self.style.comb {
            Comb::FromWhorl => (p - whorl).normalize_or(Vec3::NEG_Z) + self.down * 0.35,
            Comb::FromParting(_) => {
                let side = self.style.side_of_parting(root.position.x);
                // On top hair is combed aside, at the forehead back as well; at the sides it hangs down.
                let top = outwards.dot(-self.down).clamp(0.0, 1.0);
                let front = ((p.z - centre.z) / radii.z).clamp(0.0, 1.0);
                Vec3::new(side * (0.3 + top), 0.0, -0.1 - 0.7 * front) + self.down * (1.1 - top)
            }
            Comb::Out | Comb::ToTie => {
                // At the whorl hair parts, or it would stand up as a tuft.
                let aside = (p - whorl).with_y(0.0).normalize_or(Vec3::NEG_Z);
                outwards + aside * (0.6 * outwards.dot(-self.down).max(0.0)) + self.down * 0.2
            }
        };
        let lift = wanted.dot(outwards);
        match self.style.comb {
            Comb::Out | Comb::ToTie => wanted.normalize_or(outwards),
            Comb::FromWhorl => (wanted - outwards * lift.min(0.0)).normalize_or(self.down),
            Comb::FromParting(_) => (wanted - outwards * lift).normalize_or(self.down),
        }
    }
}

/// Returns the points of a guide with its bends rounded: where it meets an obstacle it turns at once, and hair does not.
fn rounded(mut points: Vec<Vec3>, times: usize) -> Vec<Vec3> {
    for _ in 0..times {
        let mut before = points[1];
        for k in 2..points.len() - 1 {
            let mean = (before + points[k] * 2.0 + points[k + 1]) * 0.25;
            before = std::mem::replace(&mut points[k], mean);
        }
    }
    points
}

/// A point of the strands of a style, the same on each.
#[derive(Clone, Copy, Debug)]
struct StrandStep {
    /// Part of the length, from the root.
    along: f32,
    /// Weight of the first guide against the mean of all near ones, 0 to 1.
    gather: f32,
}

/// Returns the points of every strand of a style: as many as its length and its curls need.
fn steps_of(style: &Style) -> Vec<StrandStep> {
    let length = style.length_m[0].max(style.length_m[1]);
    let turns = length * style.turns_per_m * SEGMENTS_OF_A_TURN;
    let segments = (length / LONGEST_SEGMENT_M).max(turns).ceil().clamp(4.0, MAX_SEGMENTS) as usize;
    // Close to the skin, which is convex, points are denser: a chord would lead through the skin. Curls need them all
    // along
    let bunching = if turns > MAX_SEGMENTS { 1.0 } else { 1.5 };
    let step = |k: usize| {
        let along = (k as f32 / segments as f32).powf(bunching);
        let gather = match style.comb {
            Comb::ToTie => {
                (along / TIED_AT).min(1.0) - (1.0 - LOCKS_OF_TAIL) * ((along - TIED_AT) / (1.0 - TIED_AT)).max(0.0)
            }
            _ => style.clumping * along.powf(0.7),
        };
        StrandStep { along, gather }
    };
    (0..=segments).map(step).collect()
}

/// Returns the points of a strand that follows the guides near its root, with its radius there.
fn follow(
    root: &Root,
    guides: &GuidesBySide,
    steps: &[StrandStep],
    field: &CombField,
    mut random: Random,
) -> Vec<(Vec3, f32)> {
    let style = field.style;
    // Beside a parting some strands cross to the other side, and hide the skin between both
    let over_hairline = ((root.place.y - HAIRLINE_M) / CROSSING_FROM_M).clamp(0.0, 1.0);
    let crossing = CROSSING_M * over_hairline * style.nearness_to_parting(root.position.x) * random.bell();
    let beside = root.position + Vec3::X * crossing;
    // Guides on the other side of a parting, or of the shoulders, are no neighbours: they go another way.
    let (guides, guide_roots) = guides.on_side(style.side_of_parting(beside.x));
    let near = guide_roots.nearest::<3>(beside);
    let first = &guides[near[0].1];
    let point = |guide: &Guide, step: usize| Vec3::from(guide.points[step]);
    let reach = |guide: &Guide, step: usize| point(guide, step) - guide.root.position;
    let goes_along = |guide: &Guide| {
        let is_near = |step| reach(guide, step).dot(reach(first, step)) > 0.5 * reach(first, step).length_squared();
        is_near(STEPS / 2) && point(guide, STEPS).distance(point(first, STEPS)) < 0.5 * reach(first, STEPS).length()
    };
    let weights: Vec<(f32, &Guide)> = near
        .iter()
        .map(|&(distance, index)| (1.0 / (distance + 1e-6), &guides[index]))
        .filter(|(_, guide)| goes_along(guide))
        .collect();
    let sum: f32 = weights.iter().map(|(w, _)| w).sum();
    let shorter = 1.0 - random.unit() * (0.25 * random.unit() + style.layering);
    // Curls turn with their guide; waves turn together with those of neighbours, and further round the head
    let of_curl = random.unit() * (1.0 - style.clumping) + (near[0].1 as f32 / TAU).fract();
    let Vec3 { x, z, .. } = first.root.position - field.obstacles.skull_centre();
    let of_wave = atan2(x.abs(), z) / TAU;
    let phase = of_curl * style.phase_scatter + of_wave * (1.0 - style.phase_scatter);
    let spread = Vec3::new(random.bell(), random.bell(), random.bell()) * style.frizz * 0.05 * style.length_m[0];
    let [position, offset, spread] = [root.position, root.position - first.root.position, spread].map(Vec3A::from);
    let side = field.shoulder_side(&first.root);
    let mut points = Vec::with_capacity(steps.len());
    for &StrandStep { along, gather } in steps {
        let at = along * shorter * STEPS as f32;
        let (low, t) = ((at as usize).min(STEPS - 1), at - (at as usize).min(STEPS - 1) as f32);
        // The mean shape of the guides, from this root, drawn towards the first guide
        let shape = |guide: &Guide| guide.points[low].lerp(guide.points[low + 1], t) - Vec3A::from(guide.root.position);
        let mean = weights.iter().map(|(w, guide)| shape(guide) * *w).sum::<Vec3A>() / sum;
        let p = position + mean.lerp(shape(first), gather) - offset * gather * 0.8 + spread * along;
        let mut p = Vec3::from(p);
        if style.curl_m > 0.0 {
            let length = at / STEPS as f32 * style.length_m[0];
            let turns = style.turns_per_m * length + phase;
            let (sin, cos) = sin_cos_turn(turns - turns as u32 as f32);
            let [axis, other] = first.across[low];
            p += (axis * cos + other * sin) * style.curl_m * (along * 4.0).min(1.0);
        }
        points.push((p, style.radius_m * (1.0 - 0.7 * along * along)));
    }
    // A guide's shape from another root may lead into the skin or the clothes, or before the face
    let outside = |points: &mut [Vec3]| {
        field.obstacles.move_above_head(points, CLEARANCE_M);
        for p in points {
            let beside = field.beside_face(*p, &first.root);
            if beside != *p {
                *p = field.obstacles.above_head(beside, CLEARANCE_M);
            }
        }
    };
    if move_smoothly(&mut points, &outside) {
        let mut positions: Vec<Vec3> = points[1..].iter().map(|(p, _)| *p).collect();
        outside(&mut positions);
        points[1..].iter_mut().zip(positions).for_each(|((p, _), q)| *p = field.beside_face(q, &first.root));
    }
    move_smoothly(&mut points, &|points: &mut [Vec3]| {
        points.iter_mut().for_each(|p| *p = field.obstacles.over_torso(*p, OVER_CLOTHES_M, side));
    });
    cut(&mut points, field.down, style.cut_m + CUT_SCATTER_M * random.bell());
    points
}

/// Moves the points of a strand behind its root to where `move_out` puts them. Where that is far, those before and behind
/// move along, less with the distance: the strand keeps clear of an obstacle in a curve and not in a step. Returns true
/// if there is such a place.
fn move_smoothly(points: &mut [(Vec3, f32)], move_out: &dyn Fn(&mut [Vec3])) -> bool {
    let mut wanted: Vec<Vec3> = points.iter().map(|(p, _)| *p).collect();
    move_out(&mut wanted);
    wanted.iter_mut().zip(&*points).for_each(|(offset, (p, _))| *offset -= *p);
    let squared = |k: usize| wanted.get(k).map_or(0.0, |offset| offset.length_squared());
    let is_peak = |k: usize| squared(k) > FAR_MOVE_M * FAR_MOVE_M && squared(k) >= squared(k - 1).max(squared(k + 1));
    let peaks: Vec<usize> = (1..wanted.len()).filter(|&k| is_peak(k)).collect();
    if peaks.is_empty() {
        points.iter_mut().zip(&wanted).skip(1).for_each(|((p, _), offset)| *p += *offset);
        return false;
    }
    let mut from_root = vec![0.0];
    for ends in points.windows(2) {
        from_root.push(from_root[from_root.len() - 1] + ends[0].0.distance(ends[1].0));
    }
    for (k, (p, _)) in points.iter_mut().enumerate().skip(1) {
        let along = |&peak: &usize| {
            let reach = if peak > k { MOVED_WITH_M.min(from_root[peak]) } else { MOVED_WITH_M };
            let t = (1.0 - (from_root[k] - from_root[peak]).abs() / reach).max(0.0);
            wanted[peak] * (t * t * (3.0 - 2.0 * t))
        };
        let offsets = peaks.iter().map(along);
        *p += offsets.fold(wanted[k], |a, b| if b.length_squared() > a.length_squared() { b } else { a });
    }
    true
}

/// Ends a strand at the point where it falls below a level, metres under the eyes along `down`.
fn cut(points: &mut Vec<(Vec3, f32)>, down: Vec3, level_m: f32) {
    let Some(end) = points.iter().position(|(p, _)| p.dot(down) > level_m).filter(|&end| end > 0) else { return };
    let [(a, radius_a), (b, radius_b)] = [points[end - 1], points[end]];
    let t = (level_m - a.dot(down)) / (b - a).dot(down);
    points.truncate(end);
    points.push((a.lerp(b, t), radius_a + (radius_b - radius_a) * t));
}
