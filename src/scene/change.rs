//! Compares two scenes field by field and classifies what differs.
//!
//! This is the crate's one statement of what a change of each field makes stale. Every struct is destructured without
//! `..`, so a new field does not compile until it has a class. The users (a finished render, the live traced view, the
//! preview, the background jobs) interpret the classes; they compare no scenes themselves.

use super::{
    Camera, Head, HeadDial, Light, LightBody, LightColor, LightId, Material, Meter, Modifier, Object, Power, Room,
    Scene, Solo, Transform,
};

/// The classes of everything that differs between two scenes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneChange {
    /// Names, the description, the dials of heads, and their t0.1, by which a render compares what moves: nothing to redraw.
    pub labels: bool,
    /// Locks, mute marks, the solo list and the variants that are not shown: nothing to redraw. The switches that they
    /// move are in `lights`.
    pub editing: bool,
    /// Roles of lights: the colours of their gizmos, and which lights share a film layer when there are many.
    pub roles: bool,
    /// The light meter: its reading and its gizmo.
    pub meter: bool,
    /// ISO, meter calibration, ND filter, and the light that the lens loses by its focus: develop again.
    pub exposure: bool,
    /// The f-number: develop again; with depth of field, trace again.
    pub aperture: bool,
    /// The exposure time: develop again; trace again where a film layer has it baked in.
    pub shutter: bool,
    /// The white balance: develop again; trace again where a film layer has it baked in.
    pub white_balance: bool,
    /// Framing, with the field that the focus leaves, and whether there is depth of field: the primary rays.
    pub view: bool,
    /// The plane of focus: trace again with depth of field.
    pub focus: bool,
    /// Shapes, transforms and visibility of objects and of the bodies of lights, and the room's size: prepare geometry.
    pub geometry: bool,
    /// Surfaces: prepare materials and textures.
    pub materials: bool,
    /// The lights whose light differs, in the order of the newer scene; removed ones follow.
    pub lights: Vec<LightChange>,
}

/// The classes of what differs in one light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightChange {
    /// The light.
    pub id: LightId,
    /// True if it was there and on before.
    pub was_on: bool,
    /// True if it is there and on now.
    pub is_on: bool,
    /// True if it is not there any more.
    pub removed: bool,
    /// True if the camera sees the emitter itself, before or after.
    pub visible: bool,
    /// Power, colour, loss or scrim: re-weight the light's layer.
    pub weight: bool,
    /// Place, direction, shape or beam: trace the light again.
    pub transport: bool,
}

impl SceneChange {
    /// Compares two scenes. Lights are matched by id, objects by their place in the list.
    pub fn between(old: &Scene, new: &Scene) -> Self {
        let mut change = SceneChange::default();
        let Scene { name, description, camera, room, objects, lights, bodies: _, meter, solo, variants } = old;
        change.labels |= *name != new.name || *description != new.description;
        change.compare_cameras(camera, &new.camera);
        change.compare_magnifications(old, new);
        match (room, &new.room) {
            (Some(room), Some(new)) => change.compare_rooms(room, new),
            (None, None) => {}
            (Some(_), None) | (None, Some(_)) => change.geometry = true,
        }
        change.geometry |= objects.len() != new.objects.len();
        objects.iter().zip(&new.objects).for_each(|(object, new)| change.compare_objects(object, new));
        change.compare_light_lists(lights, &new.lights);
        change.compare_bodies(old, new);
        match (meter, &new.meter) {
            (Some(meter), Some(new)) => change.compare_meters(meter, new),
            (None, None) => {}
            (Some(_), None) | (None, Some(_)) => change.meter = true,
        }
        match (solo, &new.solo) {
            (Some(solo), Some(new)) => change.compare_solos(solo, new),
            (None, None) => {}
            (Some(_), None) | (None, Some(_)) => change.editing = true,
        }
        change.editing |= *variants != new.variants;
        change
    }

    /// Returns true if some view of the studio shows the change: preview, gizmos, traced view or render.
    pub fn needs_redraw(&self) -> bool {
        self.roles || self.meter || self.view || self.focus || self.needs_surfaces() || self.needs_development()
    }

    /// Returns true if geometry or materials must be prepared again.
    pub fn needs_surfaces(&self) -> bool {
        self.geometry || self.materials
    }

    /// Returns true if a developed picture of the same film differs.
    pub fn needs_development(&self) -> bool {
        self.exposure || self.aperture || self.shutter || self.white_balance || !self.lights.is_empty()
    }

    /// Returns true if the primary rays differ; `depth_of_field` is that of the newer scene.
    pub fn moves_camera_rays(&self, depth_of_field: bool) -> bool {
        self.view || (depth_of_field && (self.focus || self.aperture))
    }

    fn compare_cameras(&mut self, old: &Camera, new: &Camera) {
        let Camera {
            position,
            aim,
            roll_deg,
            sensor,
            orientation,
            focal_length_mm,
            f_number,
            shutter_s,
            iso,
            white_balance_k,
            nd_stops,
            focus,
            depth_of_field,
            focus_breathing,
            meter_constant,
        } = old;
        self.view |= *position != new.position
            || *aim != new.aim
            || *roll_deg != new.roll_deg
            || *sensor != new.sensor
            || *orientation != new.orientation
            || *focal_length_mm != new.focal_length_mm
            || *depth_of_field != new.depth_of_field;
        // Breathing moves a plane of focus that is too near; `compare_magnifications` covers the rest of it.
        self.focus |= *focus != new.focus || *focus_breathing != new.focus_breathing;
        self.aperture |= *f_number != new.f_number;
        self.shutter |= *shutter_s != new.shutter_s;
        self.exposure |= *iso != new.iso || *meter_constant != new.meter_constant || *nd_stops != new.nd_stops;
        self.white_balance |= *white_balance_k != new.white_balance_k;
    }

    /// Compares what focus breathing derives from camera, focus and the object in focus: field and loss of light.
    fn compare_magnifications(&mut self, old: &Scene, new: &Scene) {
        let differs = old.focused_lens().magnification != new.focused_lens().magnification;
        self.view |= differs;
        self.exposure |= differs;
    }

    fn compare_rooms(&mut self, old: &Room, new: &Room) {
        let Room { size_m, floor, walls, ceiling } = old;
        self.geometry |= *size_m != new.size_m;
        self.compare_materials(floor, &new.floor);
        self.compare_materials(walls, &new.walls);
        self.compare_materials(ceiling, &new.ceiling);
    }

    fn compare_objects(&mut self, old: &Object, new: &Object) {
        let Object { id, name, transform, shape, material, part_materials, visible, locked } = old;
        self.labels |= *name != new.name;
        self.editing |= *locked != new.locked;
        self.geometry |= *id != new.id || *shape != new.shape || *visible != new.visible;
        self.compare_transforms(transform, &new.transform);
        self.compare_materials(material, &new.material);
        self.materials |= part_materials.len() != new.part_materials.len();
        for ((part, material), (new_part, new_material)) in part_materials.iter().zip(&new.part_materials) {
            self.materials |= part != new_part;
            self.compare_materials(material, new_material);
        }
    }

    fn compare_transforms(&mut self, old: &Transform, new: &Transform) {
        let Transform { position, rotation_deg, scale } = old;
        self.geometry |= *position != new.position || *rotation_deg != new.rotation_deg || *scale != new.scale;
    }

    fn compare_materials(&mut self, old: &Material, new: &Material) {
        let Material {
            base_color,
            textures,
            metallic,
            roughness,
            ior,
            transmission,
            absorption_per_m,
            subsurface,
            emission_cd_m2,
            fibre,
            alpha,
            clearcoat,
            sheen,
            anisotropy,
            frosting,
            translucency,
        } = old;
        self.materials |= *base_color != new.base_color
            || *textures != new.textures
            || *metallic != new.metallic
            || *roughness != new.roughness
            || *ior != new.ior
            || *transmission != new.transmission
            || *absorption_per_m != new.absorption_per_m
            || *subsurface != new.subsurface
            || *emission_cd_m2 != new.emission_cd_m2
            || *fibre != new.fibre
            || *alpha != new.alpha
            || *clearcoat != new.clearcoat
            || *sheen != new.sheen
            || *anisotropy != new.anisotropy
            || *frosting != new.frosting
            || *translucency != new.translucency;
    }

    fn compare_meters(&mut self, old: &Meter, new: &Meter) {
        let Meter { position, facing, receptor } = old;
        self.meter |= *position != new.position || *facing != new.facing || *receptor != new.receptor;
    }

    fn compare_solos(&mut self, old: &Solo, new: &Solo) {
        let Solo { lights, restores } = old;
        self.editing |= *lights != new.lights || *restores != new.restores;
    }

    /// Compares what a head displays; its output is in the power of the light.
    fn compare_heads(&mut self, old: &Head, new: &Head) {
        let Head { name, dial, sync_s, hss_loss_stops, t01_s } = old;
        let HeadDial { scale, lowest_stops, steps_per_stop } = dial;
        self.labels |= *name != new.name
            || *scale != new.dial.scale
            || *lowest_stops != new.dial.lowest_stops
            || *steps_per_stop != new.dial.steps_per_stop
            || *sync_s != new.sync_s
            || *hss_loss_stops != new.hss_loss_stops
            || *t01_s != new.t01_s;
    }

    fn compare_light_lists(&mut self, old: &[Light], new: &[Light]) {
        for (index, light) in new.iter().enumerate() {
            match find_light(old, index, light.id) {
                Some(other) => self.compare_lights(other, light),
                None => self.lights.push(LightChange::of_added(light)),
            }
        }
        let is_removed = |(index, light): &(usize, &Light)| find_light(new, *index, light.id).is_none();
        let removed = old.iter().enumerate().filter(is_removed);
        self.lights.extend(removed.map(|(_, light)| LightChange::of_removed(light)));
    }

    /// Compares what stands on the set for the lights: modifiers, heads and stands. They are geometry, also of lights
    /// that are off. Of `bodies` and of a light's `body` nothing else depends.
    fn compare_bodies(&mut self, old: &Scene, new: &Scene) {
        let bodies = |scene: &'_ Scene| -> Vec<(LightId, LightBody)> {
            scene.light_bodies().map(|(light, body)| (light.id, body)).collect()
        };
        self.geometry |= bodies(old) != bodies(new);
    }

    fn compare_lights(&mut self, old: &Light, new: &Light) {
        let Light {
            id,
            name,
            role,
            position,
            aim,
            roll_deg,
            emitter,
            photometric_file,
            environment_map,
            modifier,
            head,
            power,
            color,
            on,
            visible_to_camera,
            body: _,
            muted,
            locked,
        } = old;
        self.labels |= *name != new.name;
        self.editing |= *muted != new.muted || *locked != new.locked;
        self.roles |= *role != new.role;
        match (head, &new.head) {
            (Some(head), Some(new)) => self.compare_heads(head, new),
            (None, None) => {}
            (Some(_), None) | (None, Some(_)) => self.labels = true,
        }
        let mut change = LightChange {
            id: *id,
            was_on: *on,
            is_on: new.on,
            removed: false,
            visible: *visible_to_camera || new.visible_to_camera,
            weight: false,
            transport: *position != new.position
                || *aim != new.aim
                || *roll_deg != new.roll_deg
                || *emitter != new.emitter
                || *photometric_file != new.photometric_file
                || *environment_map != new.environment_map
                || *visible_to_camera != new.visible_to_camera
                // What was traced of a measured light does not say its peak intensity for a flux
                || (photometric_file.is_some() && power.output.states_flux() != new.power.output.states_flux()),
        };
        change.compare_modifiers(modifier, &new.modifier);
        change.compare_powers(power, &new.power);
        change.compare_colors(color, &new.color);
        if change.weight || change.transport || change.was_on != change.is_on {
            self.lights.push(change);
        }
    }
}

impl LightChange {
    fn of_added(light: &Light) -> Self {
        LightChange { was_on: false, is_on: light.on, removed: false, ..LightChange::of_whole(light) }
    }

    fn of_removed(light: &Light) -> Self {
        LightChange { was_on: light.on, is_on: false, removed: true, ..LightChange::of_whole(light) }
    }

    fn of_whole(light: &Light) -> Self {
        let visible = light.visible_to_camera;
        LightChange {
            id: light.id,
            was_on: false,
            is_on: false,
            removed: false,
            visible,
            weight: true,
            transport: true,
        }
    }

    fn compare_modifiers(&mut self, old: &Modifier, new: &Modifier) {
        let Modifier { loss_stops, scrim_stops, beam, grid_deg, doors } = old;
        self.weight |= *loss_stops != new.loss_stops || *scrim_stops != new.scrim_stops;
        self.transport |= *beam != new.beam || *grid_deg != new.grid_deg || *doors != new.doors;
    }

    fn compare_powers(&mut self, old: &Power, new: &Power) {
        let Power { output, dial_stops } = old;
        self.weight |= *output != new.output || *dial_stops != new.dial_stops;
    }

    fn compare_colors(&mut self, old: &LightColor, new: &LightColor) {
        let LightColor { source, gel, gel_loss_counts } = old;
        self.weight |= *source != new.source || *gel != new.gel || *gel_loss_counts != new.gel_loss_counts;
    }
}

/// Finds a light by its id, at its likely index first.
fn find_light(lights: &[Light], index: usize, id: LightId) -> Option<&Light> {
    let likely = lights.get(index).filter(|light| light.id == id);
    likely.or_else(|| lights.iter().find(|light| light.id == id))
}

#[cfg(test)]
mod tests;
