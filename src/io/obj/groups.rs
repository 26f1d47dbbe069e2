//! The faces of an OBJ file by group and material, and the mesh that they make.

use super::lines::{ABSENT, Corner, Faces, Mark};
use super::materials::Library;
use super::pieces::Elements;
use super::weld::Welder;
use crate::scene::{Mesh, MeshPart};
use rayon::prelude::*;
use std::collections::HashMap;

/// Faces with one name and one material.
#[derive(Debug)]
pub(super) struct Group<'a> {
    /// Of the group in the file; empty where it has none.
    name: String,
    /// In the library.
    pub material: Option<usize>,
    runs: Vec<&'a [[Corner; 3]]>,
}

/// All groups that have triangles, in the order of the file. Loads the materials on the way.
pub(super) fn groups<'a>(faces: &'a [Faces], library: &mut Library) -> Vec<Group<'a>> {
    let mut groups = Vec::new();
    let mut open = Group { name: String::new(), material: None, runs: Vec::new() };
    for Faces { triangles, marks } in faces {
        let mut from = 0;
        for (at, mark) in marks {
            open.extend(&triangles[from..*at]);
            from = *at;
            let (name, material) = match mark {
                Mark::Group(name) => (name.clone(), open.material),
                Mark::Material(name) if library.find(name) == open.material => continue,
                Mark::Material(name) => (open.name.clone(), library.find(name)),
                Mark::Library(name) => {
                    library.load(name);
                    continue;
                }
            };
            let closed = std::mem::replace(&mut open, Group { name, material, runs: Vec::new() });
            groups.extend(Some(closed).filter(Group::has_triangles));
        }
        open.extend(&triangles[from..]);
    }
    groups.extend(Some(open).filter(Group::has_triangles));
    groups
}

impl<'a> Group<'a> {
    fn extend(&mut self, run: &'a [[Corner; 3]]) {
        if !run.is_empty() {
            self.runs.push(run);
        }
    }

    fn has_triangles(&self) -> bool {
        !self.runs.is_empty()
    }
}

/// A name a part: the group's, with the material's where a group has several, and the material's where there is no
/// group.
pub(super) fn part_names(groups: &[Group<'_>], library: &Library) -> Vec<String> {
    let mut times = HashMap::new();
    for group in groups {
        *times.entry(group.name.as_str()).or_insert(0_u32) += 1;
    }
    let name = |group: &Group<'_>| {
        let material = library.get(group.material).map(|m| m.name.as_str());
        match material {
            Some(material) if group.name.is_empty() => material.to_owned(),
            Some(material) if times[group.name.as_str()] > 1 => format!("{} {material}", group.name),
            _ if group.name.is_empty() => "surface".to_owned(),
            _ => group.name.clone(),
        }
    };
    groups.iter().map(name).collect()
}

/// One mesh, a part a group with the given names. Texture coordinates and normals are left out where some corner has
/// none.
pub(super) fn weld(elements: &Elements, groups: &[Group<'_>], names: Vec<String>) -> Mesh {
    let mut welder = Welder::new(elements.positions.len());
    let mut mesh = Mesh::default();
    for (group, name) in groups.iter().zip(names) {
        let first = mesh.triangles.len() as u32;
        welder.begin_group();
        let triangles = group.runs.iter().copied().flatten();
        mesh.triangles.extend(triangles.map(|triangle| triangle.map(|corner| welder.vertex(corner))));
        mesh.parts.push(MeshPart { name, triangles: first..mesh.triangles.len() as u32 });
    }
    let vertices = &welder.vertices;
    let all_have = |kind: usize| vertices.par_iter().all(|vertex| vertex[kind] != ABSENT);
    mesh.positions = gather(vertices, 0, &elements.positions);
    if all_have(1) {
        mesh.uvs = gather(vertices, 1, &elements.uvs);
    }
    if all_have(2) {
        mesh.normals = gather(vertices, 2, &elements.normals);
    }
    mesh
}

/// What each vertex names of a kind.
fn gather<T: Copy + Send + Sync>(vertices: &[Corner], kind: usize, values: &[T]) -> Vec<T> {
    vertices.par_iter().map(|vertex| values[vertex[kind] as usize]).collect()
}
