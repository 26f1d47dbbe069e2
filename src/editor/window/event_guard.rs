//! Catches panics of a window inside the event loop: libraries panic on a device loss, and an event loop left by a
//! panic cannot open another window.

use eframe::{EframeWinitApplication, UserEvent};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::platform::run_on_demand::EventLoopExtRunOnDemand;
use winit::window::WindowId;

/// The payload of a panic.
pub type Panic = Box<dyn Any + Send>;

/// A window until its panic.
struct EventGuard<'a> {
    window: Option<EframeWinitApplication<'a>>,
    panic: Option<Panic>,
}

/// Runs a window until it closes. The inner result is the panic that ended it.
///
/// # Errors
/// When the loop itself fails.
pub fn run(
    events: &mut EventLoop<UserEvent>,
    window: EframeWinitApplication<'_>,
) -> Result<Result<(), Panic>, winit::error::EventLoopError> {
    let mut guard = EventGuard { window: Some(window), panic: None };
    events.run_app_on_demand(&mut guard)?;
    guard.drop_window();
    Ok(guard.panic.map_or(Ok(()), Err))
}

impl<'a> EventGuard<'a> {
    fn pass(&mut self, events: &ActiveEventLoop, event: impl FnOnce(&mut EframeWinitApplication<'a>)) {
        let Some(window) = &mut self.window else { return };
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| event(window))) {
            self.panic = Some(panic);
            // Inside the loop, so that the window disappears.
            self.drop_window();
            events.exit();
        }
    }

    /// Drops the window. A surface whose device was lost during a frame panics when it is dropped.
    fn drop_window(&mut self) {
        let window = self.window.take();
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| drop(window))) {
            self.panic.get_or_insert(panic);
        }
    }
}

impl ApplicationHandler<UserEvent> for EventGuard<'_> {
    fn new_events(&mut self, events: &ActiveEventLoop, cause: StartCause) {
        self.pass(events, |window| window.new_events(events, cause));
    }

    fn resumed(&mut self, events: &ActiveEventLoop) {
        self.pass(events, |window| window.resumed(events));
    }

    fn user_event(&mut self, events: &ActiveEventLoop, event: UserEvent) {
        self.pass(events, |window| window.user_event(events, event));
    }

    fn window_event(&mut self, events: &ActiveEventLoop, id: WindowId, event: WindowEvent) {
        self.pass(events, |window| window.window_event(events, id, event));
    }

    fn device_event(&mut self, events: &ActiveEventLoop, id: DeviceId, event: DeviceEvent) {
        self.pass(events, |window| window.device_event(events, id, event));
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        self.pass(events, |window| window.about_to_wait(events));
    }

    fn suspended(&mut self, events: &ActiveEventLoop) {
        self.pass(events, |window| window.suspended(events));
    }

    fn exiting(&mut self, events: &ActiveEventLoop) {
        self.pass(events, |window| window.exiting(events));
    }

    fn memory_warning(&mut self, events: &ActiveEventLoop) {
        self.pass(events, |window| window.memory_warning(events));
    }
}
