//! Ids of objects and lights.

/// The id of an object while the scene is open. Files refer to objects by their unique `name`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u32);

/// The id of a light while the scene is open. Files refer to lights by their unique `name`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LightId(pub u32);
