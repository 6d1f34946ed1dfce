"""Docstrings of the bound core: each name has one, and comments that do not serve are refused."""

import inspect
import re
from pathlib import Path

import pytest

from command_line import python_process
from stickslip import _core

ROOT = Path(__file__).resolve().parents[1]
SIGNATURE = re.compile(r"(?:\d+\. )?\w*\(.*\)(?: -> .+)?")  # as pybind11 writes it, or a docstring

HEADER = """
/// Laws beside those of the model. Throws
/// std::invalid_argument for a name of `kLawKeys`.
class Laws {
public:
    /// Number of laws.
    std::size_t size() const { return rows_.size(); }
    double share = 0.0;  ///< of the force, 1
    /// See Laws::size.
    int count();
    int silent();

    /// One way.
    void twice(int);
    /// Another way.
    void twice(double);
};

/// A free function,
///
/// of two paragraphs: "{".
template <class T>
std::vector<T> made(const T& of);
"""
ATTRIBUTE = 'module.attr("law_keys") = 1;\n'


def bound():
    for name, each in vars(_core).items():
        if name.startswith("_") or not callable(each):
            continue
        yield name
        if inspect.isclass(each):
            yield from (f"{name}.{of}" for of in vars(each) if not of.startswith("_"))


def texts(name):
    """What is said of each overload of a name, behind its signature."""
    home, _, member = name.partition(".")
    each = getattr(_core, home)
    lines = ((getattr(each, member) if member else each).__doc__ or "").strip().splitlines()
    said = [""]
    for line in map(str.strip, lines):
        if re.match(r"\d+\. ", line):
            said.append("")
        elif line != "Overloaded function." and not SIGNATURE.fullmatch(line):
            said[-1] += line
    return said[1:] or said


def test_each_bound_name_has_a_docstring():
    names = list(bound())
    assert {"Snapshot", "Simulator.step", "Scenario.take", "sweep"} <= {*names}
    assert [name for name in names if not all(texts(name))] == []


def made(folder, *names, header=HEADER):
    """The process that makes docstrings of a binding with these names, and its two files."""
    headers = folder / "headers"
    headers.mkdir(exist_ok=True)
    (headers / "laws.hpp").write_text(header)
    binding = folder / "binding.cpp"
    binding.write_text(ATTRIBUTE + "".join(f"bind(doc::{name});\n" for name in names))
    done = python_process(ROOT / "cmake" / "docstrings.py", folder / "to", headers, binding)
    return done, folder / "to" / "docstrings.hpp", folder / "to" / "docstrings.cpp"


def test_docstrings_are_the_comments_in_terms_of_python(tmp_path):
    done, names, of_names = made(tmp_path, "Laws", "Laws_size", "Laws_share", "made")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    declared = re.findall(r"extern const char\* const (\w+);", names.read_text())
    assert declared == ["Laws", "Laws_share", "Laws_size", "made"]
    found = re.findall(r'(\w+) = R"doc\((.*?)\)doc"', of_names.read_text(), re.DOTALL)
    assert dict(found) == {
        "Laws": "Laws beside those of the model. Raises\nScenarioError for a name of `law_keys`.",
        "Laws_size": "Number of laws.",
        "Laws_share": "Of the force, 1.",
        "made": 'A free function,\n\nof two paragraphs: "{".',
    }


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("Laws_sizes", "0 comments have this name"),
        ("size", "0 comments have this name"),
        ("Laws_silent", "0 comments have this name"),
        ("Laws_twice", "2 comments have this name"),
        ("Laws_count", "Laws::size means nothing in Python"),
    ],
)
def test_a_name_without_its_comment_is_refused(tmp_path, name, why):
    done, *files = made(tmp_path, "Laws", name)
    assert done.returncode == 1
    assert done.stderr == f"{tmp_path / 'binding.cpp'}:3: doc::{name}: {why}\n"
    assert not any(file.exists() for file in files)
