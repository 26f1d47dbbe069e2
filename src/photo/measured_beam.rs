//! A measured intensity distribution as the angular factor of an emitter.

use crate::math::safe_acos;
use crate::scene::{Emitter, IntensityTable};
use glam::Vec3;
use std::sync::Arc;

/// Least cosine by which the intensity of a panel is divided: nearer to its plane than 6 degrees its luminance stays, and
/// its intensity falls with the cosine. A flat panel can't shine along its plane.
const LEAST_PANEL_COSINE: f32 = 0.1;

/// The intensity of a photometric file relative to its peak, as a factor of an emitter's own intensity by direction: of
/// a point's or a sphere's, which is the same everywhere, or of a panel's, which falls with the cosine. The emitter then
/// has the intensity of the file in the far field; a panel only before it, and at more than 6 degrees to its plane.
#[derive(Clone, Debug)]
pub struct MeasuredBeam {
    table: Arc<IntensityTable>,
    /// The emitter is a panel.
    is_panel: bool,
}

/// Two beams are the same if they share their table.
impl PartialEq for MeasuredBeam {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.table, &other.table) && self.is_panel == other.is_panel
    }
}

impl MeasuredBeam {
    /// Returns the factor that gives an emitter the intensities of a table.
    pub fn new(table: Arc<IntensityTable>, emitter: &Emitter) -> Self {
        let is_panel = matches!(emitter, Emitter::RectPanel { .. } | Emitter::RoundPanel { .. });
        MeasuredBeam { table, is_panel }
    }

    /// Returns the table.
    pub fn table(&self) -> &Arc<IntensityTable> {
        &self.table
    }

    /// Returns true if the emitter is a panel.
    pub fn is_panel(&self) -> bool {
        self.is_panel
    }

    /// Returns the factor in a unit direction of the light's frame: 0 to 1, for panels up to 10.
    pub fn factor(&self, direction_light: Vec3) -> f32 {
        let relative = self.table.candela_towards(direction_light) / self.table.peak_cd();
        if self.is_panel { relative / (-direction_light.z).max(LEAST_PANEL_COSINE) } else { relative }
    }

    /// Returns an upper bound of the factor.
    pub fn largest_factor(&self) -> f32 {
        if self.is_panel { 1.0 / LEAST_PANEL_COSINE } else { 1.0 }
    }

    /// Returns the relative output of the lamp in its burning position: `axis` is the light's axis in world space, whose
    /// Y points up. Files state it by the tilt of the luminaire from straight down.
    pub fn tilt_factor(&self, axis: Vec3) -> f32 {
        self.table.tilt_factor(safe_acos(-axis.y).to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panel_has_the_intensity_of_the_file_up_to_six_degrees_to_its_plane() {
        let candela = vec![800.0, 400.0, 200.0];
        let table = Arc::new(IntensityTable::new(vec![0.0, 60.0, 120.0], vec![0.0], candela).unwrap());
        let point = MeasuredBeam::new(table.clone(), &Emitter::Point);
        let panel = MeasuredBeam::new(table, &Emitter::RoundPanel { diameter_m: 0.5 });
        for angle_deg in [0.0_f32, 30.0, 60.0, 80.0] {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            let direction = Vec3::new(0.0, sin, -cos);
            assert!((panel.factor(direction) * cos - point.factor(direction)).abs() < 1e-5, "{angle_deg}");
        }
        let (sin, cos) = 88_f32.to_radians().sin_cos();
        let grazing = Vec3::new(sin, 0.0, -cos);
        assert!((panel.factor(grazing) - 10.0 * point.factor(grazing)).abs() < 1e-5);
        assert!(panel.factor(grazing) <= panel.largest_factor() && point.factor(Vec3::NEG_Z) == 1.0);
    }

    #[test]
    fn the_tilt_counts_from_straight_down() {
        let mut table = IntensityTable::new(vec![0.0, 90.0], vec![0.0], vec![100.0; 2]).unwrap();
        table.tilt = vec![[0.0, 1.0], [180.0, 0.5]];
        let beam = MeasuredBeam::new(Arc::new(table), &Emitter::Point);
        for (axis, factor) in [(Vec3::NEG_Y, 1.0), (Vec3::X, 0.75), (Vec3::Y, 0.5)] {
            assert!((beam.tilt_factor(axis) - factor).abs() < 1e-6, "{axis}");
        }
    }
}
