#include "reduce/cut.h"

#include <algorithm>
#include <cmath>

namespace dynoproof::reduce {
namespace {

constexpr double kCloseEnough = 1.1;  // a length is sought until the longest that does not show it is that close

/// The shortest length from a sixteenth of `length` on that shows it, by halves of its logarithm.
std::size_t Shortest(std::size_t length, std::size_t fewest, const std::function<bool()>& left,
                     const std::function<bool(std::size_t)>& shows) {
  double fails = static_cast<double>(length), passes = static_cast<double>(fewest) - 1.0;
  double tried = std::max(fails / 16.0, static_cast<double>(fewest));
  while (left() && fails > kCloseEnough * passes) {
    const auto rows = static_cast<std::size_t>(std::lround(tried));
    if (static_cast<double>(rows) >= fails || static_cast<double>(rows) <= passes) break;
    (shows(rows) ? fails : passes) = static_cast<double>(rows);
    // Down by sixteenths as long as each shows it, then in the middle of the logarithms.
    tried = passes < static_cast<double>(fewest) ? std::max(fails / 16.0, static_cast<double>(fewest))
                                                 : std::sqrt(fails * passes);
  }
  return static_cast<std::size_t>(fails);
}

}  // namespace

Cut ShortestCut(std::size_t rows, std::size_t fewest, int most,
                const std::function<bool(std::size_t first, std::size_t last)>& shows) {
  Cut cut{.first = 0, .last = rows};
  const auto left = [&] { return cut.tries < most; };
  const auto asked = [&](std::size_t first, std::size_t last) {
    ++cut.tries;
    return shows(first, last);
  };
  for (std::size_t before = 0;
       before == 0 || 1.1 * static_cast<double>(cut.last - cut.first) < static_cast<double>(before);) {
    before = cut.last - cut.first;
    cut.last =
        cut.first + Shortest(before, fewest, left, [&](std::size_t n) { return asked(cut.first, cut.first + n); });
    cut.first = cut.last - Shortest(cut.last - cut.first, fewest, left,
                                    [&](std::size_t n) { return asked(cut.last - n, cut.last); });
  }
  cut.complete = left();
  return cut;
}

}  // namespace dynoproof::reduce
