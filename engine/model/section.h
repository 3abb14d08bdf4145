// The one table of a section that a plan may have.
#pragma once

#include "base/diagnostics.h"
#include "model/plan.h"

namespace dynoproof {

/// Null where the plan has no such section, and where it is no table: that is reported, with `hint`.
inline const Value* SectionTable(const Plan& plan, const std::string& name, const std::string& hint,
                                 Diagnostics& diagnostics) {
  const Value* table = plan.root.Find(name);
  if (table == nullptr || table->is_table()) return table;
  diagnostics.Error(table->where(), "\"" + name + "\" is " + table->KindName(), hint);
  return nullptr;
}

}  // namespace dynoproof
