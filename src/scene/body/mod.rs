//! The bodies of lights: modifiers, heads and stands as meshes, made from a light alone.
//!
//! The emitter stays what it is without a body; its light, its beam and its losses are those of `photo`. A body blocks
//! and reflects the light of others. [`LightBody`] says what stands on the set for a light, and compares equal where
//! nothing of it differs; [`LightBody::pieces`] lists its meshes.

pub(super) mod builder;
mod hard;
mod material;
mod shape;
mod soft;
mod support;
mod umbrella;

pub use material::body_material;
pub use shape::ModifierShape;

use super::bodies::{Bodies, BodyChoice};
use super::modifier_kind::ModifierKind;
use super::{Light, Mesh, Room, Scene};
use builder::Builder;
use glam::{Affine3A, Mat3, Vec2, Vec3};

/// The lights of a scene that can have bodies, the first in its list: what bounds the memory that they take.
const MOST_BODIES: usize = 256;
/// Heights over the floor between which stands hold lights, metres. Lower ones lie on the floor, higher ones hang from the
/// ceiling.
const STAND_M: (f32, f32) = (0.3, 4.5);
/// Length of a boom from its stand to the light, metres: typical.
const BOOM_M: f32 = 1.5;
/// Distance of a stand from the walls at least, metres.
const WALL_M: f32 = 0.45;

/// The body of a light in the room.
#[derive(Clone, Debug, PartialEq)]
pub struct LightBody {
    /// False if camera rays pass it.
    pub is_seen: bool,
    /// Its modifier.
    pub shape: ModifierShape,
    world_from_light: Affine3A,
    stands: Vec<Stand>,
}

/// A stand, with a boom where its pole would go through the modifier.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stand {
    /// Foot on the floor.
    foot: Vec3,
    height_m: f32,
    /// Unit direction of the boom from stand to light in (x, z).
    ahead: Vec2,
    /// Length of the boom, metres; 0 without one.
    boom_m: f32,
}

/// A mesh of a body with its place. Its parts have the materials that [`body_material`] returns for their names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPiece {
    /// Its shape.
    pub shape: PieceShape,
    /// Rigid transform.
    pub world_from_piece: Affine3A,
}

/// The shape of a piece of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PieceShape {
    /// Modifier and head, in the light's frame.
    Modifier(ModifierShape),
    /// A stand with its foot at the origin; its boom reaches from its top towards +X.
    Stand {
        /// Height, metres.
        height_m: f32,
        /// Length of the boom, metres; 0 without one.
        boom_m: f32,
    },
}

impl PieceShape {
    /// Returns the mesh.
    pub fn mesh(&self) -> Mesh {
        let mut builder = Builder::default();
        match self {
            PieceShape::Modifier(shape) => add_modifier(&mut builder, shape),
            PieceShape::Stand { height_m, boom_m } => support::stand(&mut builder, *height_m, *boom_m),
        }
        builder.finish()
    }

    /// Returns numbers that are equal for equal meshes alone.
    pub fn key(&self) -> [u32; 8] {
        match self {
            PieceShape::Modifier(shape) => shape.key(),
            PieceShape::Stand { height_m, boom_m } => [0, height_m.to_bits(), boom_m.to_bits(), 0, 0, 0, 0, 1],
        }
    }
}

fn add_modifier(builder: &mut Builder, shape: &ModifierShape) {
    match shape.kind {
        ModifierKind::Bare => {}
        ModifierKind::Softbox => soft::softbox(builder, shape),
        ModifierKind::Octa => soft::octa(builder, shape),
        ModifierKind::Umbrella | ModifierKind::ShootThrough => umbrella::umbrella(builder, shape),
        ModifierKind::Dish => hard::dish(builder, shape),
        ModifierKind::Reflector => hard::reflector(builder, shape),
        ModifierKind::Snoot => hard::snoot(builder, shape),
        ModifierKind::Projector => hard::projector(builder, shape),
        ModifierKind::Frame => soft::frame(builder, shape),
        ModifierKind::Lantern => soft::lantern(builder, shape),
    }
    if matches!(shape.kind, ModifierKind::Softbox | ModifierKind::Octa)
        && let Some(doors) = &shape.doors
    {
        hard::barn_doors(builder, 0.5 * shape.front_m, doors);
    }
    // Framed cloth is lit from behind by a head that is no part of it
    if shape.kind != ModifierKind::Frame {
        support::head(builder, shape);
    }
}

impl LightBody {
    /// Returns the pieces, the modifier first.
    pub fn pieces(&self) -> Vec<BodyPiece> {
        let modifier = BodyPiece { shape: PieceShape::Modifier(self.shape), world_from_piece: self.world_from_light };
        let stand = |stand: &Stand| {
            let Stand { foot, height_m, ahead, boom_m } = *stand;
            let turned = Mat3::from_cols(Vec3::new(ahead.x, 0.0, ahead.y), Vec3::Y, Vec3::new(-ahead.y, 0.0, ahead.x));
            let shape = PieceShape::Stand { height_m, boom_m };
            BodyPiece { shape, world_from_piece: Affine3A::from_mat3_translation(turned, foot) }
        };
        [modifier].into_iter().chain(self.stands.iter().map(stand)).collect()
    }

    /// Returns true if it hangs on a boom.
    pub fn has_boom(&self) -> bool {
        self.stands.iter().any(|stand| stand.boom_m > 0.0)
    }

    /// Returns points along the stands and over the modifier, by which a picture shows some of it.
    pub fn points(&self) -> impl Iterator<Item = Vec3> {
        const STEPS: u32 = 24;
        let stands = self.stands.iter().flat_map(|stand| {
            (0..=STEPS).map(move |step| stand.foot + Vec3::Y * (stand.height_m * step as f32 / STEPS as f32))
        });
        let half = 0.5 * self.shape.front_m;
        let grid = (-3..=3).flat_map(|x| (-3..=3).map(move |y| Vec2::new(x as f32, y as f32) / 3.0));
        let depth = self.shape.depth_m();
        let modifier = grid.flat_map(move |at| [(at * half).extend(0.0), (0.4 * at * half).extend(depth)]);
        stands.chain(modifier.map(|point| self.world_from_light.transform_point3(point)))
    }
}

impl Scene {
    /// Returns what is there of a light's body; nothing of a sun or a surround.
    pub fn bodies_of(&self, light: &Light) -> Bodies {
        match light.body {
            _ if light.emitter.is_infinite() => Bodies::Off,
            BodyChoice::AsStudio => self.bodies,
            BodyChoice::On => Bodies::On,
            BodyChoice::InReflections => Bodies::InReflections,
            BodyChoice::Off => Bodies::Off,
        }
    }

    /// Returns the body of a light, on or off; none if it has none.
    pub fn light_body(&self, light: &Light) -> Option<LightBody> {
        let is_seen = match self.bodies_of(light) {
            Bodies::On => true,
            Bodies::InReflections => false,
            Bodies::Off => return None,
        };
        let shape = ModifierShape::of(light)?;
        let world_from_light = self.light_frame(light);
        let stands = stands(&shape, &world_from_light, self.room.as_ref());
        world_from_light.is_finite().then_some(LightBody { is_seen, shape, world_from_light, stands })
    }

    /// Returns true if camera rays see a light's emitter or its body, wherever it is.
    pub fn camera_sees_light(&self, light: &Light) -> bool {
        light.visible_to_camera || self.light_body(light).is_some_and(|body| body.is_seen)
    }

    /// Returns true if some of a body that the camera sees is inside of its frame. Something may hide it there.
    pub fn is_body_in_picture(&self, light: &Light) -> bool {
        let Some(body) = self.light_body(light).filter(|body| body.is_seen) else { return false };
        let frame = self.camera_frame(self.camera.aspect());
        let is_inside = |at: Vec2| at.cmpge(Vec2::ZERO).all() && at.cmple(Vec2::ONE).all();
        body.points().any(|point| frame.project(point).is_some_and(is_inside))
    }

    /// Returns the lights that have bodies with them.
    pub fn light_bodies(&self) -> impl Iterator<Item = (&Light, LightBody)> {
        let bodies = self.lights.iter().filter_map(|light| Some((light, self.light_body(light)?)));
        bodies.take(MOST_BODIES)
    }
}

/// Returns the stands that hold a modifier.
fn stands(shape: &ModifierShape, world_from_light: &Affine3A, room: Option<&Room>) -> Vec<Stand> {
    let hold = |local: Vec3| world_from_light.transform_point3(local);
    let holds = match shape.kind {
        // A stand on either side of a frame, along its more level edge
        ModifierKind::Frame => {
            let half = 0.5 * shape.front_m;
            let is_turned = world_from_light.matrix3.x_axis.y.abs() > world_from_light.matrix3.y_axis.y.abs();
            let side = if is_turned { Vec3::Y * (half.y + 0.04) } else { Vec3::X * (half.x + 0.04) };
            vec![hold(side), hold(-side)]
        }
        _ => vec![hold(Vec3::Z * shape.stand_point_m())],
    };
    let is_held = |hold: &Vec3| (STAND_M.0..=STAND_M.1).contains(&hold.y);
    let stand = |hold: Vec3| {
        let plain = Stand { foot: hold.with_y(0.0), height_m: hold.y, ahead: Vec2::X, boom_m: 0.0 };
        if goes_through_front(shape, world_from_light, hold.y) { boom(hold, world_from_light, room) } else { plain }
    };
    holds.into_iter().filter(is_held).map(stand).collect()
}

/// Returns true if a pole under the head would go through the front of the modifier, which looks down steeply.
fn goes_through_front(shape: &ModifierShape, world_from_light: &Affine3A, height_m: f32) -> bool {
    let down = world_from_light.matrix3.transpose() * glam::Vec3A::NEG_Y;
    let behind_m = shape.stand_point_m();
    if behind_m <= 0.0 || down.z >= 0.0 {
        return false;
    }
    let length_m = behind_m / -down.z;
    let at = Vec2::new(down.x, down.y) * length_m;
    length_m < height_m && at.abs().cmplt(0.5 * shape.front_m + 0.03).all()
}

/// Returns a stand with a boom that reaches over from behind the light, and does not stand in a wall.
fn boom(hold: Vec3, world_from_light: &Affine3A, room: Option<&Room>) -> Stand {
    let level = |axis: glam::Vec3A| Vec2::new(axis.x, axis.z);
    let back = level(world_from_light.matrix3.z_axis);
    let away = if back.length() > 0.2 { back } else { -level(world_from_light.matrix3.y_axis) };
    let above = Vec2::new(hold.x, hold.z);
    let mut foot = above + away.normalize_or(Vec2::Y) * BOOM_M;
    if let Some(room) = room {
        let half = (0.5 * Vec2::new(room.size_m.x, room.size_m.z) - WALL_M).max(Vec2::ZERO);
        foot = foot.clamp(-half, half);
    }
    let ahead = above - foot;
    let boom_m = ahead.length();
    Stand { foot: Vec3::new(foot.x, 0.0, foot.y), height_m: hold.y, ahead: ahead.normalize_or(Vec2::X), boom_m }
}

#[cfg(test)]
mod tests;
