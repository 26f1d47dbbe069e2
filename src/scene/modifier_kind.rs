//! The kinds of modifiers, as far as their bodies differ.

/// What stands on the set for a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModifierKind {
    /// A head without modifier.
    Bare,
    /// A rectangular softbox or strip.
    Softbox,
    /// An octagonal softbox.
    Octa,
    /// A white umbrella that reflects: the head before it faces away from the subject.
    Umbrella,
    /// A translucent umbrella, its point towards the subject.
    ShootThrough,
    /// A beauty dish with its deflector.
    Dish,
    /// A standard reflector.
    Reflector,
    /// A tube on a reflector.
    Snoot,
    /// A projector with a lens.
    Projector,
    /// Cloth in a frame.
    Frame,
    /// A paper lantern.
    Lantern,
}
