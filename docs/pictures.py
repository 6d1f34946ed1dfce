"""Make the pictures of the README and of the pages, into docs/images/.

``python docs/pictures.py`` makes all of them, ``python docs/pictures.py gallery drawings`` those of
some sources: a page by its path in docs/ without suffix, ``readme`` or ``drawings``. The pictures
of a page are those that its own code saves.
"""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

DOCS = Path(__file__).parent
IMAGES = DOCS / "images"
sys.path[:0] = [str(DOCS / "_extensions"), str(DOCS.parent / "tests")]

from documentation_blocks import pages, play  # noqa: E402

_LINK = re.compile(r"!\[[^\]]*\]\(([^)\s]*images/[^)\s]+)\)")


def linked(page: Path) -> list[Path]:
    """The pictures that a page shows."""
    links = _LINK.findall(page.read_text(encoding="utf-8"))
    return list(dict.fromkeys((page.parent / link).resolve() for link in links))


def make_page(page: Path) -> None:
    """Run the code of a page, and keep what it saves and shows."""
    with play(page) as folder:
        for picture in linked(page):
            if (folder / picture.name).is_file():
                keep(folder / picture.name, picture)


def keep(made: Path, picture: Path) -> None:
    """Copy a picture to its place, and say how large it is."""
    picture.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(made, picture)
    print(f"{picture.stat().st_size / 1e3:6.0f} kB  {picture.relative_to(DOCS.resolve())}")


def sources() -> dict[str, Callable[[], None]]:
    """What makes pictures, by name."""
    found: dict[str, Callable[[], None]] = {}
    for page in pages(DOCS):
        if linked(page):
            name = str(page.relative_to(DOCS).with_suffix(""))
            found[name] = lambda page=page: make_page(page)
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
