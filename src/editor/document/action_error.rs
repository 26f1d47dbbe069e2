//! The error of an action that cannot be applied.

/// Why an action cannot be done, in words for the user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ActionError {
    /// A name that is empty.
    #[error("A name cannot be empty.")]
    EmptyName,
    /// A name that something else bears.
    #[error("\"{0}\" is taken. Names are unique, so that aims and the file can use them.")]
    NameTaken(String),
    /// The camera and the room are always there, once.
    #[error("The {0} cannot be deleted, duplicated or renamed.")]
    Fixed(&'static str),
    /// There is one meter, and it has no name.
    #[error("There is one light meter in a studio: move it to where you want to read.")]
    Single,
    /// What is locked does not move.
    #[error("{0} is locked in its place: unlock it first (K, or the padlock in the list).")]
    Locked(String),
    /// What the action is about has gone.
    #[error("That is no longer in the studio.")]
    Gone,
    /// The result would be a scene that no renderer can take.
    #[error("{0}")]
    Invalid(String),
}
