#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "stickslip/numbers/number_text.hpp"

/// Rows with a `time` (s), linear from one to the next, that are played again and again. The last
/// time is the period.
namespace stickslip {

/// Throws std::invalid_argument, which begins with `what`, for fewer than two rows, numbers that
/// are not finite (a row's own: `sum`), a first time that is not zero, and times that do not rise.
template <class Row>
void check_rows(const std::string& what, const std::vector<Row>& rows, auto&& sum) {
    if (rows.size() < 2) throw std::invalid_argument(what + ": needs at least two rows");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double time = rows[i].time;
        const std::string where = what + ", row " + std::to_string(i + 1) + ": ";
        if (!std::isfinite(time) || !std::isfinite(sum(rows[i]))) {
            throw std::invalid_argument(where + "allowed are finite numbers");
        }
        if (i == 0 ? time != 0.0 : !(time > rows[i - 1].time)) {
            throw std::invalid_argument(where + "t = " + digits(time) + " s: allowed is " +
                                        (i == 0 ? "0 in the first row" : "a time that rises"));
        }
    }
}

/// The row that the piece with a time of the period begins with.
template <class Row>
const Row& row_before(const std::vector<Row>& rows, double time) {
    const auto next = std::upper_bound(rows.begin() + 1, rows.end() - 1, time,
                                       [](double t, const Row& row) { return t < row.time; });
    return *(next - 1);
}

/// The begin of the period with a time in it.
template <class Row>
double period_before(const std::vector<Row>& rows, double time) {
    return std::floor(time / rows.back().time) * rows.back().time;
}

/// The first time of a row after another time.
template <class Row>
double next_row(const std::vector<Row>& rows, double after) {
    const double played = period_before(rows, after);
    for (const Row* row = &row_before(rows, after - played) + 1; row <= &rows.back(); ++row) {
        if (played + row->time > after) return played + row->time;
    }
    return played + rows.back().time + rows[1].time;
}

}  // namespace stickslip
