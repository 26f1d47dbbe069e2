//! The error of an action that cannot be applied.

/// The error of an action, as a message to the user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ActionError {
    /// The name is empty.
    #[error("A name cannot be empty.")]
    EmptyName,
    /// The name is taken.
    #[error("\"{0}\" is taken. Names are unique, so that aims and the file can use them.")]
    NameTaken(String),
    /// Camera and room exist exactly once.
    #[error("The {0} cannot be deleted, duplicated or renamed.")]
    Fixed(&'static str),
    /// The light meter exists at most once and has no name.
    #[error("There is one light meter in a studio: move it to where you want to read.")]
    Single,
    /// The item is locked.
    #[error("{0} is locked in its place: unlock it first (K, or the padlock in the list).")]
    Locked(String),
    /// The item no longer exists.
    #[error("That is no longer in the studio.")]
    Gone,
    /// Another variant has the name.
    #[error("Another variant is called \"{0}\".")]
    VariantNameTaken(String),
    /// There are as many variants as there may be.
    #[error("A studio has at most {0} variants.")]
    TooManyVariants(usize),
    /// The resulting scene would be invalid.
    #[error("{0}")]
    Invalid(String),
}
