#include "sim/integrators.h"

#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <sundials/sundials_context.hpp>

#include "sim/vector_operations.h"

namespace dynoproof {
namespace {

struct VectorDeleter {
  void operator()(N_Vector vector) const { N_VDestroy(vector); }
};
using VectorPtr = std::unique_ptr<std::remove_pointer_t<N_Vector>, VectorDeleter>;

std::span<double> Values(N_Vector vector) {
  return {N_VGetArrayPointer(vector), static_cast<std::size_t>(N_VGetLength(vector))};
}

int Rates(realtype time, N_Vector states, N_Vector rates, void* user) {
  const auto& problem = *static_cast<OdeProblem*>(user);
  problem.rates(time, Values(states), Values(rates));
  // A non-finite rate is recoverable for SUNDIALS: it tries a smaller step, and fails by itself if that does not help.
  const auto bad = [](double rate) { return !std::isfinite(rate); };
  return std::any_of(Values(rates).begin(), Values(rates).end(), bad) ? 1 : 0;
}

int Guards(realtype time, N_Vector states, realtype* values, void* user) {
  const auto& problem = *static_cast<OdeProblem*>(user);
  problem.guards(time, Values(states), {values, static_cast<std::size_t>(problem.guard_count)});
  return 0;
}

/// SUNDIALS prints its warnings; they come back as return codes, and library code does not print.
void Silence(int, const char*, const char*, char*, void*) {}

/// Whether a call of SUNDIALS succeeded. Its want of memory is not the problem's fault: who looks for a number by many runs
/// would take it for a plant that cannot be simulated, and end elsewhere.
bool Succeeded(int flag) {
  static_assert(ARK_MEM_FAIL == CV_MEM_FAIL);
  if (flag == ARK_MEM_FAIL) throw std::bad_alloc();
  return flag >= 0;
}

template <class T>
T* Made(T* object) {
  if (object == nullptr) throw std::bad_alloc();
  return object;
}

/// What both integrators share: the context, the vectors, the course of Evolve.
class SundialsIntegrator : public Integrator {
 public:
  explicit SundialsIntegrator(OdeProblem problem) : problem_(std::move(problem)), roots_(problem_.guard_count) {
    const auto n = static_cast<sunindextype>(problem_.absolute_tolerance.size());
    states_.reset(Made(N_VNew_Serial(n, context_)));
    UseOwnOperations(states_.get());
    tolerance_.reset(Made(N_VNew_Serial(n, context_)));
    std::copy(problem_.absolute_tolerance.begin(), problem_.absolute_tolerance.end(), Values(tolerance_.get()).begin());
  }

  Status Restart(double time_s, std::span<const double> states) override {
    std::copy(states.begin(), states.end(), Values(states_.get()).begin());
    ++restarts_;
    return Check(DoRestart(time_s), "restart", time_s);
  }

  Status Evolve(double end_s, double& time_s, std::span<double> states, std::vector<int>& roots) override {
    roots.clear();
    const int result = DoEvolve(end_s, time_s);
    if (Status failed = Check(result, "step", time_s)) return failed;
    std::copy_n(Values(states_.get()).begin(), states.size(), states.begin());
    if (result != kRootReturn) {
      time_s = end_s;
      return {};
    }
    DoGetRoots(roots_.data());
    for (int i = 0; i < problem_.guard_count; ++i) {
      if (roots_[i] != 0) roots.push_back(i);
    }
    return {};
  }

 protected:
  static constexpr int kRootReturn = 2;  // CV_ROOT_RETURN and ARK_ROOT_RETURN
  static_assert(CV_ROOT_RETURN == kRootReturn && ARK_ROOT_RETURN == kRootReturn);

  virtual int DoRestart(double time_s) = 0;
  virtual int DoEvolve(double end_s, double& time_s) = 0;
  virtual int DoGetRoots(int* roots) = 0;
  virtual char* FlagName(long flag) const = 0;

  Status Check(int flag, const char* action, double time_s) const {
    if (Succeeded(flag)) return {};
    char* text = FlagName(flag);
    const std::string reason = text;
    std::free(text);
    return Failure{fmt::format("{}: the solver's {} failed ({})", name(), action, reason), "", time_s};
  }

  sundials::Context context_;
  OdeProblem problem_;
  VectorPtr states_, tolerance_;
  std::vector<int> roots_;
  std::int64_t restarts_ = 0;
};

class ExplicitIntegrator final : public SundialsIntegrator {
 public:
  using SundialsIntegrator::SundialsIntegrator;
  ~ExplicitIntegrator() override { ARKStepFree(&memory_); }

  bool Make() {
    memory_ = Made(ARKStepCreate(Rates, nullptr, 0.0, states_.get(), context_));
    return Succeeded(ARKStepSetErrHandlerFn(memory_, Silence, nullptr)) &&
           Succeeded(ARKStepSetUserData(memory_, &problem_)) &&
           Succeeded(ARKStepSetTableNum(memory_, ARKODE_DIRK_NONE, ARKODE_VERNER_8_5_6)) &&
           // Only the search for roots looks between steps; degree 1 is exact at their ends. The state at a root is the
           // interpolant's: degree 3 would cost more than the steps' own tolerance.
           Succeeded(ARKStepSetInterpolantDegree(memory_, problem_.guard_count > 0 ? 5 : 1)) &&
           Succeeded(ARKStepSVtolerances(memory_, problem_.relative_tolerance, tolerance_.get())) &&
           Succeeded(ARKStepSetMaxNumSteps(memory_, 1'000'000)) &&
           (problem_.max_step_s == 0.0 || Succeeded(ARKStepSetMaxStep(memory_, problem_.max_step_s))) &&
           Succeeded(ARKStepRootInit(memory_, problem_.guard_count, problem_.guard_count > 0 ? Guards : nullptr));
  }

  std::map<std::string, std::int64_t> counters() const override {
    long steps = 0, failed = 0, explicit_calls = 0, implicit_calls = 0;
    ARKStepGetNumSteps(memory_, &steps);
    ARKStepGetNumErrTestFails(memory_, &failed);
    ARKStepGetNumRhsEvals(memory_, &explicit_calls, &implicit_calls);
    return {{"steps", steps}, {"failed_steps", failed}, {"rate_calls", explicit_calls}, {"restarts", restarts_}};
  }
  std::string name() const override { return "ARKODE Verner 8(6)"; }

 protected:
  int DoRestart(double time_s) override {
    // The step that worked last is a good first one: a held input jumps, the plant's own frequencies stay.
    if (last_step_ > 0.0) ARKStepSetInitStep(memory_, last_step_);
    return ARKStepReset(memory_, time_s, states_.get());
  }
  int DoEvolve(double end_s, double& time_s) override {
    ARKStepSetStopTime(memory_, end_s);
    const int flag = ARKStepEvolve(memory_, end_s, states_.get(), &time_s, ARK_NORMAL);
    double next = 0.0;
    // The step proposed for the next time knows nothing of the stop time that cut the last one.
    if (flag >= 0 && ARKStepGetCurrentStep(memory_, &next) == 0 && next > 0.0) last_step_ = next;
    return flag;
  }
  int DoGetRoots(int* roots) override { return ARKStepGetRootInfo(memory_, roots); }
  char* FlagName(long flag) const override { return ARKStepGetReturnFlagName(flag); }

 private:
  void* memory_ = nullptr;
  double last_step_ = 0.0;
};

class BdfIntegrator final : public SundialsIntegrator {
 public:
  using SundialsIntegrator::SundialsIntegrator;
  ~BdfIntegrator() override {
    CVodeFree(&memory_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
  }

  bool Make() {
    const auto n = static_cast<sunindextype>(problem_.absolute_tolerance.size());
    memory_ = Made(CVodeCreate(CV_BDF, context_));
    matrix_ = Made(SUNDenseMatrix(n, n, context_));
    solver_ = Made(SUNLinSol_Dense(states_.get(), matrix_, context_));
    return Succeeded(CVodeSetErrHandlerFn(memory_, Silence, nullptr)) &&
           Succeeded(CVodeInit(memory_, Rates, 0.0, states_.get())) &&
           Succeeded(CVodeSetUserData(memory_, &problem_)) &&
           Succeeded(CVodeSVtolerances(memory_, problem_.relative_tolerance, tolerance_.get())) &&
           Succeeded(CVodeSetLinearSolver(memory_, solver_, matrix_)) &&
           Succeeded(CVodeSetMaxNumSteps(memory_, 1'000'000)) &&
           (problem_.max_step_s == 0.0 || Succeeded(CVodeSetMaxStep(memory_, problem_.max_step_s))) &&
           Succeeded(CVodeRootInit(memory_, problem_.guard_count, problem_.guard_count > 0 ? Guards : nullptr));
  }

  std::map<std::string, std::int64_t> counters() const override {
    const Counts now = Present();
    return {{"steps", total_.steps + now.steps},
            {"failed_steps", total_.failed + now.failed},
            {"rate_calls", total_.calls + now.calls},
            {"restarts", restarts_}};
  }
  std::string name() const override { return "CVODE BDF"; }

 protected:
  struct Counts {
    long steps = 0, failed = 0, calls = 0;
  };
  Counts Present() const {
    Counts counts;
    CVodeGetNumSteps(memory_, &counts.steps);
    CVodeGetNumErrTestFails(memory_, &counts.failed);
    CVodeGetNumRhsEvals(memory_, &counts.calls);
    return counts;
  }
  int DoRestart(double time_s) override {
    const Counts now = Present();  // CVodeReInit forgets them
    total_ = {total_.steps + now.steps, total_.failed + now.failed, total_.calls + now.calls};
    return CVodeReInit(memory_, time_s, states_.get());
  }
  int DoEvolve(double end_s, double& time_s) override {
    CVodeSetStopTime(memory_, end_s);
    return CVode(memory_, end_s, states_.get(), &time_s, CV_NORMAL);
  }
  int DoGetRoots(int* roots) override { return CVodeGetRootInfo(memory_, roots); }
  char* FlagName(long flag) const override { return CVodeGetReturnFlagName(flag); }

 private:
  void* memory_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  Counts total_;
};

template <class T>
Result<std::unique_ptr<Integrator>> MakeIntegrator(OdeProblem problem) {
  auto integrator = std::make_unique<T>(std::move(problem));
  if (!integrator->Make()) return Failure{"SUNDIALS refused the problem", integrator->name()};
  return std::unique_ptr<Integrator>(std::move(integrator));
}

}  // namespace

Result<std::unique_ptr<Integrator>> MakeExplicitIntegrator(OdeProblem problem) {
  return MakeIntegrator<ExplicitIntegrator>(std::move(problem));
}
Result<std::unique_ptr<Integrator>> MakeBdfIntegrator(OdeProblem problem) {
  return MakeIntegrator<BdfIntegrator>(std::move(problem));
}

}  // namespace dynoproof
