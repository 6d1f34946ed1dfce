#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <initializer_list>
#include <type_traits>
#include <vector>

#include "stickslip/batch/lanes.hpp"

namespace stickslip {

/// The pack of the runs that are in one kind of phase, all with named effects or all without, and
/// those that wait for a place in it.
template <template <class> class PhaseOf, bool kEffects>
class PhasePack {
public:
    using Phase = PhaseOf<Dynamics>;

    PhasePack(int size, LaneKernels::Step kernel)
        : size_(static_cast<std::size_t>(size)), kernel_(kernel), places_(size_, nullptr) {}

    std::size_t count() const { return filled_ + waiting_.size(); }
    void add(Lane& lane) { waiting_.push_back(&lane); }

    /// One step of all runs of the pack. `leave(lane)` is called for a run whose phase has ended,
    /// `end(lane)` for one that is over. With `stay`, a run keeps its place where only the stretch
    /// of voltage has ended.
    void step(const std::function<void(Lane&)>& leave, const std::function<void(Lane&)>& end,
              bool stay) {
        fill();
        const LaneRound round = kernel_(memory_.data());
        for (std::size_t place = 0; place < size_; ++place) {
            if (!(round.flagged >> place & 1u) || places_[place] == nullptr) continue;
            Lane& lane = *places_[place];
            const Finish found = finish(lane, place, round.to_end >> place & 1u);
            if (found == Finish::step) continue;
            const bool same = stay && found == Finish::stretch;
            const bool over = same && !lane.loop.next_phase();
            if (same && !over) {
                enter(lane, place, {kBegin, kStartEvents, kOnward});
                continue;
            }
            places_[place] = nullptr;
            --filled_;
            over ? end(lane) : leave(lane);
        }
    }

private:
    using Loop = Lane::Loop;
    using N = LaneNumbers<PhaseOf, Dynamics, kEffects>;
    static constexpr std::size_t kNumbers = sizeof(N) / sizeof(double);
    static constexpr std::size_t kMostPlaces = 8;

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
    // What changes as a phase goes on over the next stretch.
    static constexpr Range kBegin =
        between(0, offsetof(N, progress.step.slope) + sizeof(typename Phase::State));
    static constexpr Range kOnward = between(offsetof(N, field), sizeof(N));
    static constexpr Range kCentre = between(offsetof(N, field.centre_x), offsetof(N, field.rate));
    static constexpr Range kField = between(offsetof(N, field), offsetof(N, contact_x));
    static constexpr Range kUnarmed = between(offsetof(N, unarmed), sizeof(N));

    void fill() {
        for (std::size_t place = 0; place < size_ && !waiting_.empty(); ++place) {
            if (places_[place] != nullptr) continue;
            Lane& lane = *waiting_.front();
            waiting_.pop_front();
            enter(lane, place, {kAll});
            places_[place] = &lane;
            ++filled_;
        }
    }

    // Writes the ranges of the numbers that its next phase begins with.
    void enter(Lane& lane, std::size_t place, std::initializer_list<Range> ranges) {
        Loop& loop = lane.loop;
        loop.player().with_phase([&](auto phase) {
            if constexpr (std::is_same_v<decltype(phase), Phase>) {
                N numbers;
                numbers.progress = loop.tsit5().begin(
                    phase, loop.player().memory(), loop.player().tau(),
                    loop.player().segment().duration, phase.begin(loop.player().body()));
                numbers.progress.look = loop.next_look();
                numbers.robot = loop.player().dynamics().robot();
                set_field(numbers, loop.player().dynamics());
                numbers.contact_x = phase.contact_x(numbers.progress.step.first);
                numbers.slip = loop.player().state().mode.slip;
                numbers.workspace = loop.player().dynamics().field().workspace();
                set_memory(numbers, loop.player().memory());
                write(numbers, place, ranges);
            }
        });
    }

    // The field, and the effects that may be on it.
    static void set_field(N& numbers, const Dynamics& dynamics) {
        numbers.field = dynamics.field().stretch();
        if constexpr (kEffects) {
            const LocalField& field = dynamics.field();
            numbers.named = {{field.further(1), field.further(2)}, dynamics.smooth_effects()};
        }
    }

    static void set_memory(N& numbers, const PhaseMemory& memory) {
        for (std::size_t i = 0; i < Phase::kEvents; ++i) {
            numbers.unarmed[i] = memory.armed[i] ? 0.0 : 1.0;
        }
        numbers.stalled = memory.stalled ? 1.0 : 0.0;
    }

    // What an attempt comes to; after a stretch of voltage the phase goes on.
    enum class Finish { step, stretch, phase };

    // What only one run can do: accepts the attempt or not, looks for events.
    Finish finish(Lane& lane, std::size_t place, bool to_end) {
        Loop& loop = lane.loop;
        N numbers = read(place, {kProgress, kCentre, kUnarmed});
        for (std::size_t i = 0; i < Phase::kEvents; ++i) {
            loop.player().memory().armed[i] = numbers.unarmed[i] == 0.0;
        }
        Finish found = Finish::step;
        loop.player().with_phase([&](auto phase) {
            if constexpr (std::is_same_v<decltype(phase), Phase>) {
                PhaseEnd<Phase> end;
                if (!loop.tsit5().finish(phase, loop.player().memory(), numbers.progress, to_end,
                                         loop.observer(phase), end)) {
                    go_on(loop, numbers, place);
                    return;
                }
                const bool goes_on = end.status == Status::ok && end.event == Event::none;
                found = goes_on ? Finish::stretch : Finish::phase;
                loop.end_phase(phase, end);
            }
        });
        return found;
    }

    void go_on(Loop& loop, N& numbers, std::size_t place) {
        const FieldStretch<double>& field = loop.player().dynamics().field().stretch();
        numbers.progress.look = loop.next_look();
        set_memory(numbers, loop.player().memory());
        write(numbers, place, {kState, kStart, kStartEvents, kUnarmed});
        if (field.centre_x != numbers.field.centre_x || field.centre_z != numbers.field.centre_z) {
            set_field(numbers, loop.player().dynamics());
            write(numbers, place, {kField});
        }
    }

    void write(const N& numbers, std::size_t place, std::initializer_list<Range> ranges) {
        const auto* values = reinterpret_cast<const double*>(&numbers);
        double* to = memory_.data() + place;
        for (const Range& range : ranges) {
#pragma GCC unroll 8
            for (std::size_t k = range.begin; k < range.end; ++k) to[k * size_] = values[k];
        }
    }
    N read(std::size_t place, std::initializer_list<Range> ranges) const {
        N numbers;
        auto* to = reinterpret_cast<double*>(&numbers);
        const double* from = memory_.data() + place;
        for (const Range& range : ranges) {
#pragma GCC unroll 8
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

}  // namespace stickslip
