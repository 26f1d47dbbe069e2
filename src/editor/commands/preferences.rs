//! The user's preferences of the window.

use crate::photo::thirds::Dial;
use crate::scene::Camera;
use crate::sheet::Units;
use eframe::egui::ThemePreference;

/// Smallest and largest scale of the window that preferences hold.
pub const SCALES: (f32, f32) = (0.75, 2.0);
/// Smallest and largest meter constant of the fields for it, lux seconds.
pub const METER_CONSTANTS: (f32, f32) = (50.0, 1000.0);

/// The preferences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preferences {
    /// Scale of texts and buttons.
    pub scale: f32,
    /// Dark, light, or as the system.
    pub theme: ThemePreference,
    /// Units of lengths in the window and on set-up sheets.
    pub units: Units,
    /// Calibration constant C of the incident meter in new studios, lux seconds.
    pub meter_constant: f32,
}

impl Default for Preferences {
    fn default() -> Self {
        Preferences {
            scale: 1.0,
            theme: ThemePreference::Dark,
            units: Units::Metres,
            meter_constant: Camera::default().meter_constant,
        }
    }
}

impl Preferences {
    /// Sets the meter constant of a new studio's camera. The aperture follows, to a third of a stop, as a meter with
    /// that constant reads it: the picture stays as bright.
    pub fn calibrate(&self, camera: &mut Camera) {
        if camera.meter_constant == self.meter_constant {
            return;
        }
        let f_number = camera.f_number * (camera.meter_constant / self.meter_constant).sqrt();
        let thirds = Dial::FNumber.thirds(f_number).round() as i32;
        camera.f_number = Dial::FNumber.value(thirds);
        camera.meter_constant = self.meter_constant;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::exposure;

    #[test]
    fn a_new_studio_with_another_meter_constant_is_as_bright_to_a_sixth_of_a_stop() {
        let before = Camera { f_number: 8.0, ..Camera::default() };
        for meter_constant in [250.0, 330.0, 340.0, 500.0] {
            let mut camera = before.clone();
            Preferences { meter_constant, ..Preferences::default() }.calibrate(&mut camera);
            let brightness = |camera: &Camera| {
                exposure::pixel_per_cd_s_m2(&crate::scene::Scene { camera: camera.clone(), ..Default::default() })
            };
            let stops = (brightness(&camera) / brightness(&before)).log2();
            assert!(stops.abs() <= 1.0 / 6.0 + 1e-4, "{meter_constant}: {stops}");
            assert_eq!(camera.meter_constant, meter_constant);
        }
    }

    #[test]
    fn a_studio_with_the_preferred_meter_constant_keeps_its_aperture() {
        let mut camera = Camera { f_number: 5.6, ..Camera::default() };
        Preferences::default().calibrate(&mut camera);
        assert_eq!(camera.f_number, 5.6);
    }
}
