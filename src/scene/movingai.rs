//! Scenes as MovingAI grid maps: the borders between free and blocked cells are the walls.

use std::path::Path;

use glam::DVec2;

use super::cells::{self, SIDE_MAX, borders};
use super::format::SceneFormat;
use super::{Scene, excerpt};
use crate::read_error::{Fault, Place, ReadError};
use crate::read_file::{SCENE_MAX, read_text};
use crate::words::plainly;

/// Grid maps of MovingAI.
pub(super) const FORMAT: SceneFormat = SceneFormat {
    extensions: &[".map"],
    files: "a MovingAI .map",
    anchor: "",
    read: |path, _| parse(&read_text(path, SCENE_MAX)?).map_err(|fault| fault.in_file(path)),
};

/// Reads a map in time linear in its cells.
///
/// Cell (column, row) is the unit square from (column, row) to (column + 1, row + 1), rows downwards as in the file.
/// The walls' order is that of [`borders`].
fn parse(text: &str) -> Result<Scene, Fault> {
    Grid::parse(text)?.scene()
}

/// A MovingAI grid map: which cells are blocked. Cell (column, row) is the unit square from (column, row) to
/// (column + 1, row + 1); rows are counted downwards as in the file.
#[derive(Debug, Clone)]
pub struct GridMap {
    width: usize,
    height: usize,
    /// Row by row.
    blocked: Vec<bool>,
    scene: Scene,
}

impl GridMap {
    /// Reads the map in `path`, in time and memory linear in its cells.
    ///
    /// # Errors
    ///
    /// A file that cannot be opened, and contents that are not a map, with their place.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let text = read_text(path, SCENE_MAX)?;
        let read = || {
            let grid = Grid::parse(&text)?;
            let (width, height) = (grid.width, grid.height());
            let blocked = (0..width * height).map(|cell| grid.blocked(cell % width, cell / width)).collect();
            Ok(GridMap { width, height, blocked, scene: grid.scene()? })
        };
        read().map_err(|fault: Fault| fault.in_file(path))
    }

    /// How many columns there are.
    pub fn width(&self) -> usize {
        self.width
    }

    /// How many rows there are.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Whether a cell is blocked; what lies around the map is.
    pub fn is_blocked(&self, column: usize, row: usize) -> bool {
        column >= self.width || row >= self.height || self.blocked[row * self.width + column]
    }

    /// The walls: the borders between blocked and free cells.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }
}

/// The cells: `rows[row][column]`, all rows `width` long, every character one that is known.
struct Grid<'a> {
    rows: Vec<&'a [u8]>,
    width: usize,
}

impl<'a> Grid<'a> {
    fn height(&self) -> usize {
        self.rows.len()
    }

    fn scene(&self) -> Result<Scene, Fault> {
        let blocked = |x, y| self.blocked(x, y);
        let walls = borders(self.width, self.height(), &blocked);
        let mut scene = cells::scene(walls, |[x, y]| DVec2::new(x as f64, y as f64), false)?.with_y_down();
        if scene.walls().is_empty() {
            let are = if self.blocked(0, 0) { "blocked" } else { "free" };
            scene.note(format!("all {} cells are {are}, so there are no walls", self.width * self.height()));
        }
        Ok(scene)
    }

    fn blocked(&self, column: usize, row: usize) -> bool {
        matches!(self.rows[row][column], b'@' | b'O' | b'T' | b'W')
    }

    fn parse(text: &'a str) -> Result<Self, Fault> {
        let mut lines = (1..).zip(text.lines());
        header(&mut lines, "type", "octile")?;
        let height = side(header(&mut lines, "height", "512")?, "height")?;
        let width = side(header(&mut lines, "width", "512")?, "width")?;
        header(&mut lines, "map", "")?;

        let mut rows = Vec::new();
        let mut next_line = 5;
        for (line, text) in lines {
            if rows.len() < height {
                rows.push(row(text, line, width)?);
            } else if !text.trim().is_empty() {
                let what = format!("a row after the last one; the header says height {height}");
                return Err(Fault::new(Place::line(line), what));
            }
            next_line = line + 1;
        }
        if rows.len() < height {
            let what = format!(
                "the file ends after {}; the header says height {height}",
                plainly(rows.len() as u64, "row", "rows")
            );
            return Err(Fault::new(Place::line(next_line), what));
        }
        Ok(Grid { rows, width })
    }
}

/// The rest of the next header line, which must start with `key`, and the line's number.
fn header<'a>(
    lines: &mut impl Iterator<Item = (u64, &'a str)>,
    key: &str,
    example: &str,
) -> Result<(u64, &'a str), Fault> {
    let right = format!("{key} {example}");
    let right = right.trim();
    let Some((line, text)) = lines.next() else {
        return Err(Fault::new(Place::default(), format!("the file ends where the line \"{right}\" must stand")));
    };
    let mut words = text.split_whitespace();
    let key_found = words.next() == Some(key);
    match (words.next(), words.next()) {
        (Some(value), None) if key_found && !example.is_empty() => Ok((line, value)),
        (None, None) if key_found && example.is_empty() => Ok((line, "")),
        _ => {
            let what = format!("{:?} stands where a line like {right:?} must stand", excerpt(text));
            Err(Fault::new(Place::line(line), what))
        }
    }
}

fn side((line, text): (u64, &str), name: &str) -> Result<usize, Fault> {
    text.parse().ok().filter(|side| (1..=SIDE_MAX).contains(side)).ok_or_else(|| {
        let what = format!("{name} {:?}; it must be a whole number from 1 to {SIDE_MAX}", excerpt(text));
        Fault::new(Place::line(line), what)
    })
}

fn row(text: &str, line: u64, width: usize) -> Result<&[u8], Fault> {
    let known = |b: u8| matches!(b, b'.' | b'G' | b'S' | b'@' | b'O' | b'T' | b'W');
    if let Some(column) = text.bytes().position(|b| !known(b)) {
        // Every character before it is one byte long, so this is the start of a character.
        let found = text[column..].chars().next().unwrap_or_default();
        let what = format!("{found:?} is no cell; free cells are . G S, blocked ones @ O T W");
        return Err(Fault::new(Place::line(line).then("column", column + 1), what));
    }
    if text.len() != width {
        let what = format!("a row of {}; the header says width {width}", plainly(text.len() as u64, "cell", "cells"));
        return Err(Fault::new(Place::line(line).then("column", text.len().min(width) + 1), what));
    }
    Ok(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(rows: &[&str]) -> String {
        let width = rows[0].len();
        format!("type octile\nheight {}\nwidth {width}\nmap\n{}\n", rows.len(), rows.join("\n"))
    }

    fn walls(text: &str) -> Vec<[f64; 4]> {
        let scene = parse(text).unwrap();
        (0..scene.walls().len()).map(|w| scene.ends(w)).map(|[u, v]| [u.x, u.y, v.x, v.y]).collect()
    }

    fn fault(text: &str) -> String {
        let fault = parse(text).unwrap_err();
        format!("{}: {}", fault.place, fault.what)
    }

    #[test]
    fn a_block_has_four_walls_in_order() {
        let expected = [[1., 1., 3., 1.], [1., 3., 3., 3.], [1., 1., 1., 3.], [3., 1., 3., 3.]];
        let text = map(&["....", ".@T.", ".OW.", ".GS."]);
        assert_eq!(walls(&text), expected);
        assert_eq!(walls(&text.replace('\n', "\r\n")), expected);
        assert_eq!(walls(text.trim_end()), expected);
        assert_eq!(walls(&(text + "\n  \n\r\n")), expected);
    }

    #[test]
    fn the_outer_edge_is_no_wall() {
        for (row, are) in [("@@", "blocked"), ("..", "free")] {
            let scene = parse(&map(&[row, row])).unwrap();
            assert!(scene.walls().is_empty());
            assert_eq!(scene.notes(), [format!("all 4 cells are {are}, so there are no walls")]);
        }
        assert!(parse(&map(&["@."])).unwrap().notes().is_empty());
        assert_eq!(walls(&map(&["@."])), [[1., 0., 1., 1.]]);
        assert_eq!(walls(&map(&["@@@", "...", "..."])), [[0., 1., 3., 1.]]);
    }

    #[test]
    fn all_four_borders_end_at_a_pinch() {
        let expected = [[0., 1., 1., 1.], [1., 1., 2., 1.], [1., 0., 1., 1.], [1., 1., 1., 2.]];
        assert_eq!(walls(&map(&["@.", ".@"])), expected);
    }

    #[test]
    fn runs_equal_unit_borders_merged_one_by_one() {
        let mut state = 7u64;
        for _ in 0..200 {
            let rows: Vec<String> = (0..7)
                .map(|_| {
                    (0..9)
                        .map(|_| {
                            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                            if state >> 63 == 0 { '.' } else { '@' }
                        })
                        .collect()
                })
                .collect();
            let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
            let cell = |x: usize, y: usize| rows[y].as_bytes()[x];
            let found = walls(&map(&rows));
            let mut units = 0;
            for y in 1..7 {
                units += (0..9).filter(|&x| cell(x, y - 1) != cell(x, y)).count();
            }
            for x in 1..9 {
                units += (0..7).filter(|&y| cell(x - 1, y) != cell(x, y)).count();
            }
            let length: f64 = found.iter().map(|[a, b, c, d]| (c - a) + (d - b)).sum();
            assert_eq!(length, units as f64);
            for [a, b, c, d] in &found {
                for [e, f, g, h] in &found {
                    let ends_inside = |x: &f64, y: &f64| (a < x && x < c && b == y) || (b < y && y < d && a == x);
                    assert!(!ends_inside(e, f) && !ends_inside(g, h), "{rows:?}");
                    let straight_on = [c, d] == [e, f] && (a == e) == (c == g) && (b == f) == (d == h);
                    let crossed = || found.iter().filter(|w| w[..2] == [*c, *d] || w[2..] == [*c, *d]).count() == 4;
                    assert!(!straight_on || crossed(), "{rows:?}");
                }
            }
        }
    }

    #[test]
    fn faults_name_line_and_column() {
        let ok = map(&["..", ".@"]);
        let cell = "is no cell; free cells are . G S, blocked ones @ O T W";
        let sides = "it must be a whole number from 1 to 32768";
        for (text, expected) in [
            ("".into(), ": the file ends where the line \"type octile\" must stand".into()),
            ("type octile\nheight 2\n".into(), ": the file ends where the line \"width 512\" must stand".into()),
            ("{}".into(), "line 1: \"{}\" stands where a line like \"type octile\" must stand".into()),
            (
                ok.replace("type octile\n", ""),
                "line 1: \"height 2\" stands where a line like \"type octile\" must stand".into(),
            ),
            (ok.replace("map", "map 3"), "line 4: \"map 3\" stands where a line like \"map\" must stand".into()),
            (
                ok.replace("width 2", "width"),
                "line 3: \"width\" stands where a line like \"width 512\" must stand".into(),
            ),
            (ok.replace("width 2", "width 0"), format!("line 3: width \"0\"; {sides}")),
            (
                ok.replace("height 2", "height 99999999999999999999"),
                format!("line 2: height \"99999999999999999999\"; {sides}"),
            ),
            (ok.replace("height 2", "height -2"), format!("line 2: height \"-2\"; {sides}")),
            (ok.replace("height 2", "height 3"), "line 7: the file ends after 2 rows; the header says height 3".into()),
            (ok.replace("height 2", "height 1"), "line 6: a row after the last one; the header says height 1".into()),
            (ok.replace("width 2", "width 3"), "line 5, column 3: a row of 2 cells; the header says width 3".into()),
            (ok.replace("width 2", "width 1"), "line 5, column 2: a row of 2 cells; the header says width 1".into()),
            (ok.replace("..", ".x"), format!("line 5, column 2: 'x' {cell}")),
            (ok.replace(".@", "é@"), format!("line 6, column 1: 'é' {cell}")),
            (ok.replace(".@", ". "), format!("line 6, column 2: ' ' {cell}")),
        ] {
            assert_eq!(fault(&text), expected);
        }
        assert!(fault(&"x".repeat(1000)).len() < 150);
    }
}
