"""Put robots that differ to x = 3 mm: a coarse controller walks there, a fine one gives pulses.

``python controllers.py`` makes the tables of both from 64 robots and judges them on 256 others.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip import STATE_COLUMNS, Scenario, rollout
from stickslip.control import Camera, Film

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

PRIORS = {  # of friction, adhesion and drag
    "contact.kinetic_friction": {"mean": 0.145, "sd": 0.01},
    "contact.static_friction": {"mean": 0.2, "sd": 0.014},
    "contact.adhesion": {"mean": 0.22e-6, "sd": 0.03e-6},
    "drag.linear": {"low": 3e-6, "high": 3e-5},
    "drag.rotational": {"median": 9e-17, "factor": 2.0},
}
GOAL, TOLERANCE = 3e-3, 2e-6  # m
LIMIT = 30.0  # s; a robot that is not there by then has failed
STEP, WINDOW = 1e-3, 20  # s; steps from one decision to the next
PERIOD = STEP * WINDOW
REST, CLAMP = 13.0, -10.0  # V, of xp and the clamp while a robot stands
EXACT = Camera(frame_rate=1000.0)
CAMERA = Camera(frame_rate=30.0, latency=0.05, noise_x=3e-6)
X, THETA = STATE_COLUMNS.index("x"), STATE_COLUMNS.index("theta")


def drawn(count: int, seed: int) -> list[Scenario]:
    """Robots with their own friction, adhesion and drag."""
    return Scenario(uncertain=PRIORS).draws(count, seed)


def play(robots: Sequence[Scenario], states: Array | None, xp: Array) -> Array:
    """States after each step, (n, steps, columns), under voltages of xp, (n, steps)."""
    volts = np.zeros((len(robots), xp.shape[-1], 5))
    volts[:, :, 0], volts[:, :, 4] = xp, CLAMP
    return rollout(robots, states, volts, STEP, hold="linear", record=STATE_COLUMNS).states


def standing(robots: Sequence[Scenario]) -> Array:
    """States of robots that have stood up, (n, columns)."""
    return play(robots, None, np.full(150, REST))[:, -1]


def teeth(heights: Array, steps: int) -> Array:
    """Pulses, (n, steps): a slow fall and a sudden rise, or the reverse for heights < 0."""
    slope = np.arange(1, steps) / (steps - 1)
    slopes = np.where(heights[:, None] > 0.0, slope, slope[::-1])
    xp = np.full((len(heights), steps), REST)
    xp[:, :-1] -= np.abs(heights)[:, None] * slopes
    return xp


HEIGHTS = np.arange(5.0, 21.0)  # V
PULSES = (1, 2, 4)  # in a window: 50, 100 and 200 Hz
HORIZON = 0.1  # s; an image is up to 83 ms old, and a decision holds for 20 ms


@dataclass(frozen=True)
class Coarse:
    """What pulses of some heights and frequencies do."""

    xp: Array  # V, (k, WINDOW)
    low: Array  # speed that 90 % of the robots exceed, m/s, (k,)
    median: Array
    high: Array  # speed that 10 % exceed
    coast: Array  # from the end of the last pulse to rest, m; below 0: it swings back

    @staticmethod
    def simulated(robots: Sequence[Scenario]) -> Coarse:
        """The table of all heights and frequencies."""
        xp = np.concatenate([np.tile(teeth(HEIGHTS, WINDOW // n), n) for n in PULSES])
        start, speeds, coasts = standing(robots), [], []
        for each in xp:
            x = play(robots, start, np.append(np.tile(each, 10), np.full(100, REST)))[:, :, X]
            before, end = x[:, 4 * WINDOW - 1], x[:, 10 * WINDOW - 1]
            speeds.append((end - before) / (6 * PERIOD))
            coasts.append(x[:, -1] - end)
        low, median, high = np.quantile(speeds, [0.1, 0.5, 0.9], axis=1)
        return Coarse(xp, low, median, high, np.median(coasts, axis=1))

    @property
    def slowest(self) -> np.intp:
        """The pulses for the last steps."""
        return np.argmin(self.high)

    def choose(self, distance: Array) -> NDArray[np.intp]:
        """Of pulses that take almost no robot beyond the goal soon, the surely fastest."""
        allowed = self.high * HORIZON + self.coast <= distance[:, None]
        allowed[:, self.slowest] = True
        return np.argmax(np.where(allowed, self.low, -np.inf), axis=1)


SINGLE = np.concatenate([np.arange(-16.0, -4.5, 0.5), np.arange(2.5, 11.5, 0.5)])  # V
BEHIND = 5e-6  # m; so far behind the goal goes a step back: steps forward are surer
SETTLE = 0.06  # s after a pulse, until what still rocks is below 0.1 um
ENOUGH, SURE = 1e-6, 0.6e-6  # m; done is a mean of images so near, with this standard deviation


@dataclass(frozen=True)
class Fine:
    """What single pulses from rest do."""

    heights: Array  # V, ascending, (k,)
    steps: Array  # median over the robots, m

    @staticmethod
    def simulated(robots: Sequence[Scenario]) -> Fine:
        """The table of all heights."""
        start, steps = standing(robots), []
        for pulse in teeth(SINGLE, WINDOW):
            rested = np.append(pulse, np.full(100, REST))
            steps.append(play(robots, start, rested)[:, -1, X] - start[:, X])
        return Fine(SINGLE, np.median(steps, axis=1))

    def choose(self, wanted: Array) -> Array:
        """Pulses, (n, WINDOW), whose steps are as wanted (m), or the longest there are."""
        return teeth(np.interp(wanted, self.steps, self.heights), WINDOW)


class FineControl:
    """Looks at robots at rest until a mean of images says enough, and gives pulses."""

    def __init__(self, table: Fine, camera: Camera, count: int) -> None:
        self._table, self._noise = table, camera.noise_x
        self._sum, self._images = np.zeros(count), np.zeros(count)
        self._before, self._scale = np.zeros(count), np.ones(count)
        self.pulses = np.zeros(count, dtype=np.int64)

    def decide(self, looks: Mask, seen: Array) -> tuple[Mask, Mask, Array]:
        """Who is there, who is pushed, and by what, from new images (m) of some robots."""
        self._sum[looks] += seen[looks]
        self._images[looks] += 1
        images = np.maximum(self._images, 1)
        off, sd = GOAL - self._sum / images, self._noise / np.sqrt(images)
        pushed = looks & (np.abs(off) > ENOUGH + np.where(sd > SURE, 3.0 * sd, 0.0))
        # How far the last pulse forward came says what to ask of the next, within bounds.
        came = np.maximum(self._before - off, 1e-9)
        learned = pushed & (self._before > 0.0)
        self._scale[learned] *= np.clip(self._before / came, 2 / 3, 3 / 2)[learned]
        self._before[pushed] = off[pushed]
        self._sum[pushed] = self._images[pushed] = 0
        self.pulses[pushed] += 1
        wanted = np.where(off > 0.0, self._scale * off, off - BEHIND)
        return looks & ~pushed & (sd <= SURE), pushed, self._table.choose(wanted[pushed])


@dataclass
class Outcome:
    """When robots were done, s (NaN: never), and how far beyond the goal they are then, m."""

    time: Array
    error: Array
    pulses: NDArray[np.int64]  # single ones

    @property
    def within(self) -> float:
        """Share of robots that are done, and within the tolerance."""
        return float(np.mean(np.isfinite(self.time) & (np.abs(self.error) <= TOLERANCE)))


def put(
    robots: Sequence[Scenario], camera: Camera, coarse: Coarse, fine: Fine | None = None
) -> Outcome:
    """Put robots to the goal by what a camera shows; without `fine` by the coarse controller."""
    random, n = np.random.default_rng(0), len(robots)
    states = standing(robots)
    film = Film(camera, STEP, states[:, [X, THETA]])
    control = None if fine is None else FineControl(fine, camera, n)
    slow = coarse.slowest
    near = PERIOD * coarse.median[slow] / 2 if fine is None else fine.steps[-1]
    near += coarse.coast[slow]
    way = [np.zeros(n)]  # after each step, by the table
    walks, still_from, done_at = np.ones(n, dtype=bool), np.zeros(n), np.full(n, np.nan)
    time = last = 0.0
    while np.isnan(done_at).any() and time < LIMIT:
        seen, taken = film.pose[:, 0], film.taken
        xp, onward = np.full((n, WINDOW), REST), np.zeros(n)
        # Where a robot is now: the newest image, and the way since then by the table.
        distance = GOAL - seen - (way[-1] - way[round(taken / STEP)])
        walks &= distance > near
        choice = coarse.choose(distance[walks])
        xp[walks], onward[walks] = coarse.xp[choice], STEP * coarse.median[choice]
        still_from[walks] = time + PERIOD + SETTLE
        there = ~walks & np.isnan(done_at)
        if control is not None:
            looks = there & (taken > last) & (taken >= still_from)
            there, pushed, pulses = control.decide(looks, seen)
            xp[pushed] = pulses
            still_from[pushed] = time + PERIOD + SETTLE
        done_at[there] = time
        last = taken
        found = play(robots, states, xp)
        states = found[:, -1]
        for poses in found[:, :, [X, THETA]].swapaxes(0, 1):
            time += STEP
            way.append(way[-1] + onward)
            film.watch(time, poses, random)
    error = play(robots, states, np.full(100, REST))[:, -1, X] - GOAL
    return Outcome(done_at, error, np.zeros(n, int) if control is None else control.pulses)


def judged(robots: Sequence[Scenario], coarse: Coarse, fine: Fine) -> dict[str, Outcome]:
    """Both controllers, by the exact state and by a camera."""
    return {
        "exact state, coarse": put(robots, EXACT, coarse),
        "exact state, coarse and fine": put(robots, EXACT, coarse, fine),
        "camera, coarse": put(robots, CAMERA, coarse),
        "camera, coarse and fine": put(robots, CAMERA, coarse, fine),
    }


def main() -> None:
    """Make the tables, and print what the controllers reach."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=256)
    count = parser.parse_args().robots
    learned = drawn(64, seed=1)
    coarse, fine = Coarse.simulated(learned), Fine.simulated(learned)
    print("| by | time, s | 90 % | error, um | 90 % | within 2 um | single pulses |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, each in judged(drawn(count, seed=2), coarse, fine).items():
        time = np.quantile(np.nan_to_num(each.time, nan=np.inf), [0.5, 0.9], method="higher")
        error = 1e6 * np.quantile(np.abs(each.error), [0.5, 0.9])
        numbers = " | ".join(f"{number:.1f}" for number in (*time, *error))
        pulses = np.median(each.pulses)
        print(f"| {name} | {numbers} | {100 * each.within:.1f} % | {pulses:.0f} |")


if __name__ == "__main__":
    main()
