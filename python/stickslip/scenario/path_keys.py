"""The keys that hold neither a number nor a word: voltages, a map, or the files of them."""

PROGRAM = "drive.program"
"""The waveform of a drive: in Python only, as a file has `FILE`."""

FILE = "drive.file"
"""The CSV file of voltages, which only a scenario's file and --set know."""

COIL_MAP = "coil.map"
"""The measured field of the coils: a `FieldMap`; in a scenario's file and with --set, its path."""

OBJECTS = (PROGRAM, COIL_MAP)
"""Keys whose value in Python is an object."""

PROGRAM_HINT = f'{FILE} names the CSV file of voltages, with drive.mode = "program"'

MAP_HINT = f"in Python, {COIL_MAP} takes a FieldMap, such as FieldMap.from_file(path)"

PATHS = {
    FILE: f"in Python, {PROGRAM} takes a Waveform, such as Waveform.from_csv(path)",
    COIL_MAP: MAP_HINT,
}
"""Keys that hold a path in a scenario's file and with --set, with what Python has instead."""
