"""``python -m stickslip`` is the command ``stickslip``."""

from stickslip.cli import main

if __name__ == "__main__":
    main()
