"""Laws of the user's own: how friction, adhesion and drag depend on the motion."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from stickslip import _core
from stickslip._util.messages import as_list, known_arguments, refuse, suggestion
from stickslip._util.text import is_number, literal
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import LAWS, Value, find_key, set_value

_KNOTS = 5

_TABLES = "a table [laws.NAME] for each law"


@known_arguments
@dataclass(frozen=True, kw_only=True)
class Law:
    """How a quantity of the contact or the fluid depends on the motion.

    With the form f and u = argument / scale the quantity becomes ``quantity + amount f(u)`` or
    ``quantity max(0, 1 + fraction f(u))``. Laws that add act before those that multiply.

    Parameters
    ----------
    quantity : str
        ``"friction"`` (both coefficients), ``"sliding_friction"`` (the kinetic one),
        ``"adhesion"`` (N), ``"drag"`` (force over velocity, N s/m), ``"rotational_drag"`` (torque
        over rate, N m s) or ``"fluid"`` (both drags, only by a fraction).
    over : str
        The argument. Of friction: ``"way"`` (+1 for slip to the robot's front, -1 to its rear),
        ``"place"`` (m, of the contact, in the world), ``"tilt"`` (rad, -pi to pi, nose-down
        positive), ``"load"`` (N, the normal force) or ``"time"`` (s, since the start of the run).
        Of sliding friction: ``"slip_speed"`` (m/s). Of adhesion and drag: ``"tilt"``, ``"time"``,
        ``"age"`` (s, of the contact since touch-down), ``"speed"`` (m/s, of the centre of mass) or
        ``"rate"`` (rad/s, size of that of the pitch).
    form : str
        f: ``"line"`` u, ``"square"`` u^2, ``"sine_squared"`` and ``"cosine_squared"`` of the pitch,
        ``"gaussian"`` exp(-u^2), ``"exponential"`` exp(-abs(u)), ``"logarithm"`` ln(1 + abs(u)),
        ``"saturation"`` u^2/(1 + u^2), ``"wave"`` sin u, or ``"curve"`` through `knots`.
    fraction, amount : float
        One of them: a part of the quantity, or a value in the quantity's unit.
    scale : float
        Above 0, in the unit of the argument; of a curve, the argument of the last knot. Not over
        the way or with a squared sine or cosine.
    knots : sequence of float
        Of a curve: five values of f, in a file and as keys also ``knot_1`` to ``knot_5``. They lie
        evenly from minus the scale to the scale over the pitch and the place, from 0 to the scale
        else; over the slip speed the first lies at a fifth of the scale, and f(0) = 0. Between
        them f is a cubic Hermite interpolant, beyond them constant.

    Examples
    --------
    >>> wear = Law(quantity="friction", over="time", form="exponential", scale=0.05, fraction=0.5)
    >>> scenario = Scenario(laws={"wear": wear})
    >>> scenario.replace({"laws.wear.fraction": 0.2}).laws["wear"].fraction
    0.2
    """

    quantity: str
    over: str
    form: str
    fraction: float | None = None
    amount: float | None = None
    scale: float | None = None
    knots: Sequence[float] | None = None

    def __post_init__(self) -> None:
        if self.knots is not None:
            object.__setattr__(self, "knots", _five("knots", self.knots))

    @property
    def text(self) -> str:
        """The law in one line."""
        given = {name: value for name, value in vars(self).items() if value is not None}
        return ", ".join(f"{name} = {value}" for name, value in given.items())


_FIELDS = tuple(field.name for field in fields(Law))


def is_law(key: str) -> bool:
    """Whether a key stands for a whole law: ``laws.NAME``."""
    return key.startswith(LAWS) and key.count(".") == 1


def flat_laws(settings: object) -> dict[str, Value]:
    """Values by dotted key of ``{name: law}``, where a law is a `Law` or a mapping of its keys."""
    if not isinstance(settings, Mapping):
        refuse("laws", settings, _TABLES)
    values: dict[str, Value] = {}
    for name, law in settings.items():
        if not isinstance(name, str):
            refuse("laws", settings, f"{_TABLES}, whose name is a word")
        given = vars(law) if isinstance(law, Law) else law
        if not isinstance(given, Mapping):
            allowed = _TABLES if name in _FIELDS else f"a Law, or a table [laws.{name}]"
            refuse(f"{LAWS}{name}", law, allowed)
        flat = _flat(f"{LAWS}{name}", given)
        if not flat:
            refuse(f"{LAWS}{name}", law, "a law with quantity, over, form and their numbers")
        values |= flat
    return values


def _flat(law: str, given: Mapping[str, Any]) -> dict[str, Value]:
    values: dict[str, Value] = {}
    for key, value in given.items():
        if value is None:
            continue
        if key == "knots":
            knots = enumerate(_five(f"{law}.knots", value), 1)
            changes = {f"{law}.knot_{k}": height for k, height in knots}
        else:
            changes = {find_key(f"{law}.{key}", value).name: value}
        twice = next((key for key in changes if key in values), None)
        if twice is not None:
            raise ScenarioError(f"{twice} beside {law}.knots: allowed is one of both")
        values |= changes
    return values


def _five(name: str, knots: object) -> tuple[Any, ...]:
    allowed = "a list of five numbers"
    values = as_list(name, knots, allowed)
    if len(values) != _KNOTS:
        refuse(name, knots, allowed)
    # A whole number may be too long for a float.
    return tuple(
        float(knot) if is_number(knot) and not isinstance(knot, int) else knot for knot in values
    )


def refuse_unknown_laws(core: _core.Scenario, keys: Collection[str]) -> None:
    """Refuse a key of a law that a scenario of the core has not and that no other key makes."""
    for key in keys:
        if not key.startswith(LAWS) or is_law(key):
            continue
        law = key.rpartition(".")[0]
        quantity = f"{law}.quantity"
        if law in keys or quantity in keys:
            continue
        try:
            core.get(quantity)
        except ValueError:
            find_key(key)
            known = [f"{LAWS}{name}" for name, _ in laws_of(core)]
            if not known:
                allowed = find_key(quantity).allowed
                raise ScenarioError(f"{quantity} is missing: allowed is {allowed}") from None
            hint = suggestion(law, known)
            raise ScenarioError(f"{key}: there is no law {law} here; {hint}") from None


def set_law(core: _core.Scenario, key: str, law: object) -> None:
    """Put a `Law`, or a mapping of its keys, in the place of ``laws.NAME``; None removes it."""
    name = key.removeprefix(LAWS)
    values = {} if law is None else flat_laws({name: law})
    core.remove_law(name)
    for full, value in values.items():
        set_value(core, full, value)


def laws_of(core: _core.Scenario) -> Iterator[tuple[str, Law]]:
    """Name and law of each that a scenario of the core has."""
    laws: dict[str, dict[str, Any]] = {}
    for key, value in core.changed().items():
        if key.startswith(LAWS):
            _, name, part = key.split(".")
            law = laws.setdefault(name, {})
            if part.startswith("knot_"):
                law.setdefault("knots", [0.0] * _KNOTS)[int(part[-1]) - 1] = value
            else:
                law[part] = value
    for name, law in laws.items():
        law["knots"] = tuple(law["knots"]) if "knots" in law else None
        yield name, Law(**law)


def law_lines(name: str, law: Law) -> list[str]:
    """The lines of its section in a scenario's file."""
    lines = ["", f"[{LAWS}{name}]"]
    for field in _FIELDS:
        value = getattr(law, field)
        if value is not None:
            lines.append(f"{field} = {literal(value)}")
    return lines
