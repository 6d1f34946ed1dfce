"""One run and its number: whether an installed stickslip computes what it should.

    python tests/check_run.py

It needs no more than the base installation, and exits with 1 if the number is another.
"""

import sys

from stickslip import Drive, Scenario, simulate

MEAN_VELOCITY = 1.9128050696029081e-3  # m/s, of g++ 12 on x86-64-v3
# Another compiler, C library or processor rounds some operations otherwise: Clang with musl differs
# by 8e-15, a processor without fused multiply-add by 4e-15.
TOLERANCE = 1e-12


def main() -> int:
    velocity = simulate(Scenario(drive=Drive(base=0.5e-3, pulses=20))).mean_velocity
    error = abs(velocity / MEAN_VELOCITY - 1.0)
    print(f"mean velocity {velocity!r} m/s, relative error {error:.1e}")
    return 0 if error <= TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main())
