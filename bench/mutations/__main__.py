"""``python -m bench mutations python | core``."""

from __future__ import annotations

import sys

from mutations import core, python, trial

KINDS = {"python": python, "core": core}


def main(arguments: list[str]) -> int:
    """Hand the options to the kind; 2 without one."""
    kind = arguments[0] if arguments else ""
    if kind not in KINDS:
        for name, module in KINDS.items():
            print(f"python -m bench mutations {name} [options]: {module.__doc__.splitlines()[0]}")
        return 0 if kind in ("-h", "--help") else 2
    return trial.main(KINDS[kind], arguments[1:])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
