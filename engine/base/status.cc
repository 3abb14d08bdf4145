#include "base/status.h"

#include <fmt/format.h>

#include "base/text_safety.h"

namespace dynoproof {

std::string Failure::ToString() const {
  std::string text = signal.empty() ? message : fmt::format("{}: {}", signal, message);
  if (time_s) text += fmt::format(" (t = {:.9g} s)", *time_s);
  return AsMessage(text);
}

}  // namespace dynoproof
