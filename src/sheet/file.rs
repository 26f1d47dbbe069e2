//! Files of sheets: PDF, SVG or HTML by extension, and the picture on them.

use super::content::SheetContent;
use super::font::Font;
use super::html::html;
use super::page::page;
use super::pdf::{Jpeg, pdf};
use super::svg::svg;
use crate::denoise::{self, Quality};
use crate::io::{self, SaveError};
use crate::jobs::render_all_passes;
use crate::photo::Picture;
use crate::raytrace::{GeometryCache, PrepareError, Purpose, RenderControl, Settings, prepare_for};
use crate::scene::{Assets, Scene};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::path::Path;

/// Longer side of the picture on a sheet, pixels: 250 dpi on the page.
const PICTURE_PIXELS: u32 = 660;

/// The extensions of sheets, the default one first.
pub const SHEET_EXTENSIONS: &[&str] = &["pdf", "svg", "html"];

/// Returns the extension of a file name in lower case; empty without one.
pub fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// The format of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetFormat {
    /// A page of A4.
    Pdf,
    /// The same page as a vector drawing.
    Svg,
    /// A web page in one file.
    Html,
}

impl SheetFormat {
    /// Returns the format of a file name.
    ///
    /// # Errors
    /// If the extension is none of `pdf`, `svg`, `html` and `htm`, in upper or lower case.
    pub fn of(path: &Path) -> Result<Self, SaveError> {
        let ending = ending(path);
        match ending.as_str() {
            "pdf" => Ok(SheetFormat::Pdf),
            "svg" => Ok(SheetFormat::Svg),
            "html" | "htm" => Ok(SheetFormat::Html),
            _ => Err(SaveError::UnknownEnding {
                known: "a sheet's name ends in .pdf, .svg or .html",
                ending,
                path: path.to_owned(),
            }),
        }
    }
}

/// Renders the picture of a sheet and denoises it, on the current thread pool. None once `control` is cancelled.
///
/// # Errors
/// If the scene has errors.
pub fn draft_picture(
    scene: &Scene,
    assets: &Assets,
    samples: u32,
    cache: &GeometryCache,
    control: &RenderControl,
) -> Result<Option<Picture>, PrepareError> {
    small_picture(scene, assets, PICTURE_PIXELS, samples, cache, control)
}

/// Renders a picture of so many pixels on its longer side and denoises it. None once `control` is cancelled.
///
/// # Errors
/// If the scene has errors.
pub fn small_picture(
    scene: &Scene,
    assets: &Assets,
    longer_side: u32,
    samples: u32,
    cache: &GeometryCache,
    control: &RenderControl,
) -> Result<Option<Picture>, PrepareError> {
    let (width, height) = scene.camera.picture_size(longer_side);
    let settings = Settings { width, height, spp: samples, aovs: true, ..Settings::default() };
    let purpose = Purpose { picture: Some((width, height)), ..Purpose::default() };
    let prepared = prepare_for(scene, assets, purpose, cache)?;
    let film = render_all_passes(&prepared, &settings, control);
    let picture = film.develop(scene);
    let denoised = match film.aovs() {
        Some(aovs) => denoise::denoise(&picture, &aovs, Quality::Best, &|| control.is_cancelled()).ok(),
        None => Some(picture),
    };
    Ok(denoised.filter(|_| !control.is_cancelled()))
}

/// Returns the bytes of a sheet's file.
///
/// # Errors
/// If picture or font can't be encoded.
pub fn sheet_file(content: &SheetContent, format: SheetFormat) -> Result<Vec<u8>, String> {
    let font = Font::new().ok_or("the font is damaged")?;
    let Picture { width, height, .. } = content.picture;
    let side = width.max(height).max(1);
    // A picture that is larger than needed makes a large file
    let shrunk =
        |edge: u32| u32::try_from(u64::from(edge) * u64::from(2 * PICTURE_PIXELS) / u64::from(side)).unwrap_or(edge);
    let smaller =
        (side > 2 * PICTURE_PIXELS).then(|| content.picture.resized(shrunk(width).max(1), shrunk(height).max(1)));
    let picture = smaller.as_ref().unwrap_or(&content.picture);
    let jpeg = io::encode_jpeg(picture)?;
    let address = || format!("data:image/jpeg;base64,{}", STANDARD.encode(&jpeg));
    Ok(match format {
        SheetFormat::Pdf => {
            let picture = Jpeg { bytes: &jpeg, width: picture.width, height: picture.height };
            pdf(&page(content, &font), &content.title, picture, &font)
        }
        SheetFormat::Svg => svg(&page(content, &font), &address(), "clip").into_bytes(),
        SheetFormat::Html => html(content, &address(), &font).into_bytes(),
    })
}

/// Writes a sheet in the format of the file name's extension. An older file is replaced atomically.
///
/// # Errors
/// If the extension is unknown, or if the file can't be written.
pub fn write_sheet(path: &Path, content: &SheetContent) -> Result<(), SaveError> {
    let bytes = sheet_file(content, SheetFormat::of(path)?)
        .map_err(|message| SaveError::Encode { message, path: path.to_owned() })?;
    io::write_file(path, &bytes)
}
