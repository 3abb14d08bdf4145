// The shortest part of a record that still shows a fault.
#pragma once

#include <cstddef>
#include <functional>

namespace dynoproof::reduce {

struct Cut {
  std::size_t first = 0, last = 0;  // rows [first, last)
  int tries = 0;
  bool complete = true;  // no end can lose a tenth of what is left; false: `most` tries came first
};

/// Takes rows off the end, then off the beginning, until neither can lose a tenth. All of `rows` show the fault; `shows` is asked of
/// parts of at least `fewest` rows, at most `most` times. What happens first is kept, where it happens again.
Cut ShortestCut(std::size_t rows, std::size_t fewest, int most,
                const std::function<bool(std::size_t first, std::size_t last)>& shows);

}  // namespace dynoproof::reduce
