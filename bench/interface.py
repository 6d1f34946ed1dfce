"""Changes of the public interface since a commit: `python -m bench interface COMMIT`.

Lists public names with their signatures, the keys of a scenario, the numbers of a summary, and the
commands with their options, of the package of the earlier commit and of the installed one, and
prints the lines that differ. The earlier one is built as `against` does.
"""

from __future__ import annotations

import argparse
import difflib
import importlib
import inspect
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from against import built

import stickslip


def signature(value: object) -> str:
    try:
        return str(inspect.signature(value))
    except (TypeError, ValueError):  # of the core, or no function
        return ""


def members(name: str, value: object) -> Iterator[str]:
    """A public object, and what it has."""
    if isinstance(value, ModuleType):
        for each in sorted(getattr(value, "__all__", dir(value))):
            inner = getattr(value, each)
            if not each.startswith("_") and getattr(inner, "__module__", "").startswith(name):
                yield from members(f"{name}.{each}", inner)
        return
    yield f"{name}{signature(value)}" if callable(value) else f"{name}: {type(value).__name__}"
    if isinstance(value, type):
        for each in sorted(dir(value)):
            if not each.startswith("_"):
                yield f"{name}.{each}{signature(getattr(value, each))}"


def listing() -> Iterator[str]:
    """The interface of the package that is imported, a line for each thing."""
    import click

    from stickslip import _core
    from stickslip.cli.commands import COMMANDS, loaded

    for name in (*stickslip.__all__, "control"):
        if not name.startswith("_"):
            value = importlib.import_module("stickslip.control") if name == "control" else None
            yield from members(f"stickslip.{name}", value or getattr(stickslip, name))
    for key in _core.key_table():
        yield f"key {key['name']} = {key['default']} {key.get('unit', '')}: {key['allowed']}"
    for name in _core.RunResult().summary():
        yield f"summary {name}"
    for command in COMMANDS:
        for each in loaded(command).params:
            kind = "option" if isinstance(each, click.Option) else "argument"
            yield f"stickslip {command}: {kind} {' '.join([*each.opts, *each.secondary_opts])}"


def of_package(folder: Path) -> list[str]:
    """The listing of the package in a folder."""
    paths = [str(folder.resolve()), str(Path(__file__).parent)]
    code = "import interface; print(*interface.listing(), sep='\\n')"
    done = subprocess.run(
        [sys.executable, "-c", code],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
    )
    return done.stdout.splitlines()


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m bench interface", description=__doc__)
    parser.add_argument("commit", help="the earlier commit, or a folder with its built package")
    options = parser.parse_args()
    before = of_package(built(options.commit))
    now = of_package(Path(stickslip.__file__).parents[1])
    changes = [line for line in difflib.ndiff(before, now) if line[0] in "-+"]
    print(*(changes or ["the public interface is the same"]), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
