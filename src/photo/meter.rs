//! The light meter's arithmetic (ISO 2720): from what each light gives at a place to what the meter shows.
//!
//! Continuous light is read in lux, flash in lux seconds. Both meet in the exposure E t + H in lux s, from which the
//! f-number follows: N^2 = (E t + H) S / C. Where one number in lux is asked for all light together, a flash counts as
//! the steady light that would expose the same at the camera's shutter, H / t: so `lux x shutter = lux s` always.

use super::exposure;
use super::thirds::Dial;
pub use crate::scene::Receptor;
use crate::scene::{Camera, LightId, Role};

/// Lux in a foot-candle: a lumen a square foot.
pub const LUX_PER_FOOT_CANDLE: f32 = 10.763_91;

impl Receptor {
    /// Part of a light's normal illuminance that counts, by the cosine of its angle from where the receptor faces.
    pub fn response(self, cos: f32) -> f32 {
        match self {
            Receptor::Flat => cos.max(0.0),
            Receptor::Dome => (0.5 * (1.0 + cos)).max(0.0),
        }
    }

    /// Its name.
    pub fn label(self) -> &'static str {
        match self {
            Receptor::Flat => "flat",
            Receptor::Dome => "dome",
        }
    }
}

/// One light at the meter: lux for continuous light, lux seconds for flash.
#[derive(Clone, Debug, PartialEq)]
pub struct LightReading {
    /// The light; none for all surfaces that glow, together.
    pub light: Option<LightId>,
    /// Its name.
    pub name: String,
    /// Its part in the set-up.
    pub role: Option<Role>,
    /// Whether the numbers are lux seconds.
    pub flash: bool,
    /// Straight from the light, shadows included.
    pub direct: f32,
    /// By way of any surface, mirrors and glass included.
    pub bounced: f32,
    /// Standard error of `direct + bounced`, in the same unit.
    pub standard_error: f32,
}

impl LightReading {
    /// Direct and bounced together.
    pub fn sum(&self) -> f32 {
        self.direct + self.bounced
    }
}

/// What a meter shows at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Every light that is on, in the scene's order; glowing surfaces last, where there are any.
    pub lights: Vec<LightReading>,
    /// The camera's shutter, seconds.
    pub shutter_s: f32,
    /// The camera's ISO speed.
    pub iso: f32,
    /// C in lux seconds.
    pub meter_constant: f32,
}

/// A ratio between groups of lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Which ratio: `key:fill`.
    pub name: &'static str,
    /// So many to 1.
    pub value: f32,
}

impl Ratio {
    /// The ratio in stops.
    pub fn stops(&self) -> f32 {
        self.value.log2()
    }
}

impl Reading {
    /// A reading for a camera's settings.
    pub fn new(lights: Vec<LightReading>, camera: &Camera) -> Self {
        Reading { lights, shutter_s: camera.shutter_s, iso: camera.iso, meter_constant: camera.meter_constant }
    }

    /// Seconds for which a light counts.
    fn time_s(&self, light: &LightReading) -> f32 {
        if light.flash { 1.0 } else { self.shutter_s }
    }

    /// What a light adds to the exposure, lux s.
    pub fn lux_s(&self, light: &LightReading) -> f32 {
        light.sum() * self.time_s(light)
    }

    /// A quantity of a light (its own unit: lux, or lux s for flash) as steady light at the camera's shutter, lux.
    pub fn as_lux(&self, light: &LightReading, quantity: f32) -> f32 {
        if light.flash { quantity / self.shutter_s } else { quantity }
    }

    /// All light in one exposure, E t + H, lux s.
    pub fn total_lux_s(&self) -> f32 {
        total(self.lights.iter().map(|light| self.lux_s(light)))
    }

    /// Direct and bounced light as steady light at the camera's shutter, lux.
    pub fn total_lux(&self) -> (f32, f32) {
        self.lights.iter().fold((0.0, 0.0), |(direct, bounced), light| {
            (direct + self.as_lux(light, light.direct), bounced + self.as_lux(light, light.bounced))
        })
    }

    /// EV at ISO 100; minus infinity in the dark.
    pub fn ev100(&self) -> f32 {
        exposure::ev100(self.total_lux_s() / self.shutter_s, self.meter_constant)
    }

    /// The f-number to set at the camera's ISO and shutter; 0 in the dark.
    pub fn f_number(&self) -> f32 {
        exposure::f_number(self.total_lux_s(), self.iso, self.meter_constant)
    }

    /// The light that the others are compared with: the strongest of the key lights, or of all where none has that
    /// role.
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

    /// A light's exposure against the key's, stops; none in the dark.
    pub fn share_stops(&self, light: &LightReading) -> Option<f32> {
        let stops = (self.lux_s(light) / self.lux_s(self.key()?)).log2();
        stops.is_finite().then_some(stops)
    }

    /// Part of the exposure that comes from flash, 0 to 1; none in the dark.
    pub fn flash_share(&self) -> Option<f32> {
        let whole = self.total_lux_s();
        let flash = total(self.lights.iter().filter(|l| l.flash).map(|l| self.lux_s(l)));
        (whole > 0.0).then(|| flash / whole)
    }

    /// Standard error of the whole exposure relative to it; none in the dark.
    pub fn relative_error(&self) -> Option<f32> {
        let total = self.total_lux_s();
        let square: f32 = self.lights.iter().map(|l| (l.standard_error * self.time_s(l)).powi(2)).sum();
        (total > 0.0).then(|| square.sqrt() / total)
    }

    fn lux_s_of(&self, role: Role) -> f32 {
        total(self.lights.iter().filter(|l| l.role == Some(role)).map(|l| self.lux_s(l)))
    }

    /// Key against fill, in the two ways in which ratios are quoted. None without light from both roles.
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

/// An f-number as a meter in thirds shows it: the engraved number of the nearest third, such as `f/5.6`.
pub fn nearest_third(f_number: f32) -> String {
    let engraved = (f_number > 0.0).then(|| Dial::FNumber.thirds(f_number).round() as i32);
    match engraved.and_then(|thirds| Dial::FNumber.engraved(thirds)) {
        Some(label) => format!("f/{label}"),
        None => format!("f/{f_number:.1}"),
    }
}

/// Sum that is 0 of nothing: the standard library's is -0, which would be printed so.
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
        Reading::new(lights, &Camera::default())
    }

    #[test]
    fn flash_and_continuous_light_meet_in_the_exposure() {
        // light_and_camera.md: f/8 is 160 lux s of flash at ISO 100; 10 000 lx at 1/125 s are 80 more.
        let both = reading(vec![light(0, Role::Key, true, 160.0), light(1, Role::Fill, false, 10_000.0)]);
        assert!((both.total_lux_s() - 240.0).abs() < 1e-3);
        assert!((both.f_number() - (240.0_f32 * 100.0 / 250.0).sqrt()).abs() < 1e-4);
        assert!((both.flash_share().unwrap() - 160.0 / 240.0).abs() < 1e-6);
        let no_flash = Reading { lights: vec![light(1, Role::Key, false, 10_000.0)], ..both.clone() };
        assert!(no_flash.flash_share().is_some_and(|share| share == 0.0 && share.is_sign_positive()), "-0 is printed");
        // The flash as steady light at this shutter: 160 x 125 lx.
        assert!((both.total_lux().0 / 30_000.0 - 1.0).abs() < 1e-6);
        let slower = Reading { shutter_s: 1.0 / 60.0, ..both.clone() };
        assert_eq!(slower.lux_s(&slower.lights[0]), 160.0, "the shutter leaves the flash alone");
    }

    #[test]
    fn ratios_and_shares_are_in_stops_against_the_key() {
        let set = reading(vec![
            light(0, Role::Fill, true, 20.0),
            light(1, Role::Key, true, 80.0),
            light(2, Role::Rim, true, 160.0),
            light(3, Role::Hair, true, 0.0),
        ]);
        assert_eq!(set.key().unwrap().name, "Key 1");
        let shares: Vec<_> = set.lights.iter().map(|l| set.share_stops(l)).collect();
        assert_eq!(shares, [Some(-2.0), Some(0.0), Some(1.0), None]);
        let [plain, with_fill] = set.ratios().unwrap();
        assert_eq!((plain.value, plain.stops(), with_fill.value), (4.0, 2.0, 5.0));
    }

    #[test]
    fn without_a_key_the_strongest_light_is_the_measure_and_darkness_is_no_number() {
        let set = reading(vec![light(0, Role::Rim, false, 10.0), light(1, Role::Hair, false, 40.0)]);
        assert_eq!(set.share_stops(&set.lights[0]), Some(-2.0));
        assert!(set.ratios().is_none());
        let dark = reading(vec![light(0, Role::Key, true, 0.0)]);
        assert_eq!((dark.share_stops(&dark.lights[0]), dark.flash_share(), dark.f_number()), (None, None, 0.0));
    }

    #[test]
    fn a_dome_has_the_cardioid_and_a_disc_the_cosine() {
        for (degrees, flat, dome) in [(0.0_f32, 1.0, 1.0), (60.0, 0.5, 0.75), (90.0, 0.0, 0.5), (180.0, 0.0, 0.0)] {
            let cos = degrees.to_radians().cos();
            assert!((Receptor::Flat.response(cos) - flat).abs() < 1e-6);
            assert!((Receptor::Dome.response(cos) - dome).abs() < 1e-6);
        }
    }

    #[test]
    fn apertures_are_told_in_thirds() {
        assert_eq!([7.9, 5.5, 0.3, 0.0].map(nearest_third), ["f/8", "f/5.6", "f/0.3", "f/0.0"]);
    }
}
