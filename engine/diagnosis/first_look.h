// Every effect at every place that the record can show, run beside the null at the size that the record asks for, and those that
// promise most fitted once, cheaply: which share of what the null leaves they remove.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "diagnosis/conduct.h"
#include "diagnosis/contestant.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/policy.h"
#include "diagnosis/trial.h"

namespace dynoproof::diagnosis {

struct Looked {
  /// Those that remove most first; then those that were not fitted, at what they promise.
  std::vector<Contestant> ranked;
  std::vector<NotTestable>
      silent;  // at no size that was tried do they move an output so that it shows beside the noise
};

/// A first look may be restricted: to some candidates, to fits of the most promising, to one level, to those before one leaves nothing but
/// noise in the free run. What else does so moves the outputs as that one does, and is found as its twin.
struct Scope {
  std::function<bool(const Trial&)> takes = [](const Trial&) { return true; };
  std::size_t most_fits = policy::kLookedAtMost;
  std::size_t levels = 2;
  bool until_exact = false;
};

/// On top of the null, at `level` and the next one; where the conduct ends it, of those that were looked at by then. The null
/// holds at `level`. `magnitudes`: of the first record.
Looked FirstLook(const Contestant& null, const Levels& levels, std::size_t level, const Magnitudes& magnitudes,
                 const Registry& registry, const Conduct& conduct, const Scope& scope = {});

/// A cheap fit of a model on top of the null, from these values at `level` and at as many levels as follow up to `count`; not there where it
/// has removed next to nothing and promises no more (`next`: Sketch::next). Its rows are dropped.
Contestant FitOnce(const estimation::Hypothesis& model, Eigen::VectorXd from, const Contestant& null,
                   const Levels& levels, std::size_t level, std::size_t count, std::optional<double> next = {});

}  // namespace dynoproof::diagnosis
