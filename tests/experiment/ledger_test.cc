// Every claim of the ledger stands as it says; and the ledger's own rules hold.
#include "experiment/ledger.h"

#include <gtest/gtest.h>

#include <cmath>

#include "experiment/golden.h"
#include "tests/support/build.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

std::vector<Claim> Shipped() {
  Diagnostics diagnostics;
  std::vector<Claim> claims = ReadLedger(GoldenFolder() + "/published.toml", diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.Format();
  return claims;
}

/// Every claim stands as it says, and turns when its figure moves by a little more than its tolerance: none hides
/// everything.
TEST(SlowLedger, EveryClaimStandsAsItSaysWithinItsTolerance) {
  const std::vector<Claim> claims = Shipped();
  EXPECT_GE(claims.size(), 50u);
  for (Claim claim : claims) {
    const ClaimResult result = Reproduce(testing::BuiltIns(), claim);
    EXPECT_TRUE(result.as_expected) << claim.id << ": " << result.fault << " ours "
                                    << (result.ours ? result.ours->value : NAN) << ", published " << claim.published;
    if (claim.expect != "reproduced" || !result.ours) continue;
    claim.published = result.ours->value + 1.01 * claim.tolerance + 1e-12;
    EXPECT_FALSE(Judge(claim, *result.ours).as_expected) << claim.id;
  }
}

TEST(Ledger, AFigureInAnotherUnitIsAFault) {
  for (Claim claim : Shipped()) {
    if (claim.expect != "reproduced") continue;
    claim.unit = claim.unit == "Pa" ? "K" : "Pa";
    const ClaimResult result = Reproduce(testing::BuiltIns(), claim);
    EXPECT_FALSE(result.as_expected);
    EXPECT_NE(result.fault, "");
    return;
  }
  FAIL() << "nothing was tried";
}

}  // namespace
}  // namespace dynoproof
