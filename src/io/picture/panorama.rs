//! Pictures that may be environment maps.

use super::exr_header::holds_studio;
use crate::io::environment::is_equirectangular;
use exr::meta::MetaData;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Returns true for an EXR picture that is twice as wide as high and that holds no studio, by its header.
pub fn is_panorama(path: &Path) -> bool {
    let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let header = || {
        let file = BufReader::new(File::open(path).ok()?);
        MetaData::read_from_buffered(file, false).ok()?.headers.into_iter().next()
    };
    is_exr
        && header().is_some_and(|header| {
            is_equirectangular(header.layer_size.width(), header.layer_size.height()) && !holds_studio(&header)
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::picture::{PictureInfo, export_picture};
    use crate::photo::Picture;
    use crate::scene::Scene;

    #[test]
    fn a_picture_twice_as_wide_as_high_is_a_panorama_unless_it_holds_its_studio() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, (width, height): (u32, u32), studio: &str| {
            let path = folder.path().join(name);
            let picture = Picture { width, height, rgb: vec![[1.0; 3]; (width * height) as usize] };
            let info = PictureInfo { studio: studio.to_owned(), ..PictureInfo::new(&Scene::default(), "path", 1, 0) };
            export_picture(&path, &picture, &info).unwrap();
            path
        };
        assert!(is_panorama(&write("sky.exr", (8, 4), "")));
        assert!(!is_panorama(&write("rendered.exr", (8, 4), "(format: 1)")));
        assert!(!is_panorama(&write("square.exr", (4, 4), "")));
        std::fs::write(folder.path().join("bad.exr"), b"v/1\x01 and no more").unwrap();
        assert!(!is_panorama(&folder.path().join("bad.exr")) && !is_panorama(&folder.path().join("none.exr")));
    }
}
