"""Whether the table of effects and ways to run sees an effect that one way has lost.

Takes one mutation for each way to run, drawn by a seed. Each edits
one place of a copy of the C++ sources so that one way leaves out one effect, builds that copy, and
runs the table with it (`tests/ways_to_run.py`). The table has to find a difference that the
sources as they are do not have. The status is 1 if it overlooks one.

The copy is in build/mutations and is built there step by step: some minutes for the first time, and
then what a mutation touches.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import subprocess
import sys
import sysconfig
import time
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
SCRATCH = ROOT / "build" / "mutations"
SOURCE, BUILD, PACKAGE = (SCRATCH / name for name in ("source", "build", "package"))
CORE = "cpp/stickslip/"


class Mutation(NamedTuple):
    """`effect` is lost in `way` where `text`, which is in `file` once, becomes `replacement`.

    effect: a row of the table, or "nothing" for what all drives have.
    """

    way: str
    effect: str
    file: str
    text: str
    replacement: str


MUTATIONS = (
    Mutation("one plane", "friction_anisotropy", "named_laws.cpp",
             "if (amplitude == 0.0) continue;\n        result",
             "if (amplitude == 0.0 || (row.kind.argument == slip_sign && !frame.whole_plane))\n"
             "            continue;\n        result"),
    Mutation(
        "one plane",
        "angle_adhesion",
        "named_laws.cpp",
        "if (amplitude == 0.0) continue;\n        result",
        "if (amplitude == 0.0 || (row.kind.argument == sine && !frame.whole_plane)) continue;\n"
        "        result",
    ),
    Mutation("whole plane", "surface_tilt", "assembly.cpp",
             "{weight * downhill.x, weight * downhill.y});", "{0.0 * weight * downhill.x, 0.0});"),
    Mutation("packs", "adhesion_ageing", "lanes.cpp", "if constexpr (kEffects) put_laws(place);",
             ""),
    Mutation("packs", "friction_patches", "lanes.cpp", "laws_[i * size_ + place] = number;",
             "laws_[i * size_ + place] = 0.5 * number;"),
    Mutation("stepped", "sample_hold", "control_steps.hpp", ": hold_(hold_period),",
             ": hold_(0.0 * hold_period),"),
    Mutation("stepped", "amplifier_limit", "control_steps.cpp", "if (limit_ > 0.0) points",
             "if (limit_ < 0.0) points"),
    Mutation("restored", "adhesion_ageing", "player.cpp",
             "    dynamics_.set_contact_age(snapshot.contact_age);\n", ""),
    Mutation("restored", "eddy_lag", "circuit.cpp", "    lagging_ = memory.lagging;\n", ""),
    Mutation("rolled out", "misalignment", "rollout.cpp",
             "        Scenario own = without_record(*given);\n",
             "        Scenario own = without_record(*given);\n"
             "        own.effects.misalignment_angle = 0.0;\n"),
    Mutation("swept", "quadratic_drag", "scenario_rows.cpp",
             "        set_parameter(scenario, key, value);\n",
             '        if (key != "effects.quadratic_drag.coefficient") {\n'
             "            set_parameter(scenario, key, value);\n"
             "        }\n"),
    Mutation("in a batch", "gradient_scale", "batch.cpp",
             "[&](std::size_t index) { return std::optional(scenarios[index]); },",
             "[&](std::size_t index) {\n"
             "            Scenario each = scenarios[index];\n"
             "            if (scenarios.size() > 1) each.effects.gradient_scale_fraction = 0.0;\n"
             "            return std::optional(each);\n"
             "        },"),
    Mutation("towards -x", "friction_patches", "named_laws.cpp",
             "if (frame.sign < 0.0) {\n        for (Law& law",
             "if (false) {\n        for (Law& law"),
    Mutation("towards -x", "ambient_field", "assembly.cpp",
             "frame.sign * scenario.effects.ambient_field_bx,",
             "scenario.effects.ambient_field_bx,"),
    Mutation("map towards -x", "nothing", "coils.cpp",
             "std::make_shared<const FieldMap>(scenario.map->turned())", "scenario.map"),
    Mutation("own effects", "own_compiled", "assembly.cpp",
             "if (!each.absent()) model.user_effects.push_back(each);",
             "if (!each.absent() && s.record.kind == RecordKind::none) "
             "model.user_effects.push_back(each);"),
)  # fmt: skip


def drawn(seed: int) -> list[Mutation]:
    """One mutation of each way."""
    ways = list(dict.fromkeys(each.way for each in MUTATIONS))
    choice = random.Random(seed)
    return [choice.choice([each for each in MUTATIONS if each.way == way]) for way in ways]


def copy_sources() -> None:
    """The sources as they are; one that is the same keeps its time, so that nothing is built."""
    for path in (ROOT / "cpp").rglob("*.?pp"):
        put(SOURCE / path.relative_to(ROOT), path.read_text())
    for path in (*(ROOT / "cmake").iterdir(), ROOT / "CMakeLists.txt"):
        put(SOURCE / path.relative_to(ROOT), path.read_text())
    there = {path.relative_to(SOURCE) for path in (SOURCE / "cpp").rglob("*.?pp")}
    for gone in there - {path.relative_to(ROOT) for path in (ROOT / "cpp").rglob("*.?pp")}:
        (SOURCE / gone).unlink()
    shutil.rmtree(PACKAGE, ignore_errors=True)
    ignored = shutil.ignore_patterns("*.so", "__pycache__")
    shutil.copytree(ROOT / "python" / "stickslip", PACKAGE / "stickslip", ignore=ignored)


def put(path: Path, text: str) -> None:
    """Write a file where it differs."""
    if path.exists() and path.read_text() == text:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def configure() -> None:
    """Configure as scikit-build-core does for a wheel, but quicker to compile, with the tests."""
    said = failure(
        *("-S", SOURCE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Mutations"),
        "-DCMAKE_CXX_FLAGS_MUTATIONS=-O1 -fno-math-errno",
        "-DSTICKSLIP_BUILD_PYTHON=ON",
        "-DSTICKSLIP_BUILD_TESTS=ON",
        "-DSKBUILD_PROJECT_VERSION=0.1.0",
        f"-DPython_EXECUTABLE={sys.executable}",
        f"-DCMAKE_PREFIX_PATH={sysconfig.get_path('purelib')}",
    ) or build("_core", "_machines")
    if said:
        sys.exit(said)


def build(*targets: str) -> str:
    """Build targets of the copy, its modules beside the copied package; what goes wrong."""
    said = failure("--build", BUILD, "--target", *targets)
    for module in BUILD.glob("_*.so"):
        shutil.copy(module, PACKAGE / "stickslip")
    return said


def failure(*arguments: object) -> str:
    """Run CMake; its output if it fails, else nothing."""
    command = ["cmake", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return f"{' '.join(command)}\n{done.stdout}{done.stderr}" if done.returncode else ""


def differences(effects: Iterable[str]) -> set[str]:
    """Lines of the table of effects with the copy's core, without the numbers: way and case."""
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, ROOT / "tests" / "ways_to_run.py", ",".join(sorted(effects))],
        capture_output=True,
        text=True,
        env=environment,
        check=False,
    )
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)
    return {": ".join(line.split(": ")[:2]) for line in done.stdout.splitlines()}


def place_of(mutation: Mutation) -> Path:
    """The file in the copy, in which the text has to be once."""
    path = next((SOURCE / CORE).rglob(mutation.file))
    found = path.read_text().count(mutation.text)
    if found != 1:
        sys.exit(f"{mutation.file}: {found} times instead of once: {mutation.text}")
    return path


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser("bench mutations cpp", description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1, help="draws one mutation of each way")
    parser.add_argument("--only", type=int, metavar="N", help="the Nth alone, from 1")
    parser.add_argument("--all", action="store_true", help="all that there are of each way")
    arguments = parser.parse_args(words)
    chosen = list(MUTATIONS) if arguments.all else drawn(arguments.seed)
    if arguments.only is not None:
        chosen = chosen[arguments.only - 1 : arguments.only]
    copy_sources()
    for mutation in chosen:
        place_of(mutation)
    configure()
    before = differences({each.effect for each in chosen})
    print(f"as it is: {len(before)} differences")
    print(f"{'way':16} {'effect':20} {'file':22} {'found':6} {'by':40} {'s':>4}", flush=True)
    overlooked = 0
    for mutation in chosen:
        started = time.monotonic()
        path = place_of(mutation)
        original = path.read_text()
        try:
            path.write_text(original.replace(mutation.text, mutation.replacement))
            if said := build("_core"):
                sys.exit(said)
            new = differences([mutation.effect]) - before
        finally:
            path.write_text(original)
        ways = ", ".join(sorted({line.split(": ")[0] for line in new}))
        overlooked += not new
        verdict = f"{len(new)}" if new else "GREEN"
        seconds = time.monotonic() - started
        print(
            f"{mutation.way:16} {mutation.effect:20} {mutation.file:22} {verdict:6} {ways:40}"
            f" {seconds:4.0f}",
            flush=True,
        )
    print(f"{len(chosen) - overlooked} of {len(chosen)} found")
    return 1 if overlooked else 0
