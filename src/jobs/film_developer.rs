//! Development of films in the background, with the lights as they are now, denoised on request.

use super::denoised_film::DenoisedFilm;
use super::threads::Priority;
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::denoise::Quality;
use crate::photo::Picture;
use crate::raytrace::{Film, RenderControl};
use crate::scene::Scene;
use std::sync::{Arc, Weak};

/// A developed film.
#[derive(Debug)]
pub struct Developed<I> {
    /// The film that it was developed from.
    pub film: Weak<Film>,
    /// Scene-linear, for export.
    pub picture: Arc<Picture>,
    /// The picture before the denoiser; none if `picture` is not denoised.
    pub noisy: Option<Arc<Picture>>,
    /// Name of the denoiser, for the picture's file.
    pub denoiser: Option<&'static str>,
    /// For the screen.
    pub image: I,
    /// Samples per pixel.
    pub spp: u32,
    /// Name of the method, for the picture's file.
    pub method: &'static str,
}

/// What is made of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Development {
    /// Longest side of the image for the screen, pixels.
    pub max_side: usize,
    /// The picture is denoised.
    pub denoise: bool,
    /// The film has all samples. A film that will be replaced soon is denoised by the small network.
    pub is_final: bool,
}

/// A film to be developed.
#[derive(Debug)]
struct Request {
    film: Arc<Film>,
    scene: Scene,
    development: Development,
}

/// A worker that develops films. Only the newest request counts.
#[derive(Debug)]
pub struct FilmDeveloper<I> {
    worker: Worker<Request, Developed<I>>,
}

/// A relit picture follows a slider: its thread has the priority of the window's.
const WORKER: WorkerSettings = WorkerSettings {
    name: "develop",
    priority: Priority::Normal,
    interrupt: Interrupt::AfterResult,
    panic_message: "The picture could not be developed, because of an internal error.",
};

impl<I: Send + 'static> FilmDeveloper<I> {
    /// Returns a developer. `to_image` makes a picture's image for the screen, with a longest side in pixels.
    pub fn new(to_image: fn(&Picture, usize) -> I) -> Self {
        let work = move |inbox: &Inbox<Request, Developed<I>>| {
            let mut denoised = DenoisedFilm::default();
            while let Some((request, control)) = inbox.next() {
                let publish = |picture: Picture, noisy: Option<Picture>, quality: Option<Quality>| {
                    let image = to_image(&picture, request.development.max_side);
                    inbox.publish(Developed {
                        film: Arc::downgrade(&request.film),
                        picture: Arc::new(picture),
                        noisy: noisy.map(Arc::new),
                        denoiser: quality.map(Quality::label),
                        image,
                        spp: request.film.spp(),
                        method: request.film.method(),
                    });
                };
                develop(&request, &control, &mut denoised, &publish);
            }
        };
        FilmDeveloper { worker: Worker::new(WORKER, work) }
    }

    /// Requests a picture with the lights of `scene`.
    pub fn request(&mut self, film: Arc<Film>, scene: Scene, development: Development, wake: &Wake) {
        self.worker.request(Request { film, scene, development }, wake);
    }

    /// Takes the newest picture, or the message of an error.
    pub fn take(&self) -> Option<Result<Developed<I>, String>> {
        self.worker.take()
    }

    /// Returns true while there is a picture to be developed or to be taken.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}

/// Develops a film and publishes its picture.
///
/// A final film is denoised by the whole network. When its lights change, the small network gives a first picture; then
/// all layers are denoised, from which every later change of the lights follows at once.
fn develop(
    Request { film, scene, development }: &Request,
    control: &RenderControl,
    denoised: &mut DenoisedFilm,
    publish: &dyn Fn(Picture, Option<Picture>, Option<Quality>),
) {
    let noisy = film.develop(scene);
    if !development.denoise {
        return publish(noisy, None, None);
    }
    if let Some(picture) = denoised.relit(film, scene) {
        return publish(picture, Some(noisy), Some(Quality::Best));
    }
    let is_relit = denoised.holds(film) && development.is_final;
    let quality = if development.is_final && !is_relit { Quality::Best } else { Quality::Fast };
    match denoised.whole(film, &noisy, quality, control) {
        Some(picture) => publish(picture, Some(noisy.clone()), Some(quality)),
        None => return publish(noisy, None, None),
    }
    if is_relit
        && denoised.denoise_layers(film, scene, Quality::Best, control).is_ok()
        && let Some(picture) = denoised.relit(film, scene)
    {
        publish(picture, Some(noisy), Some(Quality::Best));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::render_all_passes;
    use crate::raytrace::{Settings, prepare};
    use crate::scene::{Assets, Emitter, Light, Output, Room};
    use std::cell::RefCell;

    #[test]
    fn films_are_denoised_as_far_as_they_are_rendered_and_relit_from_their_layers() {
        let mut scene = Scene {
            room: Some(Room::default()),
            lights: vec![Light::new(Emitter::Point, Output::Lumens(1000.0))],
            ..Scene::default()
        };
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let render = |aovs| {
            let settings = Settings { width: 32, height: 32, spp: 1, aovs, ..Settings::default() };
            Arc::new(render_all_passes(&prepared, &settings, &RenderControl::new()))
        };
        let (film, without_aovs) = (render(true), render(false));
        let mut denoised = DenoisedFilm::default();
        // Returns the networks of the pictures that are published, and the last picture
        let mut published = |film: &Arc<Film>, scene: &Scene, denoise: bool, is_final: bool| {
            let development = Development { max_side: 100, denoise, is_final };
            let request = Request { film: film.clone(), scene: scene.clone(), development };
            let all = RefCell::new((Vec::new(), Picture::default()));
            develop(&request, &RenderControl::new(), &mut denoised, &|picture, noisy, quality| {
                assert_eq!(noisy.is_some(), quality.is_some());
                assert!(noisy.is_none_or(|noisy| noisy == film.develop(scene)));
                let mut all = all.borrow_mut();
                all.0.push(quality);
                all.1 = picture;
            });
            all.into_inner()
        };
        assert_eq!(published(&film, &scene, false, true), (vec![None], film.develop(&scene)));
        assert_eq!(published(&film, &scene, true, false).0, [Some(Quality::Fast)], "while it renders");
        let other = render(true);
        let (qualities, whole) = published(&other, &scene, true, true);
        assert_eq!(qualities, [Some(Quality::Best)], "once it is final");
        scene.lights[0].power.dial_stops = 1.0;
        assert_eq!(published(&other, &scene, true, true).0, [Some(Quality::Fast), Some(Quality::Best)], "relit");
        scene.lights[0].power.dial_stops = 0.0;
        let (qualities, relit) = published(&other, &scene, true, true);
        assert_eq!(qualities, [Some(Quality::Best)], "relit from the layers");
        // The scale of the network's input takes up the stop: rounding alone differs, most in the darkest pixels.
        let sum = |picture: &Picture| picture.rgb.iter().flatten().sum::<f32>();
        assert!((sum(&relit) / sum(&whole) - 1.0).abs() < 1e-4, "{} {}", sum(&relit), sum(&whole));
        assert_eq!(published(&without_aovs, &scene, true, true).0, [None]);
    }
}
