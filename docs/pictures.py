"""Make the pictures of the README and of the pages, into docs/images/.

``python docs/pictures.py`` makes all of them, ``python docs/pictures.py pictures readme`` those of
some sources: a page by its path in docs/ without suffix, or ``readme``. The pictures of a page are
those that its own code saves, those of the README what its commands write in examples, and those
of the page on real cases what the cases write.
``diagnosis.png`` needs the browser chromium; without it the stored one stays.
"""

from __future__ import annotations

import functools
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from PIL import Image

DOCS = Path(__file__).resolve().parent
IMAGES = DOCS / "images"
README = DOCS.parent / "README.md"
sys.path.insert(0, str(DOCS.parent / "tests"))

from documentation_blocks import EXAMPLES, pages, play  # noqa: E402
from play.browser import PROGRAM as BROWSER  # noqa: E402

_LINK = re.compile(r"!\[[^\]]*\]\(([^)\s]*images/[^)\s]+)\)")
_COMMAND = re.compile(r"(?:\*\*:|comes from) `((?:stickslip|python) [^`]+)`")
_SCREEN, _ZOOM = "900,790", "1.5"  # px; chosen so that it can be read at half the width of a page


def linked(page: Path) -> list[Path]:
    """The pictures in docs/images/ that a page shows."""
    links = _LINK.findall(page.read_text(encoding="utf-8"))
    return list(dict.fromkeys((page.parent / link).resolve() for link in links))


def make_page(page: Path) -> None:
    """Run the code of a page, and keep what it saves and shows."""
    with play(page) as folder:
        for picture in linked(page):
            if (folder / picture.name).is_file():
                _keep(folder / picture.name, picture)


def readme_commands() -> list[str]:
    """The commands that stand below the pictures of the README."""
    return _COMMAND.findall(README.read_text(encoding="utf-8"))


def run_commands(commands: list[str], folder: Path) -> None:
    """Run commands of the README in an empty folder, where its examples are put."""
    shutil.copytree(EXAMPLES, folder, dirs_exist_ok=True)
    for command in commands:
        words = shlex.split(command)
        start = ["-m", "stickslip"] if words[0] == "stickslip" else []
        subprocess.run([sys.executable, *start, *words[1:]], cwd=folder, check=True)


def make_cases(page: Path) -> None:
    """Keep what the cases draw of what their page shows."""
    for picture in linked(page):
        for case in sorted((EXAMPLES / "cases").iterdir()):
            if f'"{picture.name}"' in (case / "case.py").read_text(encoding="utf-8"):
                with tempfile.TemporaryDirectory() as folder:
                    subprocess.run([sys.executable, case / "case.py"], cwd=folder, check=True)
                    _keep(Path(folder) / picture.name, picture)


def make_readme() -> None:
    """Keep what the commands of the README write."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run_commands(readme_commands(), folder)
        _photograph(folder / "found" / "report.html", folder / "diagnosis.png")
        for picture in linked(README):
            if (folder / picture.name).is_file():
                _keep(folder / picture.name, picture)


def _photograph(page: Path, picture: Path) -> None:
    """The first screen of a page as a browser shows it, where there is one."""
    if BROWSER is None:
        print(f"{picture.name}: stays as it is, as there is no Chromium here")
        return
    options = ["--headless", "--hide-scrollbars", f"--window-size={_SCREEN}"]
    options.append(f"--force-device-scale-factor={_ZOOM}")
    if os.geteuid() == 0:
        options.append("--no-sandbox")
    command = [BROWSER, *options, f"--screenshot={picture}", page.as_uri()]
    subprocess.run(command, check=True, capture_output=True)


def _keep(made: Path, picture: Path) -> None:
    """Put a picture in its place, a PNG with the colours that it needs, and say how large it is."""
    picture.parent.mkdir(parents=True, exist_ok=True)
    if picture.suffix == ".png":
        Image.open(made).convert("RGB").quantize(256).save(picture, optimize=True)
    else:
        shutil.copyfile(made, picture)
    print(f"{picture.stat().st_size / 1e3:6.0f} kB  {picture.relative_to(DOCS)}")


def sources() -> dict[str, Callable[[], None]]:
    """What makes pictures, by name."""
    found: dict[str, Callable[[], None]] = {"readme": make_readme}
    for page in pages(DOCS):
        if any("drawings" not in picture.parts for picture in linked(page)):
            name = page.relative_to(DOCS).with_suffix("").as_posix()
            make = make_cases if page.stem == "real-cases" else make_page
            found[name] = functools.partial(make, page)
    return found


def main(names: list[str]) -> None:
    """Make the pictures of some sources, or of all."""
    known = sources()
    unknown = [name for name in names if name not in known]
    if unknown:
        sys.exit(f"{', '.join(unknown)}: known are {', '.join(known)}")
    for name in names or known:
        known[name]()


if __name__ == "__main__":
    main(sys.argv[1:])
