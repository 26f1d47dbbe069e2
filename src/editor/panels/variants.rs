//! The row of the studio's variants, over the views.

use crate::editor::commands::command::Command;
use crate::editor::commands::menu_entry::entry;
use crate::editor::document::action::Action;
use crate::editor::picture::variant_pictures::VariantPictures;
use crate::editor::ui::name_field::{NameAnswer, NameField};
use crate::editor::ui::{theme, widgets};
use crate::scene::{Scene, SetupDifference, VariantId};
use eframe::egui::{Button, RichText, Ui};

/// The state of the row.
#[derive(Clone, Debug, Default)]
pub struct VariantsState {
    /// The name field of the variant that is being renamed.
    rename: Option<NameField<VariantId>>,
}

impl VariantsState {
    /// Opens the name field of a variant.
    pub fn begin_rename(&mut self, id: VariantId, name: String) {
        self.rename = Some(NameField::new(id, name));
    }
}

/// Draws the row.
pub fn variants_ui(
    ui: &mut Ui,
    scene: &Scene,
    pictures: &VariantPictures,
    state: &mut VariantsState,
    out: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.label(RichText::new("Variants").weak());
        for (index, (id, name)) in scene.variants.list().enumerate() {
            if state.rename.as_ref().is_some_and(|field| field.target == id) {
                rename_ui(ui, state, out);
                continue;
            }
            let shown = id == scene.variants.shown();
            let button = ui.add(Button::selectable(shown, name));
            widgets::named(ui, &button, &format!("Variant {name}"));
            if button.clicked() {
                out.push(Command::ShowVariant(id));
            }
            if button.double_clicked() {
                out.push(Command::BeginRenameVariant(id));
            }
            button.context_menu(|ui| entries(ui, scene, id, out));
            button.on_hover_ui(|ui| {
                let key = if index < 9 { format!(" (Ctrl+{})", index + 1) } else { String::new() };
                let hint = "Double-click to rename; right-click for more.";
                ui.label(format!("{}{key}. {hint}", difference_text(scene, id)));
            });
            if pictures.running() == Some(id) {
                ui.label(RichText::new("rendering").color(theme::accent(ui)).small());
            }
        }
        let add = ui.button("+");
        widgets::named(ui, &add, "Add variant");
        if add.on_hover_text("Add a variant, equal to what is shown").clicked() {
            out.push(Command::AddVariant);
        }
    });
}

/// Draws the menu entries of a variant.
pub fn entries(ui: &mut Ui, scene: &Scene, id: VariantId, out: &mut Vec<Command>) {
    let name = scene.variants.name(id).unwrap_or_default();
    let is_other = id != scene.variants.studio_id;
    let make = format!("Make {name} the studio");
    let tip = "It becomes what the file opens with; what was the studio becomes a variant. Pictures stay as they are.";
    entry(ui, is_other, &make, tip, Command::Apply(Action::MakeStudio(id)), out);
    entry(ui, true, &format!("Rename {name}"), "Give the variant another name", Command::BeginRenameVariant(id), out);
    let delete = Command::Apply(Action::DeleteVariant(id));
    entry(ui, is_other, &format!("Delete {name}"), "Its lights and its picture go; the studio stays", delete, out);
}

/// Returns the difference of a variant from the studio in words: `Differs in: Key, no Fill, camera`.
pub fn difference_text(scene: &Scene, id: VariantId) -> String {
    if id == scene.variants.studio_id {
        return "The studio itself".to_owned();
    }
    // The difference of the shown variant is not stored
    let of_studio = scene.as_variant(scene.variants.studio_id);
    let studio = of_studio.as_ref().unwrap_or(scene);
    let variant = studio.variants.others.iter().find(|variant| variant.id == id);
    let Some(difference) = variant.map(|variant| &variant.difference) else { return String::new() };
    let SetupDifference { camera, lights, removed_lights, added_lights, hidden, visible } = difference;
    let light_name = |id| studio.light(id).map_or(String::new(), |light| light.name.clone());
    let object_name = |id| studio.object(id).map_or(String::new(), |object| object.name.clone());
    let changed = lights.iter().map(|(id, _)| light_name(*id));
    let removed = removed_lights.iter().map(|id| format!("no {}", light_name(*id)));
    let added = added_lights.iter().map(|light| format!("with {}", light.name));
    let camera = (!camera.is_empty()).then(|| "camera".to_owned());
    let hidden = hidden.iter().map(|id| format!("{} hidden", object_name(*id)));
    let visible = visible.iter().map(|id| format!("{} visible", object_name(*id)));
    let parts: Vec<String> = changed.chain(removed).chain(added).chain(camera).chain(hidden).chain(visible).collect();
    match parts.as_slice() {
        [] => "Equal to the studio".to_owned(),
        parts => format!("Differs in: {}", parts.join(", ")),
    }
}

/// Draws the name field in the place of a variant.
fn rename_ui(ui: &mut Ui, state: &mut VariantsState, out: &mut Vec<Command>) {
    let Some(field) = &mut state.rename else { return };
    let Some(answer) = field.ui(ui, "Name of the variant", 140.0) else { return };
    if let NameAnswer::Named(name) = answer {
        out.push(Command::Apply(Action::RenameVariant(field.target, name)));
    }
    state.rename = None;
}
