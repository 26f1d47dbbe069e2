//! Lines of an OBJ file that go on in the next one, after a `\` at their end.

use std::borrow::Cow;

/// Returns the text with every continued line on one line. The line breaks that are taken out follow the joined line,
/// so that all other lines keep their numbers. A comment does not go on: a `\` at its end belongs to a Windows path.
pub(super) fn joined(text: &[u8]) -> Cow<'_, [u8]> {
    if !memchr::memchr_iter(b'\\', text).any(|at| line_break_len(&text[at + 1..]) > 0) {
        return Cow::Borrowed(text);
    }
    let mut out = Vec::with_capacity(text.len());
    let (mut is_comment, mut is_line_start, mut taken) = (false, true, 0);
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        if is_line_start && !matches!(byte, b' ' | b'\t') {
            is_comment = byte == b'#';
            is_line_start = false;
        }
        let continued = if byte == b'\\' && !is_comment { line_break_len(&text[at + 1..]) } else { 0 };
        at += 1 + continued;
        if continued > 0 {
            out.push(b' ');
            taken += 1;
            continue;
        }
        out.push(byte);
        if byte == b'\n' {
            out.extend(std::iter::repeat_n(b'\n', std::mem::take(&mut taken)));
            is_line_start = true;
        }
    }
    Cow::Owned(out)
}

/// Returns the length of a line break at the start of the text; 0 if there is none.
fn line_break_len(text: &[u8]) -> usize {
    match text {
        [b'\n', ..] => 1,
        [b'\r', b'\n', ..] => 2,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn continued_lines_are_joined_and_the_others_keep_their_numbers() {
        let text = b"v 1 \\\n2 \\\r\n3\nf 1\n  # C:\\models\\\nv 4";
        assert_eq!(joined(text).as_ref(), b"v 1  2  3\n\n\nf 1\n  # C:\\models\\\nv 4");
        assert!(matches!(joined(b"usemtl a\\b\nv 1 2 3\n"), Cow::Borrowed(_)));
        assert_eq!(joined(b"v 1 \\\n").as_ref(), b"v 1  ");
    }
}
