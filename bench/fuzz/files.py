"""Damaged files of every kind through the command: it ends with 0, or with 2 and one line."""

from __future__ import annotations

import os
import re
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fuzz.checks import Found, found
from fuzz.originals import originals
from stickslip import cli

KINDS = ("scenario", "measurement", "velocity", "tracking", "angle", "field", "voltages", "sweep")

# A command that computes on is interrupted after the one and has to hear it within the other, s.
_PATIENCE, _HEARING = 4.0, 4.0

_BAD_INPUT, _FAILED, _INTERRUPTED = 2, 1, 130

_NUMBERS = (
    b"nan", b"inf", b"-inf", b"1e400", b"-1", b"0", b"-0.0", b"1e308", b"-1e308", b"5e-324",
    b"1e-300", b"1" + b"0" * 25, b"1" * 5000, b"0x1F", b"0b11", b"1_000", b"true", b'"1"', b"[1]",
    b"{}", b"2008-06-25", b"07:00:00", b"", b"1.", b".5", b"+1", b"1e", b"--1", "\uff11".encode(),
)  # fmt: skip

_PIECES = (
    b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", b"\r", b"\r\n", b"\n\n\n", b",,,", b'"', b"'''", b'"""',
    b"[[[[", b"]", b"=", b"#", b"\\", b"\\u0000", b"\t", b"a.b.c.d = 1\n", b"[" * 3000,
    b"a." * 900 + b"b = 1\n", b"x = " + b"{a=" * 400 + b"1" + b"}" * 400 + b"\n",
    "é\u2028".encode(), b"%s%n", b"../../etc/passwd",
)  # fmt: skip


class Outcome(NamedTuple):
    """Of a command: its exit status (negative for a signal), what it printed, how long it took."""

    code: int
    out: str
    err: str
    seconds: float


def check_file(name: str) -> Found:
    """A damaged file, named ``kind:seed:number``."""
    kind, seed, number = name.split(":")
    original = originals()[kind]
    random = np.random.default_rng([KINDS.index(kind), int(seed), int(number)])
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
        for file, content in original.files.items():
            if file == original.damaged:
                content = damaged(content, random)
            (Path(folder) / file).write_bytes(content)
        outcome = command(Path(folder), original.command)
    return found(wrong(outcome), str(outcome.code))


def wrong(outcome: Outcome) -> list[str]:
    """What about the end of a command is not as promised."""
    if outcome.code < 0:
        how = "hangs" if outcome.seconds > _PATIENCE else f"signal {-outcome.code}"
        return [how]
    said = outcome.err.strip().splitlines()
    last = said[-1] if said else ""
    if "Traceback" in outcome.err:
        return [f"traceback, exit status {outcome.code}: {last}"]
    if outcome.code not in (0, _FAILED, _BAD_INPUT, _INTERRUPTED):
        return [f"exit status {outcome.code}: {last}"]
    if outcome.code == _BAD_INPUT and (len(said) != 1 or outcome.out):
        return [f"bad input in {len(said)} lines: {' | '.join(said)[:200]}"]
    if outcome.code == _FAILED and not outcome.out:
        return [f"exit status 1 without a result: {last}"]
    return []


def damaged(content: bytes, random: np.random.Generator) -> bytes:
    """The content with one to three damages."""
    ways = (_flip, _truncate, _insert, _cut, _overwrite)
    if b"\x00" not in content:
        ways += (_number, _number, _repeat_line, _swap_lines)
    for _ in range(random.integers(1, 4)):
        content = ways[random.integers(len(ways))](content, random)
    return content


def _place(content: bytes, random: np.random.Generator) -> int:
    return int(random.integers(len(content) + 1))


def _flip(content: bytes, random: np.random.Generator) -> bytes:
    data = bytearray(content)
    for _ in range(random.integers(1, 5) if data else 0):
        data[random.integers(len(data))] ^= 1 << int(random.integers(8))
    return bytes(data)


def _truncate(content: bytes, random: np.random.Generator) -> bytes:
    return content[: _place(content, random)]


def _insert(content: bytes, random: np.random.Generator) -> bytes:
    at = _place(content, random)
    piece = _PIECES[random.integers(len(_PIECES))]
    if random.random() < 0.3:
        piece = random.bytes(int(random.integers(1, 20)))
    return content[:at] + piece + content[at:]


def _cut(content: bytes, random: np.random.Generator) -> bytes:
    at = _place(content, random)
    return content[:at] + content[at + int(random.integers(1, 40)) :]


def _overwrite(content: bytes, random: np.random.Generator) -> bytes:
    at, length = _place(content, random), int(random.integers(1, 64))
    filling = (random.bytes(length), b"\x00" * length, b"\xff" * length)[random.integers(3)]
    return (content[:at] + filling + content[at + length :])[: len(content)]


def _number(content: bytes, random: np.random.Generator) -> bytes:
    places = list(re.finditer(rb"-?\d[\d.eE+-]*", content))
    if not places:
        return content
    here = places[random.integers(len(places))]
    number = _NUMBERS[random.integers(len(_NUMBERS))]
    return content[: here.start()] + number + content[here.end() :]


def _repeat_line(content: bytes, random: np.random.Generator) -> bytes:
    lines = content.split(b"\n")
    lines.insert(int(random.integers(len(lines))), lines[random.integers(len(lines))])
    return b"\n".join(lines)


def _swap_lines(content: bytes, random: np.random.Generator) -> bytes:
    lines = content.split(b"\n")
    a, b = random.integers(len(lines), size=2)
    lines[a], lines[b] = lines[b], lines[a]
    return b"\n".join(lines)


def command(folder: Path, arguments: tuple[str, ...]) -> Outcome:
    """The command in `folder`, in a fork of this process, which may exit as it likes."""
    begun = time.monotonic()
    pid = os.fork()
    if pid == 0:
        _become(folder, arguments)
    interrupted = False
    while True:
        ended, status = os.waitpid(pid, os.WNOHANG)
        seconds = time.monotonic() - begun
        if ended:
            break
        if seconds > _PATIENCE + _HEARING:
            os.kill(pid, signal.SIGKILL)
        elif seconds > _PATIENCE and not interrupted:
            os.kill(pid, signal.SIGINT)
            interrupted = True
        time.sleep(0.005)
    texts = [(folder / name).read_text(errors="replace") for name in ("stdout", "stderr")]
    return Outcome(os.waitstatus_to_exitcode(status), *texts, seconds)


def _become(folder: Path, arguments: tuple[str, ...]) -> None:
    os.chdir(folder)
    for stream, name in ((1, "stdout"), (2, "stderr")):
        os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT), stream)
        # Where these were something else than the streams of the process, as within pytest.
        setattr(sys, name, os.fdopen(stream, "w", closefd=False))
    code = 70
    try:
        cli.main(arguments)
    except SystemExit as end:
        code = int(end.code or 0)
    except BaseException:
        sys.excepthook(*sys.exc_info())
        code = 1
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
