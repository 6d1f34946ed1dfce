"""Drawn changes of the core and the machines, which are built step by step in build/mutations."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path

from mutations import trial
from mutations.trial import ROOT, Mutation, limited

SCRATCH = ROOT / "build" / "mutations"
SOURCE, BUILD, PACKAGE = (SCRATCH / name for name in ("source", "build", "package"))
FILES = ("cpp/stickslip/**/*.[ch]pp", "cpp/machines/*.[ch]pp")
_IDLE = re.compile(  # what is no text of a running program
    rb'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\])\'|\[\[[^\n]*?\]\]'
    rb"|^ *(?:#|static_assert|template|using|requires|namespace|STICKSLIP)[^\n]*",
    re.DOTALL | re.MULTILINE,
)
_PAIRS = "< >=", "> <=", "== !=", "+ -", "* /", "+= -=", "&& ||", "true false"
_TURNED = dict(map(str.split, _PAIRS)) | {word: old for old, word in map(str.split, _PAIRS)}
# Between blanks as the formatter leaves them, so that neither pointers nor templates are meant.
_OPERATOR = re.compile(rb"(?<= )(?:<=|>=|==|!=|\+=|-=|&&|\|\||[-+*/<>])(?= )|\b(?:true|false)\b")
_SIGN = re.compile(
    rb"(?<=[(\[{])-(?=[\w(])|(?<=[=,?:] )-(?=[\w(])|(?<=return )-(?=[\w(])|!(?=[\w(])"
)
_NUMBER = re.compile(rb"(?<![\w.'<])\d[\d.]*(?:e[-+]?\d+)?(?![\w.'>])")
_IF = re.compile(rb"\bif \(")


def mutations(file: str, source: bytes) -> Iterator[Mutation]:
    """All mutations of a file."""
    bare = _IDLE.sub(lambda idle: re.sub(rb"[^\n]", b" ", idle[0]), source)
    found = [(*each.span(), _TURNED[each[0].decode()]) for each in _OPERATOR.finditer(bare)]
    found += [(*each.span(), "") for each in _SIGN.finditer(bare)]
    for each in _NUMBER.finditer(bare):
        text = each[0].decode()
        changed = int(text) + 1 if text.isdigit() else 1.5 * float(text) or 1.0
        found.append((*each.span(), str(changed)))
    for each in _IF.finditer(bare):
        start, depth = each.end(), 1
        stop = start
        while depth:
            depth += {ord("("): 1, ord(")"): -1}.get(bare[stop], 0)
            stop += 1
        if b";" not in bare[start : stop - 1]:
            found.append((start, stop - 1, f"!({source[start : stop - 1].decode()})"))
    for start, stop, text in found:
        yield Mutation(file, source[:start].count(b"\n") + 1, start, stop, text)


def can_be_read(source: bytes) -> bool:
    """The compiler says it, in the trial."""
    return True


def copy_sources() -> None:
    """The sources as they are; one that is the same keeps its time, so that nothing is built."""
    for path in (ROOT / "cpp").rglob("*.?pp"):
        put(SOURCE / path.relative_to(ROOT), path.read_text())
    for path in (*(ROOT / "cmake").iterdir(), ROOT / "CMakeLists.txt"):
        put(SOURCE / path.relative_to(ROOT), path.read_text())
    there = {path.relative_to(SOURCE) for path in (SOURCE / "cpp").rglob("*.?pp")}
    for gone in there - {path.relative_to(ROOT) for path in (ROOT / "cpp").rglob("*.?pp")}:
        (SOURCE / gone).unlink()
    shutil.rmtree(PACKAGE, ignore_errors=True)
    ignored = shutil.ignore_patterns("*.so", "__pycache__")
    shutil.copytree(ROOT / "python" / "stickslip", PACKAGE / "stickslip", ignore=ignored)


def put(path: Path, text: str) -> None:
    """Write a file where it differs."""
    if path.exists() and path.read_text() == text:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def configure() -> None:
    """Configure as scikit-build-core does for a wheel, but quicker to compile, with the tests."""
    said = failure(
        *("-S", SOURCE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Mutations"),
        "-DCMAKE_CXX_FLAGS_MUTATIONS=-O1 -fno-math-errno",
        "-DSTICKSLIP_BUILD_PYTHON=ON",
        "-DSTICKSLIP_BUILD_TESTS=ON",
        "-DSKBUILD_PROJECT_VERSION=0.1.0",
        f"-DPython_EXECUTABLE={sys.executable}",
        f"-DCMAKE_PREFIX_PATH={sysconfig.get_path('purelib')}",
    ) or build("_core", "_machines")
    if said:
        sys.exit(said)


def build(*targets: str) -> str:
    """Build targets of the copy, its modules beside the copied package; what goes wrong."""
    said = failure("--build", BUILD, "--target", *targets)
    for module in BUILD.glob("_*.so"):
        shutil.copy(module, PACKAGE / "stickslip")
    return said


def failure(*arguments: object) -> str:
    """Run CMake; its output if it fails, else nothing."""
    command = ["cmake", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return f"{' '.join(command)}\n{done.stdout}{done.stderr}" if done.returncode else ""


class Copy(trial.Copy):
    """The sources and a build of them, with its own tests."""

    folder, package = SOURCE, PACKAGE

    def __init__(self) -> None:
        copy_sources()
        configure()
        if said := self.own_tests(600.0):
            raise SystemExit(f"without a change: {said}")

    def build(self) -> bool:
        return not build("_core", "_machines")

    def own_tests(self, limit: float) -> str:
        if build("stickslip_tests"):
            return "stickslip_tests is not built"
        command = [BUILD / "stickslip_tests", "--abort-after=1", "--no-intro", "--minimal"]
        status, said = limited(lambda: subprocess.call(command), limit)
        return next(iter(said.split("\n")), "hangs") if status else ""
