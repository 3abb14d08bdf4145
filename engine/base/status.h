// How library code reports a broken run: as a value, never by printing or leaving the program.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace dynoproof {

/// What broke a run. `signal` is the component, signal or file concerned; `time_s` is set when the run had started.
struct Failure {
  std::string message = {};
  std::string signal = {};
  std::optional<double> time_s = {};
  int exit_code = 3;  // of the contract: 3 a run broke, 2 bad usage, scenario or data

  /// All of it as a sentence that can be shown and stored (base/text_safety.h).
  std::string ToString() const;
};

/// A value or the reason why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}            // NOLINT(google-explicit-constructor): reads as a return
  Result(Failure failure) : content_(std::move(failure)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return std::holds_alternative<T>(content_); }
  T& operator*() & { return std::get<T>(content_); }
  const T& operator*() const& { return std::get<T>(content_); }
  T&& operator*() && { return std::get<T>(std::move(content_)); }
  T* operator->() { return &std::get<T>(content_); }
  const T* operator->() const { return &std::get<T>(content_); }
  const Failure& failure() const { return std::get<Failure>(content_); }

 private:
  std::variant<T, Failure> content_;
};

/// Success, or the reason of the failure.
using Status = std::optional<Failure>;

}  // namespace dynoproof
