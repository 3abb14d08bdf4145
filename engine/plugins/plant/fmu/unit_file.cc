#include "plugins/plant/fmu/unit_file.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zip.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <pugixml.hpp>
#include <sstream>

#include "base/units.h"

namespace dynoproof {
namespace {

namespace fs = std::filesystem;

/// Unpacks an archive; what is wrong, or "".
std::string Unpack(const std::string& path, const fs::path& folder) {
  int code = 0;
  zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &code);
  if (archive == nullptr) return "no archive: a unit is a zip file";
  std::string fault;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0) && fault.empty(); ++i) {
    zip_stat_t stat;
    if (zip_stat_index(archive, static_cast<zip_uint64_t>(i), 0, &stat) != 0) {
      fault = "an entry of the archive cannot be read";
      break;
    }
    const fs::path name = fs::path(stat.name).lexically_normal();
    // A name may not lead out of the folder.
    if (name.is_absolute() || name.empty() || *name.begin() == "..") {
      fault = fmt::format("the archive holds \"{}\", which leads out of it", stat.name);
      break;
    }
    std::error_code error;
    if (std::string_view(stat.name).ends_with('/')) {
      fs::create_directories(folder / name, error);
      continue;
    }
    fs::create_directories((folder / name).parent_path(), error);
    std::string bytes(stat.size, '\0');
    zip_file_t* file = zip_fopen_index(archive, static_cast<zip_uint64_t>(i), 0);
    // The sum of its bytes is compared once its end is met.
    char beyond = 0;
    const bool read = file != nullptr &&
                      zip_fread(file, bytes.data(), bytes.size()) == static_cast<zip_int64_t>(bytes.size()) &&
                      zip_fread(file, &beyond, 1) == 0;
    if (file != nullptr) zip_fclose(file);
    std::ofstream out(folder / name, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!read || !out.flush()) fault = fmt::format("\"{}\" of the archive cannot be unpacked", stat.name);
  }
  zip_discard(archive);
  return fault;
}

/// An attribute of a variable's type, its own or that of the type that it is declared to have.
std::string Attribute(const pugi::xml_node& real, const pugi::xml_node& types, const char* name) {
  if (const pugi::xml_attribute own = real.attribute(name)) return own.value();
  const std::string declared = real.attribute("declaredType").value();
  if (declared.empty()) return "";
  return types.find_child_by_attribute("SimpleType", "name", declared.c_str()).child("Real").attribute(name).value();
}

/// "N.m" of a unit as "N m"; "1" where it is none that is known here.
std::string UnitNamed(std::string text) {
  std::ranges::replace(text, '.', ' ');
  return !text.empty() && ParseUnit(text) ? text : "1";
}

double NumberOr(const std::string& text, double otherwise) {
  try {
    return text.empty() ? otherwise : std::stod(text);
  } catch (const std::exception&) {
    return otherwise;
  }
}

UnitVariable VariableOf(const pugi::xml_node& node, const pugi::xml_node& types) {
  const pugi::xml_node real = node.child("Real");
  UnitVariable one;
  one.name = node.attribute("name").value();
  one.description = node.attribute("description").value();
  one.reference = node.attribute("valueReference").as_uint();
  one.unit = UnitNamed(Attribute(real, types, "unit"));
  one.start = NumberOr(Attribute(real, types, "start"), 0.0);
  one.nominal = std::abs(NumberOr(Attribute(real, types, "nominal"), 1.0));
  if (!(one.nominal > 0.0)) one.nominal = 1.0;
  return one;
}

/// Reads modelDescription.xml into the file; what is wrong, or "".
std::string Describe(const pugi::xml_node& root, UnitFile& file) {
  if (std::string_view(root.attribute("fmiVersion").value()) != "2.0")
    return fmt::format("its FMI version is \"{}\", and not 2.0", root.attribute("fmiVersion").value());
  const pugi::xml_node exchange = root.child("ModelExchange");
  if (!exchange)
    return "it is no unit for model exchange: one for co-simulation keeps its state to itself, and no solver can step "
           "back";
  if (root.attribute("numberOfEventIndicators").as_uint() > 0)
    return fmt::format("it has {} event indicators: events inside a unit are not followed",
                       root.attribute("numberOfEventIndicators").as_uint());
  file.guid = root.attribute("guid").value();
  file.identifier = exchange.attribute("modelIdentifier").value();
  file.once_in_a_process = exchange.attribute("canBeInstantiatedOnlyOncePerProcess").as_bool();
  const pugi::xml_node types = root.child("TypeDefinitions");
  std::vector<pugi::xml_node> variables;
  for (const pugi::xml_node& node : root.child("ModelVariables").children("ScalarVariable")) variables.push_back(node);
  const auto at = [&](unsigned index) {
    return index >= 1 && index <= variables.size() ? variables[index - 1] : pugi::xml_node();
  };
  for (const pugi::xml_node& unknown : root.child("ModelStructure").child("Derivatives").children("Unknown")) {
    const pugi::xml_node state =
        at(at(unknown.attribute("index").as_uint()).child("Real").attribute("derivative").as_uint());
    if (!state) return "one of its derivatives names no state";
    file.states.push_back(VariableOf(state, types));
  }
  std::map<unsigned, std::size_t> input_at;  // by index
  for (std::size_t i = 0; i < variables.size(); ++i) {
    if (!variables[i].child("Real")) continue;
    const std::string_view causality = variables[i].attribute("causality").value();
    const UnitVariable one = VariableOf(variables[i], types);
    if (causality == "input") {
      input_at[static_cast<unsigned>(i + 1)] = file.inputs.size();
      file.inputs.push_back(one);
    } else if (causality == "parameter") {
      file.parameters.push_back(one);
    }
  }
  for (std::size_t i = 0; i < variables.size(); ++i) {
    if (!variables[i].child("Real") || std::string_view(variables[i].attribute("causality").value()) != "output")
      continue;
    const UnitVariable one = VariableOf(variables[i], types);
    if (std::ranges::count(file.states, one.reference, &UnitVariable::reference) > 0) continue;
    file.outputs.push_back(one);
    // Without a list of what it depends on it may depend on all.
    const pugi::xml_node known = root.child("ModelStructure")
                                     .child("Outputs")
                                     .find_child_by_attribute("Unknown", "index", std::to_string(i + 1).c_str());
    const pugi::xml_attribute dependencies = known.attribute("dependencies");
    std::vector<bool> feeds(file.inputs.size(), !dependencies);
    std::istringstream list(dependencies.value());
    for (unsigned index = 0; list >> index;) {
      if (const auto input = input_at.find(index); input != input_at.end()) feeds[input->second] = true;
    }
    file.feeds.push_back(std::move(feeds));
  }
  return file.identifier.empty() ? "it names no library" : "";
}

template <class Function>
bool Load(void* library, const char* name, Function& function, std::string& lacking) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  if (function == nullptr) lacking = name;
  return function != nullptr;
}

/// The name of a function that the library lacks; empty: it has all.
std::string LoadAll(void* library, UnitFunctions& f) {
  std::string lacking;
  (void)(Load(library, "fmi2Instantiate", f.instantiate, lacking) &&
         Load(library, "fmi2FreeInstance", f.free_instance, lacking) &&
         Load(library, "fmi2SetupExperiment", f.setup_experiment, lacking) &&
         Load(library, "fmi2EnterInitializationMode", f.enter_initialization, lacking) &&
         Load(library, "fmi2ExitInitializationMode", f.exit_initialization, lacking) &&
         Load(library, "fmi2NewDiscreteStates", f.new_discrete_states, lacking) &&
         Load(library, "fmi2EnterContinuousTimeMode", f.enter_continuous_time, lacking) &&
         Load(library, "fmi2GetReal", f.get_real, lacking) && Load(library, "fmi2SetReal", f.set_real, lacking) &&
         Load(library, "fmi2SetTime", f.set_time, lacking) &&
         Load(library, "fmi2SetContinuousStates", f.set_states, lacking) &&
         Load(library, "fmi2GetContinuousStates", f.get_states, lacking) &&
         Load(library, "fmi2GetDerivatives", f.get_derivatives, lacking));
  return lacking;
}

}  // namespace

UnitFile::~UnitFile() {
  if (library_ != nullptr) ::dlclose(library_);
  std::error_code error;
  if (!folder_.empty()) fs::remove_all(folder_, error);
}

Result<std::shared_ptr<const UnitFile>> UnitFile::Of(const std::string& path) {
  // A fit builds the same plant thousands of times.
  static std::mutex mutex;
  static std::map<std::string, std::pair<fs::file_time_type, std::shared_ptr<const UnitFile>>> known;
  const std::scoped_lock lock(mutex);
  std::error_code error;
  const fs::path whole = fs::canonical(path, error);
  if (error) return Failure{.message = "there is no such file", .signal = path, .exit_code = 2};
  const fs::file_time_type written = fs::last_write_time(whole, error);
  if (const auto found = known.find(whole.string()); found != known.end() && found->second.first == written)
    return found->second.second;
  const auto fault = [&](const std::string& what) { return Failure{.message = what, .signal = path, .exit_code = 2}; };
  std::string folder = (fs::temp_directory_path(error) / "dynoproof_unit_XXXXXX").string();
  if (error || ::mkdtemp(folder.data()) == nullptr) return fault("no temporary folder to unpack it in");
  std::shared_ptr<UnitFile> file(new UnitFile());
  file->folder_ = folder;
  if (const std::string wrong = Unpack(whole.string(), folder); !wrong.empty()) return fault(wrong);
  pugi::xml_document document;
  if (!document.load_file((folder + "/modelDescription.xml").c_str()))
    return fault("it has no modelDescription.xml that can be read");
  if (const std::string wrong = Describe(document.child("fmiModelDescription"), *file); !wrong.empty())
    return fault(wrong);
  file->resources = "file://" + folder + "/resources";
  const std::string library = folder + "/binaries/linux64/" + file->identifier + ".so";
  file->library_ = ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (file->library_ == nullptr)
    return fault(fmt::format("its library for 64-bit Linux does not load: {}", ::dlerror()));
  if (const std::string lacking = LoadAll(file->library_, file->functions); !lacking.empty())
    return fault(fmt::format("its library has no {}", lacking));
  known[whole.string()] = {written, file};
  return std::shared_ptr<const UnitFile>(file);
}

}  // namespace dynoproof
