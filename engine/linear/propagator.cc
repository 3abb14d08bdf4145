#include "linear/propagator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "linear/aligned_vector.h"
#include "linear/dense.h"

namespace dynoproof::mechanics {

/// What the pointers of a StepPlan point at.
struct Propagator::Coefficients {
  AlignedVector values;
  std::vector<LargerBlock> larger;
  std::vector<Range> integrator_ranges, output_ranges;
};

namespace {

using dense::MatrixXld;
using Eigen::MatrixXd;
using Complex = std::complex<long double>;

/// phi_0 .. phi_3 of z = L h: phi_0 = exp, phi_k+1(z) = (phi_k(z) - 1/k!) / z. With them, for x' = L x + f:
///   x(h) = phi_0 x(0) + h phi_1 f0 + h phi_2 df,   integral of x = h phi_1 x(0) + h^2 phi_2 f0 + h^2 phi_3 df,
/// where f runs straight from f0 to f0 + df.
using Phis = std::array<MatrixXld, 4>;

std::array<Complex, 4> ScalarPhis(Complex z) {
  std::array<Complex, 4> phi{std::exp(z)};
  if (std::abs(z) >= 1.0L) {
    phi[1] = (phi[0] - 1.0L) / z;
    phi[2] = (phi[1] - 1.0L) / z;
    phi[3] = (phi[2] - 0.5L) / z;
    return phi;
  }
  // Below 1 the recurrence cancels; 24 terms of the series leave 1/25!.
  for (int k = 1; k < 4; ++k) {
    long double factorial = 1.0L;
    for (int i = 2; i <= k; ++i) factorial *= static_cast<long double>(i);
    Complex term = 1.0L / factorial;
    for (int j = 1; j <= 24; ++j) {
      phi[k] += term;
      term *= z / static_cast<long double>(j + k);
    }
  }
  return phi;
}

/// The same from one exponential: exp [z I 0 0; 0 0 I 0; 0 0 0 I; 0 0 0 0] has phi_0 .. phi_3 as its first row.
template <class Scalar>
Phis AugmentedPhis(const MatrixXld& z) {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Index n = z.rows();
  Matrix augmented = Matrix::Zero(4 * n, 4 * n);
  augmented.topLeftCorner(n, n) = z.cast<Scalar>();
  augmented.topRightCorner(3 * n, 3 * n) += Matrix::Identity(3 * n, 3 * n);
  const Matrix exponential = dense::Exponential(augmented);
  Phis phi;
  for (int k = 0; k < 4; ++k) phi[k] = exponential.block(0, k * n, n, n).template cast<long double>();
  return phi;
}

Phis BlockPhis(const BlockDiagonal::Block& block, const MatrixXld& z) {
  if (!block.pair && block.size > 1) {
    // Extended precision costs n^3 in software-like speed: for a block that is a whole plant double must do.
    return block.size <= 16 ? AugmentedPhis<long double>(z) : AugmentedPhis<double>(z);
  }
  const auto scalars = ScalarPhis(block.pair ? Complex(z(0, 0), z(0, 1)) : Complex(z(0, 0)));
  Phis phi;
  for (int k = 0; k < 4; ++k) {
    phi[k].resize(block.size, block.size);
    const long double re = scalars[k].real(), im = scalars[k].imag();
    if (block.pair) {
      phi[k] << re, im, -im, re;
    } else {
      phi[k] << re;
    }
  }
  return phi;
}

/// The interval's matrices in the form's own order of coordinates; gains are [held | ramp].
struct Discrete {
  MatrixXd phi, gain;       // k x k, k x 2 m
  MatrixXd p_of_z, p_of_u;  // q x k, q x 2 m
};

Discrete Discretise(const ModalForm& form, double interval_s) {
  const auto h = static_cast<long double>(interval_s);
  const int m = form.inputs(), q = form.integrators();
  const Eigen::Index n = form.L.rows();
  Discrete result{MatrixXd::Zero(n, n), MatrixXd(n, 2 * m), MatrixXd(q, n), {}};
  MatrixXld p_of_u(q, 2 * m);
  p_of_u << h * form.F.cast<long double>(), 0.5L * h * form.F.cast<long double>();
  for (const auto& block : form.blocks) {
    const int first = block.first, size = block.size;
    const Phis phi = BlockPhis(block, h * form.L.block(first, first, size, size).cast<long double>());
    const MatrixXld B = form.B.middleRows(first, size).cast<long double>();
    const MatrixXld P = form.P.middleCols(first, size).cast<long double>();
    result.phi.block(first, first, size, size) = phi[0].cast<double>();
    result.gain.block(first, 0, size, m) = (h * phi[1] * B).cast<double>();
    result.gain.block(first, m, size, m) = (h * phi[2] * B).cast<double>();
    result.p_of_z.middleCols(first, size) = (h * P * phi[1]).cast<double>();
    p_of_u.leftCols(m) += h * h * P * phi[2] * B;
    p_of_u.rightCols(m) += h * h * P * phi[3] * B;
  }
  result.p_of_u = p_of_u.cast<double>();
  return result;
}

/// Rows over the form's coordinates and integrators, spread over the state.
MatrixXd Spread(const ModalForm& form, const MatrixXd& of_z, const MatrixXd& of_p) {
  MatrixXd rows = MatrixXd::Zero(of_z.rows(), form.layout.size);
  for (int i = 0; i < of_z.cols(); ++i) rows.col(form.layout.place[i]) = of_z.col(i);
  rows.middleCols(form.layout.integrator_begin, of_p.cols()) = of_p;
  return rows;
}

Range NonZero(const MatrixXd& rows, int first_column) {
  Range range{first_column, first_column};
  bool empty = true;
  for (int i = first_column; i < rows.cols(); ++i) {
    if ((rows.col(i).array() == 0.0).all()) continue;
    if (empty) range.begin = i / StateLayout::kGroup * StateLayout::kGroup;
    range.end = StateLayout::Padded(i + 1);
    empty = false;
  }
  return range;
}

std::vector<Range> Ranges(const MatrixXd& rows) {
  std::vector<Range> ranges;
  for (Eigen::Index i = 0; i < rows.rows(); i += 4) {
    ranges.push_back(NonZero(rows.middleRows(i, std::min<Eigen::Index>(4, rows.rows() - i)), 0));
  }
  return ranges;
}

/// One array for all numbers of a step. It is sized on a first pass and filled on a second.
class Arena {
 public:
  explicit Arena(AlignedVector& values) : values_(values) {}
  /// Zeroed place for `count` doubles on a cache line; null while sizing.
  double* Take(Eigen::Index count) {
    const std::size_t place = used_;
    used_ += StateLayout::Padded(static_cast<int>(count));
    return sizing() ? nullptr : values_.data() + place;
  }
  const double* Rows(const MatrixXd& rows) {
    double* to = Take(rows.size());
    if (!sizing()) {
      for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        for (Eigen::Index j = 0; j < rows.cols(); ++j) to[i * rows.cols() + j] = rows(i, j);
      }
    }
    return to;
  }
  bool sizing() const { return values_.empty(); }
  std::size_t used() const { return used_; }

 private:
  AlignedVector& values_;
  std::size_t used_ = 0;
};

RowSet PlaceRows(Arena& arena, const MatrixXd& rows, const MatrixXd& direct, const std::vector<Range>& ranges) {
  return {arena.Rows(rows),
          (direct.array() == 0.0).all() ? nullptr : arena.Rows(direct),
          ranges.data(),
          static_cast<int>(rows.rows()),
          static_cast<int>(rows.cols()),
          static_cast<int>(direct.cols())};
}

/// Lays the matrices out as the kernels read them.
StepPlan Place(const ModalForm& form, const Discrete& discrete, Arena& arena, std::vector<LargerBlock>& larger) {
  constexpr int kGroup = StateLayout::kGroup;
  const StateLayout& layout = form.layout;
  const int columns = form.inputs();
  StepPlan plan;
  plan.double_groups = layout.pairs / (2 * kGroup);
  plan.last_pairs = layout.pairs % (2 * kGroup);
  plan.record_size = StepPlan::kGainsInRecord + 2 * columns * kGroup;
  plan.reals = layout.reals;
  plan.real_begin = layout.real_begin;
  plan.real_stride = StateLayout::Padded(layout.reals);
  plan.integrator_begin = layout.integrator_begin;
  double* pair_records = arena.Take(StateLayout::Padded(layout.pairs) / kGroup * plan.record_size);
  double* real_phi = arena.Take(plan.real_stride);
  double* real_gain = arena.Take(columns * plan.real_stride);
  plan.pair_records = pair_records;
  plan.real_phi = real_phi;
  plan.real_gain = real_gain;
  larger.clear();
  for (const auto& block : form.blocks) {
    const int first = block.first, place = layout.place[first];
    const bool is_larger = !block.pair && block.size > 1;
    const int padded = StateLayout::Padded(block.size);
    double* phi = is_larger ? arena.Take(padded * block.size) : nullptr;
    double* gain = is_larger ? arena.Take(padded * columns) : nullptr;
    if (is_larger) larger.push_back({phi, gain, place, block.size, padded});
    if (arena.sizing()) continue;
    if (block.pair) {
      double* lane = pair_records + place / (2 * kGroup) * plan.record_size + place % kGroup;
      lane[0] = discrete.phi(first, first);
      lane[kGroup] = discrete.phi(first, first + 1);
      lane[2 * kGroup] = form.outputs() > 0 ? form.C(0, first) : 0.0;
      for (int j = 0; j < columns; ++j) {
        lane[StepPlan::kGainsInRecord + 2 * j * kGroup] = discrete.gain(first, j);
        lane[StepPlan::kGainsInRecord + (2 * j + 1) * kGroup] = discrete.gain(first + 1, j);
      }
    } else if (is_larger) {
      for (int i = 0; i < block.size; ++i) {
        for (int c = 0; c < block.size; ++c) phi[c * padded + i] = discrete.phi(first + i, first + c);
        for (int j = 0; j < columns; ++j) gain[j * padded + i] = discrete.gain(first + i, j);
      }
    } else {
      real_phi[place - layout.real_begin] = discrete.phi(first, first);
      for (int j = 0; j < columns; ++j) {
        real_gain[j * plan.real_stride + place - layout.real_begin] = discrete.gain(first, j);
      }
    }
  }
  plan.larger = larger.data();
  plan.larger_count = static_cast<int>(larger.size());
  return plan;
}

const double* PlaceRigid(const ModalForm& form, const Discrete& discrete, Arena& arena) {
  const auto body = std::find_if(form.blocks.begin(), form.blocks.end(), [](const auto& b) { return b.size == 1; });
  const Eigen::Index columns = form.inputs();
  MatrixXd record(1, 2 + 2 * columns);
  record(0, 0) = discrete.phi(body->first, body->first);
  record(0, 1) = discrete.p_of_z(0, body->first);
  for (Eigen::Index j = 0; j < columns; ++j) {
    record(0, 2 + 2 * j) = discrete.gain(body->first, j);
    record(0, 3 + 2 * j) = discrete.p_of_u(0, j);
  }
  return arena.Rows(record);
}

Failure Refused(const std::string& message) { return {"exact propagation: " + message, "propagator", {}, 2}; }

}  // namespace

Result<Propagator> Propagator::Create(const ModalForm& form, double interval_s, CpuClass cpu_class) {
  if (!(interval_s > 0.0) || !std::isfinite(interval_s)) return Refused("the interval must be positive");
  if (cpu_class > DetectCpuClass()) return Refused("this machine has no " + std::string(ToString(cpu_class)));
  for (const auto& block : form.blocks) {
    if (StateLayout::Padded(block.size) > kMaxBlock) {
      return Refused("a dense block of " + std::to_string(block.size) + " states is too large");
    }
  }
  const Discrete discrete = Discretise(form, interval_s);
  const int m = form.inputs(), q = form.integrators();
  const MatrixXd integrator_rows = Spread(form, discrete.p_of_z, MatrixXd::Zero(q, q));
  const MatrixXd output_rows = Spread(form, form.C, form.E);
  MatrixXd responses(2 * m, form.state_size());
  for (int j = 0; j < m; ++j) {
    for (const int ramp : {0, 1}) {
      const int column = j + ramp * m;
      responses.row(2 * j + ramp) =
          Spread(form, discrete.gain.col(column).transpose(), discrete.p_of_u.col(column).transpose());
    }
  }

  auto coefficients = std::make_shared<Coefficients>();
  coefficients->integrator_ranges = Ranges(integrator_rows);
  coefficients->output_ranges = Ranges(output_rows);
  const Range drawn = q == 1 ? coefficients->integrator_ranges[0] : Range{};
  const bool rigid = form.layout.reals == 1 && q == 1 && form.layout.larger_begin == form.layout.real_begin &&
                     drawn.begin >= form.layout.real_begin && drawn.end <= form.layout.integrator_begin;
  const auto place = [&] {
    Arena arena(coefficients->values);
    StepPlan plan = Place(form, discrete, arena, coefficients->larger);
    plan.integrators = PlaceRows(arena, integrator_rows, discrete.p_of_u.leftCols(m), coefficients->integrator_ranges);
    plan.outputs = PlaceRows(arena, output_rows, form.D, coefficients->output_ranges);
    if (rigid) plan.rigid_record = PlaceRigid(form, discrete, arena);
    plan.responses = arena.Rows(responses);
    plan.state_size = form.state_size();
    return std::pair(plan, arena.used());
  };
  coefficients->values.resize(place().second);

  Propagator result;
  result.plan_ = place().first;
  if (form.outputs() > 0) result.plan_.output_rest = NonZero(output_rows.topRows(1), form.layout.larger_begin);
  result.coefficients_ = std::move(coefficients);
  const Kernels& kernels = KernelsFor(cpu_class);
  result.advance_ = kernels.advance[rigid][Kernels::Variant(m)];
  result.advance_and_output_ = kernels.advance_and_output[rigid][Kernels::Variant(m)];
  result.output_ = kernels.output;
  result.respond_ = kernels.respond;
  result.add_ = kernels.add;
  result.cpu_class_ = cpu_class;
  result.interval_s_ = interval_s;
  result.state_size_ = form.state_size();
  result.inputs_ = m;
  result.held_gain_ = form.C * discrete.gain.leftCols(m) + form.E * discrete.p_of_u.leftCols(m) + form.D;
  result.ramp_gain_ = form.C * discrete.gain.rightCols(m) + form.E * discrete.p_of_u.rightCols(m) + form.D;
  return result;
}

}  // namespace dynoproof::mechanics
