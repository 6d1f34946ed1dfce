#!/usr/bin/env bash
# Expected: dry friction with a sticking spring (`CoordinateSpringDamperExt`, zone 0) holds a block that is pushed with
#   0.9 of the limit, as it holds one with 0.5.
# What happens: at steps of 1 ms the block creeps on for ever, at 4.4 mm a second, at 0.5 ms at half of that, though at
#   2 ms and 0.2 ms it holds. The velocity that is put out, 2.45 mm/s, is mu g times half the step and not the rate of
#   the positions. Critical damping of the spring mends it for a stiffness of 1e4 N/m and not for 1e3. No warning.
# Package: exudyn 1.13.6. Source: found by trying.
# Who is hurt: whoever models stick-slip drives: a creep of the solver looks like one of the stage.
# Instead: halve the step: a creep that halves with it is none (tried); a stiff and damped sticking spring (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 exudyn==1.13.6
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

warnings.simplefilter("ignore")
import exudyn
import numpy as np
from exudyn.utilities import (
    CoordinateSpringDamperExt, LoadCoordinate, MarkerNodeCoordinate, MassPoint, NodeGenericData, NodePoint,
    NodePointGround)

LIMIT = 0.5 * 1.0 * 9.81  # N


def block(share, step, end=5.0, stiffness=1e5, damping=0.0):
    """Place and velocity of a block of 1 kg, pushed with a share of its friction limit from rest."""
    system = exudyn.SystemContainer().AddSystem()
    node = system.AddNode(NodePoint(referenceCoordinates=[0, 0, 0]))
    system.AddObject(MassPoint(mass=1.0, nodeNumber=node))
    ground = system.AddNode(NodePointGround())
    markers = [system.AddMarker(MarkerNodeCoordinate(nodeNumber=each, coordinate=0)) for each in (ground, node)]
    state = system.AddNode(NodeGenericData(initialCoordinates=[1, 0, 0], numberOfDataCoordinates=3))
    system.AddObject(CoordinateSpringDamperExt(
        markerNumbers=markers, nodeNumber=state, stiffness=0.0, damping=0.0, dynamicFrictionForce=LIMIT,
        frictionProportionalZone=0.0, stickingStiffness=stiffness, stickingDamping=damping))
    system.AddLoad(LoadCoordinate(markerNumber=markers[1], load=share * LIMIT))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(end / step)
    settings.timeIntegration.endTime = end
    settings.timeIntegration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    system.SolveDynamic(settings)
    kinds = exudyn.OutputVariableType
    return [float(system.GetNodeOutput(node, kind)[0]) for kind in (kinds.Displacement, kinds.Velocity)]


print("exudyn", exudyn.GetVersionString(), "numpy", np.__version__)
for share in (0.5, 0.9):
    for step in (2e-3, 1e-3, 5e-4, 2e-4):
        place, velocity = block(share, step)
        later = block(share, step, end=10.0)[0]
        print(f"{share} of the limit, steps of {1e3 * step:g} ms: {1e3 * place:.3f} mm after 5 s, {1e3 * later:.3f} "
              f"after 10 s, velocity {1e3 * velocity:.3f} mm/s")
        if share == 0.9 and step in (1e-3, 5e-4):
            assert abs(place / (5.0 * 4.41 * step) - 1.0) < 0.05 and abs(later / place - 2.0) < 0.05
            assert abs(velocity - 0.5 * 9.81 * step / 2.0) < 1e-5
        else:
            assert max(abs(place), abs(later)) < 2e-4
for stiffness in (1e3, 1e4):
    place = block(0.9, 1e-3, stiffness=stiffness, damping=2.0 * np.sqrt(stiffness))[0]
    print(f"0.9 of the limit, 1 ms, critical damping, {stiffness:g} N/m: {1e3 * place:.3f} mm after 5 s")
    assert place > 0.02 if stiffness == 1e3 else abs(place) < 1e-3
assert abs(block(1.1, 1e-3, end=1.0)[0] - 0.05 * 9.81 / 2.0) < 0.005
PROGRAM
