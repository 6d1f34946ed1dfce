"""Sentences on data: what of the tables is not used, their noise, and what makes them suspect."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from stickslip.facts.codes import Code
from stickslip.scenario.keys import shown

Fields = Mapping[str, Any]
Sentence = str | Callable[[Fields], str]

LINES = 5
"""So many lines of a file are named; of more only the number is said."""

IN_OTHER_UNIT = "divide velocities in mm/s or um/s by 1e3 or 1e6"
"""What to do with a velocity that is too large."""

_FASTEST = "the stated model's fastest"

_ORIGINS = {
    "repeats": "the scatter of repeated readings",
    "smoothness": "how smoothly the readings follow the field",
    "free-fit": "what a free gain of each coil and a free uniform field leave over",
}


def listed(names: list[str], most: int = 4) -> str:
    """Names in a row, the first of them if they are many."""
    more = len(names) - most
    shown = names if more <= 0 else [*names[:most], f"{more} more"]
    return " and ".join([", ".join(shown[:-1]), shown[-1]] if len(shown) > 1 else shown)


def at(f: Fields) -> str:
    """The table and its lines: ``a.csv line 3``; of a table in memory ``DataFrame row 3``."""
    more = ", ..." if f["count"] > LINES else ""
    word = f.get("word", "line") + ("" if f["count"] == 1 else "s")
    return f"{f['table']} {word} " + ", ".join(str(line) for line in f["lines"][:LINES]) + more


def _in_lines(template: str) -> Sentence:
    return lambda f: template.format(at=at(f), **f)


def counted(count: int, thing: str) -> str:
    """``1 frame``, ``3 frames``."""
    return f"{count} {thing}{'' if count == 1 else 's'}"


def _counting(thing: str, template: str) -> Sentence:
    return lambda f: template.format(counted=counted(f["count"], thing), **f)


def mismatch(f: Fields, whose: str = "what the stated model gives") -> str:
    """A size that is far from the usual one, for what `magnitude_mismatch` found."""
    low, high = f["allowed"]
    said = (
        f"about {f['ratio']:.3g} times {whose} ({f['measured']:.3g} against {f['usual']:.3g} "
        f"{f['unit']}; allowed is {low:g} to {high:g} times)"
    )
    return f"{said}, so a column may be in a unit that is wrong by 1000" if f["by_1000"] else said


def _outlier(f: Fields) -> str:
    said = (
        f"{f['table']}: a trial of {f['velocity']:.4g} m/s is far from the others of its "
        f"condition, which are near {f['others']:.4g} m/s"
    )
    factor = {1000.0: "1000", 0.001: "1/1000"}.get(f["unit_factor"])
    return (
        f"{said}." if factor is None else f"{said}; the factor of {factor} is that of a wrong unit."
    )


def _stands_still(f: Fields) -> str:
    return (
        f"Every reading is zero at {counted(f['count'], 'condition')} where the stated model moves "
        f"by up to {f['speed'] * 1e3:.3g} mm/s: "
        + "; ".join(f["conditions"])
        + (f" and {f['count'] - len(f['conditions'])} more." if f["count"] > len(f["conditions"])
           else ".")
    )  # fmt: skip


def _reading(value: float, unit: str) -> str:
    return f"{math.degrees(value):.2f} degrees" if unit == "rad" else f"{value:.2g} {unit}"


def _reading_noise(f: Fields) -> str:
    sd, taken = (_reading(f[name], f["unit"]) for name in ("sd", "taken"))
    return (
        f"{f['table']}: the noise of a reading is {sd}, from {_ORIGINS[f['origin']]} (about "
        f"{f['dof']:.0f} degrees of freedom); {taken} is used, as so few readings tell it."
    )


def _reading_noise_small(f: Fields) -> str:
    return (
        f"{f['table']}: the noise from {_ORIGINS[f['origin']]} (about {f['dof']:.0f} degrees of "
        f"freedom) is below the least error of a reading, {_reading(f['taken'], f['unit'])}, which "
        "is used."
    )


def _reading_noise_unknown(f: Fields) -> str:
    return (
        f"{f['table']}: {f['dof']:.2g} degrees of freedom cannot tell the noise, {f['needed']} are "
        f"needed; an error of {_reading(f['taken'], f['unit'])} per reading is used."
    )


def _few_conditions(f: Fields) -> str:
    are = "condition is" if f["count"] == 1 else "conditions are"
    return f"{f['count']} {are} too few to tell causes apart; at least {f['needed']} are needed."


def _three(values: list[float]) -> str:
    return "(" + ", ".join(f"{value:.3g}" for value in values) + ")"


_SEPARATED = "so the scatter between set-ups cannot be separated from a cause."
_COLUMN = "{table}: the column {column} is not used, as "

SENTENCES: Mapping[Code, Sentence] = {
    Code.ROWS_LEFT_OUT: "{table}: {count} of {rows} rows were left out.",
    Code.CELL_COUNT: _in_lines(
        "{at}: a row of {cells} cells is not used, as the header names {columns} columns."
    ),
    Code.NOT_A_NUMBER: lambda f: f"{at(f)}: {f['column']} {shown(f['cell'])} is not a number.",
    Code.REPEATED_ROW: _in_lines("{at}: the row repeats an earlier one."),
    Code.SETTING_REFUSED: _in_lines("{at}: {refusal}."),
    Code.SETTING_TOO_LARGE: _in_lines(
        "{at}: {key} of {value:.3g} {unit} is above {limit:g} {unit}; if it is in {other}, divide "
        "it by 1e3."
    ),
    Code.SETTING_TOO_SMALL: _in_lines(
        "{at}: {key} of {value:.3g} {unit} is below {limit:g} {unit}; if it is in {other}, "
        "multiply it by 1e3."
    ),
    Code.OUTLIER: _outlier,
    Code.TOO_FAST: _in_lines(f"{{at}}: the velocity is above {{limit:g}} m/s; {IN_OTHER_UNIT}."),
    Code.BAD_CELLS: lambda f: (
        f"{f['table']}: {f['count']} of {f['rows']} rows have a cell that is no number, too few "
        f"cells or too many ({at(f).removeprefix(f['table']).lstrip()})."
    ),
    Code.GAPS: _counting("cell", "{table}: the column {column} has {counted} without a number."),
    Code.NO_SOUND_ROW: "{table}: no row is sound. {why}",
    Code.FRAMES_SORTED: "{table}: the rows were not in the order of time; they were sorted.",
    Code.REPEATED_TIMES: (
        "{table}: of frames with the same time only the first is used; {count} left out."
    ),
    Code.FRAMES_AFTER_DRIVE: (
        "{table}: the last pulse ends at {end:g} s, and later frames are not used; {count} left "
        "out."
    ),
    Code.FRAMES_NOT_NEEDED: "{table}: the first {used} of {count} frames are enough.",
    Code.FRAME_RATE_NOT_USED: (
        "{table}: frame_rate = {stated:g} Hz is not used, as most frames are {spacing:g} s apart."
    ),
    Code.RUN_TOO_SHORT: _counting(
        "sound frame",
        "{table}: the run is left out, as it has {counted} from {start:g} s to {end:g} s, where "
        "the robot walks steadily; {needed} are needed (times are in s, from the start of the "
        "drive).",
    ),
    Code.RUN_ANGLE_UNIT: (
        "{table}: the run is left out, as theta is near {theta:.3g}, and allowed is up to "
        "{limit:.3g}; rad are wanted, and these may be degrees."
    ),
    Code.RUN_LENGTH_UNIT: (
        "{table}: the run is left out, as x spans {span:.3g}, and allowed is up to {limit:g}; m "
        "are wanted, and these may be um or mm."
    ),
    Code.RUN_STANDS_STILL: "{table}: the run is left out, as neither x nor theta ever changes.",
    Code.COLUMN_TOO_SHORT: _counting(
        "number", f"{_COLUMN}it has {{counted}}; {{needed}} are needed."
    ),
    Code.COLUMN_SIZE: lambda f: f"{_COLUMN.format(**f)}its {f['what']} is {mismatch(f)}.",
    Code.WILD_FRAMES: _counting(
        "frame",
        "{table}: {counted} lie far from all others of their phase in {column}, such as that at "
        "{time:.5g} s, and are not used.",
    ),
    Code.ANGLE_BEYOND_TURN: (
        "{table}: theta of {theta:.4g} rad is not used, as it is more than half a turn."
    ),
    Code.LONELY_ANGLE: (
        "{table}: theta of {theta:.4g} rad at Bx = {Bx:.4g} T, Bz = {Bz:.4g} T is not used, as it "
        "is far from both its neighbours, which agree."
    ),
    Code.PROBES_ON_WIRE: (
        "{table}: rows whose probe lies on the wire of a coil are not used; {count} left out."
    ),
    Code.FAR_FIELD: lambda f: (
        f"{f['table']}: a reading of {_three(f['field'])} T with currents "
        f"{_three(f['currents'])} A is far from what any gain of the coils gives."
    ),
    Code.CONDITION_NOT_COMPUTED: (
        "The condition {condition} is not used, as the stated model cannot compute it."
    ),
    Code.NOISE_STATED: (
        "Too few trials are repeated to measure the noise ({dof} degrees of freedom, where "
        "{needed} are needed); the stated relative error of {stated:.3g} is used."
    ),
    Code.NOISE_UNKNOWN: (
        "The noise is not known: repeats that differ have {dof} degrees of freedom, where {needed} "
        "are needed, and no error is stated."
    ),
    Code.SETUPS: (
        "Between the {count} set-ups the velocities differ by {shift:.2g} times the error of a "
        "trial as a shift, and by {gain:.2g} times as a factor."
    ),
    Code.NO_BLOCK_COLUMN: f"There is no column block, {_SEPARATED}",
    Code.ONE_BLOCK: f"There is only one set-up in the column block, {_SEPARATED}",
    Code.SETUPS_NOT_CROSSED: (
        "No condition was repeated in another set-up, so the scatter between set-ups is not known."
    ),
    Code.UNEVEN_SETUP: (
        "The trials of set-up {setup}, in the order of the table, lie {ratio:.2g} times as far "
        "from the rest as the others do (p = {p_value:.1g}); all weigh alike."
    ),
    Code.MODEL_JUMPS: _counting(
        "condition",
        "At {counted} the model itself jumps by more than the noise under tiny changes of its "
        "parameters; such conditions count less.",
    ),
    Code.STANDS_STILL: _stands_still,
    Code.READING_NOISE: _reading_noise,
    Code.READING_NOISE_SMALL: _reading_noise_small,
    Code.READING_NOISE_UNKNOWN: _reading_noise_unknown,
    Code.FRAME_NOISE: (
        "{table}: the noise of {column} from repeats of a phase is {scatter:.3g} {unit}; "
        "{taken:.3g} {unit} is used, as few frames tell it."
    ),
    Code.FRAME_NOISE_ABOVE_STATED: (
        "{table}: {column} scatters by {scatter:.3g} {unit} where a phase repeats, more than the "
        "stated {stated:.3g} {unit}; the scatter is used."
    ),
    Code.FRAME_NOISE_UNKNOWN: (
        "{table}: the noise of {column} is not known; the whole misfit of {taken:.3g} {unit} "
        "counts as noise."
    ),
    Code.ROUNDED_COLUMN: (
        "{table}: {column} is rounded to steps of {step:.3g} {unit}; their scatter of "
        "{taken:.3g} {unit} is used as the noise."
    ),
    Code.PERIODS_DIFFER: (
        "{table}: the periods of {column} differ by {scatter:.2g} {unit} beyond the noise of "
        "frames; this is counted as noise."
    ),
    Code.ADVANCE_SCATTERS: (
        "{table}: the advance of {column} scatters by {scatter:.2g} {unit} from period to period "
        "beyond the noise of frames; this is counted as noise."
    ),
    Code.STATED_PROBLEM: lambda f: f"{f['problem'].rstrip('.')}.",
    Code.ALL_ZERO: "Every reading is zero: nothing moved, so nothing can be told apart.",
    Code.TOO_FEW_CONDITIONS: _few_conditions,
    Code.NO_NOISE: (
        "The noise is not known, so no misfit can be judged: repeat the trials of some conditions, "
        "or state their error (velocity_sd in [[velocity]]; in diagnose_model, condition, which "
        "says what trials are repeats, or sd, or relative_sd)."
    ),
    Code.CONDITIONS_ALIKE: (
        "The conditions differ by no more than their trials do: the variance between them is "
        "{ratio:.2g} times that of their means' errors, and {needed:g} times is needed. Labels may "
        "be mixed up."
    ),
    Code.ROUNDED: (
        "{percent:.0f} % of repeated trials read exactly alike ({limit:.0f} % is too many): they "
        "are rounded to steps wider than their scatter, which then says nothing of their error. "
        "Give more digits."
    ),
    Code.DRIFT: (
        "The velocities drift with the order in which they were measured (p = {p_value:.1g}, below "
        "{level:g}); measure the conditions again in random order."
    ),
    Code.NOTHING_COMPUTED: (
        "No condition can be simulated with the stated scenario and the middles of what is "
        "uncertain; look at its settings, and whether [uncertain] has values that it forbids."
    ),
    Code.VELOCITIES_SIZE: lambda f: f"The velocities are {mismatch(f)}.",
    Code.VELOCITY_SIZE: lambda f: f"The velocity of {f['condition']} is {mismatch(f, _FASTEST)}.",
    Code.OPPOSITE_SIGN: (
        "The velocities have the opposite sign of the stated model's (a cosine of {cosine:.2g}, "
        "below {limit:g}); x, a direction, a mode or a clamp may be reversed."
    ),
    Code.SPEEDS: (
        "The velocities have the model's size without its sign: they look like speeds. A velocity "
        "is that along +x."
    ),
    Code.REVERSED: (
        "The velocities have the model's size, and the reverse of its sign wherever {setting} is "
        "{value}. A velocity is that along +x."
    ),
}
