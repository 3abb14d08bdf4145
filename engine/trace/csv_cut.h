// Whether the last number of a text file was cut.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace dynoproof::trace::csv {

/// Compares the last cell of a file that ends without a line end with those above it, all of one column.
///
/// A cut number is a shorter number, and nothing in it says so. If all cells above have the same digits after the mark
/// and in the exponent, the last one was cut if it has fewer. Otherwise it may be cut if it has fewer significant digits
/// than half of the cells above, or, for whole numbers, if it is farther from its neighbour than any other. Numbers that
/// lost digits nobody misses (the last of 17) pass, and so do a few integers; a row is given up a little too often
/// rather than too rarely.
class CutCheck {
 public:
  /// The cell of the next row, trimmed.
  void Take(std::string_view cell);

  /// Whether the cell taken last may be cut; `values` are the column's numbers, its own included. Needs some rows to
  /// judge by: false with fewer.
  bool MayBeCut(std::span<const double> values) const;

 private:
  struct Form {
    std::size_t decimals = 0, exponent = 0, significant = 0;
  };
  static Form FormOf(std::string_view cell);

  Form last_, first_;
  std::size_t above_ = 0;  // cells above the last
  bool any_ = false, same_form_ = true;
  std::array<std::size_t, 32> with_digits_ = {};  // cells above by significant digits
};

}  // namespace dynoproof::trace::csv
