#include "stickslip/batch/simulator.hpp"

#include <stdexcept>

#include "stickslip/field/field_map.hpp"
#include "stickslip/numbers/hash.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "stickslip/solver/tsit5.hpp"
#ifdef STICKSLIP_WITH_ARKODE
#include "stickslip/solver/arkode.hpp"
#endif

namespace stickslip {
std::uint64_t fingerprint(const Scenario& scenario) {
    Hash hash;
    const auto is_start = [](const std::string& key) { return key.starts_with("initial."); };
    for (const Parameter& parameter : parameters()) {
        if (!is_start(parameter.key)) hash.add(parameter.get(scenario));
    }
    for (const Choice& choice : choices()) {
        if (!is_start(choice.key)) hash.add(choice.get(scenario));
    }
    for (const UserSetting& each : scenario.user_effects) {
        hash.add(each.effect->name);
        for (const double value : each.values) hash.add(value);
    }
    for (const VoltageBlock& block : scenario.program.blocks()) {
        hash.add(static_cast<double>(block.repeats));
        for (const VoltagePoint& point : block.points) {
            hash.add(point.time);
            for (const double voltage : point.voltage) hash.add(voltage);
        }
    }
    if (scenario.map) {
        const Box& box = scenario.map->box();
        for (const double edge :
             {box.low.x(), box.low.y(), box.low.z(), box.high.x(), box.high.y(), box.high.z()}) {
            hash.add(edge);
        }
        for (const std::vector<double>& coil : scenario.map->coefficients()) {
            hash.add(static_cast<double>(coil.size()));
            for (const double coefficient : coil) hash.add(coefficient);
        }
    }
    return hash.value();
}

/// Either integrator's loop.
struct Simulator::Runner {
    virtual ~Runner() = default;
    virtual void step(const PerCoil& voltages, double duration, bool linear,
                      const PerCoil* start) = 0;
    virtual double time() = 0;
    virtual SimulationState state() const = 0;
    virtual Status status() const = 0;
    virtual PerCoil voltages() const = 0;
    virtual RunSnapshot snapshot() const = 0;
    virtual void restore(const RunSnapshot& snapshot) = 0;

    std::string failure;  // what to do about the last step, if it failed
};

template <class Integrator>
struct Simulator::RunnerOf : Simulator::Runner {
    explicit RunnerOf(const Scenario& given) : scenario(given), loop(given, nullptr) {
        loop.play_steps([] {});
    }
    void step(const PerCoil& voltages, double duration, bool linear,
              const PerCoil* start) override {
        if (!loop.in_whole_plane()) {
            check_planar_step(scenario, voltages);
            if (start) check_planar_step(scenario, *start);
        }
        const RunSnapshot before = loop.snapshot();
        loop.reset_counts();
        if (start) loop.steps().jump(*start);
        loop.steps().give(voltages.data(), 1, duration, linear);
        try {
            loop.go();
        } catch (...) {  // of an effect of the user
            loop.restore(before);
            throw;
        }
        if (loop.status() != Status::ok) failure = stickslip::message(loop.take_result());
    }
    double time() override { return status() == Status::ok ? loop.steps().time() : loop.time(); }
    SimulationState state() const override { return loop.state(); }
    Status status() const override { return loop.status(); }
    PerCoil voltages() const override { return loop.steps().world_memory().last; }
    RunSnapshot snapshot() const override { return loop.snapshot(); }
    void restore(const RunSnapshot& snapshot) override { loop.restore(snapshot); }

    Scenario scenario;
    HybridLoop<Integrator> loop;
};

Simulator::~Simulator() = default;

Simulator::Simulator(const Scenario& scenario) : fingerprint_(fingerprint(scenario)) {
    check(scenario);
    Scenario bare = scenario;
    bare.record = {};
    if (scenario.solver.method == Method::tsit5) {
        runner_ = std::make_unique<RunnerOf<Tsit5>>(bare);
        return;
    }
#ifdef STICKSLIP_WITH_ARKODE
    runner_ = std::make_unique<RunnerOf<Arkode>>(bare);
#else
    RunResult none;
    none.status = Status::no_arkode;
    throw std::invalid_argument(stickslip::message(none));
#endif
}

void Simulator::step(const PerCoil& voltages, double duration, bool linear, const PerCoil* start) {
    if (status() != Status::ok) throw std::logic_error(message());
    runner_->step(voltages, duration, linear, start);
}

double Simulator::time() const {
    return runner_->time();
}
SimulationState Simulator::state() const {
    return runner_->state();
}
Status Simulator::status() const {
    return runner_->status();
}
const std::string& Simulator::message() const {
    return runner_->failure;
}
PerCoil Simulator::voltages() const {
    return runner_->voltages();
}
RunSnapshot Simulator::snapshot() const {
    RunSnapshot result = runner_->snapshot();
    result.scenario = fingerprint_;
    result.message = message();
    return result;
}

void Simulator::restore(const RunSnapshot& snapshot) {
    if (snapshot.scenario != fingerprint_) {
        throw std::invalid_argument("the snapshot is of another scenario");
    }
    runner_->restore(snapshot);
    runner_->failure = snapshot.message;
}

}  // namespace stickslip
