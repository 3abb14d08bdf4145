// Largest and smallest value of points inside a moving window, O(1) amortised: the engine of tubes and hulls.
#pragma once

#include <deque>
#include <span>

namespace dynoproof::score {

/// Points (time, value) with rising time; windows whose two ends never move backwards.
class SlidingExtremes {
 public:
  SlidingExtremes(std::span<const double> time_s, std::span<const double> values) : time_(time_s), values_(values) {}

  /// Moves the window to [from, to]; afterwards Max and Min hold over the points inside, unless Empty.
  void MoveTo(double from, double to) {
    for (; next_ < time_.size() && time_[next_] <= to; ++next_) {
      while (!high_.empty() && values_[high_.back()] <= values_[next_]) high_.pop_back();
      while (!low_.empty() && values_[low_.back()] >= values_[next_]) low_.pop_back();
      high_.push_back(next_);
      low_.push_back(next_);
    }
    while (!high_.empty() && time_[high_.front()] < from) high_.pop_front();
    while (!low_.empty() && time_[low_.front()] < from) low_.pop_front();
  }
  bool Empty() const { return high_.empty(); }
  double Max() const { return values_[high_.front()]; }
  double Min() const { return values_[low_.front()]; }

 private:
  std::span<const double> time_, values_;
  std::size_t next_ = 0;
  std::deque<std::size_t> high_, low_;  // indices whose values fall, and rise, from front to back
};

}  // namespace dynoproof::score
