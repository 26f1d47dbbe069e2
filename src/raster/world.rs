//! What stands in the studio, and its way into clip space.

use super::clip::{self, Place};
use super::fill::{Facing, OnScreen, Screen, ScreenTriangle};
use crate::scene::{Assets, CameraFrame, Material, Mesh, Scene, Texture, room_mesh};
use glam::{Affine3A, Mat4, Vec3, Vec3A, Vec4};
use rayon::prelude::*;
use std::sync::Arc;

/// Nearest thing shown, metres.
const NEAR_M: f32 = 0.005;
/// Triangles that one task takes on.
const TASK: usize = 4096;
/// The room stands back by this much of the distance, so that paper laid on its floor lies on top.
const BEHIND_COPLANAR: f32 = 1.0 - 1e-4;

/// A mesh in its place.
#[derive(Debug)]
pub(super) struct Placed {
    pub mesh: Arc<Mesh>,
    pub world_from_object: Affine3A,
    /// Index among the scene's objects, or `NO_OBJECT`.
    pub object: u32,
    /// First of its parts' surfaces.
    pub first_surface: u32,
    facing: Facing,
}

/// A material with its texture.
#[derive(Debug)]
pub(super) struct Surface {
    pub material: Material,
    pub texture: Option<Arc<Texture>>,
}

/// Meshes and materials of a studio.
#[derive(Debug, Default)]
pub(super) struct World {
    pub placed: Vec<Placed>,
    pub surfaces: Vec<Surface>,
}

/// A mesh's vertices after the first stage.
#[derive(Debug)]
pub(super) struct Vertices {
    /// In clip space, and on the screen.
    corners: Vec<Corner>,
    /// From the eye, along the axes of the world.
    pub view: Vec<Vec3>,
    /// Of any length; empty where the mesh has none.
    pub normals: Vec<Vec3>,
}

/// A vertex in clip space.
#[derive(Clone, Copy, Debug)]
struct Corner {
    clip: Vec4,
    /// Of no use beyond the planes.
    on_screen: OnScreen,
    beyond: clip::Planes,
}

impl World {
    pub fn new(scene: &Scene, assets: &Assets) -> Self {
        let mut world = World::default();
        if let Some(room) = &scene.room {
            let facing = Facing { one_sided: true, depth_factor: BEHIND_COPLANAR };
            let material = |part: &str| room.material_of(part).clone();
            world.add(Arc::new(room_mesh(room)), Affine3A::IDENTITY, super::NO_OBJECT, facing, assets, material);
        }
        for (index, object) in (0..).zip(&scene.objects) {
            let world_from_object = object.transform.world_from_object();
            let Some(mesh) = assets.mesh_of(&object.shape).filter(|_| object.visible && world_from_object.is_finite())
            else {
                continue;
            };
            let facing = Facing { one_sided: false, depth_factor: 1.0 };
            world.add(mesh, world_from_object, index, facing, assets, |part| object.material_of(part).clone());
        }
        world
    }

    fn add(
        &mut self,
        mesh: Arc<Mesh>,
        world_from_object: Affine3A,
        object: u32,
        facing: Facing,
        assets: &Assets,
        material: impl Fn(&str) -> Material,
    ) {
        let first_surface = self.surfaces.len() as u32;
        for part in &mesh.parts {
            let material = material(&part.name);
            let texture = material.base_color_texture.as_ref().and_then(|path| assets.textures.get(path).cloned());
            self.surfaces.push(Surface { material, texture });
        }
        self.placed.push(Placed { mesh, world_from_object, object, first_surface, facing });
    }

    pub fn triangle_count(&self) -> u64 {
        self.placed.iter().map(|placed| placed.mesh.triangles.len() as u64).sum()
    }

    /// All vertices as a camera sees them.
    pub fn transformed(&self, camera: &CameraFrame, screen: Screen) -> Vec<Vertices> {
        let eye = Vec3A::from(camera.position());
        let clip_from_view = camera.clip_from_world(NEAR_M) * Mat4::from_translation(eye.into());
        let transform = |placed: &Placed| {
            let Affine3A { matrix3, translation } = placed.world_from_object;
            let view_from_object = Affine3A { matrix3, translation: translation - eye };
            let view: Vec<Vec3> =
                placed.mesh.positions.par_iter().map(|p| view_from_object.transform_point3(*p)).collect();
            let corner = |point: &Vec3| {
                let clip = clip_from_view * point.extend(1.0);
                Corner { clip, on_screen: screen.project(clip), beyond: clip::beyond(clip) }
            };
            // Normals go by the cofactors, which exist for every scale.
            let [x, y, z] = [0, 1, 2].map(|i| Vec3::from(matrix3.col(i)));
            let mirror = if x.dot(y.cross(z)) < 0.0 { -1.0 } else { 1.0 };
            let cofactors = glam::Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * mirror;
            Vertices {
                corners: view.par_iter().map(corner).collect(),
                normals: placed.mesh.normals.par_iter().map(|n| cofactors * *n).collect(),
                view,
            }
        };
        self.placed.iter().map(transform).collect()
    }

    /// What of all triangles lies on the screen, in the order of the scene.
    pub fn screen_triangles(&self, vertices: &[Vertices], screen: Screen) -> Vec<ScreenTriangle> {
        let mut tasks = Vec::new();
        for (index, placed) in self.placed.iter().enumerate() {
            for (part, surface) in placed.mesh.parts.iter().zip(placed.first_surface..) {
                let end = (part.triangles.end as usize).min(placed.mesh.triangles.len());
                tasks.extend(
                    (part.triangles.start as usize..end)
                        .step_by(TASK)
                        .map(|first| (index, surface, first..(first + TASK).min(end))),
                );
            }
        }
        let done: Vec<Vec<ScreenTriangle>> = tasks
            .into_par_iter()
            .map(|(index, surface, range)| {
                let mut out = Vec::with_capacity(range.len());
                for triangle in range {
                    self.place(&vertices[index], (index, triangle, surface), screen, &mut out);
                }
                out
            })
            .collect();
        done.concat()
    }

    fn place(
        &self,
        vertices: &Vertices,
        (index, triangle, surface): (usize, usize, u32),
        screen: Screen,
        out: &mut Vec<ScreenTriangle>,
    ) {
        let placed = &self.placed[index];
        let name = (index as u32, triangle as u32, surface);
        let [Some(a), Some(b), Some(c)] = placed.mesh.triangles[triangle].map(|i| vertices.corners.get(i as usize))
        else {
            return;
        };
        match clip::place([a.beyond, b.beyond, c.beyond]) {
            Place::Outside => {}
            Place::Inside => {
                let corners = [a.on_screen, b.on_screen, c.on_screen];
                out.extend(ScreenTriangle::new(corners, [Vec3::X, Vec3::Y, Vec3::Z], placed.facing, name));
            }
            Place::Across => {
                let polygon = clip::cut([a.clip, b.clip, c.clip]);
                for pair in polygon.corners().windows(2).skip(1) {
                    let fan = [polygon.corners()[0], pair[0], pair[1]];
                    let (corners, weights) = (fan.map(|c| screen.project(c.clip)), fan.map(|c| c.weights));
                    out.extend(ScreenTriangle::new(corners, weights, placed.facing, name));
                }
            }
        }
    }
}
