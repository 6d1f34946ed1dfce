#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "stickslip/batch/batch.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "support.hpp"

using namespace stickslip;

namespace {

/// An effect that is registered as long as the object lives.
class Registered {
public:
    explicit Registered(WrenchFunction function, std::string name = "own") : name_(name) {
        register_user_effect({name,
                              "a force",
                              "a test",
                              {{"strength", "-", -10.0, 10.0, 0.0, "its strength"},
                               {"rate", "1/s", 0.0, 1e4, 1.0, "a rate"}},
                              std::move(function)});
    }
    ~Registered() { unregister_user_effect(name_); }
    Registered(const Registered&) = delete;
    Registered& operator=(const Registered&) = delete;

private:
    std::string name_;
};

UserEffect described(const std::string& name, std::vector<UserParameter> parameters) {
    return {name, "", "", std::move(parameters),
            [](const double*, const double*, double*) noexcept {}};
}

Scenario pulses() {
    Scenario scenario;
    scenario.drive.base = 0.5e-3;
    scenario.drive.pulses = 5;
    return scenario;
}

const double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<Method> methods() {
#ifdef STICKSLIP_WITH_ARKODE
    return {Method::tsit5, Method::arkode};
#else
    return {Method::tsit5};
#endif
}

}  // namespace

TEST_CASE("user effect: its keys are those of any other, while it is registered") {
    Scenario scenario;
    CHECK_THROWS_WITH_AS(set_parameter(scenario, "effects.own.strength", 1.0),
                         "effects.own.strength: there is no such key; an effect of your own has to "
                         "be registered in this process too",
                         std::invalid_argument);
    {
        const Registered effect([](const double*, const double*, double*) {});
        set_parameter(scenario, "effects.own.strength", 2.0);
        REQUIRE(scenario.user_effects.size() == 1);
        CHECK(scenario.user_effects[0].values == std::vector{2.0, 1.0});
        CHECK_FALSE(scenario.user_effects[0].absent());
        CHECK_THROWS_WITH_AS(set_parameter(scenario, "effects.own.strength", 11.0),
                             "effects.own.strength = 11: allowed is a number from -10 to 10",
                             std::invalid_argument);
        CHECK_THROWS_AS(set_parameter(scenario, "effects.own.strength", kNan),
                        std::invalid_argument);
        CHECK_FALSE(find_user_key("effects.own.other"));
        set_parameter(scenario, "effects.own.strength", 0.0);
        CHECK(scenario.user_effects[0].absent());
        CHECK(make_model(scenario).user_effects.empty());
    }
    CHECK_FALSE(find_user_key("effects.own.strength"));
    CHECK(user_effects().empty());
    // One that simulates with it keeps it.
    scenario.user_effects[0].values[0] = 1.0;
    CHECK(simulate(scenario).status == Status::ok);
}

TEST_CASE("user effect: the order in which effects are set does not matter") {
    const auto nothing = [](const double*, const double*, double*) {};
    const Registered b(nothing, "b"), a(nothing, "a"), c(nothing, "c");
    Scenario scenario;
    for (const char* name : {"b", "c", "a"}) {
        set_parameter(scenario, "effects." + std::string(name) + ".strength", 1.0);
    }
    REQUIRE(scenario.user_effects.size() == 3);
    CHECK(scenario.user_effects[0].effect->name == "a");
    CHECK(scenario.user_effects[1].effect->name == "b");
    CHECK(scenario.user_effects[2].effect->name == "c");
}

TEST_CASE("user effect: a scenario takes the one that is registered now") {
    Scenario scenario;
    {
        const Registered before([](const double*, const double*, double*) {});
        set_parameter(scenario, "effects.own.strength", 2.0);
    }
    const Registered now([](const double*, const double*, double*) {});
    set_parameter(scenario, "effects.own.rate", 3.0);
    REQUIRE(scenario.user_effects.size() == 1);
    CHECK(scenario.user_effects[0].effect == find_user_key("effects.own.rate")->effect);
    CHECK(scenario.user_effects[0].values == std::vector{0.0, 3.0});
    register_user_effect(described("own", {{"rate", "-", 0.0, 10.0, 0.0, ""}}));
    renew_user_effects(scenario);
    CHECK(scenario.user_effects[0].effect == find_user_key("effects.own.rate")->effect);
    CHECK(scenario.user_effects[0].values == std::vector{3.0});
    register_user_effect(described("own", {{"k", "-", 0.0, 1.0, 0.0, ""}}));
    CHECK_THROWS_WITH_AS(renew_user_effects(scenario),
                         "effects.own.rate: there is no such key; an effect of your own has to be "
                         "registered in this process too",
                         std::invalid_argument);
}

TEST_CASE("user effect: the function is not called while all its parameters are absent") {
    std::atomic<int> calls = 0;
    const Registered effect([&](const double*, const double*, double*) { ++calls; });
    Scenario scenario = pulses();
    const RunResult without = simulate(scenario);
    set_parameter(scenario, "effects.own.strength", 0.0);
    const RunResult absent = simulate(scenario);
    CHECK(calls == 0);
    CHECK(std::memcmp(&absent.summary.mean_velocity, &without.summary.mean_velocity,
                      sizeof(double)) == 0);
    CHECK(absent.steps.evaluations == without.steps.evaluations);
    set_parameter(scenario, "effects.own.rate", 2.0);
    CHECK(simulate(scenario).status == Status::ok);
    CHECK(calls > 0);
}

TEST_CASE("user effect: position, velocity and field as the wrench's own arguments, in the world") {
    WrenchState seen{};
    std::vector<double> parameters;
    const Registered effect([&](const double* state, const double* values, double* wrench) {
        std::memcpy(&seen, state, sizeof seen);
        parameters.assign(values, values + 2);
        wrench[0] = 3e-6, wrench[1] = 5e-6, wrench[2] = 7e-10;
    });
    static_assert(sizeof(WrenchState) == WrenchState::kSize * sizeof(double));
    for (const Direction direction : {Direction::plus_x, Direction::minus_x}) {
        const double sign = direction == Direction::plus_x ? 1.0 : -1.0;
        Scenario scenario;
        scenario.drive.direction = direction;
        const Model plain = make_model(scenario);
        set_parameter(scenario, "effects.own.strength", 4.0);
        const Model model = make_model(scenario);
        // Three quarters of a turn on from the quadrant's start, and two whole turns before.
        const int quadrant = -8;
        for (const double angle : {0.0, 0.3, 1.5 * std::numbers::pi, 3.5 * std::numbers::pi}) {
            Dynamics with = test::in_uniform_field(model, 1e-3, 2e-3);
            Dynamics without = test::in_uniform_field(plain, 1e-3, 2e-3);
            const auto load = [&](Dynamics& dynamics) {
                dynamics.set_start(10.0);
                dynamics.set_quadrant(quadrant);
                dynamics.rebase_field(1e-5, 6e-5);
                const Pose pose = dynamics.pose(angle);
                return dynamics.load(dynamics.field_at(0.25), 1e-5, 6e-5, pose, 1e-3, 2e-3, 5.0);
            };
            const Load a = load(with), b = load(without);
            CHECK(seen.t == 10.25);
            CHECK(seen.x == sign * 1e-5);
            CHECK(seen.z == 6e-5);
            CHECK(seen.theta ==
                  doctest::Approx(angle - 4.0 * std::numbers::pi).epsilon(8.0 * test::kRounding));
            CHECK(seen.vx == sign * 1e-3);
            CHECK(seen.vz == 2e-3);
            CHECK(seen.omega == 5.0);
            CHECK(seen.bx == sign * 1e-3);
            CHECK(seen.bz == 2e-3);
            CHECK(parameters == std::vector{4.0, 1.0});
            CHECK(a.fx == b.fx + sign * 3e-6);
            CHECK(a.fz == b.fz + 5e-6);
            CHECK(a.torque == b.torque + 7e-10);
        }
    }
}

TEST_CASE("user effect: what is not finite ends the run, with the effect's name and the time") {
    constexpr double kFrom = 0.06;  // s, between two pulses of a run of 0.1 s
    for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
        for (std::size_t component = 0; component < 3; ++component) {
            const Registered effect([&](const double* state, const double*, double* wrench) {
                if (state[0] >= kFrom) wrench[component] = bad;
            });
            for (const Method method : methods()) {
                for (const bool rests : {true, false}) {
                    Scenario scenario = pulses();
                    scenario.solver.method = method;
                    if (rests) scenario.drive.peak = scenario.drive.base = 0.0;
                    scenario.record = {RecordKind::uniform, 1e4};
                    set_parameter(scenario, "effects.own.strength", 1.0);
                    const RunResult result = simulate(scenario);
                    CHECK(result.status == Status::not_finite);
                    CHECK(message(result).find("the function of effect own gave a force") !=
                          std::string::npos);
                    // As late as a trial step reaches.
                    CHECK(result.summary.simulated_time >= kFrom);
                    CHECK(result.summary.simulated_time < kFrom + 5e-3);
                    CHECK(result.recording.t.size() > 300);
                    CHECK(std::isnan(result.summary.mean_velocity));
                }
            }
        }
    }
}

TEST_CASE("user effect: an exception of the function leaves the simulation, also through ARKODE") {
    struct Fault {};
    const Registered effect([](const double* state, const double*, double*) {
        if (state[0] > 0.06) throw Fault{};
    });
    for (const Method method : methods()) {
        for (const RecordSettings& record : {RecordSettings{}, {RecordKind::uniform, 1e5}}) {
            Scenario scenario = pulses();
            scenario.solver.method = method;
            scenario.record = record;
            set_parameter(scenario, "effects.own.strength", 1.0);
            CHECK_THROWS_AS(simulate(scenario), Fault);
            RunControl control;
            CHECK_THROWS_AS(simulate_batch({scenario, scenario, scenario}, 2, control, [] {}),
                            Fault);
        }
    }
}

TEST_CASE("user effect: a force that breaks a long rest for a moment is not overlooked") {
    // A push along x of 2 ms beyond the friction limit, amid 10 s of rest without field.
    constexpr double kMiddle = 6.2, kWidth = 1e-3;
    const Registered effect([](const double* state, const double* values, double* wrench) {
        const double from = (state[0] - kMiddle) / kWidth;
        wrench[0] = values[0] * 1e-6 * std::exp(-from * from);
    });
    Scenario scenario;
    scenario.drive.peak = scenario.drive.base = scenario.drive.hold = 0.0;
    scenario.drive.ramp = 10.0;
    scenario.drive.pulses = 1;
    scenario.record = {RecordKind::events, 0.0};
    set_parameter(scenario, "effects.own.strength", 0.2);
    const RunResult result = simulate(scenario);
    // Sliding begins where the push equals the friction of weight and adhesion.
    const Model model = make_model(scenario);
    const double limit = model.friction.static_coefficient *
                         (model.adhesion.strength - model.mass * model.gravity_z);
    const double expected = kMiddle - kWidth * std::sqrt(std::log(0.2e-6 / limit));
    REQUIRE(!result.recording.t.empty());
    CHECK(result.recording.t.front() == doctest::Approx(expected).epsilon(1e-9));
    CHECK(result.recording.x.back() > 0.0);
}

TEST_CASE("user effect: rest under one can be stopped") {
    // Hours of rest in one segment, looked at every fraction of a millisecond.
    const Registered effect([](const double*, const double*, double*) {});
    Scenario scenario;
    scenario.drive.peak = scenario.drive.base = scenario.drive.hold = 0.0;
    scenario.drive.ramp = 1e4;
    set_parameter(scenario, "effects.own.strength", 1.0);
    RunControl control;
    const auto poll = [] { throw std::runtime_error("stop"); };
    CHECK_THROWS_WITH_AS(simulate_batch({scenario}, 1, control, poll), "stop", std::runtime_error);
}
