//! Places for labels in a view: inside its frame, off people, numbers and each other, and off lines where there is room.

use glam::Vec2;

/// A rectangle by its top left and its bottom right corner, millimetres.
pub type PageRect = [Vec2; 2];

/// Whether a label may overlap something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Overlap {
    /// Never: people, the subject, numbers, other labels.
    Never,
    /// If there is no other position near: lights and small props.
    Reluctant,
    /// Rather than going far away: lines.
    Line,
}

/// The light that a mark belongs to, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// Its head and modifier.
    Body(usize),
    /// The lines to the subject and to its aim.
    Sight(usize),
}

/// A position for a label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelPosition {
    /// Middle of the label, millimetres.
    pub middle: Vec2,
    /// Cost, millimetres of way to its thing.
    pub cost: f32,
    /// The line from the label to its thing.
    pub leader: Option<[Vec2; 2]>,
}

/// A thing in a view that labels keep off.
#[derive(Clone, Debug)]
struct Mark {
    outlines: Vec<Vec<Vec2>>,
    closed: bool,
    overlap: Overlap,
    owner: Option<Owner>,
    /// A label or its leader.
    is_label: bool,
}

/// The labels and marks of a view so far.
#[derive(Clone, Debug)]
pub struct LabelLayout {
    frame: PageRect,
    marks: Vec<Mark>,
}

/// Returns the rectangle of a size around its middle.
pub fn area_around(middle: Vec2, size: Vec2) -> PageRect {
    [middle - 0.5 * size, middle + 0.5 * size]
}

/// Returns the corners of a rectangle, in order.
pub fn corners([low, high]: PageRect) -> Vec<Vec2> {
    vec![low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)]
}

impl Overlap {
    /// Returns the extra cost of a label that overlaps it, millimetres of way to its thing.
    fn cost(self) -> f32 {
        match self {
            Overlap::Never => f32::INFINITY,
            Overlap::Reluctant => 9.0,
            Overlap::Line => 3.0,
        }
    }
}

impl LabelPosition {
    /// Returns a position without a leader.
    pub fn new(middle: Vec2, cost: f32) -> Self {
        LabelPosition { middle, cost, leader: None }
    }
}

impl Mark {
    /// Returns the extra cost of a label in an area with a leader.
    fn cost_of(&self, area: PageRect, leader: Option<[Vec2; 2]>) -> f32 {
        let covered = if self.meets(area) { self.overlap.cost() } else { 0.0 };
        let is_crossed = leader.is_some_and(|leader| self.is_label && self.crosses(leader));
        covered + if is_crossed { Overlap::Reluctant.cost() } else { 0.0 }
    }

    fn crosses(&self, [from, to]: [Vec2; 2]) -> bool {
        self.edges().any(|(a, b)| {
            let sides = |a: Vec2, b: Vec2, c: Vec2, d: Vec2| (b - a).perp_dot(c - a) * (b - a).perp_dot(d - a) < 0.0;
            sides(from, to, a, b) && sides(a, b, from, to)
        })
    }

    fn edges(&self) -> impl Iterator<Item = (Vec2, Vec2)> {
        self.outlines.iter().flat_map(|outline| {
            let next = outline.iter().cycle().skip(1);
            let edges = outline.len() - usize::from(!self.closed && !outline.is_empty());
            outline.iter().copied().zip(next.copied()).take(edges)
        })
    }

    fn meets(&self, area: PageRect) -> bool {
        self.edges().any(|(a, b)| segment_meets(area, a, b))
            || (self.closed && contains(&self.outlines, 0.5 * (area[0] + area[1])))
    }
}

/// Returns true if a line from `a` to `b` passes through a rectangle (Liang and Barsky 1984).
pub fn segment_meets([low, high]: PageRect, a: Vec2, b: Vec2) -> bool {
    let way = b - a;
    let (mut first, mut last) = (0.0_f32, 1.0_f32);
    for axis in 0..2 {
        if way[axis].abs() < 1e-6 {
            if a[axis] < low[axis] || a[axis] > high[axis] {
                return false;
            }
            continue;
        }
        let ends = [low, high].map(|corner| (corner[axis] - a[axis]) / way[axis]);
        (first, last) = (first.max(ends[0].min(ends[1])), last.min(ends[0].max(ends[1])));
    }
    first <= last
}

/// Returns true if a point is within outlines, by the even-odd rule.
pub fn contains(outlines: &[Vec<Vec2>], point: Vec2) -> bool {
    let mut inside = false;
    for outline in outlines {
        for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
            let crosses = (a.y > point.y) != (b.y > point.y);
            inside ^= crosses && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x);
        }
    }
    inside
}

impl LabelLayout {
    /// Returns the empty positions of a view with a frame.
    pub fn new(frame: PageRect) -> Self {
        LabelLayout { frame, marks: Vec::new() }
    }

    /// Adds closed outlines that labels keep off.
    pub fn add(&mut self, outlines: Vec<Vec<Vec2>>, overlap: Overlap, owner: Option<Owner>) {
        self.marks.push(Mark { outlines, closed: true, overlap, owner, is_label: false });
    }

    /// Adds a line that labels should not cross.
    pub fn add_line(&mut self, line: Vec<Vec2>, owner: Option<Owner>) {
        self.marks.push(Mark { outlines: vec![line], closed: false, overlap: Overlap::Line, owner, is_label: false });
    }

    /// Returns the cheapest of the positions for a label of a size, and keeps it with its leader from then on. Marks of
    /// `own` do not count. None if all positions leave the frame or cover what is never covered, or if the cost is above
    /// `most`.
    pub fn take(
        &mut self,
        size: Vec2,
        positions: &[LabelPosition],
        own: Option<Owner>,
        most: f32,
    ) -> Option<LabelPosition> {
        let mut best: Option<(LabelPosition, f32)> = None;
        for position in positions {
            let area = area_around(position.middle, size);
            // NaN is outside
            if !(area[0].cmpge(self.frame[0]).all() && area[1].cmple(self.frame[1]).all()) {
                continue;
            }
            let limit = best.map_or(most, |(_, least)| least);
            let marks = self.marks.iter().filter(|mark| mark.owner.is_none() || mark.owner != own);
            let cost = marks.fold(position.cost, |cost, mark| cost + mark.cost_of(area, position.leader));
            if cost < limit {
                best = Some((*position, cost));
            }
        }
        let (position, _) = best?;
        let label = corners(area_around(position.middle, size));
        let mark = Mark { outlines: vec![label], closed: true, overlap: Overlap::Never, owner: None, is_label: true };
        let leader = position.leader.map(|line| Mark {
            outlines: vec![line.to_vec()],
            closed: false,
            overlap: Overlap::Line,
            ..mark.clone()
        });
        self.marks.extend([Some(mark), leader].into_iter().flatten());
        Some(position)
    }
}

/// Returns positions for a label of a size around a rectangle, with their costs: below it first, then above, beside and at
/// its corners, close by first.
pub fn positions_around([low, high]: PageRect, size: Vec2) -> Vec<LabelPosition> {
    const SIDES: [(f32, f32, f32); 8] = [
        (0.0, 1.0, 0.0),
        (0.0, -1.0, 0.4),
        (1.0, 0.0, 0.6),
        (-1.0, 0.0, 0.6),
        (1.0, 1.0, 1.0),
        (-1.0, 1.0, 1.0),
        (1.0, -1.0, 1.2),
        (-1.0, -1.0, 1.2),
    ];
    let middle = 0.5 * (low + high);
    let gaps = [0.2, 1.5, 3.0, 5.0, 8.0, 11.0, 15.0, 20.0, 26.0];
    let positions = gaps.into_iter().flat_map(|gap| {
        SIDES.map(|(x, y, cost)| {
            let side = Vec2::new(x, y);
            LabelPosition::new(middle + side * (0.5 * (high - low) + 0.5 * size + gap), gap + cost)
        })
    });
    positions.collect()
}

/// Returns the point of a rectangle that is nearest to a point.
pub fn nearest_in([low, high]: PageRect, point: Vec2) -> Vec2 {
    point.clamp(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stay_in_the_frame_off_people_and_off_each_other() {
        let mut layout = LabelLayout::new([Vec2::ZERO, Vec2::new(40.0, 40.0)]);
        let person = [Vec2::new(10.0, 30.0), Vec2::new(30.0, 38.0)];
        layout.add(vec![corners(person)], Overlap::Never, None);
        let size = Vec2::new(12.0, 3.0);
        let found: Vec<Vec2> = (0..4)
            .filter_map(|_| layout.take(size, &positions_around(person, size), None, f32::INFINITY))
            .map(|position| position.middle)
            .collect();
        // There is no room below
        assert_eq!(found.len(), 4);
        assert!(found[0].y < 30.0, "{found:?}");
        let areas: Vec<PageRect> = found.iter().map(|middle| area_around(*middle, size)).chain([person]).collect();
        for (index, a) in areas.iter().enumerate() {
            assert!(a[0].cmpge(Vec2::ZERO).all() && a[1].cmple(Vec2::splat(40.0)).all());
            assert!(areas[..index].iter().all(|b| a[0].cmpge(b[1]).any() || b[0].cmpge(a[1]).any()), "{areas:?}");
        }
    }

    #[test]
    fn a_label_crosses_a_line_only_if_all_else_is_far_or_the_line_is_its_own() {
        let frame = [Vec2::ZERO, Vec2::splat(40.0)];
        let positions = |own| {
            let mut layout = LabelLayout::new(frame);
            layout.add_line(vec![Vec2::new(0.0, 20.0), Vec2::new(40.0, 20.0)], Some(Owner::Sight(1)));
            let ways = [LabelPosition::new(Vec2::splat(20.0), 0.0), LabelPosition::new(Vec2::new(20.0, 30.0), 2.0)];
            layout.take(Vec2::splat(3.0), &ways, own, 99.0).map(|position| position.middle)
        };
        assert_eq!(positions(None), Some(Vec2::new(20.0, 30.0)));
        assert_eq!(positions(Some(Owner::Body(1))), Some(Vec2::new(20.0, 30.0)));
        assert_eq!(positions(Some(Owner::Sight(1))), Some(Vec2::splat(20.0)));
        let mut full = LabelLayout::new(frame);
        full.add(vec![corners(frame)], Overlap::Never, None);
        assert_eq!(full.take(Vec2::ONE, &[LabelPosition::new(Vec2::splat(20.0), 0.0)], None, f32::INFINITY), None);
        assert_eq!(full.take(Vec2::ONE, &[LabelPosition::new(Vec2::NAN, 0.0)], None, f32::INFINITY), None);
    }

    #[test]
    fn leaders_do_not_cross_each_other() {
        let mut layout = LabelLayout::new([Vec2::ZERO, Vec2::splat(40.0)]);
        let position = |x: f32, to: f32, cost| LabelPosition {
            leader: Some([Vec2::new(x, 11.0), Vec2::new(to, 20.0)]),
            ..LabelPosition::new(Vec2::new(x, 10.0), cost)
        };
        let mut take =
            |ways: &[LabelPosition]| layout.take(Vec2::splat(2.0), ways, None, 99.0).map(|position| position.middle.x);
        assert_eq!(take(&[position(10.0, 20.0, 0.0)]), Some(10.0));
        assert_eq!(take(&[position(20.0, 10.0, 0.0), position(5.0, 10.0, 3.0)]), Some(5.0));
    }
}
