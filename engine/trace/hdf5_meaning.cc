#include "trace/hdf5_meaning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "trace/hdf5_attributes.h"
#include "trace/hdf5_values.h"

namespace dynoproof::trace::hdf5 {
namespace {

Failure Bad(const std::string& dataset, const std::string& attribute, const std::string& what) {
  return {.message = fmt::format("dataset \"{}\": attribute \"{}\" {}", dataset, attribute, what),
          .signal = kRefused,
          .time_s = {},
          .exit_code = 2};
}

/// "Scale_Factor" -> "scalefactor".
std::string Plain(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

/// Names that stand for a scaling whose formula is not the same everywhere; and what value changes nothing.
std::optional<double> NeutralOf(std::string_view plain) {
  static constexpr std::string_view kFactors[] = {"scale",
                                                  "scales",
                                                  "scaling",
                                                  "scalingfactor",
                                                  "scalefactors",
                                                  "scaleslope",
                                                  "gain",
                                                  "gains",
                                                  "slope",
                                                  "factor",
                                                  "factors",
                                                  "multiplier",
                                                  "divisor",
                                                  "sensitivity",
                                                  "calibration",
                                                  "calibrationgain",
                                                  "calibrationslope",
                                                  "calibrationfactor",
                                                  "calfactor",
                                                  "calgain",
                                                  "conversion",
                                                  "conversionfactor",
                                                  "convfactor",
                                                  "unitfactor",
                                                  "lsb",
                                                  "lsbvalue",
                                                  "polynomial",
                                                  "coefficients",
                                                  "calibrationcoefficients",
                                                  "radiancescales"};
  static constexpr std::string_view kOffsets[] = {
      "offset",     "offsets",   "intercept",         "scaleintercept", "scaleoffset",  "bias",           "zero",
      "zerooffset", "zeropoint", "calibrationoffset", "caloffset",      "fractionbits", "fractionlength", "exponent"};
  static constexpr std::string_view kFormulas[] = {"formula", "equation", "linearization", "linearisation",
                                                   "transferfunction"};
  if (std::ranges::count(kFactors, plain) > 0) return 1.0;
  if (std::ranges::count(kOffsets, plain) > 0) return 0.0;
  if (std::ranges::count(kFormulas, plain) > 0) return std::numeric_limits<double>::quiet_NaN();
  return {};
}

/// Whether one letter less, more or other makes one of the other.
bool OneLetterApart(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty() && a.front() == b.front()) a.remove_prefix(1), b.remove_prefix(1);
  if (a.size() == b.size()) return !a.empty() && a.substr(1) == b.substr(1);
  return a.size() < b.size() ? a == b.substr(1) : a.substr(1) == b;
}

/// The attribute that changes what the numbers stand for and whose name this one has but for one letter. Short names are left
/// out: one letter makes another word of them.
const char* NearlyTheNameOf(std::string_view plain) {
  static constexpr const char* kNames[] = {"scale_factor", "add_offset", "_FillValue", "missing_value", "valid_range"};
  for (const char* const name : kNames) {
    if (OneLetterApart(plain, Plain(name))) return name;
  }
  return nullptr;
}

/// The numbers among the words of a text; a date is none.
std::vector<double> NumbersIn(std::string_view text) {
  constexpr std::string_view kBetween = " \t\r\n,;()[]{}*=/+";
  std::vector<double> numbers;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(kBetween), text.size());
    double number = 0.0;
    const auto parsed = std::from_chars(text.data(), text.data() + end, number);
    if (end > 0 && parsed.ec == std::errc() && parsed.ptr == text.data() + end) numbers.push_back(number);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers;
}

/// The numbers that an attribute says, as such or as text.
Result<std::vector<double>> NumbersOf(hid_t dataset, const std::string& attribute) {
  const Result<Attribute> value = ReadAttribute(dataset, attribute);
  if (!value.ok()) return value.failure();
  if (const auto* text = std::get_if<std::string>(&*value)) return NumbersIn(*text);
  return ReadNumbers(dataset, attribute);
}

/// Whether numbers of a scaling leave the values as they are: all neutral, or offset and gain as a pair.
bool ChangesNothing(const std::vector<double>& numbers, double neutral) {
  if (std::ranges::all_of(numbers, [&](double x) { return x == neutral; })) return true;
  return numbers.size() == 2 && numbers[0] + numbers[1] == 1.0 && numbers[0] * numbers[1] == 0.0;
}

class MeaningReader {
 public:
  MeaningReader(hid_t dataset, const std::string& name, bool scaled_later)
      : dataset_(dataset), name_(name), scaled_later_(scaled_later), type_(H5Dget_type(dataset)) {
    is_integer_ = H5Tget_class(type_.id()) == H5T_INTEGER;
    meaning_.is_signed = !is_integer_ || H5Tget_sign(type_.id()) != H5T_SGN_NONE;
  }

  Result<Meaning> Read() {
    const Result<std::vector<std::string>> names = AttributeNames(dataset_);
    if (!names.ok()) return names.failure();
    for (const std::string& attribute : *names) {
      if (Status s = Take(attribute, Plain(attribute))) {
        if (s->signal != kRefused) s->message = fmt::format("dataset \"{}\": {}", name_, s->message);
        return *s;
      }
    }
    TakeFillOfNetcdf();
    return meaning_;
  }

 private:
  Status Take(const std::string& attribute, const std::string& plain) {
    if (plain == "unit" || plain == "units") {
      const Result<Attribute> value = ReadAttribute(dataset_, attribute);
      if (!value.ok()) return value.failure();
      const auto* const text = std::get_if<std::string>(&*value);
      if (text == nullptr && !scaled_later_ && *value != Attribute(Other{0}))
        return Bad(name_, attribute,
                   "is not one text: which unit the numbers have cannot be told. Say in a map what they are, or store "
                   "one unit");
      if (text != nullptr && (meaning_.unit.empty() || attribute == "unit")) meaning_.unit = *text;
      return {};
    }
    if (plain == "interpolation") {
      const Result<Attribute> value = ReadAttribute(dataset_, attribute);
      meaning_.holds = value.ok() && *value == Attribute(std::string("hold"));  // other words are somebody else's
      return {};
    }
    if (plain == "scalefactor") return One(attribute, meaning_.scale);
    if (plain == "addoffset") return One(attribute, meaning_.offset);
    if (plain == "unsigned") return TakeSign(attribute);
    if (plain == "fillvalue" || plain == "missingvalue" || plain == "missingvalues") {
      const Result<std::vector<double>> numbers = Some(attribute);
      if (!numbers.ok()) return numbers.failure();
      for (const double number : *numbers) meaning_.missing.push_back(AsStored(number));
      return {};
    }
    if (plain == "validmin" || plain == "validmax" || plain == "validrange") return TakeLimits(attribute, plain);
    if (const std::optional<double> neutral = NeutralOf(plain)) {
      if (scaled_later_) return {};
      const Result<std::vector<double>> numbers = NumbersOf(dataset_, attribute);
      if (!numbers.ok()) return numbers.failure();
      if (!ChangesNothing(*numbers, *neutral))
        return Bad(name_, attribute,
                   fmt::format("says {}: programs mean different things by it, so it is not applied. Say in a map what "
                               "the values are (gain, offset), or store them as they are meant",
                               fmt::join(*numbers, ", ")));
      return {};
    }
    if (const char* const name = NearlyTheNameOf(plain))
      return Bad(
          name_, attribute,
          fmt::format("is nearly \"{}\", which changes what the numbers stand for: the file is damaged or the name "
                      "misspelt. Rename or remove it",
                      name));
    return {};
  }

  Result<std::vector<double>> Some(const std::string& attribute) {
    Result<std::vector<double>> numbers = NumbersOf(dataset_, attribute);
    if (numbers.ok() && numbers->empty())
      return Bad(name_, attribute, "changes what the numbers stand for, but holds no number");
    return numbers;
  }

  Status One(const std::string& attribute, double& into) {
    const Result<std::vector<double>> numbers = Some(attribute);
    if (!numbers.ok()) return numbers.failure();
    const bool is_factor = &into == &meaning_.scale;
    if (numbers->size() != 1 || !std::isfinite(numbers->front()) || (is_factor && numbers->front() == 0.0))
      return Bad(name_, attribute,
                 fmt::format("is {}, which is no {}", fmt::join(*numbers, ", "), is_factor ? "factor" : "offset"));
    into = numbers->front();
    return {};
  }

  Status TakeLimits(const std::string& attribute, const std::string& plain) {
    const Result<std::vector<double>> numbers = Some(attribute);
    if (!numbers.ok()) return numbers.failure();
    if (numbers->size() != (plain == "validrange" ? 2U : 1U))
      return Bad(name_, attribute, fmt::format("has {} numbers", numbers->size()));
    const Handle opened(H5Aopen(dataset_, attribute.c_str(), H5P_DEFAULT));
    const Handle type(H5Aget_type(opened.id()));
    if (is_integer_ && H5Tget_class(type.id()) == H5T_FLOAT) meaning_.limits_of_values = true;
    if (plain != "validmax") meaning_.least = numbers->front();
    if (plain != "validmin") meaning_.greatest = numbers->back();
    return {};
  }

  Status TakeSign(const std::string& attribute) {
    const Result<Attribute> value = ReadAttribute(dataset_, attribute);
    if (!value.ok()) return value.failure();
    const auto* const text = std::get_if<std::string>(&*value);
    const std::string word = text != nullptr ? Plain(*text) : "";
    if (word != "true" && word != "false") return Bad(name_, attribute, "is neither \"true\" nor \"false\"");
    if (is_integer_ && (word == "true") == meaning_.is_signed)
      meaning_.turn = std::ldexp(1.0, static_cast<int>(8 * H5Tget_size(type_.id())));
    return {};
  }

  /// A number as a dataset of this type would store it: 1e20 is another number in single precision.
  double AsStored(double number) const {
    return !is_integer_ && H5Tget_size(type_.id()) == sizeof(float) ? static_cast<double>(static_cast<float>(number))
                                                                    : number;
  }

  /// netCDF marks what was never written by a huge number, also where no attribute says so.
  void TakeFillOfNetcdf() {
    const Handle plist(H5Dget_create_plist(dataset_));
    H5D_fill_value_t defined = H5D_FILL_VALUE_UNDEFINED;
    double fill = 0.0;
    if (!is_integer_ && H5Pfill_value_defined(plist.id(), &defined) >= 0 && defined == H5D_FILL_VALUE_USER_DEFINED &&
        H5Pget_fill_value(plist.id(), H5T_NATIVE_DOUBLE, &fill) >= 0 && std::abs(fill) > 1e30)
      meaning_.missing.push_back(fill);
  }

  hid_t dataset_;
  const std::string& name_;
  bool scaled_later_, is_integer_ = false;
  Handle type_;
  Meaning meaning_;
};

}  // namespace

void Meaning::Apply(std::vector<double>& values) const {
  const bool scaled = scale != 1.0 || offset != 0.0;
  if (!scaled && missing.empty() && !least && !greatest && turn == 0.0) return;
  const auto signed_right = [&](double x) {
    if (turn == 0.0) return x;
    if (is_signed) return x < 0.0 ? x + turn : x;
    return x >= turn / 2 ? x - turn : x;
  };
  std::vector<double> gaps;
  for (const double gap : missing) gaps.push_back(signed_right(gap));
  const auto limit = [&](const std::optional<double>& x, double none) {
    return !x ? none : limits_of_values ? *x : signed_right(*x);
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double low = limit(least, -kInfinity), high = limit(greatest, kInfinity);
  for (double& value : values) {
    const double stored = signed_right(value), meant = scaled ? scale * stored + offset : stored;
    const double held = limits_of_values ? meant : stored;
    const bool gap = std::ranges::find(gaps, stored) != gaps.end() || held < low || held > high;
    value = gap ? std::numeric_limits<double>::quiet_NaN() : meant;
  }
}

Result<Meaning> ReadMeaning(hid_t dataset, const std::string& name, bool scaled_later) {
  return MeaningReader(dataset, name, scaled_later).Read();
}

Result<std::vector<double>> ReadMeasured(hid_t dataset, const std::string& name, const Meaning& meaning) {
  Result<std::vector<double>> values = ReadDoubles(dataset, name);
  if (values.ok()) meaning.Apply(*values);
  return values;
}

}  // namespace dynoproof::trace::hdf5
