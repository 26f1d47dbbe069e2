//! A look over an OBJ file before the parser: every face must name vertices that exist. The parser would say so, too,
//! but without the line; and some wild indices overflow its arithmetic.

/// Positions, texture coordinates, normals.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// What is wrong with the first bad face, with its line.
pub(super) fn check(text: &str) -> Result<(), String> {
    let mut counts = [0_i64; 3];
    // A face may name a vertex that comes later, so the largest index of each kind waits for the end.
    let mut largest = [(0_i64, 0_usize); 3];
    for (number, line) in text.lines().enumerate().map(|(i, line)| (i + 1, line.trim_start())) {
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "v" => counts[0] += 1,
            "vt" => counts[1] += 1,
            "vn" => counts[2] += 1,
            "f" | "l" => check_face(rest, number, &counts, &mut largest)?,
            _ => {}
        }
    }
    for ((kind, count), (index, line)) in KINDS.iter().zip(counts).zip(largest) {
        if index > count {
            return Err(format!("line {line}: the face names {kind} {index}, but there are {count}"));
        }
    }
    Ok(())
}

fn check_face(rest: &str, line: usize, counts: &[i64; 3], largest: &mut [(i64, usize); 3]) -> Result<(), String> {
    for corner in rest.split_whitespace() {
        for (kind, text) in corner.split('/').enumerate().filter(|(_, text)| !text.is_empty()) {
            let wrong = |why: &str| Err(format!("line {line}: the face's corner {corner:?} {why}"));
            let Some(count) = counts.get(kind) else { return wrong("has too many parts") };
            match text.parse::<i64>() {
                Err(_) => return wrong("is no index"),
                Ok(0) => return wrong("is 0, but indices begin at 1"),
                Ok(index) if index < 0 && index.checked_neg().is_none_or(|back| back > *count) => {
                    return wrong("points to before the first");
                }
                Ok(index) if index > largest[kind].0 => largest[kind] = (index, line),
                Ok(_) => {}
            }
        }
        if corner.starts_with('/') {
            return Err(format!("line {line}: the face's corner {corner:?} names no vertex"));
        }
    }
    Ok(())
}
