"""How large each wing of the project is, beside its budget: ``python -m bench lines``.

Lines are those of the files as the formatters leave them. `--package` counts what is short, called
once, a constant or long in other packages than those of the diagnosis, and `--list` names it.
"""

from __future__ import annotations

import argparse
import ast
import re
import subprocess
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]


def _package(of: str) -> str:
    return rf"python/stickslip/({of})\.py"


WINGS = {
    "common": (_package(r"_util/.*|errors"), 3_100),
    "simulator": (_package(r"(scenario|field|simulation|sweeping|plot)/.*"), 9_000),
    "applications": (_package(r"(design|control|reproduction)/.*"), 4_150),
    "diagnosis": (_package(r"diagnosis/.*"), 11_230),
    "machines": (rf"{_package(r'models/.*')}|cpp/machines/.*\.[hc]pp", 2_950),
    "walker": (_package(r"walker/.*"), 5_180),
    "command": (_package(r"cli/.*|(?!errors)\w+"), 2_250),
    "core": (r"cpp/(stickslip|bindings)/.*\.[hc]pp|cmake/.*\.py", 19_130),
    "tests": (r"(tests|cpp/tests)/.*\.(py|[hc]pp)", 38_600),
    "bench": (r"bench/.*\.(py|cpp)", 8_600),
}
"""Which files belong to a wing, and how many lines they may have; a file belongs to one wing.

Budgets are the sizes of November 2026.
"""
WORDS = (r"(docs/.*|README|CONTRIBUTING)\.md", 35_000)
OVER = 1.05  # of a budget; above it the tests fail. Chosen: small changes need no new budget
SHORT = 60  # lines of a file below which it should be part of another


def files(pattern: str) -> list[Path]:
    """Files of the project whose whole path matches, ignored ones apart."""
    command = ["git", "-C", str(ROOT), "ls-files", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    return [ROOT / name for name in names if re.fullmatch(pattern, name) and (ROOT / name).exists()]


def constants(tree: ast.Module) -> Iterator[str]:
    """Names in capitals that a module gives a number, each name of a tuple by itself."""
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            parts = list(ast.walk(node.value))
            numbers = [each for each in parts if isinstance(each, ast.Constant)]
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = [each.id for target in targets for each in ast.walk(target)
                     if isinstance(each, ast.Name)]  # fmt: skip
            bad = any(isinstance(each, ast.Dict | ast.Lambda | ast.comprehension) for each in parts)
            if numbers and not bad and all(type(each.value) in (int, float) for each in numbers):
                yield from (name for name in names if re.fullmatch(r"_?[A-Z][A-Z0-9_]*", name))


def called_once(tree: ast.Module) -> Iterator[str]:
    """Private functions and methods that their file mentions once beside their definition."""
    used = Counter(
        node.id if isinstance(node, ast.Name) else node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Name | ast.Attribute)
    )
    for node in ast.walk(tree):
        private = isinstance(node, ast.FunctionDef) and re.match(r"_[^_]", node.name)
        if private and used[node.name] == 1:
            yield node.name


def lengths(tree: ast.Module) -> dict[str, int]:
    """Lines of each function, with its docstring."""
    return {
        f"{node.name}, line {node.lineno}": (node.end_lineno or node.lineno) - node.lineno + 1
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
    }


def shape(paths: list[Path]) -> tuple[dict[str, int], dict[str, list[str]]]:
    """Counts of what makes a package hard to read, and the names behind them."""
    classes, long = 0, {}
    found: dict[str, list[str]] = {
        f"files below {SHORT} lines": [], "numeric constants": [],
        "private functions called once": [],
    }  # fmt: skip
    short, numbers, once = found.values()
    for path in paths:
        text, name = path.read_text(), str(path.relative_to(ROOT))
        tree = ast.parse(text)
        classes += sum(isinstance(node, ast.ClassDef) for node in ast.walk(tree))
        if len(text.splitlines()) < SHORT and path.name != "__init__.py":
            short.append(name)
        numbers += [f"{name}: {each}" for each in constants(tree)]
        once += [f"{name}: {each}" for each in called_once(tree)]
        long |= {f"{name}: {each}": lines for each, lines in lengths(tree).items()}
    limit = int(np.percentile(list(long.values()), 95)) if long else 0
    counts = {"files": len(paths), "classes": classes, "functions": len(long)}
    counts |= {what: len(each) for what, each in found.items()}
    counts["lines of a function, 95th percentile"] = limit
    worst = sorted(long, key=lambda each: -long[each])[: len(long) // 20]
    return counts, {**found, "longest functions": [f"{each}: {long[each]} lines" for each in worst]}


def circles() -> list[set[str]]:
    """Modules of the package that import each other, with what is imported for types alone."""
    home = ROOT / "python" / "stickslip"
    trees = {
        ".".join(path.relative_to(home).with_suffix("").parts).removesuffix(".__init__"): ast.parse(
            path.read_text()
        )
        for path in home.rglob("*.py")
        if path.parent != home or path.name != "__init__.py"
    }
    needed = {name: set[str]() for name in trees}
    for name, tree in trees.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("stickslip"):
                base = node.module.removeprefix("stickslip").lstrip(".")
                within = {f"{base}.{each.name}".lstrip(".") for each in node.names}
                found = within & trees.keys()
                needed[name] |= found | ({base} & trees.keys() if within - found else set())
        needed[name].discard(name)
    reached = {}
    for name in trees:
        seen, left = set[str](), [name]
        while left:
            new = needed[left.pop()] - seen
            seen |= new
            left += new
        reached[name] = seen
    found = {frozenset(e for e in reached[n] if n in reached[e]) for n in trees if n in reached[n]}
    return sorted(map(set, found), key=min)


def sizes() -> dict[str, tuple[int, int]]:
    """Lines of each wing and words of the documentation, each with its budget."""
    found = {
        wing: (sum(len(path.read_text().splitlines()) for path in files(pattern)), budget)
        for wing, (pattern, budget) in WINGS.items()
    }
    words = sum(len(path.read_text().split()) for path in files(WORDS[0]))
    return {**found, "words of documentation": (words, WORDS[1])}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench lines", description=__doc__)
    parser.add_argument("--package", default="diagnosis", help="a regular expression")
    parser.add_argument("--list", action="store_true", help="name what is counted of the packages")
    options = parser.parse_args()
    print(f"{'wing':<36}{'lines':>8}{'budget':>8}{'over':>8}")
    for wing, (lines, budget) in sizes().items():
        print(f"{wing:<36}{lines:>8}{budget:>8}{lines / budget - 1.0:>+8.1%}")
    for circle in circles():
        print(f"in a circle: {', '.join(sorted(circle))}")
    counts, found = shape(files(rf"python/stickslip/({options.package})/.*\.py"))
    print(f"\nOf {options.package.replace('|', ', ')}:")
    print(*(f"{what:<36}{count:>8}" for what, count in counts.items()), sep="\n")
    if options.list:
        for what, names in found.items():
            print(f"\n{what}:", *names, sep="\n  ")


if __name__ == "__main__":
    main()
