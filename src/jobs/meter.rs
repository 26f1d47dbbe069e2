//! Light meter readings: first quick, then full. The command line reads once, the window in the background.

use super::threads::{Priority, background_pool};
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::photo::meter::Reading;
use crate::raytrace::{GeometryCache, LightMeter, MeterEffort, MeterPoint, MeterResult, PrepareError, RenderControl};
use crate::scene::{Assets, Meter, Scene};
use std::sync::Arc;

/// Reads the meter at `point` once for each effort, and calls `observe` with each result until `control` is cancelled.
///
/// # Errors
/// When the scene cannot be prepared.
pub fn read_meter(
    scene: &Scene,
    assets: &Assets,
    point: &MeterPoint,
    efforts: &[MeterEffort],
    cache: &GeometryCache,
    control: &RenderControl,
    observe: &mut dyn FnMut(MeterResult),
) -> Result<(), PrepareError> {
    let meter = LightMeter::kept(scene, assets, point.position, cache)?;
    efforts.iter().map_while(|effort| meter.read(point, effort, control)).for_each(observe);
    Ok(())
}

#[derive(Debug)]
struct Request {
    scene: Scene,
    assets: Assets,
    meter: Meter,
}

/// The reading of the studio's meter, in the background.
#[derive(Debug)]
pub struct MeterJob {
    worker: Worker<Request, Reading>,
    /// Revision of the document that was requested last.
    requested: Option<u64>,
    latest: Option<Result<Reading, String>>,
}

/// The quick reading is always finished: the numbers follow the mouse in a drag.
const WORKER: WorkerSettings = WorkerSettings {
    name: "meter",
    priority: Priority::Background,
    interrupt: Interrupt::AfterResult,
    panic_message: "The meter failed. This is an error in Catchlight.",
};

impl MeterJob {
    /// Returns a job that shares BVHs of meshes with renders and live view.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        let work = move |inbox: &Inbox<Request, Reading>| serve(inbox, &cache);
        MeterJob { worker: Worker::new(WORKER, work), requested: None, latest: None }
    }

    /// Requests a reading when the studio has changed, and takes in the newest result. To be called once a frame.
    pub fn update(&mut self, scene: &Scene, assets: &Assets, revision: u64, wake: &Wake) {
        let Some(meter) = scene.meter else {
            (self.requested, self.latest) = (None, None);
            self.worker.reset();
            return;
        };
        if let Some(result) = self.worker.take() {
            self.latest = Some(result);
        }
        if self.requested != Some(revision) {
            self.requested = Some(revision);
            self.worker.request(Request { scene: scene.clone(), assets: assets.clone(), meter }, wake);
        }
    }

    /// Returns the latest reading, or the message of an error; none until the first one is there.
    pub fn reading(&self) -> Option<&Result<Reading, String>> {
        self.latest.as_ref()
    }

    /// Returns true while a reading is running.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}

/// The body of the meter thread.
fn serve(inbox: &Inbox<Request, Reading>, cache: &GeometryCache) {
    let pool = match background_pool(0, "meter") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail_all(&format!("No threads to read the meter with: {error}.")),
    };
    while let Some((Request { scene, assets, meter }, control)) = inbox.next() {
        let point = MeterPoint { position: meter.position, facing: meter.direction(&scene), receptor: meter.receptor };
        let efforts = [MeterEffort::quick(), MeterEffort::default()];
        let read = || {
            let mut publish = |result: MeterResult| inbox.publish(result.reading);
            read_meter(&scene, &assets, &point, &efforts, cache, &control, &mut publish)
        };
        if let Err(error) = pool.install(read) {
            inbox.fail(error.to_string());
        }
    }
}
