//! A vector drawing in millimetres, to be written as SVG or PDF.

use glam::Vec2;

/// An sRGB colour.
pub type Rgb = [u8; 3];

/// A line around or along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: Rgb,
    /// Width, millimetres.
    pub width_mm: f32,
    /// Length of dashes and gaps, millimetres; none for a whole line.
    pub dash_mm: Option<f32>,
}

impl Stroke {
    /// Returns a whole line.
    pub fn new(color: Rgb, width_mm: f32) -> Self {
        Stroke { color, width_mm, dash_mm: None }
    }

    /// Returns a dashed line.
    pub fn dashed(color: Rgb, width_mm: f32) -> Self {
        Stroke { color, width_mm, dash_mm: Some(1.2) }
    }
}

/// The place of the given point in a line of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// At its beginning.
    Left,
    /// In its middle.
    Center,
    /// At its end.
    Right,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// A point of the baseline.
    pub at: Vec2,
    /// The characters.
    pub text: String,
    /// Height of the font, millimetres.
    pub size_mm: f32,
    /// Colour.
    pub color: Rgb,
    /// The place of `at` in the text.
    pub align: Align,
    /// Drawn with heavier lines.
    pub strong: bool,
}

/// A part of a drawing. Points are in millimetres from the top left, y down; later elements cover earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Element {
    /// Lines through points.
    Path {
        /// The points of each closed outline or open line.
        lines: Vec<Vec<Vec2>>,
        /// The last point is joined to the first.
        closed: bool,
        /// Colour of the inside, by the even-odd rule.
        fill: Option<Rgb>,
        /// The line.
        stroke: Option<Stroke>,
    },
    /// A line of text.
    Text(Text),
    /// The sheet's picture, over a rectangle.
    Picture {
        /// Top left corner.
        at: Vec2,
        /// Width and height.
        size: Vec2,
    },
    /// Elements that are seen within a rectangle.
    Clipped {
        /// Top left corner.
        at: Vec2,
        /// Width and height.
        size: Vec2,
        /// The elements.
        elements: Vec<Element>,
    },
}

impl Element {
    /// Returns an open line through points.
    pub fn line(points: impl Into<Vec<Vec2>>, stroke: Stroke) -> Self {
        Element::Path { lines: vec![points.into()], closed: false, fill: None, stroke: Some(stroke) }
    }

    /// Returns a polygon.
    pub fn polygon(points: impl Into<Vec<Vec2>>, fill: Option<Rgb>, stroke: Option<Stroke>) -> Self {
        Element::Path { lines: vec![points.into()], closed: true, fill, stroke }
    }

    /// Returns a rectangle by its top left corner and its size.
    pub fn rect(at: Vec2, size: Vec2, fill: Option<Rgb>, stroke: Option<Stroke>) -> Self {
        let corners = [at, at + Vec2::X * size.x, at + size, at + Vec2::Y * size.y];
        Element::polygon(corners, fill, stroke)
    }

    /// Returns a circle.
    pub fn circle(middle: Vec2, radius: f32, fill: Option<Rgb>, stroke: Option<Stroke>) -> Self {
        const SIDES: u32 = 32;
        let point = |side| middle + radius * Vec2::from_angle(std::f32::consts::TAU * side as f32 / SIDES as f32);
        Element::polygon((0..SIDES).map(point).collect::<Vec<_>>(), fill, stroke)
    }

    /// Returns plain black text from a point of its baseline to the right.
    pub fn text(at: Vec2, text: impl Into<String>, size_mm: f32) -> Text {
        Text { at, text: text.into(), size_mm, color: [20; 3], align: Align::Left, strong: false }
    }
}

impl Text {
    /// Returns the text in a colour.
    pub fn colored(self, color: Rgb) -> Self {
        Text { color, ..self }
    }

    /// Returns the text with another alignment.
    pub fn aligned(self, align: Align) -> Self {
        Text { align, ..self }
    }

    /// Returns the text in heavier lines.
    pub fn strong(self) -> Self {
        Text { strong: true, ..self }
    }
}

impl From<Text> for Element {
    fn from(text: Text) -> Self {
        Element::Text(text)
    }
}

/// A drawing of a width and height in millimetres.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width and height, millimetres.
    pub size_mm: Vec2,
    /// The elements.
    pub elements: Vec<Element>,
}
