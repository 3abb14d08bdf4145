#include "score/nrmse.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/within.h"

namespace dynoproof::score {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

struct Errors {
  double rms = 0.0, max = 0.0, max_time_s = 0.0;
};

Errors ErrorsOf(const Series& reference, std::span<const double> test) {
  Errors errors;
  std::vector<double> difference(test.size());
  errors.max_time_s = reference.time_s.front();
  for (std::size_t i = 0; i < test.size(); ++i) {
    difference[i] = test[i] - reference.values[i];
    if (std::abs(difference[i]) > errors.max) {
      errors.max = std::abs(difference[i]);
      errors.max_time_s = reference.time_s[i];
    }
  }
  errors.rms = RootMeanSquare(difference);
  return errors;
}

bool IsConstant(std::span<const double> values) {
  double span = 0.0;
  for (double v : values) span = std::max(span, std::abs(v - values.front()));
  return span <= 4.0 * kEps * Largest(values);
}

bool Bad(double limit) { return !std::isfinite(limit) || limit < 0.0; }

}  // namespace

NrmseResult Nrmse(const Series& reference, const Series& test, const NrmseOptions& options) {
  NrmseResult result;
  if (Bad(options.limit) || Bad(options.constant_limit) || Bad(options.nominal)) {
    result.reason = "nrmse: a limit or the nominal is negative or not finite";
    return result;
  }
  const Aligned aligned = AlignTo(reference, test, options.max_gap_s);
  result.reason = aligned.reason;
  if (!aligned.ok()) return result;

  const Errors errors = ErrorsOf(reference, aligned.test);
  result.rms_error = errors.rms;
  result.max_error = errors.max;
  result.max_error_time_s = errors.max_time_s;
  if (IsConstant(reference.values)) {
    const double allowed = options.constant_limit * options.nominal;
    if (allowed > 0.0 && Within(errors.max, allowed)) {
      result.verdict = Verdict::kPass;
    } else {
      result.reason = fmt::format(
          "the reference is constant, so NRMSE is not defined; largest error {:.6g} at {:.6g} s, {:.6g} allowed",
          errors.max, errors.max_time_s, allowed);
    }
    return result;
  }
  result.nrmse = errors.rms / StandardDeviation(reference.values);
  if (Within(*result.nrmse, options.limit)) {
    result.verdict = Verdict::kPass;
  } else {
    result.reason = fmt::format("NRMSE {:.6g} exceeds {:.6g}; largest error {:.6g} at {:.6g} s", *result.nrmse,
                                options.limit, errors.max, errors.max_time_s);
  }
  return result;
}

Check NrmseCheck(const NrmseResult& result, const NrmseOptions& options, std::string name, std::string origin) {
  if (result.ok() && !result.nrmse)
    return ToCheck(result, std::move(name), "nrmse", result.max_error / options.nominal, options.constant_limit,
                   "of the nominal", std::move(origin));
  return ToCheck(result, std::move(name), "nrmse", result.nrmse.value_or(std::numeric_limits<double>::quiet_NaN()),
                 options.limit, "1", std::move(origin));
}

MaxErrorResult MaxError(const Series& reference, const Series& test, double nominal, double limit, double max_gap_s) {
  MaxErrorResult result;
  if (!(nominal > 0.0) || !std::isfinite(nominal) || Bad(limit)) {
    result.reason = "max error: needs a positive nominal and a limit that is finite and not negative";
    return result;
  }
  const Aligned aligned = AlignTo(reference, test, max_gap_s);
  result.reason = aligned.reason;
  if (!aligned.ok()) return result;
  const Errors errors = ErrorsOf(reference, aligned.test);
  result.relative_error = errors.max / nominal;
  result.time_s = errors.max_time_s;
  if (Within(result.relative_error, limit)) {
    result.verdict = Verdict::kPass;
  } else {
    result.reason = fmt::format("largest error {:.6g} of the nominal at {:.6g} s, {:.6g} allowed",
                                result.relative_error, result.time_s, limit);
  }
  return result;
}

}  // namespace dynoproof::score
