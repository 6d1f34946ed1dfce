"""Side-view tracking of one run as a table of observables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from scipy.linalg import block_diag

from stickslip._util.arrays import Array, Indices, Mask, distinct_rows
from stickslip._util.note import Note
from stickslip._util.palette import BLACK
from stickslip._util.picture import Picture
from stickslip._util.prior import Prior
from stickslip._util.units import in_handy_units
from stickslip.diagnosis.data.errors import Errors, meter_step
from stickslip.diagnosis.data.noise import Draws
from stickslip.diagnosis.report.pictures import plain_axes
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.scenario.keys import known_keys
from stickslip.walker.exposure import CameraModel, Recording, record, recording_rate, rocking
from stickslip.walker.folding import Kind, fold, frame_errors, reduce, undrifted
from stickslip.walker.instruments import of_films
from stickslip.walker.outliers import far_from_their_phase
from stickslip.walker.read_tracking import FEWEST, REQUIRED, TrackingRun
from stickslip.walker.simulated import SimulatedTable

_KINDS: dict[str, tuple[Kind, str]] = {
    "theta": ("level", "rad"),
    "x": ("drift", "m"),
    "z": ("place", "m"),
    "current_x": ("level", "A"),
    "current_clamp": ("level", "A"),
}
"""How each column is reduced, and its unit."""

_CURRENTS = ("current_x", "current_clamp")

_OF_ALL = {
    "film_delay.time": "trigger", "angle_offset.angle": "angle_offset",
    "length_scale.fraction": "length_scale", "clock_scale.fraction": "clock_scale",
    "film_clipping.limit": "angle_limit",
    "marker_place.along": "marker_along", "marker_place.across": "marker_across",
}  # fmt: skip
"""Errors that all films share, by their names in `CameraModel`."""

_ANGLE_OFFSET, _SCALE, _TRIGGER = math.radians(1.0), 0.01, 3e-4
"""Standard deviations of a camera's zero, rad, of its angles' and a current's scale, and of the
time at which frames begin, s. Chosen: a camera that was set up by eye, an ammeter of class 1, and a
third of a frame of 1 kHz."""

_TOO_LARGE = 10.0
"""Ratio of a stated error to the scatter of frames that is reported. Chosen: no camera differs by
as much from what it is taken for."""

_DRAWN = 200  # points of the picture

_CORRELATED = 0.2
"""Correlation of neighbours that is reported. Chosen: it changes an error by a fifth."""


class FilmTable(SimulatedTable):
    """Frames of one run, folded on the drive's phase, and a simulation that its camera films.

    The conditions are the observables of each column, one column after another. `number` counts
    from 1; the name is ``tracking.<number>``. `threads` simulations run at a time. `columns` has,
    for each column in use, its frames, a mask of shape (n,), and the matrix that maps these to
    observables.
    """

    drawable = False

    def __init__(self, film: TrackingRun, number: int = 1, threads: int = 1) -> None:
        self.film, self.threads, self.words = film, threads, film.file
        self.name, self.rate = f"tracking.{number}", recording_rate(film.scenario)
        self.left_out = []
        self.columns: dict[str, tuple[Mask, Array]] = {}
        self._sizes: dict[str, float] = {}
        self._notes: list[Note] = []
        nominal = self._frames_of(next(record(film.scenario, [], np.zeros((1, 0)), self.rate, 1)))
        parts = [self._reduced(key, nominal) for key in _KINDS if key in film.columns]
        reduced = [part for part in parts if part is not None]
        counts = [len(mean) for mean, _, _ in reduced]
        number_of = np.concatenate([np.arange(count) for count in counts])
        settings = {"column": np.repeat(list(self.columns), counts), "number": number_of}
        covariance = np.asarray(block_diag(*(block for _, block, _ in reduced)), dtype=float)
        sd = np.sqrt(np.diag(covariance))
        means = np.concatenate([mean for mean, _, _ in reduced])
        super().__init__(settings, means, sd=sd, name=self.name)
        # Columns are of different size, each with its own degrees of freedom.
        dof = [freedom for _, _, freedom in reduced]
        spread = np.sum((np.array(counts) / len(sd)) ** 2 / np.maximum(dof, 1e-9))
        dof_of_all = 1.0 / float(spread) if spread > 0.0 else math.inf
        self.errors = Errors(sd, covariance, dof_of_all, self._sizes, tuple(self._notes))
        # A film is held out as a whole. What a model misses may follow the bins of a column, and
        # columns share no unit.
        self.group = np.zeros(len(sd), dtype=np.int64)
        self.run, self.order = np.repeat(np.arange(len(counts)), counts), number_of.astype(float)
        self.nuisance = self._uncertain()
        self.instruments = of_films(film.columns["theta"][self.columns["theta"][0]])

    @property
    def at(self) -> str:
        return f"{self.title}: "

    def unit_of(self, condition: int) -> str:
        return _KINDS[str(self["column"][self.first[condition]])][1]

    def parts(self) -> list[tuple[Indices | slice, str]]:
        columns = self["column"][self.first]
        return [(np.flatnonzero(columns == name), f"Column {name}")
                for name in _KINDS if name in columns]  # fmt: skip

    def predict(self, names: Sequence[str], values: Array) -> Array:
        """Observables; NaN where the simulation fails.

        Vectors that differ in the camera alone share a simulation.
        """
        result = np.full((len(values), len(self.mean)), np.nan)
        for vector, frames in self._simulated(names, values):
            parts = [matrix @ frames[key][used] for key, (used, matrix) in self.columns.items()]
            result[vector] = np.concatenate(parts)
        return result

    def figure(
        self, names: Sequence[str], models: Mapping[str, tuple[str, Array]]
    ) -> Figure | None:
        """Pitch and place over the phase of the drive; None where nothing is steady."""
        used = self.own_columns(names)
        traces = {}
        for label, (colour, values) in models.items():
            seen = self.over_phase([names[k] for k in used], values[used])
            if seen is None:
                return None
            traces[label] = colour, seen
        figure = Picture(figsize=(9.6, 5.0), layout="constrained")
        frames = figure.subplots(2, 2, sharex=True)
        _, first = next(iter(traces.values()))
        step = max(1, len(first["phase"]) // _DRAWN)
        for row, key, unit in zip(frames, ("theta", "x"), ("rad", "m"), strict=True):
            factor, label_of = in_handy_units({"theta": "pitch", "x": "place"}[key], unit)
            base = first[f"{key}_model"]
            # Beside the motion what differs from the recalibrated model, which would hide there.
            for axes, below, words in zip(row, (0.0 * base, base), ("", "change of "), strict=True):
                for label, (colour, seen) in traces.items():
                    at = seen["phase"][::step]
                    if seen is first:
                        measured = (seen[key] - below)[::step] * factor
                        axes.plot(at, measured, ".", color=BLACK, ms=3, label="measured")
                    level = (seen[f"{key}_model"] - below)[::step] * factor
                    axes.plot(at, level, color=colour, label=label)
                axes.set_ylabel(words + label_of)
                plain_axes(axes)
        for axes in frames[1]:
            axes.set_xlabel("phase of the drive, in periods")
        figure.legend(*frames[0, 0].get_legend_handles_labels(), loc="outside upper center",
                      ncols=3, frameon=False)  # fmt: skip
        return figure

    def over_phase(self, names: Sequence[str], values: Array) -> dict[str, Array] | None:
        """Steady frames beside those of a model, in the order of their phase, for a picture.

        Keys are ``phase`` (1) and, measured and of the model, ``theta``, ``theta_model`` (rad),
        ``x`` and ``x_model`` (m), less their advance and mean; each has the shape (frames,).
        `values` have the shape (names,). None where the simulation fails, or nothing is steady.
        """
        folded = fold(self.film.columns["t"], self.film.scenario)
        used = folded.steady & self.columns["x"][0] & self.columns["theta"][0]
        model = next((frames for _, frames in self._simulated(names, values[None])), None)
        if model is None or not used.any():
            return None
        order = folded.by_phase[used[folded.by_phase]]
        traces = {"phase": folded.phase[order]}
        for key in ("theta", "x"):
            for word, of in (("", self.film.columns), ("_model", model)):
                seen = of[key] if key == "theta" else undrifted(folded, of[key])
                traces[key + word] = seen[order] - (0.0 if key == "theta" else seen[order].mean())
        return traces

    def _simulated(
        self, names: Sequence[str], values: Array
    ) -> Iterator[tuple[int, dict[str, Array]]]:
        """Frames of each vector whose simulation succeeds."""
        known = known_keys()
        keys = [k for k, name in enumerate(names) if name in known]
        motions, which = distinct_rows(values[:, keys])
        recorded = record(
            self.film.scenario, [names[k] for k in keys], motions, self.rate, self.threads
        )
        for number, motion in enumerate(recorded):
            for vector in np.flatnonzero(which == number).tolist():
                frames = self._frames_of(motion, dict(zip(names, values[vector], strict=True)))
                if frames is not None:
                    yield vector, frames

    def _frames_of(
        self, motion: Recording | None, p: Mapping[str, float] | None = None
    ) -> dict[str, Array] | None:
        """Frames of a motion, at values of `nuisance` and `instruments`."""
        if motion is None:
            return None
        p = p or {}
        start = f"{self.name}."
        values = {key.removeprefix(start): p[key] for key in p if key.startswith(start)}
        for common, name in _OF_ALL.items():
            if common in p:  # beside what this film has of it
                values[name] = values.get(name, 0.0) + p[common]
        camera = CameraModel(self.film.exposure, **values, facing=self.film.scenario.drive.facing)
        return camera.frames(motion, self.film.columns["t"], list(self.columns or _KINDS))

    def _uncertain(self) -> tuple[Parameter, ...]:
        """Uncertain parameters of this camera alone."""
        # A frame's time may mark the middle of the exposure or its beginning, so a long exposure
        # makes the trigger less certain.
        trigger = math.hypot(_TRIGGER, 0.25 * self.film.exposure)
        priors = [
            ("angle_offset", 0.0, _ANGLE_OFFSET, "rad"),
            ("angle_scale", 1.0, _SCALE, "-"),
            ("trigger", 0.0, trigger, "s"),
        ]
        if not self.columns.keys().isdisjoint(_CURRENTS):
            priors.append(("current_scale", 1.0, _SCALE, "-"))
        return tuple(
            Parameter(f"{self.name}.{key}", Prior("normal", mean, sd), unit, cause=False)
            for key, mean, sd, unit in priors
        )

    def _reduced(
        self, name: str, nominal: dict[str, Array] | None
    ) -> tuple[Array, Array, float] | None:
        """Observables of a column, their covariance and its degrees of freedom, if it is used."""
        film, (kind, unit) = self.film, _KINDS[name]
        times, values, drive = film.columns["t"], film.columns[name], film.scenario.drive
        used = np.isfinite(values)
        required = name in REQUIRED
        if not required and used.sum() < FEWEST:
            text = f"The column {name} is not used: of {FEWEST} numbers it has {used.sum()}."
            self.left_out.append(Note("column-too-short", text, int(used.sum())))
            return None
        residual = values - (0.0 if nominal is None else nominal[name])
        step = meter_step(values[used])
        folded, lost = fold(times[used], film.scenario), np.zeros(len(times), dtype=bool)
        # The advance may be wrong by much, so neighbours are compared without it.
        level = undrifted(folded, residual[used])[folded.by_phase]
        lost[np.flatnonzero(used)[folded.by_phase]] = far_from_their_phase(level, step)
        if lost.any():
            text = (
                f"{lost.sum()} frames lie far from all others of their phase in {name}, the first "
                f"at {times[lost][0]:.5g} s, and are not used."
            )
            self.left_out.append(Note("wild-frames", text, int(lost.sum())))
        used &= ~lost
        if kind != "level" and drive.kind == "sawtooth":
            # How far the contact slips while the robot pitches up in the ramp changes by jumps with
            # every parameter, and carries little information; the motion after it is smooth.
            used &= times >= drive.latency + drive.ramp
        folded, place = fold(times[used], film.scenario), np.flatnonzero(used)
        stated = film.noise.get({"x": "x", "z": "x", "theta": "theta"}.get(name, ""))
        rate = film.scenario.pulse_rate
        pace = rocking(film.scenario) / rate if rate > 0.0 else 0.0
        fitted = frame_errors(folded, residual[used], place, kind, pace, stated)
        if fitted is None:
            sd = stated or float(np.std(residual[used])) or 1.0
            draws = {key: np.array([value]) for key, value in
                     (("s2", sd**2), ("phi", 0.0), ("shared2", 0.0), ("weight", 1.0))}  # fmt: skip
            if stated is None:
                text = f"The noise of {name} is not known; the stated model's whole misfit counts."
                self._notes.append(Note("frame-noise-unknown", text, sd))
        else:
            draws, believed, scatter = fitted
            self._say(name, unit, scatter, stated, believed, draws)
        draws["s2"] = np.maximum(draws["s2"], step**2 / 12.0)
        matrix, covariance, dof = reduce(folded, place, kind, draws)
        self.columns[name] = used, matrix
        return matrix @ values[used], covariance, 0.0 if fitted is None and stated is None else dof

    def _say(
        self, name: str, unit: str, scatter: float, stated: float | None, believed: bool,
        draws: Draws,
    ) -> None:  # fmt: skip
        """Report the errors of frames."""
        weight = draws["weight"]
        sd, shared = (math.sqrt(weight @ draws[key]) for key in ("s2", "shared2"))
        phi = float(weight @ draws["phi"])
        self._sizes |= {f"{name}.sd": sd, f"{name}.phi": phi, f"{name}.shared": shared}
        head = f"{name} scatters by {scatter:.3g} {unit} where a phase repeats"
        if stated is None:
            self._notes.append(Note("frame-noise", f"{head}.", scatter))
        elif stated > _TOO_LARGE * scatter:
            text = f"{head}, and {stated:.3g} {unit} are stated, which are used: look at the unit."
            self._notes.append(Note("frame-noise-below-stated", text, scatter))
        elif not believed:
            text = f"{head}, more than the stated {stated:.3g} {unit}; the scatter is used."
            self._notes.append(Note("frame-noise-above-stated", text, scatter))
        if phi > _CORRELATED:
            text = f"Errors of {name} in neighbouring frames have a correlation of {phi:.2f}."
            self._notes.append(Note("frames-correlated", text, phi))
        if shared > sd:
            text = f"Periods of {name} differ by {shared:.2g} {unit}, which counts as noise."
            self._notes.append(Note("periods-differ", text, shared))
