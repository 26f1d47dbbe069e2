//! Development of films in the background, with the lights as they are now, denoised on request.

use super::denoised_film::DenoisedFilm;
use super::threads::Priority;
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::denoise::Quality;
use crate::photo::{Picture, PictureDisplay};
use crate::raytrace::{Film, RenderControl};
use crate::scene::{Scene, SceneChange};
use std::cell::RefCell;
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

/// A developed film.
#[derive(Debug)]
pub struct Developed<I> {
    /// The film that it was developed from.
    pub film: Weak<Film>,
    /// Scene-linear, for export.
    pub picture: Arc<Picture>,
    /// The picture before the denoiser; none if `picture` is not denoised.
    pub noisy: Option<Arc<Picture>>,
    /// The network that denoised the picture; none if it is not denoised.
    pub denoiser: Option<Quality>,
    /// For the screen.
    pub image: I,
    /// Samples per pixel.
    pub spp: u32,
    /// Name of the method, for the picture's file.
    pub method: String,
    /// Time that its development took.
    pub took: Duration,
    /// When it was developed.
    pub at: Instant,
}

impl<I> Developed<I> {
    /// Returns how long the next film, of so many pixels, of a render should still wait that has run for some time:
    /// development takes the processors from tracing.
    pub fn pause(&self, pixels: u64, rendered: Duration) -> Duration {
        let own = u64::from(self.picture.width) * u64::from(self.picture.height);
        let next_takes = self.took.mul_f64(pixels as f64 / own.max(1) as f64);
        pause_after(next_takes, rendered).saturating_sub(self.at.elapsed())
    }
}

/// Time between two pictures of a running render, in times of a development: it takes a fifth of the processors, at
/// most.
const DEVELOPMENTS_APART: u32 = 4;
/// Part of a render's time in which nothing new is seen, and the longest pause for it.
const PART_APART: f64 = 0.1;
const LONGEST_APART: Duration = Duration::from_secs(10);

/// Returns the pause before a development that takes so long in a render that has run for some time.
fn pause_after(took: Duration, rendered: Duration) -> Duration {
    (took * DEVELOPMENTS_APART).max(rendered.mul_f64(PART_APART).min(LONGEST_APART))
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
    /// How the image for the screen displays the picture.
    pub display: PictureDisplay,
}

/// A film to be developed.
#[derive(Debug)]
struct Request {
    film: Arc<Film>,
    scene: Scene,
    development: Development,
}

/// A picture of a film.
#[derive(Debug)]
struct DevelopedPicture {
    picture: Arc<Picture>,
    /// The picture before the denoiser, and its network.
    noisy: Option<Arc<Picture>>,
    quality: Option<Quality>,
}

/// The picture that was developed last. To display it otherwise, it need not be developed again.
#[derive(Debug)]
struct LastPicture {
    film: Weak<Film>,
    scene: Scene,
    development: Development,
    picture: DevelopedPicture,
}

impl LastPicture {
    fn new(Request { film, scene, development }: &Request, picture: DevelopedPicture) -> Self {
        let (film, scene, development) = (Arc::downgrade(film), scene.clone(), *development);
        LastPicture { film, scene, development, picture }
    }

    /// Returns true if a request is for the same picture.
    fn is_of(&self, request: &Request) -> bool {
        let development = Development { display: request.development.display, ..self.development };
        self.film.as_ptr() == Arc::as_ptr(&request.film)
            && development == request.development
            && !SceneChange::between(&self.scene, &request.scene).needs_development()
    }
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
    /// Returns a developer. `to_image` makes a picture's image for the screen.
    pub fn new(to_image: fn(&Picture, &Development) -> I) -> Self {
        let work = move |inbox: &Inbox<Request, Developed<I>>| {
            let mut denoised = DenoisedFilm::default();
            let mut last: Option<LastPicture> = None;
            while let Some((request, control)) = inbox.next() {
                let started = Instant::now();
                let show = |picture: &DevelopedPicture| {
                    inbox.publish(Developed {
                        film: Arc::downgrade(&request.film),
                        picture: picture.picture.clone(),
                        noisy: picture.noisy.clone(),
                        denoiser: picture.quality,
                        image: to_image(&picture.picture, &request.development),
                        spp: request.film.spp(),
                        method: request.film.method(),
                        took: started.elapsed(),
                        at: Instant::now(),
                    });
                };
                if let Some(last) = last.as_ref().filter(|last| last.is_of(&request)) {
                    show(&last.picture);
                    continue;
                }
                let newest = RefCell::new(None);
                develop(&request, &control, &mut denoised, &|picture, noisy, quality| {
                    let picture = DevelopedPicture { picture: Arc::new(picture), noisy: noisy.map(Arc::new), quality };
                    show(&picture);
                    newest.replace(Some(picture));
                });
                let newest = newest.into_inner().filter(|_| !control.is_cancelled());
                last = newest.map(|picture| LastPicture::new(&request, picture));
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
            let development = Development { max_side: 100, denoise, is_final, display: PictureDisplay::Plain };
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

    #[test]
    fn the_pictures_of_a_running_render_leave_it_most_of_the_time() {
        let pause = |took: f64, rendered: f64| {
            pause_after(Duration::from_secs_f64(took), Duration::from_secs_f64(rendered)).as_secs_f64()
        };
        assert_eq!(pause(0.5, 1.0), 2.0, "a development takes a fifth of the time");
        assert_eq!(pause(0.5, 60.0), 6.0, "less in a long render, which changes slowly");
        assert_eq!(pause(0.5, 6000.0), 10.0, "and is still seen to go on");
    }

    #[test]
    fn the_pause_after_a_coarse_picture_is_that_of_the_whole_ones_development() {
        let developed = Developed {
            film: Weak::new(),
            picture: Arc::new(Picture { width: 100, height: 50, rgb: Vec::new() }),
            noisy: None,
            denoiser: None,
            image: (),
            spp: 1,
            method: "path".to_owned(),
            took: Duration::from_secs(1),
            at: Instant::now(),
        };
        let pause = |pixels| developed.pause(pixels, Duration::from_secs(1)).as_secs_f64();
        assert!((3.0..=4.0).contains(&pause(5000)) && (15.0..=16.0).contains(&pause(20_000)));
    }

    #[test]
    fn another_display_of_a_picture_shows_the_same_pixels_without_developing_them_again() {
        let scene = Scene { lights: vec![Light::new(Emitter::Point, Output::Lumens(1000.0))], ..Scene::default() };
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 16, height: 16, spp: 1, ..Settings::default() };
        let film = Arc::new(render_all_passes(&prepared, &settings, &RenderControl::new()));
        let mut developer = FilmDeveloper::new(|_, development| development.display);
        let mut developed = |scene: &Scene, display: PictureDisplay| {
            let development = Development { max_side: 100, denoise: false, is_final: true, display };
            developer.request(film.clone(), scene.clone(), development, &(Arc::new(|| ()) as Wake));
            loop {
                if let Some(developed) = developer.take() {
                    return developed.unwrap();
                }
                std::thread::yield_now();
            }
        };
        let (plain, colored) =
            (developed(&scene, PictureDisplay::Plain), developed(&scene, PictureDisplay::FalseColor));
        assert_eq!((plain.image, colored.image), (PictureDisplay::Plain, PictureDisplay::FalseColor));
        assert!(Arc::ptr_eq(&plain.picture, &colored.picture));
        let mut dimmed = scene.clone();
        dimmed.lights[0].power.dial_stops = -1.0;
        assert!(!Arc::ptr_eq(&developed(&dimmed, PictureDisplay::FalseColor).picture, &plain.picture));
    }
}
