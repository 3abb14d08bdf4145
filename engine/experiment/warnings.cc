#include "experiment/warnings.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/linear_group.h"

namespace dynoproof {
namespace {

/// The first block that `realtime` does not carry exactly: it has no linear part, or laws beyond it. Null: none.
const Block* NonlinearBlock(const Rig& rig) {
  const Roles roles = AssignRoles(rig);
  if (!roles.nonlinear.empty()) return &rig.blocks[static_cast<std::size_t>(roles.nonlinear.front())];
  for (const int index : roles.linear) {
    const Block& block = rig.blocks[static_cast<std::size_t>(index)];
    const std::vector<LawChannel>& channels = block.component->linear_part()->channels;
    if (std::any_of(channels.begin(), channels.end(), [](const LawChannel& c) { return !c.law->constant(); }))
      return &block;
  }
  return nullptr;
}

void WarnOfLimit(const std::string& key, const Value& value, Diagnostics& diagnostics) {
  if (!value.is_number() || value.number() < 1.0) return;
  diagnostics.Warning(value.where(),
                      fmt::format("{} = {:g} cannot fail in earnest: a signal that is wrong throughout is "
                                  "about 1 away",
                                  key, value.number()),
                      "a relative limit is well below 1");
}

}  // namespace

void AddWarnings(const Prepared& prepared, Diagnostics& diagnostics) {
  const Value* checks = prepared.plan.root.Find("check");
  bool compares_solvers = false;
  for (const Value& table : checks != nullptr ? checks->array() : Value::Array()) {
    const CheckKind* kind = prepared.registry->FindCheck(table.Find("kind")->string());
    compares_solvers = compares_solvers || kind->compares_solvers;
    for (const std::string& key : kind->relative_limits) {
      if (const Value* value = table.Find(key)) WarnOfLimit(key, *value, diagnostics);
    }
  }
  if (const Value* limits = prepared.plan.root.FindPath("record.nrmse"); limits != nullptr && limits->is_table()) {
    for (const Value::Entry& entry : limits->table())
      WarnOfLimit("record.nrmse." + entry.key, entry.value, diagnostics);
  }
  const bool held_against_record = prepared.record && !prepared.record->file.empty();
  if ((checks == nullptr || checks->array().empty()) && !held_against_record) {
    diagnostics.Warning(
        prepared.plan.root.where(), "the scenario states no checks: `run` compares nothing, and ends with 1",
        "add [[check]] kind = \"solvers\", with its signal, nrmse and origin", "dynoproof describe check.solvers");
    return;
  }
  const Block* nonlinear = NonlinearBlock(*prepared.rig);
  if (nonlinear == nullptr || compares_solvers) return;
  const Value* table = prepared.plan.root.FindPath(nonlinear->name);
  diagnostics.Warning(
      table != nullptr ? table->where() : prepared.plan.root.where(),
      fmt::format("{}: {} is nonlinear, and no check compares the solvers: steps of `realtime` that are too "
                  "coarse for it go unseen",
                  prepared.plan.id, nonlinear->name),
      "add [[check]] kind = \"solvers\", with its signal, nrmse and origin", "dynoproof describe check.solvers");
}

}  // namespace dynoproof
