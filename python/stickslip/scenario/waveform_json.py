"""The voltages of a program as one text, for files whose scenario leaves them out."""

from __future__ import annotations

import json

from stickslip.scenario.waveform import Waveform


def voltage_blocks(program: Waveform | None) -> str:
    """Blocks of times (s) and voltages (V) as JSON; empty where there is no program."""
    if program is None:
        return ""
    return json.dumps(
        [{"t": t.tolist(), "V": v.tolist(), "repeats": n} for t, v, n in program.blocks]
    )


def program_of(blocks: str) -> Waveform:
    """The program of what `voltage_blocks` gave."""
    return Waveform([(each["t"], each["V"], each["repeats"]) for each in json.loads(blocks)])
