#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace stickslip {

/// Whether each row of a table stands at the place of its enumerator `code`.
template <class Row, std::size_t N>
constexpr bool in_order(const std::array<Row, N>& rows) {
    for (std::size_t k = 0; k < N; ++k) {
        if (static_cast<std::size_t>(rows[k].code) != k) return false;
    }
    return true;
}

/// Place of the row of a name; the number of rows where there is none.
template <class Row, std::size_t N>
constexpr std::size_t place_of(const std::array<Row, N>& rows, std::string_view name) {
    std::size_t k = 0;
    while (k < N && rows[k].name != name) ++k;
    return k;
}

/// Something that is called by a word: its enumerator, the word, and what it is.
template <class Code>
struct Word {
    Code code;
    std::string_view name;
    std::string_view meaning;
};

}  // namespace stickslip
