// A campaign on a real cluster of four nodes, one of which dies in the middle: the table is that of one machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <set>
#include <thread>

#include "tests/support/slurm_cluster.h"

namespace dynoproof::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kRunsPerTask = 25;  // of the campaign below
constexpr const char* kCampaign = R"(title = "a thousand lines"
scenario = "line.toml"
set = ["run.duration_s=0.5"]
samples = 1000
most_failing = 1.0

[slurm]
runs_per_task = 25
deadline_minutes = 4

[[axis]]
key = "plant.inertia.I3"
log_normal = [1.0, 0.2]
relative = true

[[axis]]
key = "plant.shaft.k2.stiffness_Nm_per_rad"
uniform = [0.8, 1.2]
relative = true

[figure.T_peak]
of = "T_shaft"
take = "peak"
at_most = 150.0

[figure.omega_rms]
of = "omega_1"
take = "rms"
)";

/// First runs of the pieces that are stored; a piece is written at once when its task is done.
std::set<int> Pieces(const fs::path& folder) {
  std::error_code error;
  std::set<int> first;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with('.')) first.insert(std::atoi(name.c_str()));
  }
  return first;
}

class OnSlurm : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!SlurmCluster::Installed()) GTEST_SKIP() << "slurm-wlm and munge are not installed";
    cluster_ = std::make_unique<SlurmCluster>();
    bench_.Write("thousand.toml", kCampaign);
  }
  std::unique_ptr<SlurmCluster> cluster_;
  Bench bench_;
};

TEST_F(OnSlurm, AThousandRunsGiveTheTableOfOneMachineThoughANodeDies) {
  ASSERT_EQ(bench_.Call({"sweep", "thousand.toml", "--out", "local"}).exit, 0);
  const fs::path rows = bench_ / "out/thousand/rows";
  std::size_t at_death = 0;
  std::set<int> lost;
  std::thread fate([&] {
    for (int i = 0; i < 6000 && at_death < 8; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      at_death = Pieces(rows).size();
    }
    // However fast the machine: the plug is pulled while tasks are held still whose rows are not there. A node may have
    // none for a second, between two waves of the scheduler.
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (lost.empty() && Pieces(rows).size() < 40 && std::chrono::steady_clock::now() < until) {
      for (const int task : cluster_->SignalTasks(2, SIGSTOP)) {
        if (!Pieces(rows).contains(task * kRunsPerTask)) lost.insert(task);
      }
      if (lost.empty()) cluster_->SignalTasks(2, SIGCONT);
    }
    cluster_->Kill(2);
  });
  const Outcome outcome =
      bench_.Call({"sweep", "thousand.toml", "--executor", "slurm"}, {.environment = cluster_->Environment()});
  fate.join();
  ASSERT_EQ(outcome.exit, 0) << outcome.Both();
  EXPECT_GE(at_death, 8U);
  EXPECT_FALSE(lost.empty()) << "the node had nothing to lose";
  EXPECT_LT(at_death, 40U) << "the node died when all was done";
  EXPECT_THAT(cluster_->AwaitState("n2 down"), HasSubstr("n2 down")) << "nobody noticed its death";
  for (const char* file : {"table.csv", "table.h5"}) {
    const std::string local = ReadBytes(bench_ / "local/thousand" / file);
    ASSERT_FALSE(local.empty());
    EXPECT_TRUE(local == ReadBytes(bench_ / "out/thousand" / file)) << file;
  }
}

TEST_F(OnSlurm, WhatCannotRunIsSaidAndNotWaitedFor) {
  std::string text = kCampaign;
  text.replace(text.find("runs_per_task = 25"), 18, "runs_per_task = 500\npartition = \"none\"");
  bench_.Write("thousand.toml", text);
  const Outcome outcome =
      bench_.Call({"sweep", "thousand.toml", "--executor", "slurm"}, {.environment = cluster_->Environment()});
  EXPECT_EQ(outcome.exit, 3) << outcome.Both();
  EXPECT_THAT(outcome.err, HasSubstr("sbatch refused"));
  EXPECT_THAT(outcome.err, HasSubstr("--resume"));
}

}  // namespace
}  // namespace dynoproof::test
