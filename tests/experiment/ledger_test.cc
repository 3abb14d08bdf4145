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

TEST(Ledger, EveryClaimStandsAsItSays) {
  const std::vector<Claim> claims = Shipped();
  EXPECT_GE(claims.size(), 50u);
  for (const Claim& claim : claims) {
    const ClaimResult result = Reproduce(testing::BuiltIns(), claim);
    EXPECT_TRUE(result.as_expected) << claim.id << ": " << result.fault << " ours "
                                    << (result.ours ? result.ours->value : NAN) << ", published " << claim.published;
  }
}

/// A claim turns when its figure moves by a little more than its tolerance: no tolerance hides everything.
TEST(Ledger, ReproducedClaimsTurnWhenTheFigureMoves) {
  for (Claim claim : Shipped()) {
    if (claim.expect != "reproduced") continue;
    const ClaimResult before = Reproduce(testing::BuiltIns(), claim);
    ASSERT_TRUE(before.ours.has_value()) << claim.id;
    claim.published = before.ours->value + 1.01 * claim.tolerance + 1e-12;
    EXPECT_FALSE(Reproduce(testing::BuiltIns(), claim).as_expected) << claim.id;
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
