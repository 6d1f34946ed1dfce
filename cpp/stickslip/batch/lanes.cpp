#include "stickslip/batch/lanes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <type_traits>
#include <utility>

namespace stickslip {

namespace {

/// The pack of the runs that are in one kind of phase, all with named effects or all without, and
/// those that wait for a place in it.
template <class Phase, bool kEffects>
class PhasePack {
public:
    /// table: of the laws of all runs that it has.
    PhasePack(int size, const StepKernel<Phase, kEffects>& kernel, const LawTable& table)
        : size_(static_cast<std::size_t>(size)), kernel_(kernel), table_(&table) {}

    std::size_t count() const { return count_; }
    void add(Lane& lane) {
        waiting_.push_back(&lane);
        ++count_;
    }
    /// The table has become another.
    void put_laws() {
        for (std::size_t place = 0; place < size_; ++place) {
            if (places_[place] != nullptr) put_laws(place);
        }
    }

    /// One step of all runs of the pack. `leave(lane)` is called for a run whose phase has ended,
    /// `end(lane)` for one that is over. With `stay`, a run keeps its place where only the segment
    /// of voltage has ended.
    void step(const auto& leave, const auto& end, bool stay) {
        fill();
        const StepRound round = kernel_.step(memory_.data(), *table_, laws_.data());
        for (std::size_t place = 0; place < size_; ++place) {
            if (!(round.flagged >> place & 1u) || places_[place] == nullptr) continue;
            Lane& lane = *places_[place];
            const Attempt found = finish(lane, place, round.of(place));
            if (found == Attempt::step || found == Attempt::far_step) continue;
            const bool same = stay && found == Attempt::segment;
            const bool over = same && !lane.run.next_phase();
            if (same && !over) {
                enter(lane, place);
                continue;
            }
            places_[place] = nullptr;
            --count_;
            over ? end(lane) : leave(lane);
        }
    }

private:
    using Numbers = StepNumbers<Phase, kEffects>;
    using Attempt = Run::Attempt;
    static constexpr std::size_t kMostPlaces = 8;

    void fill() {
        for (std::size_t place = 0; place < size_ && !waiting_.empty(); ++place) {
            if (places_[place] != nullptr) continue;
            places_[place] = waiting_.front();
            waiting_.pop_front();
            if constexpr (kEffects) put_laws(place);
            enter(*places_[place], place);
        }
    }
    void put_laws(std::size_t place) {
        const auto put = [&](std::size_t i, double number) { laws_[i * size_ + place] = number; };
        places_[place]->run.player().model().laws.spread(*table_, put);
    }

    // Calls `use` with the phase of a run in this pack.
    static void with_phase(Lane& lane, auto&& use) {
        lane.run.player().with_phase([&](auto phase) {
            if constexpr (std::is_same_v<decltype(phase), Phase>) use(phase);
        });
    }

    // Puts what its next phase begins with into the place.
    void enter(Lane& lane, std::size_t place) {
        with_phase(lane, [&](Phase& phase) {
            Numbers numbers;
            lane.run.enter(phase, numbers);
            kernel_.put_beginning(memory_.data(), place, numbers);
        });
    }

    // Finishes the attempt of one run outside its pack: accepts it or not, looks for events.
    Attempt finish(Lane& lane, std::size_t place, const StepRound& round) {
        Attempt found = Attempt::step;
        with_phase(lane, [&](Phase& phase) {
            Numbers numbers;
            kernel_.take_attempt(memory_.data(), place, numbers);
            found = lane.run.finish(phase, numbers, round);
            if (found == Attempt::segment || found == Attempt::phase) return;
            kernel_.put_going_on(memory_.data(), place, numbers);
            if (found == Attempt::far_step) kernel_.put_around(memory_.data(), place, numbers);
        });
        return found;
    }

    std::size_t size_;
    StepKernel<Phase, kEffects> kernel_;
    const LawTable* table_;
    std::array<Lane*, kMostPlaces> places_ = {};
    std::size_t count_ = 0;
    std::deque<Lane*> waiting_;
    // Zero where nothing was written yet: an empty place computes too, and nobody looks.
    alignas(64) std::array<std::byte, kMostPlaces * sizeof(Numbers)> memory_ = {};
    alignas(64) std::array<double, kEffects ? kMostPlaces* kMostPackedLawNumbers : 0> laws_ = {};
};

/// The packs of runs with named effects, or of those without.
template <bool kEffects>
class PhasePacks {
public:
    PhasePacks(int size, const StepKernels::Phases<kEffects>& kernels, const LawTable& table)
        : stick_(size, kernels.corner_stick, table),
          slip_(size, kernels.corner_slip, table),
          flight_(size, kernels.flight, table) {}

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
    // Fewer runs are quicker one by one: a step of a pack costs as much as those of two or three.
    static constexpr std::size_t kLeast = 4;

    LaneGroup(const StepKernels& kernels, const std::function<void(Lane&)>& done)
        : done_(done),
          plain_(kernels.size, kernels.plain, table_),
          extended_(kernels.size, kernels.extended, table_) {}

    std::size_t size() const { return lanes_.size(); }
    /// No run will follow those that are here.
    void set_last() { is_last_ = true; }

    void start(Lane& lane) {
        if (!lane.run.fits_packs() || !take_laws(lane)) {
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
        std::size_t most = 0;
        const auto each_pack = [this](const auto& use) {
            plain_.each(use);
            extended_.each(use);
        };
        each_pack([&](const auto& pack) { most = std::max(most, pack.count()); });
        bool found = false;
        each_pack([&](auto& pack) {
            if (found || pack.count() < most) return;
            found = true;
            step(pack);
        });
    }

private:
    // Not inlined: it needs a large frame, and most packs are only asked for their count.
    [[gnu::noinline]] void step(auto& pack) {
        const auto leave = [this](Lane& lane) { play(lane); };
        const auto end = [this](Lane& lane) { this->end(lane); };
        pack.step(leave, end, !is_few());
    }

    // Whether the packs have room for the laws of a run, which they then have.
    bool take_laws(const Lane& lane) {
        const LawTable& table = lane.run.player().model().laws.table();
        if (table_.holds(table)) return true;
        if (!table_.merge(table, kMostPackedLawNumbers)) return false;
        extended_.each([](auto& pack) { pack.put_laws(); });
        return true;
    }

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
    bool is_last_ = false;
    std::vector<Lane*> lanes_;
    LawTable table_;  // of all runs that are here or were
    PhasePacks<false> plain_;
    PhasePacks<true> extended_;
};

}  // namespace

void play_in_lanes(const StepKernels& kernels, std::size_t count,
                   const std::function<Lane*()>& next, const std::function<void(Lane&)>& done,
                   const RunControl& control) {
    const auto goes_on = [&] { return !control.stop.load(std::memory_order_relaxed); };
    if (kernels.size == 1 || count < LaneGroup::kLeast) {  // without packs, which fill 100 kB
        for (Lane* lane; goes_on() && (lane = next()) != nullptr; done(*lane)) lane->run.go();
        return;
    }
    LaneGroup group(kernels, done);
    bool more = true;
    while (goes_on()) {
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
