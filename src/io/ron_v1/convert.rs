//! Converts the parts of format 1 to and from those of a scene. Files refer to objects and lights by name, the scene by
//! id.

use super::figure::GazeV1;
use super::head::{head_from, head_to};
use super::mannequin;
use super::names::{LightIds, ObjectIds, UnknownName};
use super::painted_eyes;
use super::{
    AimV1, BarnDoorsV1, CameraV1, ColorV1, ConeV1, EmitterV1, FacingV1, FocusV1, GelV1, LightV1, MaterialV1, MeterV1,
    ModifierV1, ObjectV1, OrientationV1, OutputV1, PartMaterialV1, PowerV1, ReceptorV1, RoleV1, RoomV1, SensorV1,
    ShapeV1,
};
use crate::scene::{
    Aim, BarnDoors, Camera, ColorSource, Cone, Emitter, Facing, Focus, Gaze, Gel, Light, LightColor, LightId, Material,
    Meter, Modifier, Object, ObjectId, Orientation, Output, Power, Receptor, Role, Room, Scene, Sensor, Shape,
    Transform,
};
use glam::Vec3;

pub(super) fn camera_from(file: CameraV1, ids: &ObjectIds) -> Result<Camera, UnknownName> {
    Ok(Camera {
        position: Vec3::from(file.position),
        aim: ids.aim(file.aim, "camera.")?,
        roll_deg: file.roll_deg,
        sensor: file.sensor.into(),
        orientation: file.orientation.into(),
        focal_length_mm: file.focal_length_mm,
        f_number: file.f_number,
        shutter_s: file.shutter_s,
        iso: file.iso,
        white_balance_k: file.white_balance_k,
        nd_stops: file.nd_stops,
        focus: ids.focus(file.focus, "camera.")?,
        depth_of_field: file.depth_of_field,
        focus_breathing: file.focus_breathing,
        meter_constant: file.meter_constant,
    })
}

pub(super) fn camera_to(scene: &Scene) -> CameraV1 {
    let camera = &scene.camera;
    CameraV1 {
        position: camera.position.to_array(),
        aim: aim_to(scene, &camera.aim, camera.position),
        roll_deg: camera.roll_deg,
        sensor: camera.sensor.into(),
        orientation: camera.orientation.into(),
        focal_length_mm: camera.focal_length_mm,
        f_number: camera.f_number,
        shutter_s: camera.shutter_s,
        iso: camera.iso,
        white_balance_k: camera.white_balance_k,
        nd_stops: camera.nd_stops,
        focus: focus_to(scene, camera.focus),
        depth_of_field: camera.depth_of_field,
        focus_breathing: camera.focus_breathing,
        meter_constant: camera.meter_constant,
    }
}

pub(super) fn focus_to(scene: &Scene, focus: Focus) -> FocusV1 {
    match focus {
        Focus::OnAim => FocusV1::OnAim,
        Focus::OnObject { object, offset } => scene.object(object).map_or(FocusV1::OnAim, |object| FocusV1::OnObject {
            name: object.name.clone(),
            offset: offset.to_array(),
        }),
        Focus::Distance(distance) => FocusV1::Distance(distance),
    }
}

pub(super) fn aim_to(scene: &Scene, aim: &Aim, position: Vec3) -> AimV1 {
    let point = |p: Vec3| AimV1::Point(p.x, p.y, p.z);
    match *aim {
        Aim::Point(target) => point(target),
        Aim::Object { object, offset } => match scene.object(object) {
            Some(object) => AimV1::Object { name: object.name.clone(), offset: offset.to_array() },
            None => point(scene.aim_point(aim, position)),
        },
        Aim::Angles { yaw_deg, pitch_deg } => AimV1::Angles { yaw_deg, pitch_deg },
    }
}

pub(super) fn object_from(mut file: ObjectV1, index: u32, lights: &LightIds) -> Result<Object, UnknownName> {
    let is_mannequin = matches!(file.shape, ShapeV1::Mannequin { .. });
    let gaze = match &mut file.shape {
        ShapeV1::Figure(person) => person.gaze.take(),
        _ => None,
    };
    let place = format!("objects[{index}] {:?} shape.gaze", file.name);
    let gaze = gaze.map(|gaze| lights.gaze(gaze, &place)).transpose()?;
    let mut object = Object {
        id: ObjectId(index),
        name: file.name,
        transform: Transform {
            position: Vec3::from(file.position),
            rotation_deg: Vec3::from(file.rotation_deg),
            scale: Vec3::from(file.scale),
        },
        shape: file.shape.into(),
        material: file.material.into(),
        part_materials: file.part_materials.into_iter().map(|part| (part.part, part.material.into())).collect(),
        visible: file.visible,
        locked: file.locked,
    };
    if let (Shape::Figure(figure), Some(gaze)) = (&mut object.shape, gaze) {
        figure.gaze = gaze;
    }
    painted_eyes::put_under_cornea(&mut object);
    if is_mannequin {
        mannequin::complete_parts(&mut object);
    }
    Ok(object)
}

/// Returns what a figure's eyes follow; none for the angles of its pose, and for a light that is gone.
fn gaze_to(scene: &Scene, shape: &Shape) -> Option<GazeV1> {
    let Shape::Figure(figure) = shape else { return None };
    match figure.gaze {
        Gaze::Pose => None,
        Gaze::Camera => Some(GazeV1::Camera),
        Gaze::Light(light) => scene.light_of_any_variant(light).map(|light| GazeV1::Light(light.name.clone())),
    }
}

pub(super) fn object_to(scene: &Scene, object: &Object) -> ObjectV1 {
    let part = |(part, material): &(String, Material)| PartMaterialV1 {
        part: part.clone(),
        material: MaterialV1::from(material),
    };
    let mut shape = ShapeV1::from(&object.shape);
    if let ShapeV1::Figure(person) = &mut shape {
        person.gaze = gaze_to(scene, &object.shape);
    }
    ObjectV1 {
        name: object.name.clone(),
        shape,
        position: object.transform.position.to_array(),
        rotation_deg: object.transform.rotation_deg.to_array(),
        scale: object.transform.scale.to_array(),
        material: MaterialV1::from(&object.material),
        part_materials: object.part_materials.iter().map(part).collect(),
        visible: object.visible,
        locked: object.locked,
    }
}

/// Converts a light; `place` is that of its fields.
pub(super) fn light_from(file: LightV1, id: LightId, place: &str, ids: &ObjectIds) -> Result<Light, UnknownName> {
    let gel = file.gel.into();
    Ok(Light {
        id,
        role: file.role.into(),
        position: Vec3::from(file.position),
        aim: ids.aim(file.aim, place)?,
        roll_deg: file.roll_deg,
        emitter: file.emitter.into(),
        photometric_file: file.photometric_file,
        environment_map: file.environment_map,
        modifier: file.modifier.into(),
        head: file.head.map(head_from),
        power: Power { output: file.power.output.into(), dial_stops: file.power.dial_stops },
        color: LightColor {
            source: file.color.into(),
            gel,
            gel_loss_counts: file.gel_loss_counts.unwrap_or(gel == Gel::None),
        },
        on: file.on,
        visible_to_camera: file.visible_to_camera,
        body: file.body.into(),
        muted: file.muted,
        locked: file.locked,
        name: file.name,
    })
}

pub(super) fn light_to(scene: &Scene, light: &Light) -> LightV1 {
    LightV1 {
        name: light.name.clone(),
        role: light.role.into(),
        position: light.position.to_array(),
        aim: aim_to(scene, &light.aim, light.position),
        roll_deg: light.roll_deg,
        emitter: light.emitter.into(),
        photometric_file: light.photometric_file.clone(),
        environment_map: light.environment_map.clone(),
        modifier: light.modifier.into(),
        head: light.head.as_ref().map(head_to),
        power: PowerV1 { output: light.power.output.into(), dial_stops: light.power.dial_stops },
        color: light.color.source.into(),
        gel: light.color.gel.into(),
        gel_loss_counts: Some(light.color.gel_loss_counts).filter(|counts| *counts != (light.color.gel == Gel::None)),
        on: light.on,
        visible_to_camera: light.visible_to_camera,
        body: light.body.into(),
        muted: light.muted,
        locked: light.locked,
    }
}

impl From<ColorV1> for ColorSource {
    fn from(file: ColorV1) -> Self {
        match file {
            ColorV1::Kelvin(kelvin) => ColorSource::Kelvin(kelvin),
            ColorV1::Rgb(r, g, b) => ColorSource::Rgb([r, g, b]),
        }
    }
}

impl From<ColorSource> for ColorV1 {
    fn from(source: ColorSource) -> Self {
        match source {
            ColorSource::Kelvin(kelvin) => ColorV1::Kelvin(kelvin),
            ColorSource::Rgb([r, g, b]) => ColorV1::Rgb(r, g, b),
        }
    }
}

impl From<GelV1> for Gel {
    fn from(file: GelV1) -> Self {
        match file {
            GelV1::NoGel => Gel::None,
            GelV1::Mired(shift) => Gel::Mired(shift),
            GelV1::Tint(r, g, b) => Gel::Tint([r, g, b]),
        }
    }
}

impl From<Gel> for GelV1 {
    fn from(gel: Gel) -> Self {
        match gel {
            Gel::None => GelV1::NoGel,
            Gel::Mired(shift) => GelV1::Mired(shift),
            Gel::Tint([r, g, b]) => GelV1::Tint(r, g, b),
        }
    }
}

impl From<ModifierV1> for Modifier {
    fn from(file: ModifierV1) -> Self {
        let ModifierV1 { loss_stops, scrim_stops, beam, grid_deg, doors } = file;
        let cone = |ConeV1 { inner_deg, outer_deg }| Cone { inner_deg, outer_deg };
        let flaps = |BarnDoorsV1 { left_deg, right_deg, top_deg, bottom_deg }| BarnDoors {
            left_deg,
            right_deg,
            top_deg,
            bottom_deg,
        };
        Modifier { loss_stops, scrim_stops, beam: beam.map(cone), grid_deg, doors: doors.map(flaps) }
    }
}

impl From<Modifier> for ModifierV1 {
    fn from(modifier: Modifier) -> Self {
        let Modifier { loss_stops, scrim_stops, beam, grid_deg, doors } = modifier;
        let cone = |Cone { inner_deg, outer_deg }| ConeV1 { inner_deg, outer_deg };
        let flaps = |BarnDoors { left_deg, right_deg, top_deg, bottom_deg }| BarnDoorsV1 {
            left_deg,
            right_deg,
            top_deg,
            bottom_deg,
        };
        ModifierV1 { loss_stops, scrim_stops, beam: beam.map(cone), grid_deg, doors: doors.map(flaps) }
    }
}

impl From<MeterV1> for Meter {
    fn from(MeterV1 { position, facing, receptor }: MeterV1) -> Self {
        Meter { position: Vec3::from(position), facing: facing.into(), receptor: receptor.into() }
    }
}

impl From<Meter> for MeterV1 {
    fn from(Meter { position, facing, receptor }: Meter) -> Self {
        MeterV1 { position: position.to_array(), facing: facing.into(), receptor: receptor.into() }
    }
}

impl From<RoomV1> for Room {
    fn from(file: RoomV1) -> Self {
        Room {
            size_m: Vec3::from(file.size_m),
            floor: file.floor.into(),
            walls: file.walls.into(),
            ceiling: file.ceiling.into(),
        }
    }
}

impl From<&Room> for RoomV1 {
    fn from(room: &Room) -> Self {
        RoomV1 {
            size_m: room.size_m.to_array(),
            floor: MaterialV1::from(&room.floor),
            walls: MaterialV1::from(&room.walls),
            ceiling: MaterialV1::from(&room.ceiling),
        }
    }
}

same_variants!(OrientationV1 <=> Orientation { Landscape, Portrait });
same_variants!(RoleV1 <=> Role { Key, Fill, Rim, Hair, Background, Accent });
same_variants!(SensorV1 <=> Sensor {
    FullFrame, ApsC, MicroFourThirds, Medium44x33, Medium54x40, Custom { width_mm, height_mm },
});
same_variants!(EmitterV1 <=> Emitter {
    Point, Sphere { radius_m }, Spot { inner_deg, outer_deg }, RectPanel { width_m, height_m },
    RoundPanel { diameter_m }, Sun { angular_diameter_deg }, Surround,
});
same_variants!(OutputV1 <=> Output {
    Lumens(lm), Candela(cd), LuxAt { lux, distance_m }, Lux(lux), FlashWs { energy_ws, efficacy_lm_s_per_ws },
    FlashGuideNumber(gn),
});
same_variants!(FacingV1 <=> Facing { Camera, Angles { yaw_deg, pitch_deg } });
same_variants!(ReceptorV1 <=> Receptor { Flat, Dome });
