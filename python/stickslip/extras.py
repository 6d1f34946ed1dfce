"""Optional packages: the extras that install them, and the names that need them.

A base installation simulates. Packages larger than the simulator itself (HDF5, pandas, matplotlib,
SciPy) come with extras, and an error names the one that is missing.
"""

from __future__ import annotations

import contextlib
import importlib.util
import sys
from collections.abc import Iterator

EXTRAS = {
    "netcdf": ("h5netcdf", "h5py", "xarray", "pandas"),
    "plot": ("matplotlib",),
    "diagnosis": ("scipy", "pandas", "matplotlib", "jinja2", "threadpoolctl"),
    "optimise": ("scipy", "pandas", "matplotlib"),
    "gym": ("gymnasium",),
    "dask": ("distributed",),
    "excel": ("pandas", "openpyxl"),
}
"""The modules of each extra of pyproject.toml."""

_DIAGNOSIS = (
    *("Cause", "Diagnosis", "Measurement", "Parameter", "Table", "diagnose", "propose_experiments"),
    *("Series", "diagnose_model", "events", "free_law", "instruments", "models"),
    *("diagnose_change", "read", "read_measurement", "velocity_of_track"),
)
_NEEDED = {
    "Optimum": "optimise",
    "optimise": "optimise",
    "plot": "plot",
    "predict": "netcdf",
    "sweep": "netcdf",
    "sweep_dataframe": "netcdf",
    **dict.fromkeys(_DIAGNOSIS, "diagnosis"),
}
"""The extra of each public name and command that needs one."""


class MissingExtra(ImportError):
    """A package of an extra is missing; the message says how to install it.

    Its `name` is that of the missing module.
    """

    def __init__(self, what: str, module: str, extra: str) -> None:
        how = f'pip install ".[{extra}]" in the folder of stickslip'
        super().__init__(f"{what} needs {module}: {how}", name=module)


def check_extras(what: str, name: str) -> None:
    """Raise MissingExtra if a public name or command lacks a module of its extra.

    Modules are found, not imported, before a long calculation whose result needs them. `what` is
    the subject of the message.
    """
    extra = _NEEDED.get(name, "")
    for module in EXTRAS.get(extra, ()):
        if not _is_there(module):
            raise MissingExtra(what, module, extra)


def _is_there(module: str) -> bool:
    if sys.modules.get(module) is not None:
        return True
    try:
        return importlib.util.find_spec(module) is not None
    except ModuleNotFoundError:
        return False


@contextlib.contextmanager
def naming_the_extra(what: str) -> Iterator[None]:
    """Raise MissingExtra where the block imports a missing module of an extra."""
    try:
        yield
    except ModuleNotFoundError as error:
        module = (error.name or "").partition(".")[0]
        for extra, modules in EXTRAS.items():
            if module in modules:
                raise MissingExtra(what, module, extra) from None
        raise
