"""The versions that a bug report should state."""

from __future__ import annotations

import importlib.metadata
import platform
from itertools import chain

from stickslip import _core
from stickslip.extras import EXTRAS

_BASE = ("numpy", "click", "tqdm")


def show_versions() -> None:
    """Print the versions of stickslip, of Python and of the packages it uses with all extras."""
    rows = [
        ("stickslip", _core.__version__),
        ("arkode", "yes" if _core.has_arkode else "no"),
        ("python", platform.python_version()),
        ("platform", platform.platform()),
    ]
    for package in dict.fromkeys([*_BASE, *chain.from_iterable(EXTRAS.values())]):
        try:
            rows.append((package, importlib.metadata.version(package)))
        except importlib.metadata.PackageNotFoundError:
            rows.append((package, "missing"))
    for name, version in rows:
        print(f"{name:<12}{version}")
