// Pictures of laws with play: the phase plane of the shaft.
#include "experiment/pictures_phase_plane.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/law.h"
#include "model/motion.h"

namespace dynoproof {
namespace {

const Value::Table& ShaftsOf(const Plan& plan) {
  static const Value::Table none;
  const Value* shafts = plan.root.FindPath("plant.shaft");
  return shafts != nullptr && shafts->is_table() ? shafts->table() : none;
}

/// The output that shows `quantity` of a shaft.
std::string OutputOf(const Plan& plan, const std::string& shaft, const std::string& quantity) {
  const Value* outputs = plan.root.Find("output");
  for (const Value::Entry& output : outputs != nullptr && outputs->is_table() ? outputs->table() : Value::Table{}) {
    if (output.value.TextOr("of") == fmt::format("plant.{}.{}", shaft, quantity)) return output.key;
  }
  return "";
}

/// Where the sides touch at twist > 0 for a twist rate: the least such twist, found by asking the law itself.
double Boundary(const Law& law, double rate, double half_gap) {
  std::vector<double> states(law.layout().states.size());
  std::vector<int> modes(static_cast<std::size_t>(law.layout().modes));
  const auto touches = [&](double twist) {
    std::fill(states.begin(), states.end(), 0.0);
    std::fill(modes.begin(), modes.end(), 0);
    law.Start(twist, rate, states, modes);
    return modes[0] == 1;
  };
  double low = -half_gap, high = 4.0 * half_gap;
  if (touches(low)) return low;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (touches(middle) ? high : low) = middle;
  }
  return high;
}

/// The activation areas A+ and A- of a law in the plane of twist and twist rate (thesis Figs. 3.5, 3.8).
void AddAreas(const Law& law, const std::string& name, double half_gap, double most_twist, double most_rate,
              Picture& picture) {
  Area plus{name + ": A+, touching at twist > 0", {}, {}}, minus{name + ": A-, touching at twist < 0", {}, {}};
  constexpr int kPoints = 400;
  for (int i = 0; i <= kPoints; ++i) {
    const double rate = most_rate * (2.0 * i / kPoints - 1.0);
    const double at = std::min(Boundary(law, rate, half_gap), most_twist);
    plus.x.push_back(at);
    plus.y.push_back(rate);
    minus.x.push_back(-at);  // the laws are odd
    minus.y.push_back(-rate);
  }
  for (auto [area, side] : {std::pair(&plus, 1.0), std::pair(&minus, -1.0)}) {
    area->x.push_back(side * most_twist);
    area->y.push_back(side * most_rate);
    area->x.push_back(side * most_twist);
    area->y.push_back(-side * most_rate);
    picture.areas.push_back(std::move(*area));
  }
}

std::unique_ptr<Law> MakeLaw(const Prepared& prepared, const Value& shaft, const std::string& name) {
  Diagnostics ignored;  // the rig has been built of the same table
  const Motion motion = MotionIn(prepared.plan.root);
  BuildContext context{
      *prepared.registry,
      ignored,
      name,
      {"between", NameIn(motion, "initial_twist_rad"), NameIn(motion, "initial_twist_rate_rad_per_s"), "law"}};
  context.motion = motion;
  return prepared.registry->MakeLaw(shaft.TextOr("law"), shaft, context);
}

}  // namespace

void AddPhasePlanes(const Prepared& prepared, const Course& course, RunPictures& pictures) {
  const Motion motion = MotionIn(prepared.plan.root);
  for (const Value::Entry& shaft : ShaftsOf(prepared.plan)) {
    const double half_gap = shaft.value.NumberOr(KeyIn(motion, shaft.value, "half_gap_rad"), 0.0);
    const std::string twist = OutputOf(prepared.plan, shaft.key, NameIn(motion, "twist")),
                      rate = OutputOf(prepared.plan, shaft.key, "rate");
    if (!(half_gap > 0.0) || twist.empty() || rate.empty()) continue;
    // The scenario's law and one with damping inside the gap, if a variant has one: the thesis compares these two.
    std::vector<std::pair<std::string, const Plan*>> laws = {{"", &prepared.plan}};
    for (const Prepared::Variant& variant : prepared.variants) {
      const Value* own = variant.plan.root.FindPath("plant.shaft")->Find(shaft.key);
      if (own != nullptr && own->TextOr("law") == "damped_" + shaft.value.TextOr("law")) {
        laws.emplace_back("_" + variant.name, &variant.plan);
      }
    }
    for (const auto& [suffix, plan] : laws) {
      const Value& table = *plan->root.FindPath("plant.shaft")->Find(shaft.key);
      const trace::Signal *d = course.trace.Find(twist + suffix), *w = course.trace.Find(rate + suffix);
      const std::unique_ptr<Law> law = MakeLaw(prepared, table, shaft.key);
      if (d == nullptr || w == nullptr || law == nullptr || law->layout().modes < 1) continue;
      const std::string name = table.TextOr("law");
      Picture picture{.key = "phase_plane:" + name,
                      .title = fmt::format("Phase plane of shaft \"{}\", {}", shaft.key, name),
                      .note = TextIn(motion,
                                     "twist against its rate; in the areas both sides touch, in between the "
                                     "shaft is free"),
                      .x = {NameIn(motion, "twist") + " " + twist, UnitIn(motion, "rad")},
                      .y = {NameIn(motion, "twist") + " rate " + rate, UnitIn(motion, "rad/s")}};
      double most_twist = 0.0, most_rate = 0.0;
      for (std::size_t i = 0; i < d->values.size(); ++i) {
        most_twist = std::max(most_twist, std::abs(d->values[i]));
        most_rate = std::max(most_rate, std::abs(w->values[i]));
      }
      most_twist = 1.1 * std::max(most_twist, 1.2 * half_gap);
      most_rate *= 1.1;
      picture.x.from = -most_twist;
      picture.x.to = most_twist;
      picture.y.from = -most_rate;
      picture.y.to = most_rate;
      AddAreas(*law, name, half_gap, most_twist, most_rate, picture);
      picture.curves.push_back({"motion", d->values, w->values});
      picture.marks = {{half_gap, "half gap"}, {-half_gap, ""}};
      pictures.pictures.push_back(std::move(picture));
    }
  }
}

}  // namespace dynoproof
