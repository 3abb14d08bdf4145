// Static condensation: fast modes of a network follow its slow ones and the inputs at once, as springs do. Unlike
// ModalForm::KeepBelow(), which leaves the slow modes exact, this goes before the decomposition: of a soft rotor's 200
// states some forty are left to decompose.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "linear/linear_system.h"

namespace dynoproof::mechanics {

struct Condensed {
  LinearSystem system;      // of the k states that are kept
  std::vector<int> kept;    // which of the n states they are
  Eigen::MatrixXd follows;  // n x k: all states by those kept, inputs left aside
};

/// Condenses the pairs of states x1' = w x2, x2' = -w x1 + .. (EnergyCoordinates) with w > `above` [rad/s]. Static: x2 = 0
/// and w x1 is all that acts on x2. The forces that act on x2 lose nothing at rest; at the frequency f the compliance of a
/// mode at f_w is too small by (f / f_w)^2 of it, and its dampings couple no more.
Condensed Condense(const LinearSystem& full, double above);

}  // namespace dynoproof::mechanics
