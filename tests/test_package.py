"""Cost and public names of an import."""

import importlib.metadata
import pkgutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import mypy.api
import pytest

import stickslip


def test_import_is_light():
    # The promise is 0.3 s (bench/promises.py); what would break it are these, each 0.1 s or more by
    # itself. Looking for them, unlike a clock, gives one answer on any machine.
    heavy = "{'numpy', 'scipy', 'pandas', 'xarray', 'matplotlib', 'h5py', 'jinja2', 'click'}"
    code = f"import sys, stickslip; print(sorted({heavy} & set(sys.modules)))"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"


def test_no_module_has_the_name_of_a_public_function():
    # Importing a submodule binds its name in the package, over a function that has the same.
    for module in pkgutil.walk_packages(stickslip.__path__, "stickslip."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    kinds = {name for name in stickslip.__all__ if isinstance(getattr(stickslip, name), ModuleType)}
    assert kinds == {"events", "instruments", "models", "plot"}


def test_the_library_does_not_need_the_command():
    folder = Path(stickslip.__file__).parent
    programs = [folder / "__main__.py", folder / "demo.py", *folder.glob("cli/*.py")]
    for path in set(folder.rglob("*.py")) - set(programs):
        assert "stickslip.cli" not in path.read_text(encoding="utf-8"), path


def test_every_public_name_is_there():
    for name in stickslip.__all__:
        assert getattr(stickslip, name) is not None
        assert name in dir(stickslip)


def test_version_is_that_of_the_installed_package():
    assert stickslip.__version__ == importlib.metadata.version("stickslip")


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'no_such_name'"):
        _ = stickslip.no_such_name


@pytest.mark.nightly
def test_type_checkers_see_names_that_are_not_there(tmp_path):
    file = tmp_path / "typos.py"
    file.write_text(
        "import stickslip\n"
        "stickslip.foo\n"
        "run = stickslip.simulate(stickslip.Scenario())\n"
        "run.thetta\n"
        "run.theta\n"
    )
    text, _, _ = mypy.api.run(["--strict", f"--cache-dir={tmp_path}", str(file)])
    errors = [line for line in text.splitlines() if line.startswith(str(file))]
    assert len(errors) == 2, text
    assert ":2: " in errors[0]
    assert '"foo"' in errors[0]
    assert ":4: " in errors[1]
    assert '"thetta"' in errors[1]
