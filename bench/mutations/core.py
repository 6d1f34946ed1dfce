"""Changes of the core and the machines, which are built step by step in build/mutations."""

from __future__ import annotations

import filecmp
import re
import shutil
import subprocess
import sys
import sysconfig
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from mutations.trial import PAIRS, ROOT, SCRATCH, limited, turned

SOURCE, BUILD = SCRATCH / "source", SCRATCH / "build"
_TARGETS = "--build", BUILD, "--target"
FILES = ("cpp/stickslip/**/*.[ch]pp", "cpp/machines/*.[ch]pp")
_IDLE = re.compile(  # what is no text of a running program
    rb'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\])\'|\[\[[^\n]*?\]\]'
    rb"|^ *(?:#|static_assert|template|using|requires|namespace|STICKSLIP)[^\n]*",
    re.DOTALL | re.MULTILINE,
)
_TURNED = turned(*PAIRS, ("+=", "-="), ("&&", "||"), ("true", "false"))
# Between blanks as the formatter leaves them, so that neither pointers nor templates are meant.
_OPERATOR = re.compile(rb"(?<= )(?:<=|>=|==|!=|\+=|-=|&&|\|\||[-+*/<>])(?= )|\b(?:true|false)\b")
_SIGN = re.compile(rb"(?:(?<=[(\[{])-|(?<=[=,?:] )-|(?<=return )-|!)(?=[\w(])")
_NUMBER = re.compile(rb"(?<![\w.'<])\d[\d.]*(?:e[-+]?\d+)?(?![\w.'>])")
_INNER = rb"[^();]"
for _ in range(6):
    _INNER = rb"(?:[^();]|\(" + _INNER + rb"*\))"
_IF = re.compile(rb"\bif \((" + _INNER + rb"*)\)")
_TEST = re.compile(r"^def (test_\w+)(.*?)(?=^[@\w]|\Z)", re.DOTALL | re.MULTILINE)


def mutations(source: bytes) -> Iterator[tuple[int, int, str]]:
    """All changes of a file: from where to where which text is put."""
    bare = _IDLE.sub(lambda idle: re.sub(rb"[^\n]", b" ", idle[0]), source)
    for each in _OPERATOR.finditer(bare):
        yield *each.span(), _TURNED[each[0]]
    for each in _SIGN.finditer(bare):
        yield *each.span(), ""
    for each in _NUMBER.finditer(bare):
        changed = int(each[0]) + 1 if each[0].isdigit() else 1.5 * float(each[0]) or 1.0
        yield *each.span(), str(changed)
    for start, stop in (each.span(1) for each in _IF.finditer(bare)):
        yield start, stop, f"!({source[start:stop].decode()})"


def put(source: str | Path, target: str | Path) -> None:
    """Copy a file where it differs."""
    if not Path(target).exists() or not filecmp.cmp(source, target, shallow=False):
        shutil.copyfile(source, target)


def cmake(*arguments: object) -> str:
    """Run CMake; its output if it fails, else nothing."""
    command = ["cmake", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return f"{' '.join(command)}\n{done.stdout}{done.stderr}" if done.returncode else ""


class Copy:
    """The sources and a build of them, with its own tests."""

    folder, package = SOURCE, SOURCE / "python"

    def __init__(self, tests: list[str]) -> None:
        """Configure as scikit-build-core does for a wheel, but quicker to compile, with tests."""
        self.tests = tests
        # A source that is the same keeps its time, so that nothing is built.
        idle = shutil.ignore_patterns("*.so", "__pycache__")
        for folder in "cpp", "cmake", "python":
            shutil.copytree(ROOT / folder, SOURCE / folder, False, idle, put, dirs_exist_ok=True)
        put(ROOT / "CMakeLists.txt", SOURCE / "CMakeLists.txt")
        for path in SOURCE.rglob("*.*"):
            if path.is_file() and not (ROOT / path.relative_to(SOURCE)).exists():
                path.unlink()
        said = cmake(
            *("-S", SOURCE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Mutations"),
            *("-DSTICKSLIP_BUILD_PYTHON=ON", "-DSTICKSLIP_BUILD_TESTS=ON"),
            *("-DCMAKE_CXX_FLAGS_MUTATIONS=-O1 -fno-math-errno", "-DSKBUILD_PROJECT_VERSION=0.1.0"),
            f"-DPython_EXECUTABLE={sys.executable}",
            f"-DCMAKE_PREFIX_PATH={sysconfig.get_path('purelib')}",
        )
        said = said or cmake(*_TARGETS, "_core", "_machines", "stickslip_tests")
        if said := said or self.build(SOURCE, 600.0):
            sys.exit(f"without a change: {said}")

    def build(self, path: Path, limit: float) -> tuple[str, str] | None:
        """Build the modules beside the copied package, and run the tests in C++."""
        if cmake(*_TARGETS, "_core", "_machines"):
            return "unbuilt", ""
        for module in BUILD.glob("_*.so"):
            shutil.copy(module, self.package / "stickslip")
        if cmake(*_TARGETS, "stickslip_tests"):
            return "seen", "stickslip_tests is not built"
        command = [BUILD / "stickslip_tests", "--abort-after=1", "--no-intro", "--minimal"]
        status, said = limited(lambda: subprocess.call(command), limit)
        return ("seen", said.partition("\n")[0] or "hangs") if status else None

    def near(self, file: str, line: int) -> list[str]:
        """Tests in Python that name the module or its folder, those first that often do."""
        module, folder = Path(file).stem, Path(file).parent.name
        words = "|".join(re.findall("[^_]{4,}", module) or [module])
        share = Counter()
        for path in sorted((ROOT / "tests").rglob("test_*.py")):
            for test, text in _TEST.findall(path.read_text(encoding="utf-8")):
                name = f"{path.relative_to(ROOT).as_posix()}::{test}"
                often = 10 * len(re.findall(words, name + text)) + text.count(folder)
                share[name] = often / (len(text) + 200)
        near = (name for name, part in share.most_common() if part > 0.0)
        return [name for name in near if name.startswith(tuple(self.tests))]
