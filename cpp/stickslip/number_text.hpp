#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

/// Numbers as they stand in messages.
namespace stickslip {

/// The shortest digits that read back as the same number: for what the user gave.
inline std::string digits(double value) {
    std::array<char, 32> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
}

inline constexpr int kRoundedDigits = 6;

/// For what was computed.
inline std::string rounded(double value) {
    std::array<char, 32> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                   std::chars_format::general, kRoundedDigits)
                         .ptr;
    return {text.data(), end};
}

/// For a limit, which may be taken as it stands: rounded down, or up, where the nearest is refused.
inline std::string highest(double limit) {
    const std::string nearest = rounded(limit);
    if (!std::isfinite(limit) || std::strtod(nearest.c_str(), nullptr) <= limit) return nearest;
    const double place = std::floor(std::log10(std::fabs(limit))) - (kRoundedDigits - 1);
    return rounded(limit - 0.5 * std::pow(10.0, place));
}

inline std::string lowest(double limit) {
    const std::string mirrored = highest(-limit);
    if (limit == 0.0) return "0";
    return mirrored.front() == '-' ? mirrored.substr(1) : "-" + mirrored;
}

}  // namespace stickslip
