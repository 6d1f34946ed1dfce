"""The pictures that ``stickslip run`` is asked for: checked before the run, drawn after it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from stickslip._util.text import highest
from stickslip.cli.common import draw, nothing_drawn
from stickslip.cli.progress import ProgressBar
from stickslip.cli.targets import Inputs, check_plot, check_target
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import RECORD_FIELDS, recorded_fields, shown
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.run import Run
from stickslip.simulation.simulate import check_memory


@dataclass(frozen=True)
class Pictures:
    """What ``--plot``, ``--animate``, ``--start``, ``--stop`` and ``--slowdown`` say."""

    plot: Path | None
    animate: Path | None
    start: float | None  # s
    stop: float | None
    slowdown: float | None

    @property
    def option(self) -> str:
        """The first option that needs a recorded motion; "" without one."""
        if self.plot is not None:
            return "--plot"
        return "" if self.animate is None else "--animate"

    def check_stretch(self, scenario: Scenario) -> None:
        """Refuse a stretch of time that the run does not have, or that nothing shows."""
        if self.slowdown is not None and self.animate is None:
            raise ScenarioError("--slowdown: allowed with --animate only")
        for option, time in (("--start", self.start), ("--stop", self.stop)):
            if time is None:
                continue
            if not self.option:
                raise ScenarioError(f"{option}: allowed with --plot or --animate only")
            # The sum of the drive's parts has the rounding of each: 0.16999... s is 0.17 s.
            end = round(scenario.duration, 12)
            if not 0.0 <= time <= max(end, scenario.duration):
                raise ScenarioError(
                    f"{option} = {time!r}: allowed is from 0 to {highest(end)} s, "
                    "the duration of the run"
                )
        if self.start is not None and self.stop is not None and self.start >= self.stop:
            raise ScenarioError(
                f"--start = {self.start!r}: allowed is less than --stop = {self.stop!r}"
            )

    def check_files(self, inputs: Inputs) -> None:
        """Say before a long simulation which picture could not be written after it."""
        if self.plot is not None:
            check_plot(self.plot, inputs)
        if self.animate is not None:
            from stickslip.plot.moving import check_moving_format

            check_target("--animate", self.animate, inputs)
            with prefixed("--animate", RuntimeError), prefixed("--animate", ValueError):
                check_moving_format(self.animate)

    def check_recorded(self, scenario: Scenario) -> None:
        """Say before a long simulation that its record could not be drawn after it."""
        from stickslip.plot.motion import _DRAWN, _DRAWN_ACROSS
        from stickslip.plot.moving import _stretch, _timing

        fields = str(scenario.record.fields)
        drawn = (*_DRAWN, *_DRAWN_ACROSS) if scenario.turns else _DRAWN
        missing = [name for name in drawn if name not in recorded_fields(fields)]
        if missing:
            raise ScenarioError(
                f"{self.option}: {RECORD_FIELDS} = {shown(fields)}: allowed is what has all that "
                f"is drawn, also {', '.join(missing)}"
            )
        with prefixed(self.option):
            check_memory(scenario)
        if self.animate is not None:
            first, last = _stretch(scenario, 0.0, scenario.duration, self.start, self.stop)
            with prefixed("--animate", ValueError):
                _timing(last - first, self.slowdown)

    def draw(self, run: Run) -> bool:
        """Write all pictures; False if there was nothing to draw."""
        drawn = True
        if self.plot is not None:
            drawn = draw(self.plot, "run", run, self.start, self.stop)
        if self.animate is not None:
            drawn = self._animate(run, self.animate) and drawn
        return drawn

    def _animate(self, run: Run, path: Path) -> bool:
        from stickslip import plot

        try:
            picture = plot.animation(run, self.start, self.stop, self.slowdown)
        except ValueError as error:  # of a run that failed before the time that is drawn
            return nothing_drawn("--animate", error)
        # What --out has written is there already.
        with ProgressBar("drawing frames", kept=lambda stage: "") as bar:
            picture.save(path, progress=bar)
        return True
