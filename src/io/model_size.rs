//! The size of imported models: the unit of their files.

use crate::scene::{Mesh, Object};
use glam::Vec3;

/// Units of model files, with their length in metres.
pub const MODEL_UNITS: [(&str, f32); 4] = [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)];
/// Smallest extent of a thing in a studio, metres: a ring.
const SMALLEST_M: f32 = 0.01;
/// Largest extent of a model in metres, a car, and of one in another unit, metres: what is 300 long has millimetres.
const LARGEST_M: [f32; 2] = [6.0, 2.5];

/// Returns the unit of a model by its extent: the largest of metres, centimetres and millimetres in which it fits a studio.
fn guessed_unit(extent: f32) -> (&'static str, f32) {
    let is_plausible = |(_, metres): &&(&str, f32)| {
        let largest_m = if *metres == 1.0 { LARGEST_M[0] } else { LARGEST_M[1] };
        (SMALLEST_M..=largest_m).contains(&(extent * metres))
    };
    MODEL_UNITS[..3].iter().find(is_plausible).copied().unwrap_or(MODEL_UNITS[0])
}

/// Gives an imported model a plausible size and stands it on the floor. Returns a sentence if its unit is not metres.
pub fn fit_model(object: &mut Object, mesh: &Mesh) -> Option<String> {
    let (low, high) = mesh.bounds();
    let (unit, metres) = guessed_unit((high - low).max_element());
    object.transform.scale = Vec3::splat(metres);
    object.transform.position.y = -low.y * metres;
    let height = 100.0 * metres * (high.y - low.y);
    (metres != 1.0).then(|| {
        format!(
            "{} is taken to be in {unit}: {height:.1} cm high. Its inspector has other units and its height.",
            object.name
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Shape, tessellate};

    #[test]
    fn a_model_gets_the_unit_in_which_it_fits_a_studio_and_stands_on_the_floor() {
        for (edge, height_m) in
            [(1.8, 1.8), (0.05, 0.05), (30.0, 0.3), (180.0, 1.8), (300.0, 0.3), (800.0, 0.8), (1e-4, 1e-4), (1e9, 1e9)]
        {
            let shape = Shape::Box { size_m: Vec3::splat(edge) };
            let mesh = tessellate(&shape).unwrap();
            let mut object = Object::new("Model", shape);
            let told = fit_model(&mut object, &mesh);
            assert!((object.transform.scale.y * edge / height_m - 1.0).abs() < 1e-5, "{edge}");
            assert!((object.transform.position.y / (0.5 * height_m) - 1.0).abs() < 1e-5, "{edge}");
            assert_eq!(told.is_some(), edge != height_m, "{told:?}");
        }
    }
}
