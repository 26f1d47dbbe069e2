//! The live preview as a texture of the window: built in the background, drawn only when something changed. Where the
//! graphics device cannot draw it, the processor does.

use crate::editor::document::revisions::Revisions;
use crate::editor::document::studio_document::Document;
use crate::editor::viewport::live::cpu_preview::CpuPreview;
use crate::preview::{Channel, Gloss, LossFlag, Options, Overlay, Pick, PreviewError, PreviewInput, PreviewRenderer};
use crate::scene::{CameraFrame, LightId};
use eframe::egui::{Context, Painter, Rect, TextureId};
use eframe::egui_wgpu::RenderState;
use eframe::wgpu;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// How long nothing must change before a draft gives way to the picture in full.
const SETTLED: Duration = Duration::from_millis(120);

#[derive(Debug)]
enum PreviewStage {
    /// The pipelines are being compiled.
    Starting(Receiver<Result<PreviewRenderer, PreviewError>>),
    Ready(Box<PreviewRenderer>),
    /// The processor draws instead, and why.
    Failed(String),
}

/// Everything that the picture depends on.
#[derive(Clone, Debug, PartialEq)]
struct PreviewKey {
    revisions: Revisions,
    frame: CameraFrame,
    size: (u32, u32),
    overlay: Overlay,
    options: Options,
}

/// What the views of the studio show of it. No part of the scene: it is neither saved nor undone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ViewOptions {
    /// What each pixel shows.
    pub channel: Channel,
    /// Leaves all other lights out.
    pub only_light: Option<LightId>,
    /// How surfaces shine.
    pub gloss: Gloss,
    /// Whether the traced view shows less grain than it has until it has settled.
    pub smooth: bool,
}

/// The preview and the texture it draws into.
pub struct PreviewHost {
    /// What it shows.
    pub view_options: ViewOptions,
    stage: PreviewStage,
    state: Option<RenderState>,
    /// Raised when the window's device is gone.
    loss: LossFlag,
    cpu_preview: CpuPreview,
    texture: Option<(TextureId, u64)>,
    shown: Option<PreviewKey>,
    /// When the picture on show was drawn, if it is a draft.
    draft_since: Option<Instant>,
    /// Pictures drawn so far.
    draws: u64,
    last_draw: Duration,
}

impl std::fmt::Debug for PreviewHost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PreviewHost").field("stage", &self.stage).field("draws", &self.draws).finish_non_exhaustive()
    }
}

impl PreviewHost {
    /// Starts to build the preview on the window's device.
    pub fn new(state: Option<&RenderState>, ctx: &Context) -> Self {
        let mut host = PreviewHost {
            view_options: ViewOptions::default(),
            stage: PreviewStage::Failed(String::new()),
            state: None,
            loss: LossFlag::default(),
            cpu_preview: CpuPreview::default(),
            texture: None,
            shown: None,
            draft_since: None,
            draws: 0,
            last_draw: Duration::ZERO,
        };
        host.move_to(state, ctx);
        host
    }

    /// Drops the window's device and all that is on it.
    pub fn let_device_go(&mut self) {
        (self.state, self.texture, self.loss) = (None, None, LossFlag::default());
        self.give_up("There is no graphics adapter that could draw the view.");
        self.cpu_preview.clear();
    }

    /// Goes over to the device of another window.
    pub fn move_to(&mut self, state: Option<&RenderState>, ctx: &Context) {
        self.let_device_go();
        if let Some(state) = state {
            (self.state, self.loss) = (Some(state.clone()), LossFlag::watch(&state.device));
            // What nobody waits for, such as egui's own, is no reason to end the program, as wgpu would.
            state.device.on_uncaptured_error(Arc::new(|error| log::error!("the graphics driver: {error}")));
            self.restart(ctx);
        }
    }

    /// Why the window's device is gone, if it is: nothing can be drawn in this window any more.
    pub fn lost_device(&self) -> Option<&str> {
        self.state.as_ref().and_then(|state| self.loss.poll(&state.device))
    }

    /// Leaves the view to the processor until [`PreviewHost::restart`].
    pub fn give_up(&mut self, why: &str) {
        (self.stage, self.shown, self.draft_since) = (PreviewStage::Failed(why.to_owned()), None, None);
    }

    /// Whether there is a device to build the preview on.
    pub fn has_device(&self) -> bool {
        self.state.is_some()
    }

    /// Why the processor draws the view.
    pub fn failure(&self) -> Option<&str> {
        match &self.stage {
            PreviewStage::Failed(message) => Some(message),
            PreviewStage::Starting(_) | PreviewStage::Ready(_) => None,
        }
    }

    /// Whether the preview is still being built.
    pub fn is_starting(&self) -> bool {
        matches!(self.stage, PreviewStage::Starting(_))
    }

    /// Whether the picture on show is a draft that is about to be drawn in full.
    pub fn is_draft(&self) -> bool {
        self.draft_since.is_some()
    }

    /// Pictures drawn so far; does not grow while nothing changes.
    pub fn draws(&self) -> u64 {
        self.draws
    }

    /// Time the last picture took to set up and submit.
    pub fn last_draw(&self) -> Duration {
        self.last_draw
    }

    /// Builds the preview again after a failure.
    pub fn restart(&mut self, ctx: &Context) {
        if let Some(state) = &self.state {
            self.stage = start(state, self.loss.clone(), ctx);
            (self.shown, self.draft_since) = (None, None);
        }
    }

    /// The picture of the studio from `frame`, drawn anew if anything of it changed: as a draft where the adapter is a
    /// processor, and in full as soon as nothing has changed for a moment. With `overlay_alone`, only what lies over it.
    pub fn show(
        &mut self,
        ctx: &Context,
        document: &Document,
        frame: CameraFrame,
        size: (u32, u32),
        overlay: Overlay,
        overlay_alone: bool,
    ) -> Option<TextureId> {
        self.finish_start();
        let drafts = match &self.stage {
            PreviewStage::Starting(_) => return None,
            PreviewStage::Ready(renderer) => renderer.draws_drafts(),
            PreviewStage::Failed(_) => CpuPreview::draws_drafts(size),
        };
        let ViewOptions { channel, only_light, gloss, smooth: _ } = self.view_options;
        // A light that was deleted meanwhile leaves the others as they are.
        let only_light = only_light.filter(|id| document.scene().light(*id).is_some());
        let options = Options { channel, only_light, gloss, overlay_alone, ..Options::default() };
        // Names and locks show in no picture.
        let revisions = Revisions { document: 0, ..document.revisions() };
        let wanted = PreviewKey { revisions, frame, size, overlay, options };
        let changed = self.shown.as_ref() != Some(&wanted);
        let settled = self.draft_since.is_some_and(|since| since.elapsed() >= SETTLED);
        if changed || settled {
            // The very first picture is drawn in full: there is no motion to keep up with.
            let draft = changed && drafts && self.shown.is_some() && !overlay_alone;
            self.draw(ctx, document, wanted, draft);
            self.draft_since = draft.then(Instant::now);
        }
        if let Some(since) = self.draft_since {
            ctx.request_repaint_after(SETTLED.saturating_sub(since.elapsed()));
        }
        match self.stage {
            PreviewStage::Failed(_) => self.cpu_preview.texture(),
            PreviewStage::Starting(_) | PreviewStage::Ready(_) => self.texture.map(|(id, _)| id),
        }
    }

    fn draw(&mut self, ctx: &Context, document: &Document, wanted: PreviewKey, draft: bool) {
        let began = Instant::now();
        let input = PreviewInput {
            scene: document.scene(),
            assets: document.assets(),
            frame: wanted.frame,
            size: wanted.size,
            overlay: wanted.overlay.clone(),
            options: Options { draft, ..wanted.options },
        };
        if let PreviewStage::Ready(renderer) = &mut self.stage {
            match renderer.render(&input).map(|_| ()) {
                Ok(()) => self.register(),
                Err(error) => self.give_up(&crate::jobs::sentence(&error)),
            }
        }
        if let PreviewStage::Failed(_) = self.stage {
            self.cpu_preview.draw(ctx, &input, wanted.revisions.surfaces);
        }
        (self.draws, self.last_draw, self.shown) = (self.draws + 1, began.elapsed(), Some(wanted));
    }

    /// Lines and tints over the picture in `rect`, where the picture itself has none.
    pub fn paint_over(&self, painter: &Painter, rect: Rect) {
        if let PreviewStage::Failed(_) = self.stage {
            self.cpu_preview.paint_over(painter, rect);
        }
    }

    fn finish_start(&mut self) {
        let PreviewStage::Starting(receiver) = &self.stage else { return };
        match receiver.try_recv() {
            Ok(Ok(renderer)) => self.stage = PreviewStage::Ready(Box::new(renderer)),
            Ok(Err(error)) => self.stage = PreviewStage::Failed(crate::jobs::sentence(&error)),
            Err(TryRecvError::Disconnected) => {
                self.stage = PreviewStage::Failed("The live view could not be built.".to_owned())
            }
            Err(TryRecvError::Empty) => {}
        }
    }

    /// Tells egui of the picture's texture, when it is a new one.
    fn register(&mut self) {
        let (PreviewStage::Ready(renderer), Some(state)) = (&self.stage, &self.state) else { return };
        let generation = renderer.generation();
        let mut egui_renderer = state.renderer.write();
        match &mut self.texture {
            Some((_, known)) if *known == generation => {}
            Some((id, known)) => {
                let (view, filter) = (renderer.color_view(), wgpu::FilterMode::Linear);
                egui_renderer.update_egui_texture_from_wgpu_texture(&state.device, view, filter, *id);
                *known = generation;
            }
            None => {
                let (view, filter) = (renderer.color_view(), wgpu::FilterMode::Linear);
                self.texture = Some((egui_renderer.register_native_texture(&state.device, view, filter), generation));
            }
        }
    }

    /// What stands at a pixel of the picture on show.
    pub fn pick(&self, pixel: (u32, u32)) -> Option<Pick> {
        match &self.stage {
            PreviewStage::Ready(renderer) => renderer.pick_blocking(pixel).ok().flatten(),
            PreviewStage::Failed(_) => self.cpu_preview.pick(pixel),
            PreviewStage::Starting(_) => None,
        }
    }
}

fn start(state: &RenderState, loss: LossFlag, ctx: &Context) -> PreviewStage {
    let (sender, receiver) = channel();
    let (device, queue, ctx) = (state.device.clone(), state.queue.clone(), ctx.clone());
    std::thread::spawn(move || {
        let began = Instant::now();
        let renderer = PreviewRenderer::watched(&device, &queue, loss);
        log::debug!("the live view was built in {} ms", began.elapsed().as_millis());
        let _ = sender.send(renderer);
        ctx.request_repaint();
    });
    PreviewStage::Starting(receiver)
}
