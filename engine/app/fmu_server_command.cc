// dynoproof fmu-server: the program's side of an exported unit, which starts it
#include <sys/socket.h>

#include "app/app.h"
#include "fmu/frames.h"
#include "fmu/unit.h"

namespace dynoproof::app {
namespace {

int Serve(const Common& common, const std::string& scenario) {
  int type = 0;
  socklen_t size = sizeof(type);
  if (::getsockopt(fmu::kSocket, SOL_SOCKET, SO_TYPE, &type, &size) != 0) {
    Complain("an exported unit starts this, with a socket to talk over: see `dynoproof export --help`\n");
    return kUsage;
  }
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  if (Report(diagnostics) != kGood) return kUsage;
  return fmu::Serve(fmu::kSocket, scenario, *registry) ? kGood : kBroken;
}

}  // namespace

void AddFmuServer(Command program) {
  struct Arguments {
    Common common;
    std::string scenario;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = program.Subcommand("fmu-server", "answers an exported unit");
  command.Hide();
  command.Value("scenario", arguments->scenario, "the unit's scenario").Required();
  AddCommon(command, arguments->common);
  command.Runs([arguments] { return Serve(arguments->common, arguments->scenario); });
}

}  // namespace dynoproof::app
