//! Facts of a light on a sheet, and its row in the table of lights.

use super::lengths::Units;
use crate::photo::meter::nearest_third;
use crate::photo::text::{signed_stops, three_digits};
use crate::photo::{LightBearing, light_dial_text};
use crate::raytrace::RenderControl;
use crate::scene::{
    ColorSource, Emitter, Gel, Light, Modifier, ModifierKind, ModifierShape, NamedModifier, Output, Role,
};
use crate::setup::{LightExposure, MeteredAt, MeteredSetup};
use glam::Vec3;

/// Angle up from which a light is overhead, degrees.
const STEEP_DEG: f32 = 80.0;

/// Headings of [`LightFacts::cells`].
pub const COLUMNS: [&str; 7] = ["Light", "Modifier and head", "Dial", "Distance", "Height", "Direction", "Meter"];

/// Most lights that are metered where they hit or aim, rather than at the subject.
const MOST_METERED: usize = 64;

/// A cell of the table of lights: a line, and a smaller one under it.
pub type Cell = [String; 2];

/// The facts of a light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightFacts {
    /// Units of lengths.
    units: Units,
    /// Its number in the plan, from 1.
    pub number: usize,
    /// Its name.
    pub name: String,
    /// Its role.
    pub role: Role,
    /// Switched on.
    pub is_on: bool,
    /// Modifier with its accessories: `Softbox 60 x 90, 40° grid`.
    pub modifier: String,
    /// The head and its colour: `Flash 400 Ws, 5500 K, 1/2 CTO`.
    pub head: String,
    /// Dial, as the head displays it: `1/4`.
    pub dial_text: String,
    /// Dial, stops from full power.
    pub dial_stops: f32,
    /// Output at this dial: `100 Ws`.
    pub dialled: String,
    /// Its bearing from the subject; none for a surround. The distance of a sun means nothing.
    pub bearing: Option<LightBearing>,
    /// Distance to what it aims at, metres, if that is not the subject.
    pub aim_m: Option<f32>,
    /// Height of the middle of its front, metres; none for sun and surround.
    pub height_m: Option<f32>,
    /// The place at which it is metered.
    pub metered_at: MeteredAt,
    /// Its exposure there; none if no light of it arrives.
    pub exposure: Option<LightExposure>,
    /// Its exposure over that of the key, stops.
    pub stops_over_key: Option<f32>,
}

impl LightFacts {
    /// Returns the facts of a light.
    pub fn new(setup: &MeteredSetup<'_>, number: usize, light: &Light, units: Units, control: &RenderControl) -> Self {
        let scene = setup.scene;
        // Each of the others takes a reading of its own
        let metered_at = if number <= MOST_METERED { setup.metered_at(light) } else { MeteredAt::Subject };
        let elsewhere = metered_at == MeteredAt::Aim;
        let subject = setup.subject.position;
        let bearing = match light.emitter {
            Emitter::Surround => None,
            // A sun shines along its aim, at any distance
            Emitter::Sun { .. } => {
                let aim = scene.aim_vector(&light.aim, light.position).normalize_or(Vec3::NEG_Y);
                Some(LightBearing::new(scene, subject - aim, subject))
            }
            _ => Some(LightBearing::new(scene, light.position, subject)),
        };
        LightFacts {
            units,
            number,
            name: light.name.clone(),
            role: light.role,
            is_on: light.on,
            modifier: modifier_text(light, units),
            head: head_text(light, units),
            dial_text: light_dial_text(light, light.power.dial_stops),
            dial_stops: light.power.dial_stops,
            dialled: output_text(&light.power.output, light.power.dial_stops, units),
            bearing,
            aim_m: setup.aim_of(light).filter(|_| elsewhere).map(|aim| (aim - light.position).length()),
            height_m: (!light.emitter.is_infinite()).then_some(light.position.y),
            metered_at,
            exposure: setup.exposure(light, metered_at, control),
            stops_over_key: None,
        }
    }

    /// Compares the lights with the key: the strongest key light, else the strongest of those metered at the subject,
    /// else of all.
    pub fn compare_with_key(lights: &mut [LightFacts]) {
        let strongest = |is_candidate: &dyn Fn(&LightFacts) -> bool| {
            let exposures = lights.iter().filter(|facts| is_candidate(facts)).filter_map(|facts| facts.exposure);
            exposures.max_by(|a, b| a.lux_s.total_cmp(&b.lux_s))
        };
        let key = strongest(&|facts| facts.role == Role::Key && facts.metered_at == MeteredAt::Subject)
            .or_else(|| strongest(&|facts| facts.metered_at == MeteredAt::Subject))
            .or_else(|| strongest(&|_| true));
        for facts in lights {
            facts.stops_over_key = facts.exposure.zip(key).map(|(exposure, key)| exposure.stops_over(&key));
        }
    }

    /// Returns a cell for each of [`COLUMNS`].
    pub fn cells(&self) -> [Cell; 7] {
        let units = self.units;
        let cell = |line: String, small: &str| [line, small.to_owned()];
        let none = || cell("\u{2013}".to_owned(), "");
        let off = if self.is_on { "" } else { ", off" };
        let distance = match (self.height_m, &self.bearing, self.aim_m) {
            (Some(_), _, Some(aim_m)) => cell(units.distance(aim_m), "straight to its aim"),
            (Some(_), Some(place), None) if self.metered_at != MeteredAt::Aim => {
                cell(units.distance(place.distance_m), "straight to subject")
            }
            _ => none(),
        };
        let direction = |place: &LightBearing| {
            let up = format!(
                "{:.0}\u{b0} {}",
                place.elevation_deg.abs(),
                if place.elevation_deg < 0.0 { "down" } else { "up" }
            );
            [round_text(place), up]
        };
        let at = match self.metered_at {
            MeteredAt::Subject => "at subject",
            MeteredAt::Rim => "turned to it",
            MeteredAt::Aim => "at its aim",
        };
        let meter = match (&self.exposure, self.is_on) {
            (_, false) => cell("off".to_owned(), ""),
            (None, true) => cell("no light".to_owned(), at),
            (Some(exposure), true) => {
                let against = match (self.stops_over_key, self.metered_at) {
                    (Some(0.0), MeteredAt::Subject) => "the key".to_owned(),
                    (Some(stops), MeteredAt::Subject) => format!("{} to key", signed_stops(stops)),
                    (Some(stops), _) => format!("{}, {at}", signed_stops(stops)),
                    (None, _) => at.to_owned(),
                };
                [nearest_third(exposure.f_number), against]
            }
        };
        [
            [self.name.clone(), format!("{}{off}", self.role.label())],
            [self.modifier.clone(), self.head.clone()],
            [self.dial_text.clone(), format!("{} stops, {}", signed_stops(self.dial_stops), self.dialled)],
            distance,
            self.height_m.map_or_else(none, |height_m| cell(units.distance(height_m), "middle of front")),
            self.bearing.as_ref().map_or_else(none, direction),
            meter,
        ]
    }
}

/// Formats an angle round from the camera: `45° right`. It means nothing straight above or below the subject.
fn round_text(place: &LightBearing) -> String {
    match place.azimuth_deg.round() {
        _ if place.elevation_deg > STEEP_DEG => "overhead".to_owned(),
        _ if place.elevation_deg < -STEEP_DEG => "below".to_owned(),
        0.0 => "at camera".to_owned(),
        angle if angle.abs() == 180.0 => "behind".to_owned(),
        angle => format!("{:.0}\u{b0} {}", angle.abs(), if angle > 0.0 { "right" } else { "left" }),
    }
}

/// Returns the modifier's name if it is one that is sold, else its front with its accessories.
pub fn modifier_text(light: &Light, units: Units) -> String {
    if let Some(path) = &light.photometric_file {
        let name = path.rsplit('/').next().unwrap_or(path);
        return format!("Measured light {name}{}", accessories(&light.modifier).concat());
    }
    match NamedModifier::of(&light.emitter, &light.modifier) {
        Some(named) => named.name.to_owned(),
        None => front_text(light, units) + &accessories(&light.modifier).concat(),
    }
}

fn front_text(light: &Light, units: Units) -> String {
    match light.emitter {
        Emitter::RectPanel { width_m, height_m } => format!("Softbox or panel {}", units.size(&[width_m, height_m])),
        Emitter::RoundPanel { diameter_m } => format!("{} {}", round_name(light), units.size(&[diameter_m])),
        Emitter::Spot { inner_deg, outer_deg } => {
            format!("Reflector, beam {inner_deg:.0}\u{b0} to {outer_deg:.0}\u{b0}")
        }
        Emitter::Sphere { .. } => "Bare bulb".to_owned(),
        Emitter::Point => "Point of light".to_owned(),
        Emitter::Sun { .. } => "Sun".to_owned(),
        Emitter::Surround => "Surround".to_owned(),
    }
}

/// Returns the kind of a round modifier: what the live view puts on the set for it.
fn round_name(light: &Light) -> &'static str {
    match ModifierShape::of(light).map(|shape| shape.kind) {
        Some(ModifierKind::Umbrella) => "Umbrella",
        Some(ModifierKind::ShootThrough) => "Shoot-through umbrella",
        Some(ModifierKind::Dish) => "Dish or reflector",
        Some(_) => "Octa or umbrella",
        None => "Large round panel",
    }
}

/// Returns the accessories before a front, each with a comma before it.
fn accessories(modifier: &Modifier) -> Vec<String> {
    let Modifier { loss_stops: _, scrim_stops, beam, grid_deg, doors } = modifier;
    let texts = [
        beam.map(|beam| format!(", beam {:.0}\u{b0} to {:.0}\u{b0}", beam.inner_deg, beam.outer_deg)),
        grid_deg.map(|angle| format!(", {angle:.0}\u{b0} grid")),
        doors.map(|_| ", barn doors".to_owned()),
        (*scrim_stops > 0.0).then(|| format!(", scrim {scrim_stops:.1} stops")),
    ];
    texts.into_iter().flatten().collect()
}

/// Returns the kind of head with its full power, its colour and its gel.
fn head_text(light: &Light, units: Units) -> String {
    let color = match light.color.source {
        ColorSource::Kelvin(kelvin) => format!("{kelvin:.0} K"),
        ColorSource::Rgb(_) => "coloured".to_owned(),
    };
    let gel = gel_text(&light.color.gel).map(|gel| format!(", {gel}")).unwrap_or_default();
    format!("{}, {color}{gel}", head_name(light, units))
}

/// Returns the name of a light's head, or its kind with its full power where it is not known.
pub fn head_name(light: &Light, units: Units) -> String {
    light.head.as_ref().map_or_else(|| head_kind(&light.power.output, units), |head| head.name.clone())
}

/// Returns a head with its full power: `Flash 400 Ws`.
fn head_kind(output: &Output, units: Units) -> String {
    let kind = if output.is_flash() { "Flash" } else { "Continuous" };
    format!("{kind} {}", output_text(output, 0.0, units))
}

/// Returns the name of a gel, or its strength; none for no gel.
pub fn gel_text(gel: &Gel) -> Option<String> {
    match (gel.name(), gel) {
        (Some(name), _) => Some(name.to_owned()),
        (None, Gel::None) => None,
        (None, Gel::Mired(shift)) => Some(format!("gel {shift:+.0} mired").replace('-', "\u{2212}")),
        (None, Gel::Tint(_)) => Some("colour gel".to_owned()),
    }
}

fn output_text(output: &Output, dial_stops: f32, units: Units) -> String {
    let dialled = dial_stops.exp2();
    match *output {
        Output::FlashWs { energy_ws, .. } => format!("{} Ws", three_digits(energy_ws * dialled)),
        // The guide number is that of a distance: it falls with the root of the energy.
        Output::FlashGuideNumber(number) => {
            let (unit_m, unit) = units.ruler();
            format!("GN {} {unit}", three_digits(number * dialled.sqrt() / unit_m))
        }
        Output::Lumens(flux) => format!("{} lm", three_digits(flux * dialled)),
        Output::Candela(intensity) => format!("{} cd", three_digits(intensity * dialled)),
        Output::LuxAt { lux, distance_m } => {
            format!("{} lx at {}", three_digits(lux * dialled), units.distance(distance_m))
        }
        Output::Lux(lux) => format!("{} lx", three_digits(lux * dialled)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BarnDoors;

    #[test]
    fn modifiers_heads_and_dials_read_as_a_photographer_says_them() {
        let named = NamedModifier::named("Softbox 60 x 90, 40\u{b0} grid").unwrap();
        let mut light = Light::new(named.emitter, Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: 40.0 });
        light.modifier = named.modifier;
        assert_eq!(modifier_text(&light, Units::Metres), named.name);
        light.modifier = Modifier { grid_deg: Some(30.0), doors: Some(BarnDoors::HALF_OPEN), ..Modifier::default() };
        assert_eq!(modifier_text(&light, Units::Feet), "Softbox or panel 24 x 35\", 30\u{b0} grid, barn doors");
        let round = |diameter_m| {
            let light = Light::new(Emitter::RoundPanel { diameter_m }, Output::Lumens(1.0));
            modifier_text(&light, Units::Metres)
        };
        assert_eq!(
            [0.21, 1.5, 1.65, 4.0].map(round),
            ["Dish or reflector 21 cm", "Octa or umbrella 150 cm", "Umbrella 165 cm", "Large round panel 400 cm"]
        );
        light.color.gel = Gel::Mired(109.0);
        assert_eq!(head_text(&light, Units::Metres), "Flash 400 Ws, 5500 K, 1/2 CTO");
        assert_eq!(output_text(&light.power.output, -2.0, Units::Metres), "100 Ws");
        let guide = |units| output_text(&Output::FlashGuideNumber(40.0), -2.0, units);
        assert_eq!([Units::Metres, Units::Feet].map(guide), ["GN 20.0 m", "GN 65.6 ft"]);
        let round =
            |azimuth_deg, elevation_deg| round_text(&LightBearing { distance_m: 1.0, azimuth_deg, elevation_deg });
        assert_eq!([0.2, -45.0, 180.0].map(|angle| round(angle, 30.0)), ["at camera", "45\u{b0} left", "behind"]);
        assert_eq!([88.0, -88.0].map(|up| round(161.0, up)), ["overhead", "below"]);
    }
}
