#include "stickslip/batch/lanes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <deque>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "stickslip/contact/phases.hpp"

namespace stickslip {

const std::vector<LaneKernels>& all_lane_kernels() {
    static const std::vector<LaneKernels> all = [] {
        std::vector<LaneKernels> result;
#ifdef STICKSLIP_X86_KERNELS
        if (__builtin_cpu_supports("avx2")) result.push_back(lane_kernels_of<4>());
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
            __builtin_cpu_supports("avx512vl")) {
            result.push_back(lane_kernels_of<8>());
        }
#endif
        return result;
    }();
    return all;
}

namespace {

/// The widest pack that the environment variable STICKSLIP_LANES allows.
int widest_allowed() {
    const char* text = std::getenv("STICKSLIP_LANES");
    if (text == nullptr) return std::numeric_limits<int>::max();
    for (const int width : {1, 4, 8}) {
        if (text == std::to_string(width)) return width;
    }
    throw std::invalid_argument("STICKSLIP_LANES = " + std::string(text) +
                                ": allowed is 1, 4 or 8");
}

}  // namespace

const LaneKernels& lane_kernels() {
    static const LaneKernels chosen = [] {
        const int widest = widest_allowed();
        LaneKernels result = {1};
        for (const LaneKernels& each : all_lane_kernels()) {
            if (each.size <= widest) result = each;
        }
        return result;
    }();
    return chosen;
}

namespace {

/// The pack of the runs that are in one kind of phase, all with named effects or all without, and
/// those that wait for a place in it.
template <class Phase, bool kEffects>
class PhasePack {
public:
    PhasePack(int size, const LaneKernel<Phase, kEffects>& kernel)
        : size_(static_cast<std::size_t>(size)), kernel_(kernel) {}

    std::size_t count() const { return filled_ + waiting_.size(); }
    void add(Lane& lane) { waiting_.push_back(&lane); }

    /// One step of all runs of the pack. `leave(lane)` is called for a run whose phase has ended,
    /// `end(lane)` for one that is over. With `stay`, a run keeps its place where only the segment
    /// of voltage has ended.
    void step(const auto& leave, const auto& end, bool stay) {
        fill();
        const LaneRound round = kernel_.step(memory_.data());
        for (std::size_t place = 0; place < size_; ++place) {
            if (!(round.flagged >> place & 1u) || places_[place] == nullptr) continue;
            Lane& lane = *places_[place];
            const Finish found = finish(lane, place, round.to_end >> place & 1u);
            if (found == Finish::step) continue;
            const bool same = stay && found == Finish::segment;
            const bool over = same && !lane.run.next_phase();
            if (same && !over) {
                enter(lane, place);
                continue;
            }
            places_[place] = nullptr;
            --filled_;
            over ? end(lane) : leave(lane);
        }
    }

private:
    using Numbers = LaneNumbers<Phase, kEffects>;
    static constexpr std::size_t kMostPlaces = 8;

    void fill() {
        for (std::size_t place = 0; place < size_ && !waiting_.empty(); ++place) {
            if (places_[place] != nullptr) continue;
            places_[place] = waiting_.front();
            waiting_.pop_front();
            ++filled_;
            enter(*places_[place], place);
        }
    }

    // Puts what its next phase begins with into the place.
    void enter(Lane& lane, std::size_t place) {
        auto& player = lane.run.player();
        player.with_phase([&](auto phase) {
            if constexpr (std::is_same_v<decltype(phase), Phase>) {
                Numbers numbers;
                numbers.progress =
                    lane.run.tsit5().begin(phase, player.memory(), player.tau(),
                                           player.segment().duration, phase.begin(player.body()));
                numbers.progress.look = lane.run.next_look();
                numbers.robot = player.dynamics().robot();
                set_around(numbers, player.dynamics());
                numbers.contact_x = phase.contact(numbers.progress.step.first)[0];
                numbers.slip = player.state().mode.slip;
                numbers.workspace = player.dynamics().field().workspace();
                set_memory(numbers, player.memory());
                kernel_.put_beginning(memory_.data(), place, numbers);
            }
        });
    }

    static void set_around(Numbers& numbers, const Dynamics& dynamics) {
        const LocalField& field = dynamics.field();
        numbers.field = field.segment();
        if constexpr (kEffects) {
            numbers.named = {{field.further(1), field.further(2)}, dynamics.smooth_effects()};
        }
    }

    static void set_memory(Numbers& numbers, const PhaseMemory& memory) {
        for (std::size_t i = 0; i < Phase::kEvents; ++i) {
            numbers.unarmed[i] = memory.armed[i] ? 0.0 : 1.0;
        }
        numbers.stalled = memory.stalled ? 1.0 : 0.0;
    }

    // What an attempt comes to; after a segment of voltage the phase goes on.
    enum class Finish { step, segment, phase };

    // What only one run can do: accepts the attempt or not, looks for events.
    Finish finish(Lane& lane, std::size_t place, bool to_end) {
        Run& run = lane.run;
        auto& player = run.player();
        Numbers numbers;
        kernel_.take_attempt(memory_.data(), place, numbers);
        for (std::size_t i = 0; i < Phase::kEvents; ++i) {
            player.memory().armed[i] = numbers.unarmed[i] == 0.0;
        }
        const auto centre = [&] { return player.dynamics().field().centre(); };
        const auto before = centre();
        Finish found = Finish::step;
        player.with_phase([&](auto phase) {
            if constexpr (std::is_same_v<decltype(phase), Phase>) {
                PhaseEnd<Phase> end;
                if (!run.tsit5().finish(phase, player.memory(), numbers.progress, to_end,
                                        run.observer(phase), end)) {
                    return;
                }
                const bool goes_on = end.status == Status::ok && end.event == Event::none;
                found = goes_on ? Finish::segment : Finish::phase;
                run.end_phase(phase, end, run.tsit5().counts().accepted);
            }
        });
        if (found == Finish::step) {
            numbers.progress.look = run.next_look();
            set_memory(numbers, player.memory());
            kernel_.put_going_on(memory_.data(), place, numbers);
            if (centre() != before) {
                set_around(numbers, player.dynamics());
                kernel_.put_around(memory_.data(), place, numbers);
            }
        }
        return found;
    }

    std::size_t size_;
    LaneKernel<Phase, kEffects> kernel_;
    std::array<Lane*, kMostPlaces> places_ = {};
    std::size_t filled_ = 0;
    std::deque<Lane*> waiting_;
    // Zero where nothing was written yet: an empty place computes too, and nobody looks.
    alignas(64) std::array<std::byte, kMostPlaces * sizeof(Numbers)> memory_ = {};
};

/// The packs of runs with named effects, or of those without.
template <bool kEffects>
class PhasePacks {
public:
    PhasePacks(int size, const LaneKernels::Phases<kEffects>& kernels)
        : stick_(size, kernels.corner_stick),
          slip_(size, kernels.corner_slip),
          flight_(size, kernels.flight) {}

    auto& of(const CornerStickPhase&) { return stick_; }
    auto& of(const CornerSlipPhase&) { return slip_; }
    auto& of(const FlightPhase&) { return flight_; }
    void each(const auto& use) {
        use(stick_);
        use(slip_);
        use(flight_);
    }

private:
    PhasePack<CornerStickPhase, kEffects> stick_;
    PhasePack<CornerSlipPhase, kEffects> slip_;
    PhasePack<FlightPhase, kEffects> flight_;
};

/// The runs of a thread, each in the pack of its phase.
class LaneGroup {
public:
    LaneGroup(const LaneKernels& kernels, std::size_t most, const std::function<void(Lane&)>& done)
        : done_(done),
          has_packs_(kernels.size > 1 && most >= kLeast),
          plain_(kernels.size, kernels.plain),
          extended_(kernels.size, kernels.extended) {}

    std::size_t size() const { return lanes_.size(); }
    /// No run will follow those that are here.
    void set_last() { is_last_ = true; }

    void start(Lane& lane) {
        if (!has_packs_ || !lane.run.fits_packs()) {
            lane.run.go();
            done_(lane);
            return;
        }
        lanes_.push_back(&lane);
        play(lane);
    }

    /// Ends all runs where they are.
    void interrupt() {
        for (Lane* lane : lanes_) {
            lane->run.give_up(Status::interrupted);
            done_(*lane);
        }
        lanes_.clear();
    }

    /// One step of the fullest pack.
    void step() {
        const auto leave = [this](Lane& lane) { play(lane); };
        const auto end = [this](Lane& lane) { this->end(lane); };
        std::size_t most = 0;
        const auto each_pack = [this](const auto& use) {
            plain_.each(use);
            extended_.each(use);
        };
        each_pack([&](auto& pack) { most = std::max(most, pack.count()); });
        bool found = false;
        each_pack([&](auto& pack) {
            if (found || pack.count() < most) return;
            found = true;
            pack.step(leave, end, !is_few());
        });
    }

private:
    // Plays a run up to its next phase that a pack can have, or to its end.
    void play(Lane& lane) {
        while (lane.run.next_phase()) {
            bool added = false;
            lane.run.player().with_phase([&](auto phase) {
                if constexpr (requires { plain_.of(phase); }) {
                    if (!is_few()) {
                        lane.run.is_plain() ? plain_.of(phase).add(lane)
                                            : extended_.of(phase).add(lane);
                        added = true;
                    }
                }
                if (!added) lane.run.play_phase();
            });
            if (added) return;
        }
        end(lane);
    }

    void end(Lane& lane) {
        std::erase(lanes_, &lane);
        done_(lane);
    }

    // Whether so few runs are left that they are quicker one by one.
    bool is_few() const { return is_last_ && lanes_.size() < kLeast; }

    const std::function<void(Lane&)>& done_;
    // Fewer runs are quicker one by one: a step of a pack costs as much as those of two or three.
    static constexpr std::size_t kLeast = 4;
    bool has_packs_;
    bool is_last_ = false;
    std::vector<Lane*> lanes_;
    PhasePacks<false> plain_;
    PhasePacks<true> extended_;
};

}  // namespace

void play_in_lanes(const LaneKernels& kernels, std::size_t count,
                   const std::function<Lane*()>& next, const std::function<void(Lane&)>& done,
                   const RunControl& control) {
    LaneGroup group(kernels, count, done);
    bool more = true;
    while (!control.stop.load(std::memory_order_relaxed)) {
        if (more && group.size() < count) {
            Lane* lane = next();
            more = lane != nullptr;
            if (more)
                group.start(*lane);
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
