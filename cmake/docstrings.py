"""Docstrings of the bound core, from the comments of what is bound; the build runs it.

The bindings name a comment as ``doc::SimulatorBatch_reset``: that before ``reset`` in the class
``SimulatorBatch``, in a header below a folder or in a binding. Arguments: where to write, the
folder, the bindings. ``docstrings.hpp``, which all bindings include, declares the names, and is
written again only where these change; ``docstrings.cpp`` has the texts. A name with no comment, or
with several, is an error, and so is a comment in terms of C++.
"""

from __future__ import annotations

import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

TABLE = re.compile(r"\bk((?:[A-Z][a-z]+)+)\b")  # kStateColumns is bound as state_columns
CPP = re.compile(rf"\w+::\w+|->|\bconst\b|{TABLE.pattern}|\)doc\"")


def name_of(code: str) -> str:
    """The name that a declaration gives."""
    if code.startswith("namespace"):
        return ""
    if found := re.match(r"(?:enum class|enum|struct|class) (\w+)", code):
        return found[1]
    head = re.split(r"[;={]", code)[0]
    found = re.search(r"(\w+)\(", head) or re.search(r"(\w+)\s*(?:,.*)?$", head)
    return found[1] if found else ""


def comments(text: str) -> Iterator[tuple[str, str]]:
    """Names, with the classes they stand in, and comments of a file."""
    classes: list[tuple[int, str]] = []
    depth, comment, code = 0, list[str](), ""
    for line in map(str.strip, text.splitlines()):
        if re.match("///(?!<)", line):
            comment.append(line[3:].removeprefix(" "))
            continue
        unquoted = re.sub(r'"(?:\\.|[^"\\])*"|\'\\?.\'', '""', line)
        bare, _, behind = map(str.strip, unquoted.partition("//"))
        code = re.sub(r"^template <.*?> (?=\w)", "", f"{code} {bare}".lstrip())
        if re.search(r"[;{(]", code):
            if behind.startswith("/<"):
                said = behind[2:].strip().rstrip(".")
                comment = [f"{said[:1].upper()}{said[1:]}."]
            if comment and (name := name_of(code)):
                yield "_".join([*(each for _, each in classes), name]), "\n".join(comment)
            if found := re.match(r"(?:struct|class) (\w+)[^;]*\{", code):
                classes.append((depth, found[1]))
            comment, code = [], ""
        if not bare or re.search(r"^#|[}:]$", bare):
            code = ""
        depth += bare.count("{") - bare.count("}")
        while classes and depth <= classes[-1][0]:
            classes.pop()


def in_python(text: str, bindings: str) -> str:
    """A comment as a user of Python reads it."""
    text = re.sub(r"Throws(\s)std::invalid_argument", r"Raises\1ScenarioError", text)

    def bound(found: re.Match[str]) -> str:
        name = re.sub(r"(?<=.)(?=[A-Z])", "_", found[1]).lower()
        return name if f'attr("{name}")' in bindings else found[0]

    text = TABLE.sub(bound, text)
    if found := CPP.search(text):
        raise ValueError(f"{found[0]} means nothing in Python")
    return text


def main(to: Path, headers: Path, *bindings: Path) -> None:
    known: defaultdict[str, set[str]] = defaultdict(set)
    sources = {p: p.read_text(encoding="utf-8") for p in [*headers.rglob("*.hpp"), *bindings]}
    for name, comment in (each for text in sources.values() for each in comments(text)):
        known[name].add(comment)
    together = "\n".join(sources[path] for path in bindings)
    texts: dict[str, str] = {}
    for path in bindings:
        for number, line in enumerate(sources[path].splitlines(), 1):
            for name in re.findall(r"\bdoc::(\w+)", line):
                try:
                    if len(known[name]) != 1:
                        raise ValueError(f"{len(known[name])} comments have this name")
                    (comment,) = known[name]
                    texts[name] = in_python(comment, together)
                except ValueError as error:
                    sys.exit(f"{path}:{number}: doc::{name}: {error}")
    head = "namespace stickslip::bindings::doc {\n"
    names = "".join(f"extern const char* const {name};\n" for name in sorted(texts))
    header, declared = to / "docstrings.hpp", f"#pragma once\n\n{head}{names}}}\n"
    to.mkdir(parents=True, exist_ok=True)
    if not header.exists() or header.read_text(encoding="utf-8") != declared:
        header.write_text(declared, encoding="utf-8")
    rows = "".join(
        f'const char* const {name} = R"doc({texts[name]})doc";\n' for name in sorted(texts)
    )
    texts_too = f'#include "docstrings.hpp"\n\n{head}{rows}}}\n'
    (to / "docstrings.cpp").write_text(texts_too, encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
