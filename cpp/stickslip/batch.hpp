#pragma once

#include "stickslip/batch/batch.hpp"
#include "stickslip/batch/lanes.hpp"
#include "stickslip/batch/rollout.hpp"
#include "stickslip/batch/simulator.hpp"

/// Many runs on several threads, with the same bits for any number of them.
///
/// - batch: runs from start to end, and points of a sweep
/// - simulator, rollout: runs that are entered and left step by step, alone or many
/// - lanes: runs whose steps are taken together, as packs
namespace stickslip {}
