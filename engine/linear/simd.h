// Vectors of W doubles for inner loops that are compiled once for each class of vector instructions. Internal to the
// kernels.
#pragma once

// The templates hold vectors wider than the baseline's registers. They are inlined into functions that have them; no
// such vector crosses a call, which is all the warning is about.
#pragma GCC diagnostic ignored "-Wpsabi"

#define DYNOPROOF_INLINE [[gnu::always_inline]] static inline

namespace dynoproof::mechanics {

/// W doubles as one value; Memory may sit anywhere in an array of doubles.
template <int W>
struct Vector {
  static constexpr int kWidth = W;
  typedef double Type __attribute__((vector_size(W * sizeof(double))));
  typedef double Memory __attribute__((vector_size(W * sizeof(double)), aligned(8), may_alias));
};

template <class V>
DYNOPROOF_INLINE typename V::Type Load(const double* from) {
  return *reinterpret_cast<const typename V::Memory*>(from);
}
template <class V>
DYNOPROOF_INLINE void Store(double* to, const typename V::Type& value) {
  *reinterpret_cast<typename V::Memory*>(to) = value;
}

}  // namespace dynoproof::mechanics
