#pragma once

#include <functional>
#include <memory>

#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// Rates of one phase for ARKODE.
struct ArkodeProblem {
    int dimension = 0;
    /// Right-hand side; ArkodeSession::step and interpolate throw on what it throws.
    std::function<void(double t, const double* y, double* dydt)> rates;
};

/// One integration by SUNDIALS ERKStep; hides the C interface of SUNDIALS 6 and 7. Throws
/// std::runtime_error if SUNDIALS refuses to be set up.
class ArkodeSession {
public:
    ArkodeSession(const ArkodeProblem& problem, double t, const double* y, const double* tolerance,
                  double t_stop, double max_step, double first_step);
    ~ArkodeSession();
    ArkodeSession(const ArkodeSession&) = delete;
    ArkodeSession& operator=(const ArkodeSession&) = delete;

    struct Outcome {
        double time = 0.0;
        bool failed = false;
    };
    /// One internal step.
    Outcome step(double t, double* y);

    /// Coordinates at a time within the last step.
    void interpolate(double t, double* y) const;

    void add_counts(StepCounts& counts) const;

private:
    struct Handles;
    std::unique_ptr<Handles> handles_;
    double t_stop_;
    int dimension_;
};

}  // namespace stickslip
