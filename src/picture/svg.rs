//! Writes SVG: only what pictures here need, numbers short, the same bytes for the same picture.

use std::fmt::Write;

use crate::escape::escaped_lines;

/// An SVG document that is being written. Pixels count from the top left.
///
/// A `style` is a list of attributes as they stand in the file; it is always one of our own, never text from outside.
pub(super) struct Svg {
    out: String,
}

/// Where a text stands relative to its point.
#[derive(Clone, Copy)]
pub(super) enum Align {
    Start,
    Middle,
    End,
}

impl Svg {
    /// A document of that size on white ground, so that it can be read on any page; `title` is what a screen reader
    /// says.
    pub(super) fn new(width: f64, height: f64, title: &str) -> Self {
        let mut svg = Svg::blank([width, height], title, "fill=\"#333\"");
        svg.rect([0.0, 0.0], [width.ceil(), height.ceil()], "fill=\"#fff\"");
        svg
    }

    /// A document of that size without a ground; `style` holds for all that says nothing else.
    pub(super) fn blank(size: [f64; 2], title: &str, style: &str) -> Self {
        let [w, h] = size.map(|x| px(x.ceil()));
        let mut svg = Svg::part();
        let _ = write!(
            svg.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             role=\"img\" font-family=\"sans-serif\" font-size=\"12\" {style}>\n<title>{}</title>\n",
            escape(title)
        );
        svg
    }

    /// A part of a document, to be [added](Self::add) once it is known what stands before it.
    pub(super) fn part() -> Self {
        Svg { out: String::new() }
    }

    /// All that `part` holds.
    pub(super) fn add(&mut self, part: Svg) {
        self.out.push_str(&part.out);
    }

    /// Markup of our own that needs no other method.
    pub(super) fn raw(&mut self, markup: &str) {
        self.out.push_str(markup);
        self.out.push('\n');
    }

    /// The document.
    pub(super) fn finish(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }

    /// Opens an element that holds the next ones.
    pub(super) fn open(&mut self, tag: &str, style: &str) {
        let space = if style.is_empty() { "" } else { " " };
        let _ = writeln!(self.out, "<{tag}{space}{style}>");
    }

    /// Closes it.
    pub(super) fn close(&mut self, tag: &str) {
        let _ = writeln!(self.out, "</{tag}>");
    }

    /// A rectangle from its top left corner.
    pub(super) fn rect(&mut self, [x, y]: [f64; 2], size: [f64; 2], style: &str) {
        self.rect_named([x, y], size, style, "");
    }

    /// A rectangle that tells `name` to whoever points at it.
    pub(super) fn rect_named(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], style: &str, name: &str) {
        let (x, y, w, h) = (px(x), px(y), px(w), px(h));
        let _ = write!(self.out, "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" {style}");
        if name.is_empty() {
            self.out.push_str("/>\n");
        } else {
            let _ = writeln!(self.out, "><title>{}</title></rect>", escape(name));
        }
    }

    /// A straight line.
    pub(super) fn line(&mut self, a: [f64; 2], b: [f64; 2], style: &str) {
        self.path(&format!("M{} {}L{} {}", px(a[0]), px(a[1]), px(b[0]), px(b[1])), style);
    }

    /// Lines through all points; empty for fewer than two.
    pub(super) fn polyline(&mut self, points: &[[f64; 2]], style: &str) {
        if points.len() > 1 {
            self.path(&polyline(points), &format!("fill=\"none\" {style}"));
        }
    }

    /// A filled polygon.
    pub(super) fn polygon(&mut self, points: &[[f64; 2]], style: &str) {
        if points.len() > 2 {
            self.path(&format!("{}Z", polyline(points)), style);
        }
    }

    /// A path whose data is at hand.
    pub(super) fn path(&mut self, data: &str, style: &str) {
        if !data.is_empty() {
            let _ = writeln!(self.out, "<path d=\"{data}\" {style}/>");
        }
    }

    /// The element of that id once more, moved to `x` and `y`.
    pub(super) fn copy(&mut self, id: &str, [x, y]: [f64; 2]) {
        let _ = writeln!(self.out, "<use href=\"#{id}\" x=\"{}\" y=\"{}\"/>", px(x), px(y));
    }

    /// A circle.
    pub(super) fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: &str) {
        let _ = writeln!(self.out, "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {style}/>", px(x), px(y), px(radius));
    }

    /// A line of text on its base line.
    pub(super) fn text(&mut self, [x, y]: [f64; 2], align: Align, style: &str, text: &str) {
        let anchor = match align {
            Align::Start => "",
            Align::Middle => " text-anchor=\"middle\"",
            Align::End => " text-anchor=\"end\"",
        };
        let space = if style.is_empty() { "" } else { " " };
        let _ =
            writeln!(self.out, "<text x=\"{}\" y=\"{}\"{anchor}{space}{style}>{}</text>", px(x), px(y), escape(text));
    }
}

/// Path data of lines through `points`.
fn polyline(points: &[[f64; 2]]) -> String {
    let mut data = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        let _ = write!(data, "{}{} {}", if i == 0 { 'M' } else { 'L' }, px(*x), px(*y));
    }
    data
}

/// A number of pixels, to a tenth.
pub(super) fn px(x: f64) -> String {
    tenths((x * 10.0).round() as i64)
}

/// A tenth of a whole number, with no more digits than needed.
pub(super) fn tenths(n: i64) -> String {
    let sign = if n < 0 { "-" } else { "" };
    let (whole, rest) = (n.unsigned_abs() / 10, n.unsigned_abs() % 10);
    match (whole, rest) {
        (_, 0) => format!("{sign}{whole}"),
        (0, _) => format!("{sign}.{rest}"),
        _ => format!("{sign}{whole}.{rest}"),
    }
}

/// Text as it may stand between tags and in quotes, in XML and in HTML. What XML cannot hold at all becomes the
/// replacement character.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\u{FFFE}' | '\u{FFFF}' => out.push('\u{FFFD}'),
            c if c < ' ' && !matches!(c, '\t' | '\n' | '\r') => out.push('\u{FFFD}'),
            // What turns the direction of writing, and more, as terminals are shown it.
            c if c >= '\u{7f}' => out.push_str(&escaped_lines(c.encode_utf8(&mut [0; 4]))),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let written: Vec<String> = [0.0, -0.0, 0.04, -0.04, 0.25, -0.5, 10.0, -12.34, 719.96].map(px).into();
        assert_eq!(written, ["0", "0", "0", "0", ".3", "-.5", "10", "-12.3", "720"]);
    }

    #[test]
    fn text_cannot_leave_its_place() {
        assert_eq!(escape("a\u{9b}\u{7f}\u{202e}b"), r"a\u{9b}\u{7f}\u{202e}b");
        assert_eq!(escape("a<b>&\"c'\u{1}"), "a&lt;b&gt;&amp;&quot;c&#39;\u{FFFD}");
    }
}
