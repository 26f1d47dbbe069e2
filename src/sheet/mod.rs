//! The set-up sheet: a studio on one page, to be built again on the set.
//!
//! [`SheetContent`] collects facts from the scene and from the light meter; `page` lays them out as a [`Drawing`] in
//! millimetres; `svg` and `pdf` write drawings, `html` writes a page that reads well on a phone.
//!
//! Data flow: [`MeteredSetup`](crate::setup::MeteredSetup) -> `camera_facts`, `light_facts`, `checks` -> `gear`; `silhouette` -> `view` -> `view_labels` -> `view_drawing`; all of
//! them ->
//! `content` -> `page` -> `svg`, `pdf`. `lesson` makes sheets of pictures in which one thing changes.

mod camera_facts;
mod canvas;
mod checks;
mod content;
mod drawing;
mod file;
mod font;
mod gear;
mod html;
mod label_layout;
mod lengths;
mod lesson;
mod light_facts;
mod page;
mod pdf;
mod silhouette;
mod svg;
mod view;
mod view_drawing;
mod view_labels;

pub use content::{SheetContent, SheetLight};
pub use drawing::Drawing;
pub use file::{SHEET_EXTENSIONS, SheetFormat, draft_picture, sheet_file, write_sheet};
pub use lengths::Units;
pub use lesson::{
    LESSON_EXTENSIONS, Lesson, LessonCell, LessonError, LessonFormat, LessonSeries, LessonSheet, write_lesson,
};
pub use light_facts::{COLUMNS, LightFacts};

#[cfg(test)]
mod plan_tests;
#[cfg(test)]
mod tests;
