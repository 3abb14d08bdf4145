#include "app/examples.h"

#include <fmt/format.h>

#include <map>

namespace dynoproof::app {
namespace {

/// Numbers of the parameters that the laws share, for a line of a few kg m^2 under 100 N m.
const std::map<std::string, std::string>& UsualNumbers() {
  static const std::map<std::string, std::string> numbers = {
      {"stiffness_Nm_per_rad", "2.5e5"},
      {"damping_Nms_per_rad", "6.0"},
      {"k3_Nm_per_rad3", "1e9"},
      {"loss", "0.2"},
      {"loss_time_s", "600.0"},
      {"half_gap_rad", "0.01"},
      {"contact_free_damping_Nms_per_rad", "0.1"},
      {"k_p_m3", "0.07"},
      {"kappa_p_per_s", "190.0"},
      {"kappa_w_Pa_per_rad", "2.2e6"},
      {"segments", "12"},
      {"width_m", "0.125"},
      {"length_m", "0.08"},
      {"inner_radius_m", "0.11"},
      {"chamber_volume_m3", "3e-4"},
      {"gap_height_m", "1.6e-3"},
      {"gap_length_m", "0.03"},
      {"bulk_modulus_Pa", "1e6"},
      {"largest_twist_rad", "0.015"},
      {"largest_rate_rad_per_s", "0.1"},
      {"b_Nms_per_rad", "0.02"},
      {"b2_Nms2_per_rad2", "1e-4"},
      {"T_0_Nm", "5.0"},
      {"A_Nm", "2.0"},
      {"n", "36.0"},
      {"F_c_Nm", "0.2"},
      {"sigma_Nm_per_rad", "150.0"},
      {"T_c_Nm", "2.0"},
      {"T_s_Nm", "3.0"},
      {"w_s_rad_per_s", "0.5"},
      {"T_c_pos_Nm", "2.0"},
      {"T_c_neg_Nm", "3.0"},
  };
  return numbers;
}

}  // namespace

std::string ExampleOf(const PluginInfo& law) {
  // Dry friction and loads act between a body and the ground; a law with a stiffness joins two.
  bool shaft = false;
  for (const ParamInfo& one : law.parameters) shaft = shaft || one.name == "stiffness_Nm_per_rad";
  std::string text = shaft ? "[plant.shaft.k2]\nbetween = [\"I2\", \"I3\"]\n" : "[plant.load.bearing]\non = \"I3\"\n";
  text += fmt::format("law = \"{}\"\n", law.name);
  for (const ParamInfo& one : law.parameters) {
    // What may be left out stays out, but for what nearly every shaft has and for the oil's stiffness with its air.
    const bool usual =
        one.name == "stiffness_Nm_per_rad" || one.name == "damping_Nms_per_rad" || one.name == "bulk_modulus_Pa";
    if (!one.fallback.empty() && !usual) continue;
    const auto number = UsualNumbers().find(one.name);
    text += number != UsualNumbers().end() ? fmt::format("{} = {}\n", one.name, number->second)
                                           : fmt::format("{} = ...    # {}, {}\n", one.name, one.unit, one.range);
  }
  return text;
}

std::string ExampleOf(const EffectInfo& effect) {
  std::string parameters;
  for (const EffectParameter& one : effect.parameters)
    parameters += fmt::format("{}{} = {:g}", parameters.empty() ? "" : ", ", one.name, one.start);
  const std::string line = parameters.empty() ? "" : fmt::format("parameters = {{ {} }}\n", parameters);
  return fmt::format(
      "[[effect]]\nname = \"{}\"\nat = \"KIND:NAME\"   # dynoproof describe SCENARIO lists the places\n{}", effect.name,
      line);
}

}  // namespace dynoproof::app
