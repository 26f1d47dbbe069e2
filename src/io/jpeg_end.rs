//! Finds the end of the picture in a JPEG file (ITU-T T.81, annex B), which the decoder does not miss: it leaves the
//! rest of a file that is cut off grey.

// Markers: start of image, end of image, start of scan.
const SOI: u8 = 0xd8;
const EOI: u8 = 0xd9;
const SOS: u8 = 0xda;

/// Returns true for a JPEG file that ends before its picture does.
pub(super) fn is_cut_off(file: &[u8]) -> bool {
    file.starts_with(&[0xff, SOI]) && !has_end(&file[2..])
}

/// Returns true if the markers after the start of the image lead to the end of the image.
fn has_end(mut rest: &[u8]) -> bool {
    loop {
        // Go to the next marker. Within a scan, 0xff 0x00 is a byte of data, and 0xff 0xd0 to 0xd7 restart the coder.
        let Some(at) = memchr::memchr(0xff, rest) else { return false };
        let Some(&marker) = rest.get(at + 1) else { return false };
        rest = &rest[at + 1..];
        match marker {
            EOI => return true,
            // Skip the marker's segment, which its length in two bytes is a part of. A scan's data follows its header.
            0x02..=0xcf | SOS..=0xfe => {
                let Some(&[high, low]) = rest.get(1..3) else { return false };
                let length = usize::from(u16::from_be_bytes([high, low]));
                rest = rest.get(1 + length..).unwrap_or_default();
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::jpeg::JpegEncoder;

    fn jpeg() -> Vec<u8> {
        let mut file = Vec::new();
        let noise = image::RgbImage::from_fn(64, 48, |x, y| {
            image::Rgb((x * 37 + y * 91).to_le_bytes()[..3].try_into().unwrap())
        });
        JpegEncoder::new_with_quality(&mut file, 95).encode_image(&noise).unwrap();
        file
    }

    #[test]
    fn every_shortened_file_is_cut_off_and_the_whole_one_is_not() {
        let file = jpeg();
        for length in 2..file.len() {
            assert!(is_cut_off(&file[..length]), "{length} of {}", file.len());
        }
        assert!(!is_cut_off(&file));
    }

    #[test]
    fn a_thumbnail_does_not_end_the_picture_and_bytes_behind_it_do_no_harm() {
        let file = jpeg();
        // A segment of metadata with a whole picture in it.
        let thumbnail = &file[..900.min(file.len())];
        let thumbnail = [thumbnail, &[0xff, EOI]].concat();
        let length = u16::try_from(thumbnail.len() + 2).unwrap().to_be_bytes();
        let with_thumbnail = [&[0xff, SOI, 0xff, 0xe1], &length[..], &thumbnail, &file[2..]].concat();
        assert!(!is_cut_off(&with_thumbnail));
        assert!(is_cut_off(&with_thumbnail[..with_thumbnail.len() - 10]));
        assert!(!is_cut_off(&[&file[..], b"more"].concat()));
        assert!(!is_cut_off(b"\x89PNG"));
    }
}
