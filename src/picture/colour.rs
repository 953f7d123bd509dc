//! Colours that stay apart for colour-blind eyes and on paper.

/// Lines and letters.
pub(super) const INK: &str = "#333";
/// What stands behind: frames, ticks, explanations.
pub(super) const MUTED: &str = "#666";
/// Lines to read values off by.
pub(super) const GRID: &str = "#e4e4e4";
/// Walls where nothing is drawn below them.
pub(super) const WALL: &str = "#8a8a8a";

// From the eight colours of M. Okabe and K. Ito, "Color Universal Design" (2008).
/// Blue.
pub(super) const BLUE: &str = "#0072b2";
/// Reddish orange.
pub(super) const VERMILION: &str = "#d55e00";
/// Light blue.
pub(super) const SKY: &str = "#9dcdea";

/// Every eighth of viridis, by S. van der Walt and N. Smith (matplotlib 2.0, 2015; given to the public, CC0).
const VIRIDIS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];

/// The colour of `t` between 0 and 1: from light yellow over green to dark violet, since more is to be darker on white.
pub(super) fn colour(t: f64) -> String {
    let at = (1.0 - t.clamp(0.0, 1.0)) * (VIRIDIS.len() - 1) as f64;
    let i = (at as usize).min(VIRIDIS.len() - 2);
    let [r, g, b] = std::array::from_fn(|k| {
        let (a, b) = (f64::from(VIRIDIS[i][k]), f64::from(VIRIDIS[i + 1][k]));
        (a + (b - a) * (at - i as f64)).round() as u8
    });
    format!("#{r:02x}{g:02x}{b:02x}")
}
