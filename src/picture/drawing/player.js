'use strict';
const film = JSON.parse(document.getElementById('film').textContent);
const element = id => document.getElementById(id);
const { states, ropes } = film;
const first = states[0][0];
const last = Math.max(states[states.length - 1][0], first + 1);
const slider = element('time');
// A step takes 0.15 s, but the whole no less than 5 and no more than 60 s.
const seconds = Math.min(60, Math.max(5, 0.15 * (last - first)));

// The last state that is not later than `time`.
function stateAt(time) {
    let [low, high] = [0, states.length - 1];
    while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (states[middle][0] <= time) low = middle; else high = middle - 1;
    }
    return low;
}

let shownRope = -1;
function show(time) {
    const i = stateAt(time);
    const here = states[i];
    const next = states[Math.min(i + 1, states.length - 1)];
    const gone = next[0] > here[0] ? Math.min(1, (time - here[0]) / (next[0] - here[0])) : 0;
    const at = k => here[k] + (next[k] - here[k]) * gone;
    const [x, y] = [at(1), at(2)];
    const rope = ropes[here[3]];
    const corners = [film.anchor, ...rope, [x, y]].map(([x, y]) => `${x},${y}`).join(' ');
    element('halo').setAttribute('points', corners);
    element('rope').setAttribute('points', corners);
    element('free').setAttribute('cx', x);
    element('free').setAttribute('cy', y);
    if (here[3] !== shownRope) {
        shownRope = here[3];
        const of = kind => rope.filter(corner => corner[2] === kind);
        const round = ([x, y]) => `M${x - 3.7} ${y}a3.7 3.7 0 1 0 7.4 0a3.7 3.7 0 1 0 -7.4 0z`;
        const square = ([x, y]) => `M${x - 3.3} ${y - 3.3}h6.6v6.6h-6.6z`;
        element('left').setAttribute('d', of(1).map(round).join(''));
        element('right').setAttribute('d', of(2).map(square).join(''));
    }
    const turns = rope.filter(corner => corner[2] > 0).length;
    const step = Math.max(0, Math.min(film.steps, Math.ceil(time - 1e-9)));
    const length = Number(at(4).toPrecision(4));
    element('state').textContent =
        `step ${step} of ${film.stepsText}: ${turns} turn${turns === 1 ? '' : 's'}, ${length} long`;
    slider.value = time;
}

let playing = false;
let before = 0;
function play(on) {
    playing = on;
    element('play').textContent = on ? 'Pause' : 'Play';
    if (!on) return;
    before = performance.now();
    requestAnimationFrame(go);
}
function go(now) {
    if (!playing) return;
    const time = Number(slider.value) + Math.max(0, now - before) / 1000 * (last - first) / seconds;
    before = now;
    show(Math.min(time, last));
    if (time >= last) play(false); else requestAnimationFrame(go);
}

slider.min = first;
slider.max = last;
slider.addEventListener('input', () => { play(false); show(Number(slider.value)); });
element('play').addEventListener('click', () => {
    if (!playing && Number(slider.value) >= last) show(first);
    play(!playing);
});
document.querySelector('.player').hidden = false;
element('still').setAttribute('visibility', 'hidden');
element('moving').setAttribute('visibility', 'visible');
show(film.start === null ? first : film.start);
if (film.start === null && !matchMedia('(prefers-reduced-motion: reduce)').matches) play(true);
