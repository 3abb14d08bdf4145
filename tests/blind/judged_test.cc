#include "tests/blind/judged.h"

#include <gtest/gtest.h>

namespace dynoproof::blind {
namespace {

using nlohmann::json;

Case Hiding(const std::string& effect, const std::string& at) {
  Case hidden;
  hidden.kind = effect.empty() ? "null" : "effect";
  if (!effect.empty()) hidden.causes = {{effect, at, {1.0}}};
  return hidden;
}

Case Inexact(Case hidden, std::set<std::string> near = {}) {
  hidden.inexact = {"hum"};
  hidden.near = std::move(near);
  return hidden;
}

json Naming(const std::string& verdict, const std::vector<std::pair<std::string, std::string>>& effects) {
  json result = {{"verdict", verdict}, {"effects", json::array()}};
  for (const auto& [name, at] : effects) result["effects"].push_back({{"name", name}, {"at", at}});
  return result;
}

json OneOf(const std::vector<std::vector<std::string>>& sets) {
  return {{"verdict", "ambiguous"}, {"effects", json::array()}, {"ambiguous_with", sets}};
}

TEST(Judged, AnExactWorldAsksForTheCauseAloneAndForAllOfIt) {
  const Case hidden = Hiding("sensor_gain", "output:y");
  EXPECT_EQ(Judged(hidden, Naming("effect_found", {{"sensor_gain", "output:y"}})), "right");
  EXPECT_EQ(Judged(hidden, Naming("effect_found", {{"sensor_gain", "output:z"}})), "wrong");
  EXPECT_EQ(Judged(hidden, Naming("effect_found", {{"sensor_gain", "output:y"}, {"sensor_lag", "output:y"}})), "wrong");
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"sensor_gain", "output:y"}})), "abstained");
  EXPECT_EQ(Judged(hidden, OneOf({{"sensor_lag@output:y"}, {"sensor_gain@output:y"}})), "in the set");
  EXPECT_EQ(Judged(hidden, Naming("no_effect", {})), "missed");
  EXPECT_EQ(Judged(hidden, json::object()), "broken");
}

TEST(Judged, NothingHiddenAndAnythingNamedIsAFalseAlarm) {
  const Case hidden = Hiding("", "");
  EXPECT_EQ(Judged(hidden, Naming("no_effect", {})), "right");
  EXPECT_EQ(Judged(hidden, Naming("unexplained", {})), "abstained");
  EXPECT_EQ(Judged(hidden, Naming("effect_found", {{"sensor_gain", "output:y"}})), "false alarm");
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"sensor_gain", "output:y"}})), "false alarm");
  EXPECT_EQ(Judged(hidden, OneOf({{"sensor_gain@output:y"}})), "false alarm");
}

TEST(Judged, AnInexactWorldTakesAMainCauseAndNamesForWhatIsInexactBesideIt) {
  const Case hidden = Inexact(Hiding("inertia_change", "inertia:I3"), {"output:y"});
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"inertia_change", "inertia:I3"}})), "right");
  EXPECT_EQ(Judged(hidden, Naming("effect_found", {{"inertia_change", "inertia:I3"}, {"sensor_lag", "output:y"}})),
            "right");
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"sensor_lag", "output:y"}})), "wrong");
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"inertia_change", "inertia:I3"}, {"sensor_lag", "output:z"}})),
            "wrong");
  EXPECT_EQ(Judged(hidden, OneOf({{"sensor_lag@output:y"}})), "wrong");
}

TEST(Judged, WhatStandsForWhatIsInexactIsNearWhereNothingIsHidden) {
  const Case hidden = Inexact(Hiding("", ""), {"output:y"});
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"sensor_lag", "output:y"}})), "near");
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"sensor_lag", "output:z"}})), "false alarm");
  EXPECT_EQ(Judged(hidden, OneOf({{"sensor_lag@output:y", "sensor_delay@output:y"}})), "near");
  EXPECT_EQ(Judged(hidden, OneOf({{"sensor_lag@output:y", "sensor_lag@output:z"}})), "false alarm");
}

TEST(Judged, EveryDryFrictionAtThePlaceOfFrictionThatCreepsIsTheCause) {
  Case hidden = Inexact(Hiding("coulomb_friction", "inertia:I3"));
  hidden.any_friction = true;
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"stribeck_friction", "inertia:I3"}})), "right");
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"stribeck_friction", "inertia:I2"}})), "wrong");
  EXPECT_EQ(Judged(hidden, Naming("main_cause", {{"viscous_friction", "inertia:I3"}})), "wrong");
}

}  // namespace
}  // namespace dynoproof::blind
