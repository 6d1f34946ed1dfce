#pragma once

#include "stickslip/run/assembly.hpp"
#include "stickslip/run/drive_observer.hpp"
#include "stickslip/run/initial_state.hpp"
#include "stickslip/run/player.hpp"
#include "stickslip/run/recording.hpp"
#include "stickslip/run/run.hpp"
#include "stickslip/run/run_snapshot.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/run/status.hpp"
#include "stickslip/run/step_numbers.hpp"
#include "stickslip/run/stop_condition.hpp"
#include "stickslip/run/summary.hpp"
#include "stickslip/run/window_observer.hpp"

/// One run.
///
/// - assembly: from a scenario to the parts of its run, each effect put where it acts
/// - initial_state: from a state to a contact; stop_condition: until when
/// - player: the motion, segment after segment, phase after phase
/// - recording: samples of it; window_observer, with summary and drive_observer: what it comes to
/// - run: the three together, and when it ends; run_snapshot: where it stands between two steps
/// - step_numbers, step_kernel, step_kernels: steps of one run and of packs, for each kind of
///   processor
/// - simulation: a run from start to end, with its message; status: how it ended
namespace stickslip {}
