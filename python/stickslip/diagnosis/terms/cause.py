"""Whatever may be wrong with a model or its data, as one type."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from stickslip._util.arrays import Array
from stickslip._util.messages import known_arguments, refuse
from stickslip._util.note import Note
from stickslip._util.text import OneLine, printable
from stickslip.diagnosis.data.signal import Signal
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.curve import CURVE, Curve
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.errors import ScenarioError

Read = Callable[[Array, Array, dict[str, Array], Table], Array]
"""How an instrument reads; see `Cause`."""

Acts = Callable[[Signal, dict[str, Array]], Signal]
"""How an input acts; see `Cause`."""


@known_arguments
@dataclass(frozen=True, repr=False, eq=False)
class Cause(OneLine):
    """A term that may be added to a model.

    Attributes
    ----------
    name : str
    meaning : str
        A noun, such as ``dry friction``: reports make sentences with it.
    parameters : tuple of Parameter
        Amplitudes and shapes. None for a constant that is other than stated.
    frees : str, optional
        Name of the constant whose prior this cause relaxes: the evidence is the mean over priors
        10 and 100 times as wide. A law of a free shape relaxes the constant that it replaces.
    read : callable, optional
        Of an instrument: ``read(readings, predicted, p, table)`` returns what it makes of the
        readings, shape (vectors, rows); `predicted` is what the physics predicts, of the same
        shape, and ``p[name]`` a parameter, shape (vectors, 1). With `input` it changes that input
        of a `Series`; `predicted` is then the input as it was recorded.
    table : str, optional
        Name of the table that an instrument reads; all of them, if not given.
    input : str, optional
        Name of the input that `read` changes; the readings, if not given.
    acts : callable, optional
        In place of `read`, of an input, with when it acts: ``acts(signal, p)``.
    told : callable, optional
        ``told(value, amount, step)`` is a sentence on its first parameter, of which `amount` is a
        text with error and unit, for readings that are `step` apart, s.
    curve : Curve, optional
        Of a law of another shape, whose values at the knots, or amplitude and scale, are the
        parameters. Forms of one law have one name.
    odds : float
        Prior probability beside that of a listed cause.
    listed : bool
        Whether it may be claimed; others compete, and are said.
    between : (float, float), optional
        Of an event: the times between which it happens, s.

    Raises
    ------
    ScenarioError
        If a value is not allowed.
    """

    name: str
    parameters: tuple[Parameter, ...] = ()
    meaning: str = ""
    frees: str | None = None
    read: Read | None = field(default=None, repr=False)
    table: str | None = None
    input: str | None = None
    acts: Acts | None = field(default=None, repr=False)
    told: Callable[[float, str, float], str] | None = field(default=None, repr=False)
    curve: Curve | None = None
    between: tuple[float, float] | None = None
    odds: float = 1.0
    listed: bool = True

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or self.name in ("", "none") or "+" in self.name:
            refuse("name of a cause", self.name, 'a text other than "none", without "+"')
        if isinstance(self.parameters, Parameter):
            object.__setattr__(self, "parameters", (self.parameters,))
        given = self.parameters
        if not isinstance(given, tuple | list) or not all(isinstance(p, Parameter) for p in given):
            raise ScenarioError(f"cause {self.name}: parameters: allowed are Parameters")
        object.__setattr__(self, "parameters", tuple(given))
        if not self.parameters and self.frees is None:
            raise ScenarioError(f"cause {self.name} has no Parameter: allowed are one or more")

    @property
    def is_constant(self) -> bool:
        """Whether it is a constant other than stated."""
        return not self.parameters

    @property
    def names(self) -> list[str]:
        """Full names of its parameters, or of the constant that it frees."""
        return [parameter.name for parameter in self.parameters] or [str(self.frees)]

    @property
    def is_instrument(self) -> bool:
        """Whether it changes readings or inputs in place of the physics."""
        return self.read is not None or self.acts is not None

    def acted(self, signal: Signal, p: dict[str, Array], table: Table, given: Array) -> Signal:
        """The input as it acts, which was recorded as `given`, (vectors, rows)."""
        if self.acts is not None:
            return self.acts(signal, p)
        assert self.read is not None
        read = self.read(signal.sampled(), given, p, table)
        return Signal.of(signal.t, read, signal.held)

    @property
    def has_knots(self) -> bool:
        """Whether its parameters are values of a curve at knots."""
        return self.curve is not None and self.curve.form == CURVE


class CauseNote(Note):
    """A note on causes: each ``{}`` of its `form` stands for one of them, or for some of a model.

    Its text has their names; reports have words for them.
    """

    def __init__(
        self, code: str, form: str, causes: Sequence[str], value: float | None = None
    ) -> None:
        super().__init__(code, form.format(*causes), value)
        vars(self).update(form=form, causes=causes)

    def titled(self, title: Callable[[str], str]) -> str:
        """Its text with the `title` of each in place of its name."""
        form, causes = vars(self)["form"], vars(self)["causes"]
        return printable(form.format(*map(title, causes)))
