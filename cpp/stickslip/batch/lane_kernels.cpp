#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "stickslip/batch/lane_numbers.hpp"

namespace stickslip {

const std::vector<LaneKernels>& all_lane_kernels() {
    static const std::vector<LaneKernels> all = [] {
        std::vector<LaneKernels> result;
#ifdef STICKSLIP_X86_KERNELS
        if (__builtin_cpu_supports("avx2")) result.push_back(lane_kernels_of<4>());
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
            __builtin_cpu_supports("avx512vl")) {
            result.push_back(lane_kernels_of<8>());
        }
#endif
        return result;
    }();
    return all;
}

namespace {

/// The widest pack that the environment variable STICKSLIP_LANES allows.
int widest_allowed() {
    const char* text = std::getenv("STICKSLIP_LANES");
    if (text == nullptr) return std::numeric_limits<int>::max();
    for (const int width : {1, 4, 8}) {
        if (text == std::to_string(width)) return width;
    }
    throw std::invalid_argument("STICKSLIP_LANES = " + std::string(text) +
                                ": allowed is 1, 4 or 8");
}

}  // namespace

const LaneKernels& lane_kernels() {
    static const LaneKernels chosen = [] {
        const int widest = widest_allowed();
        LaneKernels result = {1};
        for (const LaneKernels& each : all_lane_kernels()) {
            if (each.size <= widest) result = each;
        }
        return result;
    }();
    return chosen;
}

}  // namespace stickslip
