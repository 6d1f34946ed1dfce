#!/usr/bin/env bash
# Expected: a decoded state that compares equal to "on" is found by "on", in a data frame as elsewhere.
# What happens: `table[table.state == "on"]` has two rows, `table.query("state == 'on'")` and `isin(["on"])` have none,
#   and `str.upper()` is NaN: the value is an object of its own, equal to its text, without a hash, not equal to its
#   number 1. `groupby`, `unique` and `merge` raise; a value without a name stays the number 2 in the same column.
# Packages: cantools 45.1.0, pandas 3.1.1.
# Who is hurt: whoever selects the phases of a drive (on, off, fault) in a CAN log: the selection is empty, without a
#   word.
# Instead: `decode_choices=False`, or `.map(str)` on the column (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 cantools==45.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import cantools
import pandas as pd

description = """VERSION ""
NS_ :
BS_:
BU_: Drive
BO_ 100 Status: 8 Drive
 SG_ state : 16|2@1+ (1,0) [0|3] "" Drive
VAL_ 100 state 0 "off" 1 "on" ;
"""
message = cantools.database.load_string(description, "dbc").get_message_by_name("Status")
frames = [bytes([0, 0, state, 0, 0, 0, 0, 0]) for state in (0, 1, 1, 2)]
table = pd.DataFrame([message.decode(frame) for frame in frames])
assert (table["state"] == "on").tolist() == [False, True, True, False]
assert len(table.query("state == 'on'")) == 0
assert not table["state"].isin(["on"]).any()
assert not (table["state"] == 1).any()
assert table["state"].str.upper().isna().all()
assert table["state"][1] in ["on"] and table["state"][3] == 2
for refused in (lambda: table.groupby("state").size(), lambda: table["state"].unique()):
    try:
        refused()
    except TypeError:
        pass
    else:
        raise SystemExit("the states have a hash now")
# instead
assert table["state"].map(str).isin(["on"]).sum() == 2
plain = pd.DataFrame([message.decode(frame, decode_choices=False) for frame in frames])
assert len(plain.query("state == 1")) == 2
print("cantools", cantools.__version__, "pandas", pd.__version__)
print("rows by == :", int((table["state"] == "on").sum()), "by query:", len(table.query("state == 'on'")), "by isin:", int(table["state"].isin(["on"]).sum()))
PROGRAM
