// The first commit of a series that is not like the one before it, by halves.
#pragma once

#include <cstddef>
#include <functional>

namespace dynoproof::history {

enum class Look {
  kSame,     // as the commit before the series
  kChanged,  // otherwise
  kCannot    // it cannot be built or run: it says nothing
};

struct FirstChange {
  bool found = false;     // false: the last one is as the one before the series, or nothing could be looked at
  std::size_t first = 0;  // the first that has changed
  std::size_t since =
      0;  // of those from here on up to `first` none could be looked at but the last; `first` where all could
  std::size_t looks = 0;
};

/// Looks at ceil(log2 count) of `count` commits, numbered from 0 in their order, and at the last one where it is the one that is found.
/// Where one says nothing, those nearest to it are looked at.
FirstChange FindFirstChange(std::size_t count, const std::function<Look(std::size_t)>& look);

}  // namespace dynoproof::history
