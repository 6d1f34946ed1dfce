"""Scenarios through the core that the address and undefined-behaviour sanitizers watch."""

from __future__ import annotations

import resource
import subprocess
from pathlib import Path

import numpy as np

from fuzz.checks import Found, found
from fuzz.scenarios import Identity, scenario
from stickslip.scenario.keys import SAWTOOTH, known_keys

PROGRAM = Path("build/asan/stickslip_fuzz")
"""Built by ``python -m bench fuzz --check sanitized``."""

_SECONDS = 25.0


def check_sanitized(identity: Identity) -> Found:
    """The sanitized program takes the scenario, and ends without a complaint."""
    lines = [f"{key}={value}\n" for key, value in core_keys(identity).items()]
    # The shadow memory of the sanitizers takes terabytes of addresses.
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    try:
        done = subprocess.run(
            [PROGRAM], input="".join(lines), capture_output=True, text=True, timeout=_SECONDS
        )
    except subprocess.TimeoutExpired:
        # A sanitized run takes some ten times as long; the check `status` looks for hangs.
        return found([], "slow")
    if done.returncode == 0:
        return found([], done.stdout.split()[0])
    complaint = [line for line in done.stderr.splitlines() if "ERROR" in line or "error" in line]
    return found([(complaint or [f"exit status {done.returncode}"])[0]], "complaint")


def core_keys(identity: Identity) -> dict[str, str]:
    """Keys and values as the core takes them, and the one block of a program."""
    given = scenario(identity)
    keys: dict[str, str] = {}
    program = given.drive.program
    for name in known_keys():
        if name not in SAWTOOTH or program is None:
            value = given.get(name)
            keys[name] = repr(value) if isinstance(value, float) else str(value)
    if program is not None:
        ((times, voltages, repeats),) = program.blocks
        rows = np.column_stack([times, voltages]).tolist()
        keys["program"] = ";".join([str(repeats), *(" ".join(map(repr, row)) for row in rows)])
    return keys
