//! Where a vertex of the base mesh lies on the body: which garments cover it.

use super::body_data::{BodyData, BoneWeights};
use crate::scene::{Bottom, Figure, Top};
use glam::Vec3;
use std::sync::LazyLock;

/// The place of a vertex on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// On trunk, neck or head; the height is 0 at the hips and 1 at the base of the neck.
    Trunk {
        /// Height.
        height: f32,
    },
    /// On an arm: 0 at the shoulder, 1 at the elbow, 2 at the wrist, more on the hand.
    Arm(f32),
    /// On a leg: 0 at the hip, 1 at the knee, 2 at the ankle, more on the foot.
    Leg(f32),
}

/// Returns the place of every vertex of the base mesh.
fn places(data: &BodyData) -> Vec<Place> {
    let bone = |name: &str| data.bone(name).map(|index| &data.bones[index]);
    let head = |name: &str| bone(name).map_or(Vec3::ZERO, |bone| data.positions[usize::from(bone.head)]);
    let limbs = ["L", "R"].map(|side| {
        let joints = |names: [&str; 3]| names.map(|stem| head(&format!("{stem}.{side}")));
        (joints(["upperarm01", "lowerarm01", "wrist"]), joints(["upperleg01", "lowerleg01", "foot"]))
    });
    let (hips, neck) = (head("pelvis.L"), head("neck01"));
    let span = neck.y - hips.y;
    let is_of =
        |bone: u8, stems: &[&str]| stems.iter().any(|stem| data.bones[usize::from(bone)].name.starts_with(stem));
    let share = |weights: &BoneWeights, stems: &[&str]| -> u32 {
        weights.iter().filter(|(bone, w)| *w > 0 && is_of(*bone, stems)).map(|(_, w)| u32::from(*w)).sum()
    };
    let place = |(position, weights): (&Vec3, &BoneWeights)| {
        let (arms, legs) = &limbs[usize::from(position.x < 0.0)];
        if share(weights, &["wrist", "metacarpal", "finger"]) > 127 {
            Place::Arm(2.0 + along(*position, arms[2], arms[2] + (arms[2] - arms[1]) * 0.5).max(0.02))
        } else if share(weights, &["upperarm", "lowerarm", "wrist", "metacarpal", "finger"]) > 110 {
            Place::Arm(along_limb(*position, arms))
        } else if share(weights, &["foot", "toe"]) > 127 {
            Place::Leg(2.0 + (0.02_f32).max((legs[2].y - position.y) / 0.1))
        } else if share(weights, &["upperleg", "lowerleg", "foot", "toe"]) > 127 {
            Place::Leg(along_limb(*position, legs))
        } else {
            Place::Trunk { height: (position.y - hips.y) / span }
        }
    };
    data.positions.iter().zip(&data.weights).map(place).collect()
}

/// Returns the position along two segments: 0 to 1 on the first, 1 to 2 on the second.
fn along_limb(p: Vec3, [a, b, c]: &[Vec3; 3]) -> f32 {
    let first = along(p, *a, *b);
    if first < 1.0 && (p - *b).dot(*c - *b) <= 0.0 { first } else { 1.0 + along(p, *b, *c).max(0.0) }
}

fn along(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    (p - a).dot(b - a) / (b - a).length_squared().max(1e-9)
}

/// Distance from a hold that the ends of trousers are counted as, metres: they lie on the shoes, which slow their fall.
const ON_SHOE_M: f32 = 0.01;
/// Distance from the neckline at which a garment hangs freely, metres.
const COLLAR_END_M: f32 = 0.06;

/// Distance of cuffs from the arm, and the distance from the end of a sleeve at which it is as wide as without, metres.
const CUFF_M: f32 = 0.004;
const CUFF_TAPER_M: f32 = 0.1;
/// Height over its hem to which a top that hangs spans hollows, metres.
const SPAN_M: f32 = 0.24;
/// Length at the lower edge of a top over which it is tucked into a skirt, and the depth of that edge below the skin,
/// metres: the skirt hugs the hips.
const TUCK_M: f32 = 0.045;
const TUCKED_IN_M: f32 = 0.015;
/// Distance of a skirt from its helper mesh, and the length of its waistband, at whose upper edge it is as far below that
/// mesh, metres.
const SKIRT_M: f32 = 0.006;
const WAISTBAND_M: f32 = 0.06;
/// Part of its distance from the body by which a top comes nearer where it lies on the shoulders.
const LIES_CLOSER: f32 = 0.7;

/// What a figure wears, besides shoes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clothes {
    /// Upper garment.
    pub top: Top,
    /// Lower garment.
    pub bottom: Bottom,
}

impl Clothes {
    /// Returns the clothes of a figure.
    pub fn new(figure: &Figure) -> Clothes {
        Clothes { top: figure.top, bottom: figure.bottom }
    }
}

/// The edges of garments, in the rest pose of the base mesh. A field is positive inside of a garment, about the distance
/// to its edge in metres.
#[derive(Clone, Debug)]
pub struct Edges {
    places: Vec<Place>,
    positions: Vec<Vec3>,
    /// Knee and ankle, and elbow and wrist, left and right.
    shins: [[Vec3; 2]; 2],
    forearms: [[Vec3; 2]; 2],
    /// Middle of the neck's base.
    neck: Vec3,
    knee_height: f32,
    hip_height: f32,
    /// Height of a skirt's upper edge.
    waist_height: f32,
}

impl Edges {
    /// Returns the edges on the shipped body.
    pub fn shipped() -> &'static Edges {
        static SHIPPED: LazyLock<Edges> = LazyLock::new(|| Edges::new(BodyData::shipped()));
        &SHIPPED
    }

    /// Returns the edges on a body.
    fn new(data: &BodyData) -> Edges {
        let head = |name: &str| data.bone(name).map_or(Vec3::ZERO, |b| data.positions[usize::from(data.bones[b].head)]);
        let joints = |names: [&str; 2]| ["L", "R"].map(|side| names.map(|stem| head(&format!("{stem}.{side}"))));
        Edges {
            places: places(data),
            shins: joints(["lowerleg01", "foot"]),
            forearms: joints(["lowerarm01", "wrist"]),
            positions: data.positions.clone(),
            neck: head("neck01"),
            knee_height: head("lowerleg01.L").y,
            hip_height: head("pelvis.L").y,
            waist_height: data
                .quads("helper-skirt")
                .iter()
                .flatten()
                .map(|&v| data.positions[usize::from(v)].y)
                .fold(f32::NEG_INFINITY, f32::max),
        }
    }

    /// Returns the place of a vertex on the body.
    pub fn place(&self, vertex: u16) -> Place {
        self.places[usize::from(vertex)]
    }

    /// Returns the position along an arm or a leg, as in [`Place`], but without a step between a limb and its hand or
    /// foot: lines of equal values lie in planes there.
    fn along(&self, vertex: u16, at: f32, bones: &[[Vec3; 2]; 2]) -> f32 {
        let position = self.positions[usize::from(vertex)];
        let [from, to] = bones[usize::from(position.x < 0.0)];
        if at > 1.5 { 1.0 + along(position, from, to) } else { at }
    }

    /// Returns the distance from the end of a sleeve, metres, for a place on an arm.
    fn to_sleeve_end(&self, vertex: u16, at: f32, top: Top) -> f32 {
        let end = match top {
            Top::LongSleeves => 1.93,
            Top::ShortSleeves => 0.56,
            Top::Straps => 0.02,
        };
        (end - self.along(vertex, at, &self.forearms)) * 0.27
    }

    /// Returns the field of an upper garment.
    pub fn top(&self, vertex: u16, clothes: Clothes) -> f32 {
        match self.place(vertex) {
            Place::Arm(at) => self.to_sleeve_end(vertex, at, clothes.top),
            Place::Leg(_) => self.to_hem(vertex, clothes.bottom),
            // Neck and head lie over every garment.
            Place::Trunk { height } => self
                .to_neckline(vertex, clothes.top)
                .min((1.04 - height) * 0.5)
                .min(self.to_hem(vertex, clothes.bottom)),
        }
    }

    /// Returns the height over the lower edge of an upper garment, which hangs over trousers and is tucked into a skirt.
    fn to_hem(&self, vertex: u16, bottom: Bottom) -> f32 {
        let hem_height = match bottom {
            Bottom::Trousers | Bottom::Shorts => self.hip_height - 0.05,
            Bottom::Skirt => self.waist_height - 0.08,
        };
        self.positions[usize::from(vertex)].y - hem_height
    }

    /// Returns how much an upper garment spans the hollows of the body: 1 near a hem that hangs, 0 from
    /// 24 cm above it on.
    pub fn spans_hollows(&self, vertex: u16, clothes: Clothes) -> f32 {
        let is_arm = matches!(self.place(vertex), Place::Arm(_));
        if is_arm || clothes.bottom.hangs_from_waist() {
            return 0.0;
        }
        (2.0 - 2.0 * self.to_hem(vertex, clothes.bottom) / SPAN_M).clamp(0.0, 1.0)
    }

    /// Returns true where the nearest edge of an upper garment is one that is tucked into a skirt.
    pub fn is_tucked_in(&self, vertex: u16, clothes: Clothes) -> bool {
        let is_arm = matches!(self.place(vertex), Place::Arm(_));
        let is_by_hem = self.to_hem(vertex, clothes.bottom) < self.to_neckline(vertex, clothes.top);
        clothes.bottom.hangs_from_waist() && !is_arm && is_by_hem
    }

    /// Returns the distance from the opening for the neck: a ball round its base, lower in front for straps.
    fn to_neckline(&self, vertex: u16, top: Top) -> f32 {
        let (centre, radius) = match top {
            Top::LongSleeves | Top::ShortSleeves => (Vec3::new(0.0, 0.022, 0.0), 0.09),
            Top::Straps => (Vec3::new(0.0, 0.0, 0.05), 0.125),
        };
        self.positions[usize::from(vertex)].distance(self.neck + centre) - radius
    }

    /// Returns the field of a lower garment.
    pub fn bottom(&self, vertex: u16, bottom: Bottom) -> f32 {
        let end = match bottom {
            Bottom::Trousers => 1.95,
            Bottom::Shorts => 0.75,
            Bottom::Skirt => return self.positions[usize::from(vertex)].y - self.knee_height - 0.03,
        };
        match self.place(vertex) {
            Place::Arm(_) => -0.05,
            Place::Leg(at) => (end - self.along(vertex, at, &self.shins)) * 0.42,
            Place::Trunk { height } => (0.16 - height) * 0.5,
        }
    }

    /// Returns the field of the skin below a lower garment: a skirt covers thighs, but does not touch them.
    pub fn below_bottom(&self, vertex: u16, bottom: Bottom) -> f32 {
        match (bottom, self.place(vertex)) {
            (Bottom::Skirt, Place::Leg(at)) => (0.55 - at) * 0.42,
            (Bottom::Skirt, _) => self.bottom(vertex, Bottom::Shorts),
            _ => self.bottom(vertex, bottom),
        }
    }

    /// Returns the field of a shoe.
    pub fn shoe(&self, vertex: u16) -> f32 {
        match self.place(vertex) {
            Place::Leg(at) => (at - 2.0) * 0.1,
            _ => -0.05,
        }
    }

    /// Returns the distance from the nearest edge of an upper garment that lies close: collar and straps.
    fn to_close_edge(&self, vertex: u16, top: Top) -> f32 {
        match self.place(vertex) {
            Place::Arm(at) if top == Top::Straps => {
                self.to_sleeve_end(vertex, at, top).min(self.to_neckline(vertex, top))
            }
            _ => self.to_neckline(vertex, top),
        }
    }

    /// Returns 1 where an edge of an upper garment lies close, falling to 0 within 6 cm of it.
    pub fn nearness_to_close_edge(&self, vertex: u16, top: Top) -> f32 {
        1.0 - (self.to_close_edge(vertex, top) / COLLAR_END_M).clamp(0.0, 1.0)
    }

    /// Returns true for skin on which such an edge may lie.
    pub fn is_near_close_edge(&self, vertex: u16, top: Top) -> bool {
        self.to_close_edge(vertex, top).abs() < 2.0 * COLLAR_END_M
    }

    /// Returns the distance of a vertex of a garment from where it is held, metres: at collar, straps and cuffs, by the
    /// waistband below the upper garment. Trousers rest on shoes. Shoes are held everywhere.
    pub fn to_hold(&self, vertex: u16, garment: Garment, Clothes { top, bottom }: Clothes) -> f32 {
        match (garment, self.place(vertex)) {
            (Garment::Shoe, _) => 0.0,
            (Garment::Top, Place::Arm(at)) if top != Top::ShortSleeves => self.to_sleeve_end(vertex, at, top),
            (Garment::Top, _) if bottom.hangs_from_waist() => {
                self.to_neckline(vertex, top).min(self.to_hem(vertex, bottom))
            }
            (Garment::Top, _) => self.to_neckline(vertex, top),
            (Garment::Bottom, Place::Leg(_)) if bottom == Bottom::Trousers => {
                (self.bottom(vertex, bottom).max(0.0) + ON_SHOE_M).min(-self.to_hem(vertex, bottom))
            }
            (Garment::Bottom, _) => -self.to_hem(vertex, bottom),
        }
    }

    /// Returns the part of its distance from the body by which a garment comes nearer where it faces up.
    pub fn lies_closer(&self, vertex: u16, garment: Garment) -> f32 {
        match (garment, self.place(vertex)) {
            (Garment::Top, Place::Arm(at)) => LIES_CLOSER * (1.0 - at).clamp(0.0, 1.0),
            (Garment::Top, Place::Trunk { height }) => LIES_CLOSER * ((height - 0.6) / 0.2).clamp(0.0, 1.0),
            _ => 0.0,
        }
    }

    /// Returns how far a garment stands off from the body, metres; negative where it is below another one.
    pub fn looseness(&self, vertex: u16, garment: Garment, Clothes { top, bottom }: Clothes) -> f32 {
        let from_edge = 1.0 - self.nearness_to_close_edge(vertex, top);
        // A top that is tucked in comes closer from the edge of the skirt on
        let tuck = if bottom.hangs_from_waist() { (self.to_hem(vertex, bottom) / TUCK_M).clamp(0.0, 1.0) } else { 1.0 };
        let tucked = |loose_m: f32| loose_m * tuck - TUCKED_IN_M * (1.0 - tuck);
        match (garment, self.place(vertex)) {
            (Garment::Shoe, _) => 0.003,
            (Garment::Top, Place::Arm(at)) => {
                let loose = 0.006 + 0.006 * at.min(1.0);
                // Cuffs of long sleeves are close
                let from_cuff =
                    if top == Top::LongSleeves { self.to_sleeve_end(vertex, at, top) } else { CUFF_TAPER_M };
                CUFF_M + (loose - CUFF_M) * (from_cuff / CUFF_TAPER_M).clamp(0.0, 1.0)
            }
            // Over the trousers
            (Garment::Top, Place::Trunk { height }) => {
                tucked(0.001 + 0.006 * from_edge + 0.022 * (0.6 - height).clamp(0.0, 0.6))
            }
            (Garment::Top, Place::Leg(_)) => tucked(0.02),
            // The waistband of a skirt is below the top
            (Garment::Bottom, _) if bottom.hangs_from_waist() => {
                let below_edge_m = self.waist_height - self.positions[usize::from(vertex)].y;
                let below_waistband = (below_edge_m / WAISTBAND_M).clamp(0.0, 1.0);
                SKIRT_M * (2.0 * below_waistband - 1.0)
            }
            (Garment::Bottom, Place::Leg(at)) => 0.005 + 0.009 * at.clamp(0.0, 2.0),
            (Garment::Bottom, _) => 0.005,
        }
    }
}

/// A garment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Garment {
    /// Of the upper body.
    Top,
    /// Of the lower body.
    Bottom,
    /// Of the feet.
    Shoe,
}
