//! A picture of bytes on which pictures and text are put side by side.

use super::font::Font;
use ab_glyph_rasterizer::{Point, Rasterizer, point};
use ttf_parser::{GlyphId, OutlineBuilder};

/// An sRGB picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Canvas {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// The pixels, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

impl Canvas {
    /// Returns a white canvas.
    pub fn new(width: u32, height: u32) -> Self {
        Canvas { width, height, pixels: vec![[255; 3]; width as usize * height as usize] }
    }

    /// Puts rows of `width` pixels at a place; what lies outside is cut off.
    pub fn put(&mut self, (left, top): (u32, u32), width: u32, pixels: &[[u8; 3]]) {
        for (y, row) in (top..self.height).zip(pixels.chunks(width.max(1) as usize)) {
            for (x, pixel) in (left..self.width).zip(row) {
                self.pixels[y as usize * self.width as usize + x as usize] = *pixel;
            }
        }
    }

    /// Draws a line of text from a point of its baseline to the right. `size` is the height of the font, pixels.
    pub fn text(&mut self, font: &Font, text: &str, size: f32, (left, baseline): (f32, f32), color: [u8; 3]) {
        let scale = size / f32::from(font.face().units_per_em().max(1));
        let mut outline = Outline {
            rasterizer: Rasterizer::new(self.width as usize, self.height as usize),
            scale,
            left,
            baseline,
            first: point(0.0, 0.0),
            last: point(0.0, 0.0),
        };
        for character in text.chars() {
            let glyph = font.glyph(character);
            font.face().outline_glyph(GlyphId(glyph), &mut outline);
            outline.left += font.advance(glyph) * size;
        }
        let pixels = &mut self.pixels;
        outline.rasterizer.for_each_pixel(|index, coverage| {
            if coverage > 0.0
                && let Some(pixel) = pixels.get_mut(index)
            {
                let blend = |under: u8, over: u8| {
                    let value = f32::from(under) + (f32::from(over) - f32::from(under)) * coverage.min(1.0);
                    value.round() as u8
                };
                *pixel = [0, 1, 2].map(|channel| blend(pixel[channel], color[channel]));
            }
        });
    }
}

/// The outline of glyphs, y up in the units of the font, on its way to the rasterizer.
struct Outline {
    rasterizer: Rasterizer,
    scale: f32,
    left: f32,
    baseline: f32,
    first: Point,
    last: Point,
}

impl Outline {
    fn place(&self, x: f32, y: f32) -> Point {
        point(self.left + x * self.scale, self.baseline - y * self.scale)
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.first = self.place(x, y);
        self.last = self.first;
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.place(x, y);
        self.rasterizer.draw_line(self.last, to);
        self.last = to;
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (control, to) = (self.place(x1, y1), self.place(x, y));
        self.rasterizer.draw_quad(self.last, control, to);
        self.last = to;
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (first, second, to) = (self.place(x1, y1), self.place(x2, y2), self.place(x, y));
        self.rasterizer.draw_cubic(self.last, first, second, to);
        self.last = to;
    }

    fn close(&mut self) {
        self.rasterizer.draw_line(self.last, self.first);
        self.last = self.first;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_covers_about_its_width_and_nothing_else() {
        let font = Font::new().unwrap();
        let mut canvas = Canvas::new(120, 40);
        canvas.put((110, 35), 20, &[[0; 3]; 400]);
        canvas.text(&font, "Key 45\u{b0}", 20.0, (10.0, 30.0), [0; 3]);
        let dark = |columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
            let pixels = rows.flat_map(|y| columns.clone().map(move |x| y * 120 + x));
            pixels.filter(|index| canvas.pixels[*index][0] < 128).count()
        };
        let width = font.width("Key 45\u{b0}", 20.0) as usize;
        assert!((80..600).contains(&dark(10..10 + width, 10..36)), "{}", dark(10..10 + width, 10..36));
        assert_eq!((dark(0..10, 0..40), dark(12 + width..110, 0..40)), (0, 0));
        assert_eq!(dark(110..120, 35..40), 50, "a picture is cut off at the edge");
        canvas.text(&font, "beyond the edge of the canvas", 20.0, (100.0, 500.0), [0; 3]);
    }
}
