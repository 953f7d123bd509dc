//! Why a picture cannot be had in pixels.

/// The greatest width and height in pixels.
pub(super) const LARGEST: u32 = 16_384;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The SVG is not one.
    #[cfg(feature = "png")]
    #[error("the picture cannot be read: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// It would have no pixels, or too many.
    #[error("a picture of {width} x {height} pixels cannot be made: each must be from 1 to {LARGEST}")]
    Size {
        /// How wide.
        width: u32,
        /// How high.
        height: u32,
    },
    /// The pixels cannot be written as PNG.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(String),
    /// The program was built without what draws pixels.
    #[error("this build draws no PNG: build tautline with its feature png, or have the picture as .svg")]
    Unavailable,
}
