//! The pictures of a lesson, side by side.

use super::series::{Lesson, LessonCell, LessonError};
use crate::io::{self, SaveError};
use crate::photo::Picture;
use crate::raytrace::{GeometryCache, RenderControl};
use crate::scene::Assets;
use crate::sheet::canvas::Canvas;
use crate::sheet::file::{ending, small_picture};
use crate::sheet::font::Font;
use crate::sheet::svg::{FONTS, escaped};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;
use std::path::Path;

/// Longer side of a picture, pixels.
const PICTURE_PIXELS: u32 = 300;
/// Edge and gaps of the sheet, pixels.
const EDGE: u32 = 24;
const GAP: u32 = 16;
/// Heights of heading and captions, pixels.
const HEADING: u32 = 78;
const CAPTIONS: u32 = 44;
const TITLE_SIZE: f32 = 28.0;
const TEXT_SIZE: f32 = 16.0;
const BLACK: [u8; 3] = [20; 3];
const GREY: [u8; 3] = [110; 3];

const STYLE: &str = "
body { margin: 0 auto; padding: 16px; max-width: 1600px; color: #181818; background: #fff; line-height: 1.4 }
h1 { font-size: 1.6em; margin: 0 } p, small { color: #666 } small { display: block }
main { display: grid; gap: 16px } figure { margin: 0 } img { width: 100%; height: auto; display: block }
@media (max-width: 640px) { main { grid-template-columns: 1fr 1fr !important } }
";

/// The extensions of lesson sheets, the default one first.
pub const LESSON_EXTENSIONS: &[&str] = &["png", "html"];

/// The format of a lesson sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LessonFormat {
    /// A picture.
    Png,
    /// A web page in one file.
    Html,
}

impl LessonFormat {
    /// Returns the format of a file name.
    ///
    /// # Errors
    /// If the extension is none of `png`, `html` and `htm`, in upper or lower case.
    pub fn of(path: &Path) -> Result<Self, SaveError> {
        let ending = ending(path);
        match ending.as_str() {
            "png" => Ok(LessonFormat::Png),
            "html" | "htm" => Ok(LessonFormat::Html),
            _ => Err(SaveError::UnknownEnding {
                known: "a lesson sheet's name ends in .png or .html",
                ending,
                path: path.to_owned(),
            }),
        }
    }
}

/// A lesson with its pictures.
#[derive(Clone, Debug)]
pub struct LessonSheet {
    lesson: Lesson,
    pictures: Vec<Picture>,
}

impl LessonSheet {
    /// Renders the pictures of a lesson and denoises them, on the current thread pool; `observe` is called before each,
    /// with its number from 0.
    ///
    /// # Errors
    /// If a scene has errors, or once `control` is cancelled.
    pub fn render(
        lesson: Lesson,
        assets: &Assets,
        samples: u32,
        cache: &GeometryCache,
        control: &RenderControl,
        observe: &mut dyn FnMut(usize, &LessonCell),
    ) -> Result<Self, LessonError> {
        let mut pictures = Vec::new();
        for (index, cell) in lesson.cells.iter().enumerate() {
            observe(index, cell);
            let picture = small_picture(&cell.scene, assets, PICTURE_PIXELS, samples, cache, control)?;
            pictures.push(picture.ok_or(LessonError::Cancelled)?);
        }
        Ok(LessonSheet { lesson, pictures })
    }

    fn cells(&self) -> impl Iterator<Item = (&LessonCell, &Picture)> {
        self.lesson.cells.iter().zip(&self.pictures)
    }

    /// Returns the sheet as one picture.
    fn canvas(&self, font: &Font) -> Canvas {
        let size = |edge: fn(&Picture) -> u32| self.pictures.iter().map(edge).max().unwrap_or(1);
        let (width, height) = (size(|picture| picture.width), size(|picture| picture.height));
        let count = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        let columns = count(self.lesson.columns.clamp(1, self.lesson.cells.len().max(1)));
        let rows = count(self.lesson.cells.len()).div_ceil(columns);
        let (step_x, step_y) = (width + GAP, height + CAPTIONS + GAP);
        let sheet_width = (2 * EDGE + columns * step_x - GAP).max(640);
        let mut canvas = Canvas::new(sheet_width, 2 * EDGE + HEADING + rows * step_y - GAP);
        let text_width = (sheet_width - 2 * EDGE) as f32;
        let left = EDGE as f32;
        let title = font.fitted(&self.lesson.title, TITLE_SIZE, text_width);
        canvas.text(font, &title, TITLE_SIZE, (left, (EDGE + 24) as f32), BLACK);
        let about = font.fitted(&self.lesson.about, TEXT_SIZE, text_width);
        canvas.text(font, &about, TEXT_SIZE, (left, (EDGE + 52) as f32), GREY);
        for (index, (cell, picture)) in (0..).zip(self.cells()) {
            let (x, y) = (EDGE + index % columns * step_x, EDGE + HEADING + index / columns * step_y);
            canvas.put((x, y), picture.width, &picture.to_srgb8());
            for (text, below, color) in [(&cell.caption, 18, BLACK), (&cell.note, 37, GREY)] {
                let text = font.fitted(text, TEXT_SIZE, width as f32);
                canvas.text(font, &text, TEXT_SIZE, (x as f32, (y + height + below) as f32), color);
            }
        }
        canvas
    }

    /// Returns the sheet as a web page.
    fn html(&self) -> Result<String, String> {
        let (title, columns) = (escaped(&self.lesson.title), self.lesson.columns.max(1));
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <meta name=\"generator\" content=\"Catchlight {}\"/>\n<title>{title}</title>\n\
             <style>body {{ font-family: {FONTS} }}{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<p>{}</p>\n\
             <main style=\"grid-template-columns: repeat({columns}, 1fr)\">\n",
            env!("CARGO_PKG_VERSION"),
            escaped(&self.lesson.about)
        );
        for (cell, picture) in self.cells() {
            let (caption, note) = (escaped(&cell.caption), escaped(&cell.note));
            let data = STANDARD.encode(io::encode_jpeg(picture)?);
            let _ = writeln!(
                out,
                "<figure><img src=\"data:image/jpeg;base64,{data}\" alt=\"{caption}\"/>\
                 <figcaption>{caption}<small>{note}</small></figcaption></figure>"
            );
        }
        out += "</main>\n</body>\n</html>\n";
        Ok(out)
    }

    /// Returns the bytes of the sheet's file.
    ///
    /// # Errors
    /// If a picture can't be encoded.
    pub fn file(&self, format: LessonFormat) -> Result<Vec<u8>, String> {
        match format {
            LessonFormat::Png => {
                let canvas = self.canvas(&Font::new().ok_or("the font is damaged")?);
                io::encode_png(canvas.width, canvas.height, &canvas.pixels)
            }
            LessonFormat::Html => Ok(self.html()?.into_bytes()),
        }
    }
}

/// Writes a lesson sheet in the format of the file name's extension. An older file is replaced atomically.
///
/// # Errors
/// If the extension is unknown, or if the file can't be written.
pub fn write_lesson(path: &Path, sheet: &LessonSheet) -> Result<(), SaveError> {
    let bytes = sheet.file(LessonFormat::of(path)?);
    let bytes = bytes.map_err(|message| SaveError::Encode { message, path: path.to_owned() })?;
    io::write_file(path, &bytes)
}
