#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

/// Numbers as they stand in messages.
namespace stickslip {

/// Whether the standard library writes floating numbers; libc++ does from LLVM 14 on.
template <class Number>
concept WrittenByLibrary = requires(char* text, Number value) {
    std::to_chars(text, text, value);
};

inline constexpr int kRoundedDigits = 6;

/// The texts below by `printf`, for a library without a floating `std::to_chars`: the same, but for
/// one power of two in fifty, which gets a digit more.
namespace by_printf {

inline std::string formatted(const char* format, int precision, double value) {
    std::array<char, 400> text;  // the largest number has 309 digits before its point
    const int size = std::snprintf(text.data(), text.size(), format, precision, value);
    return {text.data(), static_cast<std::size_t>(size)};
}

inline std::string digits(double value) {
    if (!std::isfinite(value)) return formatted("%.*g", 1, value);
    constexpr int kMost = 16;  // digits after the first that tell any double from its neighbours
    int precision = 0;
    std::string scientific = formatted("%.*e", precision, value);
    while (precision < kMost && std::strtod(scientific.c_str(), nullptr) != value) {
        scientific = formatted("%.*e", ++precision, value);
    }
    const std::string power = scientific.substr(scientific.find('e') + 1);
    const int exponent = static_cast<int>(std::strtol(power.c_str(), nullptr, 10));
    const std::string fixed = formatted("%.*f", std::max(precision - exponent, 0), value);
    return fixed.size() <= scientific.size() ? fixed : scientific;
}

inline std::string rounded(double value) {
    return formatted("%.*g", kRoundedDigits, value);
}

}  // namespace by_printf

/// The shortest digits that read back as the same number: for what the user gave.
template <class Number>
std::string digits(Number value) {
    if constexpr (WrittenByLibrary<Number>) {
        std::array<char, 32> text;
        const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
        return {text.data(), end};
    } else {
        return by_printf::digits(value);
    }
}

/// Text of a computed number, rounded.
template <class Number>
std::string rounded(Number value) {
    if constexpr (WrittenByLibrary<Number>) {
        std::array<char, 32> text;
        const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                       std::chars_format::general, kRoundedDigits)
                             .ptr;
        return {text.data(), end};
    } else {
        return by_printf::rounded(value);
    }
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
