//! Facts of camera, exposure and background on a sheet.

use super::lengths::Units;
use crate::photo::meter::nearest_third;
use crate::photo::nd_filter;
use crate::photo::text::signed_stops;
use crate::photo::thirds::Dial;
use crate::scene::{Camera, Orientation, Scene, Sensor};
use crate::setup::{Background, MeteredSetup};

/// Stops under the camera's exposure from which a reading counts as no light.
const DARK_STOPS: f32 = -8.0;

/// A name and its value.
pub type Fact = (&'static str, String);

/// Returns the facts of the camera: format, lens, exposure, place, focus.
pub fn camera_facts(setup: &MeteredSetup<'_>, units: Units) -> Vec<Fact> {
    let scene = setup.scene;
    let camera = &scene.camera;
    let subject_m = (setup.subject.position - camera.position).length();
    let nd = if camera.nd_stops > 0.0 { format!(", ND {}", nd_filter::label(camera.nd_stops)) } else { String::new() };
    let exposure = format!(
        "{}, {}, ISO {}{nd}",
        Dial::FNumber.label(camera.f_number),
        Dial::Shutter.label(camera.shutter_s),
        Dial::Iso.label(camera.iso)
    );
    let tilt_deg = scene.camera_frame(1.0).forward().y.clamp(-1.0, 1.0).asin().to_degrees();
    let tilt = match tilt_deg.round() {
        0.0 => "level".to_owned(),
        angle => format!("tilted {:.0}\u{b0} {}", angle.abs(), if angle < 0.0 { "down" } else { "up" }),
    };
    let mut facts = vec![
        ("Camera", sensor_text(camera)),
        ("Lens", lens_text(camera)),
        ("Exposure", exposure),
        ("White balance", format!("{:.0} K", camera.white_balance_k)),
        ("Distance", format!("{} to the subject", units.distance(subject_m))),
        ("Height", format!("{}, {tilt}", units.distance(camera.position.y))),
    ];
    facts.extend(sharp_text(scene, units).map(|text| ("Sharp", text)));
    facts
}

/// Returns the meter's reading at the subject, the background and the room.
pub fn subject_facts(setup: &MeteredSetup<'_>, background: Option<&Background>, units: Units) -> Vec<Fact> {
    let (reading, camera) = (&setup.reading, &setup.scene.camera);
    let f_number = reading.f_number();
    let over = 2.0 * (f_number / camera.f_number).log2();
    let mut facts = vec![match over > DARK_STOPS {
        true => {
            let (shown, receptor) = (nearest_third(f_number), setup.subject.receptor.label());
            let text = format!("{shown} at the subject ({receptor}), {} stops to the camera", signed_stops(over));
            ("Meter", text)
        }
        false => ("Meter", format!("no light from the front ({})", setup.subject.receptor.label())),
    }];
    let ratios = reading.ratios().into_iter().flatten().take(1);
    facts.extend(ratios.map(|r| ("Key to fill", format!("{:.1}:1, {} stops", r.value, signed_stops(r.stops())))));
    facts.extend(background.map(|Background { name, distance_m }| {
        ("Background", format!("{name}, {} behind the subject", units.distance(*distance_m)))
    }));
    facts.extend(setup.scene.room.as_ref().map(|room| {
        let [width, height, depth] = room.size_m.to_array().map(|edge| units.distance(edge));
        ("Room", format!("{width} wide, {depth} deep, {height} high"))
    }));
    facts
}

fn sensor_text(camera: &Camera) -> String {
    let named = Sensor::NAMED.iter().find(|(_, sensor)| *sensor == camera.sensor).map(|(name, _)| (*name).to_owned());
    let size = camera.sensor.size_mm();
    let name = named.unwrap_or_else(|| format!("Sensor {:.1} x {:.1}", size.x, size.y));
    let held = match camera.orientation {
        Orientation::Landscape => "landscape",
        Orientation::Portrait => "portrait",
    };
    format!("{name} mm, {held}")
}

fn lens_text(camera: &Camera) -> String {
    let crop = camera.sensor.crop_factor();
    let equivalent = camera.focal_length_mm * crop;
    match (crop - 1.0).abs() < 0.02 {
        true => format!("{:.0} mm", camera.focal_length_mm),
        false => format!("{:.0} mm ({equivalent:.0} mm on full frame)", camera.focal_length_mm),
    }
}

/// Returns the range that is sharp in a print; none where the focus is behind the camera.
fn sharp_text(scene: &Scene, units: Units) -> Option<String> {
    let camera = &scene.camera;
    let lens = scene.focused_lens();
    let (near_m, far_m) = lens.depth_of_field_m(camera.f_number, camera.sensor.sharp_circle_m())?;
    let far = if far_m.is_finite() { units.distance(far_m) } else { "infinity".to_owned() };
    Some(format!("{} to {far} from the camera", units.distance(near_m)))
}
