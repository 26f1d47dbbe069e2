//! One error or warning about a scene.

/// The severity of a [`Finding`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The scene can be rendered but is probably not what the user meant.
    Warning,
    /// The scene cannot be used.
    Error,
}

/// One error or warning about a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Its severity.
    pub severity: Severity,
    /// The field, as in the file: `lights[2] "Key" power.dial_stops`; empty for the scene as a whole.
    pub place: String,
    /// The message, with the value.
    pub message: String,
}

/// The message of two equal names; [`Finding::is_name_clash`] compares with it.
pub(super) const NAME_CLASH: &str = "another object or light has this name, too";

impl Finding {
    /// Returns a warning.
    pub fn warning(place: impl Into<String>, message: impl Into<String>) -> Self {
        Finding { severity: Severity::Warning, place: place.into(), message: message.into() }
    }

    /// Returns an error.
    pub fn error(place: impl Into<String>, message: impl Into<String>) -> Self {
        Finding { severity: Severity::Error, place: place.into(), message: message.into() }
    }

    /// Returns true if the finding is about two equal names, which loading and saving rename.
    pub fn is_name_clash(&self) -> bool {
        self.message.ends_with(NAME_CLASH)
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        f.write_str(&self.message)
    }
}
