//! The size of imported models: the unit of their files.

use crate::scene::{Mesh, Object};
use glam::Vec3;

/// Units of model files, with their length in metres.
pub const MODEL_UNITS: [(&str, f32); 4] = [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)];
/// Smallest extent of a thing in a studio, metres: a ring.
const SMALLEST_M: f32 = 0.01;
/// Largest extent of a model in metres, a car, and of one in another unit, metres: what is 300 long has millimetres.
const LARGEST_M: [f32; 2] = [6.0, 2.5];

/// Returns true if a model with this extent in a unit has the size of a thing in a studio.
fn is_plausible(extent: f32, metres: f32) -> bool {
    let largest_m = if metres == 1.0 { LARGEST_M[0] } else { LARGEST_M[1] };
    (SMALLEST_M..=largest_m).contains(&(extent * metres))
}

/// Returns the unit of a model by its extent: the largest of metres, centimetres and millimetres in which it fits a studio.
fn guessed_unit(extent: f32) -> (&'static str, f32) {
    let units = MODEL_UNITS[..3].iter().copied();
    units.clone().find(|(_, metres)| is_plausible(extent, *metres)).unwrap_or(MODEL_UNITS[0])
}

fn extent(mesh: &Mesh) -> f32 {
    let (low, high) = mesh.bounds();
    (high - low).max_element()
}

/// Returns the length in metres of the unit that a model is taken to have, by its size.
pub fn model_unit_m(mesh: &Mesh) -> f32 {
    guessed_unit(extent(mesh)).1
}

/// Returns true if the unit of a model should be asked for: no unit gives it the size of a thing in a studio, or its
/// format states metres and it is taken to have another unit.
pub fn is_model_size_doubtful(mesh: &Mesh, states_metres: bool) -> bool {
    let (extent, metres) = (extent(mesh), model_unit_m(mesh));
    !is_plausible(extent, metres) || (states_metres && metres != 1.0)
}

/// Scales an imported model to a unit of so many metres and stands it on the floor.
pub fn scale_model(object: &mut Object, mesh: &Mesh, metres: f32) {
    object.transform.scale = Vec3::splat(metres);
    object.transform.position.y = -mesh.bounds().0.y * metres;
}

/// Gives an imported model a plausible size and stands it on the floor. Returns a sentence if its unit is not metres.
pub fn fit_model(object: &mut Object, mesh: &Mesh) -> Option<String> {
    let (unit, metres) = guessed_unit(extent(mesh));
    scale_model(object, mesh, metres);
    let (low, high) = mesh.bounds();
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

    #[test]
    fn a_size_is_in_doubt_if_no_unit_fits_or_if_stated_metres_do_not() {
        for (edge, in_metres, without_unit) in [
            (0.3, false, false),
            (1.8, false, false),
            (30.0, true, false),
            (300.0, true, false),
            (1e-4, true, true),
            (1e9, true, true),
        ] {
            let mesh = tessellate(&Shape::Box { size_m: Vec3::splat(edge) }).unwrap();
            let doubts = [true, false].map(|states_metres| is_model_size_doubtful(&mesh, states_metres));
            assert_eq!(doubts, [in_metres, without_unit], "{edge}");
        }
    }
}
