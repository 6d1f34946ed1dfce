"""The environment says which kernels make the steps; those with fused multiply-add agree."""

import json

import pytest

from command_line import python_process
from frozen import freeze
from frozen.scenarios import scenarios
from stickslip import _core

BATCH = "import stickslip as s; s.simulate_batch([s.Scenario()])"
VELOCITIES = """
import json, test_lanes
from frozen.scenarios import register_own_effect
from stickslip import _core, simulate, simulate_batch
register_own_effect()
chosen = test_lanes.some_runs()
together = [run.mean_velocity.hex() for run in simulate_batch(chosen.values(), threads=1)]
alone = [simulate(each).mean_velocity.hex() for each in chosen.values()]
print(json.dumps([_core.kernel(), together, alone]))
"""
PROCESSORS = ("baseline", "x86-64-v3", "x86-64-v4")
KERNEL, _ = _core.kernel()
pytestmark = pytest.mark.usefixtures("frozen_effect")


def some_runs():
    """Frozen runs that packs have, with and without effects."""
    return {name: each for name, each in scenarios().items() if name.startswith("pack/")}


def velocities(**variables):
    """The kernel of a process with these variables, and its velocities together and alone."""
    done = python_process("-c", VELOCITIES, variables=variables)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("STICKSLIP_LANES", "2", "1, 4 or 8"),
        ("STICKSLIP_LANES", "04", "1, 4 or 8"),
        ("STICKSLIP_PROCESSOR", "v3", "baseline, x86-64-v3 or x86-64-v4"),
    ],
)
def test_a_value_that_does_not_exist_is_named(name, value, allowed):
    done = python_process("-c", BATCH, variables={name: value})
    assert done.returncode == 1
    assert f"{name} = {value}: allowed is {allowed}" in done.stderr


@pytest.mark.nightly
@pytest.mark.skipif(KERNEL == "baseline", reason="this processor has one kernel")
def test_all_kernels_with_fused_multiply_add_give_the_same_bits():
    kernel, together, alone = velocities(STICKSLIP_LANES="1")
    assert kernel == [KERNEL, 1]
    assert alone == together
    for processor in PROCESSORS[1 : PROCESSORS.index(KERNEL) + 1]:
        kernel, *others = velocities(STICKSLIP_PROCESSOR=processor)
        assert kernel == [processor, 4 if processor == "x86-64-v3" else 8]
        assert others == [together, together]


def test_the_kernel_of_any_processor_differs_by_rounding_alone():
    kernel, together, alone = velocities(STICKSLIP_PROCESSOR="baseline")
    assert kernel == ["baseline", 1]
    assert alone == together
    _, expected = freeze.read()
    for name, velocity in zip(some_runs(), map(float.fromhex, together), strict=True):
        stored = expected[name]
        own, limit = stored.numbers["mean_velocity"], freeze.ELSEWHERE + 10.0 * stored.spread
        assert abs(velocity - own) <= limit * max(abs(own), freeze.FLOOR), name
