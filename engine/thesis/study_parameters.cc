#include "thesis/study_parameters.h"

#include <fmt/format.h>

#include <utility>

#include "base/bad_input.h"

namespace dynoproof {

Failure BadStudy(std::string why) { return BadInput(std::move(why), "study"); }

Result<double> Number(const Value& parameters, const char* key) {
  const Value* value = parameters.Find(key);
  if (value == nullptr || !value->is_number()) return BadStudy(fmt::format("needs a number \"{}\"", key));
  return value->number();
}

bool Flag(const Value& parameters, const char* key) {
  const Value* value = parameters.Find(key);
  return value != nullptr && value->is_bool() && value->boolean();
}

}  // namespace dynoproof
