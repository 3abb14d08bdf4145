#include "diagnosis/saved_points.h"

#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/text.h"
#include "scenario/load.h"

namespace dynoproof::diagnosis {
namespace {

using nlohmann::json;

std::string FingerprintOf(const Plan& plan, const std::vector<MappedRecord>& records) {
  std::string bytes = ToToml(plan.root);
  for (const MappedRecord& record : records) {
    bytes += record.in_motion ? "in motion" : "";
    for (const auto* signals : {&record.inputs, &record.outputs}) {
      for (const auto& [name, series] : *signals) {
        for (const auto& values : {series.time, series.values})
          bytes.append(reinterpret_cast<const char*>(values->data()), values->size() * sizeof(double));
      }
    }
  }
  return Fingerprint(bytes);
}

}  // namespace

SavedPoints::SavedPoints(std::string file, bool resume, const Plan& plan, const std::vector<MappedRecord>& records)
    : file_(std::move(file)), fingerprint_(FingerprintOf(plan, records)) {
  if (!resume) return;
  const std::optional<std::string> text = ReadTextFile(file_);
  const json saved = text ? json::parse(*text, nullptr, false) : json();
  if (!saved.is_object() || saved.value("fingerprint", json()) != fingerprint_) return;
  try {
    points_ = saved.at("points").get<std::map<std::string, std::vector<double>>>();
  } catch (const json::exception&) {
    points_.clear();
  }
}

std::optional<Eigen::VectorXd> SavedPoints::Recall(const std::string& name, Eigen::Index count) const {
  const std::lock_guard<std::mutex> lock(own_);
  const auto found = points_.find(name);
  if (found == points_.end() || std::ssize(found->second) != count) return std::nullopt;
  return Eigen::Map<const Eigen::VectorXd>(found->second.data(), count);
}

void SavedPoints::Keep(const std::string& name, const Eigen::VectorXd& q) {
  constexpr std::chrono::milliseconds kMoment(200);
  const std::lock_guard<std::mutex> lock(own_);
  points_[name].assign(q.begin(), q.end());
  const auto now = std::chrono::steady_clock::now();
  if (now - written_ < kMoment) return;
  written_ = now;
  (void)WriteFileAtomically(file_, JsonText(json({{"fingerprint", fingerprint_}, {"points", points_}})));
}

}  // namespace dynoproof::diagnosis
