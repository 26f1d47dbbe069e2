//! Execution of commands.

use crate::editor::commands::choices::CentralView;
use crate::editor::commands::choices::PlaceLightBy;
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::action_error::ActionError;
use crate::editor::document::arrange::MirrorPlane;
use crate::editor::document::catalog::CatalogItem;
use crate::editor::document::clipboard::{self, ClipboardContent};
use crate::editor::document::files::{self, StudioSource};
use crate::editor::document::framing::{face_action, frame_figure};
use crate::editor::document::item::Item;
use crate::editor::document::light_mix::Mix;
use crate::editor::document::placement;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::{Document, import_folder};
use crate::editor::viewport::tools::place_light::{LightPlacement, can_be_placed};
use crate::editor::viewport::tools::place_light_drag::PlaceLightDrag;
use crate::editor::viewport::tools::pointer_tool::PointerTool;
use crate::editor::viewport::tools::tank_brush::TankBrush;
use crate::editor::window::app::App;
use crate::scene::{Aim, Emitter, LightId, Object, Scene, Solo, VariantId};
use eframe::egui::{Context, ViewportCommand};
use std::collections::HashSet;

impl App {
    /// Executes a command. `press_id` is the press that it came from.
    pub fn run(&mut self, command: Command, press_id: Option<u64>, ctx: &Context) {
        match command {
            Command::Apply(action) => self.apply(action, press_id),
            Command::AddFromCatalog(made) => self.place(*made),
            Command::Select(item) => self.selection = Selection::of(item),
            Command::ToggleSelected(item) => self.selection.toggle(item),
            Command::SelectAlso(items) => self.selection.add(items),
            Command::SelectAll => self.selection = Selection::of(selectable(self.document.scene())),
            Command::Escape => self.escape(),
            Command::BeginRename(item) => {
                self.selection = Selection::of([item]);
                self.panels.outliner.begin_rename(item, item.name(self.document.scene()));
            }
            Command::DeleteSelected => {
                let can_go = |item: &Item| item.can_be_copied() || *item == Item::Meter;
                self.with_selected(can_go, "Select a light or a thing to delete.", |_, items| Action::Delete(items));
            }
            Command::CopySelected => drop(self.copy_selected(ctx)),
            Command::CutSelected => {
                if let Some(items) = self.copy_selected(ctx) {
                    self.apply(Action::Delete(items), None);
                }
            }
            Command::RequestPaste => ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
            Command::Paste(text) => self.paste(&text),
            Command::DuplicateSelected => {
                let otherwise = "Select a light or a thing to duplicate.";
                self.with_selected(|item| item.can_be_copied(), otherwise, |_, items| Action::Duplicate(items));
            }
            Command::MirrorSelected { copies } => self.mirror_selected(copies),
            Command::HideSelected => {
                let otherwise = "Select things to hide or lights to mute.";
                self.with_selected(|item| item.can_be_copied(), otherwise, hide_or_show);
            }
            Command::ShowAll => {
                let all = all_things(self.document.scene()).collect();
                let action = shown(self.document.scene(), all, true, "Show everything".to_owned());
                self.apply(action, None);
            }
            Command::SoloSelected => self.solo_selected(),
            Command::LockSelected => {
                let otherwise = "Select lights or things to lock in their places.";
                self.with_selected(
                    |item| item.can_be_copied(),
                    otherwise,
                    |scene, items| {
                        let lock = items.iter().any(|item| !item.is_locked(scene));
                        Action::Lock(items, lock)
                    },
                );
            }
            Command::LookFrom(side) => {
                self.views.central = CentralView::Studio;
                self.views.viewport.view.look_from(side);
            }
            Command::ToggleParallel => self.views.viewport.view.toggle_parallel(),
            Command::ToggleLightView => self.toggle_light_view(),
            Command::TogglePlaceLight(by) => self.toggle_placing(by),
            Command::ToggleSnap => self.views.viewport.snap = !self.views.viewport.snap,
            Command::Undo => self.step(Document::undo),
            Command::Redo => self.step(Document::redo),
            Command::New => self.panels.preset_picker.open(),
            Command::NewFromPreset(index) => self.replace_with(StudioSource::Preset(index), ctx),
            Command::NewEmpty => self.replace_with(StudioSource::Memory(Box::new(files::empty_studio())), ctx),
            Command::OpenPath(path) => self.replace_with(StudioSource::File(path), ctx),
            Command::ClearRecent => self.session.recent.clear(),
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Render => self.render(ctx),
            Command::CancelRender => self.rendering.cancel(),
            Command::ToggleDenoise => self.rendering.settings.denoise = !self.rendering.settings.denoise,
            Command::DisplayPicture(display) => self.rendering.display = display,
            Command::MixLights(lights, fader) => self.rendering.mix.set(&lights, fader),
            Command::ApplyMix => {
                let action = self.rendering.mix.action(self.document.scene());
                match action.map_or(Ok(Vec::new()), |action| self.document.apply(action, None)) {
                    Ok(_) => self.rendering.mix = Mix::default(),
                    Err(error) => self.toasts.error(error.to_string()),
                }
            }
            Command::ResetMix => self.rendering.mix = Mix::default(),
            Command::ShowVariant(id) => self.show_variant(id),
            Command::ShowVariantAt(index) => self.show_variant_at(index),
            Command::AddVariant => {
                let name = self.document.scene().variants.next_name();
                self.apply(Action::AddVariant(name), None);
            }
            Command::BeginRenameVariant(id) => {
                let name = self.document.scene().variants.name(id).unwrap_or_default().to_owned();
                self.panels.variants.begin_rename(id, name);
            }
            Command::Compare(comparison) => self.views.picture.comparison = comparison,
            Command::ShowView(centre) => self.views.central = centre,
            Command::ToggleCameraView => {
                self.views.central =
                    if self.views.central == CentralView::Camera { CentralView::Studio } else { CentralView::Camera };
            }
            Command::FrameSelection => {
                self.views.central = CentralView::Studio;
                self.views.viewport.frame_selection(&self.document, &self.selection);
            }
            Command::CameraFromView => {
                let camera = self.views.viewport.camera_from_view(self.document.scene());
                self.apply(Action::SetCamera(Box::new(camera)), None);
            }
            Command::SetLiveMode(mode) => self.views.viewport.traced_view.mode = mode,
            Command::ToggleLiveMode => self.views.viewport.traced_view.toggle(),
            Command::SetHandles(handle) => self.views.handles = handle,
            Command::PlayTank(tank) => self.play_tank(tank),
            Command::SetBrush(brush) => {
                self.views.viewport.tool = brush.map(|brush| PointerTool::Brush(TankBrush::new(brush)));
                if brush.is_some() && !matches!(self.views.central, CentralView::Studio | CentralView::Camera) {
                    self.views.central = CentralView::Studio;
                }
            }
            Command::SetTankSpeed(speed) => self.panels.tank_player.set_speed(speed),
            Command::FrameFigure(id, framing) => {
                let (scene, assets) = (self.document.scene(), self.document.assets());
                if let Some(action) = frame_figure(scene, assets, id, framing) {
                    self.apply(action, None);
                }
            }
            Command::SetUpAtFace(id) => {
                if let Some(action) = face_action(self.document.scene(), id) {
                    self.apply(action, None);
                }
            }
            Command::ToggleDials => self.panels.show_dials = !self.panels.show_dials,
            Command::ToggleRoomAudit => self.panels.show_room_audit = !self.panels.show_room_audit,
            Command::ToggleGear => self.toggle_gear(),
            Command::SetOwned(entry, count) => self.set_owned(&entry, count),
            Command::ReadGear => self.panels.gear.read(),
            Command::SetDials(plan) => self.set_dials(&plan),
            Command::TogglePreferences => self.panels.show_preferences = !self.panels.show_preferences,
            Command::SetPreferences(preferences) => self.set_preferences(preferences, ctx),
            Command::StartTour => self.panels.tour.open(),
            Command::ToggleAbout => self.panels.show_about = !self.panels.show_about,
            Command::ToggleHelp => self.panels.show_help = !self.panels.show_help,
            Command::Open
            | Command::Save
            | Command::SaveAs
            | Command::Import
            | Command::ImportPath(_)
            | Command::CancelLoads
            | Command::MeasuredLight(_)
            | Command::MeasuredLightPath(..)
            | Command::EnvironmentMap(_)
            | Command::EnvironmentMapPath(..)
            | Command::ChooseTexture(..)
            | Command::ExportPicture
            | Command::ExportSheet(_)
            | Command::ExportLesson(..)
            | Command::UseFile(..) => self.run_file_command(command, ctx),
        }
    }

    /// Undoes or redoes a step and selects the items that it restores.
    fn step(&mut self, step: fn(&mut Document) -> Option<String>) {
        let known: HashSet<Item> = all_things(self.document.scene()).collect();
        step(&mut self.document);
        let brought: Vec<Item> = all_things(self.document.scene()).filter(|item| !known.contains(item)).collect();
        if !brought.is_empty() {
            self.selection = Selection::of(brought);
        }
    }

    /// Applies an action; reports its error.
    pub(super) fn apply(&mut self, action: Action, press_id: Option<u64>) {
        match self.document.apply(action, press_id) {
            Ok(items) if items.is_empty() => {}
            Ok(items) => self.selection = Selection::of(items),
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    /// Applies an action to the selected items that satisfy `can`; shows `otherwise` if there are none.
    fn with_selected(
        &mut self,
        can: impl Fn(&Item) -> bool,
        otherwise: &str,
        action: impl FnOnce(&Scene, Vec<Item>) -> Action,
    ) {
        let items: Vec<Item> = self.selection.items().iter().copied().filter(can).collect();
        if items.is_empty() {
            self.toasts.info(otherwise);
        } else {
            self.apply(action(self.document.scene(), items), None);
        }
    }

    /// Puts the selected lights and things on the clipboard, and returns them; none without any.
    fn copy_selected(&mut self, ctx: &Context) -> Option<Vec<Item>> {
        let items: Vec<Item> = self.selection.items().iter().copied().filter(|item| item.can_be_copied()).collect();
        let Some(text) = clipboard::copied_text(self.document.scene(), &items, self.document.asset_files()) else {
            self.toasts.info("Select a light or a thing to copy.");
            return None;
        };
        ctx.copy_text(text);
        Some(items)
    }

    /// Adds the lights and things of a text from the clipboard. Their files become imported ones of this studio.
    fn paste(&mut self, text: &str) {
        let Some(ClipboardContent { mut scene, files }) = clipboard::pasted(text) else {
            self.toasts.info("There are no lights or things on the clipboard.");
            return;
        };
        let document = &mut self.document;
        scene.rename_asset_files(|asset| {
            let file = files.get(asset.path()?)?;
            let path = document.asset_path_for(file, import_folder(asset));
            document.note_import(path.clone(), file.clone());
            Some(path)
        });
        self.apply(Action::Paste(Box::new(scene)), None);
    }

    fn mirror_selected(&mut self, copies: bool) {
        let scene = self.document.scene();
        let Some(subject) = mirror_subject(scene, &self.selection) else {
            self.toasts.info("There is nothing that lights could be mirrored about: put a figure up first.");
            return;
        };
        let Some(plane) = MirrorPlane::of_subject(subject) else {
            self.toasts.info(format!("{} looks straight up or down: it has no left and right.", subject.name));
            return;
        };
        let can = |item: &Item| item.can_be_copied() || (*item == Item::Meter && !copies);
        let otherwise = "Select the lights to mirror to the other side of the face.";
        self.with_selected(can, otherwise, |_, items| Action::Mirror { items, plane, copies });
    }

    fn solo_selected(&mut self) {
        let lights = self.selection.lights();
        let current = self.document.scene().solo.as_ref();
        let all_in = |some: &[LightId], others: &[LightId]| some.iter().all(|id| others.contains(id));
        let equal = |solo: &Solo| all_in(&solo.lights, &lights) && all_in(&lights, &solo.lights);
        let same = current.is_some_and(|solo| lights.is_empty() || equal(solo));
        match (same, lights.is_empty()) {
            (true, _) => self.apply(Action::Solo(Vec::new()), None),
            (false, true) => self.toasts.info("Select the lights that shall shine alone."),
            (false, false) => self.apply(Action::Solo(lights), None),
        }
    }

    fn toggle_light_view(&mut self) {
        let scene = self.document.scene();
        let light = self
            .selection
            .lights()
            .last()
            .copied()
            .filter(|id| scene.light(*id).is_some_and(|light| light.emitter != Emitter::Surround));
        match (self.views.central, light) {
            (CentralView::Light(_), _) => self.leave_light(),
            (_, Some(id)) => {
                self.views.before_light = self.views.central;
                (self.views.central, self.views.viewport.tool) = (CentralView::Light(id), None);
            }
            (_, None) => self.toasts.info("Select the light to look through."),
        }
    }

    /// Returns from the view through a light to the previous view.
    fn leave_light(&mut self) {
        self.views.central = std::mem::take(&mut self.views.before_light);
    }

    fn toggle_placing(&mut self, by: PlaceLightBy) {
        if let Some(PointerTool::PlaceLight(drag)) = self.views.viewport.tool.take()
            && drag.placing().by == by
        {
            return;
        }
        let scene = self.document.scene();
        let Some(light) = self.selection.lights().last().and_then(|id| scene.light(*id)) else {
            self.toasts.info("Select the light to place.");
            return;
        };
        if light.locked {
            self.toasts.info(ActionError::Locked(light.name.clone()).to_string());
        } else if !can_be_placed(light) {
            self.toasts.info("Light from all round has no place.");
        } else {
            let drag = PlaceLightDrag::new(LightPlacement { light: light.id, by });
            self.views.viewport.tool = Some(PointerTool::PlaceLight(Box::new(drag)));
            if !matches!(self.views.central, CentralView::Studio | CentralView::Camera) {
                self.views.central = CentralView::Studio;
            }
        }
    }

    /// Ends the innermost drag, dialog or mode; without any, clears the selection.
    fn escape(&mut self) {
        if self.views.viewport.is_dragging() {
            self.document.abandon(self.window.press_id);
            self.views.viewport.cancel_drag();
        } else if self.panels.tour.close() {
            // It was the innermost
        } else if self.panels.show_help || self.panels.show_about {
            (self.panels.show_help, self.panels.show_about) = (false, false);
        } else if self.panels.show_preferences {
            self.panels.show_preferences = false;
        } else if self.views.viewport.tool.is_some() {
            self.views.viewport.tool = None;
        } else if matches!(self.views.central, CentralView::Light(_)) {
            self.leave_light();
        } else if self.panels.show_dials {
            self.panels.show_dials = false;
        } else if self.panels.show_room_audit {
            self.panels.show_room_audit = false;
        } else if self.panels.show_gear {
            self.panels.show_gear = false;
        } else {
            self.selection = Selection::default();
        }
    }

    fn place(&mut self, made: CatalogItem) {
        let (scene, assets) = (self.document.scene(), self.document.assets());
        let action = match made {
            CatalogItem::Light(mut light) => {
                placement::place_light(scene, assets, self.selection.last(), &mut light);
                Action::AddLight(Box::new(light))
            }
            CatalogItem::Object(mut object) => {
                placement::place_object(scene, self.selection.last(), &mut object);
                Action::AddObject(Box::new(object))
            }
        };
        self.apply(action, None);
    }

    /// Shows the variant at a place in the list.
    fn show_variant_at(&mut self, index: usize) {
        let variants = &self.document.scene().variants;
        let id = variants.list().nth(index).map(|(id, _)| id);
        match id {
            Some(id) => self.show_variant(id),
            None if variants.is_empty() => {
                self.toasts.info("The studio has no variants: add one in the menu Variants.")
            }
            None => self.toasts.info(format!("There is no variant number {}.", index + 1)),
        }
    }

    /// Shows the variant that another state of the studio shows, if it is still there, with its picture.
    pub(super) fn show_variant_of(&mut self, other: &Scene) {
        let name = other.variants.name(other.variants.shown());
        if let Some(id) = name.and_then(|name| self.document.scene().variants.named(name)) {
            self.show_variant(id);
        }
    }

    /// Shows a variant with its picture.
    fn show_variant(&mut self, id: VariantId) {
        self.document.show_variant(id);
        self.variant_pictures.follow(&mut self.rendering, self.document.scene());
    }

    fn render(&mut self, ctx: &Context) {
        // The variant may have been shown in this frame
        self.variant_pictures.follow(&mut self.rendering, self.document.scene());
        if let Some(id) = self.variant_pictures.running() {
            let name = self.document.scene().variants.name(id).unwrap_or_default();
            self.toasts
                .info(format!("The picture of {name} is being rendered: wait for it, or show {name} and cancel it."));
            return;
        }
        let document = &self.document;
        self.rendering.start(document.scene(), &document.finished_assets(), document.asset_files(), ctx);
        self.views.central = CentralView::Picture;
        self.panels.tour.show_picture();
    }
}

/// Returns every object and every light.
fn all_things(scene: &Scene) -> impl Iterator<Item = Item> {
    let objects = scene.objects.iter().map(|o| Item::Object(o.id));
    objects.chain(scene.lights.iter().map(|l| Item::Light(l.id)))
}

/// Returns the items of Ctrl+A: unlocked lights and visible, unlocked objects.
fn selectable(scene: &Scene) -> Vec<Item> {
    let objects = scene.objects.iter().filter(|o| o.visible && !o.locked).map(|o| Item::Object(o.id));
    let lights = scene.lights.iter().filter(|l| !l.locked).map(|l| Item::Light(l.id));
    objects.chain(lights).collect()
}

/// Returns the subject of the mirror plane: the object that the last selected light is aimed at, else the subject of
/// the set-up.
fn mirror_subject<'a>(scene: &'a Scene, selection: &Selection) -> Option<&'a Object> {
    let aimed_at = selection.lights().last().and_then(|id| match scene.light(*id)?.aim {
        Aim::Object { object, .. } => scene.object(object),
        _ => None,
    });
    aimed_at.or_else(|| placement::subject(scene, None).and_then(|id| scene.object(id)))
}

/// Hides objects and mutes lights; shows and unmutes them if all are hidden or muted.
fn hide_or_show(scene: &Scene, items: Vec<Item>) -> Action {
    let is_there = |item: &Item| match item {
        Item::Object(id) => scene.object(*id).is_some_and(|o| o.visible),
        Item::Light(id) => scene.light(*id).is_some_and(|l| l.on),
        Item::Camera | Item::Room | Item::Meter => false,
    };
    let show = !items.iter().any(is_there);
    let label =
        format!("{} {}", if show { "Show" } else { "Hide" }, crate::editor::document::item::name_of_all(&items, scene));
    shown(scene, items, show, label)
}

fn shown(scene: &Scene, items: Vec<Item>, show: bool, label: String) -> Action {
    let (mut actions, mut lights) = (Vec::new(), Vec::new());
    for item in items {
        match item {
            Item::Object(id) => {
                let object = scene.object(id).map(|object| Object { visible: show, ..object.clone() });
                actions.extend(object.map(|object| Action::SetObject(Box::new(object))));
            }
            Item::Light(id) => lights.push(id),
            Item::Camera | Item::Room | Item::Meter => {}
        }
    }
    if !lights.is_empty() {
        actions.push(Action::Mute(lights, !show));
    }
    match <[Action; 1]>::try_from(actions) {
        Ok([only]) if matches!(only, Action::Mute(..)) => only,
        Ok(only) => Action::Together { label, actions: only.into() },
        Err(actions) => Action::Together { label, actions },
    }
}
