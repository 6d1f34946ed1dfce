#pragma once

#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/loop.hpp"
#include "stickslip/solver/motion_trace.hpp"
#include "stickslip/solver/progress_watch.hpp"
#include "stickslip/solver/stepping.hpp"
#include "stickslip/solver/tsit5.hpp"

/// Adaptive steps up to an event. The solver integrates a phase, of which it knows only
/// coordinates, rates and event functions (contact/phases.hpp says what a phase offers).
///
/// - stepping: what ends a phase, options, counts; progress_watch: whether time goes on
/// - event_location: the first event within a step, dips included
/// - loop: steps up to an event by a method; tsit5: that of order 5; arkode: SUNDIALS, the check
/// - motion_trace: extremes and strokes of a phase
namespace stickslip {}
