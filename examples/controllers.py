"""Put robots that differ to x = 3 mm by what a camera shows, and judge that on others.

``python controllers.py`` simulates 64 robots and tabulates what pulses do. Far from the goal one
walks: of the pulses that take fewer than 10 % beyond the goal before the next image, by those with
which 90 % are fastest. Near the goal it waits until a mean of images is sure, and gets the single
pulse whose step is the distance; how far one came scales its next ones.
"""

import numpy as np
from follower import field_voltages

from stickslip import STATE_COLUMNS, Drive, Scenario, rollout
from stickslip.control import Camera, Film

PRIORS = {  # of friction, adhesion and drag
    "contact.kinetic_friction": {"mean": 0.145, "sd": 0.01},
    "contact.static_friction": {"mean": 0.2, "sd": 0.014},
    "contact.adhesion": {"mean": 0.22e-6, "sd": 0.03e-6},
    "drag.linear": {"low": 3e-6, "high": 3e-5},
    "drag.rotational": {"median": 9e-17, "factor": 2.0},
}
SCENARIO = Scenario(drive=Drive(base=0.5e-3), uncertain=PRIORS)
TOLERANCE = 2e-6  # m
CAMERAS = {
    "exact state": Camera(frame_rate=1000.0),
    "camera": Camera(frame_rate=30.0, latency=0.05, noise_x=3e-6),
}
# All chosen. Times are steps of a tenth of the drive's period, heights parts of its peak.
WINDOW, STANDS, RESTS = 20, 150, 200  # steps of a decision, to stand up, to come to rest
WALKS = [(n, height) for n in (1, 2, 4) for height in np.linspace(0.2, 0.8, 16)]  # pulses a window
SINGLE = np.linspace(0.05, 0.6, 23)  # of a single pulse forward, and back
SLOWEST, ENOUGH, SURE = 0.05, 0.5, 0.3  # parts of the greatest speed, and of the tolerance
STILL, BEHIND = 0.05, 2.5  # parts of the tolerance
X, THETA = STATE_COLUMNS.index("x"), STATE_COLUMNS.index("theta")


def tooth(height, steps):
    """A pulse from half of the peak: a slow fall and a sudden rise, or the reverse below 0."""
    slope = np.arange(1, steps) / (steps - 1)
    return np.append(0.5 - abs(height) * (slope if height > 0.0 else slope[::-1]), 0.5)


class Placer:
    """Tables of what pulses do to `draws` robots of a scenario, whose drive is IPP along +x."""

    def __init__(self, scenario, camera, draws=64, seed=0):
        self.scenario, self.camera, self.step = scenario, camera, 0.1 / scenario.drive.frequency
        self.robots = scenario.draws(draws, seed)
        self.standing = self.play(self.robots, None, np.full(STANDS, 0.5))[:, -1]
        kinds = np.array([np.tile(tooth(height, WINDOW // n), n) for n, height in WALKS])
        ways = np.array([self._ways(np.tile(kind, 10)) for kind in kinds])
        before, end = ways[..., 4 * WINDOW - 1], ways[..., 10 * WINDOW - 1]
        speeds = np.quantile((end - before) / (6 * WINDOW * self.step), [0.1, 0.5, 0.9], axis=-1)
        coasts = np.median(ways[..., -1] - end, axis=-1)
        walks = speeds[0] > SLOWEST * speeds[0].max()
        self.kinds, self.coast = kinds[walks], coasts[walks]
        self.low, self.median, self.high = speeds[:, walks]
        self.slowest = int(np.argmin(self.high))
        table, moving = [(0.0, 0.0)], 0  # steps, and heights of their pulses
        for height in (*-SINGLE, *SINGLE):
            way = self._ways(tooth(height, WINDOW))
            step = float(np.median(way[:, -1]))
            far = np.abs(way - way[:, -1:]) > STILL * TOLERANCE
            moving = max(moving, int(np.max(far * np.arange(way.shape[1]))))
            longest = (max if height > 0.0 else min)(table)[0]
            if np.sign(height) * (step - longest) > STILL * TOLERANCE:  # not as a weaker one
                table.append((step, float(height)))
        self.steps, self.heights = np.array(sorted(table)).T
        self.settle = max(moving - WINDOW, 0) * self.step

    def voltages(self, along):
        """Of the five coils, V, shape (..., 5), for parts of the peak, shape (...)."""
        drive = self.scenario.drive
        clamp = -drive.hold if drive.clamp == "down" else drive.hold
        return field_voltages(self.scenario, 0.0, drive.peak * along, clamp)

    def play(self, robots, states, along):
        """States after each step, of robots that begin at `states`."""
        volts = np.broadcast_to(self.voltages(along), (len(robots), along.shape[-1], 5))
        return rollout(robots, states, volts, self.step, hold="linear", record=STATE_COLUMNS).states

    def _ways(self, along):
        x = self.play(self.robots, self.standing, np.append(along, np.full(RESTS, 0.5)))[..., X]
        return x - self.standing[:, None, X]

    def put(self, robots, goal, seed=0, limit=30.0):
        """Time, s, NaN for never; error, m; and number of single pulses of robots put to `goal`."""
        count, time, last, random = len(robots), 0.0, 0.0, np.random.default_rng(seed)
        states, camera = self.play(robots, None, np.full(STANDS, 0.5))[:, -1], self.camera
        film = Film(camera, self.step, states[:, [X, THETA]])
        total, images, before, still_from = np.zeros((4, count))
        scale, done, pulses = np.ones(count), np.full(count, np.nan), np.zeros(count, dtype=int)
        walks, table = np.ones(count, dtype=bool), [np.zeros(count)]  # ways after each step
        horizon = camera.latency + camera.exposure + 1.0 / camera.frame_rate + WINDOW * self.step
        while np.isnan(done).any() and time < limit:
            seen, taken = film.pose[:, 0], film.taken
            along, onward = np.full((count, WINDOW), 0.5), np.zeros(count)
            # Where a robot is now: the newest image, and the way since then by the table.
            distance = goal - seen - (table[-1] - table[round(taken / self.step)])
            walks &= distance > self.steps[-1] + self.coast[self.slowest]
            short = self.high * horizon + self.coast <= distance[walks, None]
            short[:, self.slowest] = True
            choice = np.argmax(np.where(short, self.low, -np.inf), axis=1)
            along[walks], onward[walks] = self.kinds[choice], self.step * self.median[choice]
            rest = time + WINDOW * self.step + self.settle
            still_from[walks] = rest
            stands = ~walks & np.isnan(done) & np.isfinite(seen)
            looks = stands & (taken > last) & (taken >= still_from)
            total[looks] += seen[looks]
            images[looks] += 1
            number = np.maximum(images, 1)
            off, sd = goal - total / number, camera.noise_x / np.sqrt(number)
            sure = sd <= SURE * TOLERANCE
            pushed = looks & (np.abs(off) > ENOUGH * TOLERANCE + np.where(sure, 0.0, 3.0 * sd))
            # How far the last pulse forward came says what to ask of the next, within bounds.
            learned = pushed & (before > 0.0)
            came = np.maximum(before - off, 1e-9)
            scale[learned] *= np.clip(before / came, 2 / 3, 3 / 2)[learned]
            # One that is too far is taken behind the goal first: steps forward are surer.
            wanted = np.where(off > 0.0, scale * off, off - BEHIND * TOLERANCE)
            for robot in np.flatnonzero(pushed):
                along[robot] = tooth(np.interp(wanted[robot], self.steps, self.heights), WINDOW)
            before[pushed], still_from[pushed] = off[pushed], rest
            total[pushed], images[pushed], pulses[pushed] = 0.0, 0.0, pulses[pushed] + 1
            done[looks & ~pushed & sure], last = time, taken
            table += [table[-1] + (k + 1) * onward for k in range(WINDOW)]
            played = self.play(robots, states, along)
            for now in played.swapaxes(0, 1):
                time += self.step
                film.watch(time, now[:, [X, THETA]], random)
            states = played[:, -1]
        end = self.play(robots, states, np.full(RESTS, 0.5))[:, -1, X]
        return done, end - goal, pulses


def main(count=256):
    """Make the tables, and print what the placer reaches with so many robots."""
    robots = SCENARIO.draws(count, seed=2)
    print("| by | time, s | 90 % | error, um | 90 % | within 2 um | single pulses |")
    print(f"|{' --- |' * 7}")
    for name, camera in CAMERAS.items():
        done, error, pulses = Placer(SCENARIO, camera, seed=1).put(robots, 3e-3)
        time = np.quantile(np.nan_to_num(done, nan=np.inf), [0.5, 0.9], method="higher")
        numbers = [*time, *(1e6 * np.quantile(np.abs(error), [0.5, 0.9]))]
        share = 100 * np.mean(np.isfinite(done) & (np.abs(error) <= TOLERANCE))
        shown = " | ".join(f"{number:.1f}" for number in numbers)
        print(f"| {name} | {shown} | {share:.1f} % | {np.median(pulses):.0f} |")


if __name__ == "__main__":
    main()
