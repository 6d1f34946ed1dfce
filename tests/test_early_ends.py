"""Commands that end early: one line, and of their files those that are whole."""

import re
import shlex
import signal

import pytest

from command_line import ended_at_the_bar, files_up_to, stickslip
from made_measurement import write

FILES = {
    "s.toml": "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 4\nramp = 0.02\n",
    "u.toml": '[uncertain]\n"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }\n',
}
HOURS = "--set=solver.max_step=1e-7 --set=drive.pulses=5000"
SEARCH = "--maximise=mean_velocity --free=drive.hold=0.5e-3:2e-3 --fresh=5 --draws=3"
TERMINATED = 2 * (signal.SIGTERM,)  # as `timeout` sends it: to the process and to its group


def lay_out(folder, command):
    """The files that a command reads, and an empty folder to write into."""
    (folder / "out").mkdir()
    if "m.toml" in command:
        # One condition of eight has no other to stand beside.
        few = None if command.endswith("seed=1") else lambda lines: lines[:4]
        write(folder, {"effects.surface_tilt.angle": 0.04}, change=few)
    for name, text in FILES.items():
        (folder / name).write_text(text)


def left_in(folder):
    return sorted(str(each.relative_to(folder)) for each in folder.rglob("*") if each.is_file())


# What the bar shows when the signals come, what is said behind "interrupted", the files that stay.
# A run of hours ends; how fast is not asked of a busy machine.
INTERRUPTED = {
    f"run s.toml {HOURS}": ("simulating", "", []),
    # As many pulses as the default of solver.max_steps allows, two stretches each.
    "run s.toml --set=drive.peak=0.6e-3 --set=drive.hold=1e-6 --set=drive.pulses=499e6": (
        "simulating", "", [],
    ),
    f"run s.toml {HOURS} --set=record.rate=1e7 --out=out/a.nc": (
        "simulating", r", \S+a\.nc\.part has the record up to \S+ s", ["a.nc.part"], TERMINATED,
    ),
    "sweep s.toml --set=solver.max_step=1e-6 --vary=drive.frequency=50:60:1000 --out=out/a.nc": (
        r" [1-9]\d*/1000", r", \S*a\.nc has \d+ of 1000 points.*--resume.*", ["a.nc"],
    ),
    f"predict s.toml --uncertain=u.toml {HOURS} --out=out/a.csv": ("%", "", []),
    f"optimise s.toml {SEARCH} {HOURS} --out=out/found": ("%", "", []),
    # Beyond its start, which may show the bar before anything is found.
    f"optimise s.toml {SEARCH} --evaluations=100000 --out=out/found": (
        "(?s)(%.*){3}", ", this is the best so far", ["found/best.png", "found/best.toml"],
    ),
    "diagnose m.toml --out=out/found --threads=1 --seed=1": ("%", "", []),
}  # fmt: skip


# Those of the others, which take long to begin, are nightly.
@pytest.mark.parametrize(
    "command",
    [
        pytest.param(c, marks=() if c.startswith("run") else pytest.mark.nightly)
        for c in INTERRUPTED
    ],
)
def test_a_signal_ends_a_command(tmp_path, command):
    shows, said, left, *signals = INTERRUPTED[command]
    lay_out(tmp_path, command)
    how = {"signals": signals[0]} if signals else {}
    done, _ = ended_at_the_bar(*shlex.split(command), shows=shows.encode(), cwd=tmp_path, **how)
    assert done.returncode == 130
    assert ("best so far" in said) == (done.stdout != b"")
    assert b"Traceback" not in done.stderr
    last = done.stderr.decode().replace("\r", "\n").splitlines()[-1]
    assert re.fullmatch(f"stickslip: interrupted{said}", last), last
    assert left_in(tmp_path / "out") == left


# The largest file that there is room for, bytes, and a word of what is printed all the same: what
# took long to compute is not lost with its file.
FULL = {
    "init out/s.toml": (1_000, ""),
    "run s.toml --set=record.rate=2e3 --out=out/a.nc": (10_000, ""),
    "run s.toml --out=out/a.csv": (10_000, ""),
    "run s.toml --plot=out/a.png": (10_000, "mean_velocity"),
    "sweep s.toml --vary=drive.mode=IPP,OPP --out=out/a.nc": (10_000, ""),
    "predict s.toml --uncertain=u.toml --draws=4 --out=out/a.csv": (100, "mean_velocity"),
    f"optimise s.toml {SEARCH} --evaluations=20 --out=out/found": (300, "mean_velocity"),
    "diagnose m.toml --out=out/found": (1_000, "Verdict: data-problem"),
}


@pytest.mark.parametrize("command", FULL)
def test_a_full_disk_is_told_and_leaves_no_file(tmp_path, command):
    largest, printed = FULL[command]
    lay_out(tmp_path, command)
    with files_up_to(largest):
        done = stickslip(*shlex.split(command), cwd=tmp_path)
    assert done.returncode == 1
    assert printed in done.stdout
    assert (printed == "") == (done.stdout == "")
    # A slow machine shows a bar before.
    last = done.stderr.replace("\r", "\n").splitlines()[-1]
    assert last.startswith("stickslip: cannot write out/"), done.stderr
    assert "Traceback" not in done.stderr
    assert left_in(tmp_path / "out") == []
