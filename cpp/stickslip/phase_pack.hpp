#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <initializer_list>
#include <type_traits>
#include <vector>

#include "stickslip/lanes.hpp"

namespace stickslip {

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
    using Loop = Lane::Loop;
    using N = LaneNumbers<PhaseOf, Dynamics>;
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

}  // namespace stickslip
