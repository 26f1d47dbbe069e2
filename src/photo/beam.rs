//! The beam of a light by direction: what a modifier leaves of it, the transmission of a dish's or snoot's cone, a grid
//! and barn doors; and a measured distribution.

use super::emitter::{EmitterShape, cone_falloff_at};
use super::measured_beam::MeasuredBeam;
use crate::scene::{BarnDoors, Cone, Modifier};
use glam::Vec3;
use std::f32::consts::TAU;

/// Width of the penumbra of a barn door's edge, degrees: the lamp behind it has a size.
pub const DOOR_EDGE_DEG: f32 = 4.0;

/// Angular transmission of a modifier, without its loss, times a measured distribution. The axis of a grid passes
/// everything.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    /// Cone of a dish or a snoot.
    pub cone: Option<Cone>,
    /// Full angle at which a grid cuts off, degrees; linear in angle from the axis.
    pub grid_deg: Option<f32>,
    /// Barn doors.
    pub doors: Option<BarnDoors>,
    /// Measured distribution.
    pub measured: Option<MeasuredBeam>,
}

impl Beam {
    /// Converts a modifier; none where it passes all directions alike.
    pub fn new(modifier: &Modifier) -> Option<Self> {
        let Modifier { loss_stops: _, scrim_stops: _, beam: cone, grid_deg, doors } = *modifier;
        modifier.narrows().then_some(Beam { cone, grid_deg, doors, measured: None })
    }

    /// As [`Beam::new`], for a light with a measured distribution.
    pub fn with_measured(modifier: &Modifier, measured: Option<MeasuredBeam>) -> Option<Self> {
        match (Self::new(modifier), measured) {
            (beam, None) => beam,
            (Some(beam), measured) => Some(Beam { measured, ..beam }),
            (None, measured) => Some(Beam { cone: None, grid_deg: None, doors: None, measured }),
        }
    }

    /// Returns the cones whose falloffs multiply: that of the dish or snoot, and that of the grid.
    pub fn cones(&self) -> impl Iterator<Item = Cone> {
        let grid = self.grid_deg.map(|outer_deg| Cone { inner_deg: 0.0, outer_deg });
        self.cone.into_iter().chain(grid)
    }

    /// Returns the transmission in a unit direction of the light's frame (right, up, back: the axis is -Z): 0 to 1, and up
    /// to [`MeasuredBeam::largest_factor`] with a measured distribution.
    pub fn transmission(&self, direction_light: Vec3) -> f32 {
        let Vec3 { x, y, z } = direction_light;
        let angle_rad = x.hypot(y).atan2(-z);
        let cone = self.cone.map_or(1.0, |cone| cone_falloff_at(angle_rad, cone.inner_deg, cone.outer_deg));
        let grid = self.grid_deg.map_or(1.0, |full_deg| cone_falloff_at(angle_rad, 0.0, full_deg));
        let doors = self.doors.map_or(1.0, |doors| doors_transmission(&doors, direction_light));
        let window = cone * grid * doors;
        match &self.measured {
            Some(measured) if window > 0.0 => window * measured.factor(direction_light),
            _ => window,
        }
    }
}

/// Returns the transmission of barn doors in a unit direction of the light's frame, 0 to 1.
pub fn doors_transmission(doors: &BarnDoors, direction_light: Vec3) -> f32 {
    let Vec3 { x, y, z } = direction_light;
    if z >= 0.0 {
        return 0.0;
    }
    let right_deg = x.atan2(-z).to_degrees();
    let up_deg = y.atan2(-z).to_degrees();
    // A flap opened by 90 degrees or more cuts nothing.
    let flap = |open_deg: f32, angle_deg: f32| match open_deg {
        open if open >= 90.0 => 1.0,
        open => ((open - angle_deg) / DOOR_EDGE_DEG + 0.5).clamp(0.0, 1.0),
    };
    flap(doors.left_deg, -right_deg)
        * flap(doors.right_deg, right_deg)
        * flap(doors.top_deg, up_deg)
        * flap(doors.bottom_deg, -up_deg)
}

/// Returns the fraction of an emitter's flux that a beam transmits, 0 to 1; 1 for distant lights. The flux of a measured
/// light is that of its file.
pub fn transmitted_flux_fraction(shape: &EmitterShape, beam: Option<&Beam>) -> f32 {
    let Some(beam) = beam.filter(|_| !shape.is_distant()) else { return 1.0 };
    let is_bare = beam.cones().next().is_none() && beam.doors.is_none();
    if is_bare && beam.measured.as_ref().is_some_and(|measured| !measured.is_panel()) {
        return 1.0;
    }
    // Midpoint rule in polar and azimuth angle; only doors and measured distributions depend on the azimuth.
    const POLAR_STEPS: u32 = 180;
    let azimuth_steps = if beam.doors.is_some() || beam.measured.is_some() { 90 } else { 1 };
    let widest = shape.widest_angle_rad();
    let (mut transmitted, mut total) = (0.0, 0.0);
    for i in 0..POLAR_STEPS {
        let polar = (i as f32 + 0.5) / POLAR_STEPS as f32 * widest;
        let (sin, cos) = polar.sin_cos();
        let weight = sin * shape.relative_intensity(cos);
        for k in 0..azimuth_steps {
            let (sin_azimuth, cos_azimuth) = ((k as f32 + 0.5) / azimuth_steps as f32 * TAU).sin_cos();
            transmitted += weight * beam.transmission(Vec3::new(sin * cos_azimuth, sin * sin_azimuth, -cos));
            total += weight;
        }
    }
    if let Some(measured) = &beam.measured {
        let step_sr = widest / POLAR_STEPS as f32 * TAU / azimuth_steps as f32;
        return transmitted * step_sr / measured.table().solid_angle_sr();
    }
    if total > 0.0 { transmitted / total } else { 1.0 }
}

/// Returns the stops of flux that a beam cuts off; the intensity on the axis stays.
pub fn beam_loss_stops(shape: &EmitterShape, beam: Option<&Beam>) -> f32 {
    -transmitted_flux_fraction(shape, beam).log2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::NamedModifier;
    use std::f32::consts::PI;

    fn beam(modifier: Modifier) -> Beam {
        Beam::new(&modifier).unwrap()
    }

    #[test]
    fn a_grid_transmits_its_axis_and_cuts_off_at_its_angle() {
        let grid = beam(Modifier { grid_deg: Some(40.0), ..Modifier::default() });
        let at = |deg: f32| grid.transmission(Vec3::new(deg.to_radians().sin(), 0.0, -deg.to_radians().cos()));
        assert!(at(0.0) > 0.999 && (at(10.0) - 0.5).abs() < 1e-3 && at(20.1) == 0.0 && at(180.0) == 0.0);
    }

    #[test]
    fn each_barn_door_cuts_its_own_side() {
        let doors = BarnDoors { left_deg: 10.0, right_deg: 50.0, top_deg: 90.0, bottom_deg: 20.0 };
        let beam = beam(Modifier { doors: Some(doors), ..Modifier::default() });
        let at = |x: f32, y: f32| beam.transmission(Vec3::new(x, y, -1.0).normalize());
        // Seen along the axis, +X is to the right.
        assert_eq!((at(0.0, 0.0), at(0.8, 0.0), at(-0.3, 0.0)), (1.0, 1.0, 0.0));
        assert_eq!((at(0.0, 5.0), at(0.0, -0.5)), (1.0, 0.0));
        assert_eq!(beam.transmission(Vec3::Z), 0.0);
    }

    #[test]
    fn the_transmitted_flux_is_the_integral_over_the_cone() {
        let cone = |full_deg: f32| {
            let cone = Cone { inner_deg: full_deg, outer_deg: full_deg };
            beam(Modifier { beam: Some(cone), ..Modifier::default() })
        };
        let (disc, point) = (crate::scene::Emitter::RoundPanel { diameter_m: 1.0 }, crate::scene::Emitter::Point);
        let (disc, point) = (EmitterShape::new(&disc), EmitterShape::new(&point));
        for full_deg in [20.0_f32, 40.0, 90.0, 120.0] {
            let half = (0.5 * full_deg).to_radians();
            // A Lambertian panel emits sin2 a of its flux into a cone of half angle a, an isotropic source
            // (1 - cos a) / 2. The hard edge falls between two of 180 midpoints: half a degree at most.
            let fraction = transmitted_flux_fraction(&disc, Some(&cone(full_deg)));
            let slack = (2.0 * half.sin() * half.cos()) * 0.5_f32.to_radians() + 1e-3;
            assert!((fraction - half.sin().powi(2)).abs() < slack, "{full_deg}: {fraction}");
            let fraction = transmitted_flux_fraction(&point, Some(&cone(full_deg)));
            assert!(
                (fraction - 0.5 * (1.0 - half.cos())).abs() < 0.5 * half.sin() * PI / 180.0 + 1e-3,
                "{full_deg}: {fraction}"
            );
        }
        assert_eq!(transmitted_flux_fraction(&point, None), 1.0);
    }

    #[test]
    fn every_named_modifier_loses_flux_only_where_it_narrows_the_beam() {
        for named in &NamedModifier::ALL {
            let beam = Beam::new(&named.modifier);
            let loss = beam_loss_stops(&EmitterShape::new(&named.emitter), beam.as_ref());
            assert!((0.0..9.0).contains(&(loss + 1e-4)), "{}: {loss} stops", named.name);
            assert_eq!(loss > 0.01, named.modifier.narrows(), "{}: {loss} stops", named.name);
            assert!((0.0..=2.0).contains(&named.modifier.loss_stops), "{}", named.name);
            let on_axis = beam.map_or(1.0, |beam| beam.transmission(Vec3::NEG_Z));
            assert!((on_axis - 1.0).abs() < 1e-3, "{}: {on_axis} on its axis", named.name);
        }
    }
}
