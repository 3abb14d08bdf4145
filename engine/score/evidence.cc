#include "score/evidence.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dynoproof::score {
namespace {

std::shared_ptr<Evidence> Begin(Compared compared, Evidence::Rule rule, double half_width) {
  auto evidence = std::make_shared<Evidence>();
  evidence->signal = std::move(compared.signal);
  evidence->unit = std::move(compared.unit);
  evidence->reference_name = std::move(compared.reference_name);
  evidence->test_name = std::move(compared.test_name);
  evidence->rule = rule;
  evidence->half_width = half_width;
  return evidence;
}

SharedEvidence Finish(std::shared_ptr<Evidence> evidence) {
  const std::vector<double>& distance = evidence->distance;
  evidence->worst = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
  const auto outside = std::find_if(distance.begin(), distance.end(), [](double d) { return !(d <= 1.0); });
  if (outside != distance.end()) evidence->first = static_cast<std::size_t>(outside - distance.begin());
  return evidence;
}

}  // namespace

SharedEvidence BandEvidence(Compared compared, Evidence::Rule rule, const Series& reference, const Series& test,
                            double half_width) {
  if (!(half_width > 0.0) || !std::isfinite(half_width)) return nullptr;
  Aligned aligned = AlignTo(reference, test);
  if (!aligned.ok()) return nullptr;
  const auto evidence = Begin(std::move(compared), rule, half_width);
  evidence->time_s.assign(reference.time_s.begin(), reference.time_s.end());
  evidence->reference.assign(reference.values.begin(), reference.values.end());
  evidence->test = std::move(aligned.test);
  for (std::size_t i = 0; i < evidence->test.size(); ++i) {
    evidence->lower.push_back(evidence->reference[i] - half_width);
    evidence->upper.push_back(evidence->reference[i] + half_width);
    evidence->distance.push_back(std::abs(evidence->test[i] - evidence->reference[i]) / half_width);
  }
  return Finish(evidence);
}

SharedEvidence TubeEvidence(Compared compared, const Series& reference, const TubeResult& result,
                            const TubeOptions& options) {
  if (result.time_s.empty()) return nullptr;
  const auto evidence =
      Begin(std::move(compared), Evidence::Rule::kEverySample, options.relative_width * options.nominal);
  evidence->time_s = result.time_s;
  evidence->reference = SampleAt(reference, result.time_s);
  evidence->test = result.test;
  evidence->lower = result.lower;
  evidence->upper = result.upper;
  evidence->distance = result.ratio;
  return Finish(evidence);
}

}  // namespace dynoproof::score
