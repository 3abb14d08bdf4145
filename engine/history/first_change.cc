#include "history/first_change.h"

#include <algorithm>
#include <map>
#include <optional>

namespace dynoproof::history {
namespace {

class Search {
 public:
  Search(std::size_t count, const std::function<Look(std::size_t)>& look) : look_(look), high_(count) {}

  FirstChange Run() {
    // Commits low_ ... high_ - 1 are undecided; the one at high_ - 1 is taken for changed until it is looked at.
    while (low_ + 1 < high_) {
      const std::optional<std::size_t> next = NearTheMiddle();
      if (!next) break;
      (At(*next) == Look::kSame ? low_ : high_) = *next + 1;
    }
    FirstChange change;
    if (high_ > low_ && At(high_ - 1) == Look::kChanged) change = {true, high_ - 1, Since(high_ - 1), 0};
    change.looks = seen_.size();
    return change;
  }

 private:
  Look At(std::size_t i) {
    const auto known = seen_.find(i);
    return known != seen_.end() ? known->second : seen_[i] = look_(i);
  }

  /// The one that says something and is nearest to the middle, but for the last; nothing where none does.
  std::optional<std::size_t> NearTheMiddle() {
    const std::size_t middle = low_ + (high_ - low_) / 2 - 1;
    for (std::size_t away = 0; away < high_ - low_; ++away) {
      for (const bool below : {true, false}) {
        if (below && away > middle - low_) continue;
        const std::size_t i = below ? middle - away : middle + away;
        if (i + 1 >= high_ || (away == 0 && !below)) continue;
        if (At(i) != Look::kCannot) return i;
      }
    }
    return std::nullopt;
  }

  std::size_t Since(std::size_t first) const {
    std::size_t since = first;
    while (since > low_ && seen_.contains(since - 1) && seen_.at(since - 1) == Look::kCannot) --since;
    return since;
  }

  const std::function<Look(std::size_t)>& look_;
  std::map<std::size_t, Look> seen_;
  std::size_t low_ = 0, high_;
};

}  // namespace

FirstChange FindFirstChange(std::size_t count, const std::function<Look(std::size_t)>& look) {
  return count == 0 ? FirstChange{} : Search(count, look).Run();
}

}  // namespace dynoproof::history
