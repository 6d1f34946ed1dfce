"""Without any extra the core features work, and all else names the extra which it needs."""

import re
import sys
from pathlib import Path

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from command_line import python_process
from stickslip.extras import EXTRAS

PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]

# What Python runs before anything else: packages are to be found neither as modules nor by version.
BLOCKER = """
import importlib.metadata
import sys

version = importlib.metadata.version

def version_of_others(name):
    if name in {blocked}:
        raise importlib.metadata.PackageNotFoundError(name)
    return version(name)

importlib.metadata.version = version_of_others

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {blocked}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Blocker())
"""

OPTIONAL = sorted({module for modules in EXTRAS.values() for module in modules})

SCENARIO = """
stickslip = 1
[drive]
mode = "IPP"
frequency = 100
base = 0.5e-3
pulses = 4
[record]
rate = 2e3
[uncertain]
"contact.kinetic_friction" = { low = 0.1, high = 0.3 }
"""

BASE = """
import numpy as np
from stickslip import (Drive, Scenario, Simulator, Waveform, load, rollout, show_versions,
                       simulate, simulate_batch)

scenario = load("scenario.toml")
run = simulate(scenario)
assert run.ok and run.summary()["notes"] is not None
assert simulate_batch([scenario, scenario.replace({"drive.frequency": 50})])[0].ok

run.save("run.csv")
assert open("run.csv").read().startswith("t (s),x (m),")
assert simulate(scenario, out="kept.csv").recorded

rest = Waveform.hold(0.02, {"xp": 5.0}) + Waveform.ramp(0.01, {"xp": 10.0}, {"xp": 5.0})
rest.write("voltages.csv")
program = Drive(mode="program", program=Waveform.from_csv("voltages.csv"))
assert simulate(Scenario(drive=program)).ok
assert scenario.draws(2, seed=0)[0].contact != scenario.contact
assert np.isfinite(Simulator(scenario).step({"xp": 5.0}, 1e-3).theta)
assert rollout(scenario, None, np.zeros((3, 5)), 1e-3).states.shape[-1] == 2
assert "<" in run._repr_html_() + scenario._repr_html_()
show_versions()
"""


def without(blocked, arguments, folder):
    """Run Python in a folder where some modules are not to be found."""
    (folder / "sitecustomize.py").write_text(BLOCKER.format(blocked=set(blocked)))
    (folder / "scenario.toml").write_text(SCENARIO)
    return python_process(*arguments, path=[folder], cwd=folder)


def test_the_base_simulates(tmp_path):
    result = without(OPTIONAL, ["-c", BASE], tmp_path)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize(
    "arguments",
    ["run scenario.toml --out run.csv", "keys drive", "effects", "init new.toml", "--help",
     "sweep --help", "predict -h"],
)  # fmt: skip
def test_commands_of_the_base(arguments, tmp_path):
    result = without(OPTIONAL, ["-m", "stickslip", *arguments.split()], tmp_path)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize(
    ("blocked", "arguments", "module", "extra"),
    [
        (OPTIONAL, "stickslip sweep scenario.toml --vary drive.peak=0", "h5netcdf", "netcdf"),
        (OPTIONAL, "stickslip predict scenario.toml", "h5netcdf", "netcdf"),
        (OPTIONAL, "stickslip optimise scenario.toml", "scipy", "optimise"),
        (OPTIONAL, "stickslip diagnose measurement.toml", "scipy", "diagnosis"),
        (OPTIONAL, "stickslip run scenario.toml --plot run.png", "matplotlib", "plot"),
        (OPTIONAL, "stickslip run scenario.toml --out run.nc", "h5netcdf", "netcdf"),
        # Not begun where its page could not be written.
        (["jinja2"], "stickslip diagnose no.toml", "jinja2", "diagnosis"),
    ],
)
def test_a_missing_extra_is_named_in_one_line(blocked, arguments, module, extra, tmp_path):
    result = without(blocked, ["-m", *arguments.split()], tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert re.fullmatch(
        rf'stickslip: .* needs {module}: pip install "\.\[{extra}\]" in the folder .*\n',
        result.stderr,
    )
    assert {each.name for each in tmp_path.iterdir()} <= {
        *("sitecustomize.py", "scenario.toml", "__pycache__")
    }


EVERY_NAME = """
import stickslip
for name in stickslip.__all__:
    try:
        getattr(stickslip, name)
    except ImportError as error:
        print(name, error.name, str(error).startswith(f"stickslip.{name} needs {error.name}: "))
"""


def test_every_public_name_is_there_or_names_its_extra(tmp_path):
    result = without(OPTIONAL, ["-c", EVERY_NAME], tmp_path)
    assert result.returncode == 0, result.stderr
    rows = [line.split() for line in result.stdout.splitlines()]
    assert all(named == "True" for _, _, named in rows)
    assert {name: module for name, module, _ in rows} == {
        **dict.fromkeys(["predict", "sweep", "sweep_dataframe"], "h5netcdf"),
        **dict.fromkeys(["Cause", "Diagnosis", "Measurement", "Parameter", "Series"], "scipy"),
        **dict.fromkeys(["diagnose", "free_law"], "scipy"),
        **dict.fromkeys(
            ["propose_experiments", "diagnose_model", "instruments", "models"], "scipy"
        ),
        **dict.fromkeys(
            ["Table", "diagnose_change", "events", "read_measurement", "velocity_of_track"], "scipy"
        ),
        **dict.fromkeys(["Optimum", "optimise"], "scipy"),
        "plot": "matplotlib",
    }


@pytest.mark.parametrize("method", ["to_dataframe()", "to_xarray()", "save('run.nc')"])
def test_a_run_names_the_extra_of_its_tables(method, tmp_path):
    code = f"import stickslip\nstickslip.simulate(stickslip.load('scenario.toml')).{method}"
    result = without(OPTIONAL, ["-c", code], tmp_path)
    assert result.stderr.endswith('pip install ".[netcdf]" in the folder of stickslip\n')
    assert "MissingExtra" in result.stderr


def test_another_missing_module_is_not_taken_for_an_extra(tmp_path):
    result = without(["tqdm"], ["-m", "stickslip", "run", "scenario.toml"], tmp_path)
    assert "stickslip[" not in result.stderr
    assert "No module named 'tqdm'" in result.stderr


def test_the_table_of_extras_is_that_of_the_project():
    stated = {
        extra: {re.split(r"[^\w-]", each)[0] for each in requirements}
        for extra, requirements in PROJECT["optional-dependencies"].items()
    }
    assert {extra: set(modules) for extra, modules in EXTRAS.items()} == {
        extra: stated[extra] for extra in EXTRAS
    }
    assert PROJECT["optional-dependencies"]["all"] == [f"stickslip[{','.join(EXTRAS)}]"]
