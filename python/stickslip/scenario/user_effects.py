"""Effects of the user's own: a force and a torque given by a function."""

from __future__ import annotations

import ctypes
import numbers
import threading
from _ctypes import CFuncPtr  # the base of all functions of ctypes, which it has no name for
from collections.abc import Callable, Iterable
from dataclasses import astuple, dataclass
from typing import Any, NamedTuple

from stickslip import _core
from stickslip.scenario.keys import forget_keys, shown

UNSTATED = "not stated; registered by the user"
"""Source of an effect for which none is given."""

Wrench = Callable[[Any, tuple[float, ...]], tuple[float, float, float]]


class EffectState(NamedTuple):
    """What the function of an effect is told.

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
        Tilt angle, whole turns included, rad.
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


@dataclass(frozen=True)
class _Definition:
    """Everything by which two registrations of one name can differ."""

    parameters: tuple[EffectParameter, ...]
    meaning: str
    source: str
    code: object  # the address, or the Python function itself


_registered: dict[str, _Definition] = {}
_lock = threading.Lock()


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
    numbers. It is right for a try: it makes a simulation some ten times slower, and threads wait
    for each other.

    The function must be a pure one of its arguments. It is called for trial states, in no order of
    time, and from several threads at once; anything else it reads or keeps would make results
    depend on chance. It should be smooth; if it changes with time within less than a fraction of a
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
        If a name is not a word, is one of the model's own, or is registered with another definition
        (the same again is fine); if there is no parameter, one is given twice, or its range is not
        finite or does not hold its default.

    Notes
    -----
    A force or torque that is not finite ends the simulation with the status ``not_finite``; an
    exception of a Python function ends it, or the batch or sweep, and passes through.

    Examples
    --------
    >>> from stickslip import EffectParameter, register_effect, unregister_effect
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
    >>> unregister_effect("stream")
    """
    _check_texts(f"effect {shown(name)}", name=name, meaning=meaning, source=source)
    if not isinstance(parameters, Iterable):
        raise TypeError(f"effect {name}: parameters: allowed is a list of EffectParameter")
    parameters = tuple(parameters)
    rows = []
    for each in parameters:
        if not isinstance(each, EffectParameter):
            raise TypeError(f"effect {name}: {shown(each)}: allowed is an EffectParameter")
        rows.append(_row(name, each))
    address = _address(name, function)
    definition = _Definition(parameters, meaning, source, address or function)
    with _lock:
        if name in _registered:
            if _registered[name] == definition:
                return
            raise ValueError(
                f"effect {name}: is registered with another definition; unregister_effect("
                f'"{name}") comes first'
            )
        called = function if address else _checked(name, function)
        _core.register_effect(name, meaning, source or UNSTATED, rows, called, address)
        _registered[name] = definition
        forget_keys()


def unregister_effect(name: str) -> None:
    """Take back a `register_effect`. Simulations that are going on are not disturbed.

    Parameters
    ----------
    name : str
        Name of the effect.

    Raises
    ------
    ValueError
        If no effect of this name is registered.
    """
    with _lock:
        if name not in _registered:
            raise ValueError(f"effect {shown(name)}: is not registered")
        _core.unregister_effect(name)
        del _registered[name]
        forget_keys()


_Row = tuple[str, str, float, float, float, str]


def _check_texts(where: str, **texts: object) -> None:
    for what, text in texts.items():
        if not isinstance(text, str):
            raise TypeError(f"{where}: {what} = {shown(text)}: allowed is a text")


def _row(effect: str, parameter: EffectParameter) -> _Row:
    name, unit, low, high, meaning, default = astuple(parameter)
    where = f"effect {effect}, parameter {shown(name)}"
    _check_texts(where, name=name, unit=unit, meaning=meaning)
    for what, number in (("low", low), ("high", high), ("default", default)):
        if isinstance(number, bool) or not isinstance(number, numbers.Real):
            raise TypeError(f"{where}: {what} = {shown(number)}: allowed is a number")
    return name, unit, float(low), float(high), float(default), meaning


def _address(effect: str, function: Any) -> int:
    """Address of compiled code; 0 for a Python function."""
    address: Any
    if isinstance(function, CFuncPtr):
        address = ctypes.cast(function, ctypes.c_void_p).value or 0
    elif isinstance(function, numbers.Integral):
        address = function
    elif hasattr(function, "address"):
        address = function.address
    elif callable(function):
        return 0
    else:
        raise TypeError(
            f"effect {effect}: function = {shown(function)}: allowed is an address, an object with "
            "one, a ctypes function or a callable"
        )
    if isinstance(address, bool) or not isinstance(address, numbers.Integral):
        raise TypeError(f"effect {effect}: address = {shown(address)}: allowed is an integer")
    place = int(address)
    if not 0 < place < 2 ** (8 * ctypes.sizeof(ctypes.c_void_p)):
        raise ValueError(f"effect {effect}: address = {shown(place)}: there can be no function")
    _check_arguments(effect, function)
    return place


def _check_arguments(effect: str, function: Any) -> None:
    """Refuse compiled code that is known to take something else than three pointers."""
    # A cfunc of numba shows its signature as a ctypes function.
    prototype = function if isinstance(function, CFuncPtr) else None
    prototype = getattr(function, "ctypes", prototype)
    arguments = getattr(prototype, "argtypes", None)
    if arguments is None:
        return
    pointers = (ctypes._Pointer, ctypes.c_void_p)
    if len(arguments) != 3 or not all(
        isinstance(each, type) and issubclass(each, pointers) for each in arguments
    ):
        raise TypeError(
            f"effect {effect}: the function takes other arguments: allowed is "
            "void function(const double* state, const double* parameters, double* wrench)"
        )


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
