"""How large each wing of the project is: ``python -m bench lines``."""

from __future__ import annotations

import argparse
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def _package(of: str) -> str:
    return rf"python/stickslip/({of})\.py"


WINGS = {
    "common": _package(r"_util/.*|errors"),
    "simulator": _package(r"(scenario|field|simulation|sweeping|plot)/.*"),
    "applications": _package(r"(design|control)/.*"),
    "paper": r"bench/paper/.*\.py",
    "diagnosis": _package(r"diagnosis/.*"),
    "machines": rf"{_package(r'(models|machines)/.*')}|cpp/machines/.*\.[hc]pp",
    "walker": _package(r"walker/.*"),
    "command": _package(r"cli/.*|(?!errors)\w+"),
    "core": r"cpp/(stickslip|bindings)/.*\.[hc]pp|cmake/.*\.py",
    "tests": r"(tests|cpp/tests)/.*\.(py|[hc]pp)",
    "bench": r"bench/(?!paper/).*\.(py|cpp)",
}
"""Which files belong to a wing."""
WORDS = r"(docs/.*|README|CONTRIBUTING)\.md"


def texts(pattern: str) -> list[str]:
    """Read the files of the project whose whole path matches, ignored ones apart."""
    command = ["git", "-C", str(ROOT), "ls-files", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    paths = (ROOT / name for name in names if re.fullmatch(pattern, name))
    return [path.read_text() for path in paths if path.exists()]


def main() -> None:
    argparse.ArgumentParser(prog="python -m bench lines", description=__doc__).parse_args()
    for wing, pattern in WINGS.items():
        print(f"{wing:<24}{sum(len(each.splitlines()) for each in texts(pattern)):>8}")
    print(f"{'words of the pages':<24}{sum(len(each.split()) for each in texts(WORDS)):>8}")


if __name__ == "__main__":
    main()
