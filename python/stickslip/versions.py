"""What a report of a problem should say of the installation."""

from __future__ import annotations

import importlib.metadata
import platform
import re

from stickslip import _core


def show_versions() -> None:
    """Print the versions of stickslip, of Python and of the packages it uses."""
    rows = [
        ("stickslip", _core.__version__),
        ("arkode", "yes" if _core.has_arkode else "no"),
        ("python", platform.python_version()),
        ("platform", platform.platform()),
    ]
    for requirement in importlib.metadata.requires("stickslip") or ():
        if ";" in requirement:  # of an extra, or of another Python
            continue
        package = re.split(r"[^\w-]", requirement)[0]
        try:
            rows.append((package, importlib.metadata.version(package)))
        except importlib.metadata.PackageNotFoundError:
            rows.append((package, "missing"))
    for name, version in rows:
        print(f"{name:<12}{version}")
