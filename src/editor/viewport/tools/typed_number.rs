//! A number that is typed during a drag: `1.5`, then Enter.

use eframe::egui::{Event, Key};

/// A number as typed so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TypedNumber {
    text: String,
    finished: bool,
}

impl TypedNumber {
    /// Handles keys.
    pub fn take(&mut self, events: &[Event]) {
        for event in events {
            match event {
                Event::Text(text) => self.text.extend(text.chars().filter_map(digit)),
                Event::Key { key: Key::Backspace, pressed: true, .. } => drop(self.text.pop()),
                Event::Key { key: Key::Enter, pressed: true, .. } => self.finished |= !self.text.is_empty(),
                _ => {}
            }
        }
    }

    /// Returns the text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the number, if the text is one.
    pub fn value(&self) -> Option<f32> {
        self.text.parse().ok().filter(|value: &f32| value.is_finite())
    }

    /// Returns true after Enter.
    pub fn is_finished(&self) -> bool {
        self.finished
    }
}

/// Returns the character of a number; a comma becomes a point.
fn digit(letter: char) -> Option<char> {
    match letter {
        ',' | '.' => Some('.'),
        '\u{2212}' | '-' => Some('-'),
        digit if digit.is_ascii_digit() => Some(digit),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Modifiers;

    fn key(key: Key) -> Event {
        Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: Modifiers::NONE }
    }

    #[test]
    fn numbers_are_typed_with_point_or_comma_and_letters_are_skipped() {
        let mut typed = TypedNumber::default();
        typed.take(&[key(Key::Enter), Event::Text("-1,x5".into())]);
        assert_eq!((typed.value(), typed.is_finished()), (Some(-1.5), false));
        typed.take(&[key(Key::Backspace), Event::Text("25".into()), key(Key::Enter)]);
        assert_eq!((typed.value(), typed.is_finished(), typed.text()), (Some(-1.25), true, "-1.25"));
    }

    #[test]
    fn an_incomplete_number_has_no_value() {
        let mut typed = TypedNumber::default();
        typed.take(&[Event::Text("-".into())]);
        assert_eq!(typed.value(), None);
    }
}
