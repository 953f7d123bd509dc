//! Images of maps, PNG and PGM, as a bit for each pixel.

use std::io::Cursor;
use std::path::Path;

use super::cells::SIDE_MAX;
use super::excerpt;
use crate::read_error::{Fault, Place, ReadError};
use crate::read_file::{SCENE_MAX, read_bytes};

/// How many pixels an image may have: an eighth of that are the bytes that it takes.
const PIXELS_MAX: usize = 1 << 28;

/// The same for interlaced ones, which have to be held as a whole.
const INTERLACED_MAX: usize = 1 << 24;

/// A pixel; all values are from 0, black or transparent, to 65535.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pixel {
    /// Red, green and blue, which are all the same in grey images.
    pub(super) colours: [u16; 3],
    /// How opaque it is, if the image has an alpha channel.
    pub(super) alpha: Option<u16>,
}

impl Pixel {
    fn grey(value: u16) -> Self {
        Pixel { colours: [value; 3], alpha: None }
    }
}

/// A bit for each pixel, from the upper left one on, row by row.
pub(super) struct Bits {
    pub(super) width: usize,
    pub(super) height: usize,
    words: Vec<u64>,
}

impl Bits {
    pub(super) fn get(&self, x: usize, y: usize) -> bool {
        let i = y * self.width + x;
        self.words[i / 64] >> (i % 64) & 1 == 1
    }
}

/// Reads an image and asks of each of its pixels whether it is set.
pub(super) fn read(path: &Path, set: impl FnMut(Pixel) -> bool) -> Result<Bits, ReadError> {
    parse(&read_bytes(path, SCENE_MAX)?, set).map_err(|fault| fault.in_file(path))
}

fn parse(bytes: &[u8], set: impl FnMut(Pixel) -> bool) -> Result<Bits, Fault> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => png(bytes, set),
        [b'P', b'5' | b'2', ..] => pgm(bytes, set),
        _ => Err(fault("neither PNG nor PGM; save the image as one of them")),
    }
}

fn fault(what: impl Into<String>) -> Fault {
    Fault::new(Place::default(), what)
}

/// Room for an image of this size, if it may be as large.
fn room(width: usize, height: usize) -> Result<Bits, Fault> {
    let sides = 1..=SIDE_MAX;
    if !sides.contains(&width) || !sides.contains(&height) || width * height > PIXELS_MAX {
        let most = format!("each side must have from 1 to {SIDE_MAX} and all together at most {PIXELS_MAX}");
        return Err(fault(format!("{width} x {height} pixels; {most}")));
    }
    Ok(Bits { width, height, words: vec![0; (width * height).div_ceil(64)] })
}

/// Sets the bits of the pixels that are given in order.
fn fill(bits: &mut Bits, from: usize, pixels: impl Iterator<Item = Pixel>, set: &mut impl FnMut(Pixel) -> bool) {
    for (i, pixel) in (from..).zip(pixels) {
        bits.words[i / 64] |= u64::from(set(pixel)) << (i % 64);
    }
}

fn png(bytes: &[u8], mut set: impl FnMut(Pixel) -> bool) -> Result<Bits, Fault> {
    let wrong = |e: png::DecodingError| fault(format!("not PNG: {e}"));
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    // Texts and colour profiles are no pixels, and may be far larger than they are in the file.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(wrong)?;
    let info = reader.info();
    let interlaced = info.interlaced;
    let mut bits = room(info.width as usize, info.height as usize)?;
    let (colours, depth) = reader.output_color_type();
    let samples = colours.samples();
    // What is expanded has whole bytes.
    let wide = if depth == png::BitDepth::Sixteen { 2 } else { 1 };
    let pixels = |row: &[u8]| row.chunks_exact(samples * wide).map(|p| pixel(p, wide)).collect::<Vec<_>>();
    let (width, height) = (bits.width, bits.height);
    if interlaced {
        if width * height > INTERLACED_MAX {
            return Err(fault(format!(
                "interlaced, with more than {INTERLACED_MAX} pixels; save it without interlacing"
            )));
        }
        let mut all = vec![0; width * height * samples * wide];
        reader.next_frame(&mut all).map_err(wrong)?;
        fill(&mut bits, 0, pixels(&all).into_iter(), &mut set);
    } else {
        for y in 0..height {
            let Some(row) = reader.next_row().map_err(wrong)? else {
                return Err(fault(format!("not PNG: the image ends after {y} of {height} rows")));
            };
            fill(&mut bits, y * width, pixels(row.data()).into_iter(), &mut set);
        }
    }
    // What ends before its end may have lost more than that.
    reader.finish().map_err(wrong)?;
    if inflates_beyond(bytes, raw_size(reader.info())) {
        return Err(goes_on(width * height));
    }
    Ok(bits)
}

/// How many bytes the rows have before they are compressed, with the byte before each that names its filter.
fn raw_size(info: &png::Info<'_>) -> u64 {
    let row = |width: u32| 1 + (u64::from(width) * info.bits_per_pixel() as u64).div_ceil(8);
    if !info.interlaced {
        return u64::from(info.height) * row(info.width);
    }
    // Seven images, each with the first column and row that it has, and the steps to the next ones.
    let passes = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)];
    let sides = passes.map(|(x, y, dx, dy): (u32, u32, u32, u32)| {
        [info.width.saturating_sub(x).div_ceil(dx), info.height.saturating_sub(y).div_ceil(dy)]
    });
    sides.iter().filter(|side| side[0] > 0).map(|&[width, height]| u64::from(height) * row(width)).sum()
}

/// Whether the compressed pixels of a sound PNG are more than `size` bytes: the decoder stops there and does not look.
fn inflates_beyond(bytes: &[u8], size: u64) -> bool {
    let mut inflate = flate2::Decompress::new(true);
    let mut out = vec![0; 1 << 16];
    let mut rest = bytes.get(8..).unwrap_or_default();
    while let Some((&length, tail)) = rest.split_first_chunk::<4>().map(|(length, tail)| (length, tail)) {
        let length = u32::from_be_bytes(length) as usize;
        let Some(chunk) = tail.get(4..4 + length) else { return false };
        if tail.starts_with(b"IDAT") {
            let mut data = chunk;
            loop {
                let before = (inflate.total_in(), inflate.total_out());
                let status = inflate.decompress(data, &mut out, flate2::FlushDecompress::None);
                if inflate.total_out() > size {
                    return true;
                }
                data = &data[(inflate.total_in() - before.0) as usize..];
                match status {
                    Ok(flate2::Status::Ok | flate2::Status::BufError)
                        if before != (inflate.total_in(), inflate.total_out()) => {}
                    Ok(flate2::Status::StreamEnd) | Err(_) => return false,
                    Ok(_) => break,
                }
            }
        }
        rest = tail.get(4 + length + 4..).unwrap_or_default();
    }
    false
}

/// A pixel of samples of one or two bytes: grey or red, green and blue, and alpha behind them if there are two or four.
fn pixel(samples: &[u8], bytes: usize) -> Pixel {
    let sample = |i: usize| match bytes {
        1 => u16::from(samples[i]) * 257,
        _ => u16::from_be_bytes([samples[2 * i], samples[2 * i + 1]]),
    };
    let count = samples.len() / bytes;
    let colours = if count < 3 { [sample(0); 3] } else { [0, 1, 2].map(sample) };
    Pixel { colours, alpha: count.is_multiple_of(2).then(|| sample(count - 1)) }
}

/// PGM, binary (P5) or as text (P2).
fn pgm(bytes: &[u8], mut set: impl FnMut(Pixel) -> bool) -> Result<Bits, Fault> {
    let mut at = 2;
    let [width, height, white] = [word(bytes, &mut at), word(bytes, &mut at), word(bytes, &mut at)]
        .map(|word| word.parse::<u64>().map_err(|_| header(word)));
    let [width, height, white] = [width?, height?, white?].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
    if !(1..=65535).contains(&white) {
        return Err(fault(format!("not PGM: white is {white}; it must be from 1 to 65535")));
    }
    if width > SIDE_MAX || height > SIDE_MAX {
        return room(width, height);
    }
    // To the nearest of 65536 values; white is no larger.
    let shade = |value: usize| Pixel::grey(((value.min(white) * 65535 + white / 2) / white) as u16);
    let short = |has: usize| fault(format!("the image ends after {has} of {} pixels", width * height));
    if bytes[1] == b'5' {
        // One white space, and the pixels behind it.
        let data = bytes.get(at + 1..).unwrap_or_default();
        let size = if white < 256 { 1 } else { 2 };
        if data.len() / size < width * height {
            return Err(short(data.len() / size));
        }
        ends(&data[size * width * height..], width * height)?;
        let mut bits = room(width, height)?;
        let values = data.chunks_exact(size).map(|v| v.iter().fold(0, |sum, &b| sum * 256 + usize::from(b)));
        fill(&mut bits, 0, values.take(width * height).map(shade), &mut set);
        return Ok(bits);
    }
    // Each pixel takes two bytes at least, but for the last one.
    if (bytes.len() - at).div_ceil(2) < width * height {
        return Err(short((bytes.len() - at).div_ceil(2)));
    }
    let mut bits = room(width, height)?;
    for i in 0..width * height {
        let word = word(bytes, &mut at);
        if word.is_empty() {
            return Err(short(i));
        }
        let value =
            word.parse().map_err(|_| fault(format!("pixel {i} is {:?}; it must be a number", excerpt(word))))?;
        fill(&mut bits, i, std::iter::once(shade(value)), &mut set);
    }
    let rest = word(bytes, &mut at);
    ends(rest.as_bytes(), width * height)?;
    Ok(bits)
}

/// Refuses what comes after the last pixel but white space: the header's sides are not those of the image, then.
fn ends(rest: &[u8], pixels: usize) -> Result<(), Fault> {
    match rest.trim_ascii() {
        [] => Ok(()),
        _ => Err(goes_on(pixels)),
    }
}

fn goes_on(pixels: usize) -> Fault {
    fault(format!("the image goes on after the {pixels} pixels that its header says"))
}

fn header(word: &str) -> Fault {
    let what =
        format!("not PGM: {:?} stands where the width, the height or the value of white must stand", excerpt(word));
    fault(what)
}

/// The next word, behind white space and comments; what is not ASCII is shown as `?`.
fn word<'a>(bytes: &'a [u8], at: &mut usize) -> &'a str {
    while let Some(&b) = bytes.get(*at) {
        if b == b'#' {
            *at += bytes[*at..].iter().take_while(|&&b| b != b'\n').count();
        } else if b.is_ascii_whitespace() {
            *at += 1;
        } else {
            break;
        }
    }
    let rest = &bytes[*at..];
    let length = rest.iter().take_while(|&&b| !b.is_ascii_whitespace() && b != b'#').count();
    *at += length;
    std::str::from_utf8(&rest[..length]).unwrap_or("?")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All pixels.
    fn pixels(bytes: &[u8]) -> Result<(usize, Vec<Pixel>), Fault> {
        let mut all = Vec::new();
        let is_dark = |p: Pixel| p.colours[0] < 1 << 15;
        let bits = parse(bytes, |p| {
            all.push(p);
            is_dark(p)
        })?;
        for (i, p) in all.iter().enumerate() {
            assert_eq!(bits.get(i % bits.width, i / bits.width), is_dark(*p));
        }
        assert_eq!(all.len(), bits.width * bits.height);
        Ok((bits.width, all))
    }

    fn grey(shade: u16) -> Pixel {
        Pixel::grey(shade * 257)
    }

    fn png_of(colour: png::ColorType, depth: png::BitDepth, width: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, 1);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn every_kind_of_image_gives_the_same_pixels() {
        let expected = (3, vec![grey(0), grey(205), grey(255)]);
        assert_eq!(pixels(b"P5 3 1 255\n\x00\xcd\xff").unwrap(), expected);
        assert_eq!(pixels(b"P5\n# CREATOR: map_saver\n3\n1 # size\n65535\n\0\0\xcd\xcd\xff\xff").unwrap(), expected);
        assert_eq!(pixels(b"P2\n3 1\n255\n0 205\n255").unwrap(), expected);
        use png::{BitDepth, ColorType};
        assert_eq!(pixels(&png_of(ColorType::Grayscale, BitDepth::Eight, 3, &[0, 205, 255])).unwrap(), expected);
        let rgb = [0, 0, 0, 205, 205, 205, 255, 255, 255];
        assert_eq!(pixels(&png_of(ColorType::Rgb, BitDepth::Eight, 3, &rgb)).unwrap(), expected);
        assert_eq!(pixels(&png_of(ColorType::Grayscale, BitDepth::One, 3, &[0b0110_0000])).unwrap().1[1], grey(255));
        let colours = pixels(&png_of(ColorType::Rgba, BitDepth::Eight, 1, &[30, 60, 90, 51])).unwrap().1;
        assert_eq!(colours, [Pixel { colours: [30, 60, 90].map(|c| c * 257), alpha: Some(51 * 257) }]);
        let deep = pixels(&png_of(ColorType::GrayscaleAlpha, BitDepth::Sixteen, 1, &[1, 2, 3, 4])).unwrap().1;
        assert_eq!(deep, [Pixel { colours: [258; 3], alpha: Some(772) }]);
        // A third of white, in steps of a seventh.
        assert_eq!(pixels(b"P2 2 1 7\n0 3").unwrap().1[1], Pixel::grey(28086));
    }

    #[test]
    fn claims_beyond_the_file_are_refused() {
        let fault = |bytes: &[u8]| pixels(bytes).unwrap_err().what;
        for magic in ["P5", "P2"] {
            let all = fault(format!("{magic} 30000 30000 255\n123").as_bytes());
            assert!(all.contains("of 900000000 pixels"), "{all}");
            let sides = fault(format!("{magic} 1000000000 1000000000 255\n").as_bytes());
            assert!(
                sides.starts_with("1000000000 x 1000000000 pixels; each side must have from 1 to 32768"),
                "{sides}"
            );
            assert!(fault(format!("{magic} 99999999999999999999 1 255\n").as_bytes()).starts_with("not PGM: "));
            assert!(fault(format!("{magic} 0 5 255\n").as_bytes()).starts_with("0 x 5 pixels; "));
            assert!(fault(format!("{magic} 3 1 0\n\0\0\0").as_bytes()).contains("white is 0"));
            assert!(fault(format!("{magic} 3 x 255\n").as_bytes()).contains("\"x\" stands where"));
        }
        assert_eq!(fault(b"P5 3 1 255\n\x00\xcd"), "the image ends after 2 of 3 pixels");
        assert_eq!(fault(b"P2 3 1 255\n0 205 "), "the image ends after 2 of 3 pixels");
        assert_eq!(pixels(b"P5 1 1 255\n\0\n").unwrap().1, pixels(b"P2 1 1 255 0 # all\n").unwrap().1);
        for more in [&b"P5 3 1 255\n\0\0\0\0"[..], b"P5 1 3 65535 \0\0\0\0\0\0 P5", b"P2 3 1 255\n0 205 255 0"] {
            assert_eq!(fault(more), "the image goes on after the 3 pixels that its header says");
        }
        assert_eq!(fault(b"P2 2 1 255\n0 -1"), "pixel 1 is \"-1\"; it must be a number");
        assert_eq!(fault(b"BM"), "neither PNG nor PGM; save the image as one of them");
        let mut huge = png_of(png::ColorType::Grayscale, png::BitDepth::Eight, 3, &[0, 205, 255]);
        let cut = huge.len() - 30;
        assert!(fault(&huge[..cut]).starts_with("not PNG: "));
        huge[16] = 0x3b;
        assert!(!fault(&huge).is_empty());
    }

    #[test]
    fn no_more_pixels_are_taken_than_the_header_says() {
        use png::{BitDepth, ColorType};
        // The header's height, and then its check sum, are made smaller.
        let cut = |mut png: Vec<u8>, height: u8| {
            png[23] = height;
            let crc =
                (0..256u32).map(|n| (0..8).fold(n, |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 }));
            let table: Vec<u32> = crc.collect();
            let sum = png[12..29].iter().fold(!0u32, |c, &b| table[((c ^ u32::from(b)) & 255) as usize] ^ (c >> 8));
            png[29..33].copy_from_slice(&(!sum).to_be_bytes());
            png
        };
        let image = |height: u32| {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, 7, height);
            encoder.set_color(ColorType::Grayscale);
            encoder.set_depth(BitDepth::Two);
            let data = (0..2 * height as u8).collect::<Vec<u8>>();
            encoder.write_header().unwrap().write_image_data(&data).unwrap();
            bytes
        };
        for height in [1, 2, 9] {
            assert_eq!(pixels(&image(height)).unwrap().1.len(), 7 * height as usize);
            assert_eq!(pixels(&cut(image(height), height as u8)).unwrap().1.len(), 7 * height as usize);
        }
        let e = pixels(&cut(image(9), 8)).unwrap_err().what;
        assert_eq!(e, "the image goes on after the 56 pixels that its header says");
        // Of 8 x 8 pixels the seven images have 1, 1, 1, 2, 2, 4 and 4 rows.
        let size = |width: u32, height: u32| {
            let mut info = png::Info::with_size(width, height);
            info.interlaced = true;
            info.color_type = ColorType::Grayscale;
            info.bit_depth = BitDepth::Eight;
            raw_size(&info)
        };
        assert_eq!((size(1, 1), size(8, 8)), (2, 64 + 15));
    }
}
