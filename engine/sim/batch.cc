#include "sim/batch.h"

#include <algorithm>
#include <numbers>

#include "base/subnormals.h"
#include "sim/blocks.h"

namespace dynoproof {

using mechanics::BatchPropagator;

Result<BatchMember> BatchMember::Create(const Rig& rig) {
  const auto refused = [&rig](const std::string& what) { return Failure{"no batch: " + what, rig.id, {}, 2}; };
  if (rig.run.solver != "realtime") return refused("another solver");
  if (!rig.controls.empty()) return refused("controllers");
  if (rig.intervals.size() != 1 || !rig.intervals[0].samples.empty() || !rig.intervals[0].switches.empty())
    return refused("delays");
  const Roles roles = AssignRoles(rig);
  if (!roles.nonlinear.empty() || !roles.held.empty() || !roles.behind.empty())
    return refused("parts that are not linear");
  const LinearGroup group = JoinLinearParts(rig, roles);
  if (!group.channels.empty()) return refused("laws that are not linear");
  BatchMember member;
  member.rig_ = &rig;
  for (const int slot : group.reads) {
    const auto input = std::ranges::find_if(
        rig.inputs, [slot](const InputLine& line) { return line.delayed == slot && line.command == slot; });
    if (input == rig.inputs.end() || input->source == nullptr || input->continuous)
      return refused("inputs without a source");
    member.input_of_read_.push_back(static_cast<int>(input - rig.inputs.begin()));
  }
  for (const OutputLine& line : rig.outputs) {
    const auto write = std::ranges::find(group.writes, line.signal);
    if (write == group.writes.end() || line.ring >= 0) return refused("outputs behind a sensor");
    member.row_of_output_.push_back(static_cast<int>(write - group.writes.begin()));
  }
  member.form_ = mechanics::ModalForm::Build(group.system);
  if (rig.run.realtime.condense_above_Hz > 0.0) return refused("condensed modes");
  if (rig.run.realtime.keep_below_Hz > 0.0)
    member.form_ = member.form_.KeepBelow(2.0 * std::numbers::pi * rig.run.realtime.keep_below_Hz);
  if (!BatchPropagator::Takes(member.form_)) return refused("a larger modal block");
  Frame frame = rig.MakeFrame();
  for (const InputLine& line : rig.inputs) {
    if (line.source != nullptr) line.source->Output({0.0, {}, {}, {}}, {&frame.signals[line.command], 1});
  }
  StartBlocks(rig, frame);
  group.FromStates(frame.states, member.x_, member.p_);
  return member;
}

Result<std::vector<Samples>> SimulateBatch(std::span<const BatchMember* const> members, std::span<const int> outputs,
                                           bool same_inputs) {
  constexpr int kLanes = BatchPropagator::kLanes;
  const FlushSubnormals flush;
  const BatchMember& first = *members[0];
  const Rig& rig = *first.rig_;
  std::vector<const mechanics::ModalForm*> forms;
  for (const BatchMember* member : members) {
    if (member->rig_->steps != rig.steps || member->rig_->period != rig.period ||
        member->rig_->clock_rate != rig.clock_rate || member->input_of_read_ != first.input_of_read_ ||
        member->row_of_output_ != first.row_of_output_)
      return Failure{"no batch: the variants differ in more than numbers", rig.id, {}, 2};
    forms.push_back(&member->form_);
  }
  std::vector<int> rows;
  for (const int output : outputs) rows.push_back(first.row_of_output_[static_cast<std::size_t>(output)]);
  const Result<BatchPropagator> batch = BatchPropagator::Create(forms, rig.SecondsOf(rig.period), rows);
  if (!batch.ok()) return batch.failure();

  const auto ticks = static_cast<std::size_t>(rig.steps) + 1;
  mechanics::AlignedVector state(batch->state_size(), 0.0);
  std::vector<Samples> samples(members.size());
  for (std::size_t lane = 0; lane < members.size(); ++lane) {
    batch->SetState(static_cast<int>(lane), *forms[lane], members[lane]->x_, members[lane]->p_, state);
    samples[lane].time.resize(ticks);
    samples[lane].inputs.assign(rig.inputs.size(), std::vector<double>(ticks));
    samples[lane].outputs.resize(rig.outputs.size());
    for (const int output : outputs) samples[lane].outputs[static_cast<std::size_t>(output)].resize(ticks);
    samples[lane].counters = {{"periods", rig.steps}};
    samples[lane].solver_summary = "in a batch";
  }
  const std::size_t inputs = first.input_of_read_.size();
  mechanics::AlignedVector held(std::max<std::size_t>(1, inputs) * kLanes, 0.0), now = held,
                                                                                 y(outputs.size() * kLanes, 0.0);
  const auto read_sources = [&](double time_s, mechanics::AlignedVector& u) {
    for (std::size_t j = 0; j < inputs; ++j) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        double& value = u[j * kLanes + lane];
        if (lane >= members.size() || (same_inputs && lane > 0)) {
          value = u[j * kLanes];
          continue;
        }
        const InputLine& line = members[lane]->rig_->inputs[static_cast<std::size_t>(first.input_of_read_[j])];
        line.source->Output({time_s, {}, {}, {}}, {&value, 1});
      }
    }
  };
  read_sources(0.0, held);
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const double time_s = rig.SecondsOf(static_cast<Nanoseconds>(tick) * rig.period);
    read_sources(time_s, now);
    batch->Step(state, held.data(), now.data(), y.data());
    for (std::size_t lane = 0; lane < members.size(); ++lane) {
      samples[lane].time[tick] = time_s;
      for (std::size_t j = 0; j < inputs; ++j)
        samples[lane].inputs[static_cast<std::size_t>(first.input_of_read_[j])][tick] = now[j * kLanes + lane];
      for (std::size_t i = 0; i < outputs.size(); ++i)
        samples[lane].outputs[static_cast<std::size_t>(outputs[i])][tick] = y[i * kLanes + lane];
    }
    std::swap(held, now);
  }
  return samples;
}

}  // namespace dynoproof
