//! Random changes of files.

/// A stream of random numbers: SplitMix64 (Steele, Lea, Flood 2014, "Fast Splittable Pseudorandom Number Generators").
#[derive(Debug)]
pub struct Random(u64);

impl Random {
    /// A stream for a seed.
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Returns an index below `end`; 0 if there is none.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// Returns an item of a list that has some.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }
}

/// Numbers at the ends of ranges, in text.
const NUMBERS: [&str; 16] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "NaN",
    "inf",
    "-inf",
    "1e38",
    "-1e39",
    "1e-45",
    "1e308",
    "4294967296",
    "-2147483649",
    "0.1e",
    "99999999999999999999",
    "1/0/1",
];

/// Returns a file of the corpus with one to eight changes.
pub fn changed(random: &mut Random, corpus: &[Vec<u8>], words: &[&str]) -> Vec<u8> {
    let mut bytes = random.pick(corpus).clone();
    for _ in 0..1 + random.below(8) {
        change(random, &mut bytes, corpus, words);
    }
    bytes
}

fn change(random: &mut Random, bytes: &mut Vec<u8>, corpus: &[Vec<u8>], words: &[&str]) {
    let at = random.below(bytes.len());
    let longest = if random.below(4) == 0 { 4096 } else { 16 };
    let length = 1 + random.below(longest);
    let end = (at + length).min(bytes.len());
    match random.below(9) {
        // Flip a bit, replace a byte
        0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
        1 if at < bytes.len() => bytes[at] = *random.pick(&[0, 0xff, b'0', b'9', b'-', b'(', b')', b'\n', b'"', 0x80]),
        // Cut the end, remove a piece, repeat a piece
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(at..end)),
        4 => {
            let piece = bytes[at..end].repeat(1 + random.below(3));
            bytes.splice(at..at, piece);
        }
        // Insert a piece of another file, a word
        5 => {
            let other = random.pick(corpus);
            let from = random.below(other.len());
            let piece = other[from..(from + length).min(other.len())].to_vec();
            bytes.splice(at..at, piece);
        }
        6 => drop(bytes.splice(at..at, random.pick(words).bytes())),
        // Replace a number of a text
        7 => replace_number(random, bytes, at),
        // Replace four bytes by a number
        _ if at + 4 <= bytes.len() => {
            let number = *random.pick(&[0, 1, u32::MAX, i32::MAX as u32, 1 << 31, 0xffff, 65_537, 1 << 24]);
            let number = if random.below(2) == 0 { number.to_le_bytes() } else { number.to_be_bytes() };
            bytes[at..at + 4].copy_from_slice(&number);
        }
        _ => {}
    }
}

fn replace_number(random: &mut Random, bytes: &mut Vec<u8>, from: usize) {
    let is_part = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'e');
    let Some(start) = bytes[from..].iter().position(u8::is_ascii_digit).map(|at| from + at) else { return };
    let end = bytes[start..].iter().position(|byte| !is_part(byte)).map_or(bytes.len(), |length| start + length);
    bytes.splice(start..end, random.pick(&NUMBERS).bytes());
}
