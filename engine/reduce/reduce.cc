#include "reduce/reduce.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "experiment/compare_traces.h"
#include "experiment/golden.h"
#include "experiment/run_scenario.h"
#include "reduce/moves.h"
#include "reduce/short_form.h"
#include "reduce/symptom.h"
#include "reduce/tree.h"
#include "scenario/load.h"

namespace dynoproof::reduce {
namespace {

constexpr double kShort = 0.05;    // of the run: what lies beyond is worth moving its events for
constexpr double kShorter = 1.25;  // durations are halved until the longest that passes is that close

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
    reduced.lines_before = Lines();
    reduced.values_before = ValuesOf(plan_.root);
    reduced.seconds_before = Seconds();
    const bool golden = symptom_.check.stated == GoldenCheck::kName;
    const Result<std::optional<Value>> blessed = BlessedScenario(GoldenPlaceOf(plan_));
    if (!blessed.ok()) return blessed.failure();
    if (golden && !FindReference(*blessed)) {
      steps_.push_back(
          {"nothing but time: this program gives another trace than the golden one for the scenario that was blessed",
           reduced.lines_before, reduced.seconds_before});
      Shorten();
      return Done(std::move(reduced));
    }
    if (golden) last_ = symptom_.check;
    if (!golden) FindGood(*blessed);
    KeepItsChecks();
    Shorten();
    // What one group has taken out may let go of what an earlier one could not.
    for (bool less = true; less && Left();) {
      less = false;
      for (const std::string& group : GroupNames()) less = TakeOut(group) || less;
      if (less) ShortenAgain();
    }
    Round();
    return Done(std::move(reduced));
  }

 private:
  /// The groups of moves that what is left offers; anew each time, since what went before may have taken some of it.
  std::vector<Group> Groups() const {
    std::vector<Group> groups = GroupsOf(plan_.root, Kept(), levels_, Changed());
    // Only what passes the check elsewhere tells a check that says less from one that looks elsewhere.
    if (Guarded()) groups.push_back(KeysOfChecks(plan_.root));
    return groups;
  }
  std::vector<std::string> GroupNames() const {
    std::vector<std::string> names;
    for (const Group& group : Groups()) names.push_back(group.what);
    return names;
  }

  Reduced Done(Reduced reduced) {
    reduced.complete = Left();
    reduced.beside_sound = by_sound_;
    reduced.before = std::move(was_);
    reduced.plan = std::move(plan_);
    reduced.last = last_;
    reduced.runs = runs_;
    reduced.steps = std::move(steps_);
    return reduced;
  }

  /// What the run of a golden check is compared with, as long as that shows what the check says: the run of the blessed scenario by
  /// this program, or that of the present one by the other program.
  bool FindReference(const std::optional<Value>& blessed) {
    const Result<GoldenTolerances> tolerances = ReadTolerances(GoldenPlaceOf(plan_).tolerances);
    if (!tolerances.ok()) return false;
    tolerances_ = tolerances->For(plan_.root.TextOr("run.solver", "realtime"));
    if (blessed) {
      was_ = plan_;
      was_->root = *blessed;
      if (ShowsSame()) return true;
      was_.reset();
    }
    by_sound_ = options_.sound_trace != nullptr;
    if (by_sound_ && ShowsSame()) return true;
    by_sound_ = false;
    return false;
  }

  /// Whether the plan as it is shows the failing check beside its reference; it is that one from then on.
  bool ShowsSame() {
    const std::optional<ScenarioResult> result = Look(plan_, was_ ? &*was_ : nullptr);
    if (!result) return false;
    for (const score::Check& check : result->checks) {
      const Symptom one = SymptomOf(check);
      if (check.verdict == score::Verdict::kPass || one.name != symptom_.name) continue;
      symptom_ = one;
      symptom_.check.stated = GoldenCheck::kName;
      return true;
    }
    return false;
  }

  /// Of another check than a golden one: the scenario without what --set says, or as it was blessed, where it passes there. It loses
  /// the same, and must go on passing.
  void FindGood(const std::optional<Value>& blessed) {
    std::vector<Plan> candidates;
    if (options_.good) candidates.push_back(*options_.good);
    if (blessed) {
      candidates.push_back(plan_);
      candidates.back().root = *blessed;
      // Checks are those of today.
      if (const Value* checks = plan_.root.Find("check")) candidates.back().root["check"] = *checks;
    }
    for (Plan& candidate : candidates) {
      if (ToToml(candidate.root) == ToToml(plan_.root) || !Passes(candidate)) continue;
      good_ = std::move(candidate);
      return;
    }
  }

  /// Whether the check of the symptom passes there.
  bool Passes(const Plan& plan) {
    const std::optional<ScenarioResult> result = Look(plan, nullptr);
    if (!result || !result->broken.empty()) return false;
    if (symptom_.name.empty()) return true;
    return std::ranges::any_of(result->checks, [&](const score::Check& check) {
      return check.verdict == score::Verdict::kPass && WithoutNumbers(check.name) == symptom_.name;
    });
  }

  bool Paired() const { return symptom_.check.stated == GoldenCheck::kName; }
  /// Whether something else than the failing check tells that the fault is there.
  bool Guarded() const { return Paired() || good_ || options_.sound; }
  /// Whether another try is affordable: a run, one that it is compared with, one of the other program.
  bool Left() const {
    const int cost = 1 + (Paired() || good_ ? 1 : 0) + (options_.sound && !Paired() ? 1 : 0);
    return runs_ + cost <= options_.most_runs;
  }
  std::size_t Lines() const { return LinesOf(ToToml(plan_.root)); }
  double Seconds() const { return plan_.root.NumberOr("run.duration_s", 0.0); }

  std::unique_ptr<Prepared> Built(const Plan& plan) const {
    Diagnostics refused;
    std::unique_ptr<Prepared> prepared = Prepare(plan, {}, registry_, refused);
    // As `run`: an oracle that cannot take the plan is a fault of the file.
    if (prepared != nullptr && !ChecksApply(prepared->checks, prepared->plan, *prepared->rig, refused)) return nullptr;
    return prepared;
  }

  /// The run of a plan, beside one that it is compared with where `was` is given or the other program makes it; nothing where it
  /// cannot be built, which costs no run.
  std::optional<ScenarioResult> Look(const Plan& plan, const Plan* was) {
    const std::unique_ptr<Prepared> prepared = Built(plan);
    const std::unique_ptr<Prepared> reference = was != nullptr ? Built(*was) : nullptr;
    if (prepared == nullptr || (was != nullptr && reference == nullptr)) return std::nullopt;
    const bool pair = was != nullptr || by_sound_;
    runs_ += pair ? 2 : 1;
    if (options_.progress) options_.progress(trying_, runs_);
    if (!pair) {
      return RunScenario(*prepared, {.out = "", .seen = [&](const Course& course, const ScenarioResult&) {
                                       if (levels_.empty()) levels_ = LevelsOf(plan.root, course.trace);
                                     }});
    }
    const Result<Course> own = Play(*prepared);
    if (!own.ok()) return std::nullopt;
    std::optional<trace::Trace> beside;
    if (by_sound_) {
      beside = options_.sound_trace(plan);
    } else if (Result<Course> course = Play(*reference); course.ok()) {
      beside = std::move(course->trace);
    }
    if (!beside) return std::nullopt;
    ScenarioResult result;
    result.checks = CompareTraces(*beside, own->trace, tolerances_, GoldenCheck::kName);
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
  bool Try(const std::function<bool(Value& root)>& change) {
    Plan plan = plan_;
    if (!change(plan.root)) return false;
    std::optional<Plan> other = Paired() ? was_ : good_;
    if (other) change(other->root);
    const std::string text = ToToml(plan.root), beside = other ? ToToml(other->root) : "";
    // Two that are one do not differ, and what was refused once is refused again: neither costs a run.
    if ((other && text == beside) || refused_.contains(text + beside)) return false;
    if (other && Travels(plan, *other)) return false;
    std::optional<score::Check> same;
    if (!Answered(plan, other ? &*other : nullptr, same)) {
      refused_.insert(text + beside);
      return false;
    }
    if (same) last_ = *same;
    plan_ = std::move(plan);
    (Paired() ? was_ : good_) = std::move(other);
    return true;
  }

  /// The numbers of the plant that the scenario beside has otherwise.
  std::set<std::string> Changed() const {
    const std::optional<Plan>& beside = Paired() ? was_ : good_;
    return beside ? DifferingNumbers(plan_.root, beside->root, "plant") : std::set<std::string>();
  }

  /// Whether others differ then: a number that is wrong has got into them, where nobody finds it.
  bool Travels(const Plan& plan, const Plan& other) const {
    return !std::ranges::includes(Changed(), DifferingNumbers(plan.root, other.root, "plant"));
  }

  /// Whether the plan fails as it did, and passes where it must: whoever said no last is asked first, and a no spares the others.
  /// Moves of a kind are mostly refused for one reason.
  bool Answered(const Plan& plan, const Plan* other, std::optional<score::Check>& same) {
    // The others would spend a run on what cannot be built.
    if (order_.front() != Asked::kPresent && Built(plan) == nullptr) return false;
    for (auto asked = order_.begin(); asked != order_.end(); ++asked) {
      const bool yes = *asked == Asked::kPresent ? FailsTheSame(plan, Paired() ? other : nullptr, same)
                       : *asked == Asked::kSound ? Sound(plan, last_.name)
                                                 : Paired() || other == nullptr || Passes(*other);
      if (yes) continue;
      std::rotate(order_.begin(), asked, asked + 1);
      return false;
    }
    return true;
  }

  /// Whether the check fails there as it did; `same`: how, where the run does not break.
  bool FailsTheSame(const Plan& plan, const Plan* was, std::optional<score::Check>& same) {
    const std::optional<ScenarioResult> result = Look(plan, was);
    if (!result) return false;
    if (const auto broken = Broken(*result)) return symptom_.Same(*broken);
    if (symptom_.name.empty()) return false;
    for (const score::Check& check : result->checks) {
      if (check.verdict != score::Verdict::kPass && symptom_.Same(SymptomOf(check))) same = check;
    }
    return same.has_value();
  }

  /// Whether the other program, where one is asked, passes what fails here; its run counts. A golden check has its own comparison.
  bool Sound(const Plan& plan, const std::string& check) {
    if (!options_.sound || Paired()) return true;
    ++runs_;
    return options_.sound(plan, check);
  }

  void Note(std::string what) { steps_.push_back({std::move(what), Lines(), Seconds()}); }

  /// Signals that the checks name: these stay.
  std::vector<std::string> Kept() const {
    std::vector<std::string> kept;
    // "golden T_shaft": of a trace that signal.
    if (Paired()) kept.push_back(symptom_.check.name.substr(symptom_.check.name.find(' ') + 1));
    for (const Value& check : ListAt(plan_.root, "check")) {
      if (!check.is_table()) continue;
      for (const Value::Entry& entry : check.table()) {
        if (entry.value.is_string()) kept.push_back(entry.value.string());
      }
    }
    return kept;
  }

  /// The others first: they cost runs of other solvers, and name signals that would have to stay.
  void KeepItsChecks() {
    const Value::Array checks = ListAt(plan_.root, "check");  // a copy: tries change the plan
    if (checks.size() < 2 || symptom_.check.stated.empty()) return;
    trying_ = "other checks";
    const auto of_its_kind = [&](const Value& check) { return check.TextOr("kind") == symptom_.check.stated; };
    const auto only = [](Value::Array kept) {
      return [kept = std::move(kept)](Value& root) {
        root["check"] = Value(kept);
        return !kept.empty();
      };
    };
    Value::Array its_kind;
    std::ranges::copy_if(checks, std::back_inserter(its_kind), of_its_kind);
    for (const Value& one : its_kind) {
      if (!Left() || !Try(only({one}))) continue;
      Note("other checks");
      return;
    }
    if (its_kind.size() < checks.size() && Left() && Try(only(its_kind))) Note("checks of other kinds");
  }

  void Shorten() {
    const double before = Seconds();
    // A check that looks at a stretch of time holds the run as long as that: its stretch comes earlier first.
    const bool held = LastLookOf(plan_.root) > kShort * before;
    if (!held) CutOff();
    // Where something else says that the fault is there, it may come earlier as well.
    for (const double factor : {1.0 / 16.0, 0.25, 0.5}) {
      if (!Guarded() || Seconds() < kShort * before || !Left()) break;
      trying_ = "events earlier";
      if (!Try(Earlier(factor).apply)) continue;
      Note(Earlier(factor).what);
      if (!held) CutOff();
      break;
    }
    if (held) CutOffBehind(LastLookOf(plan_.root));
    if (Seconds() < before) Note(fmt::format("shortened from {:g} s", before));
  }

  /// Whether the fault shows in a run of this length, which it has then.
  bool Lasts(double duration_s) {
    trying_ = "a shorter run";
    if (!Left() || Rounded(duration_s, 3) >= Seconds()) return false;
    const bool lasts = Try([&](Value& root) {
      root["run"]["duration_s"] = Value(Rounded(duration_s, 3));
      return true;
    });
    if (!lasts) too_short_ = std::max(too_short_, duration_s);
    return lasts;
  }

  void CutOff() {
    too_short_ = 0.0;
    const double before = Seconds();
    // From a sixteenth on: most faults show early.
    for (double tried = before / 16.0; Left() && Seconds() > kShorter * too_short_ && tried >= 1e-3 * before;) {
      Lasts(tried);
      tried = too_short_ > 0.0 ? std::sqrt(too_short_ * Seconds()) : Seconds() / 16.0;
    }
  }

  /// Cuts the run behind the check's last look; one that is shorter still is sought only where a little less than that shows it.
  void CutOffBehind(double last_look_s) {
    if (!Lasts(last_look_s) || Lasts(Seconds() / kShorter)) CutOff();
  }

  /// After other things have gone: only if what was too short before is so no more, or nothing was.
  void ShortenAgain() {
    const double before = Seconds();
    if (too_short_ == 0.0 || Lasts(too_short_)) CutOff();
    if (Seconds() < before) Note(fmt::format("shortened from {:g} s", before));
  }

  /// All moves of a group together, or as many as keep the fault. True when any did. A move that leaves nothing that can be built is
  /// no move: to find that costs no run.
  bool TakeOut(const std::string& what) {
    for (const Group& group : Groups()) {
      if (group.what == what) return TakeOut(group);
    }
    return false;
  }

  bool TakeOut(const Group& group) {
    trying_ = group.what;
    const std::size_t lines = Lines();
    std::vector<Move> possible, once_more;
    for (const Move& move : group.moves) {
      Plan plan = plan_;
      const std::string before = ToToml(plan.root);
      Apply({move}, plan.root);
      if (ToToml(plan.root) == before || Built(plan) == nullptr) continue;
      (alone_.contains(move.what) ? once_more : possible).push_back(move);
    }
    std::vector<std::string> done;
    Halve(possible, done);
    // What was refused alone mostly is so again, and would take others of its half along.
    for (auto move = once_more.rbegin(); move != once_more.rend(); ++move) Halve({*move}, done);
    if (done.empty()) return false;
    constexpr std::size_t kSaid = 4;
    std::string text = fmt::format(
        "{}", fmt::join(done.begin(), done.begin() + static_cast<std::ptrdiff_t>(std::min(kSaid, done.size())), ", "));
    if (done.size() > kSaid) text += fmt::format(" and {} more", done.size() - kSaid);
    Note(fmt::format("{}: {}", group.what, text));
    return Lines() < lines;
  }

  /// The last of all, since it takes no line of the scenario, but makes more of them fit on one: two digits where all numbers can,
  /// else as few as each can.
  void Round() {
    std::vector<std::string> done;
    const Group two = Digits(plan_.root, 2, Changed());
    trying_ = two.what;
    if (two.moves.empty() || !Left()) return;
    if (Together(two.moves, done)) {
      Note(two.what);
      return;
    }
    for (const int digits : {6, 4, 2}) TakeOut(Digits(plan_.root, digits, Changed()));
  }

  /// Whether all of these moves together keep the fault; they are done then.
  bool Together(const std::vector<Move>& moves, std::vector<std::string>& done) {
    Value changed = plan_.root;
    Apply(moves, changed);
    const auto apply = [&](Value& root) {
      Apply(moves, root);
      return true;
    };
    if (ToToml(changed) == ToToml(plan_.root) || !Try(apply)) return false;
    for (const Move& move : moves) done.push_back(move.what);
    return true;
  }

  void Halve(const std::vector<Move>& moves, std::vector<std::string>& done) {
    if (moves.empty() || !Left() || Together(moves, done)) return;
    if (moves.size() == 1) {
      alone_.insert(moves.front().what);
      return;
    }
    // Lists lose their numbers with each part that goes: the later half goes before the earlier one.
    const auto middle = moves.begin() + static_cast<std::ptrdiff_t>(moves.size() / 2);
    Halve({middle, moves.end()}, done);
    Halve({moves.begin(), middle}, done);
  }

  Plan plan_;
  std::optional<Plan> was_;   // of a golden check: what the run is compared with
  std::optional<Plan> good_;  // of another check: where it passes
  bool by_sound_ = false;     // of a golden check: the other program's run is what it is compared with
  SignalTolerances tolerances_;
  Levels levels_;  // of the whole scenario's run
  enum class Asked { kPresent, kSound, kGood };
  std::vector<Asked> order_ = {Asked::kPresent, Asked::kSound, Asked::kGood};
  std::set<std::string> refused_;  // scenarios that did not show it, with what they were compared with
  std::set<std::string> alone_;    // moves that were refused by themselves
  double too_short_ = 0.0;         // the longest run that did not show it, as what was left stood then
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
