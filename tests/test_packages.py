"""The wings and their packages: each imports what stands before it; what an import costs."""

import ast
import functools
import importlib.metadata
import pkgutil
import re
from pathlib import Path
from types import ModuleType

import mypy.api
import pytest

import stickslip
from command_line import python_process

ROOT = Path(__file__).parents[1] / "python" / "stickslip"
BASE = ("_core", "_util", "errors", "extras", "versions")  # these know each other
SIMULATOR = ("field", "scenario", "simulation", "sweeping", "plot")
APPLICATIONS = ("design", "control")
WINGS = {
    **dict.fromkeys(BASE, ()),
    **dict.fromkeys(SIMULATOR, SIMULATOR),
    **dict.fromkeys(APPLICATIONS, (*SIMULATOR, *APPLICATIONS)),
    "diagnosis": ("diagnosis",),
    "_machines": (),
    "models": ("_machines", "diagnosis", "models"),
    "walker": (*SIMULATOR, "diagnosis", "walker"),
}
"""Packages that each may import beside common ones; `cli` and the top-level files import all."""
ORDER = (*BASE, *SIMULATOR, *APPLICATIONS, "diagnosis", "_machines", "models", "walker", "cli")
CORELESS = ("diagnosis", "models")
"""Packages that do not import the core either."""
LAZY = ("cli", "plot")
"""Packages that may be imported inside functions: commands, and those that need an extra."""
ROBOT = re.compile(
    r"\b(robot|coil|walker|magnet|drive|velocity|velocitie|camera|film)s?\b", re.IGNORECASE
)
PUBLIC = re.compile(r'"drive"|[.{]drive\b|\bdrive ?:')
"""The public name of the settings of an experiment."""


def imports(node, inside=False, types=False):
    """(module of this package, within a function, for types alone) of each import within a node."""
    for each in ast.iter_child_nodes(node):
        if isinstance(each, ast.ImportFrom) and (each.module or "").startswith("stickslip"):
            module = each.module.removeprefix("stickslip").lstrip(".")
            within = [f"{module}.{name.name}".lstrip(".") for name in each.names]
            for name in [module, *within] if module else within:
                yield name, inside, types
        elif isinstance(each, (ast.stmt, ast.ExceptHandler)):  # no expression has any
            checked = isinstance(each, ast.If) and ast.unparse(each.test) == "TYPE_CHECKING"
            is_function = isinstance(each, ast.FunctionDef)
            yield from imports(each, inside or is_function, types or checked)


@functools.cache
def modules():
    files = (file for file in ROOT.rglob("*.py") if file.parent != ROOT)
    return {
        ".".join(file.relative_to(ROOT).with_suffix("").parts): list(
            imports(ast.parse(file.read_text("utf-8")))
        )
        for file in files
    }


def package_of(module):
    return module.partition(".")[0]


def test_a_module_imports_what_its_wing_may():
    crossed = set()
    for module, needed in modules().items():
        package = package_of(module)
        if package != "cli":
            may = {*BASE, *WINGS[package]} - ({"_core"} if package in CORELESS else set())
            beyond = {name for name, *_ in needed if package_of(name) not in may}
            crossed |= {(module, each) for each in beyond}
    assert crossed == set()


def test_a_module_imports_packages_before_its_own():
    def place(name):
        package = package_of(name)
        return 0 if package in BASE else ORDER.index(package) if package in ORDER else len(ORDER)

    later = {
        (module, name)
        for module, needed in modules().items()
        for name, inside, types in needed
        if not types and not (inside and package_of(name) in LAZY)
        if place(name) > place(module)
    }
    assert later == set()


def test_no_modules_import_each_other_in_a_circle():
    needed = {
        module: {name for name, *_ in found} & modules().keys() - {module}
        for module, found in modules().items()
    }
    while leaves := {name for name, others in needed.items() if not others & needed.keys()}:
        needed = {name: others for name, others in needed.items() if name not in leaves}
    assert needed == {}


def test_no_function_imports_another_package():
    found = {
        (module, name)
        for module, needed in modules().items()
        for name, inside, _ in needed
        if inside and package_of(name) not in (package_of(module), *LAZY)
    }
    assert {pair for pair in found if package_of(pair[0]) != "cli"} == set()


def test_the_diagnosis_names_no_robot():
    files = [file for file in (ROOT / "diagnosis").rglob("*.*") if file.suffix != ".pyc"]
    assert len(files) > 50
    names = {file.name: ROBOT.findall(PUBLIC.sub("", file.read_text("utf-8"))) for file in files}
    assert {name: found for name, found in names.items() if found} == {}


def test_import_is_light():
    # Chosen: 0.3 s; what would break it are these, each 0.1 s or more by
    # itself. Looking for them, unlike a clock, gives one answer on any machine.
    heavy = "{'numpy', 'scipy', 'pandas', 'xarray', 'matplotlib', 'h5py', 'jinja2', 'click'}"
    code = f"import sys, stickslip; print([m for m in sys.modules if m in {heavy}])"
    result = python_process("-c", code)
    assert (result.stdout.strip(), result.returncode) == ("[]", 0)


def test_no_module_has_the_name_of_a_public_function():
    # Importing a submodule binds its name in the package, over a function that has the same.
    for module in pkgutil.walk_packages(stickslip.__path__, "stickslip."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    kinds = {name for name in stickslip.__all__ if isinstance(getattr(stickslip, name), ModuleType)}
    assert kinds == {"events", "instruments", "models", "plot"}


def test_the_library_does_not_need_the_command():
    folder = Path(stickslip.__file__).parent
    programs = [folder / "__main__.py", *folder.glob("cli/*.py")]
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
