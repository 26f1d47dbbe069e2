//! Dial settings for wanted exposures.
//!
//! Light adds up: the exposure of a place is the sum over the lights of 2^dial times what each gives there at full power.
//! Wishes are linear equations for 2^dial, to be solved within the range of the heads' dials.

use super::dial_system::{Group, Relation, System};
use super::metering::MeteredAt;
use super::transport::{LightTransport, SetupTransport};
use super::wish::{Wish, WishLevel, WishTarget, key_of, named_lights};
use crate::math::mean;
use crate::scene::{HeadDial, LightId, Role, Scene};
use std::collections::HashSet;

/// Largest miss by rounding to a setting, settings.
const TOLERANCE_STEPS: f32 = 0.6;
/// Most rounds in which wishes relative to the key follow it, and the change at which they end, stops.
const MOST_ROUNDS: u32 = 40;
const SETTLED_STOPS: f32 = 1e-4;
/// Part of the exposure of a background from which a light that aims at something else is set for it.
const BACKGROUND_PART: f32 = 0.05;
/// Weight of the exposure of each point of a background; that of its mean is 1.
const EVENNESS_WEIGHT: f32 = 0.1;

/// The dial of a light in a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedDial {
    /// The light.
    pub light: LightId,
    /// Its name.
    pub name: String,
    /// The dial that it has, stops from full power.
    pub from_stops: f32,
    /// It is on in the studio.
    pub was_on: bool,
    /// The dial to set, stops from full power.
    pub to_stops: f32,
}

impl PlannedDial {
    /// Returns true if the light is to be changed.
    pub fn is_change(&self) -> bool {
        !self.was_on || self.to_stops != self.from_stops
    }
}

/// What a wish gets.
#[derive(Clone, Debug, PartialEq)]
pub struct WishOutcome {
    /// The wish.
    pub wish: Wish,
    /// Wanted exposure, lux s: the mean of the points of a background.
    pub wanted_lux_s: f32,
    /// Exposure with the studio's dials.
    pub before_lux_s: f32,
    /// Exposure with the planned dials.
    pub after_lux_s: f32,
    /// Exposure over the wanted one with the planned dials, stops; none if the wish is met. Of a background that is to be
    /// white, at its darkest point.
    pub missed_stops: Option<f32>,
    /// Half of the range over the points of a background with the planned dials, stops; none with a dark point.
    pub evenness_stops: Option<f32>,
    /// Lights of a missed wish that are at an end of their dials.
    pub limits: Vec<String>,
}

impl WishOutcome {
    /// Returns the reason why the wish is not met; none if it is.
    pub fn note(&self) -> Option<String> {
        let missed = self.missed_stops?;
        let side = if missed < 0.0 { "under" } else { "over" };
        let amount = if missed.is_finite() {
            format!("{:.1} stops {side}", missed.abs())
        } else if self.wanted_lux_s.is_finite() {
            "no light of it arrives".to_owned()
        } else {
            "its surface is black".to_owned()
        };
        Some(if self.limits.is_empty() { amount } else { format!("{amount}: {}", self.limits.join(", ")) })
    }
}

/// Dial settings for wishes.
#[derive(Clone, Debug, PartialEq)]
pub struct DialPlan {
    /// The lights that may be set, in the scene's order.
    pub dials: Vec<PlannedDial>,
    /// What each wish gets.
    pub outcomes: Vec<WishOutcome>,
    /// Exposure of the key at the subject with the planned dials, lux s; 0 without a key.
    pub key_lux_s: f32,
    /// Luminous energy of the lights that are on in one exposure, lm s: with the studio's dials and with the planned ones.
    pub energy_lm_s: [f32; 2],
}

impl DialPlan {
    /// Returns the lights that are to be changed.
    pub fn changes(&self) -> impl Iterator<Item = &PlannedDial> {
        self.dials.iter().filter(|dial| dial.is_change())
    }

    /// Sets the dials of a scene, and switches on the lights that wishes name.
    pub fn apply(&self, scene: &mut Scene) {
        for dial in self.changes() {
            if let Some(light) = scene.lights.iter_mut().find(|light| light.id == dial.light) {
                light.power.dial_stops = dial.to_stops;
                (light.on, light.muted) = (true, false);
            }
        }
    }
}

/// Returns the dials that come nearest to the wishes, by least squares of the relative errors; of equally good ones those
/// of least luminous energy.
///
/// Lights that no wish names keep their dials; for a wish about a place, the lights that are metered there and have no
/// wish of their own are set, too. Lights of one wish, and those of the subject, keep their ratios to each other. A wish
/// relative to the key follows what the key gets.
pub fn solve_dials(setup: &SetupTransport, wishes: &[Wish]) -> DialPlan {
    let solver = Solver::new(setup, wishes);
    let mut key_lux_s = solver.key_lux_s(&solver.present());
    for wish in wishes {
        if let (true, WishLevel::FNumber(number)) = (solver.is_about_key(wish), wish.level) {
            key_lux_s = setup.lux_s(number);
        }
    }
    let mut powers = solver.present();
    for _ in 0..MOST_ROUNDS {
        powers = solver.solve(key_lux_s, None);
        let reached = solver.key_lux_s(&powers);
        let change = (reached / key_lux_s).log2();
        if !change.is_finite() || change.abs() < SETTLED_STOPS {
            break;
        }
        // Half way, so that a wish about the sum of key and others converges
        key_lux_s = (key_lux_s * reached).sqrt();
    }
    // Round the key first: the others follow it
    let rounded = solver.rounded(&powers, |group| solver.has_key(group));
    let powers = solver.solve(solver.key_lux_s(&rounded), Some(&rounded));
    solver.plan(&solver.rounded(&powers, |_| true))
}

/// A place of the meter: the exposure that each light gives there at its present dial, that of glowing surfaces, and
/// the wanted one.
struct Place {
    lux_s: Vec<f32>,
    glow_lux_s: f32,
    wanted_lux_s: f32,
}

impl Place {
    /// Returns the mean of places.
    fn mean(places: &[Place]) -> Place {
        let lights = places.first().map_or(0, |place| place.lux_s.len());
        let mean = |value: &dyn Fn(&Place) -> f32| mean(&places.iter().map(value).collect::<Vec<_>>());
        Place {
            lux_s: (0..lights).map(|light| mean(&|place| place.lux_s[light])).collect(),
            glow_lux_s: mean(&|place| place.glow_lux_s),
            wanted_lux_s: mean(&|place| place.wanted_lux_s),
        }
    }
}

/// A studio with wishes for it.
struct Solver<'a> {
    setup: &'a SetupTransport,
    wishes: &'a [Wish],
    /// Lights that a wish about lights names.
    named: HashSet<LightId>,
    /// The lights whose dials may be set, in groups that keep their ratios.
    groups: Vec<Group>,
    /// The light that other wishes are relative to.
    key: Option<LightId>,
}

impl<'a> Solver<'a> {
    fn new(setup: &'a SetupTransport, wishes: &'a [Wish]) -> Self {
        let lights = setup.lights();
        let named = named_lights(wishes);
        let indices = |is_member: &dyn Fn(&LightTransport) -> bool| -> Vec<usize> {
            (0..lights.len()).filter(|index| is_member(&lights[*index])).collect()
        };
        let unnamed = |at: MeteredAt| {
            indices(&|light| light.at == at && light.is_on && light.has_dial && !named.contains(&light.light))
        };
        let has = |target: &WishTarget| wishes.iter().any(|wish| wish.target == *target);
        let mut members = Vec::new();
        for wish in wishes {
            if let WishTarget::Lights(named) = &wish.target {
                members.push(indices(&|light| named.contains(&light.light)));
            }
        }
        if has(&WishTarget::Subject) {
            members.push(unnamed(MeteredAt::Subject));
        }
        if has(&WishTarget::Background) {
            // Each by itself, for an even background
            let lights_it = |index: &usize| {
                let light = &lights[*index];
                light.role == Role::Background
                    || light.mean_background_lux_s() > BACKGROUND_PART * setup.background_lux_s()
            };
            members.extend(unnamed(MeteredAt::Aim).into_iter().filter(lights_it).map(|index| vec![index]));
        } else if has(&WishTarget::Spill) {
            members.push(unnamed(MeteredAt::Aim));
        }
        members.retain(|members| !members.is_empty());
        // A light that only an upper bound concerns is dimmed if need be, and else left alone
        let is_bounded = |members: &[usize]| {
            !has(&WishTarget::Background)
                && members.iter().all(|index| !named.contains(&lights[*index].light))
                && members.iter().all(|index| lights[*index].at == MeteredAt::Aim)
        };
        Solver {
            groups: members.into_iter().map(|members| Group::new(lights, is_bounded(&members), members)).collect(),
            key: key_of(wishes, setup),
            setup,
            wishes,
            named,
        }
    }

    fn is_free(&self, light: usize) -> bool {
        self.groups.iter().any(|group| group.members.contains(&light))
    }

    /// Returns the largest distance of two settings of the dials that may be set, stops.
    fn step_stops(&self) -> f32 {
        let free = self.groups.iter().flat_map(|group| &group.members).map(|index| &self.setup.lights()[*index]);
        let steps = free.map(|light| light.dial.step_stops(light.dial_stops));
        steps.reduce(f32::max).unwrap_or(HeadDial::UNKNOWN.step_stops(0.0))
    }

    fn has_key(&self, group: &Group) -> bool {
        group.members.iter().any(|index| Some(self.setup.lights()[*index].light) == self.key)
    }

    fn is_about_key(&self, wish: &Wish) -> bool {
        matches!((&wish.target, self.key), (WishTarget::Lights(lights), Some(key)) if *lights == [key])
    }

    /// Returns the powers of the lights, 1 for full power: those of the studio, with lights that a wish names on.
    fn present(&self) -> Vec<f32> {
        let power = |light: &LightTransport| {
            let is_on = light.is_on || self.named.contains(&light.light);
            if is_on { light.dial_stops.exp2() } else { 0.0 }
        };
        self.setup.lights().iter().map(power).collect()
    }

    /// Returns the exposure of a place with these powers, lux s.
    fn exposure(&self, lux_s: &[f32], glow_lux_s: f32, powers: &[f32]) -> f32 {
        let lights = self.setup.lights().iter().zip(lux_s).zip(powers);
        glow_lux_s + lights.map(|((light, lux_s), power)| lux_s * power / light.dial_stops.exp2()).sum::<f32>()
    }

    /// Returns the exposure of the key at the subject with these powers, lux s; 0 without a key.
    fn key_lux_s(&self, powers: &[f32]) -> f32 {
        let of_key = |light: &LightTransport| if Some(light.light) == self.key { light.subject_lux_s } else { 0.0 };
        let lux_s: Vec<f32> = self.setup.lights().iter().map(of_key).collect();
        self.exposure(&lux_s, 0.0, powers)
    }

    fn relation(wish: &Wish) -> Relation {
        match (&wish.target, wish.level) {
            (WishTarget::Spill, _) => Relation::AtMost,
            (_, WishLevel::White) => Relation::AtLeast,
            _ => Relation::Equal,
        }
    }

    /// Returns the places at which a wish is metered.
    fn places(&self, wish: &Wish, key_lux_s: f32) -> Vec<Place> {
        let setup = self.setup;
        let each = |lux_s: &dyn Fn(&LightTransport) -> f32| setup.lights().iter().map(lux_s).collect::<Vec<f32>>();
        let wanted_lux_s = match wish.level {
            WishLevel::FNumber(number) => setup.lux_s(number),
            WishLevel::StopsOverKey(stops) => key_lux_s * stops.exp2(),
            // Of each point by itself, below
            WishLevel::White | WishLevel::MiddleGrey => f32::INFINITY,
        };
        match &wish.target {
            WishTarget::Lights(lights) => {
                let own = |light: &LightTransport| if lights.contains(&light.light) { light.own_lux_s } else { 0.0 };
                vec![Place { lux_s: each(&own), glow_lux_s: 0.0, wanted_lux_s }]
            }
            WishTarget::Subject => {
                let lux_s = each(&|light| light.subject_lux_s);
                vec![Place { lux_s, glow_lux_s: setup.glow_subject_lux_s, wanted_lux_s }]
            }
            WishTarget::Spill => {
                let spilled = |light: &LightTransport| match light.at {
                    MeteredAt::Aim => light.subject_lux_s,
                    MeteredAt::Subject | MeteredAt::Rim => 0.0,
                };
                vec![Place { lux_s: each(&spilled), glow_lux_s: 0.0, wanted_lux_s }]
            }
            WishTarget::Background => {
                let tones: Vec<f32> = match wish.level {
                    WishLevel::White => setup.white_lux_s().collect(),
                    WishLevel::MiddleGrey => setup.grey_lux_s().collect(),
                    _ => vec![wanted_lux_s; setup.glow_background_lux_s.len()],
                };
                let place = |(point, wanted_lux_s)| Place {
                    lux_s: each(&|light| light.background_lux_s[point]),
                    glow_lux_s: setup.glow_background_lux_s[point],
                    wanted_lux_s,
                };
                tones.into_iter().enumerate().map(place).collect()
            }
        }
    }

    /// Returns the powers that come nearest to the wishes, with wishes relative to a given exposure of the key. `keys`
    /// holds the powers of all lights if those of the key and its group are settled.
    fn solve(&self, key_lux_s: f32, keys: Option<&[f32]>) -> Vec<f32> {
        let free: Vec<&Group> = self.groups.iter().filter(|group| keys.is_none() || !self.has_key(group)).collect();
        let mut fixed = keys.map_or_else(|| self.present(), <[f32]>::to_vec);
        free.iter().flat_map(|group| &group.members).for_each(|index| fixed[*index] = 0.0);
        let mut system = System::new(&free, self.setup.lights());
        for wish in self.wishes {
            let relation = Self::relation(wish);
            let mut add = |place: &Place, weight: f32| {
                // A lower bound is kept after rounding, too
                let margin = if relation == Relation::AtLeast { (0.5 * self.step_stops()).exp2() } else { 1.0 };
                let wanted_lux_s = place.wanted_lux_s * margin;
                if wanted_lux_s.is_finite() && wanted_lux_s > 0.0 {
                    let constant_lux_s = self.exposure(&place.lux_s, place.glow_lux_s, &fixed);
                    system.add(&place.lux_s, constant_lux_s, wanted_lux_s, relation, weight);
                }
            };
            let places = self.places(wish, key_lux_s);
            if places.len() > 1 && relation == Relation::Equal {
                add(&Place::mean(&places), 1.0);
                places.iter().for_each(|place| add(place, EVENNESS_WEIGHT));
            } else {
                places.iter().for_each(|place| add(place, 1.0));
            }
        }
        let mut powers = fixed;
        for (group, power) in free.iter().zip(system.solve()) {
            for (index, ratio) in group.members.iter().zip(&group.ratios) {
                powers[*index] = power as f32 * ratio;
            }
        }
        powers
    }

    /// Rounds the powers of some groups to steps of their dials.
    fn rounded(&self, powers: &[f32], is_rounded: impl Fn(&Group) -> bool) -> Vec<f32> {
        let mut rounded = powers.to_vec();
        let groups = self.groups.iter().filter(|group| is_rounded(group));
        for index in groups.flat_map(|group| group.members.iter().copied()) {
            rounded[index] = nearest_setting(&self.setup.lights()[index], powers[index].log2()).exp2();
        }
        rounded
    }

    /// Returns the plan with powers that the dials can be set to.
    fn plan(&self, powers: &[f32]) -> DialPlan {
        let free = self.setup.lights().iter().enumerate().filter(|(index, _)| self.is_free(*index));
        let dial = |(index, light): (usize, &LightTransport)| PlannedDial {
            light: light.light,
            name: light.name.clone(),
            from_stops: light.dial_stops,
            was_on: light.is_on,
            to_stops: setting_of(light, powers[index]),
        };
        let on_now = |light: &LightTransport| if light.is_on { light.dial_stops.exp2() } else { 0.0 };
        let before: Vec<f32> = self.setup.lights().iter().map(on_now).collect();
        let energy =
            |powers: &[f32]| self.setup.lights().iter().zip(powers).map(|(l, power)| l.energy_lm_s * power).sum();
        let key_lux_s = self.key_lux_s(powers);
        DialPlan {
            dials: free.map(dial).collect(),
            outcomes: self.wishes.iter().map(|wish| self.outcome(wish, key_lux_s, &before, powers)).collect(),
            key_lux_s,
            energy_lm_s: [energy(&before), energy(powers)],
        }
    }

    /// Compares the exposures before and after with that of a wish.
    fn outcome(&self, wish: &Wish, key_lux_s: f32, before: &[f32], after: &[f32]) -> WishOutcome {
        let places = self.places(wish, key_lux_s);
        let metered = |powers: &[f32]| -> Vec<f32> {
            places.iter().map(|place| self.exposure(&place.lux_s, place.glow_lux_s, powers)).collect()
        };
        let (was, reached) = (metered(before), metered(after));
        let wanted: Vec<f32> = places.iter().map(|place| place.wanted_lux_s).collect();
        let over = || reached.iter().zip(&wanted).map(|(reached, wanted)| (reached / wanted).log2());
        let missed = match Self::relation(wish) {
            Relation::Equal => (mean(&reached) / mean(&wanted)).log2(),
            Relation::AtLeast => over().fold(f32::INFINITY, f32::min).min(0.0),
            Relation::AtMost => over().fold(f32::NEG_INFINITY, f32::max).max(0.0),
        };
        let missed_stops = (missed.is_nan() || missed.abs() > TOLERANCE_STEPS * self.step_stops()).then_some(missed);
        let values = reached.iter().copied();
        let (low, high) = values.fold((f32::INFINITY, 0.0_f32), |(low, high), v| (low.min(v), high.max(v)));
        let limit = |(index, light): (usize, &LightTransport)| {
            let gives = self.is_free(index) && places.iter().any(|place| place.lux_s[index] > 0.0);
            let (stops, lowest) = (after[index].log2(), light.dial.lowest_stops);
            if !gives {
                None
            } else if missed < 0.0 && stops > -0.5 * light.dial.step_stops(0.0) {
                Some(format!("{} is at full power", light.name))
            } else if missed > 0.0 && stops < lowest + 0.5 * light.dial.step_stops(lowest) {
                Some(format!("{} is at its lowest setting", light.name))
            } else {
                None
            }
        };
        let limits = missed_stops.map(|_| self.setup.lights().iter().enumerate().filter_map(limit).collect());
        WishOutcome {
            wish: wish.clone(),
            wanted_lux_s: mean(&wanted),
            before_lux_s: mean(&was),
            after_lux_s: mean(&reached),
            missed_stops,
            evenness_stops: (reached.len() > 1 && low > 0.0).then(|| 0.5 * (high / low).log2()),
            limits: limits.unwrap_or_default(),
        }
    }
}

/// Returns the setting of a dial that has been rounded to a power, stops; the present one to the last digit.
fn setting_of(light: &LightTransport, power: f32) -> f32 {
    let stops = power.log2();
    if (stops - light.dial_stops).abs() < 1e-4 { light.dial_stops } else { light.dial.nearest(stops) }
}

/// Returns the setting of a dial that is nearest to a power, stops; the present setting if that is as near.
fn nearest_setting(light: &LightTransport, stops: f32) -> f32 {
    let present = light.dial_stops;
    let is_in_range = light.dial.lowest_stops - 1e-3 <= present && present <= 1e-3;
    if is_in_range && (present - stops).abs() <= 0.5 * light.dial.step_stops(stops) {
        present
    } else {
        light.dial.nearest(stops)
    }
}
