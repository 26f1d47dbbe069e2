//! Numbers of a photometric file, with the line that each stands in.

/// Lines that are read: one number each, in EULUMDAT.
const MOST_LINES: usize = 1 << 20;

/// Returns the lines of a file, from 1, whatever its line breaks: LF, CR LF or CR. Bytes are read as Latin-1, for names
/// are written in the code page of their author.
pub(super) fn lines(bytes: &[u8]) -> Vec<(usize, String)> {
    let text: String = bytes.iter().map(|&byte| char::from(byte)).collect();
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    (1..).zip(text.split('\n').take(MOST_LINES)).map(|(number, line)| (number, line.trim().to_owned())).collect()
}

/// Numbers in the order of the file, wherever its lines break.
#[derive(Debug)]
pub(super) struct Numbers<'a> {
    tokens: std::vec::IntoIter<(usize, &'a str)>,
}

impl<'a> Numbers<'a> {
    /// Returns the numbers of lines, between blanks or commas.
    pub fn new(lines: &'a [(usize, String)]) -> Self {
        let blank = |c: char| c.is_whitespace() || c == ',' || c == '\0' || c == '\u{1a}';
        let of_line = |(number, line): &'a (usize, String)| {
            line.split(blank).filter(|token| !token.is_empty()).map(move |token| (*number, token))
        };
        Numbers { tokens: lines.iter().flat_map(of_line).collect::<Vec<_>>().into_iter() }
    }

    /// Returns how many are left.
    pub fn remaining(&self) -> usize {
        self.tokens.len()
    }

    fn token(&mut self, what: &str) -> Result<(usize, &'a str), String> {
        self.tokens.next().ok_or_else(|| format!("the file ends before {what}"))
    }

    /// Returns the next number.
    pub fn number(&mut self, what: &str) -> Result<f32, String> {
        let (line, token) = self.token(what)?;
        number(token).ok_or_else(|| format!("line {line}: {what} is {token:?}, not a number"))
    }

    /// Returns the next number, an integer from `least` to `most`.
    pub fn count(&mut self, what: &str, least: usize, most: usize) -> Result<usize, String> {
        let (line, token) = self.token(what)?;
        let whole = integer(token).filter(|count| (least..=most).contains(count));
        whole.ok_or_else(|| format!("line {line}: {what} is {token:?}; it must be from {least} to {most}"))
    }

    /// Returns the next numbers.
    pub fn list(&mut self, what: &str, count: usize) -> Result<Vec<f32>, String> {
        if self.remaining() < count {
            return Err(format!("the file ends before {what}: {count} are stated, {} follow", self.remaining()));
        }
        (0..count).map(|_| self.number(what)).collect()
    }

    /// Returns the next numbers, which ascend.
    pub fn angles(&mut self, what: &str, count: usize) -> Result<Vec<f32>, String> {
        let line = self.tokens.as_slice().first().map_or(0, |(line, _)| *line);
        let angles = self.list(what, count)?;
        match angles.windows(2).find(|pair| pair[0] >= pair[1]) {
            Some(pair) => Err(format!("line {line} and on: {what} must ascend, but {} follows {}", pair[1], pair[0])),
            None => Ok(angles),
        }
    }
}

/// Returns a finite number.
pub(super) fn number(token: &str) -> Option<f32> {
    token.parse().ok().filter(|number: &f32| number.is_finite())
}

/// Scales the intensities of a plane. Those that are a hundredth of a candela under 0 are the 0 of a program that rounds.
///
/// # Errors
/// A sentence about the first that is negative or not finite.
pub(super) fn scaled(mut candela: Vec<f32>, factor: f32) -> Result<Vec<f32>, String> {
    const ROUNDING_CD: f32 = 0.01;
    for value in &mut candela {
        *value *= factor;
        if !(*value >= -ROUNDING_CD && value.is_finite()) {
            return Err(format!("{value} cd is no intensity"));
        }
        *value = value.max(0.0);
    }
    Ok(candela)
}

/// Returns an integer, which may be written with decimals of 0.
pub(super) fn integer(token: &str) -> Option<usize> {
    let (whole, decimals) = token.split_once('.').unwrap_or((token, ""));
    whole.parse().ok().filter(|_| decimals.bytes().all(|digit| digit == b'0'))
}
