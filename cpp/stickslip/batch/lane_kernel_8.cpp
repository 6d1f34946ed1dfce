#include "stickslip/batch/lane_kernel.hpp"

namespace stickslip {

LaneKernels lane_kernels_of_8() {
    return kernels_of<8>();
}

}  // namespace stickslip
