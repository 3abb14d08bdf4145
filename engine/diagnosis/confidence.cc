#include "diagnosis/confidence.h"

#include "diagnosis/confidence_cases.h"

namespace dynoproof::diagnosis {

std::optional<double> ConfidenceOf(Conclusion verdict, std::size_t effects) {
  constexpr int kEnough = 20;  // 19 of 20 could be 75 to 99.9 %
  for (const MadeCases& one : kMadeCases) {
    if (one.verdict == verdict && one.several == (effects > 1) && one.count >= kEnough)
      return (one.right + 0.5) / (one.count + 1.0);
  }
  return std::nullopt;
}

}  // namespace dynoproof::diagnosis
