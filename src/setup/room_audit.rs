//! The part of the light on the subject that comes by the surfaces of the room, and what another ceiling would change.
//!
//! The studio is metered as it is, and with each surface black. The difference is the light of all paths that touch that
//! surface.

use super::metering::MeteredSetup;
use crate::math::mean;
use crate::photo::meter::Reading;
use crate::raytrace::{GeometryCache, LightMeter, MeterEffort, MeterPoint, PrepareError, RenderControl};
use crate::scene::{Assets, Material, Role, Room, Scene};
use std::collections::BTreeMap;

/// Albedo of white emulsion paint, typical.
const WHITE: f32 = 0.85;

/// A kind of surface that returns light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RoomSurface {
    /// The walls of the room.
    Walls,
    /// The ceiling.
    Ceiling,
    /// The floor of the room.
    Floor,
    /// Backdrops: sweeps, and planes such as paper, reflector panels and V-flats.
    Backdrops,
}

impl RoomSurface {
    /// All surfaces, in the order of a table.
    pub const ALL: [RoomSurface; 4] =
        [RoomSurface::Walls, RoomSurface::Ceiling, RoomSurface::Floor, RoomSurface::Backdrops];

    /// Returns its name.
    pub fn label(self) -> &'static str {
        match self {
            RoomSurface::Walls => "Walls",
            RoomSurface::Ceiling => "Ceiling",
            RoomSurface::Floor => "Floor",
            RoomSurface::Backdrops => "Backdrops, panels",
        }
    }

    /// Returns true if the studio has such a surface.
    fn is_in(self, scene: &Scene) -> bool {
        match self {
            RoomSurface::Backdrops => scene.objects.iter().any(|object| object.visible && object.shape.is_sheet()),
            _ => scene.room.is_some(),
        }
    }

    /// Returns the studio with another material on the surface.
    fn painted(self, scene: &Scene, material: &Material) -> Scene {
        let mut painted = scene.clone();
        if let (RoomSurface::Walls | RoomSurface::Ceiling | RoomSurface::Floor, Some(room)) = (self, &mut painted.room)
        {
            let Room { size_m: _, floor, walls, ceiling } = room;
            let surface = match self {
                RoomSurface::Ceiling => ceiling,
                RoomSurface::Floor => floor,
                _ => walls,
            };
            *surface = material.clone();
        }
        if self == RoomSurface::Backdrops {
            for object in painted.objects.iter_mut().filter(|object| object.shape.is_sheet()) {
                object.material = material.clone();
                object.part_materials.clear();
            }
        }
        painted
    }
}

fn matte(albedo: f32) -> Material {
    Material { base_color: [albedo; 3], ior: 1.0, ..Material::default() }
}

/// The exposure that one light, or all of them, gives the subject.
#[derive(Clone, Debug, PartialEq)]
pub struct AuditedLight {
    /// Its name.
    pub name: String,
    /// Its role.
    pub role: Option<Role>,
    /// Exposure of the subject, lux s.
    pub lux_s: f32,
    /// Exposure without the light that comes by a surface, lux s.
    pub without_lux_s: BTreeMap<RoomSurface, f32>,
    /// Exposure of the background, lux s; none without a background.
    pub background_lux_s: Option<f32>,
}

impl AuditedLight {
    /// Returns the stops that a surface adds at the subject; infinite if all light comes by it, none if the studio has no
    /// such surface, or if no light arrives.
    pub fn added_stops(&self, surface: RoomSurface) -> Option<f32> {
        let without = *self.without_lux_s.get(&surface)?;
        (self.lux_s > 0.0).then(|| (self.lux_s / without.max(0.0)).log2().max(0.0))
    }

    /// Returns the part of its light on the subject that comes by a surface, 0 to 1; 0 without light or surface.
    pub fn part(&self, surface: RoomSurface) -> f32 {
        let without = self.without_lux_s.get(&surface).copied().unwrap_or(self.lux_s);
        if self.lux_s > 0.0 { (1.0 - without / self.lux_s).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// A ceiling of another colour.
#[derive(Clone, Debug, PartialEq)]
pub struct CeilingTrial {
    /// `black` or `white`.
    pub color: &'static str,
    /// Change of the exposure of the subject, stops; none if no light is left.
    pub stops: Option<f32>,
    /// The key:fill ratio with it, to 1; none without key or fill.
    pub key_to_fill: Option<f32>,
}

/// What the room does to the light.
#[derive(Clone, Debug, PartialEq)]
pub struct RoomAudit {
    /// The lights that are on, then glowing surfaces if there are any.
    pub lights: Vec<AuditedLight>,
    /// All of them.
    pub total: AuditedLight,
    /// Exposure of the key at the subject, lux s; 0 without light.
    pub key_lux_s: f32,
    /// The key:fill ratio, to 1; none without key or fill.
    pub key_to_fill: Option<f32>,
    /// Other ceilings; none without a room.
    pub ceilings: Vec<CeilingTrial>,
    /// Names of lights that shine at the lens.
    pub flaring: Vec<String>,
}

impl RoomAudit {
    /// Returns the exposure of the background by a light over that of the key at the subject, stops; none without a
    /// background or without light.
    pub fn background_stops(&self, light: &AuditedLight) -> Option<f32> {
        light.background_lux_s.map(|lux_s| (lux_s / self.key_lux_s).log2()).filter(|stops| stops.is_finite())
    }

    /// Meters a studio with each of its surfaces and without. None once `control` is cancelled.
    ///
    /// # Errors
    /// If the scene has errors.
    pub fn measure(
        scene: &Scene,
        assets: &Assets,
        cache: &GeometryCache,
        control: &RenderControl,
    ) -> Result<Option<Self>, PrepareError> {
        let Some(setup) = MeteredSetup::new(scene, assets, cache, control)? else { return Ok(None) };
        let Some(background) = setup.read_background(control) else { return Ok(None) };
        let read = |scene: &Scene| read_at(scene, assets, &setup.held, cache, control);
        let mut without = BTreeMap::new();
        for surface in RoomSurface::ALL.into_iter().filter(|surface| surface.is_in(scene)) {
            let Some(reading) = read(&surface.painted(scene, &matte(0.0)))? else { return Ok(None) };
            without.insert(surface, reading);
        }
        let mut ceilings = Vec::new();
        if let Some(black) = without.get(&RoomSurface::Ceiling) {
            let Some(white) = read(&RoomSurface::Ceiling.painted(scene, &matte(WHITE)))? else { return Ok(None) };
            for (color, reading) in [("black", black), ("white", &white)] {
                let stops = (reading.total_lux_s() / setup.reading.total_lux_s()).log2();
                let stops = Some(stops).filter(|stops| stops.is_finite());
                ceilings.push(CeilingTrial { color, stops, key_to_fill: key_to_fill(reading) });
            }
        }
        let audited = |index: Option<usize>| {
            let lux_s = |reading: &Reading| match index {
                Some(index) => reading.lights.get(index).map_or(0.0, |light| reading.lux_s(light)),
                None => reading.total_lux_s(),
            };
            let light = index.and_then(|index| setup.reading.lights.get(index));
            let behind: Vec<f32> = background.iter().map(|(_, reading)| lux_s(reading)).collect();
            let error = |reading: &Reading| match index {
                Some(index) => reading.lights.get(index).map_or(0.0, |light| reading.error_lux_s(light)),
                None => reading.relative_error().unwrap_or(0.0) * reading.total_lux_s(),
            };
            // A difference that may be noise counts as none
            let without_lux_s = |reading: &Reading| {
                let (all, without) = (lux_s(&setup.reading), lux_s(reading));
                let noise = 2.0 * error(&setup.reading).hypot(error(reading));
                if (all - without).abs() < noise { all } else { without }
            };
            AuditedLight {
                name: light.map_or("All light", |light| &light.name).to_owned(),
                role: light.and_then(|light| light.role),
                lux_s: lux_s(&setup.reading),
                without_lux_s: without.iter().map(|(surface, reading)| (*surface, without_lux_s(reading))).collect(),
                background_lux_s: (!behind.is_empty()).then(|| mean(&behind)),
            }
        };
        let audit = RoomAudit {
            lights: (0..setup.reading.lights.len()).map(|index| audited(Some(index))).collect(),
            total: audited(None),
            key_lux_s: setup.reading.key().map_or(0.0, |key| setup.reading.lux_s(key)),
            key_to_fill: key_to_fill(&setup.reading),
            ceilings,
            flaring: setup.flaring_lights().map(|light| light.name.clone()).collect(),
        };
        Ok((!control.is_cancelled()).then_some(audit))
    }
}

fn read_at(
    scene: &Scene,
    assets: &Assets,
    point: &MeterPoint,
    cache: &GeometryCache,
    control: &RenderControl,
) -> Result<Option<Reading>, PrepareError> {
    let meter = LightMeter::kept(scene, assets, point.position, cache)?;
    Ok(meter.read(point, &MeterEffort::default(), control).map(|result| result.reading))
}

fn key_to_fill(reading: &Reading) -> Option<f32> {
    reading.ratios().map(|[key_to_fill, _]| key_to_fill.value)
}
