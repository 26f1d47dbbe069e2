//! The GPU preview as a texture of the window: built in the background, drawn only after a change. Without a GPU the
//! CPU preview replaces it.

use crate::editor::document::revisions::Revisions;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::scopes::ScopeCharts;
use crate::editor::ui::wake::wake;
use crate::editor::viewport::live::cpu_preview::CpuPreview;
use crate::jobs::BounceJob;
use crate::photo::{Picture, PictureDisplay};
use crate::preview::{
    Channel, Gloss, LossFlag, Options, Overlay, Pick, PreviewError, PreviewInput, PreviewRenderer, is_cpu_rasteriser,
};
use crate::scene::{CameraFrame, LightId};
use eframe::egui::{Context, Painter, Rect, TextureId};
use eframe::egui_wgpu::RenderState;
use eframe::wgpu;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time without a change after which a draft is replaced by the full image.
const SETTLED: Duration = Duration::from_millis(120);

/// A pool of the preview's renderers, with their devices: a closed window gives its renderer back, and the next window
/// on that device takes it and need not compile the pipelines. Clones share the pool.
#[derive(Clone, Debug, Default)]
pub struct RendererPool(Arc<Mutex<Vec<(wgpu::Device, PreviewRenderer)>>>);

impl RendererPool {
    /// Takes a renderer of a device, whose loss then sets `loss`; none if the pool has none.
    fn take(&self, device: &wgpu::Device, loss: &LossFlag) -> Option<PreviewRenderer> {
        let mut pool = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let index = pool.iter().position(|(known, _)| known == device)?;
        let (_, mut renderer) = pool.swap_remove(index);
        renderer.set_loss_flag(loss.clone());
        Some(renderer)
    }

    /// Puts the renderer of a closed window into the pool.
    fn give_back(&self, device: &wgpu::Device, renderer: PreviewRenderer) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((device.clone(), renderer));
    }
}

#[derive(Debug)]
enum PreviewStage {
    /// The pipelines are being compiled.
    Starting(Receiver<Result<PreviewRenderer, PreviewError>>),
    Ready(Box<PreviewRenderer>),
    /// The CPU preview draws instead, for this reason.
    Failed(String),
}

/// Everything that the image depends on.
#[derive(Clone, Debug, PartialEq)]
struct PreviewKey {
    revisions: Revisions,
    frame: CameraFrame,
    size: (u32, u32),
    overlay: Overlay,
    options: Options,
    /// Number of the bounced light's grid.
    bounced_light: u64,
    /// Scopes read the scene-linear picture.
    is_read: bool,
}

/// Display options of the live view; not part of the scene, neither saved nor undone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewOptions {
    /// The channel on display.
    pub channel: Channel,
    /// Shows the light of this light alone.
    pub only_light: Option<LightId>,
    /// The specular model.
    pub gloss: Gloss,
    /// True to denoise the traced view until it is finished.
    pub smooth: bool,
    /// True to average several samples of the live view while nothing moves.
    pub smooth_edges: bool,
    /// True to add the light that surfaces throw on each other.
    pub bounced_light: bool,
    /// Width and height of a light's shadow map, texels.
    pub shadow_resolution: u32,
    /// How the lit picture is displayed.
    pub display: PictureDisplay,
    /// The read-outs over it.
    pub charts: ScopeCharts,
}

impl ViewOptions {
    /// Returns true if scopes read the picture.
    pub fn has_scopes(&self) -> bool {
        self.channel == Channel::Lit && (self.display != PictureDisplay::Plain || self.charts.any())
    }
}

impl Default for ViewOptions {
    fn default() -> Self {
        ViewOptions {
            channel: Channel::Lit,
            only_light: None,
            gloss: Gloss::Ggx,
            smooth: false,
            smooth_edges: true,
            bounced_light: true,
            shadow_resolution: Options::default().shadow_resolution,
            display: PictureDisplay::Plain,
            charts: ScopeCharts::default(),
        }
    }
}

/// The preview and the texture it draws into.
pub struct PreviewHost {
    /// Display options.
    pub view_options: ViewOptions,
    stage: PreviewStage,
    pool: RendererPool,
    state: Option<RenderState>,
    /// Set when the window's device is lost.
    loss: LossFlag,
    cpu_preview: CpuPreview,
    bounced_light: BounceJob,
    texture: Option<(TextureId, u64)>,
    /// The scene-linear picture, if scopes read it.
    linear: Option<Arc<Picture>>,
    shown: Option<PreviewKey>,
    /// Time at which the current draft was drawn; none for a full image.
    draft_since: Option<Instant>,
    /// Number of samples in the full image.
    samples: u32,
    /// Number of images drawn.
    draws: u64,
    last_draw: Duration,
}

impl std::fmt::Debug for PreviewHost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PreviewHost").field("stage", &self.stage).field("draws", &self.draws).finish_non_exhaustive()
    }
}

impl Drop for PreviewHost {
    fn drop(&mut self) {
        if let (PreviewStage::Ready(renderer), Some(state)) = (self.take_stage(), &self.state)
            && self.loss.reason().is_none()
        {
            self.pool.give_back(&state.device, *renderer);
        }
    }
}

impl PreviewHost {
    /// Returns a host that builds the preview on the window's device, or takes one from the pool.
    pub fn new(state: Option<&RenderState>, pool: RendererPool, ctx: &Context) -> Self {
        let mut host = PreviewHost {
            view_options: ViewOptions::default(),
            stage: PreviewStage::Failed(String::new()),
            pool,
            state: None,
            loss: LossFlag::default(),
            cpu_preview: CpuPreview::default(),
            bounced_light: BounceJob::default(),
            texture: None,
            linear: None,
            shown: None,
            draft_since: None,
            samples: 0,
            draws: 0,
            last_draw: Duration::ZERO,
        };
        host.move_to(state, ctx);
        host
    }

    /// Returns the stage and leaves a failed one.
    fn take_stage(&mut self) -> PreviewStage {
        std::mem::replace(&mut self.stage, PreviewStage::Failed(String::new()))
    }

    /// Drops the window's device and its resources.
    pub fn drop_device(&mut self) {
        (self.state, self.texture, self.loss) = (None, None, LossFlag::default());
        self.use_cpu("There is no GPU that could draw the view.");
        self.cpu_preview.clear();
    }

    /// Moves to the device of another window.
    pub fn move_to(&mut self, state: Option<&RenderState>, ctx: &Context) {
        self.drop_device();
        if let Some(state) = state {
            (self.state, self.loss) = (Some(state.clone()), LossFlag::watch(&state.device));
            // An uncaptured error, for example of egui, is logged; wgpu's default would panic.
            state.device.on_uncaptured_error(Arc::new(|error| log::error!("the graphics driver: {error}")));
            self.restart(ctx);
        }
    }

    /// Returns the reason of a device loss, after which nothing can be drawn in this window.
    pub fn lost_device(&self) -> Option<&str> {
        self.state.as_ref().and_then(|state| self.loss.poll(&state.device))
    }

    /// Switches to the CPU preview until [`PreviewHost::restart`].
    pub fn use_cpu(&mut self, why: &str) {
        (self.stage, self.shown, self.draft_since) = (PreviewStage::Failed(why.to_owned()), None, None);
    }

    /// Returns true if there is a device to build the preview on.
    pub fn has_device(&self) -> bool {
        self.state.is_some()
    }

    /// Returns true if the processors draw the window's frames: each takes time from a render.
    pub fn window_is_drawn_by_cpu(&self) -> bool {
        self.state.as_ref().is_some_and(|state| is_cpu_rasteriser(&state.device))
    }

    /// Returns the reason why the CPU draws the view, if it does.
    pub fn failure(&self) -> Option<&str> {
        match &self.stage {
            PreviewStage::Failed(message) => Some(message),
            PreviewStage::Starting(_) | PreviewStage::Ready(_) => None,
        }
    }

    /// Returns true while the preview is being built.
    pub fn is_starting(&self) -> bool {
        matches!(self.stage, PreviewStage::Starting(_))
    }

    /// Returns true while the bounced light is traced.
    pub fn is_tracing_bounced_light(&self) -> bool {
        self.bounced_light.is_busy()
    }

    /// Returns true if the image has traced bounced light rather than an estimate of it.
    pub fn has_bounced_light(&self) -> bool {
        self.bounced_light.grid().is_some()
    }

    /// Returns true if the current image is a draft.
    pub fn is_draft(&self) -> bool {
        self.draft_since.is_some()
    }

    /// Returns the number of images drawn; constant while nothing changes.
    pub fn draws(&self) -> u64 {
        self.draws
    }

    /// Returns the time to set up and submit the last image.
    pub fn last_draw(&self) -> Duration {
        self.last_draw
    }

    /// Rebuilds the preview after a failure.
    pub fn restart(&mut self, ctx: &Context) {
        if let Some(state) = &self.state {
            let pooled = self.pool.take(&state.device, &self.loss);
            self.stage = pooled.map_or_else(
                || start(state, self.loss.clone(), ctx),
                |renderer| PreviewStage::Ready(Box::new(renderer)),
            );
            (self.shown, self.draft_since) = (None, None);
        }
    }

    /// Returns the image of the studio from `frame`, redrawn after a change: as a draft on a software adapter, and in
    /// full as soon as nothing has changed for a moment. `overlay_alone` draws only the overlays.
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
        let ViewOptions { channel, only_light, gloss, smooth_edges, bounced_light, shadow_resolution, display, .. } =
            self.view_options;
        // A deleted light no longer hides the others.
        let only_light = only_light.filter(|id| document.scene().light(*id).is_some());
        let is_read = self.view_options.has_scopes() && !overlay_alone;
        if !is_read {
            self.linear = None;
        }
        let is_lit = channel == Channel::Lit && !overlay_alone;
        // What displays the picture otherwise is drawn below the overlays
        let overlay_alone = overlay_alone || (is_read && display != PictureDisplay::Plain);
        let options = Options {
            channel,
            only_light,
            gloss,
            overlay_alone,
            bounce_estimate: bounced_light,
            shadow_resolution,
            ..Options::default()
        };
        // Names and locks do not affect the image.
        let revisions = Revisions { document: 0, ..document.revisions() };
        if matches!(self.stage, PreviewStage::Ready(_)) && is_lit && bounced_light {
            let numbers = (revisions.image, revisions.surfaces);
            self.bounced_light.update(document.scene(), document.assets(), only_light, numbers, &wake(ctx));
        }
        let generation = self.bounced_light.generation();
        let wanted = PreviewKey { revisions, frame, size, overlay, options, bounced_light: generation, is_read };
        let changed =
            self.shown.as_ref().is_none_or(|shown| PreviewKey { bounced_light: generation, ..shown.clone() } != wanted);
        // New bounced light alone is no motion: it waits for the full image after a draft.
        let brightened = self.draft_since.is_none() && self.shown.as_ref() != Some(&wanted);
        let most_samples = if smooth_edges { self.most_samples(options) } else { 1 };
        let is_oversampled = self.samples > most_samples;
        let settled = self.draft_since.is_some_and(|since| since.elapsed() >= SETTLED);
        if changed || brightened || settled || is_oversampled {
            // The first image is drawn in full: nothing is in motion.
            let draft = changed && drafts && self.shown.is_some() && (is_read || !overlay_alone);
            self.draw(ctx, document, wanted, draft, 0);
            self.draft_since = draft.then(Instant::now);
        } else if self.draft_since.is_none() && self.samples < most_samples {
            self.draw(ctx, document, wanted, false, self.samples);
        }
        if self.draft_since.is_none() && self.samples < most_samples {
            ctx.request_repaint();
        }
        if let Some(since) = self.draft_since {
            ctx.request_repaint_after(SETTLED.saturating_sub(since.elapsed()));
        }
        match self.stage {
            PreviewStage::Failed(_) => self.cpu_preview.texture(),
            PreviewStage::Starting(_) | PreviewStage::Ready(_) => self.texture.map(|(id, _)| id),
        }
    }

    /// Returns the number of samples of a finished image.
    fn most_samples(&self, options: Options) -> u32 {
        match &self.stage {
            PreviewStage::Ready(renderer) if options.channel == Channel::Lit && !options.overlay_alone => {
                renderer.still_samples()
            }
            _ => 1,
        }
    }

    fn draw(&mut self, ctx: &Context, document: &Document, wanted: PreviewKey, draft: bool, sample: u32) {
        let began = Instant::now();
        let bounced_light = self.bounced_light.grid();
        let input = PreviewInput {
            scene: document.scene(),
            assets: document.assets(),
            frame: wanted.frame,
            size: wanted.size,
            bounced_light: bounced_light.as_deref(),
            overlay: wanted.overlay.clone(),
            options: Options { draft, sample, ..wanted.options },
        };
        let reads_now = wanted.is_read && sample == 0 && (wanted.options.overlay_alone || !draft);
        if let PreviewStage::Ready(renderer) = &mut self.stage {
            // Before the picture for the screen, whose ids and gizmos are picked
            let linear = reads_now.then(|| renderer.linear_picture(&linear_input(&input))).transpose();
            let drawn = linear.and_then(|linear| {
                self.linear = linear.map(Arc::new).or(self.linear.take());
                renderer.render(&input).map(|_| ())
            });
            match drawn {
                Ok(()) => self.register(),
                Err(error) => self.use_cpu(&crate::jobs::sentence(&error)),
            }
        }
        if let PreviewStage::Failed(_) = self.stage {
            self.cpu_preview.draw(ctx, &input, wanted.revisions.surfaces);
            if reads_now {
                self.linear = self.cpu_preview.picture().cloned().map(Arc::new);
            }
        }
        (self.draws, self.last_draw, self.shown) = (self.draws + 1, began.elapsed(), Some(wanted));
        self.samples = if draft { 0 } else { sample + 1 };
    }

    /// Returns the scene-linear picture of the image, if scopes read it.
    pub fn linear_picture(&self) -> Option<&Arc<Picture>> {
        self.linear.as_ref()
    }

    /// Paints the overlays of the CPU preview in `rect`; those of the GPU preview are part of its image.
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

    /// Registers the image's texture with egui after it was recreated.
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

    /// Returns the object or gizmo at a pixel of the current image.
    pub fn pick(&self, pixel: (u32, u32)) -> Option<Pick> {
        match &self.stage {
            PreviewStage::Ready(renderer) => renderer.pick_blocking(pixel).ok().flatten(),
            PreviewStage::Failed(_) => self.cpu_preview.pick(pixel),
            PreviewStage::Starting(_) => None,
        }
    }
}

/// Returns the input of the picture that scopes read: at half the size while something moves.
fn linear_input<'a>(input: &PreviewInput<'a>) -> PreviewInput<'a> {
    let PreviewInput { size, options, overlay, .. } = input;
    let size = if options.draft { (size.0.div_ceil(2), size.1.div_ceil(2)) } else { *size };
    let overlay = Overlay { void_color: overlay.void_color, work_light: overlay.work_light, ..Overlay::default() };
    let options = Options { draft: false, overlay_alone: false, ..*options };
    PreviewInput { size, overlay, options, ..input.clone() }
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
