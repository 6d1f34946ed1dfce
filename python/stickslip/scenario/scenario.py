"""All that defines one simulation.

A scenario that is read from TOML and one that is built here are the same object. Values are checked
when an object is made, so a scenario that exists can be simulated.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Any

from stickslip import _core
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import (
    Value,
    check_kind,
    checked,
    field_of,
    find_key,
    full_name,
    is_of_one_coil,
    known_keys,
)
from stickslip.scenario.named_effects import PREFIX, EffectSettings
from stickslip.scenario.path_keys import OBJECTS
from stickslip.scenario.section_table import SECTIONS
from stickslip.scenario.sections import (
    SAWTOOTH,
    Coil,
    Contact,
    Drag,
    Drive,
    Environment,
    Record,
    Robot,
    Solver,
    refuse_sawtooth_values,
    refuse_uncertain_geometry,
)
from stickslip.scenario.state import State

if TYPE_CHECKING:
    from stickslip.scenario.uncertain import JointPrior


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """All that defines one simulation. SI units and radians throughout.

    Parameters
    ----------
    drive, coil, robot, contact, drag, environment, initial, solver, record
        Sections. Where nothing is given, `coil` and `robot` have the values of Tables I and II
        (the coils' side and distance are effective ones), `contact` and `drag` those of section VI,
        `drive` has a peak of 2.5 mT, and `initial` is rest, flat and without current. What the
        paper leaves open has a default of this package: base, hold, edge and clamp of the drive,
        the numbers and durations of its pulses and ramps, and everything that is zero.
    effects : mapping
        Named extensions of the model: ``{name: {parameter: value}}``; see `stickslip.effects`.
    uncertain : JointPrior, optional
        What is not known exactly, also as the tables of ``[uncertain]``. `simulate` and `sweep`
        take the values of the keys; `draws` draws.

    Raises
    ------
    ScenarioError
        If the values make no sense together: kinetic above static friction, a sawtooth whose top
        is below its bottom, an edge longer than a period, more than 1e9 samples.

    Examples
    --------
    >>> scenario = Scenario(drive=Drive(mode="OPP", hold=2.5e-3, edge="fall", pulses=20))
    >>> scenario.replace({"drive.frequency": 30.0}).drive.frequency
    30.0
    """

    drive: Drive = field(default_factory=Drive)
    coil: Coil = field(default_factory=Coil)
    robot: Robot = field(default_factory=Robot)
    contact: Contact = field(default_factory=Contact)
    drag: Drag = field(default_factory=Drag)
    environment: Environment = field(default_factory=Environment)
    initial: State = field(default_factory=State)
    solver: Solver = field(default_factory=Solver)
    record: Record = field(default_factory=Record)
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=EffectSettings)
    uncertain: JointPrior | None = None

    def __post_init__(self) -> None:
        for name, section in SECTIONS.items():
            check_kind(name, getattr(self, name), section)
        if not isinstance(self.effects, EffectSettings):
            object.__setattr__(self, "effects", EffectSettings(self.effects))
        if self.uncertain is not None:
            from stickslip.scenario.uncertain import as_joint_prior

            object.__setattr__(self, "uncertain", as_joint_prior(self.uncertain))
        self._check()

    def _check(self) -> None:
        """Refuse values that are allowed, but not together."""
        if self.drive.program is not None and self.drive.mode != "program":
            raise ScenarioError(
                f'drive.mode = "{self.drive.mode}": allowed is "program" where voltages are given '
                "by drive.file or a waveform"
            )
        if self.uncertain is not None:
            refuse_uncertain_geometry(self.coil, self.uncertain.names)
        try:
            self._kept_core().check()
        except ValueError as error:
            raise ScenarioError(str(error)) from None

    def _repr_html_(self) -> str:
        from stickslip.scenario.scenario_display import scenario_html

        return scenario_html(self)

    @staticmethod
    def from_toml(path: str | PathLike[str]) -> Scenario:
        """Read a scenario file.

        Parameters
        ----------
        path : path-like
            A TOML file with ``stickslip = 1`` and a section ``[drive]``.

        Returns
        -------
        Scenario

        Raises
        ------
        ScenarioError
            If the file cannot be read, is not such a file, or holds a key or value that is not
            allowed.
        """
        from stickslip.scenario.toml_file import read_scenario

        return read_scenario(path)

    def to_toml(self, path: str | PathLike[str] | None = None) -> str:
        """The scenario as the text of a TOML file, with every key.

        Parameters
        ----------
        path : path-like, optional
            Where to write it too. The voltages of a program go beside it, to
            ``<stem>.voltages.csv``, and the fitted field of ``coil.map`` to ``<stem>.map.json``.

        Returns
        -------
        str

        Raises
        ------
        OSError
            If a file cannot be written; nothing is left half-written.
        """
        from stickslip.scenario.toml_file import scenario_text, write_scenario

        return scenario_text(self) if path is None else write_scenario(self, path)

    @staticmethod
    def keys() -> tuple[str, ...]:
        """All dotted keys that hold a number or a word, including those of every extension."""
        return tuple(known_keys())

    def get(self, key: str) -> Value:
        """The value of a dotted key, such as ``"drive.frequency"``.

        A parameter of an effect is known by its short name too: ``"surface_tilt.angle"``.

        Raises
        ------
        ScenarioError
            If there is no such key.
        """
        key = full_name(key)
        known = find_key(key)
        if key.startswith(PREFIX):
            _, name, parameter = key.split(".", 2)
            return self.effects.get(name, {}).get(parameter, known.default)
        section = functools.reduce(getattr, known.section.split("."), self)
        value: Value = getattr(section, field_of(key))
        return value

    def replace(self, changes: Mapping[str, Any]) -> Scenario:
        """A copy with other values.

        Parameters
        ----------
        changes : mapping
            New values by dotted key, of effects also by short name. ``"coil.turns"`` sets all five
            coils, ``"coil.xp.turns"`` one. ``"drive.program"`` takes a
            `Waveform` or None, and ``"coil.map"`` a `FieldMap` or None. With a change of
            ``"drive.mode"`` to ``"program"`` the keys of the sawtooth get their defaults.

        Returns
        -------
        Scenario

        Raises
        ------
        ScenarioError
            If a key is unknown or a value not allowed.
        """
        changes = {full_name(key): value for key, value in changes.items()}
        # A key of all coils would undo one of a single coil that came before it.
        changes = dict(sorted(changes.items(), key=lambda change: is_of_one_coil(change[0])))
        for key, value in changes.items():
            if key not in OBJECTS:
                find_key(key, value)
        mode = changes.get("drive.mode", self.drive.mode)
        if mode == "program":
            sawtooth = {key: changes[key] for key in SAWTOOTH if key in changes}
            refuse_sawtooth_values(mode, sawtooth)
            if self.drive.mode != "program":
                changes |= {key: find_key(key).default for key in SAWTOOTH}
        # The core's scenario checks a value as it takes it. A copy of it and of the sections that
        # change is a tenth of the work of making all of them anew.
        core = self.to_core()
        by_section: dict[str, dict[str, Any]] = {}
        for key, value in changes.items():
            section, name = key.split(".", 1)
            given = value if key in OBJECTS else checked(key, value, core)
            own = name if section in ("effects", "coil") else field_of(key)
            by_section.setdefault(section, {})[own] = given
        parts = {section: self._changed(section, values) for section, values in by_section.items()}
        made = object.__new__(type(self))
        vars(made).update({each.name: getattr(self, each.name) for each in _FIELDS}, **parts)
        if "record" in parts:
            made.record.give_to(core)
        if not changes.keys() & {*OBJECTS}:
            vars(made)[_KEPT] = (known_keys(), core)
        made._check()
        return made

    def with_state(self, state: State) -> Scenario:
        """A copy that begins at `state`, such as ``run.final_state``, if it can."""
        check_kind("initial", state, State)
        return self.replace({f"initial.{name}": value for name, value in vars(state).items()})

    def with_uncertain(
        self, uncertain: JointPrior | Mapping[str, Any] | Scenario | None
    ) -> Scenario:
        """A copy of which other keys are uncertain, or none.

        Of a Scenario, such as `Diagnosis.extended`, it takes what is uncertain there, and the
        values of those keys that stand in its covariance, as that lies about them.
        """
        changed = self
        if isinstance(uncertain, Scenario):
            source, uncertain = uncertain, uncertain.uncertain
            if uncertain is None:
                raise ScenarioError("uncertain: the scenario holds nothing that is")
            changed = self.replace({key: source.get(key) for key in uncertain.keys})
        return dataclasses.replace(changed, uncertain=uncertain)  # type: ignore[arg-type]

    def draws(self, n: int, seed: int = 0) -> list[Scenario]:
        """Scenarios with drawn values of what is uncertain, of which nothing is uncertain.

        Draw number i is the same for every `n`, so that more draws keep those that there were.
        Values that make no scenario together are drawn again.

        Parameters
        ----------
        n : int
            How many.
        seed : int
            From 0.

        Raises
        ------
        ScenarioError
            If nothing is uncertain, a number is not allowed, or a hundred draws in succession make
            no scenario.
        """
        from stickslip.scenario.uncertain import counted_draws

        return counted_draws(self, n, seed)[0]

    def _changed(self, section: str, values: dict[str, Any]) -> Any:
        """A copy of a section with values that are checked already, but for those of OBJECTS."""
        before = getattr(self, section)
        if section == "effects":
            return before.with_values(values)
        if section == "coil":
            kept = {"map": values.pop("map", before.map)}
            return dataclasses.replace(before.with_values(values), **kept)
        if any(f"{section}.{name}" in OBJECTS for name in values):
            return dataclasses.replace(before, **values)
        after = object.__new__(type(before))
        vars(after).update(vars(before), **values)
        return after

    @property
    def duration(self) -> float:
        """Simulated time from start to end, s."""
        return self._kept_core().duration

    @property
    def window(self) -> tuple[float, float]:
        """Times between which the mean velocity is taken, s (section VII of the paper).

        From the end of the third pulse to the end of the last; from the end of the ramp with three
        pulses or fewer; all of a program.
        """
        return self._kept_core().window

    @property
    def turns(self) -> bool:
        """Whether the robot moves in the whole plane, and not along x alone.

        So it is with a heading of the drive that is not along x, a start that faces another way
        than the drive's direction, voltages of yp and ym that do not cancel, a measured map of the
        field, or a start, a field or a slope across x.
        """
        return self._kept_core().turns

    def to_core(self) -> _core.Scenario:
        """The same scenario as the compiled core takes it; the caller's own."""
        return _core.Scenario(self._kept_core())

    def _kept_core(self) -> _core.Scenario:
        """The same, shared and not to be changed; made anew once an effect was registered."""
        kept = vars(self).get(_KEPT)
        if kept is None or kept[0] is not known_keys():
            kept = vars(self)[_KEPT] = (known_keys(), self._make_core())
        core: _core.Scenario = kept[1]
        return core

    def __getstate__(self) -> dict[str, Any]:
        return {each.name: getattr(self, each.name) for each in _FIELDS}

    def _make_core(self) -> _core.Scenario:
        core = _core.Scenario()
        for key, section, name in _core_keys():
            core.set(key, getattr(getattr(self, section), name))
        for key, value in self.coil.own_values().items():
            core.set(key, value)
        assert isinstance(self.effects, EffectSettings)
        for key, value in self.effects.flat().items():
            checked(key, value, core)  # an effect of the user may be gone
        if self.drive.program is not None:
            core.set_program(self.drive.program.to_core())
        if self.coil.map is not None:
            core.set_map(self.coil.map.to_core())
        self.record.give_to(core)
        return core


_FIELDS = dataclasses.fields(Scenario)

_KEPT = "_kept"
"""Where an instance keeps its core, with the table of keys that it was made for."""


@functools.cache
def _core_keys() -> tuple[tuple[str, str, str], ...]:
    """Key, section and field of everything that `Scenario.to_core` takes from the sections."""
    return tuple(
        (key, *key.split(".", 1))  # type: ignore[misc]
        for key in known_keys()
        if not key.startswith(("record.", PREFIX)) and not is_of_one_coil(key)
    )
