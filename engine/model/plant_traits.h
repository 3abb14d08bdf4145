// What a plant says of itself beyond its equations, for effects and for whoever fits it to a record. A plant class
// declares it by a static member `PlantTraits Traits()`; without one a plant has none of it and is simulated all the
// same.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "model/place.h"
#include "model/plan.h"

namespace dynoproof {

/// A number of the plan that is known to a tolerance only, and is estimated along with every hypothesis. Its prior is
/// normal: value = nominal exp(spread z) where it is relative, else nominal + spread z, with z standard normal.
struct NuisanceParameter {
  std::string path;  // "plant.inertia.I5"
  bool relative = true;
  double spread = 0.0;          // standard deviation: of the logarithm, or in its own unit
  std::string reason;           // why it is this large
  bool initial = false;         // an initial state: belongs to the record, not to the model
  bool only_in_motion = false;  // of an initial state: only of records that begin otherwise than the plan does
  bool only_released = false;   // exact, unless nominal values are let go: then it is a fitted value like others
};

/// The forces and dampings in [plant.load], which stand for whatever a fit has put there; not those that are 0.
std::vector<NuisanceParameter> LoadSizes(const Plan& plan);

/// An initial value of the plan that an output shows: the record's first sample takes its place.
struct MeasuredStart {
  std::string path, port;                                   // "plant.volume.V_1.start_pressure_Pa", "plant.p_ch"
  double lower = -std::numeric_limits<double>::infinity();  // a first sample below is an error of the sensor
};

struct PlantTraits {
  /// Numbers of a plan with this plant; relative ones that are not written, or 0, are passed over.
  std::function<std::vector<NuisanceParameter>(const Plan&)> nuisances = {};
  std::vector<MeasuredStart> measured_starts = {};
  /// [plant] is laid out as a drive line: inertia, rotor, shaft, load, torque and run by name.
  bool drive_line = false;
  /// Its bodies slide, whatever the plan says of their motion.
  bool slides = false;
  /// Bodies that a [plant.load.NAME] on them brakes, as places.
  std::function<std::vector<Place>(const Plan&)> bodies = {};
  /// The inputs are the motion and the output a force, so that a run costs next to nothing.
  bool prescribed_motion = false;
  /// Sections of [plant] whose tables are places, [plant.volume.V_1] as volume:V_1.
  std::vector<std::string> sections = {};
  /// Ports that position a valve or flap through a linkage, which may have play: "plant.u_1".
  std::vector<std::string> linkages = {};
  /// An experiment that tells its effects apart, as an order to whoever runs the next test; empty: that of a drive
  /// line.
  std::string separating_experiment = {};
};

/// By the plant's name.
using PlantCatalogue = std::map<std::string, PlantTraits, std::less<>>;
/// What the plant of a plan declares; nothing for a plant that the catalogue does not have.
const PlantTraits& PlantOf(const Plan& plan, const PlantCatalogue& plants);

}  // namespace dynoproof
