#pragma once
// The failure that most readers and studies tell of.

#include <string>
#include <utility>

#include "base/status.h"

namespace dynoproof {

/// What was given is at fault (exit code 2 of the contract); `signal` is the component, signal or file concerned.
inline Failure BadInput(std::string message, std::string signal = {}) {
  return {.message = std::move(message), .signal = std::move(signal), .time_s = {}, .exit_code = 2};
}

}  // namespace dynoproof
