"""The class `Scenario`, all inputs of a run.

A scenario that is read from TOML and one that is built here are the same object. Values are checked
when an object is made, so a scenario that exists can be simulated.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import Any, Generic, TypeVar

import numpy as np

from stickslip import _core
from stickslip._util.html import html_table
from stickslip._util.messages import check_kind, check_whole, known_arguments
from stickslip._util.toml import parse_toml
from stickslip._util.units import handy
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.changes import Changes
from stickslip.scenario.effects import flat_effects
from stickslip.scenario.held import OBJECTS, PATHS, with_files
from stickslip.scenario.keys import (
    COIL_MAP,
    FILE,
    LAWS,
    PREFIX,
    PROGRAM,
    Key,
    Value,
    find_key,
    full_name,
    keys_of,
    known_keys,
)
from stickslip.scenario.law import Law, flat_laws, laws_of, refuse_unknown_laws
from stickslip.scenario.matter import Fluid, fluid_of
from stickslip.scenario.section import Section
from stickslip.scenario.sections import (
    SECTIONS,
    Coil,
    Contact,
    Drag,
    Drive,
    Environment,
    Inner,
    Record,
    Robot,
    Shake,
    Solver,
    State,
)
from stickslip.scenario.toml_file import (
    Stated,
    files_of,
    read_document,
    scenario_text,
    stated,
    write_scenario,
)
from stickslip.scenario.uncertain import JointPrior, as_joint_prior, refuse_geometry_beside_a_map

_S = TypeVar("_S", bound=Section)

# Draws in succession that may make no scenario. Chosen: where one in twenty makes one, a hundred
# fail once in 170 times; a prior of which less is allowed is a mistake.
_MOST_DRAWS = 100

_FLUID = "fluid"  # the key of what `in_fluid` put the robot into


class _View(Generic[_S]):
    """A section of a scenario."""

    def __init__(self, kind: type[_S]) -> None:
        self._kind = kind

    def __get__(self, scenario: Scenario | None, owner: object = None) -> _S:
        if scenario is None:  # of the class itself
            return self  # type: ignore[return-value]
        return self._kind.view(scenario._core, scenario._held)


@known_arguments
class Scenario:
    """All inputs of a run. SI units and radians throughout.

    Parameters
    ----------
    drive, coil, robot, contact, drag, environment, shake, inner, initial, solver, record
        Sections. Where nothing is given, `coil` and `robot` have the values of Tables I and II
        (the coils' side and distance are effective ones), `contact` and `drag` those of section VI,
        `drive` has a peak of 2.5 mT, and `initial` is rest, flat and without current. What the
        paper leaves open has a default of this package: base, hold, edge and clamp of the drive,
        the numbers and durations of its pulses and ramps, and everything that is zero.
    effects : mapping
        Effects: ``{name: {parameter: value}}``; see `stickslip.effects`.
    laws : mapping
        Laws of your own: ``{name: Law(...)}``; see `Law`.
    uncertain : JointPrior, optional
        Priors of the uncertain parameters, also as the tables of ``[uncertain]``. `simulate` and
        `sweep` take the values of the keys; `draws` draws.

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

    __slots__ = ("__weakref__", "_core", "_held", "_uncertain")

    drive = _View(Drive)
    coil = _View(Coil)
    robot = _View(Robot)
    contact = _View(Contact)
    drag = _View(Drag)
    environment = _View(Environment)
    shake = _View(Shake)
    inner = _View(Inner)
    initial = _View(State)
    solver = _View(Solver)
    record = _View(Record)

    def __init__(
        self,
        *,
        drive: Drive | None = None,
        coil: Coil | None = None,
        robot: Robot | None = None,
        contact: Contact | None = None,
        drag: Drag | None = None,
        environment: Environment | None = None,
        shake: Shake | None = None,
        inner: Inner | None = None,
        initial: State | None = None,
        solver: Solver | None = None,
        record: Record | None = None,
        effects: Mapping[str, Mapping[str, float]] | None = None,
        laws: Mapping[str, Law | Mapping[str, Any]] | None = None,
        uncertain: JointPrior | Mapping[str, Any] | None = None,
    ) -> None:
        self._core = _core.Scenario()
        self._held: dict[str, Any] = {}  # all objects of this scenario, and no others, by `HELD`
        own = drive, coil, robot, contact, drag, environment, shake, inner, initial, solver, record
        for (name, kind), section in zip(SECTIONS.items(), own, strict=True):
            if section is None:
                continue
            check_kind(name, section, kind)
            self._core.take(section._core, name)
            self._held |= section.objects
        if effects is not None:
            Changes(flat_effects(effects)).apply(self._core)
        if laws is not None:
            Changes(flat_laws(laws)).apply(self._core)
        self._uncertain = None if uncertain is None else as_joint_prior(uncertain)
        self._check()

    def _check(self) -> None:
        """Refuse values that are allowed, but not together."""
        if PROGRAM in self._held and self.drive.kind != "program":
            raise ScenarioError(
                f'drive.mode = "{self.drive.mode}": allowed is "program" where voltages are given '
                "by drive.file or a waveform"
            )
        if COIL_MAP in self._held and self._uncertain is not None:
            refuse_geometry_beside_a_map(self._uncertain.names)
        self._core.check()
        if self._uncertain is not None:
            with prefixed("[uncertain]"):
                for key in self._uncertain.names:  # a law may not be there
                    self._core.get(key)

    @property
    def effects(self) -> Mapping[str, Mapping[str, float]]:
        """Settings of the effects, ``{name: {parameter: value}}``, without defaults.

        An effect at its defaults is left out.
        """
        effects: dict[str, dict[str, float]] = {}
        for key, value in sorted(self._core.changed().items()):
            if key.startswith(PREFIX):
                _, name, parameter = key.split(".")
                effects.setdefault(name, {})[parameter] = float(value)
        return MappingProxyType({name: MappingProxyType(part) for name, part in effects.items()})

    @property
    def laws(self) -> Mapping[str, Law]:
        """Laws of the user's own by name."""
        return MappingProxyType(dict(laws_of(self._core)))

    @property
    def uncertain(self) -> JointPrior | None:
        """Priors of the uncertain parameters; None without any."""
        return self._uncertain

    @staticmethod
    def from_toml(path: str | PathLike[str]) -> Scenario:
        """Read a scenario file; the same as `load`."""
        return load(path)

    def to_toml(self, path: str | PathLike[str] | None = None) -> str:
        """The scenario as the text of a TOML file, with every key.

        Parameters
        ----------
        path : path-like, optional
            Where to write it too. The voltages of a program go beside it, to
            ``<stem>.voltages.csv``, the fitted field of ``coil.map`` to ``<stem>.map.json``, the
            accelerations of a shake to ``<stem>.accelerations.csv`` and the forces on an inner mass
            to ``<stem>.forces.csv``.

        Returns
        -------
        str

        Raises
        ------
        OSError
            If a file cannot be written; nothing is left half-written.
        """
        if path is None:
            return scenario_text(self, files_of(self, None))
        return write_scenario(self, Path(path))

    @property
    def held(self) -> Mapping[str, Any]:
        """Its objects by their keys, see `HELD`."""
        return MappingProxyType(self._held)

    def document(self) -> dict[str, str]:
        """All that decides a run, as texts by name: its TOML, and each object that has a file."""
        held = {key: value for key, value in self._held.items() if key in OBJECTS}
        texts = {OBJECTS[key].attribute: value.to_json() for key, value in held.items()}
        return {"scenario": self.to_toml(), **texts}

    @staticmethod
    def of_document(document: Mapping[str, Any]) -> Scenario:
        """The scenario of `document`, which may have further texts beside.

        Raises
        ------
        ScenarioError
            If a text is none of a scenario.
        """
        read = stated(parse_toml(document["scenario"]), None)
        for key, held in OBJECTS.items():
            if held.attribute in document:
                read.changes[key] = held.kind.from_json(document[held.attribute])
        return _of_stated(read)

    @staticmethod
    def keys() -> tuple[str, ...]:
        """All dotted keys that hold a number or a word, including those of every effect."""
        return tuple(known_keys())

    def get(self, key: str) -> Value:
        """The value of a dotted key, such as ``"drive.frequency"``.

        A parameter of an effect is known by its short name too: ``"surface_tilt.angle"``.

        Raises
        ------
        ScenarioError
            If there is no such key.
        """
        with suppress(TypeError, ValueError):  # a short name, or none
            return self._core.get(key)
        return self._core.get(find_key(full_name(key)).name)

    def replace(self, changes: Mapping[str, Any] | None = None, /, **more: Any) -> Scenario:
        """A copy with other values.

        Parameters
        ----------
        changes : mapping
            New values by dotted key, of effects also by short name. ``"coil.turns"`` sets all five
            coils, ``"coil.xp.turns"`` one. ``"drive.program"`` takes a `Waveform`,
            ``"coil.map"`` a `FieldMap`, ``"shake.accelerations"`` an `Accelerations`,
            ``"inner.forces"`` a `Forces` and ``"laws.NAME"`` a `Law`, each also None. With a change
            of ``"drive.mode"`` to ``"program"`` or ``"none"`` the keys of the sawtooth get their
            defaults.
        **more
            The same, as ``**{"drive.frequency": 30.0}``.

        Returns
        -------
        Scenario

        Raises
        ------
        ScenarioError
            If a key is unknown or a value not allowed.
        """
        made = self._copy()
        if changes is not None:
            check_kind("changes", changes, Mapping)
        given = Changes(changes or {}, more)
        refuse_unknown_laws(made._core, given)
        given.apply(made._core, made._held)
        made._check()
        return made

    def _copy(self) -> Scenario:
        made = object.__new__(type(self))
        made._core, made._held = self.to_core(), dict(self._held)
        made._uncertain = self._uncertain
        return made

    def in_fluid(
        self,
        fluid: str | None = None,
        *,
        density: float | None = None,
        viscosity: float | None = None,
        wall: bool | float = True,
        gravity: float = 9.81,
    ) -> Scenario:
        """A copy whose robot lies in a liquid: its weight and its drag are those in there.

        The drag is that of a slowly moving sphere of the robot's volume, and buoyancy makes its
        weight smaller, not its mass. It sets `drag`, ``rotational_drag`` and `environment`, from
        the size and mass that the robot has now; what is set afterwards counts instead. What the
        fluid does beyond that, by its own inertia and as a film, is not in the model: a run of this
        scenario has the note ``fluid`` with its size.

        Parameters
        ----------
        fluid : str, optional
            ``"water"``, ``"silicone oil 100 cSt"`` and others; another word is refused with the
            names. It stands for the density and viscosity that are not given.
        density, viscosity : float, optional
            kg/m^3, and Pa s (the dynamic one).
        wall : bool or float
            The gap between the robot and the surface, m, such as the roughness, which makes the
            drag larger; True for the 1.5 um of Eq. (16), False for a robot far from any wall. A
            gap of a tenth gives 30 % more drag.
        gravity : float
            Acceleration of gravity without the fluid, m/s^2.

        Raises
        ------
        ScenarioError
            If the name is unknown, a number is not allowed, or the robot floats.
        """
        known = fluid_of(fluid, density, viscosity, wall)
        made = self.replace(known.changes(self.robot, gravity))
        made._held[_FLUID] = known
        return made

    @property
    def fluid(self) -> Fluid | None:
        """The fluid of `in_fluid`, or of ``[fluid]`` of a file."""
        return self._held.get(_FLUID)

    def without_record(self) -> Scenario:
        """A copy of which a run keeps its summary alone."""
        # Whether the summary has this number is no matter of the record.
        keys = {key.name: key.default for key in keys_of("record")}
        return self.replace({**keys, "record.pull_share": self.record.pull_share})

    def with_state(self, state: State) -> Scenario:
        """A copy that begins at `state`, such as ``run.final_state``."""
        check_kind("initial", state, State)
        made = self._copy()
        made._core.take(state._core, "initial")
        made._check()
        return made

    def with_uncertain(
        self, uncertain: JointPrior | Mapping[str, Any] | Scenario | None
    ) -> Scenario:
        """A copy with other uncertain parameters, or none.

        From a Scenario, such as `Diagnosis.extended`, it takes the uncertain parameters, and the
        values of the keys in its covariance, which are the means.
        """
        made = self._copy()
        if isinstance(uncertain, Scenario):
            source, uncertain = uncertain, uncertain.uncertain
            if uncertain is None:
                raise ScenarioError("uncertain: the scenario has no uncertain parameter")
            made = self.replace({key: source.get(key) for key in uncertain.keys})
        made._uncertain = None if uncertain is None else as_joint_prior(uncertain)
        made._check()
        return made

    def draws(self, n: int, seed: int = 0) -> list[Scenario]:
        """Scenarios with drawn values of the uncertain parameters, and none uncertain themselves.

        Draw number i is the same for every `n`. Values that make no scenario together are drawn
        again.

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
        return self.counted_draws(n, seed)[0]

    def counted_draws(self, n: int, seed: int) -> tuple[list[Scenario], int]:
        """See `draws`; and how many draws besides made no scenario."""
        check_whole("n", n, 1)
        check_whole("seed", seed)
        prior = self._uncertain
        if prior is None:
            raise ScenarioError("uncertain: the scenario has no uncertain parameter to draw")
        known = self.with_uncertain(None)
        drawn = [known.drawn(prior, np.random.default_rng([int(seed), i])) for i in range(n)]
        return [scenario for scenario, _ in drawn], sum(refused for _, refused in drawn)

    def drawn(self, prior: JointPrior, random: np.random.Generator) -> tuple[Scenario, int]:
        """A scenario with values drawn from a prior; and how many draws before it made none."""
        middle = {key: float(self.get(key)) for key in prior.keys}
        for refused in range(_MOST_DRAWS):
            try:
                return self.replace(prior.draw(middle, random)), refused
            except ScenarioError as error:
                last = error
        raise ScenarioError(
            f"[uncertain]: {_MOST_DRAWS} draws in succession make no scenario, so hardly any is "
            f"allowed; the last: {last}"
        )

    @property
    def duration(self) -> float:
        """Simulated time from start to end, s."""
        return self._core.duration

    @property
    def window(self) -> tuple[float, float]:
        """Times between which the mean velocity is taken, s (section VII of the paper).

        From the end of the third pulse to the end of the last; from the end of the ramp with three
        pulses or fewer; all of a program.
        """
        return self._core.window

    @property
    def pulse_rate(self) -> float:
        """Pulses a second, Hz: of no drive, periods of the shake; of a program 0."""
        return self._core.pulse_rate

    @property
    def whole_plane(self) -> bool:
        """Whether the robot moves in the whole plane, and not along x alone.

        True with a heading of the drive that is not along x, a start that faces another way than
        the drive's direction, voltages of yp and ym that do not cancel, a measured map of the
        field, or a start, a field or a slope across x.
        """
        return self._core.whole_plane

    def to_core(self) -> _core.Scenario:
        """The same scenario for the compiled core, with the effects registered now."""
        return _core.Scenario(self._core)

    def _state(self) -> tuple[dict[str, Value], list[Any], Any]:
        return self._core.changed(), [self._held.get(key) for key in OBJECTS], self._uncertain

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scenario) and self._state() == other._state()

    def __hash__(self) -> int:
        changed, objects, uncertain = self._state()
        return hash((tuple(changed.items()), *objects, uncertain))

    def __reduce__(self) -> tuple[Any, ...]:
        return Scenario.of_document, (self.document(),)

    def __repr__(self) -> str:
        names = (*SECTIONS, "effects", "laws", "uncertain")
        values = {name: getattr(self, name) for name in names}
        values["effects"] = {name: dict(part) for name, part in self.effects.items()}
        values["laws"] = dict(self.laws)
        return f"Scenario({', '.join(f'{name}={value!r}' for name, value in values.items())})"

    def _repr_html_(self) -> str:
        """A table of all objects, of the drive's keys, and of others not at their defaults."""
        rows = [(key, str(held)) for key, held in self._held.items()]
        changed = self._core.changed()
        for key in known_keys().values():
            if key.name in changed or (key.section == "drive" and PROGRAM not in self._held):
                rows.append((key.name, _shown(key, self._core.get(key.name))))
        rows += [(f"{LAWS}{name}", law.text) for name, law in self.laws.items()]
        if self._uncertain is not None:
            rows.append(("uncertain", ", ".join(self._uncertain.names)))
        rows.append(("duration", f"{self.duration:.6g} s"))
        return html_table("Scenario; other keys have their defaults", rows)


_DEFAULT = Scenario()


def _of_stated(read: Stated) -> Scenario:
    """The scenario of a file; what stands there counts, and not what its fluid would set."""
    changes = read.changes
    made = _DEFAULT.replace(changes)
    for key, given in read.held.items():
        if not {"drag.linear", "environment.gravity"} <= changes.keys():
            made = made.replace({**given.changes(made.robot, 9.81), **changes})
        made._held[key] = given
    return made if read.uncertain is None else made.with_uncertain(read.uncertain)


def _shown(key: Key, value: Value) -> str:
    if isinstance(value, str):
        return value
    factor, unit = handy(key.unit)
    return f"{value * factor:.6g} {unit}".rstrip()


def load(path: str | PathLike[str]) -> Scenario:
    """Read a scenario file.

    Parameters
    ----------
    path : path-like
        A TOML file with ``stickslip = 1`` and a section ``[drive]``.

    Raises
    ------
    ScenarioError
        If the file cannot be read, is not such a file, or holds a key or value that is not allowed.
    """
    return loaded(path)[0]


def loaded(path: str | PathLike[str]) -> tuple[Scenario, list[Path]]:
    """The scenario of a file, and all files that it was read from."""
    path = Path(path)
    with prefixed(path):
        read = stated(read_document(path), path.parent)
        return _of_stated(read), [path, *read.files]


def with_uncertain_of(scenario: Scenario, path: str | PathLike[str]) -> Scenario:
    """The scenario with the uncertain parameters of a file: any TOML with ``[uncertain]``.

    See `Scenario.with_uncertain`. A ScenarioError if the file has none, or cannot be read.
    """
    path = Path(path)
    with prefixed(path):
        document = read_document(path)
        if "uncertain" not in document:
            raise ScenarioError("there is no section [uncertain]")
        if "stickslip" not in document:
            return scenario.with_uncertain(document["uncertain"])
    return scenario.with_uncertain(load(path))


def load_with(path: Path, set: Mapping[str, Any]) -> tuple[Scenario, list[Path]]:
    """The scenario of a file with other values, and all files that it was read from.

    Voltages replace the whole drive but its direction.
    """
    scenario, files = loaded(path)
    changes = dict(set)
    with prefixed("--set"):
        if FILE in changes:
            changes.setdefault("drive.mode", "program")
        elif changes.get("drive.mode", "program") != "program":
            changes[PROGRAM] = None
        files += with_files(changes, Path())
        scenario = scenario.replace(changes)
    return scenario, files


def load_uncertain(
    path: Path, set: Mapping[str, Any], uncertain: Path | None
) -> tuple[Scenario, list[Path]]:
    """The same, with the uncertain parameters of another file, if there is one.

    A ScenarioError names a value of ``--set`` that has no influence, as the key is uncertain.
    """
    scenario, read = load_with(path, set)
    drawn = scenario if uncertain is None else with_uncertain_of(scenario, uncertain)
    priors = {} if drawn.uncertain is None else drawn.uncertain.priors
    for key in set:
        if key not in PATHS and (key in priors or drawn.get(key) != scenario.get(key)):
            raise ScenarioError(f"--set {key}: has no influence, as it is uncertain")
    return drawn, read if uncertain is None else [*read, uncertain]
