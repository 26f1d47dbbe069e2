//! Which light a point asks: by an estimate of what each gives there, from a tree when there are many.
//!
//! A node is a handful of packets of eight entries; an entry is a light, or stands for a cluster of lights with a node
//! of its own. An entry is chosen in proportion to its estimate, and so on down (Conty Estevez and Kulla 2018,
//! "Importance Sampling of Many Lights with Adaptive Tree Splitting", without the splitting). Estimates are bounded from
//! below wherever a light may give something, so that each such light has a chance.

use super::{LEAST_BEAM, Source, TracedLight};
use crate::math::safe_sqrt;
use crate::raytrace::simd::{self, KernelTask, Kernels, LANES};
use glam::Vec3;
use std::f32::consts::PI;

/// Entries of a node: so many lights are asked one by one.
const NODE: usize = 8 * LANES;

/// Spread of a light that shines the same all round: a cosine plus this is never under 1.
const ALL_ROUND: f32 = 2.0;

/// Eight lights or clusters. Positions are relative to the camera.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
struct Packet {
    centre: [[f32; LANES]; 3],
    /// 1; 0 for a sun, whose `centre` is a direction.
    near: [f32; LANES],
    /// Radius of a ball that holds all of it.
    radius: [f32; LANES],
    /// Intensity on the axis times exposure time; 0 where a lane is not used.
    power: [f32; LANES],
    /// Unit direction in which it shines.
    axis: [[f32; LANES]; 3],
    /// Added to the cosine against the axis: how far members' axes differ from it.
    spread: [f32; LANES],
    /// How far members lie before or behind the centre, metres.
    depth: [f32; LANES],
    /// Cosine at which the beam ends, and one over the difference to that at which it is full.
    beam_end: [f32; LANES],
    beam_gain: [f32; LANES],
}

/// One lane of a packet, before it is one.
#[derive(Clone, Copy, Debug)]
struct Entry {
    centre: Vec3,
    near: f32,
    radius: f32,
    power: f32,
    axis: Vec3,
    spread: f32,
    depth: f32,
    beam_end: f32,
    beam_gain: f32,
}

impl Entry {
    /// None for what is not sampled.
    fn of(light: &TracedLight) -> Option<Self> {
        let entry = |centre: Vec3, radius: f32, intensity: f32| Entry {
            centre,
            near: 1.0,
            radius,
            power: intensity * light.time_s,
            axis: Vec3::Z,
            spread: ALL_ROUND,
            depth: 0.0,
            beam_end: 0.0,
            beam_gain: 1.0,
        };
        let panel = |centre, radius, intensity, axis| Entry { axis, spread: 0.0, ..entry(centre, radius, intensity) };
        Some(match light.source {
            Source::Point { position, intensity } => entry(position, 0.0, intensity),
            Source::Spot { position, axis, intensity, inner_deg, outer_deg } => {
                let half_cos = |full_deg: f32| (0.5 * full_deg.to_radians()).cos();
                // Slightly wider than it is: rounding must not leave the rim without a chance.
                let (full, end) = (half_cos(inner_deg.min(outer_deg)), half_cos(outer_deg) - 1e-4);
                let gain = 1.0 / (full - end).max(1e-6);
                Entry { axis, spread: 0.0, beam_end: end, beam_gain: gain, ..entry(position, 0.0, intensity) }
            }
            Source::Rect { rect, luminance } => panel(rect.centre, rect.reach, luminance * rect.area(), rect.normal()),
            Source::Disc { disc, luminance } => panel(disc.centre, disc.radius, luminance * disc.area(), disc.normal()),
            Source::Ball { ball, luminance } => {
                entry(ball.centre, ball.radius, luminance * PI * ball.radius * ball.radius)
            }
            Source::Sun { towards, illuminance, one_minus_cos } => {
                let slack = safe_sqrt(2.0 * one_minus_cos);
                Entry { near: 0.0, ..entry(towards, slack, illuminance) }
            }
            Source::Surround { .. } => return None,
        })
    }

    /// One entry for several, all of them suns or none.
    fn cluster(leaves: &[Leaf]) -> Self {
        let members = || leaves.iter().map(|leaf| leaf.0);
        let power: f32 = members().map(|m| m.power).sum();
        let (low, high) = members()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), m| (low.min(m.centre), high.max(m.centre)));
        let centre = (low + high) * 0.5;
        let radius = members().map(|m| (m.centre - centre).length() + m.radius).fold(0.0, f32::max) * (1.0 + 1e-5);
        let axis = members().map(|m| m.axis * m.power).sum::<Vec3>().normalize_or(Vec3::Z);
        // A cosine against another axis differs by at most the distance between the axes.
        let spread = members().map(|m| m.spread + (m.axis - axis).length()).fold(0.0, f32::max);
        let spread = (spread * (1.0 + 1e-5)).min(ALL_ROUND);
        let near = leaves.first().map_or(1.0, |leaf| leaf.0.near);
        Entry { centre, near, radius, power, axis, spread, depth: radius, beam_end: 0.0, beam_gain: 1.0 }
    }
}

impl Packet {
    fn set(&mut self, lane: usize, entry: &Entry) {
        for axis in 0..3 {
            self.centre[axis][lane] = entry.centre[axis];
            self.axis[axis][lane] = entry.axis[axis];
        }
        self.near[lane] = entry.near;
        self.radius[lane] = entry.radius;
        self.power[lane] = entry.power;
        self.spread[lane] = entry.spread;
        self.depth[lane] = entry.depth;
        self.beam_end[lane] = entry.beam_end;
        self.beam_gain[lane] = entry.beam_gain;
    }

    /// What each lane gives at a point, up to a constant: power, inverse square and both cosines, each bounded so that
    /// no part of it that reaches over a horizon is forgotten. 0 where it certainly gives nothing on the side of
    /// `normal`.
    #[inline(always)]
    fn estimates(&self, point: Vec3, normal: Vec3) -> [f32; LANES] {
        let mut estimates = [0.0; LANES];
        // A plain loop: closures would not be compiled for wide vectors.
        for (i, lane) in estimates.iter_mut().enumerate() {
            let x = self.centre[0][i] - point.x * self.near[i];
            let y = self.centre[1][i] - point.y * self.near[i];
            let z = self.centre[2][i] - point.z * self.near[i];
            let height = normal.x * x + normal.y * y + normal.z * z;
            let before = -(self.axis[0][i] * x + self.axis[1][i] * y + self.axis[2][i] * z);
            let radius = self.radius[i];
            let distance2 = larger(x * x + y * y + z * z, radius * radius);
            let inverse = 1.0 / larger(distance2, f32::MIN_POSITIVE).sqrt();
            // In units of the distance: a light in the middle of which the point lies is before it and behind.
            let cos = before * inverse + (self.spread[i] + self.depth[i] * inverse);
            let beam = (cos - self.beam_end[i]) * self.beam_gain[i];
            let given = self.power[i] * inverse * inverse;
            let estimate = given * smaller(larger(height * inverse, 0.05), 1.0) * smaller(larger(beam, 0.02), 1.0);
            *lane = if height > -radius && beam > 0.0 { estimate } else { 0.0 };
        }
        estimates
    }
}

/// Unlike `f32::max` this is one instruction, and no NaN comes here that matters: it makes the total no number.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// See [`larger`].
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// What an entry stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Meaning {
    Light(u32),
    Node(u32),
}

/// A run of packets, and where the node hangs: in which node, at which of its entries.
#[derive(Clone, Copy, Debug)]
struct Node {
    first_packet: u32,
    packets: u32,
    parent: Option<(u32, u32)>,
}

/// All lights that are sampled, ready to be chosen from.
#[derive(Clone, Debug, Default)]
pub struct LightSampler {
    packets: Vec<Packet>,
    /// By packet and lane.
    meanings: Vec<Meaning>,
    nodes: Vec<Node>,
    /// Node and entry of each light; none for those that are not sampled.
    places: Vec<Option<(u32, u32)>>,
    /// Lights with a beam, whose estimates are cut by it.
    has_beams: bool,
}

/// A light with its entry, while the tree is built.
type Leaf = (Entry, u32);

impl LightSampler {
    /// Over a scene's lights, in their order.
    pub fn new(lights: &[TracedLight]) -> Self {
        let mut leaves: Vec<Leaf> =
            lights.iter().zip(0..).filter_map(|(light, i)| Some((Entry::of(light)?, i))).collect();
        let has_beams = lights.iter().any(|light| light.beam.is_some());
        let mut light_sampler = LightSampler { places: vec![None; lights.len()], has_beams, ..LightSampler::default() };
        if !leaves.is_empty() {
            light_sampler.add_node(&mut leaves, None);
        }
        light_sampler
    }

    /// Adds a node over these lights and all below it.
    fn add_node(&mut self, leaves: &mut [Leaf], parent: Option<(u32, u32)>) -> u32 {
        // A sun is everywhere, and shares no cluster with what is somewhere.
        leaves.sort_by(|a, b| a.0.near.total_cmp(&b.0.near));
        let (suns, near) = leaves.split_at_mut(leaves.partition_point(|leaf| leaf.0.near == 0.0));
        let mut groups = Vec::with_capacity(NODE);
        split(suns, if near.is_empty() { NODE } else { NODE / 2 }, &mut groups);
        split(near, NODE - groups.len(), &mut groups);
        let (index, first) = (self.nodes.len() as u32, self.packets.len());
        let packets = groups.len().div_ceil(LANES);
        self.nodes.push(Node { first_packet: first as u32, packets: packets as u32, parent });
        self.packets.resize(first + packets, Packet::default());
        self.meanings.resize((first + packets) * LANES, Meaning::Node(0));
        for (at, mut group) in groups.into_iter().enumerate() {
            let place = (index, at as u32);
            let (entry, meaning) = if let [(entry, light)] = group[..] {
                self.places[light as usize] = Some(place);
                (entry, Meaning::Light(light))
            } else {
                (Entry::cluster(&group), Meaning::Node(self.add_node(&mut group, Some(place))))
            };
            self.packets[first + at / LANES].set(at % LANES, &entry);
            self.meanings[first * LANES + at] = meaning;
        }
        index
    }

    /// Nodes on the longest way to a light.
    #[cfg(test)]
    pub fn depth(&self) -> usize {
        let above =
            |node: &Node| std::iter::successors(Some(*node), |n| Some(self.nodes[n.parent?.0 as usize])).count();
        self.nodes.iter().map(above).max().unwrap_or(0)
    }

    /// What a node's entries give at a point.
    #[inline]
    fn estimates(&self, lights: &[TracedLight], node: &Node, point: Vec3, normal: Vec3) -> Estimates {
        let first = node.first_packet as usize;
        let packets = &self.packets[first..first + node.packets as usize];
        let mut estimates = Estimates::NOTHING;
        simd::dispatch(Ask { packets, point, normal, estimates: &mut estimates });
        if self.has_beams {
            let lanes = estimates.lanes.as_flattened_mut().iter_mut();
            for (lane, meaning) in lanes.zip(&self.meanings[first * LANES..]).take(packets.len() * LANES) {
                if let (true, Meaning::Light(light)) = (*lane > 0.0, *meaning) {
                    *lane *= lights[light as usize].beam_towards(point).max(LEAST_BEAM);
                }
            }
            estimates.add_up();
        }
        estimates
    }

    /// What the topmost entries give at a point on a surface with this normal: asked once, it serves several choices.
    pub fn importances(&self, lights: &[TracedLight], point: Vec3, normal: Vec3) -> Option<LightImportances<'_>> {
        let node = self.nodes.first()?;
        Some(LightImportances {
            light_sampler: self,
            point,
            normal,
            estimates: self.estimates(lights, node, point, normal),
        })
    }

    /// The chance that [`LightImportances::sample`] gives a light.
    pub fn pmf(&self, lights: &[TracedLight], light: u32, point: Vec3, normal: Vec3) -> f32 {
        let mut chance = 1.0;
        let mut place = self.places[light as usize];
        if place.is_none() {
            return 0.0;
        }
        while let Some((node, at)) = place {
            let node = &self.nodes[node as usize];
            let estimates = self.estimates(lights, node, point, normal);
            if !estimates.are_usable() {
                return 0.0;
            }
            chance *= estimates.lanes.as_flattened()[at as usize] / estimates.total;
            place = node.parent;
        }
        chance
    }
}

/// Halves a set of lights along its longest side until there are `groups` of about the same size.
fn split(leaves: &mut [Leaf], groups: usize, found: &mut Vec<Vec<Leaf>>) {
    if groups <= 1 || leaves.len() <= 1 {
        if !leaves.is_empty() {
            found.push(leaves.to_vec());
        }
        return;
    }
    let (low, high) = leaves
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (e, _)| (low.min(e.centre), high.max(e.centre)));
    let size = high - low;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    leaves.sort_by(|a, b| a.0.centre[axis].total_cmp(&b.0.centre[axis]));
    let middle = leaves.len() / 2;
    let (lower, upper) = leaves.split_at_mut(middle);
    split(lower, groups / 2, found);
    split(upper, groups - groups / 2, found);
}

/// What the entries of a node give.
#[derive(Clone, Copy, Debug)]
struct Estimates {
    lanes: [[f32; LANES]; NODE / LANES],
    /// Of each packet.
    sums: [f32; NODE / LANES],
    total: f32,
}

impl Estimates {
    const NOTHING: Estimates = Estimates { lanes: [[0.0; LANES]; NODE / LANES], sums: [0.0; NODE / LANES], total: 0.0 };

    #[inline(always)]
    fn add_up(&mut self) {
        for (sum, lanes) in self.sums.iter_mut().zip(&self.lanes) {
            *sum = lanes.iter().sum();
        }
        self.total = self.sums.iter().sum();
    }

    /// Whether there is something to choose from.
    fn are_usable(&self) -> bool {
        self.total > 0.0 && self.total.is_finite()
    }

    /// The entry at a part `u` in 0..1 of the total, what it gives, and the part of the way through it.
    fn entry_at(&self, u: f32) -> Option<(usize, f32, f32)> {
        let (packet, _, left) = run_at(&self.sums, u * self.total)?;
        let (lane, estimate, left) = run_at(&self.lanes[packet], left)?;
        Some((packet * LANES + lane, estimate, left / estimate))
    }
}

/// Which of some lengths, laid end to end, a place falls on, its length, and how far into it; the last that has a length
/// where rounding leads beyond.
#[inline]
fn run_at(lengths: &[f32], mut place: f32) -> Option<(usize, f32, f32)> {
    let mut found = None;
    for (index, &length) in lengths.iter().enumerate().filter(|(_, length)| **length > 0.0) {
        found = Some((index, length, place.min(length)));
        if place < length {
            break;
        }
        place -= length;
    }
    found
}

/// Lights that were asked what they give at a point.
#[derive(Clone, Copy, Debug)]
pub struct LightImportances<'a> {
    light_sampler: &'a LightSampler,
    point: Vec3,
    normal: Vec3,
    estimates: Estimates,
}

impl LightImportances<'_> {
    /// A light, by a number in 0..1, and the chance it had. None where no light gives anything.
    pub fn sample(&self, lights: &[TracedLight], u: f32) -> Option<(u32, f32)> {
        let LightImportances { light_sampler, point, normal, .. } = *self;
        let (mut node, mut u, mut chance) = (light_sampler.nodes.first()?, u, 1.0);
        let mut below;
        let mut estimates = &self.estimates;
        loop {
            if !estimates.are_usable() {
                return None;
            }
            let (at, estimate, into) = estimates.entry_at(u)?;
            chance *= estimate / estimates.total;
            match light_sampler.meanings[node.first_packet as usize * LANES + at] {
                Meaning::Light(light) => return Some((light, chance)),
                Meaning::Node(next) => {
                    // What is left of the number is as good as a new one.
                    u = into.clamp(0.0, 1.0 - f32::EPSILON);
                    node = &light_sampler.nodes[next as usize];
                    below = light_sampler.estimates(lights, node, point, normal);
                    estimates = &below;
                }
            }
        }
    }
}

/// See [`LightSampler::estimates`].
struct Ask<'a> {
    packets: &'a [Packet],
    point: Vec3,
    normal: Vec3,
    /// Nothing before.
    estimates: &'a mut Estimates,
}

impl KernelTask for Ask<'_> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        for (packet, lanes) in self.packets.iter().zip(&mut self.estimates.lanes) {
            *lanes = packet.estimates(self.point, self.normal);
        }
        self.estimates.add_up();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::statistics::Numbers;
    use crate::raytrace::lights::tests::crowd;
    use crate::raytrace::simd::Scalar;

    /// Lanes, sums and total, to the bit.
    fn bits(estimates: &Estimates) -> Vec<u32> {
        let Estimates { lanes, sums, total } = estimates;
        lanes.as_flattened().iter().chain(sums).chain([total]).map(|value| value.to_bits()).collect()
    }

    #[test]
    fn both_sets_of_instructions_estimate_the_same() {
        let mut numbers = Numbers::new(21);
        let lights = crowd(700, &mut numbers);
        let light_sampler = LightSampler::new(&lights);
        assert!(light_sampler.nodes.len() > 1, "clusters are asked, too");
        // Among the lights, right on them, and so far away that squares overflow.
        let mut points: Vec<Vec3> = (0..300).map(|_| numbers.direction() * numbers.between(0.0, 6.0)).collect();
        points.extend(lights.iter().step_by(9).filter_map(TracedLight::centre));
        points.extend((0..20).map(|_| numbers.direction() * 1e25));
        let (mut given, mut denied) = (0, 0);
        for point in points {
            let normal = numbers.direction();
            for node in &light_sampler.nodes {
                let first = node.first_packet as usize;
                let packets = &light_sampler.packets[first..first + node.packets as usize];
                let (mut ours, mut plain) = (Estimates::NOTHING, Estimates::NOTHING);
                simd::dispatch(Ask { packets, point, normal, estimates: &mut ours });
                Ask { packets, point, normal, estimates: &mut plain }.run::<Scalar>();
                assert_eq!(bits(&ours), bits(&plain), "from {point}, facing {normal}");
                let lanes = &ours.lanes.as_flattened()[..packets.len() * LANES];
                given += lanes.iter().filter(|lane| **lane > 0.0).count();
                denied += lanes.iter().filter(|lane| **lane == 0.0).count();
            }
        }
        assert!(given.min(denied) > 10_000, "{given} lanes give something, {denied} nothing: the test says little");
    }
}
