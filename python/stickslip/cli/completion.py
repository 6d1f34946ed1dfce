"""What a shell completes: bash, zsh and fish ask for it when the tabulator key is pressed.

The shells' part is click's; here stand the words, and what the shells make of ``key=value``.
"""

from __future__ import annotations

import glob
import os
from collections.abc import Callable, Iterable

import click
from click.shell_completion import (
    BashComplete,
    CompletionItem,
    FishComplete,
    ShellComplete,
    ZshComplete,
    add_completion_class,
    shell_complete,
    split_arg_string,
)

from stickslip._util.files import NETCDF_SUFFIXES
from stickslip.cli import COMPLETION
from stickslip.scenario.keys import full_name, known_keys
from stickslip.scenario.named_effects import PREFIX, effects, is_free_shape
from stickslip.scenario.path_keys import COIL_MAP, FILE, PATHS
from stickslip.scenario.sections import COIL_NAMES

Completer = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]
"""What click asks for the items that begin as an incomplete word does."""


class _WholeWords(ShellComplete):
    """A shell that replaces all of ``--option=value`` by an answer, which click gives for value."""

    _option = ""

    def get_completion_args(self) -> tuple[list[str], str]:
        args, incomplete = super().get_completion_args()
        option, equals, _ = incomplete.partition("=")
        if equals and option.startswith("-"):
            self._option = option + equals
        return args, incomplete

    def format_completion(self, item: CompletionItem) -> str:
        if item.type == "plain":
            item.value = self._option + item.value
        return super().format_completion(item)


@add_completion_class
class _Bash(BashComplete):
    """Bash, which splits words at the signs of COMP_WORDBREAKS, by default also at = and :.

    They are put together again, and what stands before the last = is left out of the answers, as
    bash replaces only what comes after it. No space follows an answer that ends in =.
    """

    source_template = BashComplete.source_template.replace(
        "COMPREPLY+=($value)",
        "COMPREPLY+=($value)\n            [[ $value == *= ]] && compopt -o nospace",
    )
    _replaced_from = ""

    def get_completion_args(self) -> tuple[list[str], str]:
        words = split_arg_string(os.environ["COMP_WORDS"])
        place = int(os.environ["COMP_CWORD"])
        whole: list[str] = []
        goes_on = False
        for word in words[1 : place + 1]:
            is_break = word != "" and not word.strip("=:")
            if whole and (is_break or goes_on):
                whole[-1] += word
            else:
                whole.append(word)
            goes_on = is_break
        if place >= len(words):  # a word that has not begun
            return whole, ""
        incomplete = whole.pop() if whole else ""
        if incomplete != words[place]:
            value = incomplete.partition("=")[2] if incomplete.startswith("-") else incomplete
            self._replaced_from = value[: value.rfind("=") + 1]
        return whole, incomplete

    def format_completion(self, item: CompletionItem) -> str:
        item.value = item.value.removeprefix(self._replaced_from)
        return super().format_completion(item)


@add_completion_class
class _Zsh(_WholeWords, ZshComplete):
    """Zsh, which puts no space after answers that end in =: all answers do, or none does."""

    source_template = ZshComplete.source_template.replace(
        "    for type key descr",
        "    local -a suffix\n"
        '    [[ "$response[2]" == *= ]] && suffix=(-S "")\n\n'
        "    for type key descr",
    ).replace("completions_with_descriptions -U", 'completions_with_descriptions -U "${suffix[@]}"')


@add_completion_class
class _Fish(_WholeWords, FishComplete):
    """Fish, whose answers may have commas in them."""

    source_template = FishComplete.source_template.replace(
        'string split ","', 'string split --max 1 ","'
    )


def answer(command: click.Command, instruction: str) -> int:
    """Print the script of a shell, or what it asks for, by the value of `COMPLETION`.

    An instruction that is none of click's gives the exit status 1.
    """
    return shell_complete(command, {}, "stickslip", COMPLETION, instruction)


def _beginning(words: Iterable[tuple[str, str]], incomplete: str) -> list[CompletionItem]:
    """Those of some words with their meanings that begin as an incomplete one."""
    return [
        CompletionItem(word, help=meaning) for word, meaning in words if word.startswith(incomplete)
    ]


def _next_of_list(before: str, words: Iterable[str], incomplete: str) -> list[CompletionItem]:
    """Lists of words with commas between them, `incomplete` with one that it has not; after a text
    `before`."""
    done, comma, last = incomplete.rpartition(",")
    return [
        CompletionItem(f"{before}{done}{comma}{word}")
        for word in words
        if word.startswith(last) and word not in done.split(",")
    ]


def _files(before: str, incomplete: str, suffixes: tuple[str, ...]) -> list[CompletionItem]:
    """Files of some kinds and folders: shells complete a path only where it is a whole word."""
    folders = glob.glob(f"{glob.escape(incomplete)}*/")
    files = [path for path in glob.glob(f"{glob.escape(incomplete)}*") if path.endswith(suffixes)]
    return [CompletionItem(before + path) for path in sorted([*folders, *files])]


def _setting(incomplete: str, is_list: bool) -> list[CompletionItem]:
    key, equals, value = incomplete.partition("=")
    if not equals:
        # They are many and alike, and would hide the others.
        without_free = not incomplete.startswith(f"{PREFIX}free")
        keys = [
            (f"{each.name}=", f"{each.meaning}; {each.allowed}")
            for each in known_keys().values()
            if not (without_free and is_free_shape(each.section.removeprefix(PREFIX)))
        ]
        if not is_list:
            keys.append((f"{FILE}=", "CSV file of voltages"))
            keys.append((f"{COIL_MAP}=", "CSV or netCDF file of the coils' measured field"))
        return _beginning(keys, incomplete)
    if key in PATHS:
        suffixes = (".csv",) if key == FILE else (".csv", ".json", *NETCDF_SUFFIXES)
        return [] if is_list else _files(f"{key}=", value, suffixes)
    known = known_keys().get(full_name(key))
    if known is None:
        return []
    if is_list or known.kind == "fields":
        return _next_of_list(f"{key}=", known.words, value)
    return [CompletionItem(f"{key}={word}") for word in known.words if word.startswith(value)]


def setting(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """``key=value``: the keys, and behind = the words that a key takes, or the files."""
    return _setting(incomplete, is_list=False)


def settings(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """``key=a,b,c``: the keys, and behind = the words that a key takes, each once."""
    return _setting(incomplete, is_list=True)


def key_or_section(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Sections of a scenario and its keys."""
    keys = known_keys().values()
    sections = [(name, "section") for name in dict.fromkeys(key.section for key in keys)]
    return _beginning([*sections, *((key.name, key.meaning) for key in keys)], incomplete)


def effect(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of extensions."""
    return _beginning(((each.name, each.meaning) for each in effects()), incomplete)


def coils(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of coils with commas between them."""
    return _next_of_list("", COIL_NAMES, incomplete)


def figure_after(suffix: str) -> Completer:
    """Numbers of the summary, each with a suffix."""

    def complete(
        ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        from stickslip.design.goal import FIGURES

        figures = ((f"{name}{suffix}", each.meaning) for name, each in FIGURES.items())
        return _beginning(figures, incomplete)

    return complete
