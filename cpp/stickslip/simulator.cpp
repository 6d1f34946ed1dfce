#include "stickslip/simulator.hpp"

#include <bit>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "stickslip/assembly.hpp"
#include "stickslip/parameters.hpp"
#include "stickslip/tsit5.hpp"
#ifdef STICKSLIP_WITH_ARKODE
#include "stickslip/arkode.hpp"
#endif

namespace stickslip {
namespace {

static_assert(std::is_trivially_copyable_v<LoopMemory>);

/// What stands before the memory in the bytes of a snapshot.
struct Header {
    char magic[8] = {'s', 't', 'k', 's', 'l', 'i', 'p', '\0'};
    std::uint32_t version = 3;  // goes up with every change of LoopMemory
    std::uint32_t size = sizeof(LoopMemory);
    std::uint64_t scenario = 0;
};
static_assert(std::is_trivially_copyable_v<Header>);

/// FNV-1a.
class Hash {
public:
    void add(const void* data, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; ++i) {
            value_ = (value_ ^ bytes[i]) * 0x100000001b3ULL;
        }
    }
    void add(double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        add(&bits, sizeof bits);
    }
    void add(const std::string& text) { add(text.data(), text.size() + 1); }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace

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
    hash.add(turns(without_start(scenario)) ? 1.0 : 0.0);  // a map may say so
    return hash.value();
}

std::string SimulatorSnapshot::to_bytes() const {
    Header header;
    header.scenario = scenario;
    std::string result(sizeof header + sizeof memory, '\0');
    std::memcpy(result.data(), &header, sizeof header);
    std::memcpy(result.data() + sizeof header, &memory, sizeof memory);
    return result;
}

SimulatorSnapshot SimulatorSnapshot::from_bytes(const std::string& bytes) {
    const Header own;
    Header header;
    if (bytes.size() < sizeof header ||
        bytes.compare(0, sizeof own.magic, own.magic, sizeof own.magic) != 0) {
        throw std::invalid_argument("these bytes are no snapshot of a simulator");
    }
    std::memcpy(&header, bytes.data(), sizeof header);
    if (header.version != own.version) {
        throw std::invalid_argument("the snapshot is of version " + std::to_string(header.version) +
                                    ": allowed is version " + std::to_string(own.version));
    }
    if (header.size != own.size) {
        throw std::invalid_argument("the snapshot is of another kind of machine");
    }
    if (bytes.size() != sizeof header + own.size) {
        throw std::invalid_argument("the snapshot was cut, or something was added to it");
    }
    SimulatorSnapshot result;
    result.scenario = header.scenario;
    std::memcpy(&result.memory, bytes.data() + sizeof header, sizeof result.memory);
    return result;
}

/// Either integrator's loop.
struct Simulator::Runner {
    virtual ~Runner() = default;
    virtual void step(const PerCoil& voltages, double duration, bool linear,
                      const PerCoil* start) = 0;
    virtual double time() = 0;
    virtual SimulationState state() const = 0;
    virtual Status status() const = 0;
    virtual LoopMemory memory() const = 0;
    virtual void restore(const LoopMemory& memory) = 0;

    std::string failure;  // what to do about the last step, if it failed
};

template <class Integrator>
struct Simulator::RunnerOf : Simulator::Runner {
    explicit RunnerOf(const Scenario& given) : scenario(given) { begin(given); }

    void begin(const Scenario& from) {
        loop.emplace(from, nullptr);
        loop->play_steps([] {});
    }
    void step(const PerCoil& voltages, double duration, bool linear,
              const PerCoil* start) override {
        const bool turning = turns(scenario, voltages) || (start && turns(scenario, *start));
        if (!loop->in_whole_plane() && turning) {
            const PlaneHandover handover = loop->hand_over();
            const Scenario next = in_whole_plane(scenario, handover.state);
            check(next);  // before the loop that is there is given up
            begin(next);
            loop->take_over(handover);
        }
        loop->reset_counts();
        if (start) loop->steps().jump(*start);
        loop->steps().give(voltages.data(), 1, duration, linear);
        loop->go();
        if (loop->status() != Status::ok) failure = stickslip::message(loop->take_result());
    }
    double time() override { return status() == Status::ok ? loop->steps().time() : loop->time(); }
    SimulationState state() const override { return loop->state(); }
    Status status() const override { return loop->status(); }
    LoopMemory memory() const override { return loop->loop_memory(); }
    void restore(const LoopMemory& memory) override {
        if (memory.in_whole_plane != loop->in_whole_plane()) {
            // One plane may be left by the initial state alone, which a snapshot replaces.
            begin(memory.in_whole_plane ? in_whole_plane(scenario, {}) : without_start(scenario));
        }
        loop->restore(memory);
    }

    Scenario scenario;
    std::optional<HybridLoop<Integrator>> loop;
};

Simulator::Simulator(const Scenario& scenario) : fingerprint_(fingerprint(scenario)) {
    check(scenario);
    Scenario bare = scenario;
    bare.record = {};
    if (scenario.solver.method == Method::tsit5) {
        runner_ = std::make_shared<RunnerOf<Tsit5>>(bare);
        return;
    }
#ifdef STICKSLIP_WITH_ARKODE
    runner_ = std::make_shared<RunnerOf<Arkode>>(bare);
#else
    RunResult none;
    none.status = Status::no_arkode;
    throw std::invalid_argument(stickslip::message(none));
#endif
}

void Simulator::step(const PerCoil& voltages, double duration, bool linear,
                     const PerCoil* start) {
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
SimulatorSnapshot Simulator::snapshot() const {
    return {fingerprint_, runner_->memory()};
}

void Simulator::restore(const SimulatorSnapshot& snapshot) {
    if (snapshot.scenario != fingerprint_) {
        throw std::invalid_argument("the snapshot is of another scenario");
    }
    runner_->restore(snapshot.memory);
    runner_->failure.clear();
}

}  // namespace stickslip
