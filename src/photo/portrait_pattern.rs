//! Portrait lighting patterns, by the shadows that the key light alone casts on a face.
//!
//! The definitions are the usual ones of portrait lighting (Hunter, Biver and Fuqua, *Light: Science and Magic*,
//! chapter on portraits). Split: one half of the face is dark. Rembrandt: the nose's shadow joins that of the cheek,
//! and a lit triangle is left on the cheek below the eye. Loop: the nose's shadow lies on the shadow side and is clear of
//! the cheek's. Butterfly: the nose's shadow lies straight below the nose. Flat: the nose casts no shadow.
//!
//! Lengths on the face are measured in nose lengths: the height of the eyes above the tip of the nose, 30 to 45 mm.

use std::collections::HashSet;

/// A portrait lighting pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortraitPattern {
    /// One half of the face is dark.
    Split,
    /// A triangle of light on the dark cheek.
    Rembrandt,
    /// A shadow of the nose beside it, clear of the cheek's.
    Loop,
    /// A shadow straight below the nose.
    Butterfly,
    /// No shadow of the nose.
    Flat,
}

impl PortraitPattern {
    /// Returns its label.
    pub fn label(self) -> &'static str {
        match self {
            PortraitPattern::Split => "split",
            PortraitPattern::Rembrandt => "Rembrandt",
            PortraitPattern::Loop => "loop",
            PortraitPattern::Butterfly => "butterfly",
            PortraitPattern::Flat => "flat",
        }
    }

    /// Returns true if one side of the face is in shadow, so that its lighting is short or broad.
    pub fn has_shadow_side(self) -> bool {
        matches!(self, PortraitPattern::Split | PortraitPattern::Rembrandt | PortraitPattern::Loop)
    }
}

/// A side of a face: the person's own left or right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceSide {
    /// The person's own left.
    Left,
    /// The person's own right.
    Right,
}

impl FaceSide {
    /// Returns the side of a coordinate that grows to the person's left.
    pub fn of(across: f32) -> Self {
        if across >= 0.0 { FaceSide::Left } else { FaceSide::Right }
    }

    fn sign(self) -> f32 {
        match self {
            FaceSide::Left => 1.0,
            FaceSide::Right => -1.0,
        }
    }
}

/// The key light on a cell of skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinLight {
    /// Illuminance, in any unit.
    pub arriving: f32,
    /// Illuminance without anything between light and skin, in the same unit.
    pub unshadowed: f32,
}

/// The key light on a face, in cells as seen from straight before it.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceMap {
    /// Number of columns. Column 0 is at the person's right; the middle between both eyes is the middle of the columns.
    pub columns: usize,
    /// Height of the first row's middle above the eyes, metres; rows go down.
    pub top_m: f32,
    /// Edge of a cell, metres.
    pub cell_m: f32,
    /// The cells, row by row; none where no skin is seen.
    pub cells: Vec<Option<SkinLight>>,
    /// Angle of the key above the direction of the face, degrees.
    pub key_above_deg: f32,
    /// Places of the features, by which the regions of the face are found.
    pub features: FaceFeatures,
}

/// Places of a face's features below the middle of the eyes, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceFeatures {
    /// Depth of the tip of the nose below the eyes: the nose length.
    pub nose_tip_m: f32,
    /// Depth of the upper edge of the lips.
    pub lips_top_m: f32,
    /// Depth of the lower edge of the lips.
    pub lips_bottom_m: f32,
}

/// A pattern with the side that is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FoundPattern {
    /// The pattern.
    pub pattern: PortraitPattern,
    /// The lit side; none where both are.
    pub lit_side: Option<FaceSide>,
}

/// Illuminance below which skin is dark whatever hides the light, relative to the bright skin of the face.
const DARK: f32 = 0.1;
/// Part of the emitter that is visible at the edge of a cast shadow: the middle of the penumbra.
const SHADOW_EDGE: f32 = 0.5;
/// Part of the cells that are darker than what counts as bright skin: some cells face the light by chance.
const BRIGHT_QUANTILE: f32 = 0.95;
/// Least part of the dark half of a face that is dark in split lighting.
const SPLIT_DARK: f32 = 0.9;
/// Least part of the other cheek that is lit: a light from behind lights its outer edge alone.
const SPLIT_LIT: f32 = 0.75;
/// Smallest area of the nose's shadow, and of a lit triangle, square nose lengths: some 0.4 square centimetres.
const SMALLEST_SHADOW: f32 = 0.03;
/// Largest distance of the middle of a butterfly's shadow from the middle of the face, nose lengths. A key about 10
/// degrees beside the face's direction makes it, half of the least angle of loop lighting.
const BUTTERFLY_OFFSET: f32 = 0.06;
/// Lowest angle of a key above the direction of the face, degrees: the patterns are those of light from the height of
/// the face or above.
const LOWEST_KEY_DEG: f32 = -20.0;
/// Part of a face that may be dark in flat lighting.
const FLAT_DARK: f32 = 0.1;
/// Least part of the cheek beside the nose that is lit in loop lighting.
const LOOP_LIT: f32 = 0.5;

/// Finds the pattern of the shadows; none where they are none of the patterns.
pub fn find_pattern(face: &FaceMap) -> Option<FoundPattern> {
    let shades = Shades::new(face).filter(|_| face.key_above_deg >= LOWEST_KEY_DEG)?;
    let lit_side = shades.brighter_side();
    let shadow_side = FaceSide::of(-lit_side.sign());
    let of_side = |pattern| Some(FoundPattern { pattern, lit_side: Some(lit_side) });
    let of_both = |pattern| Some(FoundPattern { pattern, lit_side: None });

    let nose = shades.nose_shadow();
    let has_nose_shadow = shades.area(nose.len()) >= SMALLEST_SHADOW;
    if has_nose_shadow && shades.joins_cheek(&nose, shadow_side) && shades.has_enclosed_triangle(shadow_side) {
        return of_side(PortraitPattern::Rembrandt);
    }
    if shades.dark_part(shadow_side) >= SPLIT_DARK && shades.cheek_lit_part(lit_side) >= SPLIT_LIT {
        return of_side(PortraitPattern::Split);
    }
    if !has_nose_shadow {
        let is_lit = [FaceSide::Left, FaceSide::Right].iter().all(|&side| shades.dark_part(side) <= FLAT_DARK);
        return if is_lit { of_both(PortraitPattern::Flat) } else { None };
    }
    if shades.joins_cheek(&nose, shadow_side) || shades.cheek_lit_part(shadow_side) < LOOP_LIT {
        return None;
    }
    let offset = shades.mean_across(&nose);
    if offset.abs() <= BUTTERFLY_OFFSET {
        of_both(PortraitPattern::Butterfly)
    } else {
        (offset * shadow_side.sign() > 0.0)
            .then_some(FoundPattern { pattern: PortraitPattern::Loop, lit_side: Some(lit_side) })
    }
}

/// Light or shadow on a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shade {
    /// Lit.
    Lit,
    /// In a shadow that something casts.
    Cast,
    /// Turned away from the light.
    Turned,
}

/// The shades of a face's cells, in nose lengths.
struct Shades<'a> {
    face: &'a FaceMap,
    shades: Vec<Option<Shade>>,
}

impl<'a> Shades<'a> {
    /// Shades the cells. None without light or with features that are not in order.
    fn new(face: &'a FaceMap) -> Option<Self> {
        let FaceFeatures { nose_tip_m, lips_top_m, lips_bottom_m } = face.features;
        if !(0.0 < nose_tip_m && nose_tip_m < lips_top_m && lips_top_m < lips_bottom_m) {
            return None;
        }
        let mut values: Vec<f32> = face.cells.iter().flatten().map(|cell| cell.arriving).collect();
        values.sort_by(f32::total_cmp);
        let bright = *values.get((values.len() as f32 * BRIGHT_QUANTILE) as usize)?;
        let shade = |cell: &SkinLight| {
            if cell.unshadowed <= DARK * bright {
                Shade::Turned
            } else if cell.arriving < SHADOW_EDGE * cell.unshadowed {
                Shade::Cast
            } else if cell.arriving <= DARK * bright {
                Shade::Turned
            } else {
                Shade::Lit
            }
        };
        let shades = face.cells.iter().map(|cell| cell.as_ref().map(shade)).collect();
        (bright > 0.0).then_some(Shades { face, shades })
    }

    /// Returns the place of a cell in nose lengths: to the person's left, and down from the eyes.
    fn place(&self, cell: usize) -> (f32, f32) {
        let FaceMap { columns, top_m, cell_m, features, .. } = self.face;
        let across_m = ((cell % columns) as f32 + 0.5 - *columns as f32 / 2.0) * cell_m;
        let down_m = (cell / columns) as f32 * cell_m - top_m;
        (across_m / features.nose_tip_m, down_m / features.nose_tip_m)
    }

    /// Returns the cells with skin in a region, by place and shade.
    fn cells(&self, is_in: impl Fn(f32, f32, Shade) -> bool) -> Vec<usize> {
        let accepts = |cell: &usize| {
            let (across, down) = self.place(*cell);
            self.shades[*cell].is_some_and(|shade| is_in(across, down, shade))
        };
        (0..self.shades.len()).filter(accepts).collect()
    }

    /// Returns the area of so many cells, square nose lengths.
    fn area(&self, cells: usize) -> f32 {
        let edge = self.face.cell_m / self.face.features.nose_tip_m;
        cells as f32 * edge * edge
    }

    fn lips_top(&self) -> f32 {
        self.face.features.lips_top_m / self.face.features.nose_tip_m
    }

    fn lips_middle(&self) -> f32 {
        let features = &self.face.features;
        (features.lips_top_m + features.lips_bottom_m) / 2.0 / features.nose_tip_m
    }

    /// Returns the side of the face with more light.
    fn brighter_side(&self) -> FaceSide {
        let light = |cell: usize| self.face.cells[cell].map_or(0.0, |light| light.arriving);
        let sum: f32 = (0..self.shades.len()).map(|cell| light(cell) * self.place(cell).0.signum()).sum();
        FaceSide::of(sum)
    }

    /// Returns the part of a half of the face that is dark, from the brow to the mouth, beside the ridge of the nose.
    fn dark_part(&self, side: FaceSide) -> f32 {
        let end = self.lips_middle();
        let half = |x: f32, y: f32| x * side.sign() > 0.3 && (-0.6..=end).contains(&y);
        let all = self.cells(|x, y, _| half(x, y)).len();
        let dark = self.cells(|x, y, shade| half(x, y) && shade != Shade::Lit).len();
        dark as f32 / all.max(1) as f32
    }

    /// Returns the part of the cheek below the eye and beside the nose that is lit.
    fn cheek_lit_part(&self, side: FaceSide) -> f32 {
        let all = self.cells(|x, y, _| is_cheek(x, y, side)).len();
        let lit = self.cells(|x, y, shade| is_cheek(x, y, side) && shade == Shade::Lit).len();
        lit as f32 / all.max(1) as f32
    }

    /// Returns the cells of the shadow that the nose casts beside and below itself.
    fn nose_shadow(&self) -> Vec<usize> {
        let end = self.lips_top();
        self.cells(|x, y, shade| shade == Shade::Cast && x.abs() <= 0.7 && (0.5..=end).contains(&y))
    }

    /// Returns the mean place of cells to the person's left, nose lengths.
    fn mean_across(&self, cells: &[usize]) -> f32 {
        cells.iter().map(|&cell| self.place(cell).0).sum::<f32>() / cells.len().max(1) as f32
    }

    /// Returns true if a shadow reaches the outline of the face through dark cells between eye and mouth.
    fn joins_cheek(&self, shadow: &[usize], side: FaceSide) -> bool {
        let end = self.lips_middle();
        let is_way = |x: f32, y: f32| x * side.sign() > -0.1 && (0.3..=end).contains(&y);
        let dark: HashSet<usize> = self.cells(|x, y, shade| is_way(x, y) && shade != Shade::Lit).into_iter().collect();
        self.grow(shadow, &dark).iter().any(|&cell| self.is_outline(cell, side))
    }

    /// Returns true if a part of the cheek below the eye is lit that the face's outline does not cut.
    fn has_enclosed_triangle(&self, side: FaceSide) -> bool {
        let end = self.lips_middle();
        let is_way = |x: f32, y: f32| x * side.sign() > 0.25 && (0.3..=end).contains(&y);
        let lit: HashSet<usize> = self.cells(|x, y, shade| is_way(x, y) && shade == Shade::Lit).into_iter().collect();
        let mut triangle: Vec<usize> =
            lit.iter().copied().filter(|&cell| is_cheek(self.place(cell).0, self.place(cell).1, side)).collect();
        triangle.sort_unstable();
        let is_large = self.area(triangle.len()) >= SMALLEST_SHADOW;
        is_large && !self.grow(&triangle, &lit).iter().any(|&cell| self.is_outline(cell, side))
    }

    /// Returns true for the outermost cell of its row on a side.
    fn is_outline(&self, cell: usize, side: FaceSide) -> bool {
        let row = cell / self.face.columns;
        let mut outside = match side {
            FaceSide::Left => cell + 1..(row + 1) * self.face.columns,
            FaceSide::Right => row * self.face.columns..cell,
        };
        outside.all(|other| self.shades[other].is_none())
    }

    /// Returns the cells of `way` that are connected with `seeds` by edges of cells.
    fn grow(&self, seeds: &[usize], way: &HashSet<usize>) -> HashSet<usize> {
        let columns = self.face.columns;
        let mut reached = HashSet::new();
        let mut open: Vec<usize> = seeds.iter().copied().filter(|seed| way.contains(seed)).collect();
        while let Some(cell) = open.pop() {
            if !reached.insert(cell) {
                continue;
            }
            let left = (cell % columns > 0).then(|| cell - 1);
            let right = (cell % columns + 1 < columns).then_some(cell + 1);
            let neighbours = [left, right, cell.checked_sub(columns), Some(cell + columns)];
            open.extend(neighbours.into_iter().flatten().filter(|next| way.contains(next)));
        }
        reached
    }
}

/// Returns true on the cheek below the eye, beside the nose.
fn is_cheek(across: f32, down: f32, side: FaceSide) -> bool {
    (0.3..=1.4).contains(&(across * side.sign())) && (0.3..=1.0).contains(&down)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOSE_M: f32 = 0.045;

    /// Returns a face 140 mm wide whose cells are lit as `shade` says at places in nose lengths.
    fn face(shade: impl Fn(f32, f32) -> Shade) -> FaceMap {
        let (columns, rows, cell_m, top_m) = (56, 52, 0.0025, 0.04);
        let features = FaceFeatures { nose_tip_m: NOSE_M, lips_top_m: 0.064, lips_bottom_m: 0.083 };
        let cell = |index: usize| {
            let across = ((index % columns) as f32 + 0.5 - columns as f32 / 2.0) * cell_m / NOSE_M;
            let down = ((index / columns) as f32 * cell_m - top_m) / NOSE_M;
            // The outline is an ellipse.
            if (across / 1.5).powi(2) + ((down - 0.5) / 2.0).powi(2) > 1.0 {
                return None;
            }
            Some(match shade(across, down) {
                Shade::Lit => SkinLight { arriving: 900.0, unshadowed: 950.0 },
                Shade::Cast => SkinLight { arriving: 30.0, unshadowed: 600.0 },
                Shade::Turned => SkinLight { arriving: 0.0, unshadowed: 20.0 },
            })
        };
        let cells = (0..columns * rows).map(cell).collect();
        FaceMap { columns, top_m, cell_m, cells, key_above_deg: 30.0, features }
    }

    fn found(shade: impl Fn(f32, f32) -> Shade) -> Option<(PortraitPattern, Option<FaceSide>)> {
        find_pattern(&face(shade)).map(|found| (found.pattern, found.lit_side))
    }

    fn when(dark: bool, shade: Shade) -> Shade {
        if dark { shade } else { Shade::Lit }
    }

    /// A shadow from the nose to the person's right and down, of some length.
    fn nose_shadow(x: f32, y: f32, length: f32) -> bool {
        (-length..0.0).contains(&x) && (0.75..1.3).contains(&y)
    }

    #[test]
    fn a_dark_half_is_split_lighting() {
        let split = |x: f32, _| when(x < 0.1, Shade::Turned);
        assert_eq!(found(split), Some((PortraitPattern::Split, Some(FaceSide::Left))));
        assert_eq!(found(|x, y| split(-x, y)), Some((PortraitPattern::Split, Some(FaceSide::Right))));
        // A light from behind leaves the edge of the cheek lit alone.
        assert_eq!(found(|x, _| when(x < 0.7, Shade::Turned)), None);
    }

    #[test]
    fn a_lit_triangle_between_the_shadows_of_nose_and_cheek_is_rembrandt_lighting() {
        let shade = |x: f32, y: f32| {
            let cheek = x < -0.9;
            let joined = x < 0.0 && y > 0.75;
            if joined { Shade::Cast } else { when(cheek, Shade::Turned) }
        };
        assert_eq!(found(shade), Some((PortraitPattern::Rembrandt, Some(FaceSide::Left))));
        assert_eq!(found(|x, y| shade(-x, y)), Some((PortraitPattern::Rembrandt, Some(FaceSide::Right))));
        // The cheek is lit to its edge: the triangle is open, and the pattern has no name.
        assert_eq!(found(|x, y| when(x < 0.0 && y > 0.75, Shade::Cast)), None);
        // The triangle has gone, the forehead is lit.
        assert_eq!(found(|x, y| when(x < 0.0 && y > 0.0, Shade::Cast)), None);
    }

    #[test]
    fn a_shadow_beside_the_nose_that_is_clear_of_the_cheeks_is_loop_lighting() {
        let shade = |x: f32, y: f32| {
            if nose_shadow(x, y, 0.5) { Shade::Cast } else { when(x < -1.1, Shade::Turned) }
        };
        assert_eq!(found(shade), Some((PortraitPattern::Loop, Some(FaceSide::Left))));
        assert_eq!(found(|x, y| shade(-x, y)), Some((PortraitPattern::Loop, Some(FaceSide::Right))));
    }

    #[test]
    fn a_shadow_below_the_nose_is_butterfly_lighting_and_none_is_flat_lighting() {
        let below = |x: f32, y: f32| when(x.abs() < 0.35 && (1.1..1.4).contains(&y), Shade::Cast);
        assert_eq!(found(below), Some((PortraitPattern::Butterfly, None)));
        assert_eq!(found(|_, _| Shade::Lit), Some((PortraitPattern::Flat, None)));
        // A few cells are no shadow.
        let speck = |x: f32, y: f32| when(x.abs() < 0.05 && (1.1..1.2).contains(&y), Shade::Cast);
        assert_eq!(found(speck), Some((PortraitPattern::Flat, None)));
        // Dark brows and no shadow of the nose; light from below.
        assert_eq!(found(|_, y| when(y < -0.1, Shade::Turned)), None);
        assert_eq!(find_pattern(&FaceMap { key_above_deg: -45.0, ..face(|_, _| Shade::Lit) }), None);
    }

    #[test]
    fn a_face_without_light_or_features_has_no_pattern() {
        let mut dark = face(|_, _| Shade::Lit);
        dark.cells.iter_mut().flatten().for_each(|cell| cell.arriving = 0.0);
        assert_eq!(find_pattern(&dark), None);
        let mut odd = face(|_, _| Shade::Lit);
        odd.features.nose_tip_m = f32::NAN;
        assert_eq!(find_pattern(&odd), None);
        assert_eq!(find_pattern(&FaceMap { cells: Vec::new(), ..odd }), None);
    }
}
