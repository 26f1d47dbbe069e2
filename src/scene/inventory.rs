//! Enumerates the materials and the asset references of a scene. Nothing else in the crate lists them.

use super::{AssetRef, Material, Object, Room, Scene, Shape, Tank, Terrain, TextureSlot};
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
        /// The material's texture slot.
        texture: TextureSlot,
    },
    /// The photometric file of `lights[index]`.
    Photometry {
        /// Index into [`Scene::lights`].
        index: usize,
    },
    /// The photometric file of a light of another variant than the shown one.
    VariantPhotometry,
    /// The environment map of `lights[index]`.
    Environment {
        /// Index into [`Scene::lights`].
        index: usize,
    },
    /// The environment map of a light of another variant than the shown one.
    VariantEnvironment,
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
        let lights = self.lights.iter().enumerate().filter_map(|(index, light)| {
            let path = light.photometric_file.as_deref()?;
            Some((AssetField::Photometry { index }, AssetRef::Photometry(Cow::Borrowed(path))))
        });
        let stored = self.variants.stored_photometric_files();
        let stored = stored.map(|path| (AssetField::VariantPhotometry, AssetRef::Photometry(Cow::Borrowed(path))));
        let maps = self.lights.iter().enumerate().filter_map(|(index, light)| {
            let path = light.environment_map.as_deref()?;
            Some((AssetField::Environment { index }, AssetRef::Environment(Cow::Borrowed(path))))
        });
        let stored_maps = self.variants.stored_environment_maps();
        let stored_maps =
            stored_maps.map(|path| (AssetField::VariantEnvironment, AssetRef::Environment(Cow::Borrowed(path))));
        let surfaces = room_materials(self).flat_map(texture_assets).chain(objects);
        surfaces.chain(lights).chain(stored).chain(maps).chain(stored_maps)
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
            AssetField::Texture { material, texture } => self.texture_place(material, texture.field()),
            AssetField::VariantPhotometry | AssetField::VariantEnvironment => "variants".to_owned(),
            AssetField::Environment { index } => {
                let name = self.lights.get(index).map_or("", |light| &light.name);
                format!("lights[{index}] {name:?} environment_map")
            }
            AssetField::Photometry { index } => {
                let name = self.lights.get(index).map_or("", |light| &light.name);
                format!("lights[{index}] {name:?} photometric_file")
            }
        }
    }

    /// Renames the files of the assets of objects and lights: `new_path` returns the new path of an asset, or none to keep
    /// it. The room's textures and the lights of other variants keep theirs.
    pub fn rename_asset_files(&mut self, mut new_path: impl FnMut(&AssetRef<'_>) -> Option<String>) {
        for object in &mut self.objects {
            rename_shape_file(&mut object.shape, &mut new_path);
            let parts = object.part_materials.iter_mut().map(|(_, material)| material);
            for material in std::iter::once(&mut object.material).chain(parts) {
                for slot in TextureSlot::ALL {
                    let texture = material.textures.get_mut(slot);
                    let new = texture.as_ref().and_then(|texture| new_path(&AssetRef::Texture(Cow::Borrowed(texture))));
                    *texture = texture.take().map(|texture| match new {
                        Some(path) => texture.at_path(path),
                        None => texture,
                    });
                }
            }
        }
        for light in &mut self.lights {
            if let Some(path) = &mut light.photometric_file
                && let Some(new) = new_path(&AssetRef::Photometry(Cow::Borrowed(path)))
            {
                *path = new;
            }
            if let Some(path) = &mut light.environment_map
                && let Some(new) = new_path(&AssetRef::Environment(Cow::Borrowed(path)))
            {
                *path = new;
            }
        }
    }

    fn texture_place(&self, material: MaterialSlot, field: &str) -> String {
        match material {
            MaterialSlot::Floor => format!("room.floor.{field}"),
            MaterialSlot::Walls => format!("room.walls.{field}"),
            MaterialSlot::Ceiling => format!("room.ceiling.{field}"),
            MaterialSlot::Object { index } => self.object_place(index, &format!("material.{field}")),
            MaterialSlot::Part { index, part } => {
                self.object_place(index, &format!("part_materials[{part}].material.{field}"))
            }
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
    material.textures.iter().map(move |(texture, reference)| {
        (AssetField::Texture { material: slot, texture }, AssetRef::Texture(Cow::Borrowed(reference)))
    })
}

fn object_materials(index: usize, object: &Object) -> impl Iterator<Item = (MaterialSlot, &Material)> {
    let parts = object.part_materials.iter().enumerate();
    let parts = parts.map(move |(part, (_, material))| (MaterialSlot::Part { index, part }, material));
    std::iter::once((MaterialSlot::Object { index }, &object.material)).chain(parts)
}

fn shape_asset(shape: &Shape) -> Option<AssetRef<'_>> {
    match shape {
        Shape::MeshFile { path } => Some(AssetRef::Mesh(Cow::Borrowed(path))),
        Shape::Figure(figure) => Some(AssetRef::figure(Cow::Borrowed(figure))),
        Shape::Tank(tank) => Some(AssetRef::tank(Cow::Borrowed(tank))),
        Shape::Plane { .. }
        | Shape::Box { .. }
        | Shape::Sphere { .. }
        | Shape::Cylinder { .. }
        | Shape::Sweep { .. }
        | Shape::VFlat { .. }
        | Shape::Prop(_) => None,
    }
}

/// Renames the file of a shape's asset.
fn rename_shape_file(shape: &mut Shape, new_path: &mut impl FnMut(&AssetRef<'_>) -> Option<String>) {
    let new = shape_asset(shape).filter(|asset| asset.path().is_some()).and_then(|asset| new_path(&asset));
    match (shape, new) {
        (Shape::MeshFile { path }, Some(new)) => *path = new,
        (Shape::Tank(tank), Some(new)) => {
            let Tank { terrain, .. } = &mut **tank;
            if let Terrain::Picture { path, .. } = terrain {
                *path = new;
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Extent, Figure, Light, MaterialTextures, Output, TextureRef};

    #[test]
    fn every_asset_file_of_objects_and_lights_is_renamed() {
        let embedded = TextureRef::Embedded { model: "chair.glb".to_owned(), image: 2 };
        let textures = MaterialTextures {
            emission: Some(embedded),
            ..MaterialTextures::with_base_color(TextureRef::file("wood.png"))
        };
        let material = Material { textures, ..Material::default() };
        let ground = Terrain::Picture { path: "hills.png".to_owned(), low_m: 0.0, high_m: 0.1 };
        let tank = Tank { terrain: ground, ..Tank::default() };
        let chair = Object {
            material: material.clone(),
            part_materials: vec![("seat".to_owned(), material)],
            ..Object::new("Chair", Shape::MeshFile { path: "chair.glb".to_owned() })
        };
        let mut scene = Scene {
            objects: vec![chair, Object::new("Tank", Shape::Tank(Box::new(tank)))],
            lights: vec![Light {
                photometric_file: Some("lamp.ies".to_owned()),
                environment_map: Some("sky.hdr".to_owned()),
                ..Light::new(Emitter::Surround, Output::Lumens(100.0))
            }],
            ..Scene::default()
        };
        let paths = |scene: &Scene| -> Vec<String> {
            scene.assets().filter_map(|(_, asset)| asset.path().map(str::to_owned)).collect()
        };
        let before = paths(&scene);
        assert_eq!(before.len(), 8);
        scene.rename_asset_files(|asset| asset.path().map(|path| format!("new/{path}")));
        assert_eq!(paths(&scene), before.iter().map(|path| format!("new/{path}")).collect::<Vec<_>>());
        let renamed = scene.clone();
        scene.rename_asset_files(|_| None);
        assert_eq!(scene, renamed);
    }

    #[test]
    fn materials_and_assets_are_listed_with_the_fields_that_hold_them() {
        let textured = |path: &str| Material {
            textures: MaterialTextures::with_base_color(TextureRef::file(path)),
            ..Material::default()
        };
        let figure = Figure { extent: Extent::Bust, ..Figure::default() };
        let object = |name: &str, shape| Object {
            part_materials: vec![("eyes".to_owned(), textured("iris.png"))],
            ..Object::new(name, shape)
        };
        let scene = Scene {
            room: Some(Room { ceiling: textured("sky.png"), ..Room::default() }),
            objects: vec![
                object("Chair", Shape::MeshFile { path: "chair.obj".to_owned() }),
                object("Bust", Shape::Figure(Box::new(figure))),
            ],
            lights: vec![Light {
                photometric_file: Some("lamp.ies".to_owned()),
                ..Light::new(Emitter::Point, Output::Lumens(100.0))
            }],
            ..Scene::default()
        };
        assert_eq!(scene.materials().count(), 3 + 2 + 2);
        let assets: Vec<_> = scene.assets().map(|(field, asset)| (scene.place_of(field), asset.into_owned())).collect();
        let image = |path: &str| AssetRef::Texture(Cow::Owned(TextureRef::file(path)));
        let expected = [
            ("room.ceiling.base_color_texture", image("sky.png")),
            ("objects[0] \"Chair\" shape.path", AssetRef::Mesh(Cow::Borrowed("chair.obj"))),
            ("objects[0] \"Chair\" part_materials[0].material.base_color_texture", image("iris.png")),
            ("objects[1] \"Bust\" shape", AssetRef::figure(Cow::Owned(figure))),
            ("objects[1] \"Bust\" part_materials[0].material.base_color_texture", image("iris.png")),
            ("lights[0] \"Light\" photometric_file", AssetRef::Photometry(Cow::Borrowed("lamp.ies"))),
        ];
        assert_eq!(assets, expected.map(|(place, asset)| (place.to_owned(), asset)));
    }
}
