#include <doctest/doctest.h>
#include <algorithm>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "stickslip/batch/batch.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "support.hpp"

using namespace stickslip;

namespace {

/// An effect that is registered as long as the object lives.
class Registered {
public:
    explicit Registered(WrenchFunction function) {
        register_user_effect({"own",
                              "a force",
                              "a test",
                              {{"strength", "-", -10.0, 10.0, 0.0, "its strength"}},
                              std::move(function)});
    }
    ~Registered() { unregister_user_effect("own"); }
    Registered(const Registered&) = delete;
    Registered& operator=(const Registered&) = delete;
};

}  // namespace

TEST_CASE("user effect: a force that breaks a long rest for a moment is not overlooked") {
    // A push along x of 2 ms beyond the friction limit, amid 10 s of rest without field.
    constexpr double kMiddle = 6.2, kWidth = 1e-3;
    const Registered effect([](const double* state, const double* values, double* wrench) {
        const double from = (state[0] - kMiddle) / kWidth;
        wrench[0] = values[0] * 1e-6 * std::exp(-from * from);
        wrench[1] = wrench[2] = 0.0;
    });
    Scenario scenario;
    scenario.drive.peak = scenario.drive.base = scenario.drive.hold = 0.0;
    scenario.drive.ramp = 10.0;
    scenario.drive.pulses = 1;
    scenario.record = {RecordKind::events, 0.0};
    set_parameter(scenario, "effects.own.strength", 0.2);
    const RunResult result = simulate(scenario);
    // Sliding begins where the push equals the friction of weight and adhesion.
    const Model model = make_model(scenario, frame_of(scenario));
    const double limit =
        model.friction.static_coefficient * (model.adhesion - model.mass * model.gravity_z);
    const double expected = kMiddle - kWidth * std::sqrt(std::log(0.2e-6 / limit));
    REQUIRE(!result.recording.t.empty());
    CHECK(result.recording.t.front() == doctest::Approx(expected).epsilon(1e-9));
    CHECK(result.recording.x.back() > 0.0);
}

TEST_CASE("user effect: rest under one can be stopped") {
    // Hours of rest in one segment, looked at every fraction of a millisecond.
    const Registered effect(
        [](const double*, const double*, double* wrench) { std::fill_n(wrench, 3, 0.0); });
    Scenario scenario;
    scenario.drive.peak = scenario.drive.base = scenario.drive.hold = 0.0;
    scenario.drive.ramp = 1e4;
    set_parameter(scenario, "effects.own.strength", 1.0);
    RunControl control;
    const auto poll = [] { throw std::runtime_error("stop"); };
    CHECK_THROWS_WITH_AS(simulate_batch({scenario}, 1, control, poll), "stop", std::runtime_error);
}
