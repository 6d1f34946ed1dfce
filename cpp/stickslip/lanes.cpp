#include "stickslip/lanes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <initializer_list>
#include <memory>
#include <vector>

#include "stickslip/hybrid_loop.hpp"

namespace stickslip {
namespace {

using Loop = HybridLoop<Tsit5>;

template <template <class> class PhaseOf>
using Numbers = LaneNumbers<PhaseOf, Dynamics>;

/// A run among others.
struct Lane {
    Lane(const LaneTask& task, RunControl& control)
        : index(task.index), loop(task.scenario, &control) {}

    std::size_t index;
    Loop loop;
};

/// The pack of the runs that are in one kind of phase, and those that wait for a place in it.
template <template <class> class PhaseOf>
class PhasePack {
public:
    using Phase = PhaseOf<Dynamics>;

    PhasePack(int size, LaneKernels::Step kernel)
        : size_(static_cast<std::size_t>(size)), kernel_(kernel), places_(size_, nullptr) {}

    std::size_t count() const { return filled_ + waiting_.size(); }
    void add(Lane& lane) { waiting_.push_back(&lane); }

    /// One step of all runs of the pack. `leave(lane)` is called for a run whose phase has ended.
    void step(const std::function<void(Lane&)>& leave) {
        fill();
        const LaneRound round = kernel_(memory_.data());
        for (std::size_t place = 0; place < size_; ++place) {
            if (!(round.flagged >> place & 1u) || places_[place] == nullptr) continue;
            Lane& lane = *places_[place];
            const bool far = round.far >> place & 1u, to_end = round.to_end >> place & 1u;
            if (finish(lane, place, far, to_end)) {
                places_[place] = nullptr;
                --filled_;
                leave(lane);
            }
        }
    }

private:
    using N = Numbers<PhaseOf>;
    static constexpr std::size_t kNumbers = sizeof(N) / sizeof(double);
    static constexpr std::size_t kMostPlaces = 8;

    void fill() {
        for (std::size_t place = 0; place < size_ && !waiting_.empty(); ++place) {
            if (places_[place] != nullptr) continue;
            Lane& lane = *waiting_.front();
            waiting_.pop_front();
            enter(lane, place);
            places_[place] = &lane;
            ++filled_;
        }
    }

    void enter(Lane& lane, std::size_t place) {
        Loop& loop = lane.loop;
        loop.with_phase([&](auto phase) {
            if constexpr (std::is_same_v<decltype(phase), Phase>) {
                N numbers;
                numbers.progress = loop.integrator().begin(
                    phase, loop.memory(), loop.tau(), loop.tau_end(), phase.begin(loop.body()));
                numbers.robot = loop.dynamics().robot();
                numbers.field = loop.dynamics().field().stretch();
                numbers.contact_x = phase.contact_x(numbers.progress.step.first);
                numbers.slip = loop.slip();
                numbers.workspace = loop.dynamics().field().workspace();
                set_memory(numbers, loop.memory());
                write(numbers, place, {kAll});
            }
        });
    }

    static void set_memory(N& numbers, const PhaseMemory& memory) {
        for (std::size_t i = 0; i < Phase::kEvents; ++i) {
            numbers.unarmed[i] = memory.armed[i] ? 0.0 : 1.0;
        }
        numbers.stalled = memory.stalled ? 1.0 : 0.0;
    }

    // What only one run can do: accepts the attempt or not, looks for events. True if the phase has
    // ended.
    bool finish(Lane& lane, std::size_t place, bool far, bool to_end) {
        Loop& loop = lane.loop;
        N numbers = read(place, {kProgress, kBase, kCentre, kUnarmed});
        loop.dynamics().set_base(numbers.robot.base);
        for (std::size_t i = 0; i < Phase::kEvents; ++i) {
            loop.memory().armed[i] = numbers.unarmed[i] == 0.0;
        }
        bool ended = false;
        loop.with_phase([&](auto phase) {
            if constexpr (std::is_same_v<decltype(phase), Phase>) {
                if (far) numbers.progress.attempt(phase);
                PhaseEnd<Phase> end;
                ended = loop.integrator().finish(phase, loop.memory(), numbers.progress, to_end,
                                                 loop.observer(phase), end);
                if (ended)
                    loop.end_phase(phase, end);
                else
                    go_on(loop, numbers, place);
            }
        });
        return ended;
    }

    void go_on(Loop& loop, N& numbers, std::size_t place) {
        const FieldStretch<double>& field = loop.dynamics().field().stretch();
        numbers.robot.base = loop.dynamics().robot().base;
        set_memory(numbers, loop.memory());
        write(numbers, place, {kState, kStart, kStartEvents, kBase, kUnarmed});
        if (field.centre_x != numbers.field.centre_x || field.centre_z != numbers.field.centre_z) {
            numbers.field = field;
            write(numbers, place, {kField});
        }
    }

    /// The places of some numbers among all.
    struct Range {
        std::size_t begin, end;
    };
    static constexpr Range between(std::size_t from, std::size_t to) {
        return {from / sizeof(double), to / sizeof(double)};
    }
    static constexpr Range kAll = {0, kNumbers};
    static constexpr Range kState =
        between(offsetof(N, progress.tau), offsetof(N, progress.step.weight));
    static constexpr Range kProgress = between(0, offsetof(N, robot));
    static constexpr Range kStart =
        between(offsetof(N, progress.step.first),
                offsetof(N, progress.step.slope) + sizeof(typename Phase::State));
    static constexpr Range kStartEvents =
        between(offsetof(N, progress.samples.start), offsetof(N, progress.samples.end));
    static constexpr Range kBase = between(offsetof(N, robot.base), offsetof(N, field));
    static constexpr Range kCentre = between(offsetof(N, field.centre_x), offsetof(N, field.rate));
    static constexpr Range kField = between(offsetof(N, field), offsetof(N, contact_x));
    static constexpr Range kUnarmed = between(offsetof(N, unarmed), sizeof(N));

    void write(const N& numbers, std::size_t place, std::initializer_list<Range> ranges) {
        const auto* values = reinterpret_cast<const double*>(&numbers);
        double* to = memory_.data() + place;
        for (const Range& range : ranges) {
            for (std::size_t k = range.begin; k < range.end; ++k) to[k * size_] = values[k];
        }
    }
    N read(std::size_t place, std::initializer_list<Range> ranges) const {
        N numbers;
        auto* to = reinterpret_cast<double*>(&numbers);
        const double* from = memory_.data() + place;
        for (const Range& range : ranges) {
            for (std::size_t k = range.begin; k < range.end; ++k) to[k] = from[k * size_];
        }
        return numbers;
    }

    std::size_t size_;
    LaneKernels::Step kernel_;
    std::vector<Lane*> places_;
    std::size_t filled_ = 0;
    std::deque<Lane*> waiting_;
    // Zero where nothing was written yet: an empty place computes too, and nobody looks.
    alignas(64) std::array<double, kNumbers* kMostPlaces> memory_ = {};
};

class LaneGroup {
public:
    LaneGroup(const LaneKernels& kernels, std::size_t most,
              const std::function<void(std::size_t, RunResult&&)>& done)
        : done_(done),
          has_packs_(kernels.size > 1 && most >= kLeast),
          stick_(kernels.size, kernels.corner_stick),
          slip_(kernels.size, kernels.corner_slip),
          flight_(kernels.size, kernels.flight) {}

    std::size_t size() const { return lanes_.size(); }
    /// No run will follow those that are here.
    void set_last() { is_last_ = true; }

    void start(const LaneTask& task, RunControl& control) {
        if (!has_packs_ || task.scenario.solver.method != Method::tsit5) {
            done_(task.index, simulate(task.scenario, &control));
            return;
        }
        auto lane = std::make_unique<Lane>(task, control);
        if (!lane->loop.is_plain()) {
            done_(task.index, lane->loop.run());
            return;
        }
        lanes_.push_back(std::move(lane));
        play(*lanes_.back());
    }

    /// Ends all runs where they are.
    void interrupt() {
        for (const auto& lane : lanes_) {
            lane->loop.interrupt();
            done_(lane->index, lane->loop.take_result());
        }
        lanes_.clear();
    }

    /// One step of the fullest pack.
    void step() {
        const auto leave = [this](Lane& lane) { play(lane); };
        const std::size_t stick = stick_.count(), slip = slip_.count(), flight = flight_.count();
        if (stick >= slip && stick >= flight) {
            stick_.step(leave);
        } else if (slip >= flight) {
            slip_.step(leave);
        } else {
            flight_.step(leave);
        }
    }

private:
    // Plays a run up to its next phase that a pack can have, or to its end.
    void play(Lane& lane) {
        while (lane.loop.next_phase()) {
            bool added = false;
            lane.loop.with_phase([&](auto phase) {
                using Phase = decltype(phase);
                Loop& loop = lane.loop;
                constexpr bool kNever = std::is_same_v<Phase, FaceSlidePhase>;
                if (kNever || (is_last_ && lanes_.size() < kLeast)) {
                    loop.end_phase(phase, loop.integrator().advance(
                                              phase, loop.memory(), loop.tau(), loop.tau_end(),
                                              phase.begin(loop.body()), loop.observer(phase)));
                } else if constexpr (!kNever) {
                    pack_of(phase).add(lane);
                    added = true;
                }
            });
            if (added) return;
        }
        done_(lane.index, lane.loop.take_result());
        std::erase_if(lanes_, [&](const auto& each) { return each.get() == &lane; });
    }

    auto& pack_of(const CornerStickPhase&) { return stick_; }
    auto& pack_of(const CornerSlipPhase&) { return slip_; }
    auto& pack_of(const FlightPhase&) { return flight_; }

    const std::function<void(std::size_t, RunResult&&)>& done_;
    // Fewer runs are quicker one by one: a step of a pack costs as much as those of two or three.
    static constexpr std::size_t kLeast = 4;
    bool has_packs_;
    bool is_last_ = false;
    std::vector<std::unique_ptr<Lane>> lanes_;
    PhasePack<CornerStickPhaseOf> stick_;
    PhasePack<CornerSlipPhaseOf> slip_;
    PhasePack<FlightPhaseOf> flight_;
};

}  // namespace

void simulate_in_lanes(const LaneKernels& kernels, std::size_t count,
                       const std::function<std::optional<LaneTask>()>& next,
                       const std::function<void(std::size_t, RunResult&&)>& done,
                       RunControl& control) {
    LaneGroup group(kernels, count, done);
    bool more = true;
    while (!control.stop.load(std::memory_order_relaxed)) {
        if (more && group.size() < count) {
            const auto task = next();
            more = task.has_value();
            if (task)
                group.start(*task, control);
            else
                group.set_last();
        } else if (group.size() > 0) {
            group.step();
        } else {
            return;
        }
    }
    group.interrupt();
}

}  // namespace stickslip
