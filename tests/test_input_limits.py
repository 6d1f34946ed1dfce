"""Input that is too long, too deep, endless or badly named: one line, in bounded time."""

import os
import threading

import pytest

from command_line import check, stickslip, stickslip_process
from made_measurement import write
from refusals.scenario import CSV, HEAD, PROGRAM
from stickslip import ScenarioError, Waveform, load
from stickslip._util import columns
from stickslip._util.files import check_folder, read_bytes
from stickslip.walker import read_measurement
from stickslip.walker.read_velocity import velocities

MEASUREMENT = 'stickslip_measurement = 1\nscenario = "s.toml"\n'
NOT_UTF8 = "caf\udce9"  # how Python spells the bytes "café" has in Latin-1


def refused(path, *words, read=load):
    with pytest.raises(ScenarioError) as error:
        read(path)
    text = str(error.value)
    assert text.isprintable()
    assert text.startswith(str(path))
    for word in words:
        assert word in text, text


def read_table(path):
    return columns.read_table(path, velocities())


def test_links_in_a_circle_are_refused(tmp_path):
    (tmp_path / "s.toml").write_text(HEAD)
    (tmp_path / "loop.nc").symlink_to("loop.nc")
    check(stickslip("run", "s.toml", "--set=drive.file=loop.nc", cwd=tmp_path), "loop.nc")
    refused(tmp_path / "loop.nc", "symbolic links")
    with pytest.raises(OSError, match=r"cannot write .*circle"):
        check_folder(tmp_path / "loop.nc")
    (tmp_path / "m.toml").write_text(f'{MEASUREMENT}[[velocity]]\nfile = "loop.nc"\n')
    with pytest.raises(ScenarioError, match="symbolic links"):
        read_measurement(tmp_path / "m.toml")


def test_names_that_no_report_could_hold_are_refused_before_the_work(tmp_path):
    path = write(tmp_path, {})
    check(stickslip("diagnose", path, "--out", tmp_path / NOT_UTF8), "--out", "not UTF-8")
    check(stickslip("run", path.with_name("nominal.toml"), "--out", f"{NOT_UTF8}.nc"), "not UTF-8")
    check(stickslip("run", path.with_name("nominal.toml"), f"--set=drive.mode={NOT_UTF8}"), "mode")
    os.rename(path, tmp_path / f"{NOT_UTF8}.toml")
    check(stickslip("diagnose", tmp_path / f"{NOT_UTF8}.toml"), "not UTF-8")
    assert sorted(os.listdir(tmp_path)) == [f"{NOT_UTF8}.toml", "nominal.toml", "velocity.csv"]


def test_a_pipe_is_read(tmp_path):
    for scenario in (HEAD + "pulses = 4\n", ""):
        done = stickslip_process("run", "/dev/stdin", "--json", input=scenario)
        assert done.returncode == (0 if scenario else 2), done.stderr
    (tmp_path / "s.toml").write_text(PROGRAM.replace("v.csv", "/dev/stdin"))
    assert stickslip_process("run", tmp_path / "s.toml", input=CSV).returncode == 0


def test_an_endless_pipe_is_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe")

    def write_for_ever():
        with open(tmp_path / "pipe", "wb", buffering=0) as pipe:
            try:
                while True:
                    pipe.write(b"y\n" * 1000)
            except BrokenPipeError:
                pass

    writer = threading.Thread(target=write_for_ever)
    writer.start()
    with pytest.raises(ScenarioError, match="longer than 5000 bytes, so it is no table"):
        read_bytes(tmp_path / "pipe", 5000, "table")
    writer.join(timeout=30)
    assert not writer.is_alive()


@pytest.mark.parametrize("read", [load, Waveform.from_csv, read_table])
def test_a_file_that_is_too_long_is_refused(tmp_path, read):
    path = tmp_path / "a"
    with path.open("wb") as file:
        file.truncate(1 << 40)  # takes no place on the disk
    refused(path, "is longer than", "bytes", read=read)


def test_a_table_of_endless_columns_is_refused(tmp_path):
    (tmp_path / "a.csv").write_text(",".join(map(str, range(200_000))) + "\n1\n")
    refused(tmp_path / "a.csv", "200000 columns; allowed are 1000", read=read_table)
