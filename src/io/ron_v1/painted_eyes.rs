//! Eyes of figures as studios were saved with them while iris and pupil were painted on the cornea.

use crate::figures::iris_textures;
use crate::scene::{BuiltinTexture, MaterialTextures, Object, Shape, TextureRef};

/// Part of figures that there was beside the iris.
const PUPIL: &str = "pupil";

/// Puts the painted irises of a figure under the cornea, where the picture of the iris has the pupil.
pub(super) fn put_under_cornea(object: &mut Object) {
    if !matches!(object.shape, Shape::Figure(_)) {
        return;
    }
    let painted = MaterialTextures {
        normal: Some(TextureRef::Builtin(BuiltinTexture::IrisRelief)),
        smooth_gloss: true,
        ..MaterialTextures::default()
    };
    let iris = object.part_materials.iter_mut().find(|(part, material)| part == "iris" && material.textures == painted);
    if let Some((_, iris)) = iris {
        iris.textures = iris_textures();
        object.part_materials.retain(|(part, _)| part != PUPIL);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::EYE_COLORS;
    use crate::io::presets;
    use crate::scene::Material;

    #[test]
    fn the_eyes_of_the_shipped_people_have_colors_to_choose_from() {
        let scenes: Vec<_> = presets().iter().map(|preset| preset.scene().unwrap()).collect();
        let people = scenes.iter().flat_map(|scene| &scene.objects).filter(|o| matches!(o.shape, Shape::Figure(_)));
        let irises: Vec<_> = people.map(|person| (&person.name, person.material_of("iris"))).collect();
        assert!(irises.len() >= 12, "{}", irises.len());
        for (name, iris) in irises {
            assert!(EYE_COLORS.iter().any(|color| color.material() == *iris), "{name}: {iris:?}");
        }
    }

    #[test]
    fn a_painted_iris_goes_under_the_cornea_and_keeps_its_color() {
        let material = |textures| Material { base_color: [0.1, 0.2, 0.3], textures, ..Material::default() };
        let relief = TextureRef::Builtin(BuiltinTexture::IrisRelief);
        let painted = MaterialTextures { normal: Some(relief), smooth_gloss: true, ..MaterialTextures::default() };
        let plain = MaterialTextures::default();
        for (shape, before, after) in [
            (Shape::Figure(Box::default()), &painted, &iris_textures()),
            (Shape::Figure(Box::default()), &iris_textures(), &iris_textures()),
            (Shape::Figure(Box::default()), &plain, &plain),
            (Shape::Sphere { radius_m: 0.1 }, &painted, &painted),
        ] {
            let mut object = Object::new("Woman", shape);
            let parts = ["iris", PUPIL].map(|part| (part.to_owned(), material(before.clone())));
            object.part_materials = parts.to_vec();
            put_under_cornea(&mut object);
            assert_eq!(object.part_materials[0], ("iris".to_owned(), material(after.clone())));
            let is_put = before != after;
            assert_eq!(object.part_materials.len(), if is_put { 1 } else { 2 });
        }
    }
}
