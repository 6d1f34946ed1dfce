"""Tables with SI units of what oscilloscopes, spreadsheets, field solvers and trackers write.

Take the part that you need, and put in your names of files and channels, your frame rate and size
of a pixel. Each part follows the document named above it.
"""

import numpy as np
import pandas as pd

from stickslip import COIL_NAMES, Drive, velocity_of_track


def save_voltages(scope, name):
    """Voltages of the +x coil and the clamp coil as the file of `drive.file`."""
    table = scope.assign(t=scope["t"] - scope["t"].iloc[0], xm=0.0, yp=0.0, ym=0.0)
    table.to_csv(name, index=False)


# Tektronix (4/5/6 Series MSO Programmer Manual, SAVe:WAVEform, format .csv): lines of a key and its
# values, then TIME,CH1,CH2 and the samples in s and V.
with open("tektronix.csv") as file:
    head = [line.startswith("TIME,") for line in file].index(True)
scope = pd.read_csv("tektronix.csv", skiprows=head).iloc[:, :3]
save_voltages(scope.set_axis(["t", "xp", "clamp"], axis=1), "tektronix_voltages.csv")

# Rigol (DS1000Z User's Guide, Store and Recall, CSV): numbered samples, with their Increment in s
# in the second line.
step = float(pd.read_csv("rigol.csv", nrows=1)["Increment"].iloc[0])
scope = pd.read_csv("rigol.csv", skiprows=2, header=None).iloc[:, :3]
scope = scope.set_axis(["t", "xp", "clamp"], axis=1)
scope["t"] *= step
save_voltages(scope, "rigol_voltages.csv")

# PicoScope (PicoScope 6 User's Guide, Text formats): a line of names and one of units, which depend
# on the range.
scope = pd.read_csv("picoscope.csv", header=[0, 1], skipinitialspace=True)
unit = {"(s)": 1, "(ms)": 1e-3, "(us)": 1e-6, "(µs)": 1e-6, "(V)": 1, "(mV)": 1e-3}
scope = scope * [unit[each] for each in scope.columns.get_level_values(1)]
save_voltages(scope.set_axis(["t", "xp", "clamp"], axis=1), "picoscope_voltages.csv")

# A spreadsheet with decimal commas writes semicolons between the cells (Microsoft Support, Import
# or export text (.txt or .csv) files). The velocity is in mm/s here.
table = pd.read_csv("trials.csv", sep=";", decimal=",")
table.columns = ["mode", "frequency", "trial", "velocity"]
table["velocity"] *= 1e-3
table.to_csv("velocity.csv", index=False)

# COMSOL (Spreadsheet Data Format): "%" before each line of the head, places in the length unit of
# the model. Compute with one coil on, here with 2 A, a file for each coil.
columns = ["x", "y", "z", "Bx", "By", "Bz"]
read = {"sep": r"\s+", "names": columns}
coils = {k: pd.read_csv(f"comsol_{k}.txt", comment="%", **read) for k in COIL_NAMES}
table = pd.concat(coils, names=["coil"]).reset_index("coil")
table[columns] *= [1e-3, 1e-3, 1e-3, 1 / 2, 1 / 2, 1 / 2]  # "% Length unit: mm"; 2 A
table.to_csv("comsol_map.csv", index=False)

# Ansys Maxwell (Exporting Field Quantities, .fld): two lines before the numbers, and places in
# metres, whatever the unit in the first line.
coils = {k: pd.read_csv(f"maxwell_{k}.fld", skiprows=2, **read) for k in COIL_NAMES}
table = pd.concat(coils, names=["coil"]).reset_index("coil")
table[["Bx", "By", "Bz"]] /= 2  # A
table.to_csv("maxwell_map.csv", index=False)

# TrackMate (Export spots to CSV): three more lines of headings, the last with units. Spots without
# a TRACK_ID are in no track; the robot's track is the longest. Frame 0 is the start of the drive.
drive = Drive(frequency=30, base=0.5e-3, pulses=12)
spots = pd.read_csv("spots.csv", skiprows=[1, 2, 3])
robot = spots[spots["TRACK_ID"] == spots["TRACK_ID"].mode()[0]]
row = velocity_of_track(robot["FRAME"] / 400, 1e-6 * robot["POSITION_X"], drive)
pd.DataFrame([row]).to_csv("tracked_velocity.csv", index=False)

# DeepLabCut (analyze_videos with save_as_csv): three lines of headings: scorer, body parts and
# coordinates. Two marks at the same distance from the centre give place and tilt. With +x to the
# right in the picture, and y downwards, theta is positive nose-down.
points = pd.read_csv("filmDLC.csv", header=[0, 1, 2], index_col=0).droplevel(0, axis=1)
front, rear = points["front"], points["rear"]
theta = np.arctan2(front["y"] - rear["y"], front["x"] - rear["x"])
x = 2e-6 * (front["x"] + rear["x"]) / 2  # m a pixel
film = pd.DataFrame({"t": points.index / 1000, "x": x, "theta": theta})  # frames/s
sure = np.minimum(front["likelihood"], rear["likelihood"]) > 0.9
film[sure].to_csv("film.csv", index=False)
