// An installation, moved away from where it was made: the program with its own data, and plugins of somebody else, the
// templates of `dynoproof new` built against the installed headers, loaded, run, and a plant with effects, diagnosed;
// and libraries that must not be loaded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>

#include "tests/support/noisy_record.h"
#include "tests/support/program.h"
#include "trace/csv_write.h"

namespace dynoproof::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// Installs the build once for all tests of this program, moves it, and builds both templates against it.
class Plugins : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (bench_ != nullptr) return;
    bench_ = std::make_unique<Bench>();
    Shell("cmake --install '" DYNOPROOF_BUILD "' --strip --prefix '" + (*bench_ / "first").string() + "'");
    fs::rename(*bench_ / "first", *bench_ / "prefix");
    for (const auto& [kind, name] : {std::pair("law", "soft_stop"), std::pair("effect", "extra_mass")}) {
      const Outcome made = bench_->Call({"new", kind, name}, {.program = (*bench_ / "prefix/bin/dynoproof").string()});
      ASSERT_EQ(made.exit, 0) << made.Both();
      Shell(std::string("cmake -S ") + name + " -B " + name +
            "/build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS='" DYNOPROOF_PLUGIN_FLAGS "' -DCMAKE_PREFIX_PATH='" +
            (*bench_ / "prefix").string() + "' && cmake --build " + name + "/build");
    }
    std::string text = Bench::kLine;
    text.erase(text.find("[[check]]\nkind = \"oracle\""));
    const std::string spring = "stiffness_Nm_per_rad = 2.5e5\n";
    text.replace(text.find(spring), spring.size(), spring + "law = \"soft_stop\"\nlimit_Nm = 20.0\n");
    text.replace(text.find("nrmse = 1e-6"), 12, "nrmse = 1e-2");
    bench_->Write("stop.toml", text);
    bench_->Write("mass.toml",
                  std::string(Bench::kLine) +
                      "\n[[effect]]\nname = \"extra_mass\"\nat = \"inertia:I3\"\nparameters = { I_extra = 0.1 }\n");
  }
  static void Shell(const std::string& command) {
    const Outcome outcome = bench_->Call({"-c", command}, {.program = "sh"});
    ASSERT_EQ(outcome.exit, 0) << command << outcome.Both();
  }

  static constexpr const char* kLaw = "soft_stop/build/soft_stop.so";
  static constexpr const char* kEffect = "extra_mass/build/extra_mass.so";
  static std::unique_ptr<Bench> bench_;  // of all suites here
};
std::unique_ptr<Bench> Plugins::bench_;

TEST_F(Plugins, LawOfTheTemplateRuns) {
  EXPECT_EQ(bench_->Call({"validate", "stop.toml"}).exit, 2) << "unknown without its library";
  const Outcome described = bench_->Call({"describe", "soft_stop", "--plugin", kLaw});
  EXPECT_EQ(described.exit, 0) << described.Both();
  EXPECT_THAT(described.out, HasSubstr("limit_Nm"));
  const nlohmann::json result = bench_->Json({"run", "stop.toml", "--plugin", kLaw});
  EXPECT_EQ(result["exit"], 0) << result.dump(2);
  const nlohmann::json negative =
      bench_->Json({"run", "stop.toml", "--plugin", kLaw, "--set", "plant.shaft.k2.limit_Nm=1e9"});
  EXPECT_EQ(negative["exit"], 0);
  EXPECT_NE(ReadBytes(*bench_ / "out/stop.h5"), "");
  const Outcome wrong = bench_->Call({"run", "stop.toml", "--plugin", kLaw, "--set", "plant.shaft.k2.limit_Nm=-1"});
  EXPECT_EQ(wrong.exit, 2) << "its parameters are checked like those of a built-in law";
  EXPECT_THAT(wrong.err, HasSubstr("\"limit_Nm\" in law.soft_stop \"k2\" is -1"));
}

TEST_F(Plugins, EffectOfTheTemplateDoesWhatItSays) {
  const nlohmann::json with = bench_->Json({"modes", "mass.toml", "--plugin", kEffect});
  const nlohmann::json by_hand = bench_->Json({"modes", "line.toml", "--set", "plant.inertia.I3=0.6"});
  EXPECT_EQ(with["modes"], by_hand["modes"]);
  EXPECT_EQ(bench_->Call({"run", "mass.toml", "--plugin", kEffect}).exit, 0);
  EXPECT_EQ(bench_->Call({"run", "mass.toml", "--plugin", kEffect, "--set", "effect.0.parameters.I_extra=1e3"}).exit,
            2);
}

/// A plant and effects that were built out of the tree.
class Diagnosed : public Plugins {
 protected:
  static void SetUpTestSuite() {
    Plugins::SetUpTestSuite();
    const fs::path sources = fs::current_path() / "tests/acceptance/heated_block";
    Shell("cmake -S '" + sources.string() +
          "' -B block -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS='" DYNOPROOF_PLUGIN_FLAGS "' -DCMAKE_PREFIX_PATH='" +
          (*bench_ / "prefix").string() + "' && cmake --build block");
    fs::copy_file(sources / "block.toml", *bench_ / "block.toml", fs::copy_options::skip_existing);
  }
  /// The effect found in a record of the block with this effect hidden in it, with 1 % of noise.
  static nlohmann::json Found(const std::string& hidden) {
    bench_->Write("hidden.toml", "include = [\"block.toml\"]\n[[effect]]\n" + hidden);
    const std::vector<trace::Column> columns =
        NoisyRecord(*bench_, {"hidden.toml", "--plugin", kBlock}, "out/hidden.h5", {"P"}, {"T"});
    EXPECT_FALSE(trace::WriteCsv(*bench_ / "block.csv", columns));
    const nlohmann::json result = bench_->Json({"diagnose", "block.toml", "--plugin", kBlock, "--data", "block.csv"});
    EXPECT_EQ(result["verdict"], "effect_found") << result.dump(1);
    return result["effects"].empty() ? nlohmann::json() : result["effects"][0];
  }
  static void ExpectAround(const nlohmann::json& parameter, double truth) {
    EXPECT_LT(parameter["ci95"][0], truth) << parameter.dump();
    EXPECT_GT(parameter["ci95"][1], truth) << parameter.dump();
  }
  static constexpr const char* kBlock = "block/heated_block.so";
};

TEST_F(Diagnosed, AnEffectOfAPluginInAPlantOfAPlugin) {
  const nlohmann::json found = Found("name = \"radiation\"\nat = \"surface:block\"\nparameters = { A = 0.03 }\n");
  EXPECT_EQ(found["name"], "radiation");
  EXPECT_EQ(found["at"], "surface:block");
  ExpectAround(found["parameters"]["A"], 0.03);
}

TEST_F(Diagnosed, AnEffectOfAPluginThatChangesANuisanceParameterOfThePlant) {
  const nlohmann::json found = Found("name = \"fouling\"\nat = \"surface:block\"\nparameters = { delta = -0.4 }\n");
  EXPECT_EQ(found["name"], "fouling");
  ExpectAround(found["parameters"]["delta"], -0.4);
}

TEST_F(Diagnosed, ABuiltInEffectInAPlantOfAPlugin) {
  const nlohmann::json found = Found("name = \"sensor_lag\"\nat = \"output:T\"\nparameters = { tau = 0.5 }\n");
  EXPECT_EQ(found["name"], "sensor_lag");
  EXPECT_EQ(found["at"], "output:T");
  ExpectAround(found["parameters"]["tau"], 0.5);
}

TEST_F(Plugins, AreFoundOnThePath) {
  const CallOptions path{.environment = {{"DYNOPROOF_PLUGIN_PATH", std::string(kLaw) + ":extra_mass/build"}}};
  EXPECT_EQ(bench_->Call({"validate", "stop.toml", "mass.toml"}, path).exit, 0);
  const Outcome list = bench_->Call({"list"}, path);
  EXPECT_THAT(list.out, HasSubstr("law.soft_stop"));
  EXPECT_THAT(list.out, HasSubstr("extra_mass"));
  const CallOptions wrong{.environment = {{"DYNOPROOF_PLUGIN_PATH", "nowhere"}}};
  const Outcome outcome = bench_->Call({"list"}, wrong);
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nowhere"));
}

/// The program of the moved installation, with nothing in its environment but what is given. Called within the sources:
/// they must not decide either.
class Installed : public Plugins {
 protected:
  static fs::path Own(const std::string& file) { return *bench_ / "prefix/share/dynoproof" / file; }
  static Outcome Call(std::vector<std::string> arguments, const std::vector<std::string>& environment = {}) {
    arguments.insert(arguments.begin(), (*bench_ / "prefix/bin/dynoproof").string());
    arguments.insert(arguments.begin(), environment.begin(), environment.end());
    arguments.insert(arguments.begin(), "-i");
    return test::Call(arguments, {.folder = fs::current_path(), .program = "env"});
  }
  static std::string Out() { return (*bench_ / "out_installed").string(); }
  /// Takes a file or folder of the installation away for as long as this lives.
  class Without {
   public:
    explicit Without(const std::string& file) : file_(Own(file)) { fs::rename(file_, file_.string() + ".away"); }
    ~Without() { fs::rename(file_.string() + ".away", file_); }
    Without(const Without&) = delete;
    Without& operator=(const Without&) = delete;

   private:
    fs::path file_;
  };
};

TEST_F(Installed, ListsTheScenariosThatWereInstalledWithIt) {
  const Without pressure("scenarios/pressure");
  fs::create_directories(Own("scenarios/mine"));
  std::ofstream(Own("scenarios/mine/line.toml")) << Bench::kLine;
  const Outcome list = Call({"list"});
  EXPECT_EQ(list.exit, 0) << list.Both();
  EXPECT_THAT(list.out, HasSubstr("mine/line"));
  EXPECT_THAT(list.out, HasSubstr("backlash/experiment_1"));
  EXPECT_THAT(list.out, Not(HasSubstr("pressure/hil_load_step"))) << "those of the sources are not asked";
  const Outcome run = Call({"run", "mine/line", "--out", Out()});
  EXPECT_EQ(run.exit, 0) << run.Both();
  const Outcome gone = Call({"run", "pressure/hil_load_step", "--out", Out()});
  EXPECT_EQ(gone.exit, 2) << gone.Both();
  EXPECT_EQ(Call({"describe", "drive_line"}).exit, 0);
}

TEST_F(Installed, ComparesWithItsOwnGoldenData) {
  const Outcome run = Call({"run", "heavy_duty/alternative_setup_1", "--out", Out()});
  EXPECT_EQ(run.exit, 0) << run.Both();
  const Without golden("golden/heavy_duty/alternative_setup_1.h5");
  const Outcome without = Call({"run", "heavy_duty/alternative_setup_1", "--out", Out()});
  EXPECT_EQ(without.exit, 1) << without.Both();
  EXPECT_THAT(without.Both(), HasSubstr(Own("golden/heavy_duty/alternative_setup_1.h5").string()));
}

TEST_F(Installed, ReproducesAClaimOfItsOwnLedger) {
  const Outcome claim = Call({"reproduce", "5.6.1-notch-1", "--html", (*bench_ / "atlas.html").string()});
  EXPECT_EQ(claim.exit, 0) << claim.Both();
  EXPECT_THAT(ReadBytes(*bench_ / "atlas.html"), HasSubstr("Fig. 5.19"));
  const Without ledger("golden/published.toml");
  const Outcome without = Call({"reproduce", "5.6.1-notch-1"});
  EXPECT_EQ(without.exit, 2) << without.Both();
  EXPECT_THAT(without.Both(), HasSubstr(Own("golden/published.toml").string()));
}

TEST_F(Installed, IsToldOtherFoldersByTheEnvironment) {
  bench_->Write("theirs/line.toml", Bench::kLine);
  const Outcome list = Call({"list"}, {"DYNOPROOF_SCENARIOS=" + (*bench_ / "theirs").string()});
  EXPECT_EQ(list.exit, 0) << list.Both();
  EXPECT_THAT(list.out, Not(HasSubstr("backlash/experiment_1")));
  const std::string other = (*bench_ / "other_golden").string();
  const Outcome run = Call({"run", "heavy_duty/alternative_setup_1", "--out", Out()}, {"DYNOPROOF_GOLDEN=" + other});
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.Both(), HasSubstr(other + "/heavy_duty/alternative_setup_1.h5"));
}

TEST_F(Installed, LoadsALawThatWasMadeAndBuiltWithIt) {
  const Outcome run =
      Call({"run", (*bench_ / "stop.toml").string(), "--plugin", (*bench_ / kLaw).string(), "--out", Out()});
  EXPECT_EQ(run.exit, 0) << run.Both();
}

TEST_F(Installed, NamesNoFolderOfTheBuildAndHasItsLicence) {
  const std::string sources = fs::current_path().string();
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(*bench_ / "prefix")) {
    if (!entry.is_regular_file() || entry.path().extension() == ".a") continue;
    const std::string text = ReadBytes(entry.path());
    for (const std::string& folder : {sources, std::string(DYNOPROOF_BUILD)})
      EXPECT_EQ(text.find(folder), std::string::npos) << entry.path() << " names " << folder;
  }
  for (const char* file : {"LICENSE", "README.md"})
    EXPECT_NE(ReadBytes(*bench_ / "prefix/share/doc/dynoproof" / file), "") << file;
}

TEST_F(Plugins, ThatAreNoneAreRefused) {
  bench_->Write("stranger.cc",
                "struct Entry { const char* stamp; void (*f)(void*); };\n"
                "static void Nothing(void*) {}\n"
                "extern \"C\" __attribute__((visibility(\"default\"))) const Entry dynoproof_plugin = "
                "{\"headers of another day\", Nothing};\n");
  bench_->Write("plain.cc", "int answer() { return 42; }\n");
  Shell("c++ -shared -fPIC -o stranger.so stranger.cc && c++ -shared -fPIC -o plain.so plain.cc");
  bench_->Write("text.so", "this is no library\n");
  for (const auto& [file, answer] :
       {std::pair("stranger.so", "headers of another day"), std::pair("plain.so", "exports no dynoproof_plugin"),
        std::pair("text.so", "cannot be loaded"), std::pair("none.so", "there is no such plugin file")}) {
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"list"}, {"run", "line.toml"}, {"modes", "line.toml"}}) {
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.end(), {"--plugin", file});
      const Outcome outcome = bench_->Call(arguments);
      EXPECT_EQ(outcome.exit, 2) << file << outcome.Both();
      EXPECT_THAT(outcome.err, HasSubstr(file));
      EXPECT_THAT(outcome.err, HasSubstr(answer));
    }
  }
}

}  // namespace
}  // namespace dynoproof::test
