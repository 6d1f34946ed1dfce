"""The command ``stickslip``."""

FAILED = 1
BAD_INPUT = 2
INTERRUPTED = 130  # 128 and the number of SIGINT, as shells have it
