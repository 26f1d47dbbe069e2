//! The sections of a figure: body, face, expression, pose, clothes and hair.

use crate::editor::commands::command::Command;
use crate::editor::commands::item_menu::{FACE_TIP, FRAMING_TIP};
use crate::editor::document::framing::Framing;
use crate::editor::ui::widgets::{self, row, section, swatch};
use crate::figures::{
    self, CLOTH_COLORS, ClothColor, EYE_COLORS, EyeColor, HAIR_COLORS, NamedExpression, NamedPose, SKIN_TONES, SkinTone,
};
use crate::jobs::{Catchlight, Face, sentence};
use crate::scene::{
    Arm, Beard, Body, Bottom, Figure, Gaze, HairStyle, Leg, MaterialPreset, Object, ObjectId, Parameter, ParameterSet,
    SEAT_RANGE_M, Scene, Shape, Top,
};
use eframe::egui::{
    Align, Color32, ComboBox, CornerRadius, Label, Layout, Role, Sense, Slider, StrokeKind, TextStyle, Ui, WidgetInfo,
    vec2,
};

/// Draws the lighting pattern on a figure's face, and its catchlights. The height does not depend on the texts: what is
/// below stays where it is in a drag.
pub(super) fn face_rows(ui: &mut Ui, face: Option<Result<&Face, &str>>) {
    let text = match face {
        Some(Ok(face)) => sentence(&face.lighting),
        Some(Err(message)) => message.to_owned(),
        None => "Checking\u{2026}".to_owned(),
    };
    let tip = "The pattern of the key light's shadows on the face. The key is the light that gives the face the most \
               direct light. Broad: the side that is turned to the camera is lit; short: the other one";
    row(ui, "Light on face", tip, |ui| lines_of_text(ui, 3, text));
    let tip = "The lights that are reflected in the eyes, as on a clock that the camera sees. Surrounds and surfaces that \
               glow do not count";
    let face = face.and_then(Result::ok);
    row(ui, "Catchlights", tip, |ui| {
        draw_iris(ui, face.map_or(&[], |face| &face.catchlights));
        lines_of_text(ui, 2, face.map(Face::catchlight_line).unwrap_or_default());
    });
}

/// Draws a text that wraps, in the rest of a row, as high as so many lines.
fn lines_of_text(ui: &mut Ui, lines: u8, text: String) {
    let width = ui.available_size_before_wrap().x;
    let size = vec2(width, f32::from(lines) * ui.text_style_height(&TextStyle::Body));
    ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
        ui.set_min_size(size);
        ui.add(Label::new(text).wrap());
    });
}

/// Draws an iris with the catchlights in their places.
fn draw_iris(ui: &mut Ui, catchlights: &[Catchlight]) {
    let size = 2.0 * ui.text_style_height(&TextStyle::Body);
    let (rect, _) = ui.allocate_exact_size(vec2(size, size), Sense::hover());
    let (middle, radius) = (rect.center(), size / 2.0);
    let painter = ui.painter_at(rect);
    painter.circle_filled(middle, radius, Color32::from_rgb(96, 74, 56));
    painter.circle_filled(middle, radius * 0.4, Color32::from_rgb(18, 16, 15));
    for Catchlight { place, .. } in catchlights {
        painter.circle_filled(middle + vec2(place.x, -place.y) * radius, radius * 0.16, Color32::WHITE);
    }
}

/// Draws the buttons that set the camera up before a person.
pub(super) fn framing_rows(ui: &mut Ui, id: ObjectId, out: &mut Vec<Command>) {
    row(ui, "Frame", FRAMING_TIP, |ui| {
        ui.horizontal_wrapped(|ui| {
            for framing in Framing::ALL {
                if ui.small_button(framing.label()).clicked() {
                    out.push(Command::FrameFigure(id, framing));
                }
            }
        });
    });
    row(ui, "At the face", FACE_TIP, |ui| {
        if ui.small_button("Aim, focus and meter").clicked() {
            out.push(Command::SetUpAtFace(id));
        }
    });
}

/// Draws the sections of an object that is a figure; returns true if a stool under it is wanted.
pub(super) fn figure_ui(ui: &mut Ui, scene: &Scene, object: &mut Object) -> bool {
    section(ui, "Person", true, |ui| person_rows(ui, object));
    section(ui, "Clothes and hair", true, |ui| clothes_rows(ui, object));
    let falls_short = figures::gaze_falls_short(scene, object);
    let Shape::Figure(figure) = &mut object.shape else { return false };
    let mut wants_stool = false;
    section(ui, "Face", false, |ui| set_rows(ui, &mut figure.face));
    section(ui, "Expression", false, |ui| {
        row(ui, "Expression", "A starting point for the sliders below", |ui| {
            let named = NamedExpression::ALL.into_iter().map(|e| (e.label(), e.expression()));
            picker(ui, "expression", named, &mut figure.expression);
        });
        set_rows(ui, &mut figure.expression);
    });
    section(ui, "Pose", true, |ui| {
        gaze_row(ui, scene, &mut figure.gaze, falls_short);
        wants_stool = pose_rows(ui, figure);
    });
    wants_stool
}

fn person_rows(ui: &mut Ui, object: &mut Object) {
    let Shape::Figure(figure) = &mut object.shape else { return };
    row(ui, "Somebody", "Another body, face and hair by chance; undo brings the last one back", |ui| {
        if ui.button("Randomise").clicked() {
            **figure = figures::randomised(figure, figure.seed.wrapping_add(1));
        }
    });
    let body = &mut figure.body;
    for (value, parameter) in body.values_mut().into_iter().zip(Body::PARAMETERS) {
        match parameter.name {
            "height_m" => row(ui, parameter.label, "Without shoes", |ui| {
                ui.add(Slider::new(value, parameter.low..=parameter.high).suffix(" m").fixed_decimals(2));
            }),
            "age_years" => row(ui, parameter.label, "Years", |ui| {
                ui.add(Slider::new(value, parameter.low..=parameter.high).fixed_decimals(0));
            }),
            "sex" => row(ui, parameter.label, "From female to male", |ui| slider(ui, value, parameter)),
            _ => row(ui, parameter.label, "", |ui| slider(ui, value, parameter)),
        }
    }
    let tip = "Classes of the individual typology angle, from very light to dark";
    let look = |tone: &SkinTone| (tone.label, tone.base_color(), object.material == tone.material());
    if let Some(tone) = color_choice(ui, "Skin tone", tip, SKIN_TONES, look) {
        figures::give_skin(object, &tone);
    }
    let tip = "Of the iris, from dark to light";
    let look = |eyes: &EyeColor| (eyes.label, eyes.base_color, *object.material_of("iris") == eyes.material());
    if let Some(color) = color_choice(ui, "Eyes", tip, EYE_COLORS, look) {
        figures::give_eyes(object, &color);
    }
}

/// Draws a row of coloured squares, and returns the choice whose square is clicked. `look` is that of
/// [`color_squares`].
fn color_choice<C>(
    ui: &mut Ui,
    label: &str,
    tip: &str,
    choices: impl IntoIterator<Item = C>,
    look: impl Fn(&C) -> (&'static str, [f32; 3], bool),
) -> Option<C> {
    row(ui, label, tip, |ui| color_squares(ui, label, choices, look))
}

/// Draws coloured squares, and returns the choice whose square is clicked. `look` returns the name and the reflectance
/// of a choice, and whether the figure has it now: a frame round the square shows that.
fn color_squares<C>(
    ui: &mut Ui,
    label: &str,
    choices: impl IntoIterator<Item = C>,
    look: impl Fn(&C) -> (&'static str, [f32; 3], bool),
) -> Option<C> {
    let mut clicked = None;
    for choice in choices {
        let (name, color, is_current) = look(&choice);
        let square = swatch(ui, shown(color), vec2(20.0, 20.0)).interact(Sense::click()).on_hover_text(name);
        // Named for screen readers, and for tests
        square.widget_info(|| WidgetInfo::selected(Role::Button, true, is_current, format!("{label}: {name}")));
        let widgets = &ui.visuals().widgets;
        // Black is as dark as the panel
        let stroke = if is_current { widgets.active.fg_stroke } else { widgets.noninteractive.bg_stroke };
        ui.painter().rect_stroke(square.rect, CornerRadius::same(3), stroke, StrokeKind::Outside);
        if square.clicked() {
            clicked = Some(choice);
        }
    }
    clicked
}

/// Draws what the eyes follow. `falls_short`: they are turned as far as eyes go, and do not meet it.
fn gaze_row(ui: &mut Ui, scene: &Scene, gaze: &mut Gaze, falls_short: bool) {
    let tip = "The eyes keep on it while it moves, the figure moves, or its head turns";
    row(ui, "Looks at", tip, |ui| {
        let lights = scene.lights.iter().map(|light| (light.name.as_str(), Gaze::Light(light.id)));
        let choices = [("Ahead, as posed", Gaze::Pose), ("The camera", Gaze::Camera)].into_iter().chain(lights);
        picker(ui, "gaze", choices, gaze);
    });
    if falls_short {
        row(ui, "", "", |ui| ui.weak("Eyes do not turn so far: turn the head, too"));
    }
}

/// Draws the rows of the pose; returns true if a stool is wanted.
fn pose_rows(ui: &mut Ui, figure: &mut Figure) -> bool {
    let mut wants_stool = false;
    row(ui, "Pose", "A starting point for the sliders below", |ui| {
        picker(ui, "pose", NamedPose::ALL.into_iter().map(|p| (p.label(), p.pose())), &mut figure.pose);
        if ui.button("Mirror").on_hover_text("Exchanges left and right").clicked() {
            figure.pose = figure.pose.mirrored();
        }
    });
    let pose = &mut figure.pose;
    if let Some(seat_m) = &mut pose.seat_m {
        row(ui, "Seat", "Height of what the figure sits on", |ui| {
            let mut seat_cm = *seat_m * 100.0;
            let range = SEAT_RANGE_M[0] * 100.0..=SEAT_RANGE_M[1] * 100.0;
            if ui.add(Slider::new(&mut seat_cm, range).suffix(" cm").fixed_decimals(0)).changed() {
                *seat_m = seat_cm / 100.0;
            }
        });
        row(ui, "", "", |ui| {
            let button = ui.small_button("Put a stool under").on_hover_text("A round stool as high as the seat");
            wants_stool = button.clicked();
        });
    }
    section(ui, "Head and body", true, |ui| {
        let follows = figure.gaze != Gaze::Pose;
        rows_of(ui, &mut pose.torso, |parameter| !(follows && parameter.name.starts_with("gaze")));
    });
    for (name, arm) in ["Left arm", "Right arm"].into_iter().zip(&mut pose.arms) {
        section(ui, name, false, |ui| set_rows::<Arm>(ui, arm));
    }
    for (name, leg) in ["Left leg", "Right leg"].into_iter().zip(&mut pose.legs) {
        section(ui, name, false, |ui| set_rows::<Leg>(ui, leg));
    }
    wants_stool
}

/// Draws the garments and the hair, each with its colours.
fn clothes_rows(ui: &mut Ui, object: &mut Object) {
    let Shape::Figure(figure) = &mut object.shape else { return };
    row(ui, "Top", "", |ui| {
        picker(ui, "top", Top::ALL.into_iter().map(|top| (top.label(), top)), &mut figure.top);
    });
    cloth_color_row(ui, object, "top", "Top colour");
    let Shape::Figure(figure) = &mut object.shape else { return };
    row(ui, "Below", "", |ui| {
        picker(ui, "bottom", Bottom::ALL.into_iter().map(|bottom| (bottom.label(), bottom)), &mut figure.bottom);
    });
    cloth_color_row(ui, object, "bottom", "Below colour");
    cloth_color_row(ui, object, "shoes", "Shoe colour");
    hair_rows(ui, object);
}

/// Draws hair and beard and their colour.
fn hair_rows(ui: &mut Ui, object: &mut Object) {
    let Shape::Figure(figure) = &mut object.shape else { return };
    row(ui, "Hair", "", |ui| {
        picker(ui, "hair", HairStyle::ALL.into_iter().map(|hair| (hair.label(), hair)), &mut figure.hair);
    });
    row(ui, "Beard", "", |ui| {
        picker(ui, "beard", Beard::ALL.into_iter().map(|beard| (beard.label(), beard)), &mut figure.beard);
    });
    let tip = "Of hair, beard and brows. Each of them has a colour of its own below, dyes as well";
    let look = |color: &MaterialPreset| {
        let (name, material) = (color.label(), color.material());
        let is_worn = *object.material_of("hair") == material;
        (name.strip_prefix("Hair, ").unwrap_or(name), material.base_color, is_worn)
    };
    if let Some(color) = color_choice(ui, "Hair colour", tip, HAIR_COLORS, look) {
        figures::give_hair(object, color);
    }
}

/// Draws the colours of a garment or of the shoes, and a button for any other one.
fn cloth_color_row(ui: &mut Ui, object: &mut Object, part: &str, label: &str) {
    let before = object.material_of(part).base_color;
    let mut color = before;
    let tip =
        "What the cloth reflects; the last square opens any other colour. Textures are those of its surface, below";
    row(ui, label, tip, |ui| {
        let look = |cloth: &ClothColor| (cloth.label, cloth.base_color, cloth.base_color == before);
        if let Some(cloth) = color_squares(ui, label, CLOTH_COLORS, look) {
            color = cloth.base_color;
        }
        widgets::color_ui(ui, &mut color).on_hover_text("Any other colour");
    });
    if color != before {
        figures::give_cloth_color(object, part, color.map(|c| c.min(0.99)));
    }
}

/// Draws a slider for each parameter of a set.
fn set_rows<S: ParameterSet>(ui: &mut Ui, set: &mut S) {
    rows_of(ui, set, |_| true);
}

/// Draws a slider for some parameters of a set.
fn rows_of<S: ParameterSet>(ui: &mut Ui, set: &mut S, is_shown: impl Fn(&Parameter) -> bool) {
    for (value, parameter) in set.values_mut().into_iter().zip(S::PARAMETERS) {
        if is_shown(parameter) {
            row(ui, parameter.label, "", |ui| slider(ui, value, parameter));
        }
    }
}

fn slider(ui: &mut Ui, value: &mut f32, parameter: &Parameter) {
    let slider = Slider::new(value, parameter.low..=parameter.high);
    // Names of parameters end in their unit.
    let slider = match parameter.name.rsplit_once('_') {
        Some((_, "deg")) => slider.suffix("°").fixed_decimals(0),
        Some((_, "m")) => slider.suffix(" m").fixed_decimals(2),
        _ => slider.fixed_decimals(2),
    };
    if ui.add(slider).double_clicked() {
        *value = parameter.default;
    }
}

/// Greatest height of a list, points: that of the poses.
const LIST_HEIGHT: f32 = 480.0;

/// Draws a list of named values. One that is none of them is shown as "Own".
fn picker<'a, T: PartialEq>(ui: &mut Ui, id: &str, choices: impl Iterator<Item = (&'a str, T)>, value: &mut T) {
    let choices: Vec<(&str, T)> = choices.collect();
    let current = choices.iter().find(|(_, choice)| choice == value).map_or("Own", |(name, _)| name);
    // All of a list is in sight
    ComboBox::from_id_salt(id).selected_text(current).height(LIST_HEIGHT).show_ui(ui, |ui| {
        for (name, choice) in choices {
            ui.selectable_value(value, choice, name);
        }
    });
}

/// Returns the display colour of a reflectance under the light that a white card shows as white.
fn shown(base_color: [f32; 3]) -> Color32 {
    let [r, g, b] = base_color.map(|c| (crate::color::srgb_encode(c.min(1.0)) * 255.0 + 0.5) as u8);
    Color32::from_rgb(r, g, b)
}
