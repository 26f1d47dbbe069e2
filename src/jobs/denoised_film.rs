//! A denoised film whose lights can be changed without denoising it anew.

use crate::denoise::{Cancelled, Quality, denoise, denoise_layers};
use crate::photo::Picture;
use crate::raytrace::{Film, RenderControl};
use crate::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// The newest film that was denoised, with its denoised layers once a light has changed.
#[derive(Debug, Default)]
pub(super) struct DenoisedFilm {
    film: Option<Arc<Film>>,
    layers: Option<DenoisedLights>,
}

/// Denoised layers, with the lights as in `scene`.
#[derive(Debug)]
struct DenoisedLights {
    scene: Scene,
    layers: Vec<Picture>,
}

impl DenoisedFilm {
    /// Returns true if this film was denoised last.
    pub fn holds(&self, film: &Arc<Film>) -> bool {
        self.film.as_ref().is_some_and(|held| Arc::ptr_eq(held, film))
    }

    /// Denoises the whole picture of a film. None if the film has no albedo and normals, or once `control` is
    /// cancelled.
    pub fn whole(
        &mut self,
        film: &Arc<Film>,
        noisy: &Picture,
        quality: Quality,
        control: &RenderControl,
    ) -> Option<Picture> {
        if !self.holds(film) {
            *self = DenoisedFilm { film: Some(film.clone()), layers: None };
        }
        denoise(noisy, &film.aovs()?, quality, &|| control.is_cancelled()).ok()
    }

    /// Denoises the layers of the film, with the lights as in `scene`, and keeps them.
    ///
    /// # Errors
    /// Once `control` is cancelled.
    pub fn denoise_layers(
        &mut self,
        film: &Film,
        scene: &Scene,
        quality: Quality,
        control: &RenderControl,
    ) -> Result<(), Cancelled> {
        let Some(aovs) = film.aovs() else { return Ok(()) };
        let layers: Vec<Picture> = film.develop_layers(scene).into_iter().map(|(_, layer)| layer).collect();
        let denoised =
            denoise_layers(&film.develop(scene), &layers, &aovs, quality, &|| control.is_cancelled())?.layers;
        self.layers = Some(DenoisedLights { scene: scene.clone(), layers: denoised });
        Ok(())
    }

    /// Returns the denoised picture with the lights of `scene`, from the layers. None if there are none, or if a light
    /// is on that was off when they were denoised.
    pub fn relit(&self, film: &Arc<Film>, scene: &Scene) -> Option<Picture> {
        let lights = self.layers.as_ref().filter(|_| self.holds(film))?;
        let factors = film.relight_factors(&lights.scene, scene)?;
        let layers: Vec<(&[[f32; 3]], Vec3)> =
            lights.layers.iter().map(|layer| layer.rgb.as_slice()).zip(factors).collect();
        let sum = |pixel: usize| -> [f32; 3] {
            layers.iter().map(|(layer, factor)| Vec3::from(layer[pixel]) * *factor).sum::<Vec3>().to_array()
        };
        let mut picture = Picture::new(film.width(), film.height());
        picture.rgb.par_iter_mut().enumerate().for_each(|(pixel, rgb)| *rgb = sum(pixel));
        Some(picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::render_all_passes;
    use crate::raytrace::{Settings, prepare};
    use crate::scene::{Assets, Emitter, Light, LightId, Output, Room};

    /// Returns a room with two lights, and its film.
    fn rendered() -> (Scene, Arc<Film>) {
        let light = |name: &str, id: u32, x: f32| Light {
            name: name.to_owned(),
            id: LightId(id),
            position: Vec3::new(x, 2.0, 0.0),
            ..Light::new(Emitter::Point, Output::Lumens(1000.0))
        };
        let lights = vec![light("Left", 1, -1.0), light("Right", 2, 1.0)];
        let scene = Scene { room: Some(Room::default()), lights, ..Scene::default() };
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 48, height: 32, spp: 2, aovs: true, ..Settings::default() };
        let film = render_all_passes(&prepared, &settings, &RenderControl::new());
        (scene, Arc::new(film))
    }

    fn sum(picture: &Picture) -> f32 {
        picture.rgb.iter().flatten().sum()
    }

    #[test]
    fn denoised_layers_follow_the_lights() {
        let (scene, film) = rendered();
        let control = RenderControl::new();
        let mut denoised = DenoisedFilm::default();
        assert!(denoised.relit(&film, &scene).is_none());
        let whole = denoised.whole(&film, &film.develop(&scene), Quality::Fast, &control).unwrap();
        denoised.denoise_layers(&film, &scene, Quality::Fast, &control).unwrap();
        let close = |a: &Picture, b: &Picture| {
            let values = a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
            // Three layers are rounded twice and added.
            values.for_each(|(a, b)| assert!((a - b).abs() <= 8.0 * f32::EPSILON * b.abs(), "{a} {b}"));
        };
        close(&denoised.relit(&film, &scene).unwrap(), &whole);
        // One stop more doubles the light
        let mut brighter = scene.clone();
        brighter.lights.iter_mut().for_each(|light| light.power.dial_stops += 1.0);
        let doubled =
            Picture { rgb: whole.rgb.iter().map(|rgb| rgb.map(|value| 2.0 * value)).collect(), ..whole.clone() };
        close(&denoised.relit(&film, &brighter).unwrap(), &doubled);
        // Lights that go off leave the others
        let mut alone = [scene.clone(), scene.clone()];
        alone[0].lights[1].on = false;
        alone[1].lights[0].on = false;
        let parts = alone.each_ref().map(|scene| denoised.relit(&film, scene).unwrap());
        assert!(parts.iter().all(|part| sum(part) > 0.0));
        assert!((sum(&parts[0]) + sum(&parts[1]) - sum(&whole)).abs() < 1e-4 * sum(&whole));
        // What was dark cannot be brightened
        denoised.denoise_layers(&film, &alone[0], Quality::Fast, &control).unwrap();
        assert!(denoised.relit(&film, &alone[0]).is_some() && denoised.relit(&film, &scene).is_none());
        // Another film has other layers
        assert!(denoised.relit(&Arc::new((*film).clone()), &alone[0]).is_none());
    }

    #[test]
    fn a_cancelled_film_keeps_no_layers() {
        let (scene, film) = rendered();
        let control = RenderControl::new();
        control.cancel();
        let mut denoised = DenoisedFilm::default();
        assert!(denoised.whole(&film, &film.develop(&scene), Quality::Fast, &control).is_none());
        assert_eq!(denoised.denoise_layers(&film, &scene, Quality::Fast, &control), Err(Cancelled));
        assert!(denoised.relit(&film, &scene).is_none());
    }
}
