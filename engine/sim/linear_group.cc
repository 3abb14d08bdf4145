#include "sim/linear_group.h"

#include <algorithm>
#include <map>
#include <set>

#include "sim/blocks.h"
#include "sim/solver.h"

namespace dynoproof {
namespace {

/// Slots that only ticks and delayed commands change.
std::set<int> HeldSlots(const Rig& rig) {
  std::set<int> held;
  for (const InputLine& line : rig.inputs) {
    if (!line.continuous) held.insert({line.command, line.delayed});
  }
  for (const OutputLine& line : rig.outputs) held.insert(line.sample);
  for (const Block& block : rig.controls) {
    for (int i = 0; i < block.outputs(); ++i) held.insert(block.first_output + i);
  }
  return held;
}

/// A signal of the group as a row: y = c x + e p + d v.
struct Row {
  Eigen::RowVectorXd c, e, d;
};

}  // namespace

Roles AssignRoles(const Rig& rig) {
  std::set<int> held = HeldSlots(rig);
  const int count = static_cast<int>(rig.blocks.size());
  const std::vector<bool> feeds = FeedsDynamics(rig);
  Roles roles;
  std::set<int> behind;  // slots of the blocks behind the dynamics
  for (int i = 0; i < count; ++i) {
    const Block& block = rig.blocks[i];
    const bool follows =
        std::any_of(block.inputs.begin(), block.inputs.end(), [&](int slot) { return behind.contains(slot); });
    const bool only_held =
        std::all_of(block.inputs.begin(), block.inputs.end(), [&](int slot) { return held.contains(slot); });
    if (block.states() == 0 && only_held) {
      roles.held.push_back(i);
      for (int k = 0; k < block.outputs(); ++k) held.insert(block.first_output + k);
    } else if (block.component->linear_part() != nullptr && !follows) {
      roles.linear.push_back(i);
    } else if (block.states() > 0 || feeds[i]) {
      roles.nonlinear.push_back(i);
    } else {
      roles.behind.push_back(i);
      for (int k = 0; k < block.outputs(); ++k) behind.insert(block.first_output + k);
    }
  }
  return roles;
}

void LinearGroup::FromStates(const std::vector<double>& states, Eigen::VectorXd& x, Eigen::VectorXd& p) const {
  x = Eigen::VectorXd::Zero(system.states());
  p = Eigen::VectorXd::Zero(system.integrators());
  for (const Member& member : members) {
    const Eigen::Map<const Eigen::VectorXd> s(states.data() + member.first_state, member.x_from_state.cols());
    x.segment(member.first_x, member.x_from_state.rows()) = member.x_from_state * s;
    const Eigen::Index integrators = member.p_from_state.rows();
    if (integrators == 0) continue;
    if (member.first_p >= 0) {
      p.segment(member.first_p, integrators) = member.p_from_state * s;
    } else {
      x.segment(member.first_x + member.x_from_state.rows(), integrators) = member.p_from_state * s;
    }
  }
}

void LinearGroup::ToStates(const Eigen::VectorXd& x, const Eigen::VectorXd& p, std::vector<double>& states) const {
  for (const Member& member : members) {
    Eigen::Map<Eigen::VectorXd> s(states.data() + member.first_state, member.state_from_x.rows());
    s = member.state_from_x * x.segment(member.first_x, member.state_from_x.cols());
    const Eigen::Index integrators = member.state_from_p.cols();
    if (integrators == 0) continue;
    s += member.state_from_p * (member.first_p >= 0
                                    ? p.segment(member.first_p, integrators)
                                    : x.segment(member.first_x + member.state_from_x.cols(), integrators));
  }
}

namespace {

/// Joins the parts. When `promote` the integrators become ordinary states: needed where somebody reacts to an angle.
LinearGroup Join(const Rig& rig, const Roles& roles, bool promote, bool& reacts_to_integrators) {
  LinearGroup group;
  int n = 0, q = 0, channels = 0;
  std::map<int, int> producer;  // slot -> index in roles.linear
  for (std::size_t k = 0; k < roles.linear.size(); ++k) {
    const Block& block = rig.blocks[roles.linear[k]];
    const LinearPart& part = *block.component->linear_part();
    const int integrators = part.system.integrators();
    group.members.push_back({block.first_state, n, promote ? -1 : q, part.x_from_state, part.p_from_state,
                             part.state_from_x, part.state_from_p});
    n += part.system.states() + (promote ? integrators : 0);
    q += promote ? 0 : integrators;
    channels += static_cast<int>(part.channels.size());
    for (int i = 0; i < block.outputs(); ++i) producer[block.first_output + i] = static_cast<int>(k);
  }
  const std::set<int> held = [&] {
    std::set<int> slots = HeldSlots(rig);
    for (const int index : roles.held) {
      for (int i = 0; i < rig.blocks[index].outputs(); ++i) slots.insert(rig.blocks[index].first_output + i);
    }
    return slots;
  }();
  for (const int index : roles.linear) {
    for (const int slot : rig.blocks[index].inputs) {
      const bool known = std::find(group.reads.begin(), group.reads.end(), slot) != group.reads.end();
      if (producer.contains(slot) || known) continue;
      group.reads.push_back(slot);
      group.read_is_held.push_back(held.contains(slot));
    }
  }
  std::set<int> wanted;
  for (const OutputLine& line : rig.outputs) wanted.insert(line.signal);
  for (const InputLine& line : rig.inputs) wanted.insert(line.from);
  for (const Block& block : rig.controls) wanted.insert(block.inputs.begin(), block.inputs.end());
  for (const auto* list : {&roles.nonlinear, &roles.behind}) {
    for (const int index : *list) wanted.insert(rig.blocks[index].inputs.begin(), rig.blocks[index].inputs.end());
  }
  const int reads = static_cast<int>(group.reads.size()), m = reads + channels;
  mechanics::LinearSystem& system = group.system;
  system.A = Eigen::MatrixXd::Zero(n, n);
  system.B = Eigen::MatrixXd::Zero(n, m);
  system.P = Eigen::MatrixXd::Zero(q, n);

  std::map<int, Row> rows;        // of slots that the group produces
  std::vector<Row> channel_rows;  // twist, rate, twist, rate, ...
  int next_channel = 0;
  for (std::size_t k = 0; k < roles.linear.size(); ++k) {
    const Block& block = rig.blocks[roles.linear[k]];
    const LinearPart& part = *block.component->linear_part();
    const mechanics::LinearSystem& own = part.system;
    const LinearGroup::Member& member = group.members[k];
    const int integrators = own.integrators(), own_channels = static_cast<int>(part.channels.size());
    // The block's inputs as rows; an input that does not feed through may not have its row yet (zero now, the A
    // matrix is filled below when all rows are known).
    const auto input_rows = [&] {
      Eigen::MatrixXd c = Eigen::MatrixXd::Zero(own.inputs(), n), e = Eigen::MatrixXd::Zero(own.inputs(), q),
                      d = Eigen::MatrixXd::Zero(own.inputs(), m);
      for (std::size_t i = 0; i < block.inputs.size(); ++i) {
        const auto read = std::find(group.reads.begin(), group.reads.end(), block.inputs[i]);
        const auto row = rows.find(block.inputs[i]);
        if (read != group.reads.end()) {
          d(i, read - group.reads.begin()) = 1.0;
        } else if (row != rows.end()) {
          c.row(i) = row->second.c;
          e.row(i) = row->second.e;
          d.row(i) = row->second.d;
        }
      }
      for (int i = 0; i < own_channels; ++i) d(block.inputs.size() + i, reads + next_channel + i) = 1.0;
      return std::tuple(c, e, d);
    };
    const auto [c, e, d] = input_rows();
    for (int r = 0; r < own.outputs(); ++r) {
      Row row{own.D.row(r) * c, own.D.row(r) * e, own.D.row(r) * d};
      row.c.segment(member.first_x, own.states()) += own.C.row(r);
      if (promote) {
        row.c.segment(member.first_x + own.states(), integrators) += own.E.row(r);
      } else {
        row.e.segment(member.first_p, integrators) += own.E.row(r);
      }
      if (r < block.outputs()) {
        rows[block.first_output + r] = std::move(row);
      } else {
        channel_rows.push_back(std::move(row));
      }
    }
    for (const LawChannel& channel : part.channels) {
      group.channels.push_back({channel, block.first_state + channel.state_offset,
                                block.first_mode + channel.mode_offset,
                                static_cast<int>(channel.law->layout().states.size()), channel.law->layout().modes,
                                channel.law->layout().modes > 0 && !channel.law->sticks()});
    }
    next_channel += own_channels;
  }
  next_channel = 0;
  reacts_to_integrators = false;
  for (std::size_t k = 0; k < roles.linear.size(); ++k) {
    const Block& block = rig.blocks[roles.linear[k]];
    const LinearPart& part = *block.component->linear_part();
    const mechanics::LinearSystem& own = part.system;
    const LinearGroup::Member& member = group.members[k];
    const int states = own.states(), integrators = own.integrators();
    system.A.block(member.first_x, member.first_x, states, states) += own.A;
    if (promote) {
      system.A.block(member.first_x + states, member.first_x, integrators, states) = own.P;
    } else {
      system.P.block(member.first_p, member.first_x, integrators, states) = own.P;
    }
    for (std::size_t i = 0; i < block.inputs.size(); ++i) {
      const auto read = std::find(group.reads.begin(), group.reads.end(), block.inputs[i]);
      if (read != group.reads.end()) {
        system.B.block(member.first_x, read - group.reads.begin(), states, 1) += own.B.col(i);
        continue;
      }
      const Row& row = rows.at(block.inputs[i]);
      system.A.middleRows(member.first_x, states) += own.B.col(i) * row.c;
      system.B.middleRows(member.first_x, states) += own.B.col(i) * row.d;
      reacts_to_integrators = reacts_to_integrators || row.e.any();
    }
    const int own_channels = static_cast<int>(part.channels.size());
    system.B.block(member.first_x, reads + next_channel, states, own_channels) += own.B.rightCols(own_channels);
    next_channel += own_channels;
  }
  for (const auto& [slot, row] : rows) {
    if (wanted.contains(slot)) group.writes.push_back(slot);
  }
  const int written = static_cast<int>(group.writes.size()), r = written + 2 * channels;
  system.C.resize(r, n);
  system.E.resize(r, q);
  system.D.resize(r, m);
  for (int i = 0; i < r; ++i) {
    const Row& row = i < written ? rows.at(group.writes[i]) : channel_rows[i - written];
    system.C.row(i) = row.c;
    system.E.row(i) = row.e;
    system.D.row(i) = row.d;
  }
  return group;
}

}  // namespace

LinearGroup JoinLinearParts(const Rig& rig, const Roles& roles) {
  bool reacts = false;
  LinearGroup group = Join(rig, roles, false, reacts);
  return reacts ? Join(rig, roles, true, reacts) : group;
}

}  // namespace dynoproof
