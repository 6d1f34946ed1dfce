"""What `python -m bench lines` counts."""

import ast
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "bench"))

import lines

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
