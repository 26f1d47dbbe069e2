//! The light on the surface under the pointer, read in the background.

use super::threads::{Priority, background_pool};
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::photo::meter::{Reading, Receptor};
use crate::raytrace::{GeometryCache, LightMeter, MeterEffort, MeterPoint};
use crate::scene::{Assets, Scene};
use glam::Vec3;
use std::sync::Arc;

/// Distance of the receptor from the surface, metres.
const CLEARANCE_M: f32 = 1e-3;
/// Distance between two views beyond which a studio is prepared again, metres, for floating-point accuracy.
const FAR_M: f32 = 3.0;

/// A ray of a view, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotRay {
    /// Its origin.
    pub origin: Vec3,
    /// Its unit direction.
    pub direction: Vec3,
}

/// What a reading is of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SpotSubject {
    /// Revision of the studio.
    revision: u64,
    ray: SpotRay,
}

#[derive(Debug)]
struct Request {
    scene: Arc<Scene>,
    assets: Assets,
    subject: SpotSubject,
}

/// A reading of the light on the first surface of a ray; none where it meets no surface.
type SpotResult = (SpotSubject, Option<Reading>);

/// The reading of the light on the surface under the pointer.
#[derive(Debug)]
pub struct SpotMeterJob {
    worker: Worker<Request, SpotResult>,
    /// The studio of a revision.
    scene: Option<(u64, Arc<Scene>)>,
    requested: Option<SpotSubject>,
    latest: Option<SpotResult>,
}

/// Only the newest place of the pointer counts.
const WORKER: WorkerSettings = WorkerSettings {
    name: "spot",
    priority: Priority::Background,
    interrupt: Interrupt::Always,
    panic_message: "The spot could not be read, because of an internal error.",
};

impl SpotMeterJob {
    /// Returns a job that shares BVHs of meshes with renders and live view.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        let work = move |inbox: &Inbox<Request, SpotResult>| serve(inbox, &cache);
        SpotMeterJob { worker: Worker::new(WORKER, work), scene: None, requested: None, latest: None }
    }

    /// Requests a reading when ray or studio have changed, and takes in the newest result. Returns the reading of the
    /// light on the first surface of the ray, if it is there already.
    pub fn read(
        &mut self,
        scene: &Scene,
        assets: &Assets,
        revision: u64,
        ray: SpotRay,
        wake: &Wake,
    ) -> Option<&Reading> {
        match self.worker.take() {
            Some(Ok(result)) => self.latest = Some(result),
            // Stops and display values are shown without it
            Some(Err(message)) => log::debug!("no light at the spot: {message}"),
            None => {}
        }
        let subject = SpotSubject { revision, ray };
        if self.requested != Some(subject) {
            let known = self.scene.take().filter(|(of, _)| *of == revision);
            let (_, scene) = self.scene.insert(known.unwrap_or_else(|| (revision, Arc::new(scene.clone()))));
            self.worker.request(Request { scene: scene.clone(), assets: assets.clone(), subject }, wake);
            self.requested = Some(subject);
        }
        self.latest.as_ref().filter(|(of, _)| *of == subject).and_then(|(_, reading)| reading.as_ref())
    }

    /// Returns true while a reading is running.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}

/// A studio that is prepared for readings.
struct PreparedStudio {
    revision: u64,
    around: Vec3,
    meter: LightMeter,
}

/// The body of the thread.
fn serve(inbox: &Inbox<Request, SpotResult>, cache: &GeometryCache) {
    let pool = match background_pool(0, "spot") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail_all(&format!("No threads to read the spot with: {error}.")),
    };
    let mut prepared: Option<PreparedStudio> = None;
    while let Some((Request { scene, assets, subject }, control)) = inbox.next() {
        let SpotSubject { revision, ray } = subject;
        let is_of = |studio: &PreparedStudio| studio.revision == revision && studio.around.distance(ray.origin) < FAR_M;
        let studio = match prepared.take().filter(is_of) {
            Some(studio) => studio,
            None => match pool.install(|| LightMeter::kept(&scene, &assets, ray.origin, cache)) {
                Ok(meter) => PreparedStudio { revision, around: ray.origin, meter },
                Err(error) => {
                    inbox.fail(error.to_string());
                    continue;
                }
            },
        };
        let meter = &prepared.insert(studio).meter;
        let reading = meter.first_surface(ray.origin, ray.direction, f32::INFINITY).and_then(|surface| {
            let position = surface.position + CLEARANCE_M * surface.normal;
            let point = MeterPoint { position, facing: surface.normal, receptor: Receptor::Flat };
            pool.install(|| meter.read(&point, &MeterEffort::quick(), &control)).map(|result| result.reading)
        });
        if !control.is_cancelled() {
            inbox.publish((subject, reading));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Light, Object, Output, Shape};
    use std::time::Duration;

    #[test]
    fn the_light_on_the_surface_under_the_pointer_is_read_by_light() {
        // A point light of 800 cd, 2 m above a black floor: 200 lx below it
        let mut scene = Scene::default();
        let mut light = Light::new(Emitter::Point, Output::Candela(800.0));
        (light.position, light.name) = (Vec3::new(0.0, 2.0, 0.0), "Lamp".to_owned());
        scene.lights.push(light);
        let mut floor = Object::new("Floor", Shape::Plane { width_m: 4.0, depth_m: 4.0 });
        floor.material.base_color = [0.0; 3];
        scene.objects.push(floor);
        let mut job = SpotMeterJob::new(Arc::default());
        let (sender, receiver) = std::sync::mpsc::channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let mut read = |direction: Vec3| {
            let ray = SpotRay { origin: Vec3::new(0.0, 1.0, 0.0), direction };
            let assets = Assets::default();
            assert!(job.read(&scene, &assets, 1, ray, &wake).is_none(), "nothing is read yet");
            receiver.recv_timeout(Duration::from_secs(60)).unwrap();
            job.read(&scene, &assets, 1, ray, &wake).cloned()
        };
        let reading = read(Vec3::NEG_Y).unwrap();
        let [lamp] = &reading.lights[..] else { panic!("{reading:?}") };
        assert!(lamp.name == "Lamp" && (lamp.sum() / 200.0 - 1.0).abs() < 0.01, "{lamp:?}");
        assert_eq!(read(Vec3::Y), None, "there is no surface above");
    }
}
