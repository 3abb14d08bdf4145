// A source that does what broken plugins do, so that a campaign can be seen to survive it: stumble = 0 nothing, 1 ends
// the process as a failed assertion does, 2 reads where nothing is, 3 throws, 4 gives no number, 5 never comes back, 6 throws
// what is no exception, 7 ends the program as if all were well.
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "model/plugin_loader.h"

#ifndef DYNOPROOF_STUMBLE
#define DYNOPROOF_STUMBLE "stumble"  // another name: that of a source that is there already
#endif

namespace {

using namespace dynoproof;

class Stumble : public Component {
 public:
  struct Params {
    double stumble = 0.0, at_s = 0.01;
    void Visit(auto& v) {
      v.Optional("stumble", stumble, NonNegative("1"), "what goes wrong");
      v.Optional("at_s", at_s, NonNegative(), "when");
    }
  };
  static PluginInfo Info() { return {"source", DYNOPROOF_STUMBLE, "goes wrong", "", "", {}}; }
  explicit Stumble(const Params& params) : p_(params) { layout_.outputs = {{"value", "1", "", 1.0}}; }

  void Output(const View& view, std::span<double> outputs) const override {
    outputs[0] = std::sin(2000.0 * view.time_s);
    if (view.time_s < p_.at_s) return;
    switch (static_cast<int>(p_.stumble)) {
      case 1:
        std::abort();
      case 2:
        std::raise(SIGSEGV);
        return;
      case 3:
        throw std::runtime_error("stumbled");
      case 4:
        outputs[0] = std::nan("");
        return;
      case 5:
        for (volatile bool again = true; again;) {
        }
        return;
      case 6:
        throw 42;
      case 7:
        std::exit(0);
      default:
        return;
    }
  }

 private:
  Params p_;
};

}  // namespace

DYNOPROOF_PLUGIN(registry) { registry.Add<Stumble>(); }
