#include "stickslip/scenario/coils.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "stickslip/numbers/number_text.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip {
namespace {

using Value = double CoilParameters::*;

constexpr Value kValues[] = {&CoilParameters::resistance,  &CoilParameters::inductance,
                             &CoilParameters::capacitance, &CoilParameters::side,
                             &CoilParameters::distance,    &CoilParameters::turns};
constexpr std::size_t kValueCount = std::size(kValues);
constexpr std::size_t kFirstOfGeometry = 3;  // those before are of the circuit

// Parameters of all coils, without accessors.
// clang-format off
constexpr std::array<Parameter, kValueCount> kRows = {{
    {.key = "coil.resistance", .unit = "ohm", .low = 0, .high = 1e9, .low_allowed = false,
     .meaning = "resistance of a coil, Table I"},
    {.key = "coil.inductance", .unit = "H", .low = 0, .high = 1e3, .low_allowed = false,
     .meaning = "inductance of a coil, Table I"},
    {.key = "coil.capacitance", .unit = "F", .low = 0, .high = 1e3,
     .meaning = "capacitance in series with a coil; 0: none"},
    {.key = "coil.side", .unit = "m", .low = 1e-6, .high = 100,
     .meaning = "effective length of a coil's side, Table I"},
    {.key = "coil.distance", .unit = "m", .low = 1e-3, .high = 100,
     .meaning = "distance of a coil's plane from the centre, Table I"},
    {.key = "coil.turns", .unit = "-", .low = 1e-3, .high = 1e6,
     .meaning = "turns of a coil, Table I"},
}};
// clang-format on

std::string key_of_one(std::size_t coil, std::size_t value) {
    const std::string of_all = kRows[value].key;
    return "coil." + std::string(name(static_cast<Coil>(coil))) + of_all.substr(of_all.find('.'));
}

// A row's accessors are functions without state, so each has its own.
template <std::size_t V>
Parameter row_of_all() {
    Parameter row = kRows[V];
    row.get = [](const Scenario& s) { return s.coil.*kValues[V]; };
    row.set = [](Scenario& s, double value) {
        s.coil.*kValues[V] = value;
        for (CoilParameters& each : s.coils) each.*kValues[V] = value;
    };
    return row;
}

template <std::size_t N>
Parameter row_of_one() {
    constexpr std::size_t coil = N / kValueCount, value = N % kValueCount;
    static const std::string key = key_of_one(coil, value);
    Parameter row = kRows[value];
    row.key = key.c_str();
    row.get = [](const Scenario& s) { return s.coils[coil].*kValues[value]; };
    row.set = [](Scenario& s, double to) { s.coils[coil].*kValues[value] = to; };
    return row;
}

template <std::size_t... V, std::size_t... N>
std::vector<Parameter> rows(std::index_sequence<V...>, std::index_sequence<N...>) {
    return {row_of_all<V>()..., row_of_one<N>()...};
}

PerCoilOf<CoilGeometry> geometry_of(const PerCoilOf<CoilParameters>& coils) {
    PerCoilOf<CoilGeometry> geometry;
    std::copy(coils.begin(), coils.end(), geometry.begin());
    return geometry;
}

}  // namespace

std::vector<Parameter> coil_rows() {
    return rows(std::make_index_sequence<kValueCount>(),
                std::make_index_sequence<kCoilCount * kValueCount>());
}

bool is_of_one_coil(std::string_view key) {
    return key.starts_with("coil.") && key.find('.') != key.rfind('.');
}

PerCoilOf<CoilParameters> robot_coils(const Scenario& scenario, const RobotFrame& frame) {
    PerCoilOf<CoilParameters> coils = scenario.coils;
    if (frame.sign < 0.0) {
        std::swap(coils[0], coils[1]);
        std::swap(coils[2], coils[3]);
    }
    return coils;
}

CoilSet world_coil_set(const Scenario& scenario) {
    return CoilSet(geometry_of(scenario.coils), scenario.map);
}

CoilSet robot_coil_set(const Scenario& scenario, const RobotFrame& frame) {
    return CoilSet(geometry_of(robot_coils(scenario, frame)),
                   scenario.map && frame.sign < 0.0
                       ? std::make_shared<const FieldMap>(scenario.map->turned())
                       : scenario.map);
}

void check_coils(const Scenario& scenario) {
    if (!scenario.map) return;
    for (std::size_t v = kFirstOfGeometry; v < kValueCount; ++v) {
        const double allowed = CoilParameters().*kValues[v];
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double value = scenario.coils[k].*kValues[v];
            if (value == allowed) continue;
            const std::string key =
                scenario.coil.*kValues[v] == value ? kRows[v].key : key_of_one(k, v);
            throw std::invalid_argument(key + " = " + digits(value) +
                                        ": allowed beside coil.map, which has the field of the "
                                        "coils, is " +
                                        digits(allowed) + " only");
        }
    }
}

}  // namespace stickslip
