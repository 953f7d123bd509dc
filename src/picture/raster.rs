//! Pictures as pixels.

use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Source};
use resvg::usvg::{Options, Tree};

use super::picture_error::{LARGEST, PictureError};

/// An SVG as a PNG that is `width` pixels wide.
///
/// Letters are those of DejaVu Sans, which is built in: a picture is the same on every machine, with fonts or without.
///
/// # Errors
///
/// Not an SVG, or a size that no picture can have; in a build without the feature `png`, always.
///
/// ```
/// let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2"><rect width="4" height="2"/></svg>"#;
/// assert_eq!(&tautline::picture::png(svg, 8)?[..4], b"\x89PNG");
/// # Ok::<(), tautline::picture::PictureError>(())
/// ```
pub fn png(svg: &str, width: u32) -> Result<Vec<u8>, PictureError> {
    let options = Options { font_family: FAMILY.into(), fontdb: fonts(), ..Options::default() };
    let tree = Tree::from_str(svg, &options)?;
    let scale = width as f32 / tree.size().width();
    let height = (tree.size().height() * scale).round().max(1.0) as u32;
    let fault = PictureError::Size { width, height };
    if width > LARGEST || height > LARGEST {
        return Err(fault);
    }
    let mut pixels = Pixmap::new(width, height).ok_or(fault)?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| PictureError::Png(e.to_string()))
}

const FAMILY: &str = "DejaVu Sans";

/// The one font.
fn fonts() -> Arc<Database> {
    static FONTS: OnceLock<Arc<Database>> = OnceLock::new();
    let load = || {
        let mut fonts = Database::new();
        fonts.load_font_source(Source::Binary(Arc::new(dejavu::sans::regular())));
        fonts.set_sans_serif_family(FAMILY);
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}
