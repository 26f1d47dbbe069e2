//! The prompt that offers an unsaved studio after a crash.

use crate::editor::panels::thumbnails::{Thumbnail, UNSAVED_POINTS};
use crate::editor::ui::widgets::{self, Question};
use crate::io::RecoveryInfo;
use eframe::egui::{self, RichText, Sense, Ui, Vec2};
use std::time::Duration;

/// An unsaved studio on offer.
#[derive(Clone, Copy, Debug)]
pub struct UnsavedStudio<'a> {
    /// The studio.
    pub info: &'a RecoveryInfo,
    /// Its rendered picture is kept, too.
    pub has_picture: bool,
    /// Number of other unsaved studios.
    pub more: usize,
    /// What its camera sees; none until it is drawn.
    pub picture: Option<Thumbnail>,
}

/// The answer to the offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecoveryAnswer {
    /// Open it.
    Recover,
    /// Delete it.
    Discard,
    /// Ask at the next start.
    Later,
}

/// Draws the offer.
pub fn recovery_ui(ctx: &egui::Context, unsaved: &UnsavedStudio<'_>) -> Option<RecoveryAnswer> {
    let UnsavedStudio { info, picture, .. } = *unsaved;
    let question = Question {
        name: "recovery",
        width: 560.0,
        heading: if info.is_saved { "Picture that was not exported" } else { "Unsaved studio" },
        answers: &[
            (
                "Recover",
                RecoveryAnswer::Recover,
                "Open it with all changes and its picture; nothing is written to its file yet (Enter)",
            ),
            ("Discard", RecoveryAnswer::Discard, "What is kept of it is lost"),
            ("Later", RecoveryAnswer::Later, "Ask again at the next start (Esc)"),
        ],
        on_enter: Some(RecoveryAnswer::Recover),
    };
    widgets::question_dialog(ctx, &question, |ui| {
        ui.horizontal_top(|ui| {
            // Text and buttons stay where they are when the picture arrives, whatever its shape.
            let (rect, response) = ui.allocate_exact_size(Vec2::splat(UNSAVED_POINTS), Sense::hover());
            let name = "Picture of the unsaved studio";
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
            if let Some(picture) = picture {
                picture.paint(ui, rect);
            }
            ui.vertical(|ui| facts(ui, unsaved));
        });
    })
}

/// Writes what is known about an unsaved studio.
fn facts(ui: &mut Ui, UnsavedStudio { info, has_picture, more, .. }: &UnsavedStudio<'_>) {
    let age = info.changed_at.elapsed().unwrap_or_default();
    let (title, ago) = (&info.title, ago(age));
    ui.label(if info.is_saved {
        format!("Catchlight ended before the picture of \"{title}\" was exported. It was kept {ago}.")
    } else {
        let picture = if *has_picture { " Its picture is kept, too." } else { "" };
        format!("Catchlight ended before \"{title}\" was saved. Its last change was {ago}.{picture}")
    });
    if let Some(path) = info.path.as_ref().filter(|_| !info.is_saved) {
        ui.label(RichText::new(format!("The file {} is as it was saved last.", path.display())).weak());
    }
    if *more > 0 {
        ui.label(RichText::new(format!("Unsaved studios that are offered after this one: {more}")).weak());
    }
}

/// Returns how long ago something was, in words.
fn ago(age: Duration) -> String {
    let minutes = age.as_secs() / 60;
    let (number, unit) = match minutes {
        0 => return "less than a minute ago".to_owned(),
        1..60 => (minutes, "minute"),
        60..1440 => (minutes / 60, "hour"),
        _ => (minutes / 1440, "day"),
    };
    format!("{number} {unit}{} ago", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_words() {
        let words = [0, 59, 60, 179, 3600, 7200, 86_400, 200_000].map(|seconds| ago(Duration::from_secs(seconds)));
        assert_eq!(&words[..2], ["less than a minute ago"; 2]);
        assert_eq!(
            &words[2..],
            ["1 minute ago", "2 minutes ago", "1 hour ago", "2 hours ago", "1 day ago", "2 days ago"]
        );
    }
}
