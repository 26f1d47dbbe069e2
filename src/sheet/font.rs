//! The font of a sheet: Ubuntu Light, which the window uses, too.

use ttf_parser::Face;

/// The font's file.
pub const FONT: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;

/// The metrics of the font.
#[derive(Clone, Debug)]
pub struct Font {
    face: Face<'static>,
}

impl Font {
    /// Returns the font; none if its file is damaged.
    pub fn new() -> Option<Self> {
        Face::parse(FONT, 0).ok().map(|face| Font { face })
    }

    /// Returns the parsed file.
    pub fn face(&self) -> &Face<'static> {
        &self.face
    }

    /// Returns the glyph of a character; that of an unknown character is 0, a box.
    pub fn glyph(&self, character: char) -> u16 {
        self.face.glyph_index(character).map_or(0, |glyph| glyph.0)
    }

    /// Returns true if the font has all characters of a text.
    pub fn has_all(&self, text: &str) -> bool {
        text.chars().all(|character| character.is_control() || self.glyph(character) != 0)
    }

    /// Returns the width of a glyph in parts of the font's height.
    pub fn advance(&self, glyph: u16) -> f32 {
        let units = self.face.glyph_hor_advance(ttf_parser::GlyphId(glyph)).unwrap_or(0);
        f32::from(units) / f32::from(self.face.units_per_em().max(1))
    }

    /// Returns the width of a text of a height, in the same unit.
    pub fn width(&self, text: &str, size: f32) -> f32 {
        text.chars().map(|character| self.advance(self.glyph(character))).sum::<f32>() * size
    }

    /// Shortens a text to a width, with an ellipsis at its end.
    pub fn fitted(&self, text: &str, size: f32, width: f32) -> String {
        if self.width(text, size) <= width {
            return text.to_owned();
        }
        let mut characters: Vec<char> = text.chars().collect();
        while characters.pop().is_some() {
            let shorter: String = characters.iter().collect::<String>().trim_end().to_owned() + "\u{2026}";
            if self.width(&shorter, size) <= width {
                return shorter;
            }
        }
        String::new()
    }

    /// Breaks a text between words into lines of at most a width.
    pub fn lines(&self, text: &str, size: f32, width: f32) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            match lines.last_mut() {
                Some(line) if self.width(&format!("{line} {word}"), size) <= width => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(self.fitted(word, size, width)),
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_shortened_and_broken_to_a_width() {
        let font = Font::new().unwrap();
        let whole = font.width("Key softbox", 3.0);
        assert!((10.0..20.0).contains(&whole), "{whole}");
        assert_eq!(font.fitted("Key softbox", 3.0, whole), "Key softbox");
        let short = font.fitted("Key softbox", 3.0, 0.6 * whole);
        assert!(short.ends_with('\u{2026}') && font.width(&short, 3.0) <= 0.6 * whole, "{short}");
        let lines = font.lines("one two three four five", 3.0, 15.0);
        assert!(lines.len() > 1 && lines.iter().all(|line| font.width(line, 3.0) <= 15.0), "{lines:?}");
        assert_eq!(lines.join(" "), "one two three four five");
        assert_eq!(font.fitted("wide", 3.0, 0.1), "");
    }

    #[test]
    fn the_font_has_the_characters_of_a_sheet() {
        let font = Font::new().unwrap();
        let missing: String = "Aäßé°×−–…·µ½⅓\"'1/4".chars().filter(|c| font.glyph(*c) == 0).collect();
        assert_eq!(missing, "");
    }
}
