"""Refusals of the command: its arguments, with other files than usual where these are bad."""

from command_line import check, stickslip
from stickslip.cli.commands import COMMANDS, loaded

HEAD = "stickslip = 1\n[drive]\n"
CSV = "t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n1,1,0,0,0,0\n"
PROGRAM = {"s.toml": HEAD + 'mode = "program"\nfile = "v.csv"\n'}
PRIOR = {"u.toml": '[uncertain]\n"contact.adhesion" = { mean = 0.22e-6, sd = 0.01e-6 }\n'}
PRIOR_OF_A_TILT = {"u.toml": '[uncertain]\n"surface_tilt.angle" = { mean = 0.01, sd = 0.002 }\n'}
MEASURED = {
    "m.toml": 'stickslip_measurement = 1\nscenario = "s.toml"\n'
    '[[velocity]]\nfile = "velocity.csv"\n',
    "velocity.csv": "velocity\n1e-3\n",
}
LOG = ["t (s),speed (rad/s),torque (N m)", *(f"0.{k},0.0{k},1.0" for k in range(10))]
MODELS = "from stickslip import models\nsteel = models.joint(inertia=1)\nnone = print\n"
JOINT = "--model joint --set inertia=1"
SWEEP = "sweep s.toml --vary drive.peak=0"
HOPS = (
    "--set drive.mode=OPP --set drive.frequency=400 --set robot.length=0.4e-3 "
    "--set robot.width=0.25e-3 --set robot.height=0.15e-3"
)


def lay_out(folder, files):
    """Write files, a scenario with an empty drive and voltages; return what is there."""
    for name, text in {"s.toml": HEAD, "v.csv": CSV, **files}.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    return contents(folder)


def contents(folder):
    """The files of a folder."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def by_command(folder, bad):
    """A command in a folder with a scenario: exit status 2, one line, and nothing written."""
    arguments, files = (bad, {}) if isinstance(bad, str) else bad
    before = lay_out(folder, files)
    done = stickslip(*arguments.split(), cwd=folder)
    reason, end, table = done.stderr.partition("\n")
    if table.startswith("log.csv: "):  # how the columns of a log are understood
        done.stderr = reason + end
    check(done)
    assert contents(folder) == before
    return done.stderr


def by_log(folder, bad):
    """Lines of a log by their numbers, or the options of a sound one."""
    lines, options = dict(enumerate(LOG, 1)), JOINT
    if isinstance(bad, str):
        options = bad
    else:
        lines |= bad
    files = {"log.csv": "\n".join(lines.values()), "m.py": MODELS, "wrong.py": "a = 1\nb = 1 / 0\n"}
    return by_command(folder, (f"diagnose log.csv {options} --out found", files))


def after(command):
    """A way to end a command."""
    return lambda folder, bad: by_command(folder, f"{command} {bad}")


WAYS = {
    "command": by_command, "log": by_log,
    "--set": after("run s.toml --out a.nc --set"),
    "--vary": after("sweep s.toml --out a.nc --vary"),
    "optimise": after("optimise s.toml --maximise mean_velocity --evaluations 20 "
                      "--set drive.pulses=6 --set drive.ramp=0.02 --set drive.base=0.5e-3"),
}  # fmt: skip

REFUSALS = [
    ("command", ("run s.toml", {"s.toml": HEAD + "freqency = 3\n"}),
     ["s.toml: drive.freqency = 3", 'mean "drive.frequency"?']),
    ("command", ("run s.toml", {**PROGRAM, "v.csv": CSV + "2,0,0\n"}),
     ["s.toml", '"v.csv": row 4']),
    ("command", "run no.toml", ["no.toml", "No such file"]),
    ("--set", "drive.frequency", ["drive.frequency", "key=value"]),
    ("--set", "mode=IPP", 'did you mean "drive.mode"?'),
    ("--set", "drive.peak=high", ['drive.peak = "high"', "a number"]),
    ("--set", "drive.peak=2.5mT", "2.5 mT is 2.5e-3"),
    ("command", "sweep s.toml", "--vary"),
    ("command", "coils s.toml --volts 0", "volts = 0.0: allowed is a finite number of V above 0"),
    ("command", "coils s.toml --plot s.toml", "--plot"),
    ("--vary", "drive.frequency", ["drive.frequency", "key=start:stop:count"]),
    *(
        ("--vary", f"drive.frequency={text}", "start:stop:count")
        for text in ("", "5:5:3", "5:6:1", "5:200:1.5", "5:200:-3", "5:200", "a:b:3", "1:inf:3",
                     "5:200:1" + "0" * 5000)
    ),
    ("--vary", "drive.frequency=1,,2", 'drive.frequency = ""'),
    ("--vary", "drive.peak=1e-3 --vary drive.peak=2e-3", ["--vary", "there twice"]),
    ("--vary", "drive.frequency=1,2,1.0", "twice"),
    ("--vary", "drive.frequency=5:200:100000000", "10000000"),
    ("--vary", "drive.frequency=0:200:3:log", "start:stop:count:log with numbers above 0"),
    ("command", SWEEP + " --out a.csv --resume", ["--resume", "netCDF"]),
    ("command", "predict s.toml --figures mean_velocty", ["--figures", 'mean "mean_velocity"?']),
    ("--vary", "drive.frequency=1:1e999999999999:3", "drive.frequency"),
    ("--vary", "drive.frequency=5:6:9999 --vary drive.hold=0:1:9999", "99980001 points"),
    ("--vary", "drive.mode=IPP --set drive.mode=OPP", ["drive.mode", "--set", "--vary"]),
    ("--vary", "surface_tilt.angle=0,1 --set effects.surface_tilt.angle=1", ["--set", "--vary"]),
    ("command", "rnu", ["rnu", "'run'"]),
    ("command", "run s.toml --sett drive.peak=0", ["--sett", "'--set'"]),
    ("command", "run", "SCENARIO"),
    ("command", "run s.toml other.toml", "other.toml"),
    ("command", "keys wxyz", ["wxyz", '"drive"', '"effects"']),
    ("command", "keys oil", ["oil: no key", "drive.coils"]),
    ("command", "keys frequncy", 'did you mean "drive.frequency"?'),
    ("command", "effects surface_tlt", 'did you mean "surface_tilt"?'),
    ("command", "run s.toml --plot a.png --start 9", ["--start", "9.0", "1.05 s"]),
    ("command", "run s.toml --plot a.png --set drive.ramp=0.123456789 --start 1.12346",
     ["1.12346", "the run's 1.12345 s"]),
    ("command", "run s.toml --plot a.png --start 0.1 --stop 0.1", ["--start", "--stop"]),
    ("command", "run s.toml --start 0.1", ["--start", "--plot"]),
    ("command", "run s.toml --slowdown 10", ["--slowdown", "--animate"]),
    ("command", "run s.toml --animate a.gif --slowdown 0", "--slowdown"),
    ("command", "run s.toml --until x>>1", "x>>1"),
    ("command", "run s.toml --out missing/a.nc", ["missing/a.nc", "no folder"]),
    ("command", "run s.toml --out .", "is a folder"),
    ("command", "run s.toml --out /dev/null", "not an ordinary file"),
    ("command", ("diagnose spots.csv", {"spots.csv": "FRAME,POSITION_X\n1,2\n"}),
     ["spots.csv: is a table of data", "FRAME, POSITION_X", "t, x, theta", "velocity_of_track"]),
    ("command", ("diagnose m.toml --write", MEASURED), ["--write", "table of data"]),
    ("command", "run s.toml --out a.txt", ["--out", ".nc, .nc4, .h5, .csv"]),
    ("command", "run s.toml --plot a.docx", ["--plot", "a.docx", ".png"]),
    ("command", "run s.toml --plot a.png --set record.rate=events", ["--plot", "uniform grid"]),
    ("command", "run s.toml --animate a.gif --set record.fields=x", ["--animate", "theta, omega"]),
    ("command", "run s.toml --animate a.png", ["--animate", ".gif, .webp"]),
    ("command", "run s.toml --out s.toml", ["--out", "s.toml is read"]),
    ("command", "run s.toml --plot ./s.toml", "--plot"),
    ("command", ("run s.toml --out v.csv", PROGRAM), "v.csv is read"),
    ("command", "run s.toml --set drive.file=v.csv --out v.csv", "v.csv is read"),
    ("command", "run s.toml --plot a.png --animate a.png", "--animate"),
    ("command", f"{SWEEP} --out a.nc --plot a.nc", "a.nc"),
    ("command", f"run s.toml --out {'a' * 500}.nc", "File name too long"),
    ("command", "run s.toml --out /proc/a.nc", "/proc/a.nc"),
    ("command", "init s.toml", "s.toml already exists"),
    ("command", "init --model joint j.csv", "FILE: j.csv: allowed are names that end in .py"),
    ("command", f"{SWEEP} --threads 0", ["--threads", "0"]),
    ("command", f"{SWEEP} --dask nonsense", "--dask nonsense"),
    ("command", f"{SWEEP} --resume", ["--resume", "--out"]),
    ("command", (f"{SWEEP} --out a.nc", {"a.nc": "other"}), "--resume"),
    ("command", "predict s.toml", "--uncertain FILE"),
    ("command", ("predict s.toml --uncertain u.toml --set contact.adhesion=1e-7", PRIOR),
     "--set contact.adhesion: has no influence"),
    ("command", ("predict s.toml --uncertain u.toml --set surface_tilt.angle=0.02",
                 PRIOR_OF_A_TILT), "--set effects.surface_tilt.angle: has no influence"),
    ("command", ("predict s.toml --uncertain u.toml --vary contact.adhesion=1e-7,2e-7", PRIOR),
     "either varied or uncertain"),
    ("command", "predict s.toml --draws 1", "--draws"),
    ("command", "optimise s.toml --free drive.hold=1e-3:2e-3", "--maximise or --minimise"),
    ("command", "optimise s.toml --maximise mean_velocity --out no/best", "there is no folder no"),
    ("command", "optimise s.toml --maximise mean_velocty", 'did you mean "mean_velocity"?'),
    ("optimise", "--free drive.frequency", "key=low:high"),
    ("optimise", "--free drive.frequency=5:10:300", "drive.frequency"),
    ("optimise", "--free drive.frequency=50,100", "drive.frequency"),
    ("optimise", "--free drive.hold=5:300 --free drive.hold=5:30", "there twice"),
    ("optimise", "--free drive.frequency=5Hz:300Hz", "without its unit"),
    ("optimise", "--free drive.frequency=low:high", "drive.frequency"),
    ("optimise", "--limit voltage_max", "figure=value"),
    ("optimise", "--at-least pull_ratio=2 --limit pull_ratio=1", "at least pull_ratio = 2.0"),
    ("optimise", "--limit voltage_max=high", ["--limit", "a number"]),
    ("optimise", "--limit voltage_max=26V", "without its unit"),
    ("optimise", "--limit voltage_max=26 --limit voltage_max=20", "there twice"),
    ("optimise", "--limit voltage_max=-1 --free drive.hold=1e-3:2e-3", "a number from 0"),
    *(("optimise", f"--limit {each}=-0.1 --free drive.hold=1e-3:2e-3", f"limit on {each}")
      for each in ("airborne_fraction", "pull_ratio", "tilt_max", "turning_speed")),
    ("optimise", "--limit power_mean=0 --free drive.hold=1e-3:2e-3", ["the nearest has", "of 0"]),
    ("optimise", f"{HOPS} --free drive.peak=2.4e-3:2.5e-3", "--allow-flight"),
    ("optimise", "--knots 201 --limit voltage_max=26", "from 2 to 200"),
    ("optimise", "--knots 8 --limit voltage_max=26 --coils xp,up", "up"),
    ("optimise", "--free drive.hold=1e-3:2e-3 --uncertain none.toml", "none.toml"),
    ("command", ("optimise best/s.toml --maximise slip_up",
                 {"best/s.toml": "stickslip = 1\n[drive]\n"}), "is read"),
    ("command", ("diagnose m.toml --out /proc", MEASURED), ["cannot write", "/proc"]),
    ("command", ("diagnose m.toml", {"m.toml": MEASURED["m.toml"]}), "velocity.csv"),
    ("command", f"{SWEEP} --plot a.png", "--plot: allowed with one --vary of numbers"),
    ("--vary", "drive.mode=IPP,OPP --plot a.png", "--plot: allowed with one --vary of numbers"),
    ("command", (f"{SWEEP} --out a.nc --resume", {"a.nc": "other"}), "cannot be resumed"),
    ("command", f"{SWEEP} --out ./s.toml --resume", "s.toml is read"),
    ("command", f"{SWEEP} --threads 2 --dask tcp://127.0.0.1:1", ["--threads", "--dask"]),
    ("command", ("predict m.toml", MEASURED), "m.toml: is a measurement and no scenario"),
    ("command", "predict s.toml --uncertain s.toml", "there is no section [uncertain]"),
    ("log", {5: "0.3,0.03,"}, ['log.csv: line 5, column torque = "": allowed', "two files"]),
    ("log", {5: "0.3,0.03"}, "line 5 has 2 cells, and the header has 3: allowed is the same, or"),
    ("log", {5: "noon,0.03,1.0"}, 'line 5, column t = "noon": allowed is a finite number'),
    ("log", {5: "0.15,0.03,1.0"}, ["line 5, column t = 0.15 s: allowed is a time after 0.2",
                                   "sort"]),
    ("log", {5: "0.2,0.03,1.0"}, ["t = 0.2 s: allowed is a time after 0.2 s", "digits"]),
    ("log", {11: "3.1,0.03,1.0"}, ["line 11, column t = 3.1 s", "jumps by 2.3 s", "two files"]),
    ("log", {1: "t,speed (mph),torque"}, ['"speed (mph)": "mph" is no unit', "are rad/s"]),
    ("log", {1: "t,v,torque"}, ['column "speed" is missing', '"v"', 'call one "speed (rad/s)"']),
    ("log", {1: "t,a (rad/s),b (rad/s)"}, ['column "speed" is missing', "a (rad/s)"]),
    ("log", {1: "t,speed,a (N m),b (N m)"}, ['"torque" is missing', 'call one "torque (N m)"']),
    ("log", {1: "t (s),speed (rad/s),current (mA)"}, "(--set torque_constant=VALUE,ERROR)"),
    ("log", {1: "t (s),position [deg],torque (N m)"}, "(--set reads=angle)"),
    ("log", dict.fromkeys(range(1, 12), ""), "log.csv: is empty"),
    ("log", "--model jont", ["--model jont: allowed is joint", 'did you mean "joint"?']),
    ("log", "--model joint", ["joint: inertia is missing", "kg m^2", "--set",
                              "init --model joint"]),
    ("log", f"{JOINT} --set coulomb=strong", 'joint: coulomb = "strong": allowed is a number'),
    ("log", f"{JOINT} --set viscous=0,02", ["viscous=0,02", "write 0.02 with a decimal point, or"]),
    ("log", f"{JOINT} --set viscous=3:1", "low = 3.0, high = 1.0: allowed is 0 < low < high"),
    ("log", f"{JOINT} --set viscous=1:b", "allowed is a number, in SI units"),
    ("log", f"{JOINT} --set inertai=1", ["no inertai", 'did you mean "inertia"?']),
    ("log", f"{JOINT} --set reads=position", ['reads = "position"', "speed or angle"]),
    ("log", "--model thermal --set reads=temp", "thermal: there is no reads; known are capacity"),
    ("log", f"{JOINT} --threads 1", "--threads: allowed without --model only"),
    ("log", "--against log.csv --against log.csv", "log.csv: allowed with --model only"),
    ("log", "--set inertia=1", "--set: allowed with --model only"),
    ("log", "--units si", "--units: allowed with --model only"),
    ("log", "log.csv", "log.csv: allowed with --model only"),
    ("log", "", "a log of another system needs --model"),
    ("log", "--model no.py:steel", "--model: no.py: there is no such file"),
    ("log", "--model m.py:none", "m.py: there is no model none; allowed is steel"),
    ("log", "--model m.py:steel --set inertia=1", "--set: m.py says what is known"),
    ("log", "--model wrong.py:b", "wrong.py: line 2: ZeroDivisionError"),
    ("command", "init --model jiont", ["--model", "jiont", "joint"]),
    *(
        ("command", f"{name} {option.opts[0]} 1 {option.opts[-1]} 1", "is there twice")
        for name in COMMANDS
        for option in loaded(name).params
        if option.opts[0].startswith("-") and not (option.is_flag or option.multiple)
    ),
]  # fmt: skip
