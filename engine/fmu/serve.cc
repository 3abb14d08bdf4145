#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "experiment/drive_by_record.h"
#include "fmu/frames.h"
#include "fmu/run.h"
#include "fmu/unit.h"
#include "scenario/load.h"

namespace dynoproof::fmu {
namespace {

/// One importer's side of it.
class Server {
 public:
  Server(int socket, const std::string& scenario, const Registry& registry)
      : socket_(socket), scenario_(scenario), registry_(registry) {}

  bool Answer(const Message& question) {
    switch (question.kind) {
      case kDescribe:
        return Describe();
      case kBegin:
        return Begin(question.Numbers());
      case kStep:
        return Step(question.Numbers());
      default:
        return Send(socket_, kFault, fmt::format("unknown question {}", question.kind));
    }
  }

 private:
  bool Fault(const Failure& failure) { return Send(socket_, kFault, failure.ToString()); }

  bool Describe() {
    Diagnostics diagnostics;
    const std::unique_ptr<Prepared> prepared = Prepare(scenario_, {}, registry_, diagnostics);
    if (prepared == nullptr) return Send(socket_, kFault, diagnostics.Format());
    const Result<Fmu> unit = FmuOf(*prepared);
    if (!unit.ok()) return Fault(unit.failure());
    unit_ = *unit;
    plan_ = prepared->plan;
    std::vector<double> answer = {unit_.period_s};
    for (const auto* some : {&unit_.inputs, &unit_.outputs, &unit_.parameters})
      answer.push_back(static_cast<double>(some->size()));
    for (const auto* some : {&unit_.inputs, &unit_.outputs, &unit_.parameters}) {
      for (const Variable& one : *some) answer.push_back(one.start);
    }
    return Send(socket_, kNumbers, answer);
  }

  bool Begin(const std::vector<double>& numbers) {
    const std::size_t inputs = unit_.inputs.size();
    if (numbers.size() != inputs + unit_.parameters.size())
      return Send(socket_, kFault, "another number of inputs and parameters");
    const std::span<const double> first(numbers.data(), inputs);
    if (const std::string wrong = NotFinite(first); !wrong.empty()) return Send(socket_, kFault, wrong);
    Plan plan = plan_;
    for (std::size_t i = 0; i < unit_.parameters.size(); ++i) {
      // A parameter that the importer has not changed keeps the scenario's digits.
      const Variable& own = unit_.parameters[i];
      if (numbers[inputs + i] != own.start) WriteNumber(plan.root, own.name, numbers[inputs + i]);
    }
    Result<std::unique_ptr<Run>> run = Run::Of(plan, registry_, first);
    if (!run.ok()) return Fault(run.failure());
    run_ = *std::move(run);
    return TellOutputs();
  }

  bool Step(const std::vector<double>& numbers) {
    if (run_ == nullptr) return Send(socket_, kFault, "nothing has begun");
    if (numbers.size() != 1 + run_->inputs().size()) return Send(socket_, kFault, "another number of inputs");
    const std::span<const double> held = std::span(numbers).subspan(1);
    if (const std::string wrong = NotFinite(held); !wrong.empty()) return Send(socket_, kFault, wrong);
    std::ranges::copy(held, run_->inputs().begin());
    if (const Status broken = run_->Advance(std::llround(numbers[0]))) return Fault(*broken);
    return TellOutputs();
  }

  /// Which input is no number; empty: all are.
  std::string NotFinite(std::span<const double> inputs) const {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (!std::isfinite(inputs[i])) return fmt::format("input {} is {}", unit_.inputs[i].name, inputs[i]);
    }
    return "";
  }

  bool TellOutputs() {
    const Result<std::vector<double>> outputs = run_->Outputs();
    return outputs.ok() ? Send(socket_, kNumbers, *outputs) : Fault(outputs.failure());
  }

  int socket_;
  const std::string& scenario_;
  const Registry& registry_;
  Fmu unit_;
  Plan plan_;
  std::unique_ptr<Run> run_;
};

}  // namespace

bool Serve(int socket, const std::string& scenario, const Registry& registry) {
  Server server(socket, scenario, registry);
  for (Message question; Receive(socket, question);) {
    if (!server.Answer(question)) return false;
  }
  return true;  // an importer that is done hangs up
}

}  // namespace dynoproof::fmu
