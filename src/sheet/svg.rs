//! Drawings as SVG.

use super::drawing::{Align, Drawing, Element, Rgb, Stroke, Text};
use glam::Vec2;
use std::fmt::Write;

/// Fonts of SVG and HTML, the PDF's own first.
pub const FONTS: &str = "Ubuntu, 'Open Sans', Roboto, 'Helvetica Neue', Arial, sans-serif";

/// Returns a drawing as an SVG element. The picture is a `data:` address; `prefix` makes the ids of several drawings in
/// one page differ.
pub fn svg(drawing: &Drawing, picture: &str, prefix: &str) -> String {
    let [width, height] = drawing.size_mm.to_array().map(number);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\">\n"
    );
    let mut writer = Writer { out: &mut out, picture, prefix, clips: 0 };
    drawing.elements.iter().for_each(|element| writer.element(element));
    out += "</svg>\n";
    out
}

struct Writer<'a> {
    out: &'a mut String,
    picture: &'a str,
    prefix: &'a str,
    clips: u32,
}

impl Writer<'_> {
    fn element(&mut self, element: &Element) {
        match element {
            Element::Path { lines, closed, fill, stroke } => self.path(lines, *closed, *fill, *stroke),
            Element::Text(text) => self.text(text),
            Element::Picture { at, size } => {
                let [x, y, width, height] = [at.x, at.y, size.x, size.y].map(number);
                self.line(&format!(
                    "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" href=\"{}\"/>",
                    self.picture
                ));
            }
            Element::Clipped { at, size, elements } => {
                let [x, y, width, height] = [at.x, at.y, size.x, size.y].map(number);
                let id = format!("{}{}", self.prefix, self.clips);
                self.clips += 1;
                let rect = format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>");
                self.line(&format!("<clipPath id=\"{id}\">{rect}</clipPath>"));
                self.line(&format!("<g clip-path=\"url(#{id})\">"));
                elements.iter().for_each(|element| self.element(element));
                self.line("</g>");
            }
        }
    }

    fn line(&mut self, line: &str) {
        self.out.push_str(line);
        self.out.push('\n');
    }

    fn path(&mut self, lines: &[Vec<Vec2>], closed: bool, fill: Option<Rgb>, stroke: Option<Stroke>) {
        let mut data = String::new();
        for line in lines {
            for (index, point) in line.iter().enumerate() {
                let command = if index == 0 { 'M' } else { 'L' };
                let _ = write!(data, "{command}{} {}", number(point.x), number(point.y));
            }
            data.push_str(if closed { "Z" } else { "" });
        }
        let fill = fill.map_or("none".to_owned(), color);
        let stroke = stroke.map(|stroke| {
            let dash = stroke.dash_mm.map(|dash| format!(" stroke-dasharray=\"{}\"", number(dash))).unwrap_or_default();
            let width = number(stroke.width_mm);
            format!(" stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}", color(stroke.color))
        });
        let stroke = stroke.unwrap_or_default();
        self.line(&format!("<path d=\"{data}\" fill=\"{fill}\" fill-rule=\"evenodd\"{stroke}/>"));
    }

    fn text(&mut self, text: &Text) {
        let anchor = match text.align {
            Align::Left => "",
            Align::Center => " text-anchor=\"middle\"",
            Align::Right => " text-anchor=\"end\"",
        };
        let weight = if text.strong { " font-weight=\"600\"" } else { "" };
        let [x, y, size] = [text.at.x, text.at.y, text.size_mm].map(number);
        let (fill, characters) = (color(text.color), escaped(&text.text));
        self.line(&format!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{fill}\"{anchor}{weight}>{characters}</text>"
        ));
    }
}

/// Returns text with the characters of markup replaced, for SVG and HTML. Characters that XML forbids are left out, and
/// breaks of lines are spaces.
pub fn escaped(text: &str) -> String {
    let spaced = text.chars().map(|character| if character.is_whitespace() { ' ' } else { character });
    let visible = spaced.filter(|character| !character.is_control() && !matches!(character, '\u{fffe}' | '\u{ffff}'));
    visible.fold(String::new(), |mut out, character| {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            character => out.push(character),
        }
        out
    })
}

/// Returns a colour for CSS.
pub fn color([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Formats millimetres with a hundredth.
fn number(value: f32) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
