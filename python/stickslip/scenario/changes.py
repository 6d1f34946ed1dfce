"""Changes of a scenario as a value: what six ways of changing one have in common."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from stickslip import _core
from stickslip.errors import ScenarioError
from stickslip.scenario.held import OBJECTS
from stickslip.scenario.keys import LAWS, check_word, full_name, is_of_one_coil, set_value
from stickslip.scenario.law import is_law, set_law


class Changes(dict[str, Any]):
    """New values by full name; several mappings are joined.

    Raises
    ------
    ScenarioError
        If a key is no word, or is given twice, such as by its short and its full name.
    """

    def __init__(self, *given: Mapping[str, Any]) -> None:
        values: dict[str, Any] = {}
        named: dict[str, str] = {}
        for key, value in (pair for changes in given for pair in changes.items()):
            check_word(key)
            name = full_name(str(key))
            if name in named:
                also = "" if named[name] == key else f", as {named[name]} too"
                raise ScenarioError(f"{key} is given twice{also}: allowed is once")
            named[name], values[name] = key, value
        super().__init__(values)

    def in_order(self) -> list[tuple[str, Any]]:
        """Keys and values in the order in which they act, whatever the order given.

        A mode comes first, as it resets what another one has, a key of all coils before those of
        single ones, and a law before its keys.
        """
        return sorted(self.items(), key=lambda item: _rank(item[0]))

    def apply(self, core: _core.Scenario, held: dict[str, Any] | None = None) -> None:
        """Set numbers, words and laws in a scenario of the core, which decides what is allowed.

        Objects are set there and in `held`, without which none is allowed.
        """
        for key, value in self.in_order():
            if held is not None and key in OBJECTS:
                OBJECTS[key].put(value, core, held)
            elif is_law(key):
                set_law(core, key, value)
            else:
                set_value(core, key, value)


def _rank(key: str) -> int:
    if key.startswith(LAWS):
        return key.count(".")
    return 0 if key == "drive.mode" else 1 + is_of_one_coil(key)
