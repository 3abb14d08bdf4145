// SUNDIALS' serial vectors with operations of our own. Debian compiles SUNDIALS without optimisation, and half of an
// integration is spent in these loops.
#pragma once

#include <nvector/nvector_serial.h>

namespace dynoproof {

/// Gives a serial vector, and all that is cloned from it, operations that return the same bits as SUNDIALS' own: each
/// element by the same arithmetic, each sum in the same order. One is not: a linear combination of more than two vectors
/// adds in the order of its terms, in one pass over the data.
void UseOwnOperations(N_Vector vector);

}  // namespace dynoproof
