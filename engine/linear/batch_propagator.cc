#include "linear/batch_propagator.h"

#include <algorithm>

#include "linear/batch_kernels.h"
#include "linear/propagator.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::VectorXd;

Failure BatchRefused(const std::string& message) { return {"batch: " + message, "batch propagator", {}, 2}; }

/// One interval of the form, in the order of its coordinates: the columns are read off by advancing unit vectors, which
/// gives the very numbers of the step.
struct Interval {
  Eigen::MatrixXd of_state;  // (k + q) x k
  Eigen::MatrixXd of_input;  // (k + q) x m
};

Result<Interval> Discretised(const ModalForm& form, double interval_s, CpuClass cpu_class) {
  const Result<Propagator> propagator = Propagator::Create(form, interval_s, cpu_class);
  if (!propagator.ok()) return propagator.failure();
  const Eigen::Index k = form.L.rows(), q = form.integrators();
  AlignedVector state(static_cast<std::size_t>(form.state_size()));
  std::vector<double> u(static_cast<std::size_t>(form.inputs()));
  const auto advanced = [&](auto column) {
    propagator->Advance(state, u);
    for (Eigen::Index i = 0; i < k; ++i) column[i] = state[static_cast<std::size_t>(form.layout.place[i])];
    for (Eigen::Index i = 0; i < q; ++i)
      column[k + i] = state[static_cast<std::size_t>(form.layout.integrator_begin + i)];
  };
  Interval interval{Eigen::MatrixXd(k + q, k), Eigen::MatrixXd(k + q, form.inputs())};
  for (Eigen::Index i = 0; i < k; ++i) {
    std::fill(state.begin(), state.end(), 0.0);
    state[static_cast<std::size_t>(form.layout.place[i])] = 1.0;
    advanced(interval.of_state.col(i));
  }
  for (Eigen::Index j = 0; j < interval.of_input.cols(); ++j) {
    std::fill(state.begin(), state.end(), 0.0);
    u[static_cast<std::size_t>(j)] = 1.0;
    advanced(interval.of_input.col(j));
    u[static_cast<std::size_t>(j)] = 0.0;
  }
  return interval;
}

}  // namespace

bool BatchPropagator::Takes(const ModalForm& form) {
  return std::ranges::all_of(form.blocks, [](const auto& block) { return block.pair || block.size == 1; });
}

Result<BatchPropagator> BatchPropagator::Create(std::span<const ModalForm* const> forms, double interval_s,
                                                std::span<const int> outputs, CpuClass cpu_class) {
  if (forms.empty() || std::ssize(forms) > kLanes) return BatchRefused("1 to 8 forms");
  const int m = forms[0]->inputs(), all_q = forms[0]->integrators();
  BatchPropagator batch;
  BatchPlan& plan = batch.plan_;
  plan.inputs = m;
  plan.outputs = static_cast<int>(outputs.size());
  for (const ModalForm* form : forms) {
    if (!Takes(*form)) return BatchRefused("a form with a larger block");
    if (form->inputs() != m || form->integrators() != all_q)
      return BatchRefused("forms of different inputs or integrators");
    plan.pairs = std::max(plan.pairs, form->layout.pairs);
    plan.reals = std::max(plan.reals, form->layout.reals);
  }
  for (int i = 0; i < all_q; ++i) {
    const bool seen = std::ranges::any_of(forms, [&](const ModalForm* form) {
      return std::ranges::any_of(outputs, [&](int output) { return form->E(output, i) != 0.0; });
    });
    if (seen) batch.integrators_.push_back(i);
  }
  plan.integrators = static_cast<int>(batch.integrators_.size());
  const int rows = plan.outputs + plan.integrators;
  if (plan.outputs == 0 || rows > BatchPlan::kMostRows) return BatchRefused("1 to 8 outputs and integrators");

  const int pair_size = (2 + 2 * m + 2 * rows) * kLanes, real_size = (1 + m + rows) * kLanes;
  const std::size_t reals_at = static_cast<std::size_t>(plan.pairs * pair_size);
  const std::size_t direct_at = reals_at + static_cast<std::size_t>(plan.reals * real_size);
  const std::size_t integrators_at = direct_at + static_cast<std::size_t>(rows * m * kLanes);
  batch.values_.assign(integrators_at + static_cast<std::size_t>(plan.outputs * plan.integrators * kLanes), 0.0);
  double* const values = batch.values_.data();
  for (int lane = 0; lane < std::ssize(forms); ++lane) {
    const ModalForm& form = *forms[static_cast<std::size_t>(lane)];
    const Result<Interval> interval = Discretised(form, interval_s, cpu_class);
    if (!interval.ok()) return interval.failure();
    const Eigen::Index k = form.L.rows();
    const auto weight = [&](int row, Eigen::Index coordinate) {
      return row < plan.outputs
                 ? form.C(outputs[static_cast<std::size_t>(row)], coordinate)
                 : interval->of_state(k + batch.integrators_[static_cast<std::size_t>(row - plan.outputs)], coordinate);
    };
    int pair = 0, real = 0;
    for (const auto& block : form.blocks) {
      const Eigen::Index i = block.first;
      double* to = block.pair ? values + pair++ * pair_size + lane
                              : values + reals_at + static_cast<std::size_t>(real++ * real_size) + lane;
      const auto put = [&to](double value) {
        *to = value;
        to += kLanes;
      };
      put(interval->of_state(i, i));
      if (block.pair) put(interval->of_state(i, i + 1));
      for (int j = 0; j < m; ++j) {
        put(interval->of_input(i, j));
        if (block.pair) put(interval->of_input(i + 1, j));
      }
      for (int row = 0; row < rows; ++row) {
        put(weight(row, i));
        if (block.pair) put(weight(row, i + 1));
      }
    }
    for (int row = 0; row < rows; ++row) {
      for (int j = 0; j < m; ++j) {
        values[direct_at + static_cast<std::size_t>((row * m + j) * kLanes + lane)] =
            row < plan.outputs
                ? form.D(outputs[static_cast<std::size_t>(row)], j)
                : interval->of_input(k + batch.integrators_[static_cast<std::size_t>(row - plan.outputs)], j);
      }
    }
    for (int row = 0; row < plan.outputs; ++row) {
      for (int i = 0; i < plan.integrators; ++i) {
        values[integrators_at + static_cast<std::size_t>((row * plan.integrators + i) * kLanes + lane)] =
            form.E(outputs[static_cast<std::size_t>(row)], batch.integrators_[static_cast<std::size_t>(i)]);
      }
    }
  }
  plan.pair_records = values;
  plan.real_records = values + reals_at;
  plan.direct = values + direct_at;
  plan.by_integrator = values + integrators_at;
  batch.kernel_ = BatchKernelFor(cpu_class, rows, m);
  return batch;
}

void BatchPropagator::SetState(int lane, const ModalForm& form, const VectorXd& x, const VectorXd& p,
                               std::span<double> state) const {
  const VectorXd z = form.T_inverse * x;
  int pair = 0, real = 2 * plan_.pairs;
  const auto put = [&](int place, double value) { state[static_cast<std::size_t>(place * kLanes + lane)] = value; };
  for (const auto& block : form.blocks) {
    if (block.pair) {
      put(2 * pair, z[block.first]);
      put(2 * pair++ + 1, z[block.first + 1]);
    } else {
      put(real++, z[block.first]);
    }
  }
  for (std::size_t i = 0; i < integrators_.size(); ++i)
    put(2 * plan_.pairs + plan_.reals + static_cast<int>(i), p[integrators_[i]]);
}

}  // namespace dynoproof::mechanics
