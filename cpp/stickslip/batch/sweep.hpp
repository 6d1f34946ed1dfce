#pragma once

#include <functional>
#include <string>
#include <vector>

#include "stickslip/run/simulation.hpp"

namespace stickslip {

/// What a sweep keeps of one point.
struct SweepPoint {
    Status status = Status::ok;
    bool refused = false;  ///< the point's values make no scenario; `message` says why
    Summary summary;
    std::string message;  ///< empty where the status is ok
};

/// Simulates `base` at many points of its keys. `values` holds a row for each point, a column for
/// each key; a key that takes words has the index of the word in its column. Summaries only, in the
/// order of the rows, bit-identical for any number of threads. A point that is refused is a point,
/// not an error. Throws std::invalid_argument for an unknown key or a size that does not fit.
std::vector<SweepPoint> sweep(const Scenario& base, const std::vector<std::string>& keys,
                              const std::vector<double>& values, int threads, RunControl& control,
                              const std::function<void()>& poll);

}  // namespace stickslip
