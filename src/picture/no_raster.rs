//! What stands in for pictures as pixels in a build without them.

use super::picture_error::PictureError;

/// An SVG as a PNG: not in this build.
///
/// # Errors
///
/// Always.
pub fn png(_svg: &str, _width: u32) -> Result<Vec<u8>, PictureError> {
    Err(PictureError::Unavailable)
}
