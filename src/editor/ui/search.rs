//! The search of lists, by words.

use crate::editor::ui::widgets;
use eframe::egui::{Response, TextEdit, Ui};

/// Returns true if every word of the query is a part of one of the texts, in small or capital letters.
pub fn is_match(query: &str, texts: &[&str]) -> bool {
    let texts: Vec<String> = texts.iter().map(|text| text.to_lowercase()).collect();
    query.to_lowercase().split_whitespace().all(|word| texts.iter().any(|text| text.contains(word)))
}

/// Draws the search field of a list, with this accessible name, over the width that is left.
pub fn search_ui(ui: &mut Ui, name: &str, query: &mut String) -> Response {
    let field = TextEdit::singleline(query).hint_text("Search").desired_width(f32::INFINITY);
    let response = ui.add(field);
    widgets::named(ui, &response, name);
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_words_of_a_query_have_to_be_found() {
        let texts = ["Octa 120", "Round and soft, for faces"];
        assert!(["", "  ", "octa", "OCTA face", "soft 12"].iter().all(|query| is_match(query, &texts)));
        assert!(["square", "octa square"].iter().all(|query| !is_match(query, &texts)));
    }
}
