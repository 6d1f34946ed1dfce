#include "stickslip/scenario/own_coils.hpp"

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "stickslip/numbers/number_text.hpp"
#include "stickslip/scenario/plane.hpp"

namespace stickslip {
namespace {

struct OwnValue {
    const char* of_all;   // key
    const char* meaning;  // of the own value
    double OwnCoil::*own;
    double& (*common)(CoilParameters&);
};

constexpr OwnValue kValues[] = {
    {"coil.resistance", "resistance of this coil; 0: coil.resistance", &OwnCoil::resistance,
     [](CoilParameters& c) -> double& { return c.resistance; }},
    {"coil.inductance", "inductance of this coil; 0: coil.inductance", &OwnCoil::inductance,
     [](CoilParameters& c) -> double& { return c.inductance; }},
    {"coil.side", "effective length of this coil's side; 0: coil.side", &OwnCoil::side,
     [](CoilParameters& c) -> double& { return c.geometry.side; }},
    {"coil.distance", "distance of this coil's plane from the centre; 0: coil.distance",
     &OwnCoil::distance, [](CoilParameters& c) -> double& { return c.geometry.distance; }},
    {"coil.turns", "turns of this coil; 0: coil.turns", &OwnCoil::turns,
     [](CoilParameters& c) -> double& { return c.geometry.turns; }},
};
constexpr std::size_t kValueCount = std::size(kValues);
constexpr std::size_t kFirstOfGeometry = 2;  // those before are of the circuit

// Name, and a key a value in their order.
#define STICKSLIP_COIL(coil)                                                          \
    {                                                                                 \
        "coil_" #coil, {                                                              \
            "effects.coil_" #coil ".resistance", "effects.coil_" #coil ".inductance", \
                "effects.coil_" #coil ".side", "effects.coil_" #coil ".distance",     \
                "effects.coil_" #coil ".turns"                                        \
        }                                                                             \
    }

struct OwnCoilNames {
    const char* effect;
    std::array<const char*, kValueCount> keys;
};

constexpr PerCoilOf<OwnCoilNames> kNames = {{STICKSLIP_COIL(xp), STICKSLIP_COIL(xm),
                                             STICKSLIP_COIL(yp), STICKSLIP_COIL(ym),
                                             STICKSLIP_COIL(clamp)}};
#undef STICKSLIP_COIL

// Of the key of all coils, in a table that is still being made.
const Parameter& row_of_all(const std::vector<Parameter>& rows, const OwnValue& value) {
    for (const Parameter& row : rows) {
        if (std::string_view(row.key) == value.of_all) return row;
    }
    throw std::logic_error(value.of_all);
}

// A row's accessors are functions without state, so each coil and value has its own.
template <std::size_t C, std::size_t V>
Parameter own_row(const Parameter& of_all) {
    return {
        .key = kNames[C].keys[V],
        .unit = of_all.unit,
        .low = 0.0,
        .high = of_all.high,
        .meaning = kValues[V].meaning,
        .get = [](const Scenario& s) { return s.effects.own_coils[C].*kValues[V].own; },
        .set = [](Scenario& s, double value) { s.effects.own_coils[C].*kValues[V].own = value; }};
}

template <std::size_t C, std::size_t... V>
void add_coil(std::vector<Parameter>& rows, std::index_sequence<V...>) {
    const std::array<Parameter, sizeof...(V)> own = {
        own_row<C, V>(row_of_all(rows, kValues[V]))...};
    rows.insert(rows.end(), own.begin(), own.end());
}

template <std::size_t... C>
void add_coils(std::vector<Parameter>& rows, std::index_sequence<C...>) {
    (add_coil<C>(rows, std::make_index_sequence<kValueCount>()), ...);
}

PerCoilOf<CoilGeometry> geometry_of(const PerCoilOf<CoilParameters>& coils) {
    PerCoilOf<CoilGeometry> geometry;
    for (std::size_t k = 0; k < kCoilCount; ++k) geometry[k] = coils[k].geometry;
    return geometry;
}

// Of coils whose field is that of a map.
void refuse_geometry(const Scenario& scenario) {
    CoilParameters usual, given = scenario.coil;
    for (std::size_t v = kFirstOfGeometry; v < kValueCount; ++v) {
        const auto refuse = [](const char* key, double value, double allowed) {
            throw std::invalid_argument(std::string(key) + " = " + digits(value) +
                                        ": allowed beside coil.map, which has the field of the "
                                        "coils, is " +
                                        digits(allowed) + " only");
        };
        const OwnValue& value = kValues[v];
        if (value.common(given) != value.common(usual)) {
            refuse(value.of_all, value.common(given), value.common(usual));
        }
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double own = scenario.effects.own_coils[k].*value.own;
            if (own != 0.0) refuse(kNames[k].keys[v], own, 0.0);
        }
    }
}

}  // namespace

std::vector<Parameter> with_own_coils(std::vector<Parameter> rows) {
    add_coils(rows, std::make_index_sequence<kCoilCount>());
    return rows;
}

std::vector<EffectDescription> with_own_coils(std::vector<EffectDescription> rows) {
    constexpr PerCoilOf<const char*> kMeaning = {
        "the +x coil has values of its own", "the -x coil has values of its own",
        "the +y coil has values of its own", "the -y coil has values of its own",
        "the clamp coil below has values of its own"};
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        rows.push_back({.name = kNames[k].effect,
                        .meaning = kMeaning[k],
                        .source = "Eqs. (1)-(7) coil by coil; Table I has five equal ones"});
    }
    return rows;
}

PerCoilOf<CoilParameters> world_coils(const Scenario& scenario) {
    PerCoilOf<CoilParameters> coils;
    coils.fill(scenario.coil);
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        for (const OwnValue& value : kValues) {
            const double own = scenario.effects.own_coils[k].*value.own;
            if (own != 0.0) value.common(coils[k]) = own;
        }
    }
    return coils;
}

PerCoilOf<CoilParameters> robot_coils(const Scenario& scenario) {
    PerCoilOf<CoilParameters> coils = world_coils(scenario);
    if (frame_sign(scenario) < 0.0) {
        std::swap(coils[0], coils[1]);
        std::swap(coils[2], coils[3]);
    }
    return coils;
}

CoilSet world_coil_set(const Scenario& scenario) {
    return CoilSet(geometry_of(world_coils(scenario)), scenario.map);
}

CoilSet robot_coil_set(const Scenario& scenario) {
    return CoilSet(geometry_of(robot_coils(scenario)),
                   scenario.map && frame_sign(scenario) < 0.0
                       ? std::make_shared<const FieldMap>(scenario.map->turned())
                       : scenario.map);
}

void check_own_coils(const Scenario& scenario) {
    if (scenario.map) refuse_geometry(scenario);
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        for (std::size_t v = 0; v < kValueCount; ++v) {
            const double own = scenario.effects.own_coils[k].*kValues[v].own;
            const Parameter& of_all = *find_parameter(kValues[v].of_all);
            const bool fits = of_all.low_allowed ? own >= of_all.low : own > of_all.low;
            if (own == 0.0 || fits) continue;
            throw std::invalid_argument(std::string(kNames[k].keys[v]) + " = " + digits(own) +
                                        ": allowed is 0 (" + of_all.key + ") or " +
                                        allowed_range(of_all));
        }
    }
}

}  // namespace stickslip
