#include "stickslip/batch/lane_kernel.hpp"

namespace stickslip {

LaneKernels lane_kernels_of_4() {
    return kernels_of<4>();
}

}  // namespace stickslip
