//! Warnings about a studio as lines of text. Many of one kind are one line.

use crate::scene::Finding;
use std::collections::HashMap;

/// Warnings of one kind that are all listed.
const LISTED: usize = 3;
/// Most kinds of warnings that are listed.
const KINDS: usize = 20;

/// Returns a line for each warning; for each kind, if there are more than [`LISTED`] of it or more than [`KINDS`] kinds.
pub fn lines(warnings: &[Finding]) -> Vec<String> {
    let mut kinds: Vec<Vec<&Finding>> = Vec::new();
    let mut known: HashMap<String, usize> = HashMap::new();
    for warning in warnings {
        let kind = *known.entry(kind_of(&warning.message)).or_insert_with(|| {
            kinds.push(Vec::new());
            kinds.len() - 1
        });
        kinds[kind].push(warning);
    }
    let listed = kinds.iter().take(KINDS).flat_map(|same| match same.len() {
        0..=LISTED => same.iter().map(ToString::to_string).collect(),
        many => vec![format!("{}; and {} more like this", same[0], many - 1)],
    });
    let rest: usize = kinds.iter().skip(KINDS).map(Vec::len).sum();
    listed.chain((rest > 0).then(|| format!("{rest} more warnings of other kinds"))).collect()
}

/// Returns a message without its names and numbers.
fn kind_of(message: &str) -> String {
    let outside_of_quotes = message.split('"').step_by(2);
    outside_of_quotes.flat_map(str::chars).filter(|c| !c.is_ascii_digit()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_thousand_equal_warnings_are_one_line() {
        let many = (2..10_001).map(|n| {
            Finding::warning(format!("lights[{n}]"), format!("another thing bears this name; this is now \"Key {n}\""))
        });
        let few = (0..LISTED).map(|n| Finding::warning(format!("objects[{n}]"), "it is flat"));
        let lines = lines(&many.chain(few).collect::<Vec<_>>());
        let first = "lights[2]: another thing bears this name; this is now \"Key 2\"; and 9998 more like this";
        assert_eq!(lines, [first, "objects[0]: it is flat", "objects[1]: it is flat", "objects[2]: it is flat"]);
    }

    #[test]
    fn ten_thousand_different_warnings_are_twenty_lines_and_a_number() {
        let kind = |n: u32| (0..14).map(|bit| if n >> bit & 1 == 1 { 'a' } else { 'b' }).collect::<String>();
        let all: Vec<Finding> = (0..10_000).map(|n| Finding::warning("", kind(n))).collect();
        let lines = lines(&all);
        assert_eq!((lines.len(), lines[KINDS].as_str()), (KINDS + 1, "9980 more warnings of other kinds"));
    }
}
