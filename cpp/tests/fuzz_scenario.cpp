// Simulates one scenario that stands on standard input, a `key=value` a line, and prints its
// status. Built for the sanitizers, which end the program at what they find.
#include <charconv>
#include <iostream>
#include <sstream>
#include <string>

#include "stickslip/run/simulation.hpp"
#include "stickslip/scenario/parameters.hpp"

namespace {

using namespace stickslip;

// Unlike std::stod, takes numbers that are too small to be normal.
double number(const std::string& text) {
    double value = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

// "repeats;t xp xm yp ym clamp;t xp ...": one block.
VoltageProgram program_from(const std::string& text) {
    VoltageBlock block;
    std::istringstream points(text);
    std::string each;
    std::getline(points, each, ';');
    block.repeats = std::stoll(each);
    while (std::getline(points, each, ';')) {
        std::istringstream numbers(each);
        VoltagePoint point;
        numbers >> point.time;
        for (double& voltage : point.voltage) numbers >> voltage;
        block.points.push_back(point);
    }
    return VoltageProgram({block});
}

void set(Scenario& scenario, const std::string& key, const std::string& value) {
    if (key == "program") {
        scenario.program = program_from(value);
    } else if (key == "record.rate") {
        if (value == "none") return;
        const bool events = value == "events";
        scenario.record = {events ? RecordKind::events : RecordKind::uniform,
                           events ? 0.0 : number(value)};
    } else if (find_choice(key) != nullptr) {
        set_choice(scenario, key, value);
    } else {
        set_parameter(scenario, key, number(value));
    }
}

}  // namespace

int main() {
    Scenario scenario;
    for (std::string line; std::getline(std::cin, line);) {
        const std::size_t equals = line.find('=');
        set(scenario, line.substr(0, equals), line.substr(equals + 1));
    }
    const RunResult result = simulate(scenario);
    std::cout << row_of(result.status).name << ' ' << result.summary.mean_velocity << '\n';
}
