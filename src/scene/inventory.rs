//! Enumerates the materials and the asset references of a scene. Nothing else in the crate lists them.

use super::{Mannequin, Material, Object, Room, Scene, Shape};
use std::borrow::Cow;

/// The slot of a scene that holds one material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MaterialSlot {
    /// The room's floor.
    Floor,
    /// The room's walls.
    Walls,
    /// The room's ceiling.
    Ceiling,
    /// The material of `objects[index]`.
    Object {
        /// Index into [`Scene::objects`].
        index: usize,
    },
    /// The material of one named part of `objects[index]`.
    Part {
        /// Index into [`Scene::objects`].
        index: usize,
        /// Index into [`Object::part_materials`].
        part: usize,
    },
}

/// A reference to an asset outside of the scene.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AssetRef<'a> {
    /// A mesh file, by its path relative to the scene file.
    Mesh(Cow<'a, str>),
    /// A figure in a pose.
    Figure(Mannequin),
    /// A texture file, by its path relative to the scene file.
    Texture(Cow<'a, str>),
}

impl AssetRef<'_> {
    /// Returns the same reference with a path of its own.
    pub fn into_owned(self) -> AssetRef<'static> {
        match self {
            AssetRef::Mesh(path) => AssetRef::Mesh(Cow::Owned(path.into_owned())),
            AssetRef::Figure(figure) => AssetRef::Figure(figure),
            AssetRef::Texture(path) => AssetRef::Texture(Cow::Owned(path.into_owned())),
        }
    }

    /// Returns the path relative to the scene file; `None` for assets that are not files.
    pub fn path(&self) -> Option<&str> {
        match self {
            AssetRef::Mesh(path) | AssetRef::Texture(path) => Some(path),
            AssetRef::Figure(_) => None,
        }
    }
}

/// The field of a scene that holds an asset reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AssetField {
    /// The shape of `objects[index]`.
    Shape {
        /// Index into [`Scene::objects`].
        index: usize,
    },
    /// A texture of a material.
    Texture {
        /// The material.
        material: MaterialSlot,
        /// The material's field, as in the scene file.
        field: &'static str,
    },
}

impl Scene {
    /// Returns every material with its slot: the room's, then each object's own and those of its parts.
    pub fn materials(&self) -> impl Iterator<Item = (MaterialSlot, &Material)> {
        let objects = self.objects.iter().enumerate();
        room_materials(self).chain(objects.flat_map(|(index, object)| object_materials(index, object)))
    }

    /// Returns every asset reference with the field that holds it. An asset is listed as often as it is referenced.
    pub fn assets(&self) -> impl Iterator<Item = (AssetField, AssetRef<'_>)> {
        let objects = self.objects.iter().enumerate().flat_map(|(index, object)| {
            let shape = shape_asset(&object.shape).map(|asset| (AssetField::Shape { index }, asset));
            shape.into_iter().chain(object_materials(index, object).flat_map(texture_assets))
        });
        room_materials(self).flat_map(texture_assets).chain(objects)
    }

    /// Returns true if some surface emits light, hidden objects included.
    pub fn has_emissive_material(&self) -> bool {
        self.materials().any(|(_, material)| material.is_emissive())
    }

    /// Returns the field as [`super::Finding::place`] names it: `objects[2] "Bust" shape.path`.
    pub fn place_of(&self, field: AssetField) -> String {
        match field {
            AssetField::Shape { index } => {
                let is_file = self.objects.get(index).is_some_and(|o| matches!(o.shape, Shape::MeshFile { .. }));
                self.object_place(index, if is_file { "shape.path" } else { "shape" })
            }
            AssetField::Texture { material, field } => match material {
                MaterialSlot::Floor => format!("room.floor.{field}"),
                MaterialSlot::Walls => format!("room.walls.{field}"),
                MaterialSlot::Ceiling => format!("room.ceiling.{field}"),
                MaterialSlot::Object { index } => self.object_place(index, &format!("material.{field}")),
                MaterialSlot::Part { index, part } => {
                    self.object_place(index, &format!("part_materials[{part}].material.{field}"))
                }
            },
        }
    }

    fn object_place(&self, index: usize, field: &str) -> String {
        let name = self.objects.get(index).map_or("", |object| &object.name);
        format!("objects[{index}] {name:?} {field}")
    }
}

impl Object {
    /// Returns the object's own material, then those of its parts.
    pub fn materials(&self) -> impl Iterator<Item = &Material> {
        object_materials(0, self).map(|(_, material)| material)
    }
}

fn room_materials(scene: &Scene) -> impl Iterator<Item = (MaterialSlot, &Material)> {
    scene.room.iter().flat_map(|room| {
        let Room { size_m: _, floor, walls, ceiling } = room;
        [(MaterialSlot::Floor, floor), (MaterialSlot::Walls, walls), (MaterialSlot::Ceiling, ceiling)]
    })
}

fn texture_assets((slot, material): (MaterialSlot, &Material)) -> impl Iterator<Item = (AssetField, AssetRef<'_>)> {
    let textures = material.textures();
    textures.map(move |(field, path)| (AssetField::Texture { material: slot, field }, AssetRef::Texture(path.into())))
}

fn object_materials(index: usize, object: &Object) -> impl Iterator<Item = (MaterialSlot, &Material)> {
    let parts = object.part_materials.iter().enumerate();
    let parts = parts.map(move |(part, (_, material))| (MaterialSlot::Part { index, part }, material));
    std::iter::once((MaterialSlot::Object { index }, &object.material)).chain(parts)
}

fn shape_asset(shape: &Shape) -> Option<AssetRef<'_>> {
    match shape {
        Shape::MeshFile { path } => Some(AssetRef::Mesh(Cow::Borrowed(path))),
        Shape::Mannequin(figure) => Some(AssetRef::Figure(*figure)),
        Shape::Plane { .. }
        | Shape::Box { .. }
        | Shape::Sphere { .. }
        | Shape::Cylinder { .. }
        | Shape::Sweep { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Figure, ObjectId, Pose, Transform};

    #[test]
    fn materials_and_assets_are_listed_with_the_fields_that_hold_them() {
        let textured = |path: &str| Material { base_color_texture: Some(path.to_owned()), ..Material::default() };
        let figure = Mannequin { figure: Figure::Bust, pose: Pose::Standing };
        let object = |name: &str, shape| Object {
            id: ObjectId(0),
            name: name.to_owned(),
            transform: Transform::default(),
            shape,
            material: Material::default(),
            part_materials: vec![("eyes".to_owned(), textured("iris.png"))],
            visible: true,
            locked: false,
        };
        let scene = Scene {
            room: Some(Room { ceiling: textured("sky.png"), ..Room::default() }),
            objects: vec![
                object("Chair", Shape::MeshFile { path: "chair.obj".to_owned() }),
                object("Bust", Shape::Mannequin(figure)),
            ],
            ..Scene::default()
        };
        assert_eq!(scene.materials().count(), 3 + 2 + 2);
        let assets: Vec<_> = scene.assets().map(|(field, asset)| (scene.place_of(field), asset.into_owned())).collect();
        let file = |path: &str| Cow::Owned(path.to_owned());
        let expected = [
            ("room.ceiling.base_color_texture", AssetRef::Texture(file("sky.png"))),
            ("objects[0] \"Chair\" shape.path", AssetRef::Mesh(file("chair.obj"))),
            ("objects[0] \"Chair\" part_materials[0].material.base_color_texture", AssetRef::Texture(file("iris.png"))),
            ("objects[1] \"Bust\" shape", AssetRef::Figure(figure)),
            ("objects[1] \"Bust\" part_materials[0].material.base_color_texture", AssetRef::Texture(file("iris.png"))),
        ];
        assert_eq!(assets, expected.map(|(place, asset)| (place.to_owned(), asset)));
    }
}
