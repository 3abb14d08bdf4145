#include "reduce/reduce.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiment/run_scenario.h"
#include "reduce/moves.h"
#include "reduce/short_form.h"
#include "scenario/load.h"
#include "tests/support/largest_check.h"
#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof::reduce {
namespace {

using ::dynoproof::testing::Largest;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const Registry& Plugins() { return testing::PluginsAndLargest(); }

/// The straight chain for a second, with a load that pulls at I3 with 300 N m, and 150 N m allowed in the last shaft.
Plan PulledChain() {
  Plan plan = testing::LumpedPlan();
  plan.root["title"] = Value("a chain");
  plan.root["input"]["T_airgap"]["source"] =
      Value{{"type", "chirp"}, {"amplitude", 10.0}, {"start_Hz", 0.0}, {"end_Hz", 40.0}, {"rate_Hz_per_s", 40.0}};
  plan.root["plant"]["load"]["pull"] = Value{{"on", "I5"}, {"law", "constant"}, {"T_0_Nm", 300.0}};
  plan.root["output"]["w_2"] = Value{{"of", "plant.I2.speed"}};
  plan.root["output"]["w_3"] = Value{{"of", "plant.I3.speed"}};
  plan.root["check"] = Value(Value::Array{Largest("T_shaft", 150.0), Largest("omega_1", 1e9)});
  return plan;
}

/// The verdict of the named check of a plan.
score::Verdict VerdictOf(const Plan& plan, const std::string& name) {
  Diagnostics diagnostics;
  const auto prepared = Prepare(plan, {}, Plugins(), diagnostics);
  EXPECT_NE(prepared, nullptr) << diagnostics.Format();
  if (prepared == nullptr) return score::Verdict::kBroken;
  for (const score::Check& check : RunScenario(*prepared, {.out = ""}).checks) {
    if (check.name == name) return check.verdict;
  }
  return score::Verdict::kInconclusive;
}

TEST(Reduce, KeepsTheFaultAndLittleElse) {
  const Plan plan = PulledChain();
  ASSERT_EQ(VerdictOf(plan, "largest T_shaft"), score::Verdict::kFail);
  const Result<Reduced> reduced = Reduce(plan, Plugins(), {.check = "largest T_shaft"});
  ASSERT_TRUE(reduced.ok()) << reduced.failure().ToString();
  const std::string text = ShortForm(reduced->plan.root);
  EXPECT_EQ(VerdictOf(reduced->plan, "largest T_shaft"), score::Verdict::kFail) << text;
  EXPECT_LE(reduced->runs, 100);
  EXPECT_LT(static_cast<double>(LinesOf(text)), 0.25 * static_cast<double>(reduced->lines_before)) << text;
  EXPECT_LT(static_cast<double>(ValuesOf(reduced->plan.root)), 0.5 * static_cast<double>(reduced->values_before));
  EXPECT_LE(reduced->plan.root.NumberOr("run.duration_s", 1.0), 0.05);
  // The cause is what pulls: without it nothing fails.
  EXPECT_NE(reduced->plan.root.FindPath("plant.load.pull"), nullptr) << text;
  EXPECT_EQ(reduced->plan.root.FindPath("output.w_2"), nullptr) << text;
  EXPECT_THAT(reduced->plan.root.FindPath("plant.inertia")->table(), SizeIs(2)) << "the others are one with these\n"
                                                                                << text;
  Plan without = plan;
  without.root["plant"]["load"].Erase("pull");
  EXPECT_EQ(VerdictOf(without, "largest T_shaft"), score::Verdict::kPass);
}

TEST(Reduce, KeepsWhatAnotherProgramNeedsToPass) {
  std::vector<std::string> asked;
  Options options{.check = "largest T_shaft"};
  // A program that is sound as long as it sees the second inertia's speed.
  options.sound = [&](const Plan& plan, const std::string& check) {
    asked.push_back(check);
    return plan.root.FindPath("output.w_2") != nullptr;
  };
  const Result<Reduced> reduced = Reduce(PulledChain(), Plugins(), options);
  ASSERT_TRUE(reduced.ok()) << reduced.failure().ToString();
  EXPECT_NE(reduced->plan.root.FindPath("output.w_2"), nullptr);
  EXPECT_EQ(reduced->plan.root.FindPath("output.w_3"), nullptr);
  EXPECT_THAT(asked, ::testing::Each("largest T_shaft"));
  options.sound = [](const Plan&, const std::string&) { return false; };
  const Result<Reduced> none = Reduce(PulledChain(), Plugins(), options);
  ASSERT_FALSE(none.ok());
  EXPECT_THAT(none.failure().message, HasSubstr("the other program fails this check as well"));
}

TEST(Reduce, KeepsWhatTheGoodScenarioNeedsToPass) {
  // Without the load nothing fails; a check for what the chirp does to the first inertia's speed would fail at rest in either.
  Plan good = PulledChain();
  good.root["plant"]["load"].Erase("pull");
  const Result<Reduced> reduced = Reduce(PulledChain(), Plugins(), {.check = "largest T_shaft", .good = good});
  ASSERT_TRUE(reduced.ok()) << reduced.failure().ToString();
  Plan without = reduced->plan;
  without.root["plant"].Erase("load");
  EXPECT_EQ(VerdictOf(reduced->plan, "largest T_shaft"), score::Verdict::kFail);
  EXPECT_EQ(VerdictOf(without, "largest T_shaft"), score::Verdict::kPass);
  // What fails there as well is no fault of the load: then nothing is held to it.
  good.root["check"] = Value(Value::Array{Largest("T_shaft", 1e-9)});
  EXPECT_TRUE(Reduce(PulledChain(), Plugins(), {.check = "largest T_shaft", .good = good}).ok());
}

TEST(Reduce, TakesTheWorstWhereNoneIsNamed) {
  const Result<Reduced> reduced = Reduce(PulledChain(), Plugins(), {.most_runs = 5});
  ASSERT_TRUE(reduced.ok());
  EXPECT_EQ(reduced->check, "largest T_shaft");
  EXPECT_FALSE(reduced->complete);
  EXPECT_LE(reduced->runs, 5);
}

TEST(Reduce, AsksWhoSaidNoLastAndNobodyTwice) {
  // The other program refuses whatever loses the second inertia's speed: it is asked first then, and a no spares the run of this one.
  std::vector<std::string> asked;
  int refused = 0;
  bool just_refused = false;
  Options options{.check = "largest T_shaft"};
  options.sound = [&](const Plan& plan, const std::string&) {
    asked.push_back(ToToml(plan.root));
    just_refused = plan.root.FindPath("output.w_2") == nullptr;
    refused += just_refused ? 1 : 0;
    return !just_refused;
  };
  options.progress = [&](const std::string& what, int runs) {
    EXPECT_FALSE(just_refused) << "run " << runs << " without " << what;
  };
  const Result<Reduced> reduced = Reduce(PulledChain(), Plugins(), options);
  ASSERT_TRUE(reduced.ok()) << reduced.failure().ToString();
  EXPECT_TRUE(reduced->complete);
  EXPECT_GE(refused, 2);
  std::ranges::sort(asked);
  EXPECT_EQ(std::ranges::adjacent_find(asked), asked.end());
}

TEST(Reduce, TriesNothingThatMakesTheScenarioTheGoodOne) {
  // The load is all that tells the two apart: what takes it leaves nothing to find.
  Options options{.check = "largest T_shaft", .good = PulledChain()};
  options.good->root["plant"]["load"].Erase("pull");
  int asked = 0;
  options.sound = [&](const Plan& plan, const std::string&) {
    ++asked;
    EXPECT_NE(plan.root.FindPath("plant.load.pull"), nullptr) << ToToml(plan.root);
    return true;
  };
  const Result<Reduced> reduced = Reduce(PulledChain(), Plugins(), options);
  ASSERT_TRUE(reduced.ok()) << reduced.failure().ToString();
  EXPECT_TRUE(reduced->complete);
  EXPECT_GE(asked, 10);
}

TEST(Reduce, SaysWhatFailsWhereTheNameIsWrong) {
  const Result<Reduced> reduced = Reduce(PulledChain(), Plugins(), {.check = "golden T_shaft"});
  ASSERT_FALSE(reduced.ok());
  EXPECT_EQ(reduced.failure().exit_code, 1);
  EXPECT_THAT(reduced.failure().message, HasSubstr("these fail: largest T_shaft"));
}

TEST(Reduce, HasNothingToDoWhereAllPasses) {
  Plan plan = PulledChain();
  plan.root["check"] = Value(Value::Array{Largest("T_shaft", 1e9)});
  const Result<Reduced> reduced = Reduce(plan, Plugins(), {});
  ASSERT_FALSE(reduced.ok());
  EXPECT_EQ(reduced.failure().exit_code, 1);
  EXPECT_THAT(reduced.failure().message, HasSubstr("no check fails"));
}

TEST(Reduce, KeepsARunThatBreaksForTheSameReason) {
  Plan plan = PulledChain();
  plan.root["output"]["omega_1"]["sensor"] = Value(Value::Array{Value{{"type", "gain"}, {"gain", 1e308}}});
  plan.root["input"]["T_airgap"]["source"] = Value{{"type", "constant"}, {"value", 1e12}};
  const Result<Reduced> reduced = Reduce(plan, Plugins(), {});
  ASSERT_TRUE(reduced.ok()) << reduced.failure().ToString();
  EXPECT_EQ(reduced->check, "run");
  Diagnostics diagnostics;
  const auto prepared = Prepare(reduced->plan, {}, Plugins(), diagnostics);
  ASSERT_NE(prepared, nullptr) << diagnostics.Format();
  EXPECT_THAT(RunScenario(*prepared, {.out = ""}).broken, HasSubstr("omega_1"));
}

TEST(ReduceMoves, ARigidShaftAddsUpItsInertias) {
  Value root = testing::LumpedPlan().root;
  const std::vector<Group> groups = GroupsOf(root, {});
  const auto bodies = std::ranges::find(groups, "bodies", &Group::what);
  ASSERT_NE(bodies, groups.end());
  ASSERT_THAT(bodies->moves, SizeIs(4));
  EXPECT_EQ(bodies->moves.front().what, "shaft k1 is rigid") << "the stiffest first";
  const double before = 25.082 + 6.352;
  Apply({bodies->moves.front()}, root);
  EXPECT_DOUBLE_EQ(root.NumberOr("plant.inertia.I1", 0.0), before);
  EXPECT_EQ(root.FindPath("plant.inertia.I2"), nullptr);
  EXPECT_EQ(root.TextOr("plant.shaft.k2.between.0"), "I1");
}

TEST(ReduceMoves, AJointBodyKeepsTheNameOfTheOneThatWasChanged) {
  Value root = testing::LumpedPlan().root;
  const std::vector<Group> groups = GroupsOf(root, {}, {}, {"plant.inertia.I2"});
  const auto bodies = std::ranges::find(groups, "bodies", &Group::what);
  ASSERT_NE(bodies, groups.end());
  Apply({bodies->moves.front()}, root);
  EXPECT_EQ(root.FindPath("plant.inertia.I1"), nullptr);
  EXPECT_DOUBLE_EQ(root.NumberOr("plant.inertia.I2", 0.0), 25.082 + 6.352);
}

TEST(Reduce, ANumberThatIsWrongStaysUnderItsName) {
  // The first shaft takes along all that is behind it, of which the third inertia is a small part.
  Plan good = PulledChain();
  good.root["plant"]["load"]["pull"]["on"] = Value("I1");
  good.root["output"]["T_shaft"]["of"] = Value("plant.k1.torque");
  Plan wrong = good;
  const double right = good.root.NumberOr("plant.inertia.I3", 0.0);
  wrong.root["plant"]["inertia"]["I3"] = Value(10.0 * right);
  const auto largest = [](const Plan& plan) {
    Diagnostics diagnostics;
    const auto prepared = Prepare(plan, {}, Plugins(), diagnostics);
    EXPECT_NE(prepared, nullptr) << diagnostics.Format();
    const auto checks = prepared != nullptr ? RunScenario(*prepared, {.out = ""}).checks : std::vector<score::Check>();
    const auto own = std::ranges::find(checks, "largest T_shaft", &score::Check::name);
    return own != checks.end() ? own->value : 0.0;
  };
  const double less = largest(good), more = largest(wrong);
  ASSERT_GT(more, 1.02 * less);
  for (Plan* plan : {&good, &wrong}) plan->root["check"] = Value(Value::Array{Largest("T_shaft", 0.5 * (less + more))});
  const Result<Reduced> reduced = Reduce(wrong, Plugins(), {.check = "largest T_shaft", .good = good});
  ASSERT_TRUE(reduced.ok()) << reduced.failure().ToString();
  const std::string text = ShortForm(reduced->plan.root);
  Plan mended = reduced->plan;
  Value* number = mended.root.FindPath("plant.inertia.I3");
  ASSERT_NE(number, nullptr) << text;
  *number = Value(number->number() - 9.0 * right);
  EXPECT_EQ(VerdictOf(reduced->plan, "largest T_shaft"), score::Verdict::kFail) << text;
  EXPECT_EQ(VerdictOf(mended, "largest T_shaft"), score::Verdict::kPass) << text;
  EXPECT_LT(reduced->plan.root.FindPath("plant.inertia")->table().size(), 5U) << "others are one with it\n" << text;
}

TEST(ReduceMoves, ARotorBecomesOneInertia) {
  Value root = testing::SoftPlan().root;
  const std::vector<Group> groups = GroupsOf(root, {});
  const auto rotors = std::ranges::find(groups, "rotors", &Group::what);
  ASSERT_NE(rotors, groups.end());
  Apply(rotors->moves, root);
  EXPECT_DOUBLE_EQ(root.NumberOr("plant.inertia.I1", 0.0), 25.308);
  EXPECT_EQ(root.FindPath("plant.rotor"), nullptr);
  EXPECT_EQ(root.FindPath("plant.torque.T_airgap.slices"), nullptr);
}

TEST(ReduceMoves, ItemsOfAListGoByTheirOwnNumbers) {
  Value root = Value{{"effect", Value(Value::Array{Value{{"name", "a"}}, Value{{"name", "b"}}, Value{{"name", "c"}}})}};
  const std::vector<Group> groups = GroupsOf(root, {});
  const auto group = std::ranges::find(groups, "effects", &Group::what);
  ASSERT_NE(group, groups.end());
  Apply({group->moves[0], group->moves[2]}, root);
  ASSERT_THAT(root.Find("effect")->array(), SizeIs(1));
  EXPECT_EQ(root.TextOr("effect.0.name"), "b");
}

TEST(ReduceMoves, APartGoesWithAllThatNamesIt) {
  Value root = testing::LumpedPlan().root;
  root["output"]["w_5"] = Value{{"of", "plant.I5.speed"}};
  root["plant"]["load"]["pull"] = Value{{"on", "I5"}, {"law", "constant"}, {"T_0_Nm", 300.0}};
  const auto part = [&](const std::vector<std::string>& kept, const std::string& what) {
    const std::vector<Group> groups = GroupsOf(root, kept);
    const auto parts = std::ranges::find(groups, "parts", &Group::what);
    return *std::ranges::find(parts->moves, what, &Move::what);
  };
  Value kept = root;
  EXPECT_FALSE(part({"T_shaft"}, "plant.inertia.I5").apply(kept)) << "T_shaft is the torque of the shaft at I5";
  EXPECT_EQ(ToToml(kept), ToToml(root));
  Apply({part({"omega_1"}, "plant.inertia.I5")}, root);
  for (const char* gone : {"plant.inertia.I5", "plant.shaft.k4", "plant.load.pull", "output.w_5", "output.T_shaft"})
    EXPECT_EQ(root.FindPath(gone), nullptr) << gone;
  EXPECT_NE(root.FindPath("plant.shaft.k3"), nullptr);
  EXPECT_NE(root.FindPath("output.omega_1"), nullptr);
}

TEST(ReduceMoves, ALoopThroughAControlIsOpened) {
  Value root = Value{{"control", Value{{"pi", Value{{"type", "x"}, {"inputs", Value{{"speed", "output.w"}}}}}}},
                     {"input", Value{{"T", Value{{"to", "plant.T"}, {"from", "control.pi.torque"}}},
                                     {"ref", Value{{"to", "control.pi.reference"}}}}},
                     {"output", Value{{"w", Value{{"of", "plant.I1.speed"}}}}}};
  const std::vector<Group> groups = GroupsOf(root, {"w"});
  const auto parts = std::ranges::find(groups, "parts", &Group::what);
  ASSERT_NE(parts, groups.end());
  Apply(parts->moves, root);
  EXPECT_EQ(root.Find("control"), nullptr);
  EXPECT_EQ(root.FindPath("input.ref"), nullptr);
  EXPECT_EQ(root.TextOr("input.T.source.type"), "constant");
  EXPECT_NE(root.FindPath("output.w"), nullptr);
}

TEST(ReduceMoves, AnInputWhoseControlGoesStaysAtItsLevel) {
  Value root = Value{
      {"control", Value{{"pi", Value{{"type", "x"}}}}},
      {"part", Value{{"im1", Value{{"type", "y"}}}}},
      {"plant", Value{{"inputs", Value{{"T_1", "part.im1.torque"}}}, {"torque", Value{{"T_1", Value{{"on", "I1"}}}}}}},
      {"input", Value{{"T", Value{{"to", "plant.T"}, {"from", "control.pi.torque"}}}}}};
  const std::vector<Group> groups = GroupsOf(root, {}, {{"input.T", 7.0}, {"part.im1.torque", 2.5}});
  const auto parts = std::ranges::find(groups, "parts", &Group::what);
  ASSERT_NE(parts, groups.end());
  for (const char* part : {"control.pi", "part.im1"})
    Apply({*std::ranges::find(parts->moves, part, &Move::what)}, root);
  EXPECT_EQ(root.NumberOr("input.T.source.value", 0.0), 7.0);
  EXPECT_EQ(root.FindPath("plant.inputs"), nullptr);
  EXPECT_EQ(root.TextOr("input.T_1.to"), "plant.T_1");
  EXPECT_EQ(root.NumberOr("input.T_1.source.value", 0.0), 2.5);
  EXPECT_NE(root.FindPath("plant.torque.T_1"), nullptr);
}

TEST(ReduceMoves, WhatAMachineDrivesTakesWhatItIsAskedFor) {
  const Value machine{{"type", "machine"}, {"inputs", Value{{"u", "control.field.u"}}}};
  const Value field{{"type", "field"}, {"inputs", Value{{"torque", "control.core.T_ref"}, {"i", "part.im.i"}}}};
  Value root = Value{{"part", Value{{"im", machine}}},
                     {"control", Value{{"field", field}, {"core", Value{{"type", "core"}}}}},
                     {"plant", Value{{"inputs", Value{{"T", "part.im.torque"}}}}}};
  const auto shortcut = [](Value& tree) {
    const std::vector<Group> groups = GroupsOf(tree, {});
    const auto group = std::ranges::find(groups, "shortcuts", &Group::what);
    ASSERT_NE(group, groups.end());
    Apply(group->moves, tree);
  };
  Value by_input = root;
  shortcut(root);
  EXPECT_EQ(root.TextOr("plant.inputs.T"), "control.core.T_ref");
  EXPECT_EQ(root.FindPath("part"), nullptr);
  EXPECT_EQ(root.FindPath("control.field"), nullptr);
  EXPECT_NE(root.FindPath("control.core"), nullptr);
  // Asked by an input, which goes straight to the plant then.
  by_input["control"]["field"]["inputs"].Erase("torque");
  by_input["input"]["T_set"] =
      Value{{"to", "control.field.torque"}, {"source", Value{{"type", "constant"}, {"value", 3.0}}}};
  shortcut(by_input);
  EXPECT_EQ(by_input.TextOr("input.T_set.to"), "plant.T");
  EXPECT_EQ(by_input.FindPath("plant.inputs"), nullptr);
  EXPECT_EQ(by_input.FindPath("part"), nullptr);
}

TEST(ReduceMoves, WhatIsSeenOfARigidShaftIsSeenOfItsNeighbour) {
  Value root = testing::LumpedPlan().root;
  ASSERT_EQ(root.TextOr("output.T_shaft.of"), "plant.k4.torque");
  const std::vector<Group> groups = GroupsOf(root, {"T_shaft"});
  const auto bodies = std::ranges::find(groups, "bodies", &Group::what);
  Apply({*std::ranges::find(bodies->moves, "shaft k4 is rigid", &Move::what)}, root);
  EXPECT_EQ(root.TextOr("output.T_shaft.of"), "plant.k3.torque");
  EXPECT_EQ(root.FindPath("plant.inertia.I5"), nullptr);
}

TEST(ReduceMoves, AVariantGoesFromTheListsOfTheChecks) {
  Value root = Value{{"variant", Value{{"a", Value{{"x", 1.0}}}, {"b", Value{{"x", 2.0}}}}},
                     {"check", Value(Value::Array{Value{{"alike", Value(Value::Array{"a", "b"})}}})}};
  const std::vector<Group> groups = GroupsOf(root, {});
  const auto variants = std::ranges::find(groups, "variants", &Group::what);
  ASSERT_NE(variants, groups.end());
  Apply({variants->moves.back()}, root);
  EXPECT_EQ(root.FindPath("variant.b"), nullptr);
  ASSERT_THAT(root.FindPath("check.0.alike")->array(), SizeIs(1));
  EXPECT_EQ(root.TextOr("check.0.alike.0"), "a");
}

TEST(ReduceMoves, WhatAVariantConnectsIsConnectedSoForAll) {
  Value root = Value{{"control", Value{{"new", Value{{"type", "x"}}}, {"old", Value{{"type", "y"}}}}},
                     {"input", Value{{"u", Value{{"to", "plant.u"}, {"from", "control.new.u"}}}}},
                     {"variant", Value{{"old", Value{{"input", Value{{"u", Value{{"from", "control.old.u"}}}}}}},
                                       {"stiff", Value{{"plant", Value{{"k", 2.0}}}}}}}};
  const auto apply = [&](const char* name, const char* what) {
    const std::vector<Group> groups = GroupsOf(root, {});
    const auto group = std::ranges::find(groups, name, &Group::what);
    ASSERT_NE(group, groups.end());
    Apply({*std::ranges::find(group->moves, what, &Move::what)}, root);
  };
  apply("wiring of variants", "all as in variant.old");
  EXPECT_EQ(root.TextOr("input.u.from"), "control.old.u");
  EXPECT_EQ(root.FindPath("plant.k"), nullptr) << "of another variant, which connects nothing";
  apply("parts", "control.new");
  EXPECT_EQ(root.TextOr("input.u.from"), "control.old.u");
  EXPECT_NE(root.FindPath("variant.old"), nullptr);
}

TEST(ReduceMoves, ChecksLoseKeysAndItemsButNotWhatTheyAre) {
  const Value root = Value{{"check", Value(Value::Array{Value{{"kind", "growth"},
                                                              {"window_s", 0.1},
                                                              {"notches", Value(Value::Array{"n_1", "n_2"})},
                                                              {"origin", "seen"}}})}};
  std::vector<std::string> paths;
  for (const Move& move : KeysOfChecks(root).moves) paths.push_back(move.what);
  EXPECT_THAT(paths,
              ::testing::ElementsAre("check.0.window_s", "check.0.notches", "check.0.notches.0", "check.0.notches.1"));
}

TEST(ReduceMoves, ChecksLookForTheLastTime) {
  const auto last = [](Value check) { return LastLookOf(Value{{"check", Value(Value::Array{std::move(check)})}}); };
  EXPECT_EQ(last(Value{{"kind", "golden"}}), 0.0);
  EXPECT_EQ(last(Value{{"until_s", 0.1}}), 0.1);
  EXPECT_EQ(last(Value{{"during_s", Value(Value::Array{1.0, 3.0})}}), 3.0);
  EXPECT_EQ(last(Value{{"second_s", 0.5}, {"window_s", 0.25}, {"tolerance_per_s", 9.0}}), 0.75);
}

TEST(ReduceMoves, EventsComeEarlier) {
  Value root = Value{{"run", Value{{"duration_s", 4.0}}},
                     {"input", Value{{"u", Value{{"source", Value{{"time_s", 2.0}, {"rate_Hz_per_s", 3.0}}}}}}},
                     {"check", Value(Value::Array{Value{{"during_s", Value(Value::Array{1.0, 3.0})}}})}};
  EXPECT_TRUE(Earlier(0.25).apply(root));
  EXPECT_EQ(root.NumberOr("run.duration_s", 0.0), 1.0);
  EXPECT_EQ(root.NumberOr("input.u.source.time_s", 0.0), 0.5);
  EXPECT_EQ(root.NumberOr("input.u.source.rate_Hz_per_s", 0.0), 3.0);
  EXPECT_EQ(root.NumberOr("check.0.during_s.1", 0.0), 0.75);
}

TEST(ReduceMoves, AnInputRestsWhereItBegins) {
  Value root =
      Value{{"input", Value{{"u", Value{{"source", Value{{"type", "step"}, {"initial", 2.0}, {"value", 5.0}}}}}}}};
  const std::vector<Group> groups = GroupsOf(root, {});
  for (const auto& [what, value] : {std::pair("inputs that rest", 2.0), std::pair("inputs that step", 5.0)}) {
    Value tree = root;
    Apply(std::ranges::find(groups, what, &Group::what)->moves, tree);
    EXPECT_EQ(tree.TextOr("input.u.source.type"), "constant");
    EXPECT_EQ(tree.NumberOr("input.u.source.value", 0.0), value);
  }
}

TEST(ReduceMoves, RoundsToDigits) {
  EXPECT_EQ(Rounded(25.082, 2), 25.0);
  EXPECT_EQ(Rounded(-0.0123456, 3), -0.0123);
  EXPECT_EQ(Rounded(6.28e6, 1), 6e6);
}

}  // namespace
}  // namespace dynoproof::reduce
