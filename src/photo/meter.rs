//! The arithmetic of an incident light meter (ISO 2720): from the illuminance of each light to f-number, EV and ratios.
//!
//! Continuous light is read in lux, flash in lux seconds. Their luminous exposures add up, E t + H in lux s, and give
//! the f-number: N^2 = (E t + H) S / C. For a total in lux, a flash counts as the continuous light of the same exposure
//! at the camera's shutter, H / t, so that `lux x shutter = lux s`.

use super::thirds::Dial;
use super::{exposure, nd_filter};
pub use crate::scene::Receptor;
use crate::scene::{LightId, Role, Scene};

/// Lux per foot-candle (lumen per square foot).
pub const LUX_PER_FOOT_CANDLE: f32 = 10.763_91;
/// Metres in a foot.
pub const FOOT_M: f32 = 0.3048;

impl Receptor {
    /// Returns the response to light relative to its normal illuminance, by the cosine between the light's direction
    /// and the receptor's axis.
    pub fn response(self, cos: f32) -> f32 {
        match self {
            Receptor::Flat => cos.max(0.0),
            Receptor::Dome => (0.5 * (1.0 + cos)).max(0.0),
        }
    }

    /// Returns its label.
    pub fn label(self) -> &'static str {
        match self {
            Receptor::Flat => "flat",
            Receptor::Dome => "dome",
        }
    }
}

/// The reading of one light: lux for continuous light, lux seconds for flash.
#[derive(Clone, Debug, PartialEq)]
pub struct LightReading {
    /// The light; none for the sum of all emissive surfaces.
    pub light: Option<LightId>,
    /// Name of the light.
    pub name: String,
    /// Role in the set-up.
    pub role: Option<Role>,
    /// True for flash: the numbers are lux seconds.
    pub flash: bool,
    /// Direct light, with shadows.
    pub direct: f32,
    /// Indirect light by any surface, mirrors and glass included.
    pub bounced: f32,
    /// Standard error of `direct + bounced`, in the same unit.
    pub standard_error: f32,
}

impl LightReading {
    /// Returns direct plus bounced light.
    pub fn sum(&self) -> f32 {
        self.direct + self.bounced
    }
}

/// A reading of the meter at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Every light that is on, in scene order; emissive surfaces last, if there are any.
    pub lights: Vec<LightReading>,
    /// The camera's shutter, seconds.
    pub shutter_s: f32,
    /// The camera's ISO speed.
    pub iso: f32,
    /// Meter constant C, lux seconds.
    pub meter_constant: f32,
    /// ND filter of the camera, stops.
    pub nd_stops: f32,
    /// Light that the camera's lens loses by near focus (bellows factor), stops.
    pub bellows_stops: f32,
}

/// A lighting ratio between groups of lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Name of the ratio: `key:fill`.
    pub name: &'static str,
    /// The ratio to 1.
    pub value: f32,
}

impl Ratio {
    /// Returns the ratio in stops.
    pub fn stops(&self) -> f32 {
        self.value.log2()
    }
}

impl Reading {
    /// Creates a reading for the settings of a scene's camera.
    pub fn new(lights: Vec<LightReading>, scene: &Scene) -> Self {
        let camera = &scene.camera;
        Reading {
            lights,
            shutter_s: camera.shutter_s,
            iso: camera.iso,
            meter_constant: camera.meter_constant,
            nd_stops: camera.nd_stops,
            bellows_stops: exposure::bellows_stops(&scene.focused_lens()),
        }
    }

    /// Returns the luminous exposure that may be missing where no light was found, lux s: three standard errors.
    pub fn missed_lux_s(&self) -> f32 {
        3.0 * self.lights.iter().map(|light| light.standard_error * self.time_s(light)).sum::<f32>()
    }

    /// Returns the time by which a light counts in the exposure, seconds.
    fn time_s(&self, light: &LightReading) -> f32 {
        if light.flash { 1.0 } else { self.shutter_s }
    }

    /// Returns the luminous exposure of a light, lux s.
    pub fn lux_s(&self, light: &LightReading) -> f32 {
        light.sum() * self.time_s(light)
    }

    /// Returns the standard error of the luminous exposure of a light, lux s.
    pub fn error_lux_s(&self, light: &LightReading) -> f32 {
        light.standard_error * self.time_s(light)
    }

    /// Converts a quantity of a light (lux, or lux s for flash) to continuous light at the camera's shutter, lux.
    pub fn as_lux(&self, light: &LightReading, quantity: f32) -> f32 {
        if light.flash { quantity / self.shutter_s } else { quantity }
    }

    /// Returns the luminous exposure of all lights, E t + H, lux s.
    pub fn total_lux_s(&self) -> f32 {
        total(self.lights.iter().map(|light| self.lux_s(light)))
    }

    /// Returns direct and bounced light of all lights as continuous light at the camera's shutter, lux.
    pub fn total_lux(&self) -> (f32, f32) {
        self.lights.iter().fold((0.0, 0.0), |(direct, bounced), light| {
            (direct + self.as_lux(light, light.direct), bounced + self.as_lux(light, light.bounced))
        })
    }

    /// Returns EV at ISO 100; minus infinity without light.
    pub fn ev100(&self) -> f32 {
        exposure::ev100(self.total_lux_s() / self.shutter_s, self.meter_constant)
    }

    /// Returns the f-number to set at the camera's ISO and shutter; 0 without light. ND filter and bellows factor are
    /// compensated, as in a meter with filter compensation.
    pub fn f_number(&self) -> f32 {
        let on_sensor = self.total_lux_s() * (-self.nd_stops - self.bellows_stops).exp2();
        exposure::f_number(on_sensor, self.iso, self.meter_constant)
    }

    /// Returns what the f-number is compensated for: `, ND 3 stops (ND8, 0.9), bellows factor 2.0 stops`; empty where
    /// there is nothing.
    pub fn compensation(&self) -> String {
        let nd = if self.nd_stops > 0.0 { format!(", ND {}", nd_filter::label(self.nd_stops)) } else { String::new() };
        if self.bellows_stops > 0.0 { format!("{nd}, bellows factor {:.2} stops", self.bellows_stops) } else { nd }
    }

    /// Returns the reference light of ratios: the strongest of the key lights, or of all where none has that role.
    pub fn key(&self) -> Option<&LightReading> {
        let strongest = |lights: &mut dyn Iterator<Item = &'_ LightReading>| {
            lights
                .map(|light| (light.light, self.lux_s(light)))
                .filter(|(_, lux_s)| *lux_s > 0.0)
                .max_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(id, _)| id)
        };
        let of_role = strongest(&mut self.lights.iter().filter(|l| l.role == Some(Role::Key)));
        let id = of_role.or_else(|| strongest(&mut self.lights.iter()))?;
        self.lights.iter().find(|light| light.light == id)
    }

    /// Returns a light's exposure over the key's, stops; none without light.
    pub fn stops_over_key(&self, light: &LightReading) -> Option<f32> {
        let stops = (self.lux_s(light) / self.lux_s(self.key()?)).log2();
        stops.is_finite().then_some(stops)
    }

    /// Returns the fraction of the exposure that comes from flash, 0 to 1; none without light.
    pub fn flash_fraction(&self) -> Option<f32> {
        let total_lux_s = self.total_lux_s();
        let flash = total(self.lights.iter().filter(|l| l.flash).map(|l| self.lux_s(l)));
        (total_lux_s > 0.0).then(|| flash / total_lux_s)
    }

    /// Returns the relative standard error of the total exposure; none without light.
    pub fn relative_error(&self) -> Option<f32> {
        let total = self.total_lux_s();
        let square: f32 = self.lights.iter().map(|l| (l.standard_error * self.time_s(l)).powi(2)).sum();
        (total > 0.0).then(|| square.sqrt() / total)
    }

    fn lux_s_of(&self, role: Role) -> f32 {
        total(self.lights.iter().filter(|l| l.role == Some(role)).map(|l| self.lux_s(l)))
    }

    /// Returns the key:fill and (key+fill):fill ratios; none without light from both roles.
    pub fn ratios(&self) -> Option<[Ratio; 2]> {
        let (key, fill) = (self.lux_s_of(Role::Key), self.lux_s_of(Role::Fill));
        (key > 0.0 && fill > 0.0).then(|| {
            [
                Ratio { name: "key:fill", value: key / fill },
                Ratio { name: "(key+fill):fill", value: (key + fill) / fill },
            ]
        })
    }
}

/// Formats an f-number as the nominal label of its nearest third, such as `f/5.6`; those under 0.05, which would
/// read `f/0.0`, as `below f/0.1`.
pub fn nearest_third(f_number: f32) -> String {
    if f_number < 0.05 {
        return "below f/0.1".to_owned();
    }
    let thirds = (f_number > 0.0).then(|| Dial::FNumber.thirds(f_number).round() as i32);
    match thirds.and_then(|thirds| Dial::FNumber.nominal_label(thirds)) {
        Some(label) => format!("f/{label}"),
        None => format!("f/{f_number:.1}"),
    }
}

/// Returns the sum; +0 for no values, where the standard library returns -0, which would be printed.
fn total(values: impl Iterator<Item = f32>) -> f32 {
    values.fold(0.0, |sum, value| sum + value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(id: u32, role: Role, flash: bool, direct: f32) -> LightReading {
        let light = Some(LightId(id));
        let name = format!("{role:?} {id}");
        LightReading { light, name, role: Some(role), flash, direct, bounced: 0.0, standard_error: 0.0 }
    }

    fn reading(lights: Vec<LightReading>) -> Reading {
        Reading::new(lights, &Scene::default())
    }

    #[test]
    fn exposures_of_flash_and_continuous_light_add_up() {
        // light_and_camera.md: f/8 is 160 lux s of flash at ISO 100; 10 000 lx at 1/125 s are 80 more.
        let both = reading(vec![light(0, Role::Key, true, 160.0), light(1, Role::Fill, false, 10_000.0)]);
        assert!((both.total_lux_s() - 240.0).abs() < 1e-3);
        assert!((both.f_number() - (240.0_f32 * 100.0 / 250.0).sqrt()).abs() < 1e-4);
        assert!((both.flash_fraction().unwrap() - 160.0 / 240.0).abs() < 1e-6);
        let no_flash = Reading { lights: vec![light(1, Role::Key, false, 10_000.0)], ..both.clone() };
        assert!(
            no_flash.flash_fraction().is_some_and(|fraction| fraction == 0.0 && fraction.is_sign_positive()),
            "-0 is printed"
        );
        // The flash as continuous light at this shutter: 160 x 125 lx.
        assert!((both.total_lux().0 / 30_000.0 - 1.0).abs() < 1e-6);
        let slower = Reading { shutter_s: 1.0 / 60.0, ..both.clone() };
        assert_eq!(slower.lux_s(&slower.lights[0]), 160.0, "the exposure of a flash does not depend on the shutter");
    }

    #[test]
    fn the_f_number_is_compensated_for_filter_and_bellows_factor_and_the_exposure_value_is_not() {
        let plain = reading(vec![light(0, Role::Key, true, 160.0)]);
        assert_eq!(plain.compensation(), "");
        let filtered = Reading { nd_stops: 3.0, bellows_stops: 1.0, ..plain.clone() };
        // f/8 without, four stops wider with both: f/2.
        assert!((plain.f_number() - 8.0).abs() < 1e-5 && (filtered.f_number() - 2.0).abs() < 1e-5);
        assert_eq!((filtered.ev100(), filtered.total_lux_s()), (plain.ev100(), plain.total_lux_s()));
        assert_eq!(filtered.compensation(), ", ND 3 stops (ND8, 0.9), bellows factor 1.00 stops");
    }

    #[test]
    fn ratios_and_stops_are_relative_to_the_key() {
        let set = reading(vec![
            light(0, Role::Fill, true, 20.0),
            light(1, Role::Key, true, 80.0),
            light(2, Role::Rim, true, 160.0),
            light(3, Role::Hair, true, 0.0),
        ]);
        assert_eq!(set.key().unwrap().name, "Key 1");
        let stops: Vec<_> = set.lights.iter().map(|l| set.stops_over_key(l)).collect();
        assert_eq!(stops, [Some(-2.0), Some(0.0), Some(1.0), None]);
        let [plain, with_fill] = set.ratios().unwrap();
        assert_eq!((plain.value, plain.stops(), with_fill.value), (4.0, 2.0, 5.0));
    }

    #[test]
    fn without_a_key_the_strongest_light_is_the_reference() {
        let set = reading(vec![light(0, Role::Rim, false, 10.0), light(1, Role::Hair, false, 40.0)]);
        assert_eq!(set.stops_over_key(&set.lights[0]), Some(-2.0));
        assert!(set.ratios().is_none());
        let dark = reading(vec![light(0, Role::Key, true, 0.0)]);
        assert_eq!((dark.stops_over_key(&dark.lights[0]), dark.flash_fraction(), dark.f_number()), (None, None, 0.0));
    }

    #[test]
    fn a_dome_has_the_cardioid_response_and_a_flat_receptor_the_cosine() {
        for (degrees, flat, dome) in [(0.0_f32, 1.0, 1.0), (60.0, 0.5, 0.75), (90.0, 0.0, 0.5), (180.0, 0.0, 0.0)] {
            let cos = degrees.to_radians().cos();
            assert!((Receptor::Flat.response(cos) - flat).abs() < 1e-6);
            assert!((Receptor::Dome.response(cos) - dome).abs() < 1e-6);
        }
    }

    #[test]
    fn f_numbers_are_labelled_by_their_nearest_third() {
        assert_eq!([7.9, 5.5, 0.3, 0.0].map(nearest_third), ["f/8", "f/5.6", "f/0.3", "below f/0.1"]);
    }
}
