"""What `python -m bench` lists, what `lines` counts, and what `mutations` changes."""

import ast
import importlib.util
import runpy
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "bench"))

import lines
from mutations import python as mutations

ROOT = Path(__file__).resolve().parents[1]

MODULE = '''"""A module.

With two lines of text."""

_LOW, HIGH = 0.5, 2 * 3.0  # two numbers
WORD = "3"
TABLE = {"a": 1.0}
lower = 3.0
TEXT = """not a
docstring"""


class One:
    """A class."""

    def _once(self):
        # A comment.
        return _twice(1) + _twice(2)

    def go(self):
        return self._once()


def _twice(x):
    return x


def _never():
    return None
'''


def test_code_is_counted_without_text_and_blank_lines():
    # Five assignments, of which one has two lines; a class; four functions of two lines.
    assert lines.code_lines(MODULE, True) == 6 + 1 + 4 * 2
    assert lines.code_lines("int a;  // text\n/* more\n text */\n\nint b;\n", False) == 2


def test_constants_and_functions_called_once_are_found():
    tree = ast.parse(MODULE)
    assert list(lines.constants(tree)) == ["_LOW", "HIGH"]
    assert list(lines.called_once(tree)) == ["_once"]
    assert set(lines.lengths(tree).values()) == {2, 3}


def test_every_file_of_the_package_and_the_tests_belongs_to_one_part(capsys, monkeypatch):
    parts = {name: set(lines.files(pattern)) for name, (pattern, _) in lines.PARTS.items()}
    diagnosed = parts.pop("- of the diagnosis")
    assert diagnosed < parts["tests"]
    assert Path(__file__).with_name("test_blind_record.py") in diagnosed
    assert Path(__file__) not in diagnosed
    assert sum(map(len, parts.values())) == len(set.union(*parts.values()))
    assert set(lines.files(r"(python|cpp|tests|bench)/.*\.(py|cpp|h|hpp)")) <= set.union(
        *parts.values()
    )
    monkeypatch.setattr(sys, "argv", ["lines", "--list"])
    lines.main()
    said = capsys.readouterr().out
    assert "words of documentation" in said
    assert "longest functions:" in said


def test_each_program_of_the_list_is_there(capsys):
    bench = runpy.run_path(str(ROOT / "bench" / "__main__.py"))
    assert bench["main"](["list"]) == 0
    said = capsys.readouterr().out
    for name, (module, text) in bench["PROGRAMS"].items():
        assert f"{name:<14}{text}" in said
        assert importlib.util.find_spec(module) is not None
    assert bench["main"](["lost"]) == 2


def test_changes_are_of_what_runs_and_can_be_read():
    source = (
        b"if TYPE_CHECKING:\n    x = 1 + 2\n"
        b"def f(a: int = 3) -> float:\n"
        b'    """One + two."""\n'
        b"    if a < 0.5 and not a:\n        raise ValueError(f'{a + 1}')\n"
        b"    g(a)\n"
        b"    return zip(a, -a, strict=True)\n"
    )
    made = list(mutations.mutations("one.py", source))
    assert [(each.line, each.text) for each in made] == [
        (3, "4"), (5, "False"), (5, "or"), (5, ">="), (5, "0.75"), (5, ""), (7, "None"), (8, ""),
    ]  # fmt: skip
    for each in made:
        compile(source[: each.start] + each.text.encode() + source[each.stop :], "one", "exec")
    package = ROOT / "python" / "stickslip"
    drawn = mutations.drawn(package, [], seed=1, count=12)
    assert drawn == mutations.drawn(package, [], seed=1, count=12)
    assert len({(each.file, each.line) for each in drawn}) == 12
    assert not any(each.file.startswith("diagnosis") for each in drawn)


def test_tests_near_a_module_come_first():
    near = [path.name for path in mutations.near_tests(ROOT, "sweeping/points.py")]
    assert "test_sweep.py" in near[:3]
    assert near.index("test_sweep.py") < near.index("test_predict.py")
