//! A floor plan of 24 rooms on two corridors, with doors and pillars.

use glam::DVec2;

use crate::scene::Scene;

/// The sides of a room, in metres.
const ROOM: f64 = 8.0;
/// The corridors' width.
const CORRIDOR: f64 = 3.0;
/// Rooms side by side.
const COLUMNS: usize = 6;
/// The doors' width.
const DOOR: f64 = 1.1;
/// Where the four rows of rooms start; corridors lie between the first two and between the last two.
const ROWS: [f64; 4] = [0.0, ROOM + CORRIDOR, 2.0 * ROOM + CORRIDOR, 3.0 * ROOM + 2.0 * CORRIDOR];

/// The floor plan, in metres: 48 by 38, the origin in its south-west corner, the anchor in the southern corridor.
///
/// ```
/// let plan = tautline::example::floor_plan();
/// assert!(plan.walls().len() > 300);
/// assert!(plan.anchor().is_some());
/// ```
pub fn floor_plan() -> Scene {
    let mut plan = Plan::default();
    let (width, height) = (COLUMNS as f64 * ROOM, ROWS[3] + ROOM);
    // The outer walls, with an entrance at either end of both corridors.
    plan.wall([0.0, 0.0], [width, 0.0], &[]);
    plan.wall([0.0, height], [width, height], &[]);
    let entrances = [ROOM + CORRIDOR / 2.0, height - ROOM - CORRIDOR / 2.0];
    plan.wall([0.0, 0.0], [0.0, height], &entrances);
    plan.wall([width, 0.0], [width, height], &entrances);
    for (row, &south) in ROWS.iter().enumerate() {
        for column in 0..COLUMNS {
            let west = column as f64 * ROOM;
            // Doors and furniture shift from room to room, so that no two rooms are alike.
            let shift = |k: usize| 0.2 + 0.6 * ((7 * row + 5 * column + 3 * k) % 11) as f64 / 10.0;
            // The door to the corridor, and for the two middle rows, which lie back to back, one between them.
            let to_corridor = if row % 2 == 0 { south + ROOM } else { south };
            plan.wall([west, to_corridor], [west + ROOM, to_corridor], &[west + ROOM * shift(0)]);
            if row == 1 && column % 2 == 0 {
                plan.wall([west, south + ROOM], [west + ROOM, south + ROOM], &[west + ROOM * shift(1)]);
            } else if row == 1 {
                plan.wall([west, south + ROOM], [west + ROOM, south + ROOM], &[]);
            }
            // The wall to the next room, every other one with a door.
            if column + 1 < COLUMNS {
                let doors = if (row + column) % 2 == 0 { vec![south + ROOM * shift(2)] } else { vec![] };
                plan.wall([west + ROOM, south], [west + ROOM, south + ROOM], &doors);
            }
            plan.pillar([west + ROOM * shift(3), south + 2.6], 0.35, 4 + 2 * (column % 3));
            plan.pillar([west + ROOM * shift(4), south + 5.4], 0.25, 8 - 2 * (row % 3));
        }
    }
    for corridor in entrances {
        for k in 0..COLUMNS {
            plan.pillar([k as f64 * ROOM + 4.4, corridor + 0.4], 0.2, 6);
        }
    }
    let scene = Scene::new(plan.walls).expect("the plan's coordinates are small numbers");
    scene.with_anchor(DVec2::new(24.3, ROOM + 1.2))
}

#[derive(Default)]
struct Plan {
    walls: Vec<[DVec2; 2]>,
}

impl Plan {
    /// A wall along x or y, with doors centred at the given x or y.
    fn wall(&mut self, from: [f64; 2], to: [f64; 2], doors: &[f64]) {
        let (from, to) = (DVec2::from(from), DVec2::from(to));
        let along = (to - from).normalize();
        let mut start = from;
        for &door in doors {
            let centre = DVec2::select(along.cmpgt(DVec2::splat(0.5)), DVec2::splat(door), from);
            self.walls.push([start, centre - along * DOOR / 2.0]);
            start = centre + along * DOOR / 2.0;
        }
        self.walls.push([start, to]);
    }

    /// A pillar: a regular polygon about `centre`.
    fn pillar(&mut self, centre: [f64; 2], radius: f64, corners: usize) {
        let corner = |k: usize| {
            let turn = (k as f64 + 0.5) / corners as f64 * std::f64::consts::TAU;
            DVec2::from(centre) + radius * DVec2::from_angle(turn)
        };
        self.walls.extend((0..corners).map(|k| [corner(k), corner((k + 1) % corners)]));
    }
}
