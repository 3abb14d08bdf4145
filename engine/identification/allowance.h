// The limit of simulations and CPU time of a search. Each simulation is counted here, and each loop of the search asks here
// before its next turn: a search that has spent its allowance ends with the best fit that it has.
#pragma once

#include <atomic>
#include <ctime>
#include <limits>

namespace dynoproof::identification {

class Allowance {
 public:
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

  /// `most_simulations`: of records `record_s` long altogether; a part counts by its share. `most_cpu_s`: of the process
  /// from now on, all threads together; how far that goes depends on the machine, which the other does not.
  explicit Allowance(double record_s = 1.0, double most_simulations = kUnlimited, double most_cpu_s = kUnlimited)
      : record_s_(record_s), most_simulations_(most_simulations), most_cpu_s_(most_cpu_s) {}

  /// Adds a run of `simulated_s`. Thread-safe.
  void Count(double simulated_s) { simulated_s_ += simulated_s; }
  double simulations() const { return simulated_s_ / record_s_; }
  double cpu_s() const { return static_cast<double>(std::clock() - began_) / CLOCKS_PER_SEC; }
  bool spent() const {
    return simulations() >= most_simulations_ || (most_cpu_s_ < kUnlimited && cpu_s() >= most_cpu_s_);
  }

 private:
  double record_s_, most_simulations_, most_cpu_s_;
  std::clock_t began_ = std::clock();
  std::atomic<double> simulated_s_ = 0.0;
};

}  // namespace dynoproof::identification
