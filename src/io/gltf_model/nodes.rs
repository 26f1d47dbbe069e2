//! The nodes of the default scene, and their meshes in world space.

use super::accessors;
use super::buffers::ModelFile;
use super::texture_slots::UvSets;
use crate::scene::Mesh;
use glam::{Mat3, Mat4, Vec2, Vec3, Vec4};
use gltf::mesh::Mode;
use gltf::mesh::util::ReadIndices;
use gltf::{Document, Node, Primitive, Skin};

/// The nodes of a scene with their transforms.
pub struct Nodes<'a> {
    /// World transforms by the node's index; identity for nodes that are not in the scene.
    world: Vec<Mat4>,
    with_mesh: Vec<Node<'a>>,
    /// Nodes with a lamp or a camera.
    with_set_up: Vec<Node<'a>>,
}

/// A primitive of a node.
pub struct NodePrimitive<'a> {
    node: Node<'a>,
    /// The primitive.
    pub primitive: Primitive<'a>,
    /// The node's mesh has several primitives.
    is_one_of_several: bool,
}

impl<'a> Nodes<'a> {
    /// Walks through the default scene, or the first one; through all nodes of a document without scenes.
    pub fn new(document: &'a Document) -> Self {
        let scene = document.default_scene().or_else(|| document.scenes().next());
        let mut pending: Vec<(Node<'a>, Mat4)> = match scene {
            Some(scene) => scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect(),
            None => document.nodes().map(|node| (node, Mat4::IDENTITY)).collect(),
        };
        pending.reverse();
        let mut nodes = Nodes {
            world: vec![Mat4::IDENTITY; document.nodes().len()],
            with_mesh: Vec::new(),
            with_set_up: Vec::new(),
        };
        let mut is_seen = vec![false; nodes.world.len()];
        while let Some((node, parent)) = pending.pop() {
            // Nodes of a valid file form trees
            if std::mem::replace(&mut is_seen[node.index()], true) {
                continue;
            }
            let world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
            nodes.world[node.index()] = world;
            let children: Vec<_> = node.children().map(|child| (child, world)).collect();
            pending.extend(children.into_iter().rev());
            if node.light().is_some() || node.camera().is_some() {
                nodes.with_set_up.push(node.clone());
            }
            nodes.with_mesh.extend(node.mesh().is_some().then_some(node));
        }
        nodes
    }

    /// Returns the primitives that have surfaces, in the order of the nodes.
    pub fn primitives(&self) -> impl Iterator<Item = NodePrimitive<'a>> + '_ {
        self.all().filter(|primitive| primitive.is_surface())
    }

    /// Returns true if there are primitives without a surface.
    pub fn has_lines(&self) -> bool {
        self.all().any(|primitive| !primitive.is_surface())
    }

    /// Returns the nodes with a lamp or a camera, and their transforms.
    pub fn placed(&self) -> impl Iterator<Item = (&Node<'a>, Mat4)> {
        self.with_set_up.iter().map(|node| (node, self.world[node.index()]))
    }

    fn all(&self) -> impl Iterator<Item = NodePrimitive<'a>> + '_ {
        self.with_mesh.iter().flat_map(|node| {
            let primitives = node.mesh().map(|mesh| mesh.primitives()).into_iter().flatten();
            let count = node.mesh().map_or(0, |mesh| mesh.primitives().len());
            primitives.map(move |primitive| NodePrimitive {
                node: node.clone(),
                primitive,
                is_one_of_several: count > 1,
            })
        })
    }

    /// Returns the transforms of a skin's joints, from the space of its mesh to the world.
    fn joints(&self, file: &ModelFile, skin: &Skin<'_>) -> Result<Vec<Mat4>, String> {
        if let Some(accessor) = skin.inverse_bind_matrices() {
            accessors::check_matrices(file, &accessor)?;
        }
        let reader = skin.reader(|buffer| Some(file.bytes(&buffer)));
        let mut binds = reader.read_inverse_bind_matrices();
        let mut bind =
            || binds.as_mut().and_then(Iterator::next).map_or(Mat4::IDENTITY, |m| Mat4::from_cols_array_2d(&m));
        Ok(skin.joints().map(|joint| self.world[joint.index()] * bind()).collect())
    }
}

impl NodePrimitive<'_> {
    fn is_surface(&self) -> bool {
        matches!(self.primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
    }

    /// Returns the name of the part: that of the node or of its mesh, with that of the material if the mesh has several.
    pub fn name(&self) -> String {
        let mesh = self.node.mesh();
        let name = self.node.name().or_else(|| mesh.as_ref().and_then(|mesh| mesh.name()));
        let material = self.primitive.material();
        match (name, material.name().filter(|_| self.is_one_of_several || name.is_none())) {
            (Some(name), Some(material)) => format!("{name} {material}"),
            (Some(name), None) | (None, Some(name)) => name.to_owned(),
            (None, None) => "surface".to_owned(),
        }
    }

    /// Returns the triangles in world space, posed as the file says, with at most so many triangles.
    ///
    /// # Errors
    /// If the data are damaged, or if there are too many triangles.
    pub fn mesh(&self, file: &ModelFile, nodes: &Nodes<'_>, most_triangles: usize) -> Result<Mesh, String> {
        // Read the vertices and the triangles
        accessors::check(file, &self.primitive)?;
        let reader = self.primitive.reader(|buffer| Some(file.bytes(&buffer)));
        let mut positions: Vec<Vec3> = reader.read_positions().ok_or("it has no positions")?.map(Vec3::from).collect();
        let mut normals: Vec<Vec3> = reader.read_normals().into_iter().flatten().map(Vec3::from).collect();
        let vertices = positions.len();
        let triangles = self.triangles(reader.read_indices(), vertices)?;
        if triangles.len() > most_triangles {
            return Err("it has too many triangles".to_owned());
        }

        // Add the morph targets, each by its weight
        let mesh = self.node.mesh();
        let weights = self.node.weights().or_else(|| mesh.as_ref().and_then(|mesh| mesh.weights()));
        for ((offsets, normal_offsets, _), weight) in reader.read_morph_targets().zip(weights.unwrap_or_default()) {
            let add = |values: &mut [Vec3], offset: [f32; 3], at: usize| {
                values.get_mut(at).into_iter().for_each(|value| *value += Vec3::from(offset) * *weight);
            };
            offsets.into_iter().flatten().enumerate().for_each(|(at, offset)| add(&mut positions, offset, at));
            let normal_offsets = normal_offsets.into_iter().flatten().enumerate();
            normal_offsets.for_each(|(at, offset)| add(&mut normals, offset, at));
        }

        // Blend the matrices of each vertex's joints; without a skin all vertices have that of the node
        let skin = self.node.skin().zip(reader.read_joints(0)).zip(reader.read_weights(0));
        let world = nodes.world[self.node.index()];
        let transforms: Vec<Mat4> = match skin {
            Some(((skin, joints), weights)) => {
                let matrices = nodes.joints(file, &skin)?;
                let blended = joints.into_u16().zip(weights.into_f32()).map(|(joints, weights)| {
                    let matrix = |joint: u16| matrices.get(usize::from(joint)).copied().unwrap_or(Mat4::IDENTITY);
                    let sum = joints
                        .into_iter()
                        .zip(weights)
                        .fold(Mat4::ZERO, |sum, (joint, weight)| sum + matrix(joint) * weight);
                    if sum == Mat4::ZERO { world } else { sum * weights.iter().sum::<f32>().recip() }
                });
                blended.collect()
            }
            None => vec![world],
        };

        // Transform normals and positions into world space
        let transform = |at: usize| transforms.get(at).or(transforms.first()).copied().unwrap_or(world);
        let is_mirrored = transform(0).determinant() < 0.0;
        for (at, normal) in normals.iter_mut().enumerate() {
            *normal = (Mat3::from_mat4(transform(at)).inverse().transpose() * *normal).normalize_or_zero();
        }
        for (at, position) in positions.iter_mut().enumerate() {
            *position = transform(at).transform_point3(*position);
        }

        // Turn the triangles of a mirrored node, so that their fronts stay in front
        let turned = |[a, b, c]: [u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
        let triangles = triangles.into_iter().map(turned).collect();

        // Read texture coordinates and colours; those that are missing or damaged are left out
        let has_normals = normals.len() == vertices && normals.iter().all(|normal| normal.is_normalized());
        let sets = UvSets::of(file, &self.primitive.material());
        let uvs = self.uvs(file, sets.first.or(Some(0)), vertices);
        let second_uvs = self.uvs(file, sets.second, vertices);
        let colors: Vec<Vec3> = match reader.read_colors(0) {
            // Alpha is left out: there is no property for it
            Some(colors) => {
                colors.into_rgba_f32().map(|rgba| Vec4::from(rgba).truncate().clamp(Vec3::ZERO, Vec3::ONE)).collect()
            }
            None => Vec::new(),
        };
        let colors = if colors.len() == vertices { colors } else { Vec::new() };
        let mesh = Mesh { positions, normals, uvs, second_uvs, colors, triangles, ..Mesh::default() };
        Ok(if has_normals { mesh } else { flat(mesh) })
    }

    /// Returns a set of texture coordinates, from the bottom left; empty where it is missing or damaged.
    fn uvs(&self, file: &ModelFile, set: Option<u32>, vertices: usize) -> Vec<Vec2> {
        let reader = self.primitive.reader(|buffer| Some(file.bytes(&buffer)));
        let uvs = set.and_then(|set| reader.read_tex_coords(set)).map(|uvs| uvs.into_f32());
        let uvs: Vec<Vec2> = uvs.into_iter().flatten().map(|[u, v]| Vec2::new(u, 1.0 - v)).collect();
        if uvs.len() == vertices && uvs.iter().all(|uv| uv.is_finite()) { uvs } else { Vec::new() }
    }

    fn triangles(&self, indices: Option<ReadIndices<'_>>, vertices: usize) -> Result<Vec<[u32; 3]>, String> {
        let vertices = u32::try_from(vertices).map_err(|_| "it has too many vertices")?;
        let corners: Vec<u32> = indices.map_or_else(|| (0..vertices).collect(), |indices| indices.into_u32().collect());
        if corners.iter().any(|corner| *corner >= vertices) {
            return Err("a triangle has a vertex that is not there".to_owned());
        }
        Ok(match self.primitive.mode() {
            Mode::TriangleStrip => {
                let turned = |(at, corners): (usize, &[u32])| match (at % 2, corners) {
                    (0, [a, b, c]) => [*a, *b, *c],
                    (_, [a, b, c]) => [*b, *a, *c],
                    _ => [0; 3],
                };
                corners.windows(3).enumerate().map(turned).collect()
            }
            Mode::TriangleFan => {
                corners.get(1..).unwrap_or_default().windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect()
            }
            _ => corners.as_chunks().0.to_vec(),
        })
    }
}

/// Returns a mesh with vertices of its own and a flat normal for each triangle, as files without normals ask for.
fn flat(mesh: Mesh) -> Mesh {
    let order = || mesh.triangles.iter().flatten().map(|corner| *corner as usize);
    let pick = |values: &[Vec3]| -> Vec<Vec3> { order().filter_map(|corner| values.get(corner)).copied().collect() };
    let (positions, colors) = (pick(&mesh.positions), pick(&mesh.colors));
    let pick_uvs = |uvs: &[Vec2]| order().filter_map(|corner| uvs.get(corner)).copied().collect();
    let (uvs, second_uvs) = (pick_uvs(&mesh.uvs), pick_uvs(&mesh.second_uvs));
    let normals =
        positions.as_chunks().0.iter().flat_map(|[a, b, c]| [(b - a).cross(c - a).normalize_or(Vec3::Y); 3]).collect();
    let corners = u32::try_from(positions.len()).unwrap_or(u32::MAX);
    let triangles = (0..corners / 3).map(|index| [0, 1, 2].map(|corner| 3 * index + corner)).collect();
    Mesh { positions, normals, uvs, second_uvs, colors, triangles, ..Mesh::default() }
}
