//! Readings of a set-up: at the subject, where lights aim at something else, and on the background.

use crate::photo::exposure;
use crate::photo::meter::{Reading, Receptor};
use crate::raytrace::{GeometryCache, LightMeter, MeterEffort, MeterPoint, PrepareError, RenderControl, SurfacePoint};
use crate::scene::{Aim, Assets, CameraFrame, Emitter, Light, LightId, Object, Role, Scene, Shape};
use glam::{Vec2, Vec3};

/// Distance from the subject from which a light aims at something else, metres.
const APART_M: f32 = 0.75;
/// Distance behind the camera's aim in which a surface is the subject, metres.
const NEAR_M: f32 = 0.15;
/// Distance from a surface at which a photographer holds a dome: out of the shadow of a nose, metres.
const HELD_M: f32 = 0.03;
/// Longest distance at which a background is searched for, metres.
const FARTHEST_M: f32 = 100.0;
/// Most surfaces that are skipped before a background.
const MOST_SURFACES: u32 = 64;
/// Sine of the angle behind the meter's plane from which a light is a rim light: 15 degrees.
const BEHIND: f32 = 0.26;
/// Edge from which a thing can be a background, metres.
const LARGE_M: f32 = 1.0;
/// Columns and rows of points of the picture at which the background is looked for, and the cosine to straight up from
/// which a surface is a floor.
const BACKGROUND_GRID: [u32; 2] = [5, 3];
const FLOOR: f32 = 0.7;
/// Step from a surface to either side, metres.
const STEP_M: f32 = 1e-3;

/// The place at which a light is metered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeteredAt {
    /// At the subject.
    Subject,
    /// On the subject's back, with the meter turned to the light: hair and rim lights.
    Rim,
    /// On what it aims at, which is not the subject: background lights.
    Aim,
}

/// The exposure of a light by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightExposure {
    /// Luminous exposure, lux seconds.
    pub lux_s: f32,
    /// The f-number to set for it, at the camera's ISO and shutter.
    pub f_number: f32,
}

impl LightExposure {
    /// Returns the exposure over another one, stops.
    pub fn stops_over(&self, other: &LightExposure) -> f32 {
        (self.lux_s / other.lux_s).log2()
    }
}

/// The background behind the subject, as seen by the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Background {
    /// Its name.
    pub name: String,
    /// Its distance from the subject, metres.
    pub distance_m: f32,
}

/// A studio with a light meter at its subject.
#[derive(Debug)]
pub struct MeteredSetup<'a> {
    /// The studio.
    pub scene: &'a Scene,
    /// The subject: the place of the studio's own meter, or what is before the camera's aim.
    pub subject: MeterPoint,
    /// The meter as it is held: at the studio's own place, or a dome just before the subject.
    pub held: MeterPoint,
    /// The reading there.
    pub reading: Reading,
    frame: CameraFrame,
    meter: LightMeter,
}

impl<'a> MeteredSetup<'a> {
    /// Reads the meter at the subject. None once `control` is cancelled.
    ///
    /// # Errors
    /// If the scene has errors.
    pub fn new(
        scene: &'a Scene,
        assets: &Assets,
        cache: &GeometryCache,
        control: &RenderControl,
    ) -> Result<Option<Self>, PrepareError> {
        let camera = &scene.camera;
        let aim = scene.aim_point(&camera.aim, camera.position);
        let around = scene.meter.map_or(aim, |meter| meter.position);
        let meter = LightMeter::kept(scene, assets, around, cache)?;
        let subject = match scene.meter {
            Some(own) => MeterPoint { position: own.position, facing: own.direction(scene), receptor: own.receptor },
            None => subject_of_camera(scene, &meter, aim),
        };
        let frame = scene.camera_frame(camera.aspect());
        let out_m = if scene.meter.is_some() { 0.0 } else { HELD_M };
        let held = MeterPoint { position: subject.position + subject.facing * out_m, ..subject };
        let read = meter.read(&held, &MeterEffort::default(), control);
        Ok(read.map(|result| MeteredSetup { scene, subject, held, reading: result.reading, frame, meter }))
    }

    /// Returns the point that a light aims at: the first surface there for a light that is aimed by angles. None if
    /// there is none, and for lights that shine in all directions or from afar.
    pub fn aim_of(&self, light: &Light) -> Option<Vec3> {
        match light.emitter {
            Emitter::Point | Emitter::Sphere { .. } if light.photometric_file.is_none() => None,
            Emitter::Sun { .. } | Emitter::Surround => None,
            _ => match light.aim {
                Aim::Angles { .. } => self.first_on_axis(light).map(|surface| surface.position),
                Aim::Point(_) | Aim::Object { .. } => Some(self.scene.aim_point(&light.aim, light.position)),
            },
        }
    }

    fn axis(&self, light: &Light) -> Option<Vec3> {
        self.scene.aim_vector(&light.aim, light.position).try_normalize()
    }

    fn first_on_axis(&self, light: &Light) -> Option<SurfacePoint<'_>> {
        self.meter.first_surface(light.position, self.axis(light)?, FARTHEST_M)
    }

    /// Returns true if a light aims at something else than the subject: its way to its aim does not come near.
    fn aims_elsewhere(&self, light: &Light) -> bool {
        let Some(aim) = self.aim_of(light) else { return false };
        let (way, away) = (aim - light.position, self.subject.position - light.position);
        let along = away.dot(way) / way.length_squared().max(f32::MIN_POSITIVE);
        along <= 0.0 || (away - way * along.min(1.0)).length() > APART_M
    }

    /// Returns the place at which a light is metered. A key light is never a rim light: the others are compared with
    /// it.
    pub fn metered_at(&self, light: &Light) -> MeteredAt {
        let to_light = (light.position - self.subject.position).normalize_or_zero();
        let from_behind = to_light.dot(self.subject.facing) < -BEHIND && !light.emitter.is_infinite();
        // A feathered key or a bounced fill is still for the subject
        let elsewhere = self.aims_elsewhere(light) && !matches!(light.role, Role::Key | Role::Fill);
        match (elsewhere, from_behind && light.role != Role::Key) {
            (true, _) => MeteredAt::Aim,
            (false, true) => MeteredAt::Rim,
            (false, false) => MeteredAt::Subject,
        }
    }

    /// Returns the exposure that a light gives at a place; none if it is off, or if no light of it arrives.
    pub fn exposure(&self, light: &Light, at: MeteredAt, control: &RenderControl) -> Option<LightExposure> {
        if at == MeteredAt::Subject || !light.on {
            return exposure_in(&self.reading, self.scene, light.id);
        }
        let (position, facing) = match at {
            MeteredAt::Aim => self.first_on_axis(light).map(|surface| (surface.position, surface.normal))?,
            MeteredAt::Subject | MeteredAt::Rim => self.rim_of(light),
        };
        exposure_in(&self.read_flat(position, facing, control)?, self.scene, light.id)
    }

    /// Returns the first point of the subject that a light from behind hits, along its axis or else on the way to the
    /// meter, and the direction from there to the light.
    fn rim_of(&self, light: &Light) -> (Vec3, Vec3) {
        let way = self.subject.position - light.position;
        let straight = way.normalize_or(Vec3::NEG_Y);
        let hit = |direction: Vec3| {
            let surface = self.meter.first_surface(light.position, direction, way.length() + APART_M)?;
            let is_near = (surface.position - self.subject.position).length() < APART_M;
            is_near.then_some((surface.position, -direction))
        };
        let on_axis = self.aim_of(light).and_then(|_| self.axis(light)).and_then(hit);
        on_axis.or_else(|| hit(straight)).unwrap_or((self.subject.position, -straight))
    }

    /// Returns the first backdrop, wall or large thing behind the subject, at the height of the subject.
    pub fn background(&self) -> Option<Background> {
        let surface = self.background_surface()?;
        let name = self.object_of(&surface).map_or_else(|| "Wall".to_owned(), |object| object.name.clone());
        let away = (self.subject.position - self.scene.camera.position).with_y(0.0).normalize_or_zero();
        Some(Background { name, distance_m: (surface.position - self.subject.position).dot(away) })
    }

    /// Returns points of the background that the picture shows, spread over it; the point behind the subject if it shows
    /// none. Empty without a background.
    fn background_points(&self) -> Vec<SurfacePoint<'_>> {
        let Some(behind) = self.background_surface() else { return Vec::new() };
        let (camera, forward) = (self.frame.position(), self.frame.forward());
        let subject_m = (self.subject.position - camera).dot(forward);
        let [columns, rows] = BACKGROUND_GRID;
        let seen = (0..columns * rows).filter_map(|cell| {
            let (column, row) = (cell % columns, cell / columns);
            let point = (Vec2::new(column as f32, row as f32) + 0.5) / Vec2::new(columns as f32, rows as f32);
            self.meter.first_surface(camera, self.frame.direction(point).normalize(), FARTHEST_M)
        });
        let is_background = |surface: &SurfacePoint<'_>| {
            surface.object == behind.object
                && surface.part == behind.part
                && surface.normal.y < FLOOR
                && (surface.position - camera).dot(forward) > subject_m
        };
        let points: Vec<_> = seen.filter(is_background).collect();
        if points.is_empty() { vec![behind] } else { points }
    }

    /// Reads a flat receptor at each of the points of the background. None once cancelled.
    pub fn read_background(&self, control: &RenderControl) -> Option<Vec<(SurfacePoint<'_>, Reading)>> {
        let points = self.background_points().into_iter();
        points.map(|point| Some((point, self.read_flat(point.position, point.normal, control)?))).collect()
    }

    /// Reads a flat receptor on a surface. None once cancelled.
    fn read_flat(&self, position: Vec3, normal: Vec3, control: &RenderControl) -> Option<Reading> {
        let position = position + normal * STEP_M;
        let point = MeterPoint { position, facing: normal, receptor: Receptor::Flat };
        Some(self.meter.read(&point, &MeterEffort::quick(), control)?.reading)
    }

    /// Returns the base colour of a surface, linear; that of the material alone where it has a texture.
    pub fn base_color(&self, surface: &SurfacePoint<'_>) -> [f32; 3] {
        let room = || self.scene.room.as_ref().map(|room| room.material_of(surface.part));
        let material = self.object_of(surface).map(|object| object.material_of(surface.part)).or_else(room);
        material.map_or([0.0; 3], |material| material.base_color)
    }

    fn object_of(&self, surface: &SurfacePoint<'_>) -> Option<&Object> {
        surface.object.and_then(|index| self.scene.objects.get(index as usize))
    }

    /// Returns the point of the background behind the subject.
    fn background_surface(&self) -> Option<SurfacePoint<'_>> {
        let away = self.subject.position - self.scene.camera.position;
        let direction = Vec3::new(away.x, 0.0, away.z).try_normalize()?;
        let reach_m = away.length() + NEAR_M;
        let own = self.meter.first_surface(self.scene.camera.position, away.normalize_or_zero(), reach_m);
        let own = own.and_then(|surface| surface.object);
        let mut origin = self.subject.position;
        for _ in 0..MOST_SURFACES {
            let surface = self.meter.first_surface(origin, direction, FARTHEST_M)?;
            let is_own = surface.object.is_some() && surface.object == own;
            if !is_own && self.object_of(&surface).is_none_or(is_large) {
                return Some(surface);
            }
            origin = surface.position + direction * STEP_M;
        }
        None
    }

    /// Returns true if the camera sees a point: it is in the picture, and nothing is before it.
    pub fn is_seen(&self, point: Vec3) -> bool {
        let in_picture = self.frame.project(point).is_some_and(|p| p.min_element() >= 0.0 && p.max_element() <= 1.0);
        in_picture && self.is_clear(self.frame.position(), point)
    }

    /// Returns true if nothing lies between two points.
    pub fn is_clear(&self, from: Vec3, to: Vec3) -> bool {
        let way = to - from;
        way.try_normalize()
            .is_none_or(|direction| self.meter.first_surface(from, direction, way.length() - STEP_M).is_none())
    }
}

/// Returns true for an object that can be a background: a backdrop, a model, or a thing of a metre or more.
fn is_large(object: &Object) -> bool {
    let scale = object.transform.scale.abs();
    let edge_m = match object.shape {
        Shape::Prop(model) if model.is_backdrop() => f32::INFINITY,
        Shape::Figure(_) | Shape::Prop(_) => 0.0,
        Shape::Plane { .. } | Shape::Sweep { .. } | Shape::MeshFile { .. } => f32::INFINITY,
        Shape::Box { size_m } => (size_m * scale).max_element(),
        Shape::Tank(ref tank) => (tank.size_m() * scale).max_element(),
        Shape::Sphere { radius_m } => 2.0 * radius_m * scale.max_element(),
        Shape::VFlat { wing_m, height_m, .. } => (Vec3::new(wing_m, height_m, wing_m) * scale).max_element(),
        Shape::Cylinder { radius_m, height_m } => {
            (Vec3::new(2.0 * radius_m, height_m, 2.0 * radius_m) * scale).max_element()
        }
    };
    edge_m >= LARGE_M
}

/// Returns the first surface before the camera's aim, facing the camera; the aim itself if there is none near it.
fn subject_of_camera(scene: &Scene, meter: &LightMeter, aim: Vec3) -> MeterPoint {
    let way = aim - scene.camera.position;
    let direction = way.normalize_or(Vec3::NEG_Z);
    // An aim by angles has no distance
    let reach_m = if matches!(scene.camera.aim, Aim::Angles { .. }) { FARTHEST_M } else { way.length() + NEAR_M };
    let surface = meter.first_surface(scene.camera.position, direction, reach_m);
    let position = surface.map_or(aim, |surface| surface.position);
    MeterPoint { position, facing: -direction, receptor: Receptor::Dome }
}

/// Returns the exposure of a light in a reading.
fn exposure_in(reading: &Reading, scene: &Scene, light: LightId) -> Option<LightExposure> {
    let read = reading.lights.iter().find(|read| read.light == Some(light))?;
    let lux_s = reading.lux_s(read);
    (lux_s > 0.0).then(|| LightExposure { lux_s, f_number: exposure::f_number_to_set(scene, lux_s) })
}
