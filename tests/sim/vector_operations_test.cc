#include "sim/vector_operations.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <sundials/sundials_context.hpp>
#include <type_traits>
#include <utility>

namespace dynoproof {
namespace {

/// A vector with SUNDIALS' operations or our own, filled with numbers of many magnitudes, zeros of both signs among them.
class Vector {
 public:
  Vector(SUNContext context, bool own, unsigned seed) : vector_(N_VNew_Serial(kSize, context), N_VDestroy) {
    if (own) UseOwnOperations(get());
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_int_distribution<int> exponent(-40, 40);
    for (int i = 0; i < kSize; ++i) data()[i] = std::ldexp(normal(random), exponent(random));
    data()[3] = 0.0;
    data()[4] = -0.0;
    data()[5] = 1.0;  // equal in every vector: differences of exactly 0
  }
  N_Vector get() const { return vector_.get(); }
  double* data() const { return NV_DATA_S(get()); }

  static constexpr int kSize = 77;  // no multiple of any vector register

 private:
  std::unique_ptr<std::remove_pointer_t<N_Vector>, decltype(&N_VDestroy)> vector_;
};

/// Lets `change(x, y, z)` act on both kinds; every bit of all three must agree.
template <class Change>
void ExpectSameBits(Change change) {
  sundials::Context context;
  const Vector x(context, false, 1), y(context, false, 2), z(context, false, 3);
  const Vector own_x(context, true, 1), own_y(context, true, 2), own_z(context, true, 3);
  const double result = change(x.get(), y.get(), z.get()), own = change(own_x.get(), own_y.get(), own_z.get());
  EXPECT_EQ(std::bit_cast<std::uint64_t>(result), std::bit_cast<std::uint64_t>(own));
  for (const auto& [theirs, ours] : {std::pair(&x, &own_x), std::pair(&y, &own_y), std::pair(&z, &own_z)}) {
    for (int i = 0; i < Vector::kSize; ++i) {
      EXPECT_EQ(std::bit_cast<std::uint64_t>(theirs->data()[i]), std::bit_cast<std::uint64_t>(ours->data()[i])) << i;
    }
  }
}

TEST(VectorOperations, LinearSumsHaveSundialsBits) {
  for (const double a : {1.0, -1.0, 0.3, -0.3, 7.0}) {
    for (const double b : {1.0, -1.0, 0.3, -0.3, 0.7}) {
      SCOPED_TRACE(::testing::Message() << a << " x + " << b << " y");
      ExpectSameBits([a, b](N_Vector x, N_Vector y, N_Vector z) { return N_VLinearSum(a, x, b, y, z), 0.0; });
      ExpectSameBits([a, b](N_Vector x, N_Vector y, N_Vector) { return N_VLinearSum(a, x, b, y, x), 0.0; });
      ExpectSameBits([a, b](N_Vector x, N_Vector y, N_Vector) { return N_VLinearSum(a, x, b, y, y), 0.0; });
    }
  }
}

TEST(VectorOperations, AllOthersHaveSundialsBits) {
  for (const double c : {1.0, -1.0, 0.3, 0.0}) {
    ExpectSameBits([c](N_Vector x, N_Vector, N_Vector z) { return N_VScale(c, x, z), 0.0; });
    ExpectSameBits([c](N_Vector x, N_Vector, N_Vector) { return N_VScale(c, x, x), 0.0; });
    ExpectSameBits([c](N_Vector x, N_Vector, N_Vector z) { return N_VAddConst(x, c, z), 0.0; });
    ExpectSameBits([c](N_Vector x, N_Vector, N_Vector) { return N_VConst(c, x), 0.0; });
  }
  ExpectSameBits([](N_Vector x, N_Vector y, N_Vector z) { return N_VProd(x, y, z), 0.0; });
  ExpectSameBits([](N_Vector x, N_Vector y, N_Vector z) { return N_VDiv(x, y, z), 0.0; });
  ExpectSameBits([](N_Vector x, N_Vector, N_Vector z) { return N_VAbs(x, z), 0.0; });
  ExpectSameBits([](N_Vector x, N_Vector, N_Vector z) { return N_VInv(x, z), 0.0; });
  ExpectSameBits([](N_Vector x, N_Vector y, N_Vector) { return N_VWrmsNorm(x, y); });
  ExpectSameBits([](N_Vector x, N_Vector y, N_Vector) { return N_VWSqrSumLocal(x, y); });
}

TEST(VectorOperations, ClonesHaveThemToo) {
  sundials::Context context;
  const Vector original(context, true, 1);
  const std::unique_ptr<std::remove_pointer_t<N_Vector>, decltype(&N_VDestroy)> clone(N_VClone(original.get()),
                                                                                      N_VDestroy);
  EXPECT_EQ(clone->ops->nvwrmsnorm, original.get()->ops->nvwrmsnorm);
}

}  // namespace
}  // namespace dynoproof
