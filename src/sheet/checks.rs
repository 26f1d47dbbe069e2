//! Checks for the set: faults of the plan, and what a plan can't know.

use super::font::Font;
use super::lengths::Units;
use crate::photo::thirds::Dial;
use crate::scene::{Assets, Finding, Gel, Head, Light, Room, placement, validate};
use crate::setup::{LightShape, MeteredSetup};
use glam::Vec3;

/// Shutter from which a flash needs high-speed sync, seconds: typical of focal-plane shutters.
const SYNC_S: f32 = 1.0 / 250.0;
/// Room that a head needs over its front, metres.
const HEADROOM_M: f32 = 0.15;
/// Steps in which a stand is looked at, metres.
const STEP_M: f32 = 0.04;
/// Length of cable that a head has with it, metres: typical.
const CABLE_M: f32 = 4.0;

/// The lights of a studio that are somewhere in the room, with their places in the list.
type Placed<'a> = Vec<(usize, &'a Light, LightShape)>;

/// The checks of a studio.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Checks {
    /// A sentence each.
    pub texts: Vec<String>,
    /// The lights, by their place in the list, whose stand would be in the picture: they need a boom.
    pub stands_seen: Vec<usize>,
}

impl Checks {
    /// Returns the checks of a studio.
    pub fn new(setup: &MeteredSetup<'_>, assets: &Assets, units: Units) -> Self {
        let scene = setup.scene;
        let all = scene.lights.iter().enumerate();
        let lights = all.filter_map(|(index, light)| Some((index, light, LightShape::new(scene, light)?)));
        let lights: Placed<'_> = lights.collect();
        let mut checks = Checks::default();
        checks.exposure(setup);
        checks.seen(setup, &lights);
        for light in setup.flaring_lights() {
            checks.add(format!("{:?} shines at the lens: shade it with a flag, or use a lens hood.", light.name));
        }
        if let Some(room) = &scene.room {
            checks.room(room, &lights, units);
        }
        let off: Vec<&str> = scene.lights.iter().filter(|light| !light.on).map(|light| light.name.as_str()).collect();
        if !off.is_empty() {
            checks.add(format!("Switched off in the plan: {}.", off.join(", ")));
        }
        let is_compensated = |light: &&Light| light.color.gel != Gel::None && !light.color.gel_loss_counts;
        for light in scene.lights.iter().filter(is_compensated) {
            let (name, loss) = (&light.name, light.color.gel.loss_stops());
            checks
                .add(format!("The gel of {name:?} takes {loss:.1} stops that the dial leaves out: turn the head up."));
        }
        // The stands and fronts in the picture are told above
        let is_other = |finding: &Finding| !finding.place.ends_with(" body");
        for Finding { place, message, .. } in
            validate(&scene.without_variants()).into_iter().chain(placement(scene, assets).into_iter().filter(is_other))
        {
            checks.add(format!("{}: {message}.", thing_of(&place)));
        }
        let names = scene.lights.iter().map(|light| &light.name).chain(scene.objects.iter().map(|object| &object.name));
        let mut shown = names.chain([&scene.name, &scene.description]);
        if Font::new().is_some_and(|font| shown.any(|text| !font.has_all(text))) {
            checks.add("Some names have characters that the font of the PDF lacks: SVG and HTML show them.".to_owned());
        }
        checks
    }

    fn add(&mut self, text: String) {
        self.texts.push(text);
    }

    fn exposure(&mut self, setup: &MeteredSetup<'_>) {
        let camera = &setup.scene.camera;
        let flashes = setup.scene.lights.iter().filter(|light| light.on && light.power.output.is_flash());
        let mut told = Vec::new();
        for light in flashes {
            if let Some(text) = sync_text(light.head.as_ref(), camera.shutter_s).filter(|text| !told.contains(text)) {
                self.add(text.clone());
                told.push(text);
            }
        }
        let flash = setup.reading.flash_fraction().unwrap_or(0.0);
        if (0.02..0.98).contains(&flash) {
            let steady = 100.0 * (1.0 - flash);
            self.add(format!(
                "{steady:.0} % of the light is continuous: it changes with the shutter, the flash does not."
            ));
        }
    }

    /// Adds the stands and fronts that the camera sees. A light stands on the floor under its head.
    fn seen(&mut self, setup: &MeteredSetup<'_>, lights: &Placed<'_>) {
        for (index, light, shape) in lights {
            let foot = Vec3::new(shape.head.x, 0.0, shape.head.z);
            let steps = (shape.head.y / STEP_M).ceil().clamp(1.0, 1000.0);
            let stand = (0..steps as u32).map(|step| foot.lerp(shape.head, step as f32 / steps));
            if { stand }.any(|point| setup.is_seen(point)) {
                self.stands_seen.push(*index);
                self.add(format!("The stand of {:?} would be in the picture: a boom, or move it.", light.name));
            }
            if shape.surface_points().any(|point| setup.is_seen(point)) {
                let hidden = if setup.scene.camera_sees_light(light) { "" } else { " (the plan hides it)" };
                self.add(format!("{:?} itself is in the picture{hidden}: move it out, or retouch.", light.name));
            }
        }
    }

    fn room(&mut self, room: &Room, lights: &Placed<'_>, units: Units) {
        let ceiling_m = room.size_m.y;
        for (_, light, shape) in lights {
            let over_m = ceiling_m - shape.top_m();
            if over_m < 0.0 {
                let [top, height] = [shape.top_m(), ceiling_m].map(|metres| units.distance(metres));
                self.add(format!("{:?} does not fit: its top is at {top}, the ceiling at {height}.", light.name));
            } else if over_m < HEADROOM_M {
                let over = units.distance(over_m);
                self.add(format!(
                    "Only {over} between {:?} and the ceiling: little room for its head or boom.",
                    light.name
                ));
            }
        }
        let half = 0.5 * room.size_m;
        // Down the stand and along the floor
        let cable_m = |light: &Light| {
            let to_wall = half - light.position.abs();
            to_wall.x.min(to_wall.z) + light.position.y
        };
        let lengths = lights.iter().map(|(_, light, _)| (light, cable_m(light)));
        let longest = lengths.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, length_m)| *length_m > CABLE_M);
        if let Some((light, length_m)) = longest {
            let length = units.distance(length_m);
            self.add(format!("Cable: {:?} needs at least {length} to the nearest wall, or a battery.", light.name));
        }
    }
}

/// Returns the sentence about a head whose flash the shutter cuts off; none if it gets the whole flash.
fn sync_text(head: Option<&Head>, shutter_s: f32) -> Option<String> {
    let sync_s = head.and_then(|head| head.sync_s).unwrap_or(SYNC_S);
    if shutter_s >= 0.99 * sync_s {
        return None;
    }
    let shutter = Dial::Shutter.label(shutter_s);
    Some(match head {
        Some(Head { name, hss_loss_stops: Some(loss), .. }) => {
            // In high-speed sync the flash is a continuous light: it counts for the time of the shutter
            let lost = loss + (sync_s / shutter_s).log2();
            format!(
                "{shutter} needs high-speed sync: {name} then loses about {lost:.1} stops, which the plan leaves out."
            )
        }
        Some(Head { name, sync_s: Some(_), .. }) => format!(
            "{shutter} is faster than the sync of {name} ({}), which has no high-speed sync in the list: a longer time.",
            Dial::Shutter.label(sync_s)
        ),
        _ => format!(
            "{shutter} is faster than the usual flash sync (1/200 to 1/250, typical): high-speed sync, or a longer time."
        ),
    })
}

/// Returns the thing that the place of a finding is about: `"Key"` for `lights[0] "Key" position`, else `camera` for
/// `camera.aim`.
fn thing_of(place: &str) -> &str {
    match (place.find('"'), place.rfind('"')) {
        (Some(first), Some(last)) if first < last => &place[first..=last],
        _ => place.split(['.', '[']).next().filter(|thing| !thing.is_empty()).unwrap_or("studio"),
    }
}
