#include "stickslip/batch/sweep.hpp"

#include <stdexcept>

#include "stickslip/batch/batch.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/scenario_rows.hpp"

namespace stickslip {
std::vector<SweepPoint> sweep(const Scenario& base, const std::vector<std::string>& keys,
                              const std::vector<double>& values, int threads, RunControl& control,
                              const std::function<void()>& poll) {
    const ScenarioRows rows(base, keys, values);
    std::vector<SweepPoint> points(rows.size());
    const auto scenario_of = [&](std::size_t index) -> std::optional<Scenario> {
        try {
            Scenario scenario = rows[index];
            scenario.record = {};
            check(scenario);
            return scenario;
        } catch (const std::logic_error& refusal) {
            points[index].refused = true;
            points[index].message = refusal.what();
            return std::nullopt;
        }
    };
    const auto done = [&](std::size_t index, RunResult&& result) {
        SweepPoint& point = points[index];
        point.status = result.status;
        point.summary = result.summary;
        if (result.status != Status::ok) point.message = message(result);
    };
    simulate_tasks(points.size(), threads, control, scenario_of, done, poll);
    return points;
}

}  // namespace stickslip
