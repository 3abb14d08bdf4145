#include "reduce/reduce.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "experiment/compare_traces.h"
#include "experiment/golden.h"
#include "experiment/run_scenario.h"
#include "reduce/moves.h"
#include "scenario/load.h"
#include "score/share.h"

namespace dynoproof::reduce {
namespace {

constexpr double kFarther = 10.0;  // a check that is so much further beyond its limit fails for another reason
constexpr double kShorter = 1.25;  // durations are halved until the longest that passes is that close

/// A text without its numbers: resonances move, and "resonance 2 at 605.1 Hz" stays the same check.
std::string WithoutNumbers(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool digit = (c >= '0' && c <= '9') || (c == '.' && !out.empty() && out.back() == '#');
    if (!digit) out += c;
    if (digit && (out.empty() || out.back() != '#')) out += '#';
  }
  return out;
}

/// What a failing run shows.
struct Symptom {
  std::string name = {};   // of the check, without numbers; empty: the run breaks
  bool number = false;     // a value beyond a limit
  double share = 0.0;      // of the limit
  std::string words = {};  // why there is none, without numbers
  score::Check check = {};

  bool Same(const Symptom& other) const {
    if (name != other.name || number != other.number) return false;
    return number ? other.share <= kFarther * share : words == other.words;
  }
};

Symptom SymptomOf(const score::Check& check) {
  Symptom one{.name = WithoutNumbers(check.name), .check = check};
  one.share = score::ShareOfLimit(check);
  one.number = std::isfinite(check.value) && std::isfinite(check.limit);
  if (!std::isfinite(one.share)) one.share = std::numeric_limits<double>::infinity();
  if (!one.number) one.words = WithoutNumbers(check.explanation);
  return one;
}

std::size_t LinesOf(const Value& root) {
  const std::string text = ToToml(root);
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

class Reducer {
 public:
  Reducer(Plan plan, const Registry& registry, const Options& options)
      : plan_(std::move(plan)), registry_(registry), options_(options) {}

  Result<Reduced> Run() {
    const Result<Symptom> symptom = Choose();
    if (!symptom.ok()) return symptom.failure();
    symptom_ = *symptom;
    Reduced reduced;
    if (!Sound(plan_, symptom_.check.name))
      return Failure{
          "the other program fails this check as well: the fault is in the scenario, or in both", plan_.id, {}, 1};
    reduced.check = symptom_.name.empty() ? "run" : symptom_.check.name;
    reduced.first = last_ = symptom_.check;
    reduced.lines_before = LinesOf(plan_.root);
    reduced.seconds_before = Seconds();
    const bool golden = symptom_.check.stated == GoldenCheck::kName;
    if (golden && !FindBlessed()) {
      steps_.push_back(
          {"nothing but time: this program gives another trace than the golden one for the scenario that was blessed",
           reduced.lines_before, reduced.seconds_before});
      Shorten();
      return Done(std::move(reduced));
    }
    if (golden) last_ = symptom_.check;
    KeepItsChecks();
    Shorten();
    // What one group has taken out may let go of what an earlier one could not.
    for (bool less = true; less && Left();) {
      less = false;
      for (const Group& group : GroupsOf(plan_.root, Kept())) {
        // Anew, since what went before may have taken some of it.
        for (const Group& now : GroupsOf(plan_.root, Kept())) {
          if (now.what == group.what && Left()) less = TakeOut(now.what, now.moves) || less;
        }
      }
      if (less) Shorten();
    }
    return Done(std::move(reduced));
  }

 private:
  Reduced Done(Reduced reduced) {
    reduced.complete = Left();
    reduced.before = std::move(was_);
    reduced.plan = std::move(plan_);
    reduced.last = last_;
    reduced.runs = runs_;
    reduced.steps = std::move(steps_);
    return reduced;
  }

  /// The scenario of the golden trace, as long as its run by this program and the present one differ as the check says.
  bool FindBlessed() {
    const GoldenPlace place = GoldenPlaceOf(plan_);
    std::optional<Value> root = BlessedScenario(place);
    const Result<GoldenTolerances> tolerances = ReadTolerances(place.tolerances);
    if (!root || !tolerances.ok()) return false;
    was_ = plan_;
    was_->root = *std::move(root);
    tolerances_ = tolerances->For(plan_.root.TextOr("run.solver", "realtime"));
    const std::optional<ScenarioResult> result = Look(plan_, &*was_);
    if (result) {
      for (const score::Check& check : result->checks) {
        const Symptom one = SymptomOf(check);
        if (check.verdict == score::Verdict::kPass || one.name != symptom_.name) continue;
        symptom_ = one;
        symptom_.check.stated = GoldenCheck::kName;
        return true;
      }
    }
    was_.reset();
    return false;
  }

  bool Left() const { return runs_ < options_.most_runs; }
  double Seconds() const { return plan_.root.NumberOr("run.duration_s", 0.0); }

  /// The run of a plan, beside one that it is compared with where `was` is given; nothing where it cannot be built, which costs no
  /// run.
  std::optional<ScenarioResult> Look(const Plan& plan, const Plan* was) {
    Diagnostics refused;
    const std::unique_ptr<Prepared> prepared = Prepare(plan, {}, registry_, refused);
    const std::unique_ptr<Prepared> reference = was != nullptr ? Prepare(*was, {}, registry_, refused) : nullptr;
    if (prepared == nullptr || (was != nullptr && reference == nullptr)) return std::nullopt;
    runs_ += was != nullptr ? 2 : 1;
    if (options_.progress) options_.progress(trying_, runs_);
    if (was == nullptr) return RunScenario(*prepared, {.out = ""});
    const Result<Course> own = Play(*prepared), others = Play(*reference);
    if (!own.ok() || !others.ok()) return std::nullopt;
    ScenarioResult result;
    result.checks = CompareTraces(others->trace, own->trace, tolerances_, GoldenCheck::kName);
    return result;
  }

  static std::optional<Symptom> Broken(const ScenarioResult& result) {
    if (result.broken.empty()) return std::nullopt;
    return Symptom{.words = WithoutNumbers(result.broken)};
  }

  /// The check that is asked for, or the worst of those that fail.
  Result<Symptom> Choose() {
    const std::optional<ScenarioResult> result = Look(plan_, nullptr);
    if (!result) return Failure{"cannot be built", plan_.id, {}, 2};
    if (const auto broken = Broken(*result)) return *broken;
    std::optional<Symptom> worst;
    std::vector<std::string> failing;
    for (const score::Check& check : result->checks) {
      if (check.verdict == score::Verdict::kPass) continue;
      failing.push_back(check.name);
      const bool asked = options_.check.empty() || check.name == options_.check || check.stated == options_.check;
      const Symptom one = SymptomOf(check);
      if (asked && (!worst || one.share > worst->share)) worst = one;
    }
    if (worst) return *worst;
    if (failing.empty()) return Failure{"no check fails: there is nothing to reduce", plan_.id, {}, 1};
    return Failure{
        fmt::format("no failing check is called \"{}\"; these fail: {}", options_.check, fmt::join(failing, ", ")),
        plan_.id,
        {},
        1};
  }

  /// Whether the plan shows the same after a change, which the one it is compared with undergoes, too; keeps it then.
  bool Try(const std::function<void(Value& root)>& change) {
    Plan plan = plan_;
    change(plan.root);
    std::optional<Plan> was = was_;
    if (was) change(was->root);
    const std::optional<ScenarioResult> result = Look(plan, was ? &*was : nullptr);
    if (!result) return false;
    std::optional<score::Check> same;
    if (const auto broken = Broken(*result)) {
      if (!symptom_.Same(*broken)) return false;
    } else {
      if (symptom_.name.empty()) return false;
      for (const score::Check& check : result->checks) {
        if (check.verdict != score::Verdict::kPass && symptom_.Same(SymptomOf(check))) same = check;
      }
      if (!same) return false;
    }
    if (!was_ && !Sound(plan, same ? same->name : "")) return false;
    if (same) last_ = *same;
    plan_ = std::move(plan);
    was_ = std::move(was);
    return true;
  }

  /// Whether the other program, where one is asked, passes what fails here; its run counts. A golden check has its own comparison.
  bool Sound(const Plan& plan, const std::string& check) {
    if (!options_.sound || symptom_.check.stated == GoldenCheck::kName) return true;
    ++runs_;
    return options_.sound(plan, check);
  }

  void Note(std::string what) { steps_.push_back({std::move(what), LinesOf(plan_.root), Seconds()}); }

  /// Signals that the checks name: these stay.
  std::vector<std::string> Kept() const {
    std::vector<std::string> kept;
    // "golden T_shaft": of a trace that signal.
    if (was_) kept.push_back(symptom_.check.name.substr(symptom_.check.name.find(' ') + 1));
    const Value* checks = plan_.root.Find("check");
    for (const Value& check : checks != nullptr && checks->is_array() ? checks->array() : Value::Array{}) {
      if (!check.is_table()) continue;
      for (const Value::Entry& entry : check.table()) {
        if (entry.value.is_string()) kept.push_back(entry.value.string());
      }
    }
    return kept;
  }

  /// Other kinds of checks first: they cost runs of other solvers.
  void KeepItsChecks() {
    const Value* all = plan_.root.Find("check");
    if (all == nullptr || !all->is_array() || symptom_.check.stated.empty()) return;
    trying_ = "other checks";
    const bool kept = Try([&](Value& root) {
      Value* checks = root.Find("check");
      if (checks == nullptr || !checks->is_array()) return;
      std::erase_if(checks->array(), [&](const Value& check) { return check.TextOr("kind") != symptom_.check.stated; });
    });
    if (kept) Note("checks of other kinds");
  }

  void Shorten() {
    double passes = 0.0;
    const double before = Seconds();
    trying_ = "a shorter run";
    // From a sixteenth on: most faults show early.
    for (double fails = before, tried = before / 16.0; Left() && fails > kShorter * passes && fails > 0.0;) {
      if (Try([&](Value& root) { root["run"]["duration_s"] = Value(Rounded(tried, 3)); })) {
        fails = Seconds();
      } else {
        passes = tried;
      }
      tried = passes > 0.0 ? std::sqrt(passes * fails) : fails / 16.0;
      if (tried < 1e-3 * before) break;
    }
    if (Seconds() < before) Note(fmt::format("shortened from {:g} s", before));
  }

  /// All of these moves together, or as many as keep the fault. True when any did.
  bool TakeOut(const std::string& what, const std::vector<Move>& moves) {
    trying_ = what;
    const std::size_t lines = LinesOf(plan_.root);
    std::vector<std::string> done;
    Halve(moves, done);
    if (done.empty()) return false;
    constexpr std::size_t kSaid = 4;
    std::string text = fmt::format(
        "{}", fmt::join(done.begin(), done.begin() + static_cast<std::ptrdiff_t>(std::min(kSaid, done.size())), ", "));
    if (done.size() > kSaid) text += fmt::format(" and {} more", done.size() - kSaid);
    Note(fmt::format("{}: {}", what, text));
    return LinesOf(plan_.root) < lines || what == "digits";
  }

  void Halve(const std::vector<Move>& moves, std::vector<std::string>& done) {
    if (moves.empty() || !Left()) return;
    Value changed = plan_.root;
    Apply(moves, changed);
    const bool changes = ToToml(changed) != ToToml(plan_.root);
    if (changes && Try([&](Value& root) { Apply(moves, root); })) {
      for (const Move& move : moves) done.push_back(move.what);
      return;
    }
    if (moves.size() == 1) return;
    // Lists lose their numbers with each part that goes: the later half goes before the earlier one.
    const auto middle = moves.begin() + static_cast<std::ptrdiff_t>(moves.size() / 2);
    Halve({middle, moves.end()}, done);
    Halve({moves.begin(), middle}, done);
  }

  Plan plan_;
  std::optional<Plan> was_;  // of a golden check: what the run is compared with
  SignalTolerances tolerances_;
  const Registry& registry_;
  const Options& options_;
  Symptom symptom_;
  score::Check last_;
  std::string trying_;
  std::vector<Step> steps_;
  int runs_ = 0;
};

}  // namespace

Result<Reduced> Reduce(Plan plan, const Registry& registry, const Options& options) {
  return Reducer(std::move(plan), registry, options).Run();
}

}  // namespace dynoproof::reduce
