//! Commands carried out.

use super::action::{Action, Item};
use super::app::App;
use super::catalog::Made;
use super::command::{Centre, Command};
use super::files::Source;
use super::placement;
use eframe::egui::{Context, ViewportCommand};

impl App {
    /// Carries a command out. `gesture` is the press that it came from.
    pub fn run(&mut self, command: Command, gesture: Option<u64>, ctx: &Context) {
        match command {
            Command::Do(action) => self.apply(action, gesture),
            Command::Place(made) => self.place(*made),
            Command::Select(item) => self.selection = item,
            Command::BeginRename(item) => {
                self.selection = Some(item);
                self.outliner.begin_rename(item, item.name(self.document.scene()));
            }
            Command::DeleteSelected => self.with_selected("Select a light or a thing to delete.", Action::Delete),
            Command::DuplicateSelected => {
                self.with_selected("Select a light or a thing to duplicate.", Action::Duplicate)
            }
            Command::Undo => drop(self.document.undo()),
            Command::Redo => drop(self.document.redo()),
            Command::New => self.picker.open(),
            Command::NewFromPreset(index) => self.replace_with(Source::Preset(index), ctx),
            Command::OpenPath(path) => self.replace_with(Source::File(path), ctx),
            Command::ClearRecent => self.recent.clear(),
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Render => self.render(ctx),
            Command::CancelRender => self.rendering.cancel(),
            Command::Show(centre) => self.centre = centre,
            Command::ToggleCameraView => {
                self.centre = if self.centre == Centre::Camera { Centre::Studio } else { Centre::Camera };
            }
            Command::FrameSelection => {
                self.centre = Centre::Studio;
                self.viewport.frame_selection(&self.document, self.selection);
            }
            Command::CameraFromView => {
                let camera = self.viewport.camera_from_view(self.document.scene());
                self.apply(Action::SetCamera(Box::new(camera)), None);
            }
            Command::Handles(handle) => self.handles = handle,
            Command::ToggleHelp => self.show_help = !self.show_help,
            Command::Open
            | Command::Save
            | Command::SaveAs
            | Command::Import
            | Command::ImportPath(_)
            | Command::ChooseTexture(..)
            | Command::ExportPicture
            | Command::PathTyped(..) => self.run_file_command(command, ctx),
        }
    }

    /// Changes the scene; what cannot be done is said.
    pub(super) fn apply(&mut self, action: Action, gesture: Option<u64>) {
        match self.document.apply(action, gesture) {
            Ok(Some(item)) => self.selection = Some(item),
            Ok(None) => {}
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    fn with_selected(&mut self, otherwise: &str, action: impl FnOnce(Item) -> Action) {
        match self.selection {
            Some(item @ (Item::Object(_) | Item::Light(_) | Item::Meter)) => self.apply(action(item), None),
            Some(Item::Camera | Item::Room) | None => self.toasts.news(otherwise),
        }
    }

    fn place(&mut self, made: Made) {
        let (scene, assets) = (self.document.scene(), self.document.assets());
        let action = match made {
            Made::Light(mut light) => {
                placement::place_light(scene, assets, self.selection, &mut light);
                Action::AddLight(Box::new(light))
            }
            Made::Object(mut object) => {
                placement::place_object(scene, self.selection, &mut object);
                Action::AddObject(Box::new(object))
            }
        };
        self.apply(action, None);
    }

    fn render(&mut self, ctx: &Context) {
        let folder = self.document.folder().map(std::path::Path::to_owned);
        self.rendering.start(self.document.scene(), self.document.assets(), folder, ctx);
        self.centre = Centre::Picture;
    }
}
