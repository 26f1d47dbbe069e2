//! The coarse version of a large picture, whose first pass takes its time: the first samples of every second, fourth ...
//! pixel across and down.
//!
//! They are traced before those of the other pixels and stay the picture's own, so that the coarse version costs no
//! time.

use super::film::{Film, FilmTile};
use super::settings::Settings;

/// Pixels above which a picture has a coarse version.
const LARGE: u64 = 150_000;
/// Most pixels of the coarse version: those of a portrait of 720x1080 at half the size, less than a second on two cores.
const MOST_COARSE: u64 = 200_000;

/// The pixels of a large picture that make its coarse version: one in each square of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoarseGrid {
    /// Side of a square, pixels.
    step: u32,
    /// Size of the picture, pixels.
    size: (u32, u32),
}

impl CoarseGrid {
    /// Returns the grid of a render; none where the picture is small.
    pub fn of(settings: &Settings) -> Option<Self> {
        let grids = (1..32).map(|halvings| CoarseGrid { step: 1 << halvings, size: (settings.width, settings.height) });
        (settings.pixels() > LARGE).then_some(grids)?.find(|grid| grid.settings(settings).pixels() <= MOST_COARSE)
    }

    /// Returns the settings of the coarse version.
    pub fn settings(&self, settings: &Settings) -> Settings {
        let (width, height) = (self.size.0.div_ceil(self.step), self.size.1.div_ceil(self.step));
        Settings { width, height, spp: 1, ..settings.clone() }
    }

    /// Returns the pixel of the picture that stands for one of the coarse version: that at the middle of its square.
    pub fn pixel(&self, (x, y): (u32, u32)) -> (u32, u32) {
        let along = |index: u32, size: u32| (index * self.step + self.step / 2).min(size - 1);
        (along(x, self.size.0), along(y, self.size.1))
    }

    /// Returns the pixel of the coarse version for which one of the picture stands, if it does.
    fn coarse_pixel(&self, (x, y): (u32, u32)) -> Option<(u32, u32)> {
        let coarse = (x / self.step, y / self.step);
        (self.pixel(coarse) == (x, y)).then_some(coarse)
    }
}

/// The traced coarse version of a picture.
#[derive(Clone, Copy, Debug)]
pub struct CoarseFilm<'a> {
    /// Where its pixels are in the picture.
    pub grid: CoarseGrid,
    /// The samples.
    pub film: &'a Film,
}

impl CoarseFilm<'_> {
    /// Copies the first sample of a pixel to an empty tile. Returns false where the coarse version has none.
    pub fn copy_to(&self, tile: &mut FilmTile, pixel: usize) -> bool {
        let Some((x, y)) = self.grid.coarse_pixel(tile.position(pixel)) else { return false };
        let (source, index) = self.film.pixel_at(x, y);
        tile.take_pixel(pixel, source, index);
        true
    }
}

/// The pixels of a film that a pass traces.
#[derive(Clone, Copy, Debug)]
pub enum PassPixels<'a> {
    /// All.
    All,
    /// All of the coarse version on this grid.
    Coarse(CoarseGrid),
    /// All but those that take their sample from the coarse version.
    Rest(CoarseFilm<'a>),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{RenderControl, TracedFilm, empty_film, prepare, render, resume, resume_coarse_first};
    use crate::scene::{Assets, Camera, Emitter, Light, Material, Object, Output, Room, Scene, Shape, Transform};
    use glam::Vec3;
    use std::ops::ControlFlow;

    #[test]
    fn the_coarse_version_has_the_shape_of_a_large_picture_and_few_pixels() {
        let coarse = |width, height| {
            let settings = Settings { width, height, spp: 64, ..Settings::default() };
            let coarse = CoarseGrid::of(&settings)?.settings(&settings);
            Some((coarse.width, coarse.height, coarse.spp))
        };
        assert_eq!(coarse(320, 240), None);
        assert_eq!(coarse(720, 1080), Some((360, 540, 1)));
        assert_eq!(coarse(3840, 2160), Some((480, 270, 1)));
        assert!(coarse(u32::MAX, 1).is_some_and(|(width, height, _)| width <= 200_000 && height == 1));
    }

    #[test]
    fn every_square_of_the_grid_has_a_pixel_also_at_the_edges() {
        for size in [(700, 401), (701, 403), (5001, 3999)] {
            let settings = Settings { width: size.0, height: size.1, ..Settings::default() };
            let grid = CoarseGrid::of(&settings).unwrap();
            let coarse = grid.settings(&settings);
            for x in 0..coarse.width {
                for y in [0, 1, coarse.height - 1] {
                    let pixel = grid.pixel((x, y));
                    assert!(pixel.0 < size.0 && pixel.1 < size.1, "{pixel:?}");
                    assert_eq!(grid.coarse_pixel(pixel), Some((x, y)));
                }
            }
            let row = coarse.height / 2;
            let y = grid.pixel((0, row)).1;
            let taken = (0..size.0).filter(|x| grid.coarse_pixel((*x, y)).is_some()).count();
            assert_eq!(taken as u32, coarse.width);
        }
    }

    /// A mirror ball in a room under a bulb: caustics come from photons.
    fn studio() -> Scene {
        let light = Light { position: Vec3::new(1.0, 2.0, 1.0), ..Light::new(Emitter::Point, Output::Lumens(1000.0)) };
        let ball = Object {
            transform: Transform::at(Vec3::Y * 0.8),
            material: Material { metallic: 1.0, roughness: 0.0, ..Material::default() },
            ..Object::new("Ball", Shape::Sphere { radius_m: 0.4 })
        };
        let camera = Camera { position: Vec3::new(0.0, 1.2, 2.5), ..Camera::default() };
        Scene { room: Some(Room::default()), lights: vec![light], objects: vec![ball], camera, ..Scene::default() }
    }

    #[test]
    fn a_picture_has_the_same_bits_with_and_without_its_coarse_version() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 503, height: 301, spp: 2, aovs: true, ..Settings::default() };
        let grid = CoarseGrid::of(&settings).unwrap();
        let (mut coarse, mut samples) = (None, Vec::new());
        let control = RenderControl::new();
        let empty = empty_film(&prepared, &settings);
        let film = resume_coarse_first(&prepared, &settings, empty.clone(), &control, &mut |traced| {
            samples.push(control.samples_done());
            if let TracedFilm::Coarse(film) = traced {
                coarse = Some(film.clone());
            }
            ControlFlow::Continue(())
        });
        let mut first = None;
        let alone = render(&prepared, &settings, &RenderControl::new(), &mut |film| {
            first.get_or_insert_with(|| film.develop(&scene));
            ControlFlow::Continue(())
        });
        assert!(film.approximations().photons);
        assert_eq!(film.develop_layers(&scene), alone.develop_layers(&scene));
        assert_eq!(film.aovs(), alone.aovs());
        assert_eq!(film.tile_noise(), alone.tile_noise());
        // No sample is traced twice
        let pixels = settings.pixels();
        assert_eq!(samples, [grid.settings(&settings).pixels(), pixels, 2 * pixels]);
        // The coarse version is the first sample of its pixels
        let (coarse, first) = (coarse.unwrap().develop(&scene), first.unwrap());
        assert_eq!((coarse.width, coarse.height), (252, 151));
        for (x, y) in [(0, 0), (100, 70), (251, 150)] {
            let (px, py) = grid.pixel((x, y));
            assert_eq!(coarse.at(x, y), first.at(px, py));
        }
        // A film with samples has no coarse version
        let settings = Settings { spp: 3, ..settings };
        let mut stages = Vec::new();
        let further = resume_coarse_first(&prepared, &settings, film.clone(), &RenderControl::new(), &mut |traced| {
            stages.push(matches!(traced, TracedFilm::Pass(_)));
            ControlFlow::Continue(())
        });
        assert_eq!((stages, further.spp()), (vec![true], 3));
        let resumed = resume(&prepared, &settings, film, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        assert_eq!(further.develop(&scene), resumed.develop(&scene));
    }

    #[test]
    fn a_render_that_is_cancelled_after_its_coarse_version_has_no_sample() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 503, height: 301, spp: 2, ..Settings::default() };
        let control = RenderControl::new();
        let empty = empty_film(&prepared, &settings);
        let film = resume_coarse_first(&prepared, &settings, empty, &control, &mut |_| {
            control.cancel();
            ControlFlow::Continue(())
        });
        assert_eq!((film.spp(), film.mean_spp()), (0, 0.0));
        assert!(film.develop(&scene).rgb.iter().all(|rgb| *rgb == [0.0; 3]), "nothing is left of it in the film");
    }
}
