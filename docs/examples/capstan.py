"""Six pins in MuJoCo: a chain of beads that slips round them, beside what tautrope says of the same rope.

    pip install tautrope mujoco==3.3.7
    python docs/examples/capstan.py

A chain of beads, joined by stiff springs, lies round six round pins on alternate sides. A constant force pulls its first
bead; its last one is moved at a constant pace, away from the pins (the free end hauls) or towards them (it holds). The
tensions are those of the springs of the first and of the last leg, on average while all of the chain slips; the forces
on the pins are those of all contacts. For tautrope the pins are polygons of as many corners as SIDES says, through which
the beads' middles go.

Exits with 1 if anything is further off than the bounds at the end.
"""

import math
import sys

import mujoco
import numpy as np
import tautrope

PINS = [(1.0, 0.35), (2.0, -0.25), (3.0, 0.45), (4.0, -0.45), (5.0, 0.3), (6.0, -0.2)]
# Which way the rope turns at each: clockwise (-1) over the first, counter-clockwise under the second.
WAYS = [-1, 1, -1, 1, -1, 1]
ANCHOR, FREE = (0.0, 0.0), (7.0, 0.5)
# How far the middles of beads are from those of pins, how large beads are, and how far one is from the next.
RADIUS, BEAD, SPACING = 0.25, 0.02, 0.04
STIFFNESS, MASS, PACE, HAUL, STEP = 1e4, 1e-3, 0.05, 0.5, 1e-4
SIDES = 64


def way(radius: float) -> np.ndarray:
    """The way round all pins at that distance: tangents and arcs, with a point every hundredth or so."""
    middles = np.array([ANCHOR, *PINS, FREE])
    radii = np.array([0.0, *(radius * np.array(WAYS)), 0.0])
    legs = []
    for i in range(len(middles) - 1):
        x, y = middles[i + 1] - middles[i]
        legs.append(math.atan2(y, x) - math.asin((radii[i + 1] - radii[i]) / math.hypot(x, y)))
    points = [np.array(ANCHOR)]
    for i, turns in enumerate(WAYS, start=1):
        turn = (legs[i] - legs[i - 1] + math.pi) % (2 * math.pi) - math.pi
        assert turn * turns > 0, "the rope does not touch this pin"
        for heading in np.linspace(legs[i - 1], legs[i - 1] + turn, max(2, int(abs(turn) / 0.01))):
            points.append(middles[i] + radii[i] * np.array([math.sin(heading), -math.cos(heading)]))
    return np.array([*points, np.array(FREE)])


def ropes(friction: float, holds: bool) -> tuple[float, float, np.ndarray]:
    """Of the rope as tautrope sees it: all turns, the tension at the free end, and the force on each pin."""
    angles = np.arange(SIDES) * 2 * math.pi / SIDES
    corners = [np.array(pin) + RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1) for pin in PINS]
    walls = np.concatenate([np.stack([pin, np.roll(pin, -1, axis=0)], axis=1) for pin in corners])
    rope = tautrope.Scene(walls, anchor=ANCHOR).evaluate([way(RADIUS + 0.05)], friction=friction)
    turned, tension = (float(rope.steps[name][-1]) for name in ("turned", "tension"))
    forces = rope.forces(0, friction=friction, holds=holds)
    at = np.stack([forces["x"], forces["y"]], axis=1)
    pin = np.linalg.norm(at[:, None] - np.array(PINS)[None], axis=2).argmin(axis=1)
    force = np.stack([forces["force_x"], forces["force_y"]], axis=1)
    on_pins = np.array([force[pin == i].sum(axis=0) for i in range(len(PINS))])
    return turned, 1 / tension if holds else tension, on_pins


def chain(friction: float) -> tuple[mujoco.MjModel, float, list[int]]:
    """The chain, how long its springs are without a force, and of which pin each geom is (-1 for beads)."""
    path = way(RADIUS)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    count = int(along[-1] / SPACING)
    spacing = along[-1] / count
    places = np.stack([np.interp(np.arange(count + 1) * spacing, along, path[:, axis]) for axis in (0, 1)], axis=1)
    # MuJoCo's contacts are as soft as the bodies are light: by default these beads would sink into the pins.
    touch = f'friction="{friction} 0 0" condim="3" solref="0.002 1" solimp="0.95 0.99 0.0001"'
    pins = [
        f'<geom type="cylinder" size="{RADIUS - BEAD} 0.5" pos="{x} {y} 0" contype="1" conaffinity="2" {touch}/>'
        for x, y in PINS
    ]
    beads = []
    for i, (x, y) in enumerate(places):
        if i in (0, count):
            # The ends move along their legs alone.
            dx, dy = path[1] - path[0] if i == 0 else path[-1] - path[-2]
            joints = f'<joint name="end {i}" type="slide" axis="{dx} {dy} 0"/>'
        else:
            joints = "".join(f'<joint type="slide" axis="{axis}" damping="2e-5"/>' for axis in ("1 0 0", "0 1 0"))
        geom = f'<geom type="sphere" size="{BEAD}" mass="{MASS}" contype="2" conaffinity="1" {touch}/>'
        beads.append(f'<body pos="{x} {y} 0">{joints}{geom}<site name="{i}"/></body>')
    rest = spacing - 1 / STIFFNESS
    spring = f'stiffness="{STIFFNESS}" damping="2" springlength="{rest}"'
    springs = [f'<spatial {spring}><site site="{i}"/><site site="{i + 1}"/></spatial>' for i in range(count)]
    text = f"""<mujoco><option timestep="{STEP}" gravity="0 0 0" cone="elliptic" impratio="10" integrator="implicitfast"/>
        <worldbody>{"".join(pins)}{"".join(beads)}</worldbody><tendon>{"".join(springs)}</tendon>
        <actuator><motor joint="end 0"/><position joint="end {count}" kp="20000" kv="60"/></actuator></mujoco>"""
    return mujoco.MjModel.from_xml_string(text), rest, list(range(len(PINS))) + [-1] * (count + 1)


def slipped(friction: float, holds: bool) -> tuple[float, float, np.ndarray]:
    """Of the chain as it slips: the tension in its first leg, that in its last one, and the force on each pin."""
    model, rest, pin_of = chain(friction)
    data = mujoco.MjData(model)
    steps = int(HAUL / PACE / STEP)
    speeding = 0.3 * steps
    ends, forces, looks = [], np.zeros((len(PINS), 2)), 0
    contact = np.zeros(6)
    for i in range(steps):
        gone = i * i / (2 * speeding) if i < speeding else i - speeding / 2
        data.ctrl[:] = -1.0, (-PACE if holds else PACE) * STEP * gone
        mujoco.mj_step(model, data)
        if i > 0.65 * steps and i % 20 == 0:
            tension = STIFFNESS * (data.ten_length - rest)
            ends.append((tension[:10].mean(), tension[-10:].mean()))
            looks += 1
            for c in range(data.ncon):
                mujoco.mj_contactForce(model, data, c, contact)
                found = data.contact[c]
                # The force is the one on the second geom.
                geom, sign = (found.geom1, -1) if pin_of[found.geom1] >= 0 else (found.geom2, 1)
                forces[pin_of[geom]] += sign * (found.frame.reshape(3, 3).T @ contact[:3])[:2]
    first, last = np.mean(ends, axis=0)
    return first, last, forces / looks


def main() -> None:
    print(f"MuJoCo {mujoco.__version__}, tautrope {tautrope.__version__}")
    print("friction  free end  turned  tension: tautrope  MuJoCo     off  most off of the forces on pins")
    worst = {"none": 0.0, "some": 0.0}
    for friction, holds in ((0.0, False), (0.1, False), (0.2, False), (0.2, True)):
        turned, expected, on_pins = ropes(friction, holds)
        first, last, forces = slipped(friction, holds)
        off = last / first / expected - 1
        # Of the tension with which the rope presses on a pin.
        sizes = np.linalg.norm(on_pins, axis=1)
        forces_off = (np.linalg.norm(forces / first - on_pins, axis=1) / sizes).max()
        print(
            f"{friction:8.1f}  {'holds' if holds else 'hauls':8}  {turned:6.3f}  {expected:17.4f}  {last / first:6.4f}  "
            f"{100 * off:+6.2f} %  {100 * forces_off:.2f} %",
            flush=True,
        )
        kind = "some" if friction else "none"
        worst[kind] = max(worst[kind], abs(off), forces_off)
    sys.exit(int(worst["none"] > 0.01 or worst["some"] > 0.02))


if __name__ == "__main__":
    main()
