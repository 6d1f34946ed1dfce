"""The command ``stickslip reproduce``."""

import json

import pytest
from click.testing import CliRunner

from command_line import stickslip
from stickslip.cli.reproduce_command import command
from stickslip.reproduction import setting_search, study
from stickslip.reproduction.settings import Grid


@pytest.fixture
def small(monkeypatch):
    """A study that takes a second."""
    grid = Grid(("rise",), ("down", "up"), (0.0, 1e-3), (1.5e-3, 2.5e-3))
    effort = study.Effort(grid, 1, 1)
    monkeypatch.setattr(study, "Effort", lambda: effort)


def test_json_is_one_object(small, tmp_path):
    out = tmp_path / "out"
    done = CliRunner().invoke(command, ["--out", str(out), "--only", "fig9, fig4", "--json"])
    assert done.exit_code == 0
    result = json.loads(done.stdout)
    assert list(result["figures"]) == ["fig4", "fig9"]
    assert [each["name"] for each in result["statements"]] == [f"S{k}" for k in range(1, 18)]
    words = {"reproduced", "not reproduced", "depends"}
    assert {each["verdict"] for each in result["statements"]} <= words
    assert result["reference"]["OPP"]["drive.mode"] == "OPP"
    names = {"fig4.png", "fig4.csv", "fig9.png", "fig9.csv", "index.html", "settings.csv"}
    assert {each.name for each in out.iterdir()} == names
    assert (out / "index.html").read_text(encoding="utf-8").count("<img") == 2


def test_the_text_names_statements_reference_and_page(small, tmp_path):
    done = CliRunner().invoke(command, ["--out", str(tmp_path), "--only=fig6", "--threads=1"])
    assert done.exit_code == 0
    lines = done.stdout.splitlines()
    assert lines[0].startswith("IPP  sudden rise")
    assert lines[1].startswith("OPP  sudden rise")
    for number in range(1, 18):
        assert any(line.startswith(f"S{number} ") for line in lines)
    assert str(tmp_path / "index.html") in lines[-1]


@pytest.mark.parametrize("options", [[], ["--search"]])
def test_an_interrupt_is_told_and_leaves_no_folder(tmp_path, monkeypatch, options):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(study, "survey", interrupted)
    monkeypatch.setattr(setting_search, "survey", interrupted)
    done = stickslip("reproduce", *options, "--out", "found", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr.startswith("stickslip: interrupted at the stage '")
    assert done.stderr.rstrip().endswith("', nothing written")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--only", "fig3"], ['"fig3"', "allowed is", "fig15"]),
        (["--only", ","], ["--only", "fig8,fig12"]),
        (["--measured", "missing.csv"], ["missing.csv", "cannot be read"]),
        (["--measured", "bad.csv"], ["bad.csv", "line 2", "figure", "fig1"]),
        (["--threads", "0"], ["--threads", "0"]),
        (["--nonsense"], ["--nonsense"]),
    ],
)
def test_bad_input_is_one_line_and_exit_code_two(tmp_path, arguments, words):
    (tmp_path / "bad.csv").write_text("figure,mode,x,y\nfig1,IPP,1,1\n")
    done = stickslip("reproduce", *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("stickslip: ")
    assert all(word in done.stderr for word in words)
    assert [each.name for each in tmp_path.iterdir()] == ["bad.csv"]


def test_an_impossible_output_folder_is_reported_before_the_work(tmp_path):
    (tmp_path / "file").write_text("")
    done = stickslip("reproduce", "--out", tmp_path / "file")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "not a folder" in done.stderr


def test_help_has_an_example():
    done = stickslip("reproduce", "--help")
    assert done.returncode == 0
    assert "Example:" in done.stdout
    assert "reproduce" in stickslip("--help").stdout
