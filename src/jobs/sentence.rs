//! Messages for a window.

use std::fmt::Display;

/// Returns a message as a sentence: with a capital letter and a full stop.
pub fn sentence(message: &(impl Display + ?Sized)) -> String {
    let text = message.to_string();
    let mut chars = text.chars();
    let first = chars.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    let rest = chars.as_str();
    if rest.ends_with(['.', '!', '?']) { format!("{first}{rest}") } else { format!("{first}{rest}.") }
}
