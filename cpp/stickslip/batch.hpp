#pragma once

#include "stickslip/batch/batch.hpp"
#include "stickslip/batch/lanes.hpp"
#include "stickslip/batch/rollout.hpp"
#include "stickslip/batch/simulator.hpp"
#include "stickslip/batch/sweep.hpp"

/// Many runs on several threads, with the same bits for any number of them.
///
/// - batch, sweep: runs from start to end; their points as columns
/// - simulator, rollout: runs that are entered and left step by step, alone or many
/// - lanes, lane_kernel: runs whose steps are taken together, as packs
namespace stickslip {}
