#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "stickslip/run/step_numbers.hpp"

namespace stickslip {
namespace {

constexpr std::array<const char*, 3> kProcessors = {"baseline", "x86-64-v3", "x86-64-v4"};
constexpr std::array<const char*, 3> kWidthNames = {"1", "4", "8"};
constexpr std::array<int, 3> kWidths = {1, 4, 8};

/// The place of an environment variable's value among those allowed; the last where it is not set.
std::size_t chosen(const char* name, const std::array<const char*, 3>& allowed) {
    const char* text = std::getenv(name);
    if (text == nullptr) return allowed.size() - 1;
    for (std::size_t i = 0; i < allowed.size(); ++i) {
        if (std::string(text) == allowed[i]) return i;
    }
    throw std::invalid_argument(std::string(name) + " = " + text + ": allowed is " + allowed[0] +
                                ", " + allowed[1] + " or " + allowed[2]);
}

}  // namespace

const char* name_of(Processor processor) {
    return kProcessors[static_cast<std::size_t>(processor)];
}

const StepKernels& step_kernels() {
    static const StepKernels found = [] {
        StepKernels result = step_kernels_of<Processor::baseline>();
        [[maybe_unused]] const auto best =
            static_cast<Processor>(chosen("STICKSLIP_PROCESSOR", kProcessors));
        const int widest = kWidths[chosen("STICKSLIP_LANES", kWidthNames)];
#ifdef STICKSLIP_X86_KERNELS
        const bool has_v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
        const bool has_v4 = has_v3 && __builtin_cpu_supports("avx512f") &&
                            __builtin_cpu_supports("avx512dq") &&
                            __builtin_cpu_supports("avx512vl");
        if (has_v3 && best >= Processor::x86_64_v3) {
            result = step_kernels_of<Processor::x86_64_v3>();
        }
        // Packs of four are those of v3.
        if (has_v4 && best >= Processor::x86_64_v4 && widest != 4) {
            result = step_kernels_of<Processor::x86_64_v4>();
        }
#endif
        result.size = std::min(result.size, widest);
        return result;
    }();
    return found;
}

}  // namespace stickslip
