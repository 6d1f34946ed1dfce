"""The sections of a scenario, with the fields that the core's table of keys has.

What type checkers know of them is in `sections.pyi`, which is made from the same table.
"""

import functools
import inspect
import math
from collections import namedtuple
from collections.abc import Mapping

from stickslip import _core
from stickslip._util.arrays import in_columns
from stickslip._util.messages import check_above_zero, refuse, shown, suggestion
from stickslip.errors import ScenarioError
from stickslip.field.coils import Coils
from stickslip.scenario.keys import COIL_NAMES, is_of_one_coil, keys_of
from stickslip.scenario.matter import magnet_of
from stickslip.scenario.section import Section

STATE_COLUMNS = tuple(_core.state_columns)
"""The fields of a `State` in the order of the last axis of an array of states.

`contact` stands there as the index of its word in `CONTACT_WORDS`.
"""

CONTACT_WORDS = tuple(_core.contact_words)
"""Values of `State.contact`."""

OneCoil = namedtuple("OneCoil", [key.field for key in keys_of("coil.xp")])
OneCoil.__doc__ = "Values of one coil, as those of `Coil`."


def _by_words(make):
    """Wrap `make`: unknown words, and all that are missing, are refused in one line."""
    words = inspect.signature(make).parameters
    name = make.__qualname__
    section = name.partition(".")[0]
    needed = [word for word, each in words.items() if each.default is each.empty]

    @functools.wraps(make)
    def made(*values, **named):
        for word in named:
            if word in SECTIONS[section.casefold()]._fields and word not in words:
                refuse(word, named[word], f"{section}({word}=...), or {name} of {', '.join(words)}")
            if word not in words:
                hint = f"{name} has no such word; {suggestion(word, words)}"
                raise ScenarioError(f"{word} = {shown(named[word])}: {hint}")
        missing = [word for word in needed[len(values) :] if word not in named]
        if missing:
            verb = "is" if len(missing) == 1 else "are"
            raise ScenarioError(
                f"{', '.join(missing)} {verb} missing: {name} takes {', '.join(words)}"
            )
        return make(*values, **named)

    return made


class Drive(Section, key="drive"):
    __slots__ = ()

    @property
    def kind(self):
        """Kind of its voltages: a sawtooth, a program, or none."""
        return _core.drive_kinds[self.mode]

    @property
    def facing(self):
        """1 where a robot that stays in its plane faces +x, -1 where it faces -x."""
        back = self.direction == "-x"
        if self.kind != "program" and math.cos(self.heading) < 0.0:
            back = not back
        return -1.0 if back else 1.0


class Coil(
    Section,
    key="coil",
    **{
        name: f"mapping or OneCoil, optional: Values of the {name} coil, if they differ, such as "
        '``{"resistance": 10.5}``. It reads as a `OneCoil`.'
        for name in COIL_NAMES
    },
):
    __slots__ = ()

    def _changes(self, field, value):
        if field not in COIL_NAMES:
            return super()._changes(field, value)
        fields = value._asdict() if isinstance(value, OneCoil) else value
        if not isinstance(fields, Mapping | None):
            refuse(f"coil.{field}", value, f"a table [coil.{field}]")
        return {f"coil.{field}.{name}": number for name, number in (fields or {}).items()}

    @staticmethod
    @_by_words
    def of(
        *,
        field_per_ampere,
        distance,
        side=None,
        radius=None,
        resistance,
        inductance=None,
        rise_time=None,
        capacitance=0.0,
    ):
        """Five like coils from what a laboratory measures.

        Parameters
        ----------
        field_per_ampere : float
            Field at the centre per ampere in one coil, T/A; it gives the turns.
        distance : float
            From the centre to the middle of a winding, m.
        side, radius : float
            One of both: mean side of a square winding, or mean radius of a round one, which becomes
            the square of the same area, m.
        resistance : float
            Of a coil with its leads, ohm.
        inductance, rise_time : float
            One of both: H, or the time that the current takes to 63 % after a step of the voltage,
            s, which gives the inductance.
        capacitance : float
            Of a capacitor in series, F; 0: none. It is none of the rise time.

        Raises
        ------
        ScenarioError
            If both or none of a pair are given, a word is missing or unknown, or a number is not
            allowed.
        """
        given = {"field_per_ampere": field_per_ampere, "distance": distance}
        given |= {"resistance": resistance}
        for one, other in (
            (("side", side), ("radius", radius)),
            (("inductance", inductance), ("rise_time", rise_time)),
        ):
            if one[1] is None and other[1] is None:
                raise ScenarioError(f"{one[0]} is missing: give {one[0]} or {other[0]}")
            if one[1] is not None and other[1] is not None:
                refuse(one[0], one[1], f"none beside {other[0]}; give one of both")
            given |= dict([other if one[1] is None else one])
        for name, value in given.items():
            check_above_zero(name, value, "its SI unit")
        side = side if radius is None else math.sqrt(math.pi) * radius
        one_turn = Coils(side, distance, 1.0).centre_field_per_ampere
        return Coil(
            side=side,
            distance=distance,
            turns=field_per_ampere / one_turn,
            resistance=resistance,
            inductance=resistance * rise_time if inductance is None else inductance,
            capacitance=capacitance,
        )

    def own_values(self):
        """By dotted key, the values of single coils that differ from those of all coils."""
        changed = self._core.changed().items()
        return {key: value for key, value in changed if is_of_one_coil(key)}

    def __repr__(self):
        coils = {key.split(".")[1] for key in self.own_values()}
        values = self.as_dict().items()
        shown = [f"{name}={value!r}" for name, value in values if name not in {*COIL_NAMES} - coils]
        return f"Coil({', '.join(shown)})"


def _one_coil(name):
    def values(self):
        return OneCoil(*(self._core.get(key.name) for key in keys_of(f"coil.{name}")))

    return property(values, doc=f"Values of the {name} coil.")


for _name in COIL_NAMES:
    setattr(Coil, _name, _one_coil(_name))


class Robot(Section, key="robot"):
    __slots__ = ()

    @staticmethod
    @_by_words
    def of(length, width, height, *, material=None, density=None, magnetization=None):
        """A robot from its size and what it is made of.

        Parameters
        ----------
        length, width, height : float
            m, the length along the magnetization.
        material : str, optional
            A magnet, such as ``"NdFeB N42"``; another word is refused with the names. It stands for
            the density and the magnetization that are not given.
        density, magnetization : float, optional
            kg/m^3 and A/m. A small piece that was cut may have half of the material's
            magnetization: measure it.

        Raises
        ------
        ScenarioError
            If the material or a word is unknown, a size is missing, or a number is not allowed.
        """
        robot = Robot(length=length, width=width, height=height)
        density, magnetization = magnet_of(material, density, magnetization)
        mass = density * robot.length * robot.width * robot.height
        return Robot(**{**robot.as_dict(), "mass": mass, "magnetization": magnetization})


# Those with values alone.
Contact, Drag, Environment, Inner, Shake, Solver, Record = (
    type(name, (Section,), {"__slots__": (), "__module__": __name__}, key=name.casefold())
    for name in ("Contact", "Drag", "Environment", "Inner", "Shake", "Solver", "Record")
)


class State(Section, key="initial"):
    __slots__ = ()

    @property
    def row(self):
        """The values in the order of `STATE_COLUMNS`, as an array of states holds them."""
        values = {**self.as_dict(), "contact": CONTACT_WORDS.index(self.contact)}
        return [float(values[name]) for name in STATE_COLUMNS]

    @staticmethod
    def from_row(row):
        """The state of a row of an array of states; a ScenarioError if it is none."""
        allowed = f"{len(STATE_COLUMNS)} numbers in the order of STATE_COLUMNS"
        given = in_columns("row", row, STATE_COLUMNS, allowed, axes=1)
        values = dict(zip(STATE_COLUMNS, given.tolist(), strict=True))
        index = values["contact"]
        if index not in range(len(CONTACT_WORDS)):
            refuse("initial.contact", index, f"a whole number from 0 to {len(CONTACT_WORDS) - 1}")
        return State(**{**values, "contact": CONTACT_WORDS[int(index)]})


_ALL = Drive, Coil, Robot, Contact, Drag, Environment, Shake, Inner, State, Solver, Record
SECTIONS = {section._name: section for section in _ALL}
"""Their classes by name, in the order of a file."""
