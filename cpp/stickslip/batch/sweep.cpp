#include "stickslip/batch/sweep.hpp"

#include <cmath>
#include <stdexcept>

#include "stickslip/batch/batch.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/parameters.hpp"

namespace stickslip {
namespace {

class PointSetter {
public:
    explicit PointSetter(const std::string& key) : key_(key), choice_(find_choice(key)) {
        if (choice_ != nullptr || find_parameter(key) != nullptr) return;
        // Once for all points: they must not meet different effects of one name.
        own_ = find_user_key(key);
        if (own_) return;
        const bool effect = key.starts_with("effects.");
        throw std::invalid_argument(
            key + ": there is no such key" +
            (effect ? "; an effect of your own has to be registered in this process too" : ""));
    }

    void operator()(Scenario& scenario, double value) const {
        if (own_) {
            set_parameter(scenario, *own_, value);
            return;
        }
        if (choice_ == nullptr) {
            set_parameter(scenario, key_, value);
            return;
        }
        if (!(value >= 0.0 && value < static_cast<double>(choice_->allowed.size()))) {
            throw std::invalid_argument(key_ + ": there is no word with this index");
        }
        choice_->set(scenario, static_cast<std::size_t>(value));
    }

private:
    std::string key_;
    const Choice* choice_;
    std::optional<UserKey> own_;
};

}  // namespace

std::vector<SweepPoint> sweep(const Scenario& base, const std::vector<std::string>& keys,
                              const std::vector<double>& values, int threads, RunControl& control,
                              const std::function<void()>& poll) {
    const std::vector<PointSetter> setters(keys.begin(), keys.end());
    if (keys.empty() || values.size() % keys.size() != 0) {
        throw std::invalid_argument("a sweep needs a row of one value a key for each point");
    }
    std::vector<SweepPoint> points(values.size() / keys.size());
    const auto scenario_of = [&](std::size_t index) -> std::optional<Scenario> {
        Scenario scenario = base;
        scenario.record = {};
        try {
            for (std::size_t k = 0; k < keys.size(); ++k) {
                setters[k](scenario, values[index * keys.size() + k]);
            }
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
