#include <vector>

#include "stickslip/lane_numbers.hpp"

namespace stickslip {

LaneKernels lane_kernels_of_2();
LaneKernels lane_kernels_of_4();
LaneKernels lane_kernels_of_8();

const std::vector<LaneKernels>& all_lane_kernels() {
    static const std::vector<LaneKernels> all = [] {
        std::vector<LaneKernels> result = {lane_kernels_of_2()};
#ifdef STICKSLIP_X86_KERNELS
        if (__builtin_cpu_supports("avx2")) result.push_back(lane_kernels_of_4());
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
            __builtin_cpu_supports("avx512vl")) {
            result.push_back(lane_kernels_of_8());
        }
#endif
        return result;
    }();
    return all;
}

const LaneKernels& lane_kernels() {
    return all_lane_kernels().back();
}

}  // namespace stickslip
