//! How a query's free end is dragged: straight, or along a shortest way from cell to cell.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::SQRT_2;

use glam::DVec2;

use super::{Query, middle};
use crate::scene::{GridMap, Model};

/// Where a query's free end goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// The points, from the middle of the start's cell to that of the goal's.
    pub points: Vec<DVec2>,
    /// Whether they go straight there: no wall is in the way.
    pub straight: bool,
    /// The length of a shortest way from cell to cell, in cells.
    pub octile: f64,
}

/// Plans drives on one map. Keeps its memory from query to query.
pub struct Driver<'a> {
    map: &'a GridMap,
    /// By cell: the length of the shortest way found, and the cell before it.
    found: Vec<(f64, u32)>,
    /// The cells that were found.
    touched: Vec<u32>,
}

impl<'a> Driver<'a> {
    /// A planner for `map`; O(cells) in memory.
    pub fn new(map: &'a GridMap) -> Self {
        Driver { map, found: vec![(f64::INFINITY, 0); map.width() * map.height()], touched: Vec::new() }
    }

    /// The drive of a query, whose rope `model` is tied at its start: straight where no wall is touched, else along a
    /// shortest way from cell to cell (A* with octile distances: Hart, Nilsson, Raphael, IEEE Trans. Syst. Sci. Cybern.
    /// 4, 1968). Diagonal moves need both cells beside them free. `None` if there is no way. O(cells log cells).
    pub fn drive(&mut self, query: &Query, model: &Model) -> Option<Drive> {
        let cells = self.search(query)?;
        let octile = length(&cells);
        let [start, goal] = query.ends();
        let straight = start == goal || model.is_clear(start, goal);
        let points = if straight { vec![start, goal] } else { cells.into_iter().map(middle).collect() };
        Some(Drive { points, straight, octile })
    }

    /// The cells of a shortest way.
    fn search(&mut self, query: &Query) -> Option<Vec<[usize; 2]>> {
        for cell in self.touched.drain(..) {
            self.found[cell as usize].0 = f64::INFINITY;
        }
        let width = self.map.width();
        let number = |[x, y]: [usize; 2]| (y * width + x) as u32;
        let place = |cell: u32| [cell as usize % width, cell as usize / width];
        let (start, goal) = (number(query.start), number(query.goal));
        // Of lengths that are not negative, the bits are in order.
        let mut open = BinaryHeap::from([Reverse((0u64, start))]);
        self.found[start as usize] = (0.0, start);
        self.touched.push(start);
        while let Some(Reverse((bound, cell))) = open.pop() {
            if cell == goal {
                let mut cells = vec![place(cell)];
                let mut cell = cell;
                while cell != start {
                    cell = self.found[cell as usize].1;
                    cells.push(place(cell));
                }
                cells.reverse();
                return Some(cells);
            }
            let so_far = self.found[cell as usize].0;
            if (so_far + octile(place(cell), query.goal)).to_bits() < bound {
                continue;
            }
            for (next, step) in moves(self.map, place(cell)) {
                let (next, length) = (number(next), so_far + step);
                if length < self.found[next as usize].0 {
                    if self.found[next as usize].0 == f64::INFINITY {
                        self.touched.push(next);
                    }
                    self.found[next as usize] = (length, cell);
                    open.push(Reverse(((length + octile(place(next), query.goal)).to_bits(), next)));
                }
            }
        }
        None
    }
}

/// Where one can go from a cell, and how far that is.
fn moves(map: &GridMap, [x, y]: [usize; 2]) -> impl Iterator<Item = ([usize; 2], f64)> {
    const AROUND: [[isize; 2]; 8] = [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];
    AROUND.into_iter().filter_map(move |[dx, dy]| {
        // What lies around the map is blocked: a column or row below 0 becomes one beyond the last.
        let [to_x, to_y] = [x.wrapping_add_signed(dx), y.wrapping_add_signed(dy)];
        let diagonal = dx != 0 && dy != 0;
        let beside = diagonal && (map.is_blocked(to_x, y) || map.is_blocked(x, to_y));
        let free = !map.is_blocked(to_x, to_y) && !beside;
        free.then_some(([to_x, to_y], if diagonal { SQRT_2 } else { 1.0 }))
    })
}

/// The octile distance of two cells: that of the shortest way if nothing were blocked.
fn octile(a: [usize; 2], b: [usize; 2]) -> f64 {
    let [dx, dy] = [0, 1].map(|axis| a[axis].abs_diff(b[axis]));
    dx.abs_diff(dy) as f64 + dx.min(dy) as f64 * SQRT_2
}

/// The length of a way from cell to cell, its straight and its diagonal moves counted and not summed up one by one.
fn length(cells: &[[usize; 2]]) -> f64 {
    let diagonal = cells.windows(2).filter(|w| w[0][0] != w[1][0] && w[0][1] != w[1][1]).count();
    (cells.len() - 1 - diagonal) as f64 + diagonal as f64 * SQRT_2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(rows: &[&str]) -> GridMap {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.map");
        let (height, width) = (rows.len(), rows[0].len());
        std::fs::write(&path, format!("type octile\nheight {height}\nwidth {width}\nmap\n{}\n", rows.join("\n")))
            .unwrap();
        GridMap::read(&path).unwrap()
    }

    fn drive(map: &GridMap, start: [usize; 2], goal: [usize; 2]) -> Option<Drive> {
        let query = Query { bucket: 0, start, goal, octile: 0.0 };
        let model = Model::new(map.scene().clone(), Some(middle(start))).unwrap();
        Driver::new(map).drive(&query, &model)
    }

    #[test]
    fn no_corner_is_cut() {
        let map = map(&["..", "@."]);
        let drive = drive(&map, [0, 0], [1, 1]).unwrap();
        assert_eq!(drive.octile, 2.0);
        // The straight way passes the corner itself.
        assert!(!drive.straight);
        assert_eq!(drive.points, [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5]].map(DVec2::from));
    }

    #[test]
    fn a_way_that_is_free_is_straight() {
        let map = map(&["....", "....", "@@@@"]);
        let drive = drive(&map, [0, 0], [3, 1]).unwrap();
        assert_eq!((drive.straight, drive.points.len(), drive.octile), (true, 2, 2.0 + SQRT_2));
    }

    #[test]
    fn where_there_is_no_way_there_is_no_drive() {
        let map = map(&[".@.", ".@."]);
        assert_eq!(drive(&map, [0, 0], [2, 0]), None);
        assert_eq!(drive(&map, [0, 0], [0, 0]).unwrap().octile, 0.0);
    }

    /// Against Bellman and Ford's plain method on random maps, one planner for all queries.
    #[test]
    fn ways_are_shortest() {
        let mut state = 5u64;
        let mut draw = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        let mut ways = 0;
        for _ in 0..20 {
            let rows: Vec<String> =
                (0..9).map(|_| (0..11).map(|_| if draw(3) == 0 { '@' } else { '.' }).collect()).collect();
            let map = map(&rows.iter().map(String::as_str).collect::<Vec<_>>());
            let mut driver = Driver::new(&map);
            let start = [draw(11) as usize, draw(9) as usize];
            if map.is_blocked(start[0], start[1]) {
                continue;
            }
            let mut lengths = vec![f64::INFINITY; 99];
            lengths[start[1] * 11 + start[0]] = 0.0;
            for _ in 0..99 {
                for cell in 0..99 {
                    let at = [cell % 11, cell / 11];
                    if map.is_blocked(at[0], at[1]) {
                        continue;
                    }
                    for ([x, y], step) in moves(&map, at) {
                        lengths[y * 11 + x] = lengths[y * 11 + x].min(lengths[cell] + step);
                    }
                }
            }
            let model = Model::new(map.scene().clone(), Some(middle(start))).unwrap();
            for (cell, &length) in lengths.iter().enumerate() {
                let goal = [cell % 11, cell / 11];
                if map.is_blocked(goal[0], goal[1]) {
                    continue;
                }
                let drive = driver.drive(&Query { bucket: 0, start, goal, octile: 0.0 }, &model);
                match drive {
                    None => assert_eq!(length, f64::INFINITY),
                    Some(drive) => {
                        assert!((drive.octile - length).abs() < 1e-9, "{start:?} {goal:?}");
                        assert!(
                            drive
                                .points
                                .iter()
                                .skip(1)
                                .zip(&drive.points)
                                .all(|(b, a)| a == b || model.is_clear(*a, *b))
                        );
                        ways += 1;
                    }
                }
            }
        }
        assert!(ways > 300, "{ways}");
    }
}
