// How a search is conducted: who hears of its progress, when it has to end, and what an earlier one had found.
#pragma once

#include <functional>
#include <string>

#include "diagnosis/saved_points.h"

namespace dynoproof::diagnosis {

struct Conduct {
  std::function<void(double)> progress = [](double) {};  // a share of the work
  /// Whether it may not go on. Asked between parts of the work that are the same however many threads there are.
  std::function<bool()> spent = [] { return false; };
  SavedPoints* saved = nullptr;  // none: nothing is kept
  std::string stage = {};        // under which it is kept

  std::string NameOf(const std::string& what, std::size_t level) const {
    return stage + ", " + what + ", level " + std::to_string(level);
  }
  std::optional<Eigen::VectorXd> Recall(const std::string& what, std::size_t level, Eigen::Index count) const {
    return saved != nullptr ? saved->Recall(NameOf(what, level), count) : std::nullopt;
  }
  void Keep(const std::string& what, std::size_t level, const Eigen::VectorXd& q) const {
    if (saved != nullptr) saved->Keep(NameOf(what, level), q);
  }
};

}  // namespace dynoproof::diagnosis
