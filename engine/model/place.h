// Where an effect can sit in a plan.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dynoproof {

/// Where an effect can sit: kind:name[@quantity], such as "inertia:I5", "shaft:k3", "output:T_shaft".
struct Place {
  std::string kind, name, quantity;

  std::string ToString() const;
  friend bool operator==(const Place&, const Place&) = default;
};
std::optional<Place> ParsePlace(std::string_view text);

}  // namespace dynoproof
