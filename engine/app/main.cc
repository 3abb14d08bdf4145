// dynoproof: is this simulation right, is it fast enough for 10 kHz, and if it disagrees with the measurement, why?
#include <fmt/format.h>
#include <glog/logging.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>

#include "app/app.h"
#include "app/measured.h"
#include "app/usage.h"
#include "experiment/build_info.h"
#ifdef DYNOPROOF_THESIS
#include "thesis/commands/commands.h"
#include "thesis/two_stage.h"
#endif

int main(int argc, char** argv) {
  using namespace dynoproof;  // NOLINT(google-build-using-namespace): the program itself
  CLI::App program(
      "dynoproof: proves simulations of highly dynamic test beds.\n"
      "Exit codes: 0 all holds, 1 something fell short, 2 bad usage, scenario or data, 3 a run broke,\n"
      "4 undecided, 5 a timing budget is broken.");
  program.set_version_flag("--version", fmt::format("dynoproof {} ({})", build_info::kVersion, build_info::Commit()));
  program.require_subcommand(1);
  program.footer("More: dynoproof COMMAND --help");
  std::signal(SIGPIPE, SIG_IGN);           // a closed pipe is a failed write, not a death without a word
  std::signal(SIGXFSZ, SIG_IGN);           // a file as large as it may be is a failed write, too
  FLAGS_minloglevel = google::GLOG_FATAL;  // what Ceres meets on its way is no message to a user
  // A plugin may end the program with exit(0), as if all were said.
  static bool answered = false;
  std::atexit([] {
    if (answered) return;
    app::Complain("the program was ended before it had an answer, by a plugin or a library\n");
    _exit(app::kBroken);
  });
  int exit = app::kGood;
  const app::Command all(&program, &exit);
  app::AddRun(all);
  app::AddModes(all);
#ifdef DYNOPROOF_THESIS
  app::AddCoupling(all);
  app::AddReproduce(all);
  identification::AddTwoStage();
#endif
  app::AddCompare(all);
  app::AddCheckData(all);
  app::AddIdentify(all);
  app::AddDiagnose(all);
  app::AddBench(all);
  app::AddHistory(all);
  app::AddSweep(all);
  app::AddProbe(all);
  app::AddReduce(all);
  app::AddBisect(all);
  app::AddBless(all);
  app::AddList(all);
  app::AddDescribe(all);
  app::AddValidate(all);
  app::AddNew(all);
  app::AddExport(all);
  app::AddFmuServer(all);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Help and version are asked for; a table of them is no document.
    if (error.get_exit_code() == 0) return answered = true, program.exit(error);
    exit = app::Report(app::UsageFaults(program, error));
  } catch (const std::bad_alloc&) {
    app::Complain("out of memory\n");
    exit = app::kBroken;
  } catch (const std::exception& error) {
    app::Complain(fmt::format("unexpected: {}\n", error.what()));
    exit = app::kBroken;
  } catch (...) {  // a plugin may throw what it likes
    app::Complain("unexpected: an exception that is none of the standard library's\n");
    exit = app::kBroken;
  }
  exit = app::FinishJson(app::JsonFile(argc, argv), exit);
  answered = true;
  return exit;
}
