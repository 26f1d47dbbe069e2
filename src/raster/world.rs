//! What stands in the studio, and its way into clip space.

use super::batch::{self, Batch};
use super::clip::{self, Place};
use super::row::Attributes;
use super::triangle::{Facing, OnScreen, Screen, ScreenTriangle};
use crate::scene::{Assets, CameraFrame, Material, Mesh, Scene, Texture, room_mesh};
use glam::{Affine3A, Mat4, Vec3, Vec3A, Vec4};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Nearest thing shown, metres.
const NEAR_M: f32 = 0.005;
/// Vertices that one task takes on.
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
    /// Its mesh among the placed.
    pub placed: u32,
    pub material: Material,
    pub texture: Option<Arc<Texture>>,
}

/// Meshes and materials of a studio.
#[derive(Debug, Default)]
pub(super) struct World {
    pub placed: Vec<Placed>,
    pub surfaces: Vec<Surface>,
    /// All triangles, in the order of the scene: surfaces, and a few of their triangles at a time.
    spans: Vec<(u32, Range<usize>)>,
}

/// A mesh's vertices after the first stage.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    /// In clip space, and on the screen.
    corners: Vec<Corner>,
    /// Point from the eye, along the axes of the world; normal of any length, zero where there is none; and texture.
    pub attributes: Vec<Attributes>,
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
            let end = (part.triangles.end as usize).min(mesh.triangles.len());
            let starts = (part.triangles.start as usize..end).step_by(batch::TRIANGLES);
            let surface = self.surfaces.len() as u32;
            self.spans.extend(starts.map(|first| (surface, first..(first + batch::TRIANGLES).min(end))));
            self.surfaces.push(Surface { placed: self.placed.len() as u32, material, texture });
        }
        self.placed.push(Placed { mesh, world_from_object, object, first_surface, facing });
    }

    pub fn triangle_count(&self) -> u64 {
        self.placed.iter().map(|placed| placed.mesh.triangles.len() as u64).sum()
    }

    /// All vertices as a camera sees them.
    pub fn transform(&self, camera: &CameraFrame, screen: Screen, vertices: &mut Vec<Vertices>) {
        let eye = Vec3A::from(camera.position());
        let clip_from_view = camera.clip_from_world(NEAR_M) * Mat4::from_translation(eye.into());
        vertices.resize_with(self.placed.len(), Vertices::default);
        for (placed, Vertices { corners, attributes }) in self.placed.iter().zip(vertices) {
            let (mesh, Affine3A { matrix3, translation }) = (&placed.mesh, placed.world_from_object);
            let view_from_object = Affine3A { matrix3, translation: translation - eye };
            let clip_from_object = clip_from_view * Mat4::from(view_from_object);
            let corner = |point: &Vec3| {
                let clip = clip_from_object * point.extend(1.0);
                Corner { clip, on_screen: screen.project(clip), beyond: clip::beyond(clip) }
            };
            // Normals go by the cofactors, which exist for every scale.
            let [x, y, z] = [0, 1, 2].map(|i| Vec3::from(matrix3.col(i)));
            let mirror = if x.dot(y.cross(z)) < 0.0 { -1.0 } else { 1.0 };
            let cofactors = glam::Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * mirror;
            let attribute = |i: usize| {
                let point = view_from_object.transform_point3(mesh.positions[i]);
                let normal = mesh.normals.get(i).map_or(Vec3::ZERO, |normal| cofactors * *normal);
                let uv = mesh.uvs.get(i).copied().unwrap_or_default();
                [point.x, point.y, point.z, normal.x, normal.y, normal.z, uv.x, uv.y]
            };
            mesh.positions.par_iter().with_min_len(TASK).map(corner).collect_into_vec(corners);
            let all = (0..mesh.positions.len()).into_par_iter().with_min_len(TASK);
            all.map(attribute).collect_into_vec(attributes);
        }
    }

    /// What of all triangles lies on the screen, in the order of the scene.
    pub fn set_up(&self, vertices: &[Vertices], screen: Screen, batches: &mut Vec<Batch>) {
        batches.resize_with(self.spans.len(), Batch::default);
        batches.par_iter_mut().zip(&self.spans).enumerate().for_each(|(number, (batch, (surface, triangles)))| {
            let index = self.surfaces[*surface as usize].placed as usize;
            batch.fill(number, screen, |out| {
                for triangle in triangles.clone() {
                    self.place(&vertices[index], &self.placed[index], (*surface, triangle as u32), screen, out);
                }
            });
        });
    }

    fn place(
        &self,
        vertices: &Vertices,
        placed: &Placed,
        name: (u32, u32),
        screen: Screen,
        out: &mut Vec<ScreenTriangle>,
    ) {
        let corners = placed.mesh.triangles[name.1 as usize];
        let [Some(a), Some(b), Some(c)] = corners.map(|i| vertices.corners.get(i as usize)) else { return };
        match clip::place([a.beyond, b.beyond, c.beyond]) {
            Place::Outside => {}
            Place::Inside => {
                let corners = [a.on_screen, b.on_screen, c.on_screen];
                out.extend(ScreenTriangle::new(corners, placed.facing, name, None));
            }
            Place::Across => {
                let polygon = clip::cut([a.clip, b.clip, c.clip]);
                for pair in polygon.corners().windows(2).skip(1) {
                    let fan = [polygon.corners()[0], pair[0], pair[1]];
                    let (corners, weights) = (fan.map(|c| screen.project(c.clip)), fan.map(|c| c.weights));
                    out.extend(ScreenTriangle::new(corners, placed.facing, name, Some(weights)));
                }
            }
        }
    }
}
