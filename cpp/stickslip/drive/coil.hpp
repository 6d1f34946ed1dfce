#pragma once

#include <array>

namespace stickslip {

/// The coils in the order of every array of currents or voltages: +x, -x, +y, -y, and below (-z).
enum class Coil { xp, xm, yp, ym, clamp };

inline constexpr int kCoilCount = 5;
inline constexpr std::array<Coil, kCoilCount> kAllCoils{Coil::xp, Coil::xm, Coil::yp, Coil::ym,
                                                        Coil::clamp};

/// One value a coil.
template <class T>
using PerCoilOf = std::array<T, kCoilCount>;
using PerCoil = PerCoilOf<double>;
inline constexpr auto kClampCoil = static_cast<std::size_t>(Coil::clamp);

/// Currents or voltages as a robot turned by 180 degrees about z sees them: the coils of each pair
/// change places, and fields along x and y change sign.
inline PerCoil turned(const PerCoil& v) {
    return {-v[1], -v[0], -v[3], -v[2], v[4]};
}

/// "xp", "xm", "yp", "ym" or "clamp".
const char* name(Coil coil);

}  // namespace stickslip
