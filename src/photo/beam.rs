//! What a modifier leaves of a light, by direction and in all: one source for tracer, preview, meter and panels.

use super::exposure::spot_falloff;
use crate::scene::{BarnDoors, Emitter, Modifier};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Angle over which a barn door's edge goes from light to dark, degrees: the lamp behind it has a size.
pub const DOOR_EDGE_DEG: f32 = 4.0;

/// Part of a modifier's own loss, 0 to 1: swallowed in all directions alike.
pub fn transmittance(modifier: &Modifier) -> f32 {
    (-(modifier.loss_stops + modifier.scrim_stops)).exp2()
}

/// Part that passes in a unit direction of the light's frame (right, up, back: the axis is -Z), 0 to 1. On the axis of
/// a grid everything passes: what is lost is lost beside it.
pub fn passed(modifier: &Modifier, direction: Vec3) -> f32 {
    let cos = -direction.z;
    let beam = modifier.beam.map_or(1.0, |cone| spot_falloff(cos, cone.inner_deg, cone.outer_deg));
    let grid = modifier.grid_deg.map_or(1.0, |full_deg| spot_falloff(cos, 0.0, full_deg));
    let doors = modifier.doors.map_or(1.0, |doors| passed_by_doors(&doors, direction));
    beam * grid * doors
}

fn passed_by_doors(doors: &BarnDoors, direction: Vec3) -> f32 {
    if direction.z >= 0.0 {
        return 0.0;
    }
    let across_deg = direction.x.atan2(-direction.z).to_degrees();
    let up_deg = direction.y.atan2(-direction.z).to_degrees();
    // A flap at 90 degrees or more is out of the way.
    let flap = |open_deg: f32, angle_deg: f32| match open_deg {
        open if open >= 90.0 => 1.0,
        open => ((open - angle_deg) / DOOR_EDGE_DEG + 0.5).clamp(0.0, 1.0),
    };
    flap(doors.left_deg, -across_deg)
        * flap(doors.right_deg, across_deg)
        * flap(doors.top_deg, up_deg)
        * flap(doors.bottom_deg, -up_deg)
}

/// Part of an emitter's flux that leaves through the beam, 0 to 1, without the modifier's own loss.
pub fn passed_share(emitter: &Emitter, modifier: &Modifier) -> f32 {
    if !modifier.narrows() || emitter.is_infinite() {
        return 1.0;
    }
    // Midpoints in angle from the axis and around it; around it only doors make a difference.
    const ANGLES: u32 = 180;
    let turns = if modifier.doors.is_some() { 90 } else { 1 };
    let reach = if matches!(emitter, Emitter::Point | Emitter::Sphere { .. }) { 2.0 * FRAC_PI_2 } else { FRAC_PI_2 };
    let (mut through, mut all) = (0.0, 0.0);
    for i in 0..ANGLES {
        let angle = (i as f32 + 0.5) / ANGLES as f32 * reach;
        let (sin, cos) = angle.sin_cos();
        let weight = sin * relative_intensity(emitter, cos);
        for k in 0..turns {
            let (sin_turn, cos_turn) = ((k as f32 + 0.5) / turns as f32 * TAU).sin_cos();
            through += weight * passed(modifier, Vec3::new(sin * cos_turn, sin * sin_turn, -cos));
            all += weight;
        }
    }
    if all > 0.0 { through / all } else { 1.0 }
}

/// Intensity of a bare emitter at an angle, relative to its axis.
fn relative_intensity(emitter: &Emitter, cos: f32) -> f32 {
    match *emitter {
        Emitter::Point | Emitter::Sphere { .. } => 1.0,
        Emitter::RectPanel { .. } | Emitter::RoundPanel { .. } => cos.max(0.0),
        Emitter::Spot { inner_deg, outer_deg } => spot_falloff(cos, inner_deg, outer_deg),
        Emitter::Sun { .. } | Emitter::Surround => 0.0,
    }
}

/// Stops of flux lost to the narrower beam; what lies on the axis does not feel it.
pub fn beam_loss_stops(emitter: &Emitter, modifier: &Modifier) -> f32 {
    -passed_share(emitter, modifier).log2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cone, NamedModifier};
    use std::f32::consts::PI;

    #[test]
    fn a_grid_passes_its_axis_and_cuts_off_at_its_angle() {
        let grid = Modifier { grid_deg: Some(40.0), ..Modifier::default() };
        let at = |degrees: f32| passed(&grid, Vec3::new(degrees.to_radians().sin(), 0.0, -degrees.to_radians().cos()));
        assert!(at(0.0) > 0.999 && (at(10.0) - 0.5).abs() < 1e-3 && at(20.1) == 0.0 && at(180.0) == 0.0);
    }

    #[test]
    fn barn_doors_open_to_their_own_sides() {
        let doors = BarnDoors { left_deg: 10.0, right_deg: 50.0, top_deg: 90.0, bottom_deg: 20.0 };
        let modifier = Modifier { doors: Some(doors), ..Modifier::default() };
        let at = |x: f32, y: f32| passed(&modifier, Vec3::new(x, y, -1.0).normalize());
        // Seen along the axis, +X is to the right.
        assert_eq!((at(0.0, 0.0), at(0.8, 0.0), at(-0.3, 0.0)), (1.0, 1.0, 0.0));
        assert_eq!((at(0.0, 5.0), at(0.0, -0.5)), (1.0, 0.0));
        assert_eq!(passed(&modifier, Vec3::Z), 0.0);
    }

    #[test]
    fn the_lost_share_is_the_integral_of_what_is_cut() {
        let cut = |full_deg: f32| Modifier {
            beam: Some(Cone { inner_deg: full_deg, outer_deg: full_deg }),
            ..Modifier::default()
        };
        for full_deg in [20.0_f32, 40.0, 90.0, 120.0] {
            let half = (0.5 * full_deg).to_radians();
            // A Lambertian panel sends sin2 a of its flux into a cone of half angle a, a bulb (1 - cos a) / 2. The hard
            // edge falls between two of 180 midpoints: half a degree at most.
            let panel = passed_share(&Emitter::RoundPanel { diameter_m: 1.0 }, &cut(full_deg));
            let slack = (2.0 * half.sin() * half.cos()) * 0.5_f32.to_radians() + 1e-3;
            assert!((panel - half.sin().powi(2)).abs() < slack, "{full_deg}: {panel}");
            let bulb = passed_share(&Emitter::Point, &cut(full_deg));
            assert!(
                (bulb - 0.5 * (1.0 - half.cos())).abs() < 0.5 * half.sin() * PI / 180.0 + 1e-3,
                "{full_deg}: {bulb}"
            );
        }
        assert_eq!(passed_share(&Emitter::Point, &Modifier::default()), 1.0);
    }

    #[test]
    fn every_modifier_of_the_rack_loses_what_it_says_and_no_more() {
        for named in &NamedModifier::ALL {
            let loss = beam_loss_stops(&named.emitter, &named.modifier);
            assert!((0.0..9.0).contains(&(loss + 1e-4)), "{}: {loss} stops", named.name);
            assert_eq!(loss > 0.01, named.modifier.narrows(), "{}: {loss} stops", named.name);
            assert!((0.0..=2.0).contains(&named.modifier.loss_stops), "{}", named.name);
            let on_axis = passed(&named.modifier, Vec3::NEG_Z);
            assert!((on_axis - 1.0).abs() < 1e-3, "{}: {on_axis} on its axis", named.name);
        }
    }
}
