#include "estimation/data_set.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "experiment/drive_by_record.h"
#include "score/series.h"
#include "score/white_noise.h"

namespace dynoproof::estimation {
namespace {

constexpr double kLeastNoise = 1e-4;  // of the spread: what a simulation is good for

/// The rows up to `end_s`.
Series Until(const Series& series, double end_s) {
  const auto rows = std::upper_bound(series.time->begin(), series.time->end(), end_s) - series.time->begin();
  if (rows == std::ssize(*series.time)) return series;
  return {std::make_shared<const std::vector<double>>(series.time->begin(), series.time->begin() + rows),
          std::make_shared<const std::vector<double>>(series.values->begin(), series.values->begin() + rows)};
}

/// The channel of an output in a record; null where there is none.
const Channel* Find(const std::vector<Channel>& channels, std::size_t record, const std::string& name) {
  const auto found =
      std::ranges::find_if(channels, [&](const Channel& one) { return one.record == record && one.name == name; });
  return found != channels.end() ? &*found : nullptr;
}

}  // namespace

DataSet::DataSet(std::vector<MappedRecord> records, const Plan& plan, const Options& options)
    : records_(std::move(records)) {
  std::vector<double> measured;
  for (std::size_t r = 0; r < records_.size(); ++r) {
    MappedRecord& record = records_[r];
    record = OntoClock(std::move(record), plan);
    record.end_s = std::min(record.end_s, options.most_s);
    for (auto* signals : {&record.inputs, &record.outputs}) {
      for (auto& [name, series] : *signals) series = Until(series, record.end_s);
    }
    for (const auto& [name, series] : record.outputs) {
      const std::vector<double>&t = *series.time, &y = *series.values;
      const double from_s = std::max(options.from_s, options.from_share * record.end_s);
      const auto first = std::lower_bound(t.begin(), t.end(), from_s) - t.begin();
      Eigen::Index every = 1;
      while ((std::ssize(t) - first + every - 1) / every > options.most_rows) ++every;
      Channel channel;
      channel.record = r;
      channel.name = name;
      channel.unit = plan.root.TextOr("output." + name + ".unit", "1");
      channel.spread = score::StandardDeviation(y);
      const Channel* known = options.noise_of != nullptr ? Find(options.noise_of->channels(), r, name) : nullptr;
      channel.white = known != nullptr ? known->white : score::WhiteNoise(y);
      const double size = std::abs(plan.root.NumberOr("output." + name + ".nominal", 0.0));
      channel.still = !(channel.spread > kRounding * size);
      channel.noise = known != nullptr
                          ? known->noise
                          : std::max({channel.white, kLeastNoise * channel.spread, kRounding * size, 1e-100});
      channel.begin = std::ssize(measured);
      for (auto i = first; i < std::ssize(t); i += every) {
        measured.push_back(y[static_cast<std::size_t>(i)]);
        time_s_.push_back(t[static_cast<std::size_t>(i)]);
      }
      channel.count = std::ssize(measured) - channel.begin;
      channels_.push_back(std::move(channel));
    }
  }
  measured_ = Eigen::Map<const Eigen::VectorXd>(measured.data(), std::ssize(measured));
}

std::vector<Block> BlocksOf(const DataSet& data) {
  constexpr Eigen::Index kBlocks = 40;
  std::vector<Block> blocks(static_cast<std::size_t>(kBlocks) * data.records().size());
  for (std::size_t c = 0; c < data.channels().size(); ++c) {
    const Channel& channel = data.channels()[c];
    for (Eigen::Index b = 0; b < kBlocks; ++b) {
      const Eigen::Index begin = channel.begin + channel.count * b / kBlocks,
                         end = channel.begin + channel.count * (b + 1) / kBlocks;
      blocks[channel.record * kBlocks + static_cast<std::size_t>(b)].rows.push_back({c, begin, end - begin});
    }
  }
  return blocks;
}

}  // namespace dynoproof::estimation
