#include "diagnosis/resolution.h"

#include <cstdint>
#include <memory>
#include <utility>

#include "base/random.h"
#include "diagnosis/policy.h"
#include "score/series.h"

namespace dynoproof::diagnosis {

std::vector<MappedRecord> AtResolution(std::vector<MappedRecord> records) {
  constexpr std::uint64_t kSeed = 1;
  std::uint64_t stream = 0;
  for (MappedRecord& record : records) {
    for (auto& [name, series] : record.outputs) {
      std::vector<double> values = *series.values;
      const double size = policy::kResolution * score::StandardDeviation(values);
      for (std::size_t i = 0; i < values.size(); ++i) values[i] += size * RandomNormal(kSeed, stream, i);
      series.values = std::make_shared<const std::vector<double>>(std::move(values));
      ++stream;
    }
  }
  return records;
}

}  // namespace dynoproof::diagnosis
