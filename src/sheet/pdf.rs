//! Drawings as PDF: one page, with the font embedded, so that its text can be searched and copied.

use super::drawing::{Align, Drawing, Element, Rgb, Stroke, Text};
use super::font::{FONT, Font};
use flate2::{Compression, write::ZlibEncoder};
use glam::Vec2;
use pdf_writer::types::{CidFontType, FontFlags, LineJoinStyle, SystemInfo, TextRenderingMode, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::BTreeMap;
use std::io::Write;

/// PDF's points in a millimetre.
const POINTS_PER_MM: f32 = 72.0 / 25.4;
/// Line around the characters of strong text, in parts of its height.
const STRONG: f32 = 0.035;

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const PICTURE: Ref = Ref::new(5);
const TEXT_FONT: Ref = Ref::new(6);
const CID_FONT: Ref = Ref::new(7);
const DESCRIPTOR: Ref = Ref::new(8);
const FONT_FILE: Ref = Ref::new(9);
const CHARACTERS: Ref = Ref::new(10);
const ABOUT: Ref = Ref::new(11);

const FONT_NAME: Name<'static> = Name(b"F1");
const PICTURE_NAME: Name<'static> = Name(b"Im1");
const BASE_FONT: Name<'static> = Name(b"Ubuntu-Light");
/// Glyphs are numbered as in the font's file.
const NUMBERING: SystemInfo<'static> =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// A picture in JPEG, with its width and height in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Jpeg<'a> {
    /// The file.
    pub bytes: &'a [u8],
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
}

/// Returns a drawing as a PDF of one page.
pub fn pdf(drawing: &Drawing, title: &str, picture: Jpeg<'_>, font: &Font) -> Vec<u8> {
    let mut pdf = Pdf::new();
    let size = drawing.size_mm * POINTS_PER_MM;
    let mut page = PageContent { content: Content::new(), font, used: BTreeMap::new() };
    // Millimetres from the top left, y down
    page.content.transform([POINTS_PER_MM, 0.0, 0.0, -POINTS_PER_MM, 0.0, size.y]);
    page.content.set_line_join(LineJoinStyle::RoundJoin);
    drawing.elements.iter().for_each(|element| page.element(element));
    let PageContent { content, used, .. } = page;

    pdf.catalog(CATALOG).pages(PAGES);
    pdf.pages(PAGES).kids([PAGE]).count(1);
    let mut info = pdf.document_info(ABOUT);
    info.title(TextStr(title)).creator(TextStr(concat!("Catchlight ", env!("CARGO_PKG_VERSION"))));
    info.finish();
    let mut page = pdf.page(PAGE);
    page.parent(PAGES).media_box(Rect::new(0.0, 0.0, size.x, size.y)).contents(CONTENT);
    let mut resources = page.resources();
    resources.fonts().pair(FONT_NAME, TEXT_FONT);
    resources.x_objects().pair(PICTURE_NAME, PICTURE);
    resources.finish();
    page.finish();
    let content = content.finish();
    pdf.stream(CONTENT, &compressed(&content)).filter(Filter::FlateDecode);
    let mut image = pdf.image_xobject(PICTURE, picture.bytes);
    image.filter(Filter::DctDecode);
    image.width(integer(picture.width)).height(integer(picture.height));
    image.color_space().device_rgb();
    image.bits_per_component(8);
    image.finish();
    write_font(&mut pdf, font, &used);
    pdf.finish()
}

/// Writes the font with the widths and the characters of the glyphs that are used.
fn write_font(pdf: &mut Pdf, font: &Font, used: &BTreeMap<u16, char>) {
    let mut text_font = pdf.type0_font(TEXT_FONT);
    text_font.base_font(BASE_FONT).encoding_predefined(Name(b"Identity-H"));
    text_font.descendant_font(CID_FONT).to_unicode(CHARACTERS);
    text_font.finish();

    let mut cid_font = pdf.cid_font(CID_FONT);
    cid_font.subtype(CidFontType::Type2).base_font(BASE_FONT).system_info(NUMBERING);
    cid_font.font_descriptor(DESCRIPTOR).default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
    let mut widths = cid_font.widths();
    for glyph in used.keys() {
        widths.consecutive(*glyph, [1000.0 * font.advance(*glyph)]);
    }
    widths.finish();
    cid_font.finish();

    let face = font.face();
    let per_mille = |units: i16| 1000.0 * f32::from(units) / f32::from(face.units_per_em().max(1));
    let bounds = face.global_bounding_box();
    let [left, bottom, right, top] = [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(per_mille);
    let mut descriptor = pdf.font_descriptor(DESCRIPTOR);
    descriptor.name(BASE_FONT).flags(FontFlags::NON_SYMBOLIC).bbox(Rect::new(left, bottom, right, top));
    descriptor.italic_angle(0.0).ascent(per_mille(face.ascender())).descent(per_mille(face.descender()));
    descriptor.cap_height(per_mille(face.capital_height().unwrap_or(face.ascender()))).stem_v(60.0);
    descriptor.font_file2(FONT_FILE);
    descriptor.finish();

    let file = compressed(FONT);
    let mut stream = pdf.stream(FONT_FILE, &file);
    stream.filter(Filter::FlateDecode);
    stream.pair(Name(b"Length1"), i32::try_from(FONT.len()).unwrap_or(i32::MAX));
    stream.finish();

    let mut characters = UnicodeCmap::new(Name(b"Characters"), NUMBERING);
    // Glyph 0 stands for all characters that the font lacks
    used.iter().filter(|(glyph, _)| **glyph > 0).for_each(|(glyph, character)| characters.pair(*glyph, *character));
    let characters = characters.finish();
    pdf.cmap(CHARACTERS, &compressed(&characters)).filter(Filter::FlateDecode);
}

/// The content of the page while it is written.
struct PageContent<'a> {
    content: Content,
    font: &'a Font,
    /// The glyphs that are used, with their characters.
    used: BTreeMap<u16, char>,
}

impl PageContent<'_> {
    fn element(&mut self, element: &Element) {
        match element {
            Element::Path { lines, closed, fill, stroke } => self.path(lines, *closed, *fill, *stroke),
            Element::Text(text) => self.text(text),
            Element::Picture { at, size } => {
                self.content.save_state();
                // Pictures are upright where y is up
                self.content.transform([size.x, 0.0, 0.0, -size.y, at.x, at.y + size.y]);
                self.content.x_object(PICTURE_NAME).restore_state();
            }
            Element::Clipped { at, size, elements } => {
                self.content.save_state();
                self.content.rect(at.x, at.y, size.x, size.y).clip_nonzero().end_path();
                elements.iter().for_each(|element| self.element(element));
                self.content.restore_state();
            }
        }
    }

    fn path(&mut self, lines: &[Vec<Vec2>], closed: bool, fill: Option<Rgb>, stroke: Option<Stroke>) {
        if let Some(color) = fill {
            self.fill_color(color);
        }
        if let Some(stroke) = stroke {
            let [r, g, b] = unit(stroke.color);
            self.content.set_stroke_rgb(r, g, b).set_line_width(stroke.width_mm);
            self.content.set_dash_pattern(stroke.dash_mm, 0.0);
        }
        for line in lines {
            let mut points = line.iter();
            if let Some(first) = points.next() {
                self.content.move_to(first.x, first.y);
            }
            points.for_each(|point| {
                self.content.line_to(point.x, point.y);
            });
            if closed {
                self.content.close_path();
            }
        }
        match (fill, stroke) {
            (Some(_), Some(_)) => self.content.fill_even_odd_and_stroke(),
            (Some(_), None) => self.content.fill_even_odd(),
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
    }

    fn text(&mut self, text: &Text) {
        let Text { at, text, size_mm, color, align, strong } = text;
        let width = self.font.width(text, *size_mm);
        let left = match align {
            Align::Left => at.x,
            Align::Center => at.x - 0.5 * width,
            Align::Right => at.x - width,
        };
        self.fill_color(*color);
        let mut glyphs = Vec::new();
        for character in text.chars().filter(|character| !character.is_control()) {
            let glyph = self.font.glyph(character);
            glyphs.extend(glyph.to_be_bytes());
            self.used.entry(glyph).or_insert(character);
        }
        self.content.begin_text().set_font(FONT_NAME, *size_mm);
        if *strong {
            let [r, g, b] = unit(*color);
            self.content.set_stroke_rgb(r, g, b).set_line_width(STRONG * size_mm).set_dash_pattern(None, 0.0);
            self.content.set_text_rendering_mode(TextRenderingMode::FillStroke);
        } else {
            self.content.set_text_rendering_mode(TextRenderingMode::Fill);
        }
        // Upright where y is down
        self.content.set_text_matrix([1.0, 0.0, 0.0, -1.0, left, at.y]).show(Str(&glyphs)).end_text();
    }

    fn fill_color(&mut self, color: Rgb) {
        let [r, g, b] = unit(color);
        self.content.set_fill_rgb(r, g, b);
    }
}

fn unit(color: Rgb) -> [f32; 3] {
    color.map(|channel| f32::from(channel) / 255.0)
}

fn integer(value: u32) -> i32 {
    i32::try_from(value).unwrap_or(i32::MAX)
}

fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Writing to memory does not fail.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}
