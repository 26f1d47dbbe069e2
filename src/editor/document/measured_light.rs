//! Lights with photometric files: reading a file for the window, and putting it on a light.

use crate::io;
use crate::jobs::sentence;
use crate::photo::PhotometricLight;
use crate::scene::{Camera, Emitter, IntensityTable, Light, Modifier, Output, Power};
use glam::Affine3A;
use std::path::PathBuf;
use std::sync::Arc;

/// Part of the flux that a panel must keep to stand for a luminaire: with less, much of the light goes to the back.
const LEAST_PANEL_PART: f32 = 0.9;

/// A photometric file that was read.
#[derive(Clone, Debug)]
pub struct MeasuredFile {
    /// File.
    pub file: PathBuf,
    /// The distribution.
    pub table: Arc<IntensityTable>,
    /// What is odd about the file.
    pub warnings: Vec<String>,
}

/// Reads a photometric file; an error is a message to the user.
pub fn read(file: PathBuf) -> Result<Box<MeasuredFile>, String> {
    let read = io::read_photometric_file(&file).map_err(|error| sentence(&error))?;
    Ok(Box::new(MeasuredFile { file, table: Arc::new(read.table), warnings: read.warnings }))
}

/// Gives a light the distribution and the flux of a photometric file, without a modifier and at full power.
pub fn put_on(light: &mut Light, path: String, table: &IntensityTable) {
    light.photometric_file = Some(path);
    light.modifier = Modifier::default();
    light.head = None;
    light.power = as_file_says(table);
    // The file takes the place of a cone
    if light.emitter.is_infinite() || matches!(light.emitter, Emitter::Spot { .. }) {
        light.emitter = Emitter::Point;
    }
}

/// Returns the power that the file states.
pub fn as_file_says(table: &IntensityTable) -> Power {
    Power { output: Output::Lumens(table.flux_lm()), dial_stops: 0.0 }
}

/// Returns a new light with the luminous opening of a photometric file: a panel where nearly all light goes to its
/// front, otherwise a point or a bulb.
pub fn new_light(path: String, table: &Arc<IntensityTable>) -> Light {
    let mut light = Light::new(table.opening, as_file_says(table).output);
    let name = if table.luminaire.is_empty() { "Measured light" } else { &table.luminaire };
    light.name = name.chars().take(40).collect::<String>().trim().to_owned();
    put_on(&mut light, path, table);
    if matches!(light.emitter, Emitter::RectPanel { .. } | Emitter::RoundPanel { .. }) {
        let flux =
            PhotometricLight::in_frame(&light, Some(table.clone()), Affine3A::IDENTITY, &Camera::default()).flux();
        if flux < LEAST_PANEL_PART * table.flux_lm() {
            light.emitter = Emitter::Point;
        }
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(vertical_end: f32) -> Arc<IntensityTable> {
        let mut table = IntensityTable::new(vec![0.0, vertical_end], vec![0.0], vec![500.0; 2]).unwrap();
        table.opening = Emitter::RectPanel { width_m: 0.3, height_m: 0.6 };
        table.luminaire = "Own works Downlight".to_owned();
        Arc::new(table)
    }

    #[test]
    fn a_new_light_has_the_opening_of_its_file_unless_it_shines_backwards() {
        let down = new_light("lamps/a.ies".to_owned(), &table(60.0));
        assert_eq!(down.emitter, Emitter::RectPanel { width_m: 0.3, height_m: 0.6 });
        assert_eq!(
            (down.name.as_str(), down.photometric_file.as_deref()),
            ("Own works Downlight", Some("lamps/a.ies"))
        );
        let around = new_light("lamps/a.ies".to_owned(), &table(180.0));
        assert_eq!(around.emitter, Emitter::Point);
    }

    #[test]
    fn a_light_that_gets_a_file_shines_as_the_file_says() {
        let mut light = Light::new(Emitter::Sun { angular_diameter_deg: 0.5 }, Output::Lux(1000.0));
        (light.modifier, light.power.dial_stops) = (Modifier::loss(1.0), -2.0);
        let table = table(180.0);
        put_on(&mut light, "a.ies".to_owned(), &table);
        assert_eq!(light.emitter, Emitter::Point);
        let light = PhotometricLight::in_frame(&light, Some(table), Affine3A::IDENTITY, &Camera::default());
        assert!((light.axial_intensity() - 500.0).abs() < 1e-2, "{} cd", light.axial_intensity());
    }
}
