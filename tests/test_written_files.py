"""Files that are written: whole or not at all, under a name that a system allows."""

import numpy as np
import pandas as pd
import pytest

from command_line import files_up_to, stickslip
from measured_maps import formula_map
from pictures import recorded, walking
from stickslip import Accelerations, Waveform, diagnose_model, plot
from stickslip.cli.output import write_frame
from stickslip.scenario.toml_file import write_scenario
from toys import LEVEL, SLOPE, WAVE, data, line

SHAKE = Accelerations([[0.0, 1.0, 0.0], [0.01, -1.0, 0.0], [0.02, 1.0, 0.0]])
PLAYED = walking().replace({"shake.accelerations": SHAKE})
DOORS = {
    "v.csv": Waveform.hold(0.02, {"xp": 5.0}).write,
    "a.csv": SHAKE.write,
    "map.json": lambda path: formula_map().write(path),
    "s.toml": lambda path: write_scenario(PLAYED, path),
    "run.nc": lambda path: recorded("walk").save(path),
    "run.csv": lambda path: recorded("walk").save(path),
    "table.csv": lambda path: write_frame(pd.DataFrame({"a": [1.0, 2.0]}), path),
    "walk.png": lambda path: plot.save(plot.trajectory(recorded("walk")), path),
    "walk.gif": lambda path: plot.animation(recorded("walk"), 0.1, 0.11, slowdown=10).save(path),
    "fit-a.svg": lambda path: fitted("a").save_figures(path.parent),
    "report.html": lambda path: fitted("a").save_report(path.parent),
}


def fitted(*names):
    waves = 0.5 * np.sin(5.0 * np.linspace(1.0, 3.0, 30))
    tables = [data(waves, seed=k).having(name=name) for k, name in enumerate(names)]
    return diagnose_model(line, tables, [SLOPE, LEVEL], [WAVE])


@pytest.mark.parametrize("name", DOORS)
def test_a_full_disk_leaves_the_old_file_and_no_part(name, tmp_path):
    path = tmp_path / name
    DOORS[name](path)
    for each in tmp_path.iterdir():
        each.write_bytes(b"old")
    old = {each.name: b"old" for each in tmp_path.iterdir()}
    assert name in old
    with files_up_to(5), pytest.raises(OSError, match="cannot write ") as error:
        DOORS[name](path)
    assert str(error.value).endswith("File too large")
    assert any(str(tmp_path / each) in str(error.value) for each in old)
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == old


def test_figures_of_tables_of_any_names_are_files_of_their_own(tmp_path):
    names = ["a/b", "a b", "A:B", "../c", "d" * 300, "\N{SNOWMAN}\n", "plain"]
    written = fitted(*names).save_figures(tmp_path / "figures", ["svg"])
    assert len({each.name.casefold() for each in written}) == len(written) == 2 * len(names)
    assert sorted(written) == sorted((tmp_path / "figures").iterdir())
    assert [each.name for each in tmp_path.iterdir()] == ["figures"]
    assert tmp_path / "figures" / "fit-plain.svg" in written


@pytest.mark.parametrize("name", [r"a\User.py", r'"""\x.py', "a\nb.py", "a b's.py"])
def test_the_file_of_a_model_is_python_whatever_it_is_called(name, tmp_path):
    assert stickslip("init", "--model", "joint", name, cwd=tmp_path).returncode == 0
    values = {}
    exec(compile((tmp_path / name).read_text(), "made", "exec"), values)
    assert values["model"].kind.name == "joint"
