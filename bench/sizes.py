"""What an installation with each extra takes, with its dependencies, in MB."""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

EXTRAS = ("", "[netcdf]", "[plot]", "[diagnosis]", "[optimise]", "[all]")


def pip(*arguments: str | Path) -> None:
    subprocess.run([sys.executable, "-m", "pip", *arguments, "--quiet"], check=True)


def main() -> None:
    argparse.ArgumentParser(prog="python -m bench sizes", description=__doc__).parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        pip("wheel", "--no-deps", "--wheel-dir", folder, ".")
        (wheel,) = folder.glob("*.whl")
        for number, extra in enumerate(EXTRAS):
            target = folder / str(number)
            pip("install", "--target", target, f"{wheel}{extra}")
            size = sum(path.stat().st_size for path in target.rglob("*") if path.is_file())
            print(f"{size / 1e6:4.0f} MB  stickslip{extra}", flush=True)


if __name__ == "__main__":
    main()
