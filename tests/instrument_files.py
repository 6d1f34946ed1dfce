"""Files as instruments and trackers write them, for examples/read_instruments.py.

Each writer follows the public description that is named there. The numbers are seeded.
"""

import functools
import itertools

import numpy as np

from stickslip import COIL_NAMES, Coils, Drive, Record, Scenario, Waveform, simulate

STEP = 1e-4  # s, between the samples of an oscilloscope
CURRENT = 2.0  # A, in the coil of a field export
LEVEL = 0.02  # V, that one bit of the oscilloscope is worth
HALF = np.array([8e-3, 3e-3, 3e-3])  # m, of the box of a field
PIXEL = 2e-6  # m
FRAMES = {"trackmate": 400.0, "deeplabcut": 1000.0}  # Hz
DRIVE = Drive(mode="IPP", frequency=30.0, base=0.5e-3, pulses=12)
FIRST = -3e-3  # s, of an oscilloscope's first sample: its zero is the trigger
TRIALS = [("IPP", 20.0, 1, 0.9912), ("IPP", 20.0, 2, 1.0214), ("OPP", 45.5, 1, -1.2345)]


@functools.cache
def voltages():
    """Samples (n, 2) of the voltages of the xp and the clamp coil as they are read, V."""
    program = Waveform.ipp(base=0.5e-3, pulses=4)
    t, volts = program.points()
    sampled = np.arange(0.0, t[-1], STEP)
    read = np.column_stack([np.interp(sampled, t, volts[:, k]) for k in (0, 4)])
    noise = 0.01 * np.random.default_rng(0).standard_normal(read.shape)
    return LEVEL * np.round((read + noise) / LEVEL)


def write_tektronix(folder):
    samples = voltages()
    head = (
        "Model,MSO46", "Firmware Version,1.28.2", "", "Waveform Type,ANALOG,ANALOG",
        "Point Format,Y,Y", "Horizontal Units,s,s", f"Sample Interval,{STEP},{STEP}",
        f"Record Length,{len(samples)},{len(samples)}", "Vertical Units,V,V", "Label,,", "",
        "TIME,CH1,CH2",
    )  # fmt: skip
    rows = (f"{FIRST + STEP * k:.9e},{a},{b}" for k, (a, b) in enumerate(samples))
    _write(folder / "tektronix.csv", (*head, *rows), "\r\n")


def write_rigol(folder):
    samples = voltages()
    head = ("X,CH1,CH2,Start,Increment,", f"Sequence,Volt,Volt,{FIRST:.6e},{STEP:.6e}")
    rows = (f"{k},{a:.2e},{b:.2e}," for k, (a, b) in enumerate(samples))
    # Three digits of a voltage, as the instrument has no more.
    _write(folder / "rigol.csv", (*head, *rows), "\r\n")


def write_picoscope(folder):
    samples = voltages()
    head = ("Time,Channel A,Channel B", "(ms),(V),(mV)", "")
    rows = (
        f"{1e3 * (FIRST + STEP * k):.8f},{a:.8f},{1e3 * b:.8f}" for k, (a, b) in enumerate(samples)
    )
    _write(folder / "picoscope.csv", (*head, *rows), "\r\n")


def write_spreadsheet(folder):
    rows = [("Modus", "Frequenz (Hz)", "Versuch", "Geschwindigkeit (mm/s)")]
    rows += [(mode, f"{f:g}", trial, f"{v:.4f}") for mode, f, trial, v in TRIALS]
    lines = (";".join(map(str, row)).replace(".", ",") for row in rows)
    _write(folder / "trials.csv", lines, "\r\n")


@functools.cache
def fields():
    """Places of a grid, m, and the field of each coil with `CURRENT` there, T."""
    axes = [np.linspace(-half, half, count) for half, count in zip(HALF, (9, 5, 5), strict=True)]
    places = np.array(list(itertools.product(*axes)))
    coils = Coils()
    return places, {
        name: np.array([coils.field(place, current) for place in places])
        for name, current in zip(COIL_NAMES, CURRENT * np.eye(5), strict=True)
    }


def write_comsol(folder):
    places, found = fields()
    head = (
        ("Model", "coils.mph"), ("Version", "COMSOL 6.1.0.252"), ("Date", "Mar 3 2026, 10:21"),
        ("Dimension", 3), ("Nodes", len(places)), ("Expressions", 3),
        ("Description", "Magnetic flux density, x-component, Magnetic flux density, y-component"),
        ("Length unit", "mm"),
    )  # fmt: skip
    columns = ("x", "y", "z", "mf.Bx (T)", "mf.By (T)", "mf.Bz (T)")
    for name, field in found.items():
        lines = [f"% {key + ':':<20}{value}" for key, value in head]
        lines.append("% " + "".join(f"{each:<25}" for each in columns))
        for row in np.column_stack([1e3 * places, field]):
            lines.append("".join(f"{value:<25.16g}" for value in row))
        _write(folder / f"comsol_{name}.txt", lines)


def write_maxwell(folder):
    places, found = fields()
    for name, field in found.items():
        grid = "Min: [-8mm -3mm -3mm] Max: [8mm 3mm 3mm] Grid Size: [2mm 1.5mm 1.5mm] "
        lines = [f"Grid Output {grid}", 'X, Y, Z, Vector data "<Bx,By,Bz>"']
        for row in np.column_stack([places, field]):
            lines.append(" ".join(f"{value:.16e}" for value in row))
        _write(folder / f"maxwell_{name}.fld", lines)


@functools.cache
def run():
    return simulate(Scenario(drive=DRIVE, record=Record(rate=20e3)))


def frames(tracker):
    """Times, s, and what a camera that begins with the drive sees of x, m, and theta, rad."""
    t = np.arange(0.0, run().t[-1], 1.0 / FRAMES[tracker])
    return t, np.interp(t, run().t, run().x), np.interp(t, run().t, run().theta)


def write_trackmate(folder):
    """One robot, a speck of dust that was tracked for a while, and a spot in no track."""
    columns = ("LABEL", "ID", "TRACK_ID", "QUALITY", "POSITION_X", "POSITION_Y", "POSITION_Z")
    columns += ("POSITION_T", "FRAME", "RADIUS", "VISIBILITY")
    names = ("Label", "Spot ID", "Track ID", "Quality", "X", "Y", "Z", "T", "Frame", "Radius")
    units = ("", "", "", "(quality)", *3 * ("(micron)",), "(sec)", "", "(micron)", "")
    head = (columns, (*names, "Visibility"), (*names[:-1], "R", "Visibility"), units)
    t, x, _ = frames("trackmate")
    noise = np.random.default_rng(1).standard_normal(len(t))  # um
    spots = [(k, 1, 1e6 * x[k] + noise[k], 210.5) for k in range(len(t))]
    spots += [(k, 0, 800.0, 95.25) for k in range(20)] + [(7, "", 12.5, 40.0)]
    rows = [
        (f"ID{n}", n, track, 21.5, f"{x:.4f}", y, 0.0, f"{t[k]:.4f}", k, 60.0, 1)
        for n, (k, track, x, y) in enumerate(sorted(spots, key=lambda spot: spot[0]))
    ]
    _write(folder / "spots.csv", (",".join(map(str, row)) for row in (*head, *rows)))


def write_deeplabcut(folder):
    """Two marks on the robot's side at the same distance from its centre; some frames failed."""
    t, x, theta = frames("deeplabcut")
    random = np.random.default_rng(2)
    along = 50.0 * np.column_stack([np.cos(theta), np.sin(theta)])  # pixels; y of a picture is down
    centre = np.column_stack([100.0 + x / PIXEL, np.full(len(t), 240.0)])
    likelihood = np.where(np.arange(len(t)) % 50 == 49, 0.12, 0.998)
    columns = []
    for place in (centre + along, centre - along):  # front and rear
        seen = place + 0.2 * random.standard_normal(place.shape)
        seen[likelihood < 0.5] += 300.0
        columns += [seen, likelihood[:, None]]
    head = [
        ("scorer", *6 * ("DLC_resnet50_robotMar3shuffle1_200000",)),
        ("bodyparts", *3 * ("front",), *3 * ("rear",)),
        ("coords", *2 * ("x", "y", "likelihood")),
    ]
    rows = ((k, *(f"{v:.6f}" for v in row)) for k, row in enumerate(np.hstack(columns)))
    _write(folder / "filmDLC.csv", (",".join(map(str, row)) for row in (*head, *rows)))


def write_all(folder):
    for write in (write_tektronix, write_rigol, write_picoscope, write_spreadsheet, write_comsol,
                  write_maxwell, write_trackmate, write_deeplabcut):  # fmt: skip
        write(folder)


def _write(path, lines, end="\n"):
    path.write_bytes("".join(line + end for line in lines).encode())
