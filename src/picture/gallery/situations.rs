//! The situations. Their captions are claims, which the tests check.

use super::Situation;

impl Situation {
    /// All of them, from the plain to the strange.
    pub fn all() -> &'static [Situation] {
        ALL
    }
}

const ALL: &[Situation] = &[
    Situation {
        name: "wrap",
        title: "Wrap",
        caption: "When the free end crosses the ray of a wall end, the rope bends there, and that wall end is the \
                  pivot.",
        walls: &[[[4.0, -2.0], [4.0, 1.0]]],
        anchor: [0.0, 0.0],
        points: &[[2.0, 2.0], [5.0, 2.5], [7.0, 1.0], [7.0, -1.0]],
        steps: &[1, 2, 3],
    },
    Situation {
        name: "unwrap",
        title: "Unwrap",
        caption: "When the free end turns back over the dotted ray behind the pivot, the rope leaves it.",
        walls: &[[[4.0, -2.0], [4.0, 1.0]]],
        anchor: [0.0, 0.0],
        points: &[[2.0, 2.0], [5.0, 2.5], [7.0, -1.0], [7.0, 1.0], [6.0, 2.5]],
        steps: &[2, 3, 4],
    },
    Situation {
        name: "several-events",
        title: "Several events in one step",
        caption: "One long step wraps the rope round three wall ends, each from the pivot that the one before has \
                  become.",
        walls: &[[[2.0, -3.0], [2.0, 1.5]], [[4.0, -3.0], [4.0, 2.0]], [[6.0, -3.0], [6.0, 1.5]]],
        anchor: [0.0, 0.0],
        points: &[[1.0, 4.0], [8.0, 7.0], [8.0, -2.0]],
        steps: &[1, 2],
    },
    Situation {
        name: "wrap-and-unwrap",
        title: "Wrap and unwrap in one step",
        caption: "In its last step the free end frees the rope from the lower wall and wraps it round the upper one.",
        walls: &[[[3.0, -3.0], [3.0, 0.5]], [[6.0, 2.0], [6.0, 5.0]]],
        anchor: [0.0, 0.0],
        points: &[[2.0, 1.5], [4.5, 1.2], [8.0, -2.0], [8.0, 5.0]],
        steps: &[1, 2, 3],
    },
    Situation {
        name: "both-sides",
        title: "Both sides",
        caption: "Over one wall and under the next: the first wall end lies on the rope's right, the second on its \
                  left.",
        walls: &[[[3.0, -4.0], [3.0, 1.0]], [[6.0, -1.0], [6.0, 4.0]]],
        anchor: [0.0, 0.0],
        points: &[[2.0, 3.0], [4.5, 3.0], [4.5, -3.0], [8.0, -3.0], [8.0, 2.5]],
        steps: &[2, 3, 4],
    },
    Situation {
        name: "closed-obstacle",
        title: "A closed obstacle",
        caption: "The rope lies along the outside of the block and spans its notch without touching the inner corner.",
        walls: &[
            [[3.0, -1.0], [6.0, -1.0]],
            [[6.0, -1.0], [6.0, 0.2]],
            [[6.0, 0.2], [4.2, 0.2]],
            [[4.2, 0.2], [4.2, 1.5]],
            [[4.2, 1.5], [3.0, 1.5]],
            [[3.0, 1.5], [3.0, -1.0]],
        ],
        anchor: [0.0, 0.0],
        points: &[[1.5, 2.5], [7.0, 2.5], [7.5, -0.5], [7.0, -2.2], [4.0, -2.2]],
        steps: &[2, 4],
    },
    Situation {
        name: "friction",
        title: "Friction",
        caption: "Round both ends of the wall the rope turns by half a turn in all: with a friction of 0.5 the free \
                  end then pulls 4.81 times as hard as the anchor.",
        walls: &[[[4.0, 0.0], [4.0, 3.0]]],
        anchor: [0.0, 0.0],
        points: &[[2.0, -1.0], [6.0, -1.5], [6.0, 2.0], [5.5, 4.5], [0.0, 3.0]],
        steps: &[2, 3, 4],
    },
    Situation {
        name: "winding",
        title: "Winding several times",
        caption: "Twice round the block and on: the rope holds its corners once for each time, and their numbers \
                  tell how often.",
        walls: &[
            [[3.0, -1.0], [5.0, -1.0]],
            [[5.0, -1.0], [5.0, 1.0]],
            [[5.0, 1.0], [3.0, 1.0]],
            [[3.0, 1.0], [3.0, -1.0]],
        ],
        anchor: [0.0, 0.0],
        points: &[
            [1.6, 2.2],
            [6.4, 2.2],
            [6.4, -2.2],
            [1.6, -2.2],
            [1.6, 2.2],
            [6.4, 2.2],
            [6.4, -2.2],
            [1.6, -2.2],
            [1.6, 2.2],
            [6.4, 2.2],
        ],
        steps: &[2, 5, 9],
    },
    Situation {
        name: "doubling-back",
        title: "Doubling back",
        caption: "Wound round a lone wall that points at the anchor, the rope lies along the wall twice, out above \
                  it and back below.",
        walls: &[[[3.0, 0.0], [6.0, 0.0]]],
        anchor: [0.0, 0.0],
        points: &[[1.0, 1.2], [7.0, 1.2], [7.0, -1.2], [2.0, -1.2], [2.0, 1.2], [4.0, 1.8]],
        steps: &[2, 3, 5],
    },
    Situation {
        name: "passed-straight",
        title: "A contact passed straight",
        caption: "Three wall ends on one line with the anchor: the rope passes two of them straight, keeps them, and \
                  bends at the last.",
        walls: &[[[2.0, -2.0], [2.0, 0.0]], [[4.0, -2.0], [4.0, 0.0]], [[6.0, -2.0], [6.0, 0.0]]],
        anchor: [0.0, 0.0],
        points: &[[1.0, 1.5], [8.0, 1.5], [8.0, -1.5]],
        steps: &[1, 2],
    },
    Situation {
        name: "collinear-walls",
        title: "Walls on one line, on different sides",
        caption: "Wrapped round the far wall end the rope passes the near one straight, and when it leaves the far \
            one, the near one holds it: had it been forgotten, the rope would slip through its wall.",
        walls: &[[[2.0, -2.0], [2.0, 1.0]], [[4.0, 2.0], [4.0, 5.0]]],
        anchor: [0.0, 0.0],
        points: &[[1.0, 2.0], [3.0, 3.0], [3.0, -1.5], [6.0, 0.0], [6.0, 4.5], [6.0, 0.0]],
        steps: &[3, 4, 5],
    },
    Situation {
        name: "touching-a-corner",
        title: "Touching a corner",
        caption: "The free end rests on a wall's end and goes on over it: it counts as passing a hair off the wall, \
                  and the rope wraps.",
        walls: &[[[4.0, -2.0], [4.0, 1.0]]],
        anchor: [0.0, 0.0],
        points: &[[2.0, 2.0], [4.0, 1.0], [7.0, -1.0]],
        steps: &[0, 1, 2],
    },
    Situation {
        name: "sliding",
        title: "Sliding along a wall",
        caption: "The free end slides along a wall from end to end, which is no crossing, and the rope bends at both \
                  ends behind it.",
        walls: &[[[3.0, 2.0], [6.0, 1.0]]],
        anchor: [0.0, 0.0],
        points: &[[1.0, 3.0], [3.0, 2.0], [6.0, 1.0], [7.0, -1.5]],
        steps: &[1, 2, 3],
    },
    Situation {
        name: "touching-a-tip",
        title: "Straight over a tip",
        caption: "The step leads straight over a wall's end and passes it a hair off, on the side where the wall is \
            not.",
        walls: &[[[4.0, 1.0], [5.0, 3.0]]],
        anchor: [0.0, 3.0],
        points: &[[1.0, 1.0], [7.0, 1.0], [7.0, 2.5]],
        steps: &[0, 1, 2],
    },
    Situation {
        name: "touching-the-middle",
        title: "On the middle of a wall",
        caption: "The free end comes to the middle of a wall, slides along a part of it and leaves it on the side from \
                  which it came.",
        walls: &[[[3.0, -2.0], [3.0, 2.0]]],
        anchor: [0.0, 0.0],
        points: &[[1.0, 3.0], [5.0, 3.0], [3.0, 0.0], [3.0, 1.0], [6.0, 0.0]],
        steps: &[2, 3, 4],
    },
    Situation {
        name: "crossing-walls",
        title: "Walls that cross",
        caption: "A rope bends at ends of walls only: where two walls cross there is no corner that it could touch.",
        walls: &[[[3.0, -1.0], [6.0, 2.0]], [[3.0, 2.0], [6.0, -1.0]]],
        anchor: [0.0, 0.5],
        points: &[[1.5, 3.0], [7.5, 3.0], [7.5, 0.5]],
        steps: &[1, 2],
    },
    Situation {
        name: "same-place-other-rope",
        title: "Same place, other rope",
        caption: "Two ropes to one place: over the block, and then once round it; what counts is the way that the \
                  free end took.",
        walls: &[
            [[3.0, -1.0], [4.5, -1.0]],
            [[4.5, -1.0], [4.5, 1.0]],
            [[4.5, 1.0], [3.0, 1.0]],
            [[3.0, 1.0], [3.0, -1.0]],
        ],
        anchor: [0.0, 0.0],
        points: &[[1.6, 2.2], [6.5, 2.2], [6.5, 0.5], [6.5, -2.2], [1.6, -2.2], [1.6, 2.2], [6.5, 2.2], [6.5, 0.5]],
        steps: &[2, 4, 7],
    },
];
