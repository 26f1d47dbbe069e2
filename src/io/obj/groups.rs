//! Groups the faces of an OBJ file by name and material, and welds the groups to one mesh.

use super::chunks::Elements;
use super::lines::{CornerIndices, Directive, Faces, NO_INDEX};
use super::materials::MaterialLibrary;
use super::mesh_index::to_index;
use super::weld::VertexWelder;
use crate::scene::{Mesh, MeshPart};
use rayon::prelude::*;
use std::collections::HashMap;

/// Faces with one group name and one material.
#[derive(Debug)]
pub(super) struct FaceGroup<'a> {
    /// The group's name in the file; empty for faces before the first group.
    name: String,
    /// Index into the library.
    pub material: Option<usize>,
    /// Runs of triangles, by chunk.
    runs: Vec<&'a [[CornerIndices; 3]]>,
}

/// Returns the groups that have triangles, in file order. Loads the material libraries that the file names.
pub(super) fn groups<'a>(faces: &'a [Faces], library: &mut MaterialLibrary) -> Vec<FaceGroup<'a>> {
    let mut groups = Vec::new();
    let mut open = FaceGroup { name: String::new(), material: None, runs: Vec::new() };
    for Faces { triangles, directives } in faces {
        let mut from = 0;
        for (at, directive) in directives {
            open.extend(&triangles[from..*at]);
            from = *at;
            let (name, material) = match directive {
                Directive::Group(name) => (name.clone(), open.material),
                Directive::Material(name) if library.find(name) == open.material => continue,
                Directive::Material(name) => (open.name.clone(), library.find(name)),
                Directive::Library(name) => {
                    library.load(name);
                    continue;
                }
            };
            let closed = std::mem::replace(&mut open, FaceGroup { name, material, runs: Vec::new() });
            groups.extend(Some(closed).filter(FaceGroup::has_triangles));
        }
        open.extend(&triangles[from..]);
    }
    groups.extend(Some(open).filter(FaceGroup::has_triangles));
    groups
}

impl<'a> FaceGroup<'a> {
    fn extend(&mut self, run: &'a [[CornerIndices; 3]]) {
        if !run.is_empty() {
            self.runs.push(run);
        }
    }

    fn has_triangles(&self) -> bool {
        !self.runs.is_empty()
    }
}

/// Returns a part name for each group: the group's, followed by the material's if several groups have the name; the
/// material's alone for groups without a name.
pub(super) fn part_names(groups: &[FaceGroup<'_>], library: &MaterialLibrary) -> Vec<String> {
    let mut uses = HashMap::new();
    for group in groups {
        *uses.entry(group.name.as_str()).or_insert(0_u32) += 1;
    }
    let name = |group: &FaceGroup<'_>| {
        let material = library.get(group.material).map(|m| m.name.as_str());
        match material {
            Some(material) if group.name.is_empty() => material.to_owned(),
            Some(material) if uses[group.name.as_str()] > 1 => format!("{} {material}", group.name),
            _ if group.name.is_empty() => "surface".to_owned(),
            _ => group.name.clone(),
        }
    };
    groups.iter().map(name).collect()
}

/// Builds one mesh with a part for each group, named by `names`. Texture coordinates and normals are left out if some
/// corner has none.
pub(super) fn weld(elements: &Elements, groups: &[FaceGroup<'_>], names: Vec<String>) -> Mesh {
    let mut welder = VertexWelder::new(elements.positions.len());
    let mut mesh = Mesh::default();
    for (group, name) in groups.iter().zip(names) {
        let first = to_index(mesh.triangles.len());
        welder.begin_group();
        let triangles = group.runs.iter().copied().flatten();
        mesh.triangles.extend(triangles.map(|triangle| triangle.map(|corner| welder.vertex(corner))));
        mesh.parts.push(MeshPart { name, triangles: first..to_index(mesh.triangles.len()) });
    }
    let vertices = &welder.vertices;
    let all_have = |kind: usize| vertices.par_iter().all(|vertex| vertex[kind] != NO_INDEX);
    mesh.positions = gather(vertices, 0, &elements.positions);
    if all_have(1) {
        mesh.uvs = gather(vertices, 1, &elements.uvs);
    }
    if all_have(2) {
        mesh.normals = gather(vertices, 2, &elements.normals);
    }
    mesh
}

/// Returns one element of each vertex: `kind` 0 positions, 1 texture coordinates, 2 normals.
fn gather<T: Copy + Send + Sync>(vertices: &[CornerIndices], kind: usize, values: &[T]) -> Vec<T> {
    vertices.par_iter().map(|vertex| values[vertex[kind] as usize]).collect()
}
