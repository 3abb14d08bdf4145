// What `diagnose` makes of the files it is given: hold-outs, saved fits, map files, MAT files, and records with faults
// that a map could hide.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

#include "tests/support/noisy_record.h"
#include "tests/support/program.h"
#include "trace/csv_write.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;
using trace::Column;
namespace fs = std::filesystem;

constexpr const char* kChanged = "plant.inertia.I3=0.65";  // 30 % more

class DiagnosedData : public ::testing::Test {
 protected:
  /// A record of line.toml with one number changed and white noise of 1 % of what the outputs swing.
  std::vector<Column> Record(const std::vector<std::string>& changes, std::uint64_t seed, double duration_s = 0.6) {
    std::vector<std::string> run = {"line.toml", "--set", "run.duration_s=" + std::to_string(duration_s)};
    for (const std::string& change : changes) run.insert(run.end(), {"--set", change});
    return NoisyRecord(bench_, run, "out/line.h5", {"T_airgap"}, {"T_shaft", "omega_1"}, 0.01, seed);
  }
  /// The record as a foreign system writes it: ms from 5 s on, the torque in kN m and of the other sign, revolutions
  /// per minute, own names.
  static void Disguise(std::vector<Column>& columns) {
    for (double& t : columns[0].values) t = 1e3 * t + 5000.0;
    for (double& torque : columns[1].values) torque *= -1e-3;
    for (double& speed : columns[3].values) speed *= 30.0 / M_PI;
    const char* names[] = {"stamp", "M_luft", "flange", "n"};
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = {.name = names[i], .values = columns[i].values};
  }
  void Write(const std::string& name, const std::vector<Column>& columns) {
    ASSERT_FALSE(trace::WriteCsv(bench_ / name, columns));
  }
  std::vector<std::string> Diagnose(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"diagnose", "line.toml", "--data", "record.csv", "--out", "found"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static void ExpectTheInertia(const nlohmann::json& result) {
    ASSERT_EQ(result["verdict"], "effect_found") << result.dump(1);
    EXPECT_EQ(result["effects"][0]["name"], "inertia_change");
    EXPECT_EQ(result["effects"][0]["at"], "inertia:I3");
    EXPECT_NEAR(result["effects"][0]["parameters"]["delta"]["value"].get<double>(), 0.3, 0.02);
  }

  Bench bench_;
};

TEST_F(DiagnosedData, AHoldOutFileIsWhatTheGainIsMeasuredOn) {
  Write("record.csv", Record({kChanged}, 3));
  Write("other.csv", Record({kChanged, "input.T_airgap.source.amplitude=60.0"}, 4));
  Write("as_drawn.csv", Record({"input.T_airgap.source.amplitude=60.0"}, 5));
  const nlohmann::json same = bench_.Json(Diagnose({"--holdout", "other.csv"}));
  ExpectTheInertia(same);
  const nlohmann::json& gain = same["gain"]["holdout"]["T_shaft"];
  EXPECT_GT(gain["gain_ci95"][0], 0.0) << gain;
  EXPECT_NEAR(gain["nrmse_after"].get<double>(), 0.01, 0.002) << "the noise";
  EXPECT_GT(gain["nrmse_before"].get<double>(), 0.1);
  // A hold-out takes no part in the choice: of another machine it shows a loss, and the cause
  // does not stand.
  const nlohmann::json other = bench_.Json(Diagnose({"--holdout", "as_drawn.csv"}));
  EXPECT_EQ(other["verdict"], "unexplained");
  EXPECT_THAT(other["reason"].get<std::string>(), HasSubstr("does not gain on the hold-out"));
  EXPECT_EQ(other["effects"][0]["parameters"], same["effects"][0]["parameters"]);
  EXPECT_EQ(other["gain"]["train"], same["gain"]["train"]);
  EXPECT_LT(other["gain"]["holdout"]["T_shaft"]["gain_ci95"][1], 0.0) << other["gain"];
  // Faults of a hold-out are found before anything is fitted.
  std::vector<Column> bad = Record({}, 6);
  bad[2].values[17] = std::nan("");
  Write("bad.csv", bad);
  const Outcome refused = bench_.Call(Diagnose({"--holdout", "bad.csv"}));
  EXPECT_EQ(refused.exit, 2) << refused.Both();
  EXPECT_THAT(refused.err, HasSubstr("bad.csv"));
}

TEST_F(DiagnosedData, AHoldOutThatBeginsInMotionGetsAStartOfItsOwn) {
  Write("record.csv", Record({kChanged}, 3));
  std::vector<Column> cut = Record({kChanged, "input.T_airgap.source.amplitude=60.0"}, 4);
  const auto first = static_cast<std::ptrdiff_t>(cut[0].values.size() / 4);
  for (Column& column : cut) column.values.erase(column.values.begin(), column.values.begin() + first);
  ASSERT_GT(std::abs(cut[3].values[0]), 0.05) << "it turns";
  Write("cut.csv", cut);
  const nlohmann::json found = bench_.Json(Diagnose({"--holdout", "cut.csv"}));
  ExpectTheInertia(found);
  for (const auto& [signal, gain] : found["gain"]["holdout"].items()) {
    // The noise is 0.01, and as much comes of a start that 45 noisy rows tell.
    EXPECT_LT(gain["nrmse_after"].get<double>(), 0.02) << signal << gain;
    EXPECT_GT(gain["gain_ci95"][0], 0.5) << signal << gain;
  }
}

TEST_F(DiagnosedData, ASensorAtItsEndIsTakenForThat) {
  std::vector<Column> columns = Record({kChanged}, 3);
  std::vector<double>& torque = columns[2].values;
  const double end = std::round(0.35 * *std::ranges::max_element(torque));
  std::size_t beyond = 0;
  for (double& value : torque) {
    beyond += std::abs(value) > end ? 1 : 0;
    value = std::clamp(value, -end, end);
  }
  ASSERT_GT(beyond, torque.size() / 20);
  Write("record.csv", columns);
  const std::string says = "sensor = [{ type = \"range\", low = ..., high = " + fmt::format("{:.6g}", end) + " }]";
  const Outcome check = bench_.Call({"check-data", "record.csv"});
  EXPECT_THAT(check.Both(), HasSubstr(says));
  const std::string line = ReadBytes(bench_ / "line.toml"), head = "[output.T_shaft]\n";
  ASSERT_NE(line.find(head), std::string::npos);
  std::string told = line;
  told.insert(told.find(head) + head.size(),
              fmt::format("sensor = [{{ type = \"range\", low = {}, high = {} }}]\n", -end, end));
  bench_.Write("line.toml", told);
  ExpectTheInertia(bench_.Json(Diagnose()));
}

TEST_F(DiagnosedData, InterruptedGoesOnToTheSameVerdict) {
  Write("record.csv", Record({kChanged}, 3));
  const nlohmann::json whole = bench_.Json({"diagnose", "line.toml", "--data", "record.csv", "--out", "whole"});
  ExpectTheInertia(whole);
  const fs::path state = bench_ / "found/diagnose_state.json";
  std::thread killer([&] {
    for (int i = 0; i < 30000 && !fs::exists(state); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::string task = "/proc/" + std::to_string(::getpid()) + "/task/" + std::to_string(::getpid());
    std::ifstream children(task + "/children");
    pid_t child = 0;
    if (children >> child) ::kill(child, SIGINT);
  });
  const Outcome stopped = bench_.Call(Diagnose({"--json", "stopped.json", "--html", "stopped.html"}));
  killer.join();
  ASSERT_EQ(stopped.exit, 4) << stopped.Both();
  EXPECT_THAT(stopped.err, HasSubstr("--resume"));
  const nlohmann::json saved = nlohmann::json::parse(ReadBytes(state), nullptr, false);
  ASSERT_TRUE(saved.contains("points")) << "whole, whenever it was stopped";
  for (const char* file : {"stopped.html", "found/extended.toml"}) EXPECT_FALSE(fs::exists(bench_ / file)) << file;
  const nlohmann::json answer = nlohmann::json::parse(ReadBytes(bench_ / "stopped.json"));
  EXPECT_EQ(answer["exit"], 4);
  EXPECT_FALSE(answer.contains("verdict")) << answer;

  const nlohmann::json resumed = bench_.Json(Diagnose({"--resume"}));
  ExpectTheInertia(resumed);
  const auto delta = [](const nlohmann::json& result) -> const nlohmann::json& {
    return result["effects"][0]["parameters"]["delta"];
  };
  // Saved are points to start from: the same optimum is met from another side.
  const double width = delta(whole)["ci95"][1].get<double>() - delta(whole)["ci95"][0].get<double>();
  EXPECT_NEAR(delta(resumed)["value"].get<double>(), delta(whole)["value"].get<double>(), 0.05 * width);
  // Of another record nothing is taken over.
  Write("record.csv", Record({}, 7));
  EXPECT_EQ(bench_.Json(Diagnose({"--resume"}))["verdict"], "no_effect");
}

TEST_F(DiagnosedData, MapsTurnAForeignRecordIntoThisOne) {
  std::vector<Column> columns = Record({kChanged}, 3);
  Write("record.csv", columns);
  const nlohmann::json own = bench_.Json(Diagnose());
  ExpectTheInertia(own);
  Disguise(columns);
  Write("record.csv", columns);
  const std::string good =
      "time = { column = \"stamp\", unit = \"ms\" }\n"
      "[input.T_airgap]\ncolumn = \"M_luft\"\nunit = \"kN m\"\nsign = -1\n"
      "[output.T_shaft]\ncolumn = \"flange\"\n[output.omega_1]\ncolumn = \"n\"\nunit = \"1/min\"\n";
  bench_.Write("map.toml", good);
  const nlohmann::json mapped = bench_.Json(Diagnose({"--map", "map.toml"}));
  ExpectTheInertia(mapped);
  EXPECT_NEAR(mapped["effects"][0]["parameters"]["delta"]["value"].get<double>(),
              own["effects"][0]["parameters"]["delta"]["value"].get<double>(), 1e-4);

  // Whatever is wrong in the map, or what it hides, ends with 2 and says what. The machine is as drawn here: of another
  // one a wrong unit is a gain, and named so.
  columns = Record({}, 3);
  Disguise(columns);
  Write("record.csv", columns);
  const auto with = [&good](const std::string& text, const std::string& other) {
    std::string map = good;
    const std::size_t at = map.find(text);
    return at == std::string::npos ? std::string("no such text") : map.replace(at, text.size(), other);
  };
  for (const auto& [map, answer] : std::vector<std::pair<std::string, std::string>>{
           {with("\"flange\"", "\"flanj\""), "did you mean \"flange\"?"},
           {with("\"flange\"", "\"n\""), "not like its own"},  // the speed compared with the torque
           {with("unit = \"kN m\"", "unit = \"Pa\""), "these are different quantities"},
           {with("unit = \"kN m\"", "unit = \"N m\""), "kilo or milli"},
           {with("unit = \"1/min\"\n", ""), "1/min and rad/s"},
           {with("sign = -1", "sign = 1"), "sign"},
           {with("sign = -1", "sign = -3"), "allowed: -1"},
           {with("[input.T_airgap]", "rows = [7, 9]\n[input.T_airgap]"), "three rows at least"},
           {with("[input.T_airgap]", "rows = [9000, 9500]\n[input.T_airgap]"), "rows begin at"},
           {"[output.T_shaft]\ncolumn = \"flange\"\n", "rate_hz"}}) {
    bench_.Write("map.toml", map);
    for (std::vector<std::string> call :
         {Diagnose({"--map", "map.toml"}),
          {"check-data", "record.csv", "--scenario", "line.toml", "--map", "map.toml"}}) {
      const Outcome outcome = bench_.Call(call);
      EXPECT_EQ(outcome.exit, 2) << map << outcome.Both();
      EXPECT_THAT(outcome.Both(), HasSubstr(answer)) << call[0] << "\n" << map;
    }
  }
}

TEST_F(DiagnosedData, FaultsBehindAMapAreStillFaults) {
  const std::vector<Column> good = Record({}, 3);
  const std::string map =
      "[input.T_airgap]\ncolumn = \"T_airgap\"\n[output.T_shaft]\ncolumn = \"T_shaft\"\n"
      "[output.omega_1]\ncolumn = \"omega_1\"\n";
  bench_.Write("map.toml", map);
  struct Fault {
    const char* says;
    std::function<void(std::vector<Column>&)> spoil;
  };
  for (const Fault& fault :
       std::vector<Fault>{{"first in row 170", [](auto& c) { c[2].values[170] = c[2].values[171] = std::nan(""); }},
                          {"falls at row 100", [](auto& c) { c[0].values[100] = c[0].values[98]; }},
                          {"constant", [](auto& c) { c[3].values.assign(c[3].values.size(), 3.0); }},
                          {"three rows at least", [](auto& c) {
                             for (Column& column : c) column.values.resize(2);
                           }}}) {
    std::vector<Column> columns = good;
    fault.spoil(columns);
    Write("record.csv", columns);
    for (std::vector<std::string> call :
         {Diagnose({"--map", "map.toml"}),
          {"identify", "line.toml", "--data", "record.csv", "--map", "map.toml", "--free", "plant.inertia.I3"}}) {
      const Outcome outcome = bench_.Call(call);
      if (call[0] == "identify" && std::string(fault.says) == "constant") continue;  // a number can be fitted to that
      EXPECT_EQ(outcome.exit, 2) << call[0] << fault.says << outcome.Both();
      EXPECT_THAT(outcome.Both(), HasSubstr(fault.says)) << call[0];
    }
  }
  // A gap is said, and compared around: nothing is filled in.
  std::vector<Column> columns = good;
  for (Column& column : columns) column.values.erase(column.values.begin() + 5000, column.values.begin() + 5200);
  Write("record.csv", columns);
  const Outcome check = bench_.Call({"check-data", "record.csv", "--scenario", "line.toml", "--map", "map.toml"});
  EXPECT_EQ(check.exit, 2) << check.Both();
  EXPECT_THAT(check.Both(), HasSubstr("gap"));
  EXPECT_THAT(check.Both(),
              HasSubstr("200 rows are missing of 6001 in 1 gap, the longest 0.02 s at 0.4999 s (row 5000)"));
}

/// MAT files from outside; what is in them otherwise is the reader's own test.
class DiagnosedMat : public DiagnosedData {
 protected:
  void WriteMat(const std::string& name, const std::vector<Column>& columns, mat_ft version) {
    mat_t* file = Mat_CreateVer((bench_ / name).string().c_str(), nullptr, version);
    ASSERT_NE(file, nullptr);
    for (const Column& column : columns) {
      std::vector<double> values = column.values;
      std::size_t extents[] = {values.size(), 1};
      matvar_t* variable = Mat_VarCreate(column.name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, extents, values.data(), 0);
      ASSERT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE), 0);
      Mat_VarFree(variable);
    }
    Mat_Close(file);
  }
};

TEST_F(DiagnosedMat, AFileOfVersion73GivesTheSameVerdict) {
  const std::vector<Column> columns = Record({kChanged}, 3);
  Write("record.csv", columns);
  const nlohmann::json text = bench_.Json(Diagnose());
  WriteMat("record.mat", columns, MAT_FT_MAT73);
  const nlohmann::json result = bench_.Json({"diagnose", "line.toml", "--data", "record.mat", "--out", "found"});
  ExpectTheInertia(result);
  EXPECT_EQ(result["effects"], text["effects"]) << "the same numbers, from another file";
}

TEST_F(DiagnosedMat, WhatCannotBeReadSaysWhatToDo) {
  const std::vector<Column> columns = Record({}, 3, 0.05);
  WriteMat("record.mat", columns, MAT_FT_MAT5);
  bench_.Write("map.toml", "[output.T_shaft]\ncolumn = \"T_shft\"\n");
  const auto refused = [&](const std::string& answer, const std::vector<std::string>& more) {
    for (const char* command : {"diagnose", "identify"}) {
      std::vector<std::string> call = {command, "line.toml", "--data", "record.mat"};
      if (std::string(command) == "identify") call.insert(call.end(), {"--free", "plant.inertia.I3"});
      call.insert(call.end(), more.begin(), more.end());
      const Outcome outcome = bench_.Call(call);
      EXPECT_EQ(outcome.exit, 2) << outcome.Both();
      EXPECT_THAT(outcome.err, HasSubstr(answer)) << command;
    }
  };
  refused("did you mean \"T_shaft\"?", {"--map", "map.toml"});
  // A timetable beside numbers: class 17 in the array flags of the first matrix.
  std::fstream file(bench_ / "record.mat", std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(128 + 16);
  file.put(17);
  file.close();
  bench_.Write("map.toml", "time = { column = \"t\" }\n[output.T_shaft]\ncolumn = \"t\"\n");
  refused("writetimetable", {"--map", "map.toml"});
}

}  // namespace
}  // namespace dynoproof::test
