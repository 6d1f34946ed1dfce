"""Drawn changes of the core and the machines, which are built step by step in build/mutations."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator

from mutations import cpp, trial
from mutations.trial import Mutation, limited

FILES = ("cpp/stickslip/**/*.[ch]pp", "cpp/machines/*.[ch]pp")
_IDLE = re.compile(  # what is no text of a running program
    rb'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\])\'|\[\[[^\n]*?\]\]'
    rb"|^ *(?:#|static_assert|template|using|requires|namespace|STICKSLIP)[^\n]*",
    re.DOTALL | re.MULTILINE,
)
_PAIRS = "< >=", "> <=", "== !=", "+ -", "* /", "+= -=", "&& ||", "true false"
_TURNED = dict(map(str.split, _PAIRS)) | {word: old for old, word in map(str.split, _PAIRS)}
# Between blanks as the formatter leaves them, so that neither pointers nor templates are meant.
_OPERATOR = re.compile(rb"(?<= )(?:<=|>=|==|!=|\+=|-=|&&|\|\||[-+*/<>])(?= )|\b(?:true|false)\b")
_SIGN = re.compile(
    rb"(?<=[(\[{])-(?=[\w(])|(?<=[=,?:] )-(?=[\w(])|(?<=return )-(?=[\w(])|!(?=[\w(])"
)
_NUMBER = re.compile(rb"(?<![\w.'<])\d[\d.]*(?:e[-+]?\d+)?(?![\w.'>])")
_IF = re.compile(rb"\bif \(")


def mutations(file: str, source: bytes) -> Iterator[Mutation]:
    """All mutations of a file."""
    bare = _IDLE.sub(lambda idle: re.sub(rb"[^\n]", b" ", idle[0]), source)
    found = [(*each.span(), _TURNED[each[0].decode()]) for each in _OPERATOR.finditer(bare)]
    found += [(*each.span(), "") for each in _SIGN.finditer(bare)]
    for each in _NUMBER.finditer(bare):
        text = each[0].decode()
        changed = int(text) + 1 if text.isdigit() else 1.5 * float(text) or 1.0
        found.append((*each.span(), str(changed)))
    for each in _IF.finditer(bare):
        start, depth = each.end(), 1
        stop = start
        while depth:
            depth += {ord("("): 1, ord(")"): -1}.get(bare[stop], 0)
            stop += 1
        if b";" not in bare[start : stop - 1]:
            found.append((start, stop - 1, f"!({source[start : stop - 1].decode()})"))
    for start, stop, text in found:
        yield Mutation(file, source[:start].count(b"\n") + 1, start, stop, text)


def can_be_read(source: bytes) -> bool:
    """The compiler says it, in the trial."""
    return True


class Copy(trial.Copy):
    """The sources and a build of them, with its own tests."""

    folder, package = cpp.SOURCE, cpp.PACKAGE

    def __init__(self) -> None:
        cpp.copy_sources()
        cpp.configure()
        if said := self.own_tests(600.0):
            raise SystemExit(f"without a change: {said}")

    def build(self) -> bool:
        return not cpp.build("_core", "_machines")

    def own_tests(self, limit: float) -> str:
        if cpp.build("stickslip_tests"):
            return "stickslip_tests is not built"
        command = [cpp.BUILD / "stickslip_tests", "--abort-after=1", "--no-intro", "--minimal"]
        status, said = limited(lambda: subprocess.call(command), limit)
        return next(iter(said.split("\n")), "hangs") if status else ""
