#include "stickslip/scenario/named_laws.hpp"

#include <array>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <utility>

namespace stickslip {
namespace {

using enum Quantity;
using enum Argument;
using enum Form;
using enum Acts;

/// A key "effects.<name>.<number>".
struct Number {
    const char* key = nullptr;
    const char* unit = "-";
    double low = 0.0, high = 0.0;
    const char* meaning = "";
    double absent = 0.0;
};
using Numbers = std::array<double, 2>;

double one(const Numbers&) {
    return 1.0;
}

/// A named effect, absent where its amplitude is zero.
struct Row {
    EffectDescription description;
    LawKind kind;  // one of kNamedKinds costs no more than its formula
    std::array<Number, 2> numbers;
    double (*amplitude)(const Scenario&, const Numbers&);
    double (*scale)(const Numbers&) = one;
};

#define STICKSLIP_AMPLITUDE(expression) [](const Scenario&, const Numbers& n) { return expression; }
#define STICKSLIP_SCALE(expression) [](const Numbers& n) { return expression; }

// A table: clang-format would give each member of a row a line of its own.
// clang-format off
constexpr Row kRows[] = {
    {{"stribeck_friction",
      "friction falls from the static to the kinetic coefficient over a range of slip velocities",
      "Stribeck curve in the Gaussian form of Bo and Pavelescu (1982)"},
     {sliding_friction, adds, slip_speed, gaussian},
     {{{"effects.stribeck_friction.velocity", "m/s", 0, 100,
        "v_s in: mu(v) = mu_k + (mu_s - mu_k) exp(-(v/v_s)^2) while slipping"}}},
     [](const Scenario& s, const Numbers& n) {
         return n[0] > 0.0 ? s.contact.static_friction - s.contact.kinetic_friction : 0.0;
     },
     STICKSLIP_SCALE(n[0])},
    {{"viscous_friction", "friction grows with slip velocity", "Coulomb-viscous friction"},
     {sliding_friction, adds, slip_speed, line},
     {{{"effects.viscous_friction.coefficient", "s/m", 0, 1e4,
        "growth of the kinetic coefficient by slip velocity"}}},
     STICKSLIP_AMPLITUDE(n[0])},
    {{"friction_anisotropy", "friction differs between slip to the front and to the rear",
      "direction-dependent Coulomb friction"},
     {directional_friction, multiplies, slip_sign, line},
     {{{"effects.friction_anisotropy.fraction", "-", -1, 1,
        "part by which friction is higher for slip to the robot's front, and lower to its rear"}}},
     STICKSLIP_AMPLITUDE(n[0])},
    {{"friction_patches", "friction varies along the surface", "periodic Coulomb coefficient"},
     {friction, multiplies, place, wave},
     {{{"effects.friction_patches.amplitude", "-", -1, 1,
        "a in: friction times (1 + a sin(2 pi x / period)), x in the world of the touching "
        "corner, or of the middle of a face"},
       {"effects.friction_patches.period", "m", 1e-6, 1, "period in the same", 1e-3}}},
     STICKSLIP_AMPLITUDE(n[0]), STICKSLIP_SCALE(n[1] / (2.0 * std::numbers::pi))},
    {{"angle_adhesion", "adhesion falls as the robot stands up on an edge",
      "contact area of a tilted face"},
     {adhesion, multiplies, sine, square},
     {{{"effects.angle_adhesion.strength", "-", -10, 1,
        "k in: adhesion times (1 - k sin^2 theta)"}}},
     STICKSLIP_AMPLITUDE(-n[0])},
    {{"adhesion_ageing", "adhesion grows while a contact lasts",
      "logarithmic ageing of capillary bridges"},
     {adhesion, multiplies, age, logarithm},
     {{{"effects.adhesion_ageing.rate", "-", 0, 100,
        "k in: adhesion times (1 + k ln(1 + age/time)), age since touch-down"},
       {"effects.adhesion_ageing.time", "s", 1e-9, 1e4, "time in the same", 1e-3}}},
     STICKSLIP_AMPLITUDE(n[0]), STICKSLIP_SCALE(n[1])},
    // Multiplies the linear drag alone.
    {{"angle_drag", "the fluid's drag depends on the angle of the body",
      "suspected in section VI-C"},
     {drag, adds, cosine, square},
     {{{"effects.angle_drag.strength", "-", -0.99, 1000,
        "k in: linear drag times (1 + k cos^2 theta)"}}},
     [](const Scenario& s, const Numbers& n) { return n[0] * s.drag.linear; }},
    {{"quadratic_drag", "drag grows with the square of the velocity", "form drag"},
     {drag, adds, speed, line},
     {{{"effects.quadratic_drag.coefficient", "N s^2/m^2", 0, 1000,
        "drag force by the square of the velocity"}}},
     STICKSLIP_AMPLITUDE(n[0])},
};
// clang-format on

#undef STICKSLIP_AMPLITUDE
#undef STICKSLIP_SCALE

static_assert(std::size(kRows) <= std::tuple_size_v<NamedLawNumbers>);

// A row's accessors are functions without state, so each number has its own.
template <std::size_t R, std::size_t K>
void add_number(std::vector<Parameter>& rows) {
    constexpr Number kNumber = kRows[R].numbers[K];
    if (kNumber.key == nullptr) return;
    rows.push_back({.key = kNumber.key,
                    .unit = kNumber.unit,
                    .low = kNumber.low,
                    .high = kNumber.high,
                    .meaning = kNumber.meaning,
                    .get = [](const Scenario& s) { return s.effects.laws[R][K]; },
                    .set = [](Scenario& s, double value) { s.effects.laws[R][K] = value; }});
}

template <std::size_t... R>
void add_numbers(std::vector<Parameter>& rows, std::index_sequence<R...>) {
    ((add_number<R, 0>(rows), add_number<R, 1>(rows)), ...);
}

}  // namespace

const NamedLawNumbers& absent_laws() {
    static const NamedLawNumbers numbers = [] {
        NamedLawNumbers result = {};
        for (std::size_t r = 0; r < std::size(kRows); ++r) {
            result[r] = {kRows[r].numbers[0].absent, kRows[r].numbers[1].absent};
        }
        return result;
    }();
    return numbers;
}

std::vector<Parameter> with_named_laws(std::vector<Parameter> rows) {
    add_numbers(rows, std::make_index_sequence<std::size(kRows)>());
    return rows;
}

std::vector<EffectDescription> with_named_laws(std::vector<EffectDescription> rows) {
    for (const Row& row : kRows) rows.push_back(row.description);
    return rows;
}

std::vector<Law> all_laws(const Scenario& scenario, const RobotFrame& frame) {
    std::vector<Law> result = own_laws(scenario);
    for (std::size_t r = 0; r < std::size(kRows); ++r) {
        const Row& row = kRows[r];
        const Numbers& numbers = scenario.effects.laws[r];
        const double amplitude = row.amplitude(scenario, numbers);
        if (amplitude == 0.0) continue;
        result.push_back(
            {row.kind, amplitude, row.scale(numbers), {}, row.numbers[0].key, numbers[0]});
    }
    // Places are the world's; all else is of the robot's own frame.
    if (frame.sign < 0.0) {
        for (Law& law : result) {
            if (law.kind.argument == place) law.turn();
        }
    }
    return result;
}

}  // namespace stickslip
