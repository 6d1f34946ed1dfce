"""The common part of all models: their terms, the causes that these become, and their readings."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri
from scipy.stats.qmc import Halton

from stickslip._util.arrays import Array, root_mean_square
from stickslip._util.messages import meant, refuse
from stickslip._util.prior import Prior
from stickslip._util.text import OneLine, brief, is_number
from stickslip._util.units import same_unit
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.terms import instruments
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import LARGEST_ERROR, Parameter
from stickslip.errors import ScenarioError, prefixed
from stickslip.models.log import Columns
from stickslip.models.physics import Inputs

Known = float | tuple[float, float] | Prior | Mapping[str, float]
"""Knowledge of a term: its value; its value and standard deviation; a Prior, or a table of one."""

Physics = Callable[[Array, Inputs, Mapping[str, Array]], Array]
"""``physics(t, inputs, values)``: states, (readings, states, vectors), at times, (readings,).
Values by name, (vectors,), have the usual `step` of the readings too, s."""

_KNOWN = 'a number, (value, error), a Prior, or a table such as {"min": 0.1, "max": 0.3}'

_COARSE = 100
"""Parts of a record between whose ends slopes are taken for the usual size of a derivative. Chosen:
noise of a dense log counts little there, and what is faster is rarely asked."""

_LEAST = 1e-3  # of its middle: a constant above zero; chosen, a wrong unit
_COARSE_STEP = 0.02  # of a lag, beyond which a step of the log is told beside it; chosen
_TRIED, _NEARER = 256, 21  # values of all ranges, and from the best to a middle; chosen: cheap
_BEGINNINGS = 1000, 3000, 9000  # readings for that, with half of what happens; chosen: 0.1 s
_CLEAR = 0.05  # of what the middles leave: evidence against a value; chosen: little of a log
_ABOVE, _BELOW = 1.2, 0.1  # where limits act: of the largest input; chosen, as for `clipping`


@dataclass(frozen=True)
class Term:
    """A row of a model's table: a constant, an effect, or the shape of an effect.

    Attributes
    ----------
    name, unit, meaning : str
    size : float
        Of an effect: how large it usually is, in the scale `of`. Of a shape: its largest value; the
        least is a hundredth. 0 of a constant.
    of : str
        Scales of the log and constants, such as ``"force / speed"``.
    signed : bool
        Whether an effect may have either sign; a constant has to be above zero otherwise.
    falls : bool
        Whether an effect acts as it falls, such as a limit.
    value : float, optional
        Of a constant that need not be stated.
    shape : Term, optional
        What an effect has beside its size.
    more : str
        What a reader of its reference should know besides.
    """

    name: str
    unit: str
    meaning: str
    size: float = 0.0
    of: str = ""
    signed: bool = False
    falls: bool = False
    value: float | None = None
    shape: Term | None = None
    more: str = ""

    @property
    def absent(self) -> float | None:
        """Its value where nothing is said of it."""
        return self.value if not self.size else math.inf if self.falls else 0.0

    def usual(self, scales: Mapping[str, float]) -> float:
        """Its size in its unit."""
        over, _, under = self.of.partition("/")
        above = math.prod(scales[name] for name in over.split() if name != "1")
        return self.size * above / math.prod(scales[name] for name in under.split())

    def parameter(self, prior: Prior) -> Parameter:
        """As an uncertain constant."""
        least = _LEAST * float(prior.value(0.0))
        if not prior.has_middle:  # its own low end, if that is above zero
            least = max(prior.first, _LEAST * least)
        low = -math.inf if self.signed else 0.0 if self.size else least
        return Parameter(self.name, prior, self.unit, low)

    def ranged(self, scales: Mapping[str, float]) -> Parameter:
        """As a shape of which only the range is known."""
        largest = self.usual(scales)
        prior = Prior("log-uniform", 0.01 * largest, largest)
        return Parameter(self.name, prior, self.unit, cause=False)

    def cause(self, scales: Mapping[str, float], known: Mapping[str, object]) -> Cause:
        """As a cause of its usual size."""
        size = self.usual(scales)
        low, high = -LARGEST_ERROR * size if self.signed else 0.0, LARGEST_ERROR * size
        if self.falls:
            low, high, size = _BELOW * size, _ABOVE * size, _BELOW * _ABOVE * size
        one = Parameter(self.name, None, self.unit, low, high, size, self.absent or 0.0, self.falls)
        shape = self.shape
        more = () if shape is None or shape.name in known else (shape.ranged(scales),)
        return Cause(self.name, (one, *more), self.meaning)


@dataclass(frozen=True)
class Sensor:
    """A usual error of a reading, or of an `input`.

    `makes` is the function of `instruments`, with a unit first where it `has_unit`. A `size` of a
    time is at least a step. `told` is that of its cause, where inputs are held between readings.
    """

    name: str
    makes: Callable[..., Cause]
    size: float
    of: str = "1"
    input: str | None = None
    has_unit: bool = False
    told: Callable[[float, str, float], str] | None = None

    def cause(self, scales: Mapping[str, float], unit: str, held: bool) -> Cause:
        """As a cause of its usual size, where inputs are held between readings or not."""
        size = Term("", "", "", self.size, self.of).usual(scales)
        if self.of == "time":
            size = max(size, scales["step"])
        more = {} if self.input is None else {"input": self.input}
        made = self.makes(*([unit] if self.has_unit else []), size=size, name=self.name, **more)
        return replace(made, told=self.told) if held and self.told is not None else made


def slow_in_words(time: float, amount: str, step: float) -> str:
    """A sentence on slow readings: a held input acts from the reading after its switch on."""
    text = f"A lag of the readings: time = {amount}"
    more = f"; up to {step:.3g} s (one step) more if the input switched between two readings"
    return f"{text}{more if step > _COARSE_STEP * time else ''}."


@dataclass(frozen=True)
class Kind:
    """The table of a kind of model.

    Attributes
    ----------
    name : str
    physics : callable
    terms : tuple of Term
    states : tuple of (str, str)
        Start states: name, and unit.
    reads : dict
        Of what may be read: the number of its state, and of its start state.
    inputs : dict
        Units by name.
    sensors : tuple of Sensor
    inertia : str
        Constant that makes a force of the fastest derivative.
    drives : tuple of str
        Inputs of which a log has to have one, as nothing happens without; none of what moves by
        itself.
    command : callable, optional
        ``command(record, constants)``: what drives a record; the first input, if not given.
    per_command : str
        The force of a unit of the command, by constants; as `Term.of`.
    placed : frozenset of str
        Effects by which readings depend on the first start state, though another one is read.
    also : dict
        What else columns of logs are called, by input.
    needs : dict
        Of what else may drive it, by name: the unit, and what to state for that.
    """

    name: str
    physics: Physics
    terms: tuple[Term, ...]
    states: tuple[tuple[str, str], ...]
    reads: Mapping[str, tuple[int, int]]
    inputs: Mapping[str, str]
    sensors: tuple[Sensor, ...]
    inertia: str = ""
    drives: tuple[str, ...] = ()
    command: Callable[[Series, Mapping[str, float]], Array] | None = None
    per_command: str = "1"
    placed: frozenset[str] = frozenset()
    also: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    needs: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    @property
    def every(self) -> dict[str, Term]:
        """All terms, with shapes and start states, by name."""
        shapes = (term.shape for term in self.terms if term.shape is not None)
        more = "one for each record is found, if not stated"
        starts = (Term(name, unit, "at the first reading", signed=True, value=0.0, more=more)
                  for name, unit in self.states)  # fmt: skip
        return {term.name: term for term in (*self.terms, *shapes, *starts)}


@dataclass(frozen=True, repr=False, eq=False)
class Model(OneLine):
    """A model of a log, with what is known of it and the usual causes: for `diagnose_model`.

    What is stated is a constant; each effect that is not stated is a cause. It is called with a
    `Series` and values by name, as any ``predict(table, p)``.

    Attributes
    ----------
    kind : Kind
    reads : str
    known : dict
        Values and priors by name.
    without : tuple of str
        Causes that are left out.
    smooth : bool
        Whether inputs change evenly between two readings; they are held otherwise.
    """

    kind: Kind
    reads: str
    known: Mapping[str, float | Prior]
    without: tuple[str, ...] = ()
    smooth: bool = False

    def __call__(self, record: Series, p: Mapping[str, Array]) -> Array:
        self._check_record(record)
        signals = {name: record.signal(name, held=not self.smooth) for name in self.kind.inputs
                   if name in record.inputs}  # fmt: skip
        columns = (*p.values(), *(signal.values for signal in signals.values()))
        vectors = max((len(array) for array in columns), default=1)
        values = {}
        for name, term in self.kind.every.items():
            stated = self.known.get(name)
            value = p[name][:, 0] if name in p else term.absent if stated is None else stated
            values[name] = np.broadcast_to(np.asarray(value, dtype=float), vectors)
        values["step"] = np.full(vectors, record.step)
        shape = 1 + len(record.t), vectors
        acts = {name: np.broadcast_to(np.vstack([each.first, each.values.T]), shape)
                for name, each in signals.items()}  # fmt: skip
        late = {name: np.broadcast_to(each.late, vectors) for name, each in signals.items()}
        inputs = Inputs(record.t[:, None], acts, late, self.smooth)
        with np.errstate(all="ignore"):
            states = self.kind.physics(record.t, inputs, values)
        return np.asarray(states[:, self.kind.reads[self.reads][0]].T)

    @property
    def middles(self) -> dict[str, float]:
        """Values by name, of a prior that of its middle."""
        return {name: float(value.value(0.0)) if isinstance(value, Prior) else value
                for name, value in self.known.items()}  # fmt: skip

    @property
    def unit(self) -> str:
        """Unit of the readings."""
        return self.kind.states[self.kind.reads[self.reads][1]][1]

    @property
    def columns(self) -> Columns:
        """Columns of a log that it takes, for `read_log`."""
        kind = self.kind
        constants = kind.every.keys() & kind.inputs.keys() - self.known.keys()
        return Columns(self.reads, self.unit, self._input_units, constants=constants,
                       drives=kind.drives, also=kind.also, needs=kind.needs)  # fmt: skip

    @property
    def _input_units(self) -> dict[str, tuple[str, ...]]:
        """Units in which each input may be."""
        units = {name: tuple(unit.split(" or ")) for name, unit in self.kind.inputs.items()}
        if "supply" in units and self.known.get("supply") != 1.0:
            units["duty"] = ("-",)  # one in V would be multiplied by the supply
        return units

    def simulate(
        self, t: ArrayLike, inputs: Mapping[str, ArrayLike] | None = None, **values: float
    ) -> Array:
        """Readings at the times `t`, s, of inputs by name, each of shape (readings,).

        Effects are absent, uncertain constants at the middle of their priors, and start states 0,
        where no value is given.

        Raises
        ------
        ScenarioError
            If a name is unknown or a value is not allowed, as where a model is made.
        """
        stated = replace(self, known={**self.known, **_stated(self.kind, values)})
        record = Series(t, np.zeros(np.shape(np.asarray(t))), inputs, sd=1.0)
        p = {name: np.array([[value]]) for name, value in stated.middles.items()}
        return np.asarray(stated(record, p)[0])

    def terms(self, data: Any) -> tuple[list[Parameter], list[Cause]]:
        """Uncertain parameters, and causes of usual sizes, for a `Series` or a list of them.

        Raises
        ------
        ScenarioError
            If the data are no series, or their unit or inputs are none of the model's.
        """
        kind = self.kind
        records = data if isinstance(data, Sequence) else [data]
        for record in records or [data]:
            self._check_record(record)
            for name in record.inputs.keys() & self.known.keys():
                raise ScenarioError(
                    f"{record.at}{name} is an input, and stated too: allowed is one of these; "
                    f"state no {name}, or leave out the input (in a file, rename its column)"
                )
        scales = self._scales(records)
        uncertain = [kind.every[name].parameter(prior) for name, prior in self.known.items()
                     if isinstance(prior, Prior)]  # fmt: skip
        causes = []
        for term in kind.terms:
            if not term.size:
                continue
            if term.name not in self.known:
                causes.append(term.cause(scales, self.known))
            elif term.shape is not None and term.shape.name not in self.known:
                uncertain.append(term.shape.ranged(scales))
        acting = set.intersection(*(set(record.inputs) for record in records))
        # A free start undoes a wrong zero of a place on which nothing depends.
        placed = kind.placed & {*(cause.name for cause in causes), *self.known}
        free = len(kind.states) > 1 and kind.reads[self.reads][1] == 0
        undone = free and not placed and kind.states[0][0] not in self.known
        held = bool(acting) and not self.smooth
        causes += [sensor.cause(scales, self.unit, held) for sensor in kind.sensors
                   if (sensor.input is None or sensor.input in acting)
                   and not (undone and sensor.makes is instruments.offset)]  # fmt: skip
        for name in self.without:
            if name not in {cause.name for cause in causes}:
                allowed = ", ".join(cause.name for cause in causes)
                raise ScenarioError(f"{kind.name}: without = {name}: allowed is one of {allowed}")
        causes = [cause for cause in causes if cause.name not in self.without]
        uncertain += self._starts(records, scales, {cause.name for cause in causes})
        return uncertain, causes

    def _starts(
        self, records: Sequence[Series], scales: Mapping[str, float], causes: set[str]
    ) -> list[Parameter]:
        """Start states that are not known, and count."""
        read = self.kind.reads[self.reads][1]
        first = np.array([record.y[0] for record in records])
        starts = []
        for k, (name, unit) in enumerate(self.kind.states):
            if name in self.known or (k < read and not self.kind.placed & {*causes, *self.known}):
                continue
            size, middle = scales[("length", "speed")[k]], 0.0
            if k == read:
                middle, size = float(first.mean()), max(float(np.ptp(first)), size)
            prior = Prior("normal", middle, size)
            starts.append(Parameter(name, prior, unit, cause=False, each_record=True))
        return starts

    def _scales(self, records: Sequence[Series]) -> dict[str, float]:
        """Usual sizes of the log's quantities, and the stated constants."""
        y = np.concatenate([record.y - record.y.mean() for record in records])
        slope = np.concatenate([_slopes(record) for record in records])
        size, change = root_mean_square(y) or 1.0, root_mean_square(slope) or 1.0
        made = {term.name: 1.0 if term.value is None else term.value
                for term in self.kind.terms if not term.size}  # fmt: skip
        made |= self.middles | self._in_ranges(records)
        # Before scales, of which one is a length too.
        per_command = Term("", "", "", 1.0, self.kind.per_command).usual(made)
        first = next(iter(self.kind.inputs))
        command = self.kind.command or (lambda record, _: record.inputs.get(first, np.zeros(0)))
        acts = np.concatenate([*(command(record, made) for record in records), np.zeros(0)])
        acts = acts if len(acts) else np.zeros(1)
        if self.kind.reads[self.reads][1] == 1:
            made |= {"length": size**2 / change, "speed": size, "acceleration": change}
        else:
            made |= {"length": size, "speed": change, "acceleration": change**2 / size}
        made |= {"reading": size, "input": root_mean_square(acts), "peak": float(abs(acts).max())}
        made["step"] = max(record.step for record in records)
        fastest = made[("speed", "acceleration")[len(self.kind.states) - 1]]
        made["force"] = max(
            made.get(self.kind.inertia, 1.0) * fastest,
            per_command * made["input"], 1e-300,
            # A weight that is stated acts too, where the inertia may be what is wrong.
            *(abs(made.get(term.name, 0.0)) for term in self.kind.terms
              if term.of == "force" and term.signed),
        )  # fmt: skip
        # A spring whose ringing the readings resolve.
        ringing = 4.0 * made["step"] ** 2 / made.get(self.kind.inertia, 1.0)
        made["deflection"] = max(0.02 * made["length"] / made["force"], ringing)
        made["input"], made["peak"] = made["input"] or 1.0, made["peak"] or 1.0
        made["time"] = made["length"] / made["speed"]
        return made

    def _in_ranges(self, records: Sequence[Series]) -> dict[str, float]:
        """Constants of which only a range is known, where the model is most like the readings.

        Each as near its middle as is nearly as likely, as it may change no reading.
        """
        ranges = {name: prior for name, prior in self.known.items()
                  if isinstance(prior, Prior) and not prior.has_middle}  # fmt: skip
        if not ranges:
            return {}
        p = {name: np.array([[value]]) for name, value in self.middles.items()}
        start, shorts = self.kind.states[self.kind.reads[self.reads][1]][0], []
        for record in records:
            rows = np.array([record.y, *record.inputs.values()])
            enough = (n for n in _BEGINNINGS if np.all(2.0 * rows[:, :n].std(1) >= rows.std(1)))
            shorts.append(record.first_readings(next(enough, _BEGINNINGS[-1])))

        def left(z: Array) -> Array:  # each from its first reading, and up to a wrong zero
            tried = {name: ranges[name].value(z[:, [k]]) for k, name in enumerate(ranges)}
            made = (self(each, {start: each.y[None, :1], **p, **tried}) - each.y for each in shorts)
            square = np.sum([np.var(each, axis=1) for each in made], axis=0)
            return np.where(np.isfinite(square), square, math.inf)

        z = ndtri(Halton(len(ranges), scramble=False).random(_TRIED))
        z[0] = 0.0  # the middles
        of_all = left(z)
        best, least = z[np.argmin(of_all)], float(of_all.min())
        likely = least + min(least, _CLEAR * of_all[0])
        for k in range(len(ranges)):
            nearer = np.tile(best, (_NEARER, 1))
            nearer[:, k] *= np.linspace(0.0, 1.0, _NEARER)
            best = nearer[np.argmax(left(nearer) <= likely)]
        return {name: float(ranges[name].value(best[k])) for k, name in enumerate(ranges)}

    def _check_record(self, record: Any) -> None:
        unit, known = self.unit, self.kind.inputs
        if not isinstance(record, Series):
            allowed = "a Series or a list of them"
            raise ScenarioError(f"{self.kind.name}: data = {brief(record)}: allowed is {allowed}")
        if record.unit != "-" and not same_unit(record.unit, unit):
            refuse(f"{record.at}unit", record.unit, f"{unit}, which a {self.kind.name} reads")
        for name in record.inputs:
            if name not in known:
                allowed = " and ".join(f"{key} ({unit_of})" for key, unit_of in known.items())
                if name in self.kind.needs:
                    allowed += f"; for a {name} {self.kind.needs[name][1]}"
                raise ScenarioError(
                    f"{record.at}input {name}: a {self.kind.name} has {allowed}{meant(name, known)}"
                )
            units, carried = self._input_units[name], record.input_units.get(name)
            if carried and not any(same_unit(carried, each) for each in units):
                refuse(f"{record.at}input {name}: unit", carried, " or ".join(units))
        for name in known.keys() - record.inputs.keys() - self.known.keys():
            if name in self.kind.every and self.kind.every[name].absent is None:
                allowed = f"a constant or an input, {known[name]}"
                raise ScenarioError(f"{record.at}{name} is missing: allowed is {allowed}")


def _stated(kind: Kind, known: Mapping[str, Any]) -> dict[str, float | Prior]:
    """What is known of a kind, by name; a ScenarioError if that is not allowed."""
    terms, stated = kind.every, {}
    for name, given in known.items():
        if name not in terms:
            text = f"there is no {name}{meant(name, terms)}; known are {', '.join(terms)}"
            raise ScenarioError(f"{kind.name}: {text}")
        term, at = terms[name], f"{kind.name}: {name}"
        stated[name] = value = _value(at, given)
        middle = float(value.value(0.0)) if isinstance(value, Prior) else value
        if not term.signed and not middle >= (1e-300, 0.0)[term.size > 0.0]:
            refuse(at, middle, f"a value {'from 0' if term.size else 'above 0'}, {term.unit}")
    return stated


def made(
    kind: Kind, reads: str, smooth: bool, without: Sequence[str], known: Mapping[str, Any]
) -> Model:
    """The model of a kind with what is known of it; a ScenarioError if that is not allowed."""
    if reads not in kind.reads:
        refuse(f"{kind.name}: reads", reads, " or ".join(kind.reads))
    if isinstance(without, str) or not isinstance(without, Sequence):
        refuse(f"{kind.name}: without", without, "a list of names of causes")
    stated = _stated(kind, known)
    for name, term in kind.every.items():
        if name not in stated and term.absent is None and name not in kind.inputs:
            raise ScenarioError(f"{kind.name}: {name} is missing: allowed is {_KNOWN}, {term.unit}")
    return Model(kind, reads, stated, tuple(without), bool(smooth))


def _value(at: str, given: object) -> float | Prior:
    if isinstance(given, Prior):
        return given
    if is_number(given) and math.isfinite(given):
        return float(given)
    with prefixed(at):
        if isinstance(given, tuple | list) and len(given) == 2:
            return Prior("normal", *given)
        prior = Prior.of_table(given) if isinstance(given, Mapping) else None
    if prior is not None:
        return prior
    refuse(at, given, _KNOWN)


def _slopes(record: Series) -> Array:
    """Slopes over the parts of a record."""
    at = np.unique(np.linspace(0, len(record) - 1, min(_COARSE, len(record))).astype(int))
    slopes = np.diff(record.y[at]) / np.diff(record.t[at])
    return slopes if len(at) > 1 else np.zeros(1)
