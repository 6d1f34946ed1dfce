#include "stickslip/batch/lanes.hpp"

#include <algorithm>
#include <type_traits>
#include <vector>

#include "stickslip/batch/phase_pack.hpp"
#include "stickslip/contact/face_slide.hpp"

namespace stickslip {
namespace {

/// The packs of runs with named effects, or of those without.
template <bool kEffects>
class PhasePacks {
public:
    PhasePacks(int size, const LaneKernels::Steps& steps)
        : stick_(size, steps.corner_stick),
          slip_(size, steps.corner_slip),
          flight_(size, steps.flight) {}

    void add(const CornerStickPhase&, Lane& lane) { stick_.add(lane); }
    void add(const CornerSlipPhase&, Lane& lane) { slip_.add(lane); }
    void add(const FlightPhase&, Lane& lane) { flight_.add(lane); }

    /// Runs of the fullest pack.
    std::size_t fullest() const {
        return std::max({stick_.count(), slip_.count(), flight_.count()});
    }
    /// One step of the fullest, see PhasePack::step.
    void step(const std::function<void(Lane&)>& leave, const std::function<void(Lane&)>& end,
              bool stay) {
        const std::size_t most = fullest();
        if (stick_.count() == most) {
            stick_.step(leave, end, stay);
        } else if (slip_.count() == most) {
            slip_.step(leave, end, stay);
        } else {
            flight_.step(leave, end, stay);
        }
    }

private:
    PhasePack<CornerStickPhaseOf, kEffects> stick_;
    PhasePack<CornerSlipPhaseOf, kEffects> slip_;
    PhasePack<FlightPhaseOf, kEffects> flight_;
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
        if (!has_packs_ || !lane.loop.fits_packs()) {
            lane.loop.go();
            done_(lane);
            return;
        }
        lanes_.push_back(&lane);
        play(lane);
    }

    /// Ends all runs where they are.
    void interrupt() {
        for (Lane* lane : lanes_) {
            lane->loop.give_up(Status::interrupted);
            done_(*lane);
        }
        lanes_.clear();
    }

    /// One step of the fullest pack.
    void step() {
        const auto leave = [this](Lane& lane) { play(lane); };
        const auto end = [this](Lane& lane) { this->end(lane); };
        const bool stay = !is_few();
        if (plain_.fullest() >= extended_.fullest()) {
            plain_.step(leave, end, stay);
        } else {
            extended_.step(leave, end, stay);
        }
    }

private:
    // Plays a run up to its next phase that a pack can have, or to its end.
    void play(Lane& lane) {
        while (lane.loop.next_phase()) {
            bool added = false;
            lane.loop.player().with_phase([&](auto phase) {
                using Phase = decltype(phase);
                Lane::Loop& loop = lane.loop;
                constexpr bool kNever = std::is_same_v<Phase, FaceSlidePhase> ||
                                        std::is_same_v<Phase, FaceRestPhase> || Phase::kTurns;
                if (kNever || is_few()) {
                    loop.play_phase();
                } else if constexpr (!kNever) {
                    loop.is_plain() ? plain_.add(phase, lane) : extended_.add(phase, lane);
                    added = true;
                }
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
