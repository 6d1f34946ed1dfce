#include "stickslip/batch/simulator.hpp"

#include <stdexcept>

#include "stickslip/field/field_map.hpp"
#include "stickslip/numbers/hash.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip {

std::uint64_t fingerprint(const Scenario& scenario) {
    Hash hash;
    // Initial currents say how strong the fields are, to which the tolerance is relative.
    const auto is_start = [](const std::string& key) {
        return key.starts_with("initial.") && !key.starts_with("initial.current_");
    };
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
    for (const OwnLaw& law : scenario.laws) {
        hash.add(law.name);
        for (const auto& word : law.words) hash.add(static_cast<double>(word.value_or(0)));
        for (const auto& number : law.numbers) hash.add(number.value_or(0.0));
    }
    for (const VoltageBlock& block : scenario.program.blocks()) {
        hash.add(static_cast<double>(block.repeats));
        for (const VoltagePoint& point : block.points) {
            hash.add(point.time);
            for (const double voltage : point.voltage) hash.add(voltage);
        }
    }
    if (const auto& accelerations = scenario.shake.accelerations) {
        for (const Accelerations::Point& point : accelerations->points()) {
            for (const double each : {point.time, point.x, point.z}) hash.add(each);
        }
    }
    if (const auto& forces = scenario.inner.drive.rows) {
        for (const InnerDrive::Row& row : *forces) {
            for (const double each : {row.time, row.force}) hash.add(each);
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

Simulator::Simulator(const Scenario& scenario, std::size_t index, RunControl* control)
    : scenario_(scenario),
      fingerprint_(fingerprint(scenario)),
      lane_(
          index,
          [&]() -> const Scenario& {
              check(scenario);
              scenario_.record = {};
              return scenario_;
          }(),
          control) {
    run().play_steps([] {});
}

void Simulator::check_step(const PerCoil& voltages) const {
    if (!in_whole_plane()) check_planar_step(scenario_, voltages);
}

void Simulator::begin_step(const double* voltages, double duration, bool linear) {
    run().reset_counts();
    run().steps().give(voltages, 1, duration, linear);
}

void Simulator::give_up(Status status) {
    run().give_up(status);
    end_step();
}

void Simulator::end_step() {
    if (status() != Status::ok) failure_ = run().message();
}

void Simulator::step(const PerCoil& voltages, double duration, bool linear, const PerCoil* start) {
    if (status() != Status::ok) throw std::logic_error(failure_);
    check_step(voltages);
    if (start) check_step(*start);
    const RunSnapshot before = run().snapshot();
    if (start) run().steps().jump(*start);
    begin_step(voltages.data(), duration, linear);
    try {
        run().go();
    } catch (...) {  // of an effect of the user
        run().restore(before);
        throw;
    }
    end_step();
}

double Simulator::time() const {
    return status() == Status::ok ? run().steps().time() : run().time();
}

RunSnapshot Simulator::snapshot() const {
    RunSnapshot result = run().snapshot();
    result.scenario = fingerprint_;
    result.message = failure_;
    return result;
}

void Simulator::restore(const RunSnapshot& snapshot) {
    if (snapshot.scenario != fingerprint_) {
        throw std::invalid_argument("the snapshot is of another scenario");
    }
    run().restore(snapshot);
    failure_ = snapshot.message;
}

}  // namespace stickslip
