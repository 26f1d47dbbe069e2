//! Pretty-prints scene files: one field a line down to the fields of each object and light, deeper values on one line
//! where they fit. A changed number is one changed line of a diff, and a vector is one line.

/// Longest line, characters; a value that would exceed it is broken over several lines.
const WIDTH: usize = 120;
/// Spaces of indentation for each level.
const INDENT: usize = 4;

/// Pretty-prints RON in the form of `ron::to_string`, without spaces or line breaks outside of strings.
pub(super) fn lay_out(compact: &str) -> String {
    let mut out = String::with_capacity(compact.len() * 2);
    put_value(compact, 0, 0, &mut out);
    out.push('\n');
    out
}

/// Writes one value that starts in column `column` of a line indented by `depth` levels. The scene, its fields and the
/// elements of its lists are always broken over several lines.
fn put_value(value: &str, depth: usize, column: usize, out: &mut String) {
    let Some(open) = group_start(value) else { return out.push_str(value) };
    let inner = &value[open + 1..value.len() - 1];
    let is_element = depth == 2 && column == INDENT * depth;
    if inner.is_empty() || (depth >= 2 && !is_element && column + one_line_len(value) < WIDTH) {
        return put_on_one_line(value, out);
    }
    out.push_str(&value[..=open]);
    out.push('\n');
    for item in split_items(inner) {
        let indent = INDENT * (depth + 1);
        out.extend(std::iter::repeat_n(' ', indent));
        let (key, rest) = split_key(item);
        if let Some(key) = key {
            out.push_str(key);
            out.push_str(": ");
        }
        put_value(rest, depth + 1, indent + key.map_or(0, |k| k.chars().count() + 2), out);
        out.push_str(",\n");
    }
    out.extend(std::iter::repeat_n(' ', INDENT * depth));
    out.push_str(&value[value.len() - 1..]);
}

fn put_on_one_line(value: &str, out: &mut String) {
    for (i, character) in unquoted(value) {
        match character {
            None => out.push_str(&value[i.clone()]),
            Some(',') => out.push_str(", "),
            Some(':') => out.push_str(": "),
            Some(c) => out.push(c),
        }
    }
}

fn one_line_len(value: &str) -> usize {
    unquoted(value)
        .map(|(range, character)| match character {
            None => value[range].chars().count(),
            Some(',' | ':') => 2,
            Some(_) => 1,
        })
        .sum()
}

/// Returns the byte of a value's opening bracket, after an enum variant's name; `None` for numbers, strings and bare
/// names.
fn group_start(value: &str) -> Option<usize> {
    if value.starts_with('"') { None } else { value.find(['(', '[', '{']) }
}

/// Iterates over the characters outside of strings; a whole string is one item without a character.
fn unquoted(text: &str) -> impl Iterator<Item = (std::ops::Range<usize>, Option<char>)> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at;
        let first = text[start..].chars().next()?;
        at += first.len_utf8();
        if first != '"' {
            return Some((start..at, Some(first)));
        }
        let mut escaped = false;
        for c in text[at..].chars() {
            at += c.len_utf8();
            match c {
                '"' if !escaped => break,
                '\\' => escaped = !escaped,
                _ => escaped = false,
            }
        }
        Some((start..at, None))
    })
}

/// Splits the content of a bracket at its top-level commas.
fn split_items(inner: &str) -> Vec<&str> {
    let (mut items, mut start, mut depth) = (Vec::new(), 0, 0_usize);
    for (range, character) in unquoted(inner) {
        match character {
            Some('(' | '[' | '{') => depth += 1,
            Some(')' | ']' | '}') => depth = depth.saturating_sub(1),
            Some(',') if depth == 0 => {
                items.push(&inner[start..range.start]);
                start = range.end;
            }
            _ => {}
        }
    }
    if start < inner.len() {
        items.push(&inner[start..]);
    }
    items
}

/// Splits `key:value`; an item of a tuple has no key.
fn split_key(item: &str) -> (Option<&str>, &str) {
    let colon = unquoted(item).take_while(|(_, c)| !matches!(c, Some('(' | '[' | '{'))).find(|(_, c)| *c == Some(':'));
    match colon {
        Some((range, _)) => (Some(&item[..range.start]), &item[range.end..]),
        None => (None, item),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_broken_and_vectors_stay_on_a_line() {
        let compact = r#"(format:1,name:"a, (b): \"c\"",list:[(at:(1.0,2.0,3.0),kind:Spot(inner_deg:3.0))],none:[])"#;
        let expected = r#"(
    format: 1,
    name: "a, (b): \"c\"",
    list: [
        (
            at: (1.0, 2.0, 3.0),
            kind: Spot(inner_deg: 3.0),
        ),
    ],
    none: [],
)
"#;
        assert_eq!(lay_out(compact), expected);
    }

    #[test]
    fn values_that_do_not_fit_are_broken() {
        let long = format!("(a:(b:X({})))", ["value:123456.0"; 12].join(","));
        let lines: Vec<String> = lay_out(&long).lines().map(str::to_owned).collect();
        assert!(lines.iter().all(|line| line.len() <= WIDTH), "{lines:#?}");
        assert_eq!(lines[2], "        b: X(");
    }
}
