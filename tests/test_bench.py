"""What `python -m bench` lists, what `lines` counts, and what `mutations cpp` replaces."""

import importlib.util
import runpy
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "bench"))

import lines
from mutations.cpp import MUTATIONS

ROOT = Path(__file__).resolve().parents[1]


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


def test_each_text_that_a_mutation_replaces_is_in_its_file_once():
    for each in MUTATIONS:
        (path,) = (ROOT / "cpp" / "stickslip").rglob(each.file)
        assert path.read_text(encoding="utf-8").count(each.text) == 1, each
