//! The modifiers that are sold, by name.

use super::modifier_kind::ModifierKind;
use super::{BarnDoors, Emitter, Modifier};

/// Full angles in which grids for softboxes and octas are sold.
pub const SOFT_GRIDS_DEG: [f32; 5] = [20.0, 30.0, 40.0, 50.0, 60.0];
/// Full angles in which honeycombs for reflectors are sold.
pub const HARD_GRIDS_DEG: [f32; 4] = [10.0, 20.0, 30.0, 40.0];

/// A modifier that is sold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedModifier {
    /// Its name, sizes in centimetres.
    pub name: &'static str,
    /// One line on its use.
    pub tip: &'static str,
    /// Luminous surface.
    pub emitter: Emitter,
    /// Loss and beam shape.
    pub modifier: Modifier,
    /// Its body.
    pub kind: ModifierKind,
}

const fn soft(name: &'static str, tip: &'static str, width_m: f32, height_m: f32, loss_stops: f32) -> NamedModifier {
    let emitter = Emitter::RectPanel { width_m, height_m };
    NamedModifier { name, tip, emitter, modifier: Modifier::loss(loss_stops), kind: ModifierKind::Softbox }
}

const fn round(name: &'static str, tip: &'static str, diameter_m: f32, loss_stops: f32) -> NamedModifier {
    let emitter = Emitter::RoundPanel { diameter_m };
    NamedModifier { name, tip, emitter, modifier: Modifier::loss(loss_stops), kind: ModifierKind::Octa }
}

impl NamedModifier {
    /// Returns it with another kind of body.
    const fn with_kind(self, kind: ModifierKind) -> Self {
        NamedModifier { kind, ..self }
    }
}

const fn dish(name: &'static str, tip: &'static str, diameter_m: f32) -> NamedModifier {
    let modifier = Modifier::loss(0.5).beam(50.0, 130.0);
    NamedModifier { name, tip, emitter: Emitter::RoundPanel { diameter_m }, modifier, kind: ModifierKind::Dish }
}

/// A standard reflector of 18 cm: hard light in a broad cone, with a loss of a third of a stop.
const REFLECTOR: Emitter = Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 };

const fn hard(name: &'static str, tip: &'static str, modifier: Modifier) -> NamedModifier {
    NamedModifier { name, tip, emitter: REFLECTOR, modifier, kind: ModifierKind::Reflector }
}

const REFLECTOR_LOSS: Modifier = Modifier::loss(0.3);

impl NamedModifier {
    /// Name of the entry of a head without a modifier.
    pub const BARE: &'static str = "Bare bulb";

    /// All modifiers, in list order. Losses are typical of makers' and testers' data: 1 to 2 stops for softboxes, more
    /// for larger ones and for more cloth; half a stop for a white dish; 1 stop for a reflective umbrella, 1.7 for a
    /// shoot-through.
    ///
    /// Losses of flux are hardly measured; what users read on the axis, bare flash against modifier, also counts how its
    /// reflector gathered light before. With a speedlight at 6 ft (whatdoineed2do.blogspot.com, September 2010) a small
    /// softbox lost 0.9 stops, one of 28 in 3.3, a shoot-through 1.9, an umbrella that reflects 2.2. A dish of 18 in read
    /// 1.7 stops over an octa of 48 in on another head (betterfamilyphotos.blogspot.com, March 2012): of ours, the dish
    /// of 42 cm is 0.9 stops over the octa of 120 cm by its lower loss alone. All good to a third of a stop at best.
    pub const ALL: [NamedModifier; 32] = [
        NamedModifier {
            name: NamedModifier::BARE,
            tip: "A head without modifier: light in all directions, hard shadows.",
            emitter: Emitter::Sphere { radius_m: 0.04 },
            modifier: Modifier::loss(0.0),
            kind: ModifierKind::Bare,
        },
        hard("Reflector", "A standard reflector: a hard, broad cone.", REFLECTOR_LOSS),
        soft("Softbox 60 x 90", "The everyday softbox: soft edges on a face from 1 to 1.5 m.", 0.6, 0.9, 1.3),
        soft("Softbox 90 x 120", "A large, very soft key or a broad fill.", 0.9, 1.2, 1.6),
        soft("Softbox 60 x 60", "A small square softbox, for heads and products.", 0.6, 0.6, 1.1),
        soft("Softbox 120 x 120", "A large square softbox, for groups and full figures.", 1.2, 1.2, 1.7),
        soft("Strip 30 x 120", "A narrow softbox: rim light along a body, clean lines on products.", 0.3, 1.2, 1.6),
        soft("Strip 30 x 160", "A tall strip for full figures.", 0.3, 1.6, 1.8),
        round("Octa 90", "A small octabox: round catchlights from close by.", 0.9, 1.2),
        round("Octa 120", "An octabox: round catchlights, soft wrapping light.", 1.2, 1.4),
        round("Octa 150", "A large octabox, for heads and half figures.", 1.5, 1.6),
        round("Octa 180", "A huge octabox, soft even for a full figure.", 1.8, 1.8),
        dish("Beauty dish 42", "A small dish: crisp light with a round catchlight.", 0.42),
        dish("Beauty dish 55", "A dish: crisper than a softbox, with a smooth fall to shadow.", 0.55),
        dish("Beauty dish 70", "A large dish: a little softer, for half figures.", 0.7),
        round("Umbrella 85", "A white umbrella that reflects: broad, soft, spills everywhere before it.", 0.85, 1.0)
            .with_kind(ModifierKind::Umbrella),
        round("Umbrella 105", "A white umbrella that reflects, for heads and half figures.", 1.05, 1.0)
            .with_kind(ModifierKind::Umbrella),
        round("Umbrella 165", "A huge white umbrella: an even fill for a whole room.", 1.65, 1.0)
            .with_kind(ModifierKind::Umbrella),
        round("Shoot-through 105", "A translucent umbrella: half of its light goes back and is lost.", 1.05, 1.7)
            .with_kind(ModifierKind::ShootThrough),
        hard("Reflector, 40\u{b0} grid", "A honeycomb: a hard pool that fades out.", REFLECTOR_LOSS.grid(40.0)),
        hard(
            "Reflector, 30\u{b0} grid",
            "A honeycomb: a hard pool, for backgrounds and hair.",
            REFLECTOR_LOSS.grid(30.0),
        ),
        hard("Reflector, 20\u{b0} grid", "A honeycomb: a small hard pool, for hair.", REFLECTOR_LOSS.grid(20.0)),
        hard("Reflector, 10\u{b0} grid", "A honeycomb: a spot of light, for an accent.", REFLECTOR_LOSS.grid(10.0)),
        hard("Barn doors", "A reflector with four flaps.", REFLECTOR_LOSS.doors(BarnDoors::HALF_OPEN)),
        hard("Snoot", "A tube on a reflector: a small round pool with a soft edge.", REFLECTOR_LOSS.beam(12.0, 18.0))
            .with_kind(ModifierKind::Snoot),
        hard("Reflector, 1 stop scrim", "A wire net: a reflector at half the light.", Modifier::loss(1.3)),
        NamedModifier {
            name: "Spot",
            tip: "A projector with a lens: a cone with a nearly hard edge.",
            emitter: Emitter::Spot { inner_deg: 20.0, outer_deg: 26.0 },
            modifier: Modifier::loss(1.0),
            kind: ModifierKind::Projector,
        },
        NamedModifier {
            name: "Softbox 60 x 90, 40\u{b0} grid",
            tip: "A softbox with a fabric grid: soft, and off the background.",
            emitter: Emitter::RectPanel { width_m: 0.6, height_m: 0.9 },
            modifier: Modifier::loss(1.3).grid(40.0),
            kind: ModifierKind::Softbox,
        },
        NamedModifier {
            name: "Strip 30 x 120, 30\u{b0} grid",
            tip: "A rim light that neither flares nor spills.",
            emitter: Emitter::RectPanel { width_m: 0.3, height_m: 1.2 },
            modifier: Modifier::loss(1.6).grid(30.0),
            kind: ModifierKind::Softbox,
        },
        NamedModifier {
            name: "Octa 120, 40\u{b0} grid",
            tip: "An octabox with a fabric grid.",
            emitter: Emitter::RoundPanel { diameter_m: 1.2 },
            modifier: Modifier::loss(1.4).grid(40.0),
            kind: ModifierKind::Octa,
        },
        NamedModifier {
            name: "Beauty dish 55, 30\u{b0} grid",
            tip: "A dish with a honeycomb: a glow that falls off fast.",
            emitter: Emitter::RoundPanel { diameter_m: 0.55 },
            modifier: Modifier::loss(0.5).beam(50.0, 130.0).grid(30.0),
            kind: ModifierKind::Dish,
        },
        soft("Scrim 120 x 180", "A frame of silk, lit from behind through its whole area.", 1.2, 1.8, 1.0)
            .with_kind(ModifierKind::Frame),
    ];

    /// Returns the modifier with this emitter and beam, if it is one of the list.
    pub fn of(emitter: &Emitter, modifier: &Modifier) -> Option<&'static NamedModifier> {
        const ALL: &[NamedModifier] = &NamedModifier::ALL;
        ALL.iter().find(|named| named.emitter == *emitter && named.modifier == *modifier)
    }

    /// Returns true for the entry of a head without a modifier.
    pub fn is_bare(&self) -> bool {
        self.name == Self::BARE
    }

    /// Returns the modifier of this name.
    pub fn named(name: &str) -> Option<&'static NamedModifier> {
        const ALL: &[NamedModifier] = &NamedModifier::ALL;
        ALL.iter().find(|named| named.name == name)
    }
}
