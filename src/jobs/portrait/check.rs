//! The pattern check of a scene's figures.

use super::catchlights::{Catchlight, find_catchlights};
use super::face_lighting::{FaceLighting, KeyPlace, Modelling};
use super::face_scan::FaceScan;
use super::key_light::{find_key, map_face};
use crate::figures::{eye_point, face_direction};
use crate::photo::portrait_pattern::find_pattern;
use crate::raytrace::{GeometryCache, LightMeter, PrepareError, RenderControl};
use crate::scene::{Assets, Figure, Object, ObjectId, Scene, Shape};
use glam::{Affine3A, Vec2, Vec3};

/// Strands of the face. They are left out: a pattern is a matter of the face's form.
const FACE_HAIR: [&str; 3] = ["beard", "brows", "lashes"];
/// Part of the direct light on a face that a key light gives at least.
const KEY_PART: f32 = 0.5;

/// The light on the face and in the eyes of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// The figure.
    pub object: ObjectId,
    /// Its lighting.
    pub lighting: FaceLighting,
    /// The lights that are reflected in its eyes.
    pub catchlights: Vec<Catchlight>,
}

impl Face {
    /// Returns where the catchlights are, in words.
    pub fn catchlight_line(&self) -> String {
        let places: Vec<String> = self.catchlights.iter().map(Catchlight::to_string).collect();
        if places.is_empty() { "none".to_owned() } else { places.join(", ") }
    }
}

/// Returns the visible figures whose eyes are in the camera's picture and whose faces are turned to it by less than 90
/// degrees.
pub fn faces_in_view(scene: &Scene) -> Vec<ObjectId> {
    let frame = scene.camera_frame(scene.camera.aspect());
    let is_in_view = |object: &&Object| {
        let Shape::Figure(figure) = &object.shape else { return false };
        let world_from_object = object.transform.world_from_object();
        let eyes = world_from_object.transform_point3(eye_point(figure));
        let ahead = world_from_object.transform_vector3(face_direction(figure));
        let is_in_picture = |p: Vec2| p.cmpge(Vec2::ZERO).all() && p.cmple(Vec2::ONE).all();
        object.visible && ahead.dot(frame.position() - eyes) > 0.0 && frame.project(eyes).is_some_and(is_in_picture)
    };
    scene.objects.iter().filter(is_in_view).map(|object| object.id).collect()
}

/// Checks the pattern on the faces of some figures. Objects that are no figures are left out. None if cancelled.
///
/// # Errors
/// When the scene cannot be prepared.
pub fn check_patterns(
    scene: &Scene,
    assets: &Assets,
    figures: &[ObjectId],
    cache: &GeometryCache,
    control: &RenderControl,
) -> Result<Option<Vec<Face>>, PrepareError> {
    let named = || scene.objects.iter().enumerate().filter(|(_, object)| figures.contains(&object.id));
    let Some(first) = named().find_map(|(_, object)| eyes_of(object)) else { return Ok(Some(Vec::new())) };
    // The face is read without its hair, on the coarse mesh
    let shaved = assets.clone().map_figures(|meshes| meshes.coarse_with_strands(|part| !FACE_HAIR.contains(&part)));
    let meter = LightMeter::kept(scene, &shaved, first, cache)?;
    let mut faces = Vec::new();
    for (index, object) in named() {
        if control.is_cancelled() {
            return Ok(None);
        }
        let Shape::Figure(figure) = &object.shape else { continue };
        let lighting = face_lighting(scene, &meter, index as u32, object, figure);
        let catchlights = find_catchlights(scene, &meter, object, figure);
        faces.push(Face { object: object.id, lighting, catchlights });
    }
    Ok(Some(faces))
}

/// Returns the point between a figure's eyes, world space.
fn eyes_of(object: &Object) -> Option<Vec3> {
    let Shape::Figure(figure) = &object.shape else { return None };
    Some(object.transform.world_from_object().transform_point3(eye_point(figure)))
}

fn face_lighting(scene: &Scene, meter: &LightMeter, index: u32, object: &Object, figure: &Figure) -> FaceLighting {
    let Some(scan) = FaceScan::new(meter, index, object, figure) else { return FaceLighting::Covered };
    let Some(key) = find_key(meter, &scan) else { return FaceLighting::Unlit };
    if key.part < KEY_PART {
        return FaceLighting::NoKey;
    }
    // Angles in the frame of the head
    let eyes = Vec3::from(scan.world_from_head.translation);
    let (camera_left_deg, _) = angles(&scan.world_from_head, scene.camera.position - eyes);
    let light = meter.sources().nth(key.source).and_then(|source| scene.light(source.light));
    let direction = meter.direction_to(key.source, eyes).unwrap_or(Vec3::ZERO);
    let (left_deg, above_deg) = angles(&scan.world_from_head, direction);
    let found = find_pattern(&map_face(meter, &scan, key.source, above_deg));
    let name = light.map(|light| light.name.clone()).unwrap_or_default();
    FaceLighting::Key {
        found,
        modelling: found.and_then(|found| Modelling::of(found, camera_left_deg)),
        key: KeyPlace { name, left_deg, above_deg },
    }
}

/// Returns the angles of a direction to the person's left of the face's direction, and above the eyes, degrees.
fn angles(world_from_head: &Affine3A, direction: Vec3) -> (f32, f32) {
    let local = world_from_head.inverse().transform_vector3(direction);
    (local.x.atan2(local.z).to_degrees(), local.y.atan2(local.x.hypot(local.z)).to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Loaded, find_preset};
    use crate::jobs::read_meter;
    use crate::photo::meter::Receptor;
    use crate::photo::portrait_pattern::{FaceSide, FoundPattern, PortraitPattern};
    use crate::raytrace::{MeterEffort, MeterPoint, MeterResult};

    fn studio(name: &str) -> Loaded {
        find_preset(name).unwrap().load().unwrap()
    }

    fn lighting(studio: &Loaded) -> FaceLighting {
        let figures = faces_in_view(&studio.scene);
        let faces =
            check_patterns(&studio.scene, &studio.assets, &figures, &GeometryCache::default(), &RenderControl::new());
        faces.unwrap().unwrap().remove(0).lighting
    }

    fn found(studio: &Loaded) -> Option<(PortraitPattern, Option<FaceSide>)> {
        let FaceLighting::Key { found, .. } = lighting(studio) else { panic!("{:?}", lighting(studio)) };
        found.map(|FoundPattern { pattern, lit_side }| (pattern, lit_side))
    }

    #[test]
    fn a_light_that_moves_is_checked_and_metered_without_a_new_tree() {
        let mut studio = studio("split");
        let figures = faces_in_view(&studio.scene);
        let cache = GeometryCache::default();
        let point = MeterPoint { position: Vec3::new(0.0, 1.6, 0.4), facing: Vec3::X, receptor: Receptor::Flat };
        let mut read = |x: f32| {
            studio.scene.lights[0].position.x = x;
            let (scene, assets, control) = (&studio.scene, &studio.assets, RenderControl::new());
            let mut key_lux = 0.0;
            let mut observe = |result: MeterResult| key_lux = result.reading.lights[0].direct;
            read_meter(scene, assets, &point, &[MeterEffort::quick()], &cache, &control, &mut observe).unwrap();
            let faces = check_patterns(scene, assets, &figures, &cache, &control).unwrap().unwrap();
            let FaceLighting::Key { key, .. } = &faces[0].lighting else { panic!("{:?}", faces[0].lighting) };
            (key_lux, key.left_deg, cache.builds())
        };
        let (near, far) = (read(1.5), read(2.5));
        assert!(near.2 > 0 && near.2 == far.2, "{near:?}, {far:?}");
        assert!(near.0 > far.0 && near.1 != far.1, "{near:?}, {far:?}");
    }

    #[test]
    fn the_shipped_studios_show_the_patterns_of_their_names() {
        for (name, pattern) in [
            ("rembrandt", PortraitPattern::Rembrandt),
            ("butterfly", PortraitPattern::Butterfly),
            ("clamshell", PortraitPattern::Butterfly),
            ("loop", PortraitPattern::Loop),
            ("split", PortraitPattern::Split),
        ] {
            assert_eq!(found(&studio(name)).map(|found| found.0), Some(pattern), "{name}");
        }
        // Two strips from behind outline the head: half a face is not lit.
        assert_eq!(found(&studio("rim_low_key")), None);
        let still_life = studio("product_still_life");
        assert_eq!(faces_in_view(&still_life.scene), []);
    }

    fn catchlights(studio: &Loaded) -> Vec<Catchlight> {
        let figures = faces_in_view(&studio.scene);
        let faces =
            check_patterns(&studio.scene, &studio.assets, &figures, &GeometryCache::default(), &RenderControl::new());
        faces.unwrap().unwrap().remove(0).catchlights
    }

    #[test]
    fn the_catchlights_of_a_clamshell_are_above_and_below_the_pupil() {
        let found = catchlights(&studio("clamshell"));
        let heights: Vec<f32> = found.iter().map(|light| light.place.y).collect();
        assert!(found.len() == 2 && heights[0] > 0.1 && heights[1] < -0.1, "{found:?}");
    }

    #[test]
    fn catchlights_are_where_the_key_is() {
        let mut portrait = studio("clamshell");
        portrait.scene.lights.truncate(1);
        let eyes = eyes_of(&portrait.scene.objects[0]).unwrap();
        let frame = portrait.scene.camera_frame(1.0);
        for (right, up, half_hours) in [(0.0, 0.5, 0), (-0.4, 0.4, 21), (0.5, 0.0, 6), (0.0, -0.5, 12)] {
            let beside = frame.world_from_camera.transform_vector3(Vec3::new(right, up, 0.0));
            portrait.scene.lights[0].position = frame.position().lerp(eyes, 0.2) + beside;
            portrait.scene.lights[0].aim = crate::scene::Aim::Point(eyes);
            if let Shape::Figure(figure) = &mut portrait.scene.objects[0].shape {
                figure.gaze = crate::scene::Gaze::Camera;
            }
            crate::figures::follow_gazes(&mut portrait.scene);
            crate::io::load_assets(&portrait.scene, None, &mut portrait.assets);
            let found: Vec<Option<u32>> = catchlights(&portrait).iter().map(Catchlight::half_hours).collect();
            assert_eq!(found, [Some(half_hours)], "{right} {up}");
        }
        // From behind the head there are none
        portrait.scene.lights[0].position = eyes + (eyes - frame.position());
        assert_eq!(catchlights(&portrait), []);
    }

    /// Moves the key, a small source, to angles from the face of the Rembrandt studio's man.
    fn key_at(studio: &mut Loaded, left_deg: f32, above_deg: f32) {
        let eyes = eyes_of(&studio.scene.objects[0]).unwrap();
        let (sin, cos) = left_deg.to_radians().sin_cos();
        let (up, level) = above_deg.to_radians().sin_cos();
        studio.scene.lights[0].position = eyes + Vec3::new(sin * level, up, cos * level) * 1.4;
        studio.scene.lights[0].aim = crate::scene::Aim::Point(eyes);
    }

    #[test]
    fn a_key_that_goes_around_a_face_draws_one_pattern_after_the_other() {
        // The middles of the textbook's ranges of angles.
        let mut studio = studio("rembrandt");
        for (left_deg, above_deg, pattern) in [
            (0.0, 0.0, PortraitPattern::Flat),
            (0.0, 40.0, PortraitPattern::Butterfly),
            (30.0, 35.0, PortraitPattern::Loop),
            (52.0, 43.0, PortraitPattern::Rembrandt),
            (90.0, 0.0, PortraitPattern::Split),
        ] {
            for sign in [1.0, -1.0] {
                key_at(&mut studio, sign * left_deg, above_deg);
                let side = pattern.has_shadow_side().then_some(FaceSide::of(sign));
                assert_eq!(found(&studio), Some((pattern, side)), "{} degrees", sign * left_deg);
            }
        }
        // From below, a face has no pattern.
        key_at(&mut studio, 0.0, -45.0);
        assert_eq!(found(&studio), None);
    }

    #[test]
    fn a_face_that_turns_to_the_key_is_lit_short_and_away_from_it_broad() {
        let mut studio = studio("rembrandt");
        for (turn_deg, expected) in [(30.0, Modelling::Short), (-25.0, Modelling::Broad)] {
            studio.scene.objects[0].transform.rotation_deg.y = turn_deg;
            // The key keeps its angle to the face.
            key_at(&mut studio, 52.0 + turn_deg, 43.0);
            let FaceLighting::Key { found, modelling, key } = lighting(&studio) else { panic!() };
            assert_eq!(found.map(|found| found.pattern), Some(PortraitPattern::Rembrandt));
            assert_eq!(modelling, Some(expected), "turned by {turn_deg} degrees");
            assert!((key.left_deg - 52.0).abs() < 3.0 && (key.above_deg - 43.0).abs() < 3.0, "{key}");
        }
    }

    #[test]
    fn faces_without_a_key_say_so() {
        let mut studio = studio("rembrandt");
        let light = studio.scene.lights[0].clone();
        studio.scene.lights.clear();
        assert_eq!(lighting(&studio), FaceLighting::Unlit);
        for (id, x) in [-1.0, 0.0, 1.0].into_iter().enumerate() {
            let position = Vec3::new(x, 1.7, 2.0);
            let id = crate::scene::LightId(id as u32);
            studio.scene.lights.push(crate::scene::Light { id, position, name: format!("{x}"), ..light.clone() });
        }
        assert_eq!(lighting(&studio), FaceLighting::NoKey);
        studio.scene.objects[0].transform.rotation_deg.y = 180.0;
        assert_eq!(faces_in_view(&studio.scene), [], "the face is turned away");
    }
}
