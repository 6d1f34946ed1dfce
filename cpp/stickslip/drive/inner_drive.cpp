#include "stickslip/drive/inner_drive.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "stickslip/drive/played_rows.hpp"
#include "stickslip/numbers/elementary.hpp"

namespace stickslip {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

void InnerDrive::set_rows(std::vector<Row> given) {
    check_rows("forces", given, [](const Row& row) { return row.force; });
    rows = std::make_shared<const std::vector<Row>>(std::move(given));
}

double InnerDrive::turns(double time) const {
    return frequency * time + phase / kTurn;
}

double InnerDrive::at(double time, double inside) const {
    if (rows) {
        const double played = period_before(*rows, inside);
        const Row& from = row_before(*rows, inside - played);
        const Row& to = *(&from + 1);
        const double part = (time - (played + from.time)) / (to.time - from.time);
        return from.force + part * (to.force - from.force);
    }
    if (duty > 0.0) {
        const double part = turns(inside);
        return part - std::floor(part) < duty ? amplitude : 0.0;
    }
    const double part = frequency * time;
    const double turn = kTurn * (part - std::floor(part));
    double sum = cosine_and_sine(turn + phase).sine;
    for (std::size_t k = 0; k < harmonics.size(); ++k) {
        if (harmonics[k].part == 0.0) continue;
        const double angle = static_cast<double>(k + 2) * turn + harmonics[k].phase;
        sum += harmonics[k].part * cosine_and_sine(angle).sine;
    }
    return amplitude * sum;
}

double InnerDrive::next_jump(double after) const {
    if (rows) return next_row(*rows, after);
    if (amplitude == 0.0 || duty == 0.0) return std::numeric_limits<double>::infinity();
    const double whole = std::floor(turns(after));
    const auto time_of = [this](double part) { return (part - phase / kTurn) / frequency; };
    for (const double part : {whole, whole + duty, whole + 1.0}) {
        if (time_of(part) > after) return time_of(part);
    }
    return time_of(whole + 1.0 + duty);
}

double InnerDrive::shortest_period() const {
    if (absent() || duty > 0.0 || rows) return std::numeric_limits<double>::infinity();
    double highest = 1.0;
    for (std::size_t k = 0; k < harmonics.size(); ++k) {
        if (harmonics[k].part != 0.0) highest = static_cast<double>(k + 2);
    }
    return 1.0 / (frequency * highest);
}

}  // namespace stickslip
