//! Lesson sheets: pictures of one studio in which one thing changes, side by side with captions.
//!
//! Data flow: `series` sets up and meters the studios; `contact_sheet` renders them and puts them side by side, as PNG or
//! as a web page.

mod contact_sheet;
mod series;

#[cfg(test)]
mod tests;

pub use contact_sheet::{LESSON_EXTENSIONS, LessonFormat, LessonSheet, write_lesson};
pub use series::{Lesson, LessonCell, LessonError, LessonSeries};
