"""Build the page to play with: the core by em++, its page beside it, all in one file.

``python3 cpp/web/build.py [page]`` writes docs/play/index.html, or another page. Without the
compiler the exit status is 2 and the page stays as it is.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PAGE = ROOT / "docs" / "play" / "index.html"
BUILD = ROOT / "build" / "play"

SCRIPTS = (
    "keys",
    "runs",
    "drawing",
    "scene",
    "strips",
    "curve",
    "notes",
    "export",
    "guess",
    "main",
)
"""In the order in which one needs the other."""

LEAST_COMPILER = 3, 1, 69
"""The em++ of Debian 13. The 3.1.6 of Debian 12 lacks parts of C++20."""

TOOLS = "em++", "emcmake", "cmake", "ninja"
PACKAGES = "Debian 13: apt-get install emscripten libeigen3-dev cmake ninja-build"


class BuildError(Exception):
    """What is missing, in one line."""


def main() -> int:
    page = Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE
    try:
        require_tools()
        compile_core()
    except BuildError as error:
        print(f"{page.name} is left as it is: {error}", file=sys.stderr)
        return 2
    text = joined()
    write_whole(page, text)
    print(f"written: {page} ({len(text.encode()) / 1e3:.0f} kB)")
    return 0


def require_tools() -> None:
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing:
        raise BuildError(f"{', '.join(missing)} not found. {PACKAGES}")
    said = subprocess.run(["em++", "--version"], capture_output=True, text=True, check=False).stdout
    found = re.search(r"\b(\d+)\.(\d+)\.(\d+)\b", said)
    if found is None or tuple(map(int, found.groups())) < LEAST_COMPILER:
        version = found.group() if found else "of an unknown version"
        least = ".".join(map(str, LEAST_COMPILER))
        raise BuildError(f"em++ {version} is older than {least}. {PACKAGES}")


def compile_core() -> None:
    BUILD.mkdir(parents=True, exist_ok=True)
    for command in (
        ["emcmake", "cmake", "--preset", "play"],
        ["cmake", "--build", "--preset", "play"],
    ):
        done = subprocess.run(
            command,
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        if done.returncode != 0:
            print(done.stdout, file=sys.stderr)
            raise BuildError(f"{' '.join(command)} failed, as above")


def joined() -> str:
    """The page with its style, scripts and the module, which is packed: half of the size."""
    packed = gzip.compress((BUILD / "play.wasm").read_bytes(), compresslevel=9, mtime=0)
    core = "\n".join(
        [
            (BUILD / "play.js").read_text(encoding="utf-8"),
            f'const CORE_SOURCES = "{fingerprint()}";',
            f'const CORE_WASM = "{base64.b64encode(packed).decode()}";',
            source("load.js"),
        ]
    )
    parts = {
        "/*{page.css}*/": source("page.css"),
        "/*{core}*/": core,
        "/*{scripts}*/": "\n".join([notes(), *(source(f"{name}.js") for name in SCRIPTS)]),
    }
    page = source("page.html")
    for place, part in parts.items():
        before, after = page.split(place)  # each stands there once
        page = before + part + after
    return page


def fingerprint() -> str:
    """Of the sources that the core of the page is built from."""
    files = [*(ROOT / "cpp" / "stickslip").rglob("*.[ch]pp"), HERE / "play.cpp"]
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(f"{file.relative_to(ROOT).as_posix()}\n".encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def fingerprint_of(page: str) -> str:
    """Of the sources that the core of a page was built from."""
    found = re.search(r'^const CORE_SOURCES = "(\w+)";$', page, re.MULTILINE)
    return found[1] if found else "unknown"


def notes() -> str:
    """The version, which the page notes at its end."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return f'const VERSION = "{project["version"]}";'


def source(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def write_whole(page: Path, text: str) -> None:
    """The old page or the new one, whatever happens on the way."""
    page.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=page.parent, prefix=f".{page.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(name).chmod(0o644)
        Path(name).replace(page)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


if __name__ == "__main__":
    sys.exit(main())
