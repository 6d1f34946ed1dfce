"""The effects of the model, and those that a user registers: a force from a function."""

from __future__ import annotations

import ctypes
import numbers
from collections.abc import Callable, Iterable, Mapping
from dataclasses import astuple, dataclass
from typing import Any, NamedTuple

from stickslip import _core
from stickslip._util.messages import known_arguments, refuse, shown, suggestion
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import PREFIX, Key, keys_of, known_keys, until_registration

UNSTATED = "not stated; registered by the user"
"""Source of an effect for which none is given."""

Wrench = Callable[[Any, tuple[float, ...]], tuple[float, float, float]]

_FUNCTION_OF_CTYPES: Any = ctypes.CFUNCTYPE(None).__base__


@dataclass(frozen=True)
class Effect:
    """An effect of the model.

    Attributes
    ----------
    name : str
        Name of its section: ``[effects.<name>]``.
    meaning : str
        Its contribution to the model, in a sentence.
    source : str
        Where its equation is from.
    parameters : tuple of Key
        Its parameters with units and ranges. The effect is absent while all have their defaults.
    """

    name: str
    meaning: str
    source: str
    parameters: tuple[Key, ...]


@until_registration
def effects() -> tuple[Effect, ...]:
    """All effects of the model, then those of `register_effect`.

    Returns
    -------
    tuple of Effect

    Examples
    --------
    >>> tilt = next(effect for effect in effects() if effect.name == "surface_tilt")
    >>> [key.name for key in tilt.parameters]
    ['effects.surface_tilt.angle', 'effects.surface_tilt.azimuth']
    """
    return tuple(
        Effect(row["name"], row["meaning"], row["source"], keys_of(PREFIX + row["name"]))
        for row in _core.effects()
    )


def is_free_shape(name: str) -> bool:
    """Whether the model's own effect `name` is a curve of free shape.

    Its parameters are a ``span`` and the knots ``knot_1`` to ``knot_5``; see `theory/effects.md`.
    """
    return name.startswith("free_") and f"{PREFIX}{name}.knot_1" in known_keys()


def suggested_effect(name: str) -> str:
    """The effect that `name` probably means, or all effects.

    Effects of free shape are many and alike, and are not listed.
    """
    names = [effect.name for effect in effects()]
    listed = [name for name in names if not is_free_shape(name)]
    return suggestion(name, names, listed)


def flat_effects(settings: object) -> dict[str, Any]:
    """Values by dotted key of ``{name: {parameter: value}}``, as `Scenario` takes effects."""
    if not isinstance(settings, Mapping):
        refuse("effects", settings, "a table [effects.<name>] for each effect")
    names = [effect.name for effect in effects()]
    values: dict[str, Any] = {}
    for name, parameters in settings.items():
        if name not in names:
            hint = suggested_effect(str(name))
            raise ScenarioError(
                f"effects.{name} = {shown(parameters)}: there is no such effect; {hint}; "
                "an effect of your own has to be registered first"
            )
        if not isinstance(parameters, Mapping):
            refuse(f"effects.{name}", parameters, f"a table [effects.{name}]")
        values |= {f"{PREFIX}{name}.{key}": value for key, value in parameters.items()}
    return values


class EffectState(NamedTuple):
    """The state that the function of an effect receives.

    Positions, velocities and fields are in the world's frame, x along the surface and z away from
    it. Angles are the robot's own, nose-down positive whichever way it faces, as in a `Run`. A
    compiled function gets the same nine numbers in this order.

    Attributes
    ----------
    t : float
        Time since the start of the run, s.
    x, z : float
        Centre of mass, z above the surface, m.
    theta : float
        Pitch angle, full revolutions included, rad.
    vx, vz : float
        Velocity of the centre of mass, m/s.
    omega : float
        Angular rate, rad/s.
    Bx, Bz : float
        Field of all coils and of ``ambient_field`` at the centre of mass, T.
    """

    t: float
    x: float
    z: float
    theta: float
    vx: float
    vz: float
    omega: float
    Bx: float
    Bz: float


@known_arguments
@dataclass(frozen=True, kw_only=True)
class EffectParameter:
    """One parameter of an effect of the user's own.

    Parameters
    ----------
    name : str
        Last part of its key ``effects.<effect>.<name>``; letters, digits and ``_``.
    unit : str
        SI unit; ``"-"`` for none.
    low, high : float
        Smallest and largest value that is allowed, in the unit.
    meaning : str
        What it is, in a phrase.
    default : float
        Value in a scenario that does not name it. The effect is absent, and its function not
        called, while all its parameters have their defaults.
    """

    name: str
    unit: str
    low: float
    high: float
    meaning: str
    default: float = 0.0


def register_effect(
    name: str,
    function: Any,
    parameters: Iterable[EffectParameter],
    *,
    meaning: str,
    source: str = "",
) -> None:
    """Add an effect to the model: a force and a torque that a function gives.

    From then on it is an effect like those of `effects`: its keys ``effects.<name>.<parameter>``
    work in scenarios, files, sweeps and batches. The force acts at the centre of mass beside
    weight, magnet and drag, so contact, friction and adhesion answer to it.

    A compiled function gets three pointers to double and fills the last::

        void function(const double* state, const double* parameters, double* wrench)

    ``state`` holds the nine numbers of `EffectState`, ``parameters`` those of the
    scenario in the order of `parameters`, and ``wrench`` takes Fx and Fz, N, world's frame, and the
    torque about the centre of mass, N m, nose-down positive. A Python function is called as
    ``function(state, parameters)`` with an `EffectState` and a tuple, and returns the three
    numbers. It is for trials: it makes a simulation some ten times slower, and threads wait for
    each other.

    The function must depend on its arguments alone. It is called for trial states, in no order of
    time, and from several threads at once; anything else it read or kept would make results
    random. It should be smooth; if it changes with time within less than a fraction of a
    free swing (some 0.1 ms), ``solver.max_step`` must say so.

    A registration lives in its process: processes of an executor, or Dask workers, must each
    register the effect too, and with the same function. A scenario's file names the effect and its
    values, not the function.

    Parameters
    ----------
    name : str
        Name of the effect; letters, digits and ``_``.
    function : int, object with an ``address``, ctypes function or callable
        Address of a compiled function, or what holds one: a numba ``cfunc``, a function that ctypes
        has loaded; or a Python function. It is kept as long as it is in use, but not the code
        behind a bare address.
    parameters : iterable of EffectParameter
        At least one.
    meaning : str
        What the effect adds, in a sentence.
    source : str
        Where its equation is from.

    Raises
    ------
    TypeError
        If an argument is of another type, or a compiled function takes other arguments.
    ValueError
        If a name is not a word or is one of the model's own; if there is no parameter, one is given
        twice, or its range is not finite or does not hold its default.

    Notes
    -----
    A force or torque that is not finite ends the simulation with the status ``not_finite``; an
    exception of a Python function ends it, or the batch or sweep, and passes through.

    A name that is registered again stands for the new function from then on, in scenarios that are
    there already too. What is being simulated is not disturbed.

    Examples
    --------
    >>> from stickslip import EffectParameter, register_effect
    >>> def stream(state, parameters):
    ...     return 1e-5 * parameters[0], 0.0, 0.0
    >>> register_effect(
    ...     "stream",
    ...     stream,
    ...     [EffectParameter(name="velocity", unit="m/s", low=-1, high=1, meaning="of the fluid")],
    ...     meaning="the fluid flows along the surface",
    ... )
    >>> Scenario().replace({"effects.stream.velocity": 1e-3}).get("effects.stream.velocity")
    0.001
    """
    texts = {"name": name, "meaning": meaning, "source": source}
    _check(f"effect {shown(name)}", texts, str, "a text")
    if not isinstance(parameters, Iterable):
        raise TypeError(f"effect {name}: parameters: allowed is a list of EffectParameter")
    rows = []
    for parameter in parameters:
        if not isinstance(parameter, EffectParameter):
            raise TypeError(f"effect {name}: {shown(parameter)}: allowed is an EffectParameter")
        word, unit, low, high, what, default = astuple(parameter)
        where = f"effect {name}, parameter {shown(word)}"
        _check(where, {"name": word, "unit": unit, "meaning": what}, str, "a text")
        _check(where, {"low": low, "high": high, "default": default}, numbers.Real, "a number")
        rows.append((word, unit, float(low), float(high), float(default), what))
    address = _address(name, function)
    called = function if address else _checked(name, function)
    _core.register_effect(name, meaning, source or UNSTATED, rows, called, address)


def _check(where: str, values: Mapping[str, object], kind: Any, allowed: str) -> None:
    for what, value in values.items():
        if isinstance(value, bool) or not isinstance(value, kind):
            raise TypeError(f"{where}: {what} = {shown(value)}: allowed is {allowed}")


def _address(effect: str, function: Any) -> int:
    """Address of compiled code; 0 for a Python function."""
    if isinstance(function, _FUNCTION_OF_CTYPES):
        address: Any = ctypes.cast(function, ctypes.c_void_p).value
    elif callable(function) and not hasattr(function, "address"):
        return 0
    else:
        address = getattr(function, "address", function)
    most = 2 ** (8 * ctypes.sizeof(ctypes.c_void_p))
    if isinstance(address, bool) or not isinstance(address, numbers.Integral):
        raise TypeError(
            f"effect {effect}: function = {shown(function)}: allowed is an address, an object with "
            "one, a ctypes function or a callable"
        )
    number = int(address)
    if not 0 < number < most:
        raise ValueError(f"effect {effect}: address = {shown(number)}: there can be no function")
    # A cfunc of numba shows its signature as a ctypes function.
    arguments = getattr(getattr(function, "ctypes", function), "argtypes", None)
    if arguments is not None and len(arguments) != 3:
        raise TypeError(
            f"effect {effect}: the function takes other arguments: allowed is "
            "void function(const double* state, const double* parameters, double* wrench)"
        )
    return number


def _checked(effect: str, function: Wrench) -> Wrench:
    """A function for the core, which gives it two tuples and takes three numbers."""

    def wrench(state: Any, parameters: tuple[float, ...]) -> tuple[float, float, float]:
        result = function(EffectState._make(state), parameters)
        try:
            fx, fz, torque = result
            return float(fx), float(fz), float(torque)
        except (TypeError, ValueError):
            raise TypeError(
                f"effect {effect}: its function returned {shown(result)}: allowed is (Fx, Fz, "
                "torque), three numbers"
            ) from None

    return wrench
