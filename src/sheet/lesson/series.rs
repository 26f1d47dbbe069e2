//! The studios of a lesson.

use crate::jobs::{FaceLighting, check_patterns, faces_in_view};
use crate::photo::exposure;
use crate::photo::meter::{Reading, nearest_third};
use crate::photo::text::signed_hundredths;
use crate::photo::{LightBearing, light_dial_text};
use crate::raytrace::{GeometryCache, PrepareError, RenderControl};
use crate::scene::{Aim, Assets, Light, LightId, Material, NamedModifier, Room, Scene};
use crate::setup::MeteredSetup;
use glam::Vec3;

/// Angles round from the camera and up at which a light is shown, degrees.
const AZIMUTHS_DEG: [f32; 5] = [0.0, 45.0, 90.0, 135.0, 180.0];
const ELEVATIONS_DEG: [f32; 3] = [60.0, 30.0, 0.0];
/// The place at which a light that swings round is metered.
const METERED_DEG: [f32; 2] = [0.0, 0.0];
/// Distances at which a light is shown, metres: a stop apart by the inverse-square law.
const DISTANCES_M: [f32; 8] = [0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0];
/// Modifiers that are shown, from hard to soft.
const MODIFIERS: [&str; 8] = [
    "Bare bulb",
    "Reflector",
    "Reflector, 20\u{b0} grid",
    "Beauty dish 55",
    "Strip 30 x 120",
    "Softbox 60 x 90",
    "Umbrella 105",
    "Octa 150",
];
/// Rooms that are shown, with the albedo of walls, ceiling and floor: typical of paint.
const ROOMS: [(&str, f32); 3] = [("Black", 0.04), ("Grey", 0.3), ("White", 0.85)];
/// Space between a light and the room, metres.
const MARGIN_M: f32 = 0.25;

/// The thing that changes over a lesson.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LessonSeries {
    /// The place of a light round the subject and up, at one distance and one power.
    Azimuth,
    /// The distance of a light, at one exposure.
    Distance,
    /// The modifier on a light, at one exposure.
    Modifier,
    /// The colour of the room around the whole set-up.
    Room,
}

impl LessonSeries {
    /// All series, in menu order.
    pub const ALL: [LessonSeries; 4] =
        [LessonSeries::Azimuth, LessonSeries::Distance, LessonSeries::Modifier, LessonSeries::Room];

    /// Returns the label in menus.
    pub fn label(self) -> &'static str {
        match self {
            LessonSeries::Azimuth => "Round the subject",
            LessonSeries::Distance => "Near and far",
            LessonSeries::Modifier => "Modifiers",
            LessonSeries::Room => "Colour of the room",
        }
    }

    /// Returns one line on it.
    pub fn tip(self) -> &'static str {
        match self {
            LessonSeries::Azimuth => "The light alone from fifteen directions, with the patterns on the face",
            LessonSeries::Distance => "The light alone at several distances, always of the same exposure",
            LessonSeries::Modifier => "Eight modifiers on the light alone, always of the same exposure",
            LessonSeries::Room => "The whole set-up in a black, a grey and a white room",
        }
    }
}

/// A picture of a lesson.
#[derive(Clone, Debug, PartialEq)]
pub struct LessonCell {
    /// What is shown: `45 degrees, 30 up`.
    pub caption: String,
    /// The lighting pattern on a face, or what the meter says.
    pub note: String,
    /// The studio.
    pub scene: Scene,
}

/// A lesson.
#[derive(Clone, Debug, PartialEq)]
pub struct Lesson {
    /// Title.
    pub title: String,
    /// One line on what stays the same.
    pub about: String,
    /// Pictures in a row.
    pub columns: usize,
    /// The pictures, row by row.
    pub cells: Vec<LessonCell>,
}

/// A reason why there is no lesson.
#[derive(Debug, thiserror::Error)]
pub enum LessonError {
    /// The scene has errors.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// Sun and surround have no place.
    #[error("{0:?} has no place in the room: take another light")]
    NoPlace(String),
    /// The studio has no lights.
    #[error("there is no light in the studio")]
    NoLight,
    /// No light of it arrives.
    #[error("no light of {0:?} reaches the subject")]
    Dark(String),
    /// Cancelled.
    #[error("it was cancelled")]
    Cancelled,
}

impl Lesson {
    /// Sets up and meters the studios of a series. `light` is the one that changes; none for the strongest key, or else the
    /// first light. It is on alone, except in rooms.
    ///
    /// # Errors
    /// If the scene has errors, if there is no such light or its light does not reach the subject, or once cancelled.
    pub fn new(
        series: LessonSeries,
        scene: &Scene,
        assets: &Assets,
        light: Option<LightId>,
        cache: &GeometryCache,
        control: &RenderControl,
    ) -> Result<Self, LessonError> {
        let studio = Studio { scene, assets, cache, face_cache: GeometryCache::default(), control };
        if series == LessonSeries::Room {
            return studio.rooms();
        }
        let reading = studio.measure(scene)?;
        let key = reading.1.key().and_then(|key| key.light);
        let id = light.or(key).or(scene.lights.first().map(|light| light.id)).ok_or(LessonError::NoLight)?;
        let light = scene.light(id).ok_or(LessonError::NoLight)?;
        if light.emitter.is_infinite() {
            return Err(LessonError::NoPlace(light.name.clone()));
        }
        match series {
            LessonSeries::Azimuth => studio.round_the_subject(light, reading.0),
            LessonSeries::Distance => studio.near_and_far(light, reading.0),
            LessonSeries::Modifier | LessonSeries::Room => studio.modifiers(light),
        }
    }
}

/// A studio to be varied.
struct Studio<'a> {
    scene: &'a Scene,
    assets: &'a Assets,
    cache: &'a GeometryCache,
    /// Figures are checked without the hair on the face.
    face_cache: GeometryCache,
    control: &'a RenderControl,
}

impl Studio<'_> {
    /// Returns the place of the subject, and the reading there.
    fn measure(&self, scene: &Scene) -> Result<(Vec3, Reading), LessonError> {
        let setup = MeteredSetup::new(scene, self.assets, self.cache, self.control)?.ok_or(LessonError::Cancelled)?;
        Ok((setup.subject.position, setup.reading))
    }

    /// Returns the studio with one light, alone.
    fn alone(&self, light: Light) -> Scene {
        let mut scene = self.scene.clone();
        scene.solo = None;
        scene.lights.iter_mut().for_each(|other| other.on = false);
        if let Some(place) = scene.lights.iter_mut().find(|other| other.id == light.id) {
            *place = Light { on: true, muted: false, ..light };
        }
        scene
    }

    /// Sets the dial of the light that is on so that the meter shows the camera's f-number, and returns the change in
    /// stops.
    fn expose(&self, scene: &mut Scene) -> Result<f32, LessonError> {
        let (_, reading) = self.measure(scene)?;
        let wanted = exposure::lux_s_to_set(scene, scene.camera.f_number);
        let change = (wanted / reading.total_lux_s()).log2();
        let light = scene.lights.iter_mut().find(|light| light.on).ok_or(LessonError::NoLight)?;
        if !change.is_finite() {
            return Err(LessonError::Dark(light.name.clone()));
        }
        light.power.dial_stops += change;
        Ok(change)
    }

    fn round_the_subject(&self, light: &Light, subject: Vec3) -> Result<Lesson, LessonError> {
        let wanted_m = (light.position - subject).length().clamp(0.3, 20.0);
        let places = || ELEVATIONS_DEG.iter().flat_map(|up| AZIMUTHS_DEG.map(|round| [round, *up]));
        let away = |[round, up]: [f32; 2]| LightBearing::direction(self.scene, subject, round, up);
        // So near that it fits everywhere
        let fits = |place: [f32; 2]| self.fitting_m(subject, away(place));
        let distance_m = places().map(fits).fold(wanted_m, f32::min).max(0.2);
        let placed = |place: [f32; 2], dial_stops: f32| {
            let mut light = light.clone();
            (light.position, light.aim) = (subject + away(place) * distance_m, Aim::Point(subject));
            light.power.dial_stops = dial_stops;
            self.alone(light)
        };
        let mut metered = placed(METERED_DEG, light.power.dial_stops);
        let dial_stops = light.power.dial_stops + self.expose(&mut metered)?;
        let mut cells = Vec::new();
        for place in places() {
            let scene = placed(place, dial_stops);
            let note = self.pattern(&scene)?;
            let [round, up] = place.map(|degrees| format!("{degrees:.0}\u{b0}"));
            cells.push(LessonCell { caption: format!("{round} round, {up} up"), note, scene });
        }
        let about = format!(
            "Alone, {distance_m:.1} m from the subject, of one power: exposed for the light in front. Round is from the \
             camera's direction."
        );
        Ok(self.lesson(&format!("{} round the subject", light.name), about, AZIMUTHS_DEG.len(), cells))
    }

    fn near_and_far(&self, light: &Light, subject: Vec3) -> Result<Lesson, LessonError> {
        let away = (light.position - subject).try_normalize().unwrap_or(Vec3::Y);
        let farthest_m = self.fitting_m(subject, away);
        let mut cells = Vec::new();
        for distance_m in DISTANCES_M.into_iter().filter(|distance_m| *distance_m <= farthest_m) {
            let mut moved = light.clone();
            (moved.position, moved.aim) = (subject + away * distance_m, Aim::Point(subject));
            let mut scene = self.alone(moved);
            self.expose(&mut scene)?;
            let note = self.exposed_note(&scene);
            cells.push(LessonCell { caption: format!("{distance_m} m"), note, scene });
        }
        let about = "Alone, always the same exposure at the subject: softness and falloff change.".to_owned();
        Ok(self.lesson(&format!("{} near and far", light.name), about, 4, cells))
    }

    fn modifiers(&self, light: &Light) -> Result<Lesson, LessonError> {
        let mut cells = Vec::new();
        for named in MODIFIERS.iter().filter_map(|name| NamedModifier::named(name)) {
            let (emitter, modifier) = (named.emitter, named.modifier);
            let mut scene = self.alone(Light { emitter, modifier, photometric_file: None, ..light.clone() });
            self.expose(&mut scene)?;
            let note = self.exposed_note(&scene);
            cells.push(LessonCell { caption: named.name.to_owned(), note, scene });
        }
        let about = "Alone, in one place, always the same exposure at the subject.".to_owned();
        Ok(self.lesson(&format!("Modifiers on {}", light.name), about, 4, cells))
    }

    fn rooms(&self) -> Result<Lesson, LessonError> {
        let (_, now) = self.measure(self.scene)?;
        let mut cells = Vec::new();
        for (name, albedo) in ROOMS {
            let paint = Material { base_color: [albedo; 3], roughness: 0.9, ..Material::default() };
            let size_m = self.scene.room.as_ref().map_or(Room::default().size_m, |room| room.size_m);
            let room = Room { size_m, floor: paint.clone(), walls: paint.clone(), ceiling: paint };
            let scene = Scene { room: Some(room), ..self.scene.clone() };
            let (_, reading) = self.measure(&scene)?;
            let over = (reading.total_lux_s() / now.total_lux_s()).log2();
            let ratio = reading.ratios().map(|[ratio, _]| format!(", key:fill {:.1}:1", ratio.value));
            let note = if over.is_finite() { format!("{} stops", signed_hundredths(over)) } else { "dark".to_owned() };
            cells.push(LessonCell { caption: name.to_owned(), note: note + &ratio.unwrap_or_default(), scene });
        }
        let about = "The same lights at the same power. Stops at the subject against the room of the plan.".to_owned();
        Ok(self.lesson("Colour of the room", about, 3, cells))
    }

    fn lesson(&self, title: &str, about: String, columns: usize, cells: Vec<LessonCell>) -> Lesson {
        let name = self.scene.title();
        let title = if name.is_empty() { title.to_owned() } else { format!("{title} \u{2013} {name}") };
        Lesson { title, about, columns, cells }
    }

    /// Returns the lighting pattern on the first face in view; empty without one.
    fn pattern(&self, scene: &Scene) -> Result<String, LessonError> {
        let faces = faces_in_view(scene);
        let first = &faces[..faces.len().min(1)];
        let faces = check_patterns(scene, self.assets, first, &self.face_cache, self.control)?;
        let faces = faces.ok_or(LessonError::Cancelled)?;
        Ok(match faces.first().map(|face| &face.lighting) {
            Some(FaceLighting::Key { found: Some(found), .. }) => format!("{} lighting", found.pattern.label()),
            Some(FaceLighting::Unlit) => "not on the face".to_owned(),
            Some(FaceLighting::Key { found: None, .. } | FaceLighting::NoKey | FaceLighting::Covered) | None => {
                String::new()
            }
        })
    }

    /// Returns the note of a light that is exposed for the camera: its dial.
    fn exposed_note(&self, scene: &Scene) -> String {
        let number = nearest_third(scene.camera.f_number);
        let Some(light) = scene.lights.iter().find(|light| light.on) else { return number };
        match light.power.dial_stops {
            stops if stops > 0.0 => format!("{number} takes {stops:.1} stops more than full power"),
            stops => format!("{number} at {}", light_dial_text(light, stops)),
        }
    }

    /// Returns how far from the subject a light fits in a direction, metres.
    fn fitting_m(&self, subject: Vec3, away: Vec3) -> f32 {
        let Some(room) = &self.scene.room else { return f32::INFINITY };
        let half = 0.5 * room.size_m;
        let (low, high) =
            (Vec3::new(-half.x, 0.0, -half.z) + MARGIN_M, Vec3::new(half.x, room.size_m.y, half.z) - MARGIN_M);
        let reach = |axis: usize| match away[axis] {
            way if way > 1e-6 => (high[axis] - subject[axis]) / way,
            way if way < -1e-6 => (low[axis] - subject[axis]) / way,
            _ => f32::INFINITY,
        };
        (0..3).map(reach).fold(f32::INFINITY, f32::min)
    }
}
