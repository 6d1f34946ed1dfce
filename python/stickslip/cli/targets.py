"""Files that a command is to write: refused before a long simulation, not after it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path

from stickslip._util.files import check_folder, check_suffix, check_writable
from stickslip.cli.settings import split_setting
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.path_keys import PATHS
from stickslip.scenario.toml_file import named_files
from stickslip.simulation.run import SUFFIXES

Inputs = dict[str, Path]
"""Files that the command reads, by what they are."""


def input_files(scenario: Path, settings: Sequence[str], uncertain: Path | None = None) -> Inputs:
    """The scenario, its voltages and map, by file or by --set, and --uncertain."""
    files = {"the scenario": scenario}
    if uncertain is not None:
        files["--uncertain"] = uncertain
    for key, path in named_files(scenario).items():
        files[f"the scenario's {key}"] = path
    for key, value in map(split_setting, settings):
        if key in PATHS:
            files[f"--set {key}"] = Path(value)
    return files


def check_target(
    option: str, path: Path, inputs: Inputs, suffixes: tuple[str, ...] | None = None
) -> None:
    """Refuse a path that cannot be written, has another suffix, or is a file that is read."""
    _check_not_read(option, path, inputs)
    with prefixed("", OSError):  # whose message names the path
        check_writable(path)
    if suffixes is not None:
        with prefixed(option, ValueError):
            check_suffix(path, suffixes)


def check_out_and_plot(out: Path | None, plot: Path | None, inputs: Inputs) -> None:
    """Say before long simulations what of ``--out`` and ``--plot`` could not be written after."""
    check_different({"--out": out, "--plot": plot})
    if out is not None:
        check_target("--out", out, inputs, SUFFIXES)
    if plot is not None:
        check_plot(plot, inputs)


def check_plot(plot: Path, inputs: Inputs) -> None:
    """Refuse a picture that could not be written."""
    check_target("--plot", plot, inputs)
    from stickslip.plot import check_format

    with prefixed("--plot", ValueError):
        check_format(plot)


def check_different(files: Mapping[str, Path | None]) -> None:
    """Refuse one file for two of the options that write one."""
    given = [(option, path) for option, path in files.items() if path is not None]
    for (one, path), (other, same) in itertools.combinations(given, 2):
        if same_file(path, same):
            raise ScenarioError(f"{one} and {other}: {path} cannot be both")


def check_folder_target(path: Path, files: Sequence[str], inputs: Inputs | None = None) -> None:
    """Refuse a folder ``--out`` in which `files` cannot be written, or are files that are read."""
    with prefixed("--out", OSError):
        check_folder(path, files)
    for name in files:
        _check_not_read("--out", path / name, inputs or {})


def _check_not_read(option: str, path: Path, inputs: Inputs) -> None:
    for what, read in inputs.items():
        if same_file(path, read):
            raise ScenarioError(f"{option}: {path} is {what}, which it would overwrite")


def same_file(one: Path, other: Path) -> bool:
    """Whether two paths are one file, by whatever name or link."""
    try:
        return one.resolve() == other.resolve() or one.samefile(other)
    except (OSError, RuntimeError, ValueError):  # not there, links in a circle, or no name at all
        return False
