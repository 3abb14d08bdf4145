// The second solver's samples, kept from one run to the next: what nothing has changed since need not be integrated again.
#pragma once

#include <optional>
#include <string>

#include "base/status.h"
#include "sim/simulate.h"

namespace dynoproof {

struct Prepared;

/// The samples of `reference` for one scenario, as a trace under FOLDER/ID.reference.h5. They stand for a run that would give the
/// same bits: of the same scenario (whatever it checks, however it is called), the same records that its sources play, the same
/// code (program, shared libraries, plugins) on the same class of processors. A gate computes both solvers; this is for a person
/// who changes checks and limits.
class KeptReference {
 public:
  KeptReference(const std::string& folder, const Prepared& prepared);

  /// The samples that are kept; nothing where there are none, where they were computed from anything else, or where the file
  /// cannot be read.
  std::optional<Samples> Find() const;

  /// Puts these samples in the place of what was kept. Failure (exit code 3): as WriteTrace().
  Status Keep(const Samples& samples) const;

  const std::string& file() const { return file_; }

 private:
  const Rig& rig_;
  std::string file_, scenario_, records_;
};

}  // namespace dynoproof
