#include "stickslip/scenario/free_shapes.hpp"

#include <array>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

namespace stickslip {
namespace {

// Limits of f at a knot: below -1 a field would change its sign.
constexpr double kLowest = -1.0, kHighest = 100.0;
constexpr double kWidestAngle = 3.2;  // rad

/// One extension, and where it stands in a scenario.
struct Hook {
    EffectDescription description;
    FreeShape Effects::*shape;
    std::array<const char*, kKnots + 1> keys;  // of the span and the knots
    const char* unit;                          // of the argument
    double low, high;                          // limits of the span
    const char* span;                          // meaning of the span
};

constexpr const char* kSource =
    "cubic Hermite interpolation in the form of Fritsch and Carlson (1980); open-set term of the "
    "diagnosis";

#define STICKSLIP_HOOK(effect, meaning)                                                   \
    .description = {"free_" #effect, meaning, kSource}, .shape = &Effects::free_##effect, \
    .keys = {"effects.free_" #effect ".span",   "effects.free_" #effect ".knot_1",        \
             "effects.free_" #effect ".knot_2", "effects.free_" #effect ".knot_3",        \
             "effects.free_" #effect ".knot_4", "effects.free_" #effect ".knot_5"}

// clang-format off
constexpr Hook kHooks[] = {
    {STICKSLIP_HOOK(contact_place,
        "the contact lies f(pitch) half lengths farther to the front of the robot: its lever is "
        "longer by that times the cosine of the pitch"),
     .unit = "rad", .low = 1e-2, .high = kWidestAngle, .span = "pitch of the last knot"},
    {STICKSLIP_HOOK(field_time,
        "the field of all coils times 1 + f(time since the run began); 1 + f is cut off at 0"),
     .unit = "s", .low = 1e-4, .high = 1e6, .span = "time of the last knot"},
    {STICKSLIP_HOOK(field_frequency,
        "the field of all coils times 1 + f(drive.frequency), not with voltages from a file; "
        "1 + f is cut off at 0"),
     .unit = "Hz", .low = 1e-3, .high = 1e5, .span = "frequency of the last knot"},
    {STICKSLIP_HOOK(field_amplitude,
        "the field of all coils times 1 + f(in-plane current), the root of the sum of squares "
        "over the four in-plane coils at each instant; 1 + f is cut off at 0"),
     .unit = "A", .low = 1e-6, .high = 1e6, .span = "in-plane current of the last knot"},
};
// clang-format on

#undef STICKSLIP_HOOK

const char* place_of_knot(FreeReach reach, std::size_t knot) {
    using Places = std::array<const char*, kKnots>;
    constexpr Places kFromZero = {"f at 0", "f at 1/4 of the span", "f at 1/2 of the span",
                                  "f at 3/4 of the span", "f at the span and beyond"};
    constexpr Places kBothWays = {"f at minus the span and beyond", "f at minus half the span",
                                  "f at 0", "f at half the span", "f at the span and beyond"};
    return reach == FreeReach::both_ways ? kBothWays[knot] : kFromZero[knot];
}

// A row's accessors are functions without state, so each hook and knot has its own.
template <std::size_t H, std::size_t K>
Parameter knot_row() {
    constexpr Hook kHook = kHooks[H];
    return {
        .key = kHook.keys[K + 1],
        .unit = "-",
        .low = kLowest,
        .high = kHighest,
        .meaning = place_of_knot((Effects().*kHook.shape).reach, K),
        .get = [](const Scenario& s) { return (s.effects.*kHooks[H].shape).knots[K]; },
        .set = [](Scenario& s, double value) { (s.effects.*kHooks[H].shape).knots[K] = value; }};
}

template <std::size_t H>
Parameter span_row() {
    constexpr Hook kHook = kHooks[H];
    return {.key = kHook.keys[0],
            .unit = kHook.unit,
            .low = kHook.low,
            .high = kHook.high,
            .meaning = kHook.span,
            .get = [](const Scenario& s) { return (s.effects.*kHooks[H].shape).span; },
            .set = [](Scenario& s, double value) { (s.effects.*kHooks[H].shape).span = value; }};
}

template <std::size_t H, std::size_t... K>
void add_rows(std::vector<Parameter>& rows, std::index_sequence<K...>) {
    rows.push_back(span_row<H>());
    (rows.push_back(knot_row<H, K>()), ...);
}

template <std::size_t... H>
void add_hooks(std::vector<Parameter>& rows, std::index_sequence<H...>) {
    (add_rows<H>(rows, std::make_index_sequence<kKnots>()), ...);
}

}  // namespace

std::vector<Parameter> with_free_shapes(std::vector<Parameter> rows) {
    add_hooks(rows, std::make_index_sequence<std::size(kHooks)>());
    return rows;
}

std::vector<EffectDescription> with_free_shapes(std::vector<EffectDescription> rows) {
    for (const Hook& hook : kHooks) rows.push_back(hook.description);
    return rows;
}

FreeShape free_shape(const Scenario& scenario, std::string_view name) {
    for (const Hook& hook : kHooks) {
        if (name == hook.description.name) return scenario.effects.*hook.shape;
    }
    if (const std::optional<FreeShape> shape = curve_of_law(scenario, name)) return *shape;
    throw std::invalid_argument(std::string(name) + ": there is no curve of this name");
}

}  // namespace stickslip
