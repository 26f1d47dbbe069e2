//! The ICC profile of sRGB (ICC.1:2022, a display profile of matrix and curves).

/// CIE XYZ of the illuminant D50 in s15Fixed16, as every profile states it.
const D50: [u32; 3] = [0xf6d6, 0x1_0000, 0xd32d];
/// Columns of the matrix from linear sRGB to XYZ at D50, adapted by Bradford's transform; their sum is D50.
const COLORANTS: [[u32; 3]; 3] = [[0x6fa0, 0x38f5, 0x0390], [0x6297, 0xb787, 0x18d9], [0x249f, 0x0f84, 0xb6c4]];
/// Bradford's transform from D65 to D50, row by row.
const ADAPTATION: [i32; 9] = [0x1_0c42, 0x05de, -0x0cdb, 0x0793, 0xfd90, -0x045f, -0x025e, 0x03dc, 0xc06e];
/// The curve of IEC 61966-2-1: exponent 2.4, then 1 / 1.055, 0.055 / 1.055, 1 / 12.92 and 0.04045.
const CURVE: [u32; 5] = [0x2_6666, 0xf2a7, 0x0d59, 0x13d0, 0x0a5b];

/// Returns the profile, always the same bytes.
pub fn srgb_profile() -> Vec<u8> {
    let [red, green, blue] = COLORANTS.map(|xyz| element(b"XYZ ", &xyz));
    let adaptation = element(b"sf32", &ADAPTATION.map(i32::cast_unsigned));
    // Function type 3, in the upper half of a word
    let [exponent, rest @ ..] = CURVE;
    let mut curve = vec![3 << 16, exponent];
    curve.extend(rest);
    let curve = element(b"para", &curve);
    let tags = [
        (b"desc", text("sRGB")),
        (b"cprt", text("CC0")),
        (b"wtpt", element(b"XYZ ", &D50)),
        (b"chad", adaptation),
        (b"rXYZ", red),
        (b"gXYZ", green),
        (b"bXYZ", blue),
        (b"rTRC", curve.clone()),
        (b"gTRC", curve.clone()),
        (b"bTRC", curve),
    ];
    let mut table = words(&[length(&tags)]);
    let mut data = Vec::new();
    let first = 128 + 4 + 12 * tags.len();
    for (name, element) in &tags {
        table.extend(*name);
        table.extend(words(&[word(first + data.len()), length(element)]));
        data.extend(element);
        data.resize(data.len().next_multiple_of(4), 0);
    }
    let mut profile = words(&[word(first + data.len()), 0, 0x0430_0000]);
    profile.extend(b"mntrRGB XYZ ");
    // 1 January 2026: a profile has a date, and pictures of one studio have the same bytes
    profile.extend([0x07, 0xea, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0]);
    profile.extend(b"acsp");
    // No platform, flags, maker, model, attributes; perceptual intent
    profile.extend([0; 28]);
    profile.extend(words(&D50));
    profile.resize(128, 0);
    profile.extend(table);
    profile.extend(data);
    profile
}

fn words(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_be_bytes()).collect()
}

fn word(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

fn length<T>(items: &[T]) -> u32 {
    word(items.len())
}

/// Returns an element of a type: its name, four zeros, its values.
fn element(kind: &[u8; 4], values: &[u32]) -> Vec<u8> {
    [&kind[..], &[0; 4], &words(values)].concat()
}

/// Returns an element with a text in English.
fn text(text: &str) -> Vec<u8> {
    let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let mut element = element(b"mluc", &[1, 12]);
    element.extend(b"enUS");
    element.extend(words(&[length(&utf16), 28]));
    element.extend(utf16);
    element
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_is_that_of_srgb_for_another_reader() {
        let bytes = srgb_profile();
        assert_eq!(bytes, srgb_profile());
        let (ours, theirs) = (moxcms::ColorProfile::new_from_slice(&bytes).unwrap(), moxcms::ColorProfile::new_srgb());
        for (a, b) in [
            (ours.red_colorant, theirs.red_colorant),
            (ours.green_colorant, theirs.green_colorant),
            (ours.blue_colorant, theirs.blue_colorant),
        ] {
            assert!((a.x - b.x).abs() < 5e-4 && (a.y - b.y).abs() < 5e-4 && (a.z - b.z).abs() < 5e-4, "{a:?} {b:?}");
        }
        let sums: Vec<u32> = (0..3).map(|axis| COLORANTS.iter().map(|column| column[axis]).sum()).collect();
        assert_eq!(sums, D50, "white is D50");
        // The rows of the adaptation take D65 to D50
        let d65 = [0.950_47, 1.0, 1.088_83];
        for (row, expected) in ADAPTATION.chunks(3).zip(D50) {
            let sum: f64 = row.iter().zip(d65).map(|(a, b)| f64::from(*a) / 65_536.0 * b).sum();
            assert!((sum - f64::from(expected) / 65_536.0).abs() < 2e-4, "{sum}");
        }
        // Elements are aligned, and lie in the file
        let field = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((field(0), field(128)), (bytes.len(), 10));
        for tag in 0..10 {
            let (offset, size) = (field(132 + 12 * tag + 4), field(132 + 12 * tag + 8));
            assert!(offset % 4 == 0 && offset + size <= bytes.len());
        }
    }
}
