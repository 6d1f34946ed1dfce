#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <utility>
#include <vector>

#include "stickslip/numbers/roots.hpp"
#include "stickslip/solver/event_location.hpp"

using namespace stickslip;

namespace {

using Function = std::function<double(double)>;

// A step of event functions that are known as functions of the fraction s, sampled where Tsit5 has
// its stages.
template <std::size_t M>
class Step {
public:
    explicit Step(std::array<Function, M> functions) : functions_(std::move(functions)) {
        armed.fill(true);
    }

    EventHit find() {
        EventSamples<M> samples;
        for (std::size_t i = 0; i < M; ++i) {
            const Function& g = functions_[i];
            samples.start[i] = g(0.0);
            samples.early[i] = g(samples.kEarly);
            samples.late[i] = g(samples.kLate);
            samples.end[i] = g(1.0);
            samples.lowest[i] = samples.start[i];
            for (const double s : {0.161, 0.327, 0.9, 0.9800255409045097, 1.0}) {
                samples.lowest[i] = std::min(samples.lowest[i], g(s));
            }
        }
        evaluations = 0;
        return find_event(samples, armed, false, [&](std::size_t i, double s) {
            ++evaluations;
            return functions_[i](s);
        });
    }

    std::array<bool, M> armed = {};
    int evaluations = 0;

private:
    std::array<Function, M> functions_;
};

Step<1> single(Function function) {
    return Step<1>({std::move(function)});
}

Function parabola(double bottom, double depth) {
    return [=](double s) { return (s - bottom) * (s - bottom) - depth; };
}

double locate(const Bracket& bracket, auto&& value) {
    const std::optional<double> root = find_root(bracket, value);
    REQUIRE(root);
    return *root;
}

// Far side, and as near to the root as the finder promises: its last bracket is shorter than twice
// its resolution.
void check_hit(const EventHit& hit, int index, double root, const Function& function) {
    REQUIRE(hit);
    CHECK(hit.index == index);
    CHECK(std::abs(hit.s - root) <= 2.0 * kRootResolution);
    CHECK(function(hit.s) <= 0.0);
}

}  // namespace

TEST_CASE("events: the first root where a function falls through zero") {
    // The golden section of [3/8, 5/8] probes at equal heights around this bottom.
    constexpr double golden = 0.3819660112501051;
    const double between_probes = 0.375 + 0.5 * (1.0 - golden) * 0.25;
    struct Case {
        const char* name;
        Function function;
        double root;
        bool armed = true;
    };
    std::vector<Case> cases = {
        {"a dip with its bottom half way between two probes", parabola(between_probes, 1e-4),
         between_probes - 1e-2},
        {"a dip that overshoots by little", parabola(0.56, 1e-9), 0.56 - std::sqrt(1e-9)},
        {"a triple root, at its flat", [](double s) { return std::pow(0.4 - s, 3); }, 0.4},
        // Negative between two roots, at a stage (0.327).
        {"falls, rises and falls again",
         [](double s) { return -(s - 0.2) * (s - 0.45) * (s - 0.95); }, 0.2},
        {"at the end of a step", [](double s) { return 1.0 - s; }, 1.0},
        {"just before the end of a step", [](double s) { return (1.0 - 1e-14) - s; }, 1.0},
        {"born on the surface, risen, and zero at the step's end",
         [](double s) { return s * (1.0 - s); }, 1.0, false},
        {"born on the surface, risen, and dips", [](double s) { return s * (s - 0.3) * (s - 0.6); },
         0.3, false},
    };
    for (const double root : {1e-6, 0.1, 0.5, 0.99, 1.0 - 1e-9}) {
        cases.push_back({"a plain crossing", [=](double s) { return root - s; }, root});
    }
    // From roots that the stages see to those of a thousandth of a step.
    for (const double bottom : {0.04, 0.08, 0.1, 0.24, 0.5, 0.62, 0.83, 0.93, 0.94, 0.96}) {
        for (const double depth : {4e-3, 1e-3, 1e-4, 1e-6}) {
            if (depth > bottom * bottom || depth > (1.0 - bottom) * (1.0 - bottom)) continue;
            cases.push_back({"a dip", parabola(bottom, depth), bottom - std::sqrt(depth)});
        }
    }
    // The looks of a function that does not simply fall are at the thirds of a step.
    for (const double root : {1.0 / 3.0, 2.0 / 3.0}) {
        cases.push_back({"a look that meets zero exactly",
                         [=](double s) { return s < root    ? 1.0
                                                : s == root ? 0.0
                                                            : -1.0; }, root});
    }
    for (const double root : {0.9, 0.5, 0.2, 0.03, 0.002, 5e-4}) {
        cases.push_back({"born on the surface and dead within the step",
                         [=](double s) { return s * (root - s); }, root, false});
    }
    for (const Case& each : cases) {
        CAPTURE(each.name);
        CAPTURE(each.root);
        Step<1> step = single(each.function);
        step.armed = {each.armed};
        check_hit(step.find(), 0, each.root, each.function);
    }
}

TEST_CASE("events: at the beginning of a step") {
    const auto at_once = [](const Function& function, bool armed) {
        Step<1> step = single(function);
        step.armed = {armed};
        const EventHit hit = step.find();
        REQUIRE(hit);
        CHECK(hit.s == 0.0);
    };
    // Armed, and on the far side already: forces that jump between two segments of voltage, or
    // rounding about a new base.
    for (const double start : {0.0, -1e-20, -1.0}) {
        for (const double slope : {-1.0, 0.0, 3.0}) {
            at_once([=](double s) { return start + slope * s; }, true);
        }
    }
    // Born on the surface, and falling; also where it comes back within the step.
    at_once([](double s) { return -s; }, false);
    at_once([](double s) { return s * (s - 0.5); }, false);
}

TEST_CASE("events: none") {
    struct Case {
        const char* name;
        Function function;
        bool armed, armed_then;
    };
    const std::array<Case, 7> cases = {{
        {"a dip above zero", parabola(0.5, -0.2), true, true},
        {"a dip just above zero", parabola(0.56, -1e-9), true, true},
        {"just after the end of a step", [](double s) { return (1.0 + 1e-14) - s; }, true, true},
        {"born on the surface and rising", [](double s) { return s; }, false, true},
        {"and below it by rounding", [](double s) { return s - 1e-18; }, false, true},
        {"rising through zero", [](double s) { return s - 0.5; }, false, true},
        {"born on the surface and staying on it", [](double) { return 0.0; }, false, false},
    }};
    for (const Case& each : cases) {
        CAPTURE(each.name);
        Step<1> step = single(each.function);
        step.armed = {each.armed};
        CHECK_FALSE(step.find());
        CHECK(step.armed[0] == each.armed_then);
    }
    Step<1> rising = single([](double s) { return 1.0 + s; });
    CHECK_FALSE(rising.find());
    CHECK(rising.evaluations == 0);  // nor any cost
}

TEST_CASE("events: a dip that touches zero and stays there") {
    // It may end at any of the looks, which are at the eighths.
    const Function dip = [](double s) { return std::abs(s - 0.5) < 0.3 ? 0.0 : 1.0; };
    Step<1> step = single([&](double s) { return s == 0.327 ? -1.0 : dip(s); });
    const EventHit hit = step.find();
    REQUIRE(hit);
    CHECK(dip(hit.s) == 0.0);
}

TEST_CASE("events: two functions of very different scale dip at once") {
    const Function large = [](double s) { return 1e6 * ((s - 0.7) * (s - 0.7) - 0.01); };
    const Function small = [](double s) { return 1e-9 * ((s - 0.4) * (s - 0.4) - 0.01); };
    Step<2> step({large, small});
    check_hit(step.find(), 1, 0.3, small);
    Step<2> exchanged({small, large});
    check_hit(exchanged.find(), 0, 0.3, small);
    // The large one alone dips early enough.
    const Function early = [](double s) { return 1e6 * ((s - 0.2) * (s - 0.2) - 0.01); };
    Step<2> other({early, small});
    check_hit(other.find(), 0, 0.1, early);
}

TEST_CASE("events: of several in a step the first, whatever their order and kind") {
    const Function crossing = [](double s) { return 0.45 - s; };
    const Function dip = parabola(0.3, 0.01);  // at 0.2
    const Function late = [](double s) { return 0.9 - s; };
    Step<3> step({late, crossing, dip});
    check_hit(step.find(), 2, 0.2, dip);
    Step<2> two({late, crossing});
    check_hit(two.find(), 1, 0.45, crossing);
    Step<2> turned({crossing, late});
    check_hit(turned.find(), 0, 0.45, crossing);
}

TEST_CASE("events: of two at one instant the second fires as the next step begins") {
    const Function first = [](double s) { return 0.5 - s; };
    const Function second = [](double s) { return 1.0 - 2.0 * s; };
    Step<2> step({first, second});
    const EventHit hit = step.find();
    check_hit(hit, 0, 0.5, first);
    Step<2> next({[](double s) { return s; }, [&](double s) { return second(hit.s + s); }});
    next.armed = {false, false};
    CHECK(next.find().index == 1);
    CHECK(next.find().s == 0.0);
}

TEST_CASE("events: a dip between the stages of a function that is flat there is missed") {
    const auto dip = [](double width) {
        return single(
            [=](double s) { return 1.0 - 2.0 * std::exp(-std::pow((s - 0.6) / width, 2)); });
    };
    CHECK_FALSE(dip(0.01).find());
    CHECK(dip(0.3).find());
}

TEST_CASE("find_root: returns the far side, at any shape, in few evaluations") {
    const std::array<std::pair<Function, double>, 6> cases = {{
        {[](double s) { return 0.3 - s; }, 0.3},
        {[](double s) { return std::tanh(200.0 * (0.7 - s)); }, 0.7},
        {[](double s) { return std::exp(-30.0 * s) - std::exp(-12.0); }, 0.4},
        {[](double s) { return std::pow(0.55 - s, 5); }, 0.55},
        {[](double s) { return s < 0.123 ? 1.0 : -1e-12; }, 0.123},
        {[](double s) { return std::sqrt(std::max(0.0, 0.8 - s)) - 1e-3; }, 0.8 - 1e-6},
    }};
    for (const auto& [function, root] : cases) {
        CAPTURE(root);
        int evaluations = 0;
        const auto value = [&](double s) {
            ++evaluations;
            return function(s);
        };
        const double s = locate({0.0, 1.0, function(0.0), function(1.0)}, value);
        CHECK(function(s) <= 0.0);
        // The fifth power is below 1e-80 in the last 1e-16: no flatter root is told apart.
        CHECK(std::abs(s - root) <= 2.0 * kRootResolution);
        CHECK(evaluations <= 2 * 40);  // bisection would take log2(1e12) = 40
    }
}

TEST_CASE("find_root: where the dense output ends short of a zero that the step has passed") {
    // By rounding: the bracket's far end is known to be past zero, the interpolant is not.
    const auto value = [](double s) { return 1.0 + 1e-15 - s; };
    const double s = locate({0.0, 1.0, 1.0, -1e-16}, value);
    CHECK(s >= 1.0 - kRootResolution);
    CHECK(s <= 1.0);
}

TEST_CASE("find_root: refuses a bracket without a change of sign") {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [low, high] : std::initializer_list<std::pair<double, double>>{{-1.0, -2.0},
                                                                                    {-1.0, 2.0},
                                                                                    {1.0, 2.0},
                                                                                    {0.0, -1.0},
                                                                                    {-1.0, 0.0},
                                                                                    {none, -1.0},
                                                                                    {1.0, none}}) {
        CAPTURE(low);
        CAPTURE(high);
        int evaluations = 0;
        const auto value = [&](double s) {
            ++evaluations;
            return low + s * (high - low);
        };
        CHECK_FALSE(find_root(Bracket{0.0, 1.0, low, high}, value));
        CHECK(evaluations == 0);
    }
}

TEST_CASE("find_root: ends whatever the function does") {
    for (const double odd : {0.0, 1.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
        CAPTURE(odd);
        int evaluations = 0;
        const auto value = [&](double s) {
            ++evaluations;
            return evaluations % 3 == 0 ? 1e-300 * s : odd;
        };
        const double s = locate({0.0, 1.0, 1e-300, -1e300}, value);
        CHECK(s >= 0.0);
        CHECK(s <= 1.0);
        CHECK(evaluations <= 130);
    }
}
