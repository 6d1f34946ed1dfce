#include "stickslip/solver/arkode_session.hpp"

#ifdef STICKSLIP_WITH_ARKODE

#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <string>

namespace stickslip {
namespace {

struct Callback {
    ArkodeProblem problem;
    std::exception_ptr failure;

    // An exception must not pass through the C code of SUNDIALS: it is kept, and thrown again on
    // the near side.
    int call(double t, const double* y, double* dydt) {
        try {
            problem.rates(t, y, dydt);
            return 0;
        } catch (...) {
            failure = std::current_exception();
            return -1;
        }
    }
    void rethrow() const {
        if (failure) std::rethrow_exception(failure);
    }
};

int rates_callback(sunrealtype t, N_Vector y, N_Vector dydt, void* data) {
    return static_cast<Callback*>(data)->call(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt));
}

void require(int flag, const char* what) {
    if (flag < 0) throw std::runtime_error(std::string("SUNDIALS ERKStep: ") + what + " failed");
}

}  // namespace

struct ArkodeSession::Handles {
    SUNContext context = nullptr;
    N_Vector y = nullptr;
    N_Vector tolerance = nullptr;
    N_Vector interpolated = nullptr;
    void* memory = nullptr;
    Callback callback;

    ~Handles() {
        if (memory) ERKStepFree(&memory);
        for (const N_Vector vector : {y, tolerance, interpolated}) {
            if (vector) N_VDestroy(vector);
        }
        if (context) SUNContext_Free(&context);
    }
};

ArkodeSession::ArkodeSession(const ArkodeProblem& problem, double t, const double* y,
                             const double* tolerance, double t_stop, double max_step,
                             double first_step)
    : handles_(std::make_unique<Handles>()), t_stop_(t_stop), dimension_(problem.dimension) {
    Handles& h = *handles_;
    h.callback.problem = problem;
#if SUNDIALS_VERSION_MAJOR >= 7
    require(SUNContext_Create(SUN_COMM_NULL, &h.context), "SUNContext_Create");
    SUNContext_ClearErrHandlers(h.context);
#else
    require(SUNContext_Create(nullptr, &h.context), "SUNContext_Create");
#endif
    h.y = N_VNew_Serial(dimension_, h.context);
    h.tolerance = N_VNew_Serial(dimension_, h.context);
    h.interpolated = N_VNew_Serial(dimension_, h.context);
    std::copy_n(y, dimension_, N_VGetArrayPointer(h.y));
    std::copy_n(tolerance, dimension_, N_VGetArrayPointer(h.tolerance));
    h.memory = ERKStepCreate(rates_callback, t, h.y, h.context);
    if (!h.memory) throw std::runtime_error("SUNDIALS ERKStep: ERKStepCreate failed");
    require(ERKStepSVtolerances(h.memory, 0.0, h.tolerance), "tolerances");
    require(ERKStepSetUserData(h.memory, &h.callback), "user data");
    require(ERKStepSetTableNum(h.memory, ARKODE_DORMAND_PRINCE_7_4_5), "table");
    require(ERKStepSetInterpolantDegree(h.memory, 5), "interpolant");
    require(ERKStepSetStopTime(h.memory, t_stop), "stop time");
    require(ERKStepSetInitStep(h.memory, std::min(first_step, t_stop - t)), "first step");
    require(ERKStepSetMaxNumSteps(h.memory, -1), "step limit");
    if (max_step > 0.0) require(ERKStepSetMaxStep(h.memory, max_step), "longest step");
#if SUNDIALS_VERSION_MAJOR < 7
    // An error is a status of the run, not a line on stderr.
    require(ERKStepSetErrFile(h.memory, nullptr), "error file");
#endif
}

ArkodeSession::~ArkodeSession() = default;

ArkodeSession::Outcome ArkodeSession::step(double t, double* y) {
    const Handles& h = *handles_;
    sunrealtype reached = t;
    const int flag = ERKStepEvolve(h.memory, t_stop_, h.y, &reached, ARK_ONE_STEP);
    h.callback.rethrow();
    Outcome outcome;
    outcome.time = reached;
    outcome.failed = flag < 0;
    std::copy_n(N_VGetArrayPointer(h.y), dimension_, y);
    return outcome;
}

void ArkodeSession::interpolate(double t, double* y) const {
    const Handles& h = *handles_;
    const int flag = ERKStepGetDky(h.memory, t, 0, h.interpolated);
    h.callback.rethrow();
    require(flag, "interpolation");
    std::copy_n(N_VGetArrayPointer(h.interpolated), dimension_, y);
}

void ArkodeSession::add_counts(StepCounts& counts) const {
    long int steps = 0, evaluations = 0, failures = 0;
    ERKStepGetNumSteps(handles_->memory, &steps);
    ERKStepGetNumRhsEvals(handles_->memory, &evaluations);
    ERKStepGetNumErrTestFails(handles_->memory, &failures);
    counts.accepted += steps;
    counts.rejected += failures;
    counts.evaluations += evaluations;
}

}  // namespace stickslip

#endif
