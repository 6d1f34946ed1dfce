#include "stickslip/batch/lane_kernel.hpp"

namespace stickslip {

LaneKernels lane_kernels_of_2() {
    return kernels_of<2>();
}

}  // namespace stickslip
