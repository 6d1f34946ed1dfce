"""Directives for what the package itself knows: keys, effects, commands, results."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import click
import rules
from docutils import nodes
from report_keys import reference
from score.__main__ import page
from score.rows import HERE as SCORES
from scores import CLAIMS
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from stale import VERDICTS, stale

from stickslip import _core, effects
from stickslip.cli.commands import loaded, stickslip
from stickslip.scenario.keys import Key, known_keys

MEASURED = Path(__file__).parents[1] / "measured"
OF_VERDICTS = {"real.json": "rows", "walkers.json": "rows", "untold.json": "kinds"}
"""Files with figures of the diagnosis, and where their rows are."""


def _markdown_table(header: list[str], rows: list[list[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def _code(text: str) -> str:
    return f"`{text}`"


def _plain(text: str) -> str:
    """Text that Markdown must not read as markup."""
    return "".join(f"\\{c}" if c in "*_$<>|`[]" else c for c in text)


def _usual(key: Key) -> str:
    return "; usually {:g} to {:g} {}".format(*key.usual) if key.usual else ""


def _default(key: Key) -> str:
    return json.dumps(key.default) if isinstance(key.default, str) else f"{key.default:g}"


class ScenarioKeys(SphinxDirective):
    """A table of keys for each section of a scenario, but the effects."""

    def run(self) -> list[nodes.Node]:
        keys = [key for key in known_keys().values() if not key.name.startswith("effects.")]
        parts = []
        for section in dict.fromkeys(key.section for key in keys):
            rows = [
                [
                    _code(key.name.rpartition(".")[2]),
                    _plain(key.meaning),
                    _code(_default(key)),
                    _plain(key.allowed + _usual(key)),
                ]
                for key in keys
                if key.section == section
            ]
            parts.append(f"**`[{section}]`**")
            parts.append(_markdown_table(["key", "meaning", "default", "allowed"], rows))
        return self.parse_text_to_nodes("\n\n".join(parts))


class EffectsTable(SphinxDirective):
    """A table of the effects."""

    def run(self) -> list[nodes.Node]:
        rows = []
        for effect in effects():
            parameters = "; ".join(
                f"`{key.name.rpartition('.')[2]}`: {_plain(key.meaning)} ({_plain(key.allowed)})"
                for key in effect.parameters
            )
            rows.append(
                [_code(effect.name), _plain(effect.meaning), parameters, _plain(effect.source)]
            )
        header = ["section `[effects.…]`", "what it adds", "parameters", "source"]
        return self.parse_text_to_nodes(_markdown_table(header, rows))


class ResultTable(SphinxDirective):
    """A table of the core: of numbers, columns, words or statuses."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        name = self.arguments[0]
        table: dict[str, Any] = getattr(_core, name)
        words = ["what it is"]
        beside = {
            "statuses": ["what happened", "what to do"], "events": words, "contact_words": words,
        }  # fmt: skip
        header = beside.get(name, ["unit", *words])
        rows = [
            [_code(each), *map(_plain, [row] if isinstance(row, str) else row)]
            for each, row in table.items()
        ]
        return self.parse_text_to_nodes(_markdown_table(["name", *header], rows))


class RunNotes(SphinxDirective):
    """A table of the notes of the core, with what their texts say of any run."""

    def run(self) -> list[nodes.Node]:
        texts = {note["code"]: note["text"] for note in reversed(_core.note_rows)}
        rows = []
        for code, text in reversed(texts.items()):
            words = re.sub(
                r"\{(\w+(?:\.\w+)+)(?:=[^}]*)?\}", r"\1", text
            )  # keys by name, numbers as dots
            rows.append([_code(code), _plain(re.sub(r"\{[^}]*\}", "…", words))])
        return self.parse_text_to_nodes(_markdown_table(["code", "what it says"], rows))


class ReportKeys(SphinxDirective):
    """A table of the keys of a report's JSON object."""

    def run(self) -> list[nodes.Node]:
        rows = [[_code(key), meaning] for key, meaning in reference().items()]
        return self.parse_text_to_nodes(_markdown_table(["key", "value"], rows))


class EquationPlaces(SphinxDirective):
    """A table of the paper's equations and the headers of the core whose comments name them."""

    def run(self) -> list[nodes.Node]:
        core = Path(__file__).parents[2] / "cpp" / "stickslip"
        places: dict[int, list[str]] = {}
        for path in sorted(core.rglob("*.hpp")):
            text = path.read_text("utf-8")
            named = set[int]()
            for words in re.findall(r"Eqs?\. ([()\d, -]*\d\))", text):
                for first, last in re.findall(r"\((\d+)\)(?:-\((\d+)\))?", words):
                    named |= {*range(int(first), int(last or first) + 1)}
            for number in named:
                places.setdefault(number, []).append(_code(str(path.relative_to(core))))
        rows = [[f"({number})", ", ".join(places[number])] for number in sorted(places)]
        return self.parse_text_to_nodes(_markdown_table(["equation", "headers"], rows))


class CommandHelp(SphinxDirective):
    """What ``--help`` prints, of ``stickslip`` and of each of its commands."""

    def run(self) -> list[nodes.Node]:
        outer = click.Context(stickslip, info_name="stickslip", **stickslip.context_settings)
        found: list[tuple[str, click.Command, click.Context]] = [("stickslip", stickslip, outer)]
        for name in stickslip.list_commands(outer):
            command = loaded(name)
            context = click.Context(command, info_name=name, parent=outer)
            found.append((f"stickslip {name}", command, context))
        result: list[nodes.Node] = []
        for words, command, context in found:
            context.terminal_width = context.max_content_width = 88
            text = command.get_help(context)
            block = nodes.literal_block(text, text, language="text", classes=["command-help"])
            title = nodes.title(words, words)
            result.append(nodes.section("", title, block, ids=[nodes.make_id(words)]))
        return result


class BenchResults(SphinxDirective):
    """The table of a file in docs/measured, with the command, the day and the machine."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        path = MEASURED / self.arguments[0]
        for each in (path, VERDICTS):
            self.env.note_dependency(str(each))
        results = json.loads(path.read_text())
        tables = {
            "speed.json": _bench,
            "peers.json": _peers,
            "sweep.json": _sweep,
            "real.json": _real,
            "walkers.json": _walkers,
            "untold.json": _untold,
        }
        rows = results[OF_VERDICTS[path.name]].values() if path.name in OF_VERDICTS else []
        parts = [*stale(rows), tables[path.name](results), _origin(results)]
        parsed = self.parse_text_to_nodes("\n\n".join(parts))
        return [nodes.container("", *parsed, classes=["measured"])]


class Score(SphinxDirective):
    """The scored table of the diagnosis, of a file of rows, or the counts of its rules."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        path = rules.STORED if self.arguments[0] == "rules" else SCORES / self.arguments[0]
        for each in (path, VERDICTS):
            self.env.note_dependency(str(each))
        text = rules.page() if path == rules.STORED else page(path)
        parsed = self.parse_text_to_nodes(text)
        return [nodes.container("", *parsed, classes=["measured"])]


def _origin(results: dict[str, Any]) -> str:
    machine = results["machine"]
    cores = machine["cores_allowed"]
    versions = {"stickslip": results["stickslip"], **results.get("versions", {})}
    said = ", ".join(f"{program} {version}" for program, version in versions.items())
    return (
        f"Measured on {results['date']} by {_code(results['command'])} on one machine: "
        f"{_plain(machine['processor'])}, {cores} core{'s' if cores != '1' else ''}, "
        f"{_plain(machine['system'])}, Python {machine['python']}; {said}. {_load(results)}"
    )


def _load(results: dict[str, Any]) -> str:
    """What else the machine had to do, if known: times by the clock suffer from it."""
    if "load_before" not in results:
        return ""
    return (
        f"Processes that wanted a processor beside it: {results['load_before']:.1f} on average; "
        "they make times by the clock longer, and the speed-up with threads smaller."
    )


def _bench(results: dict[str, Any]) -> str:
    tolerances = _markdown_table(
        ["method", "`rtol`", "simulated s a CPU s", "velocity error"],
        [
            [
                _code(row["method"]),
                _code(f"{row['rtol']:.0e}"),
                f"{row['simulated_per_cpu_second']:.0f}",
                _code(f"{row['velocity_error']:.1e}"),
            ]
            for row in results["tolerances"]
        ],
    )
    equal = _markdown_table(
        ["equal velocity error", "tsit5, s a CPU s", "arkode, s a CPU s", "ratio"],
        [
            [
                _code(f"{row['velocity_error']:.0e}"),
                f"{row['tsit5']:.0f}",
                f"{row['arkode']:.0f}",
                f"{row['ratio']:.1f}",
            ]
            for row in results["equal_accuracy"]
        ],
    )
    ratio = results["long_run"]["ratio"]
    return f"{tolerances}\n\n{equal}\n\n100 times as many pulses cost {ratio:.1f} times the time."


def _peers(results: dict[str, Any]) -> str:
    tables = []
    for unit in dict.fromkeys(row["unit"] for row in results["rows"]):
        rows = [
            [
                row["peer"],
                _plain(row["settings"]),
                f"{row['cost']:.3g}",
                _code(f"{row['error']:.1e}"),
                _code(row["stickslip_settings"]),
                f"{row['stickslip_cost']:.3g}",
                _code(f"{row['stickslip_error']:.1e}"),
                f"{row['ratio']:.3g}",
            ]
            for row in results["rows"]
            if row["unit"] == unit
        ]
        header = ["peer", "settings", "cost", "error", "stickslip", "cost", "error", "cost ratio"]
        tables.append(f"Cost in {_plain(unit)}:\n\n{_markdown_table(header, rows)}")
    return "\n\n".join(tables)


def _sweep(results: dict[str, Any]) -> str:
    single, threads, tiny = (
        results["against_single_runs"],
        results["threads"],
        results["overhead"],
    )
    rows = [
        ["simulated s a CPU s in a sweep", f"{single['sweep_simulated_per_cpu_second']:.0f}"],
        ["CPU time of a sweep over that of single runs", f"{single['ratio']:.2f}"],
        [
            f"speed-up with {threads['threads']} threads, median and best of the repetitions",
            f"{threads['speed_up_median']:.2f}, {threads['speed_up_best']:.2f}",
        ],
        ["overhead of a point, CPU µs", f"{tiny['cpu_microseconds_a_point']:.0f}"],
    ]
    return _markdown_table(["what", "result"], rows)


def _real(results: dict[str, Any]) -> str:
    rows = [
        [
            row["set"],
            row["listed"],
            str(row["readings"]),
            *(_plain(row[key]) for key in ("verdict", "found", "size", "share", "gain")),
            row["judgement"],
            f"{row['cpu_s']:.0f}",
        ]
        for row in results["rows"].values()
    ]
    header = [
        *("set", "cause listed", "readings", "verdict", "found", "size", "share"),
        *("held-out error", "judgement", "CPU s"),
    ]
    return _markdown_table(header, rows)


def _walkers(results: dict[str, Any]) -> str:
    rows = [
        [
            row["set"],
            row["alone"],
            _plain(f"{row['verdict']}: {row['found']}"),
            _plain("-" if row["verdict"] in CLAIMS else " ".join(row["reasons"])),
            _plain(row["gain"]),
        ]
        for row in results["rows"].values()
        if row["listed"] == "yes"
    ]
    header = ["set", "error of the simulation alone", "verdict", "why no name", "held-out error"]
    return _markdown_table(header, rows)


def _untold(results: dict[str, Any]) -> str:
    count = results["of each"]
    rows = [
        [kind, f"{row['said']} of {count}", f"{row['wrongly']} of {count}"]
        for kind, row in results["kinds"].items()
    ]
    return _markdown_table(["hidden", "said where it is", "said where it is not"], rows)


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directives."""
    app.add_directive("scenario-keys", ScenarioKeys)
    app.add_directive("effects-table", EffectsTable)
    app.add_directive("command-help", CommandHelp)
    app.add_directive("equation-places", EquationPlaces)
    app.add_directive("run-notes", RunNotes)
    app.add_directive("report-keys", ReportKeys)
    app.add_directive("result-table", ResultTable)
    app.add_directive("bench-results", BenchResults)
    app.add_directive("score", Score)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
