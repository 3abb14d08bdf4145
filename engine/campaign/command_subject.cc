#include "campaign/command_subject.h"

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/process.h"

namespace dynoproof::campaign {
namespace {

namespace fs = std::filesystem;

class CommandSubject : public Subject {
 public:
  CommandSubject(std::vector<std::string> command, std::vector<std::pair<std::string, FigureSpec>> figures,
                 const Axes& axes, std::string folder)
      : command_(std::move(command)), specs_(std::move(figures)), axes_(axes), folder_(std::move(folder)) {
    for (const auto& [name, spec] : specs_) figures_.push_back({name, "1", spec.at_least, spec.at_most});
  }

  const std::vector<FigureInfo>& figures() const override { return figures_; }

  Status Run(Range runs, bool, const std::function<void(Row)>& done) const override {
    for (std::int64_t run = runs.begin; run < runs.end; ++run) {
      std::error_code error;
      const std::string folder = FolderOf(run);
      fs::create_directories(folder, error);
      if (error) return Failure{error.message(), folder};
      done(RowOf(run, RunProgram(Words(run))));
      fs::remove(folder, error);  // if it is empty
    }
    return {};
  }

  std::string Command(std::int64_t run) const override {
    std::string command;
    for (const std::string& word : Words(run)) command += (command.empty() ? "" : " ") + word;
    return command;
  }

 private:
  std::string FolderOf(std::int64_t run) const {
    return (fs::path(folder_) / "work" / fmt::format("run_{:09}", run)).string();
  }

  std::vector<std::string> Words(std::int64_t run) const {
    std::vector<std::string> words = command_;
    const auto put = [&words](const std::string& key, const std::string& text) {
      const std::string place = "{" + key + "}";
      for (std::string& word : words) {
        for (std::size_t at = 0; (at = word.find(place, at)) != std::string::npos; at += text.size())
          word.replace(at, place.size(), text);
      }
    };
    for (std::size_t i = 0; i < axes_.size(); ++i) put(axes_.spec(i).key, TextOf(axes_.At(i, run)));
    put("run", fmt::format("{}", run));
    put("seed", fmt::format("{}", axes_.Seed(run)));
    put("folder", FolderOf(run));
    return words;
  }

  /// What `path` ("residual.noise_floor") leads to. A text answers its name behind it with 1 ("verdict.no_effect"), any
  /// other with 0; what leads nowhere is no number.
  static double At(const nlohmann::json& found, const std::string& path) {
    if (found.is_number() && path.empty()) return found.get<double>();
    if (found.is_string() && !path.empty()) return found == path ? 1.0 : 0.0;
    if (found.is_object() && found.contains(path)) return At(found.at(path), "");
    for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
      const std::string head = path.substr(0, dot), rest = path.substr(dot + 1);
      if (found.is_object() && found.contains(head)) return At(found.at(head), rest);
      const bool index = head.find_first_not_of("0123456789") == std::string::npos && head.size() < 9;
      if (found.is_array() && index && std::stoul(head) < found.size()) return At(found.at(std::stoul(head)), rest);
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

  /// What was printed as JSON: the last line, or an object over several lines with messages before and behind.
  static nlohmann::json DocumentOf(const std::string& out, const std::string& last) {
    nlohmann::json found = nlohmann::json::parse(last, nullptr, false);
    const std::size_t begin = out.starts_with('{') ? 0 : out.find("\n{\n"), end = out.rfind("\n}");
    if (!found.is_object() && begin < end && end != std::string::npos)
      found = nlohmann::json::parse(out.substr(begin, end + 2 - begin), nullptr, false);
    return found;
  }

  Row RowOf(std::int64_t run, const ProgramEnd& answer) const {
    Row row;
    row.run = run;
    row.figures.assign(specs_.size(), std::numeric_limits<double>::quiet_NaN());
    row.verdict = score::Verdict::kBroken;
    std::string last = answer.out.substr(0, answer.out.find_last_not_of("\r\n ") + 1);
    last.erase(0, last.rfind('\n') + 1);  // npos + 1 = 0
    const nlohmann::json found = DocumentOf(answer.out, last);
    if (answer.exit != 0) {
      const nlohmann::json told = found.is_object() ? found.value("diagnostics", nlohmann::json()) : nlohmann::json();
      const bool says = told.is_array() && !told.empty() && told.back().is_object();
      row.why = fmt::format("exit {}: {}", answer.exit, says ? told.back().value("message", last) : last);
      return row;
    }
    if (!found.is_object()) {
      row.why = "neither what it prints nor its last line is a JSON object: " + last;
      return row;
    }
    bool judged = false;
    row.verdict = score::Verdict::kPass;
    for (std::size_t i = 0; i < specs_.size(); ++i) {
      const auto& [name, spec] = specs_[i];
      row.figures[i] = At(found, spec.from);
      judged = judged || spec.limited();
      row.Takes(spec.Used(row.figures[i]), spec.Limits(name, row.figures[i]));
      const std::string fault = spec.Fault(name, row.figures[i]);
      if (fault.empty()) continue;
      row.verdict = score::Verdict::kFail;
      if (row.why.empty()) row.why = fault;
    }
    if (judged) return row;
    row.verdict = score::Verdict::kInconclusive;
    row.why = "no limit: nothing was judged";
    return row;
  }

  std::vector<std::string> command_;
  std::vector<std::pair<std::string, FigureSpec>> specs_;
  const Axes& axes_;
  std::string folder_;
  std::vector<FigureInfo> figures_;
};

}  // namespace

std::unique_ptr<Subject> MakeCommandSubject(std::vector<std::string> command,
                                            std::vector<std::pair<std::string, FigureSpec>> figures, const Value& root,
                                            const Axes& axes, const std::string& folder, Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  for (const auto& [name, spec] : figures) {
    if (!spec.from.empty()) continue;
    diagnostics.Error(root.FindPath("figure." + name)->where(), "a program has no signals",
                      "from = the name of a number it prints");
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const bool used = std::any_of(command.begin(), command.end(), [&](const std::string& word) {
      return word.find("{" + axes.spec(i).key + "}") != std::string::npos;
    });
    if (!used)
      diagnostics.Error(root.Find("axis")->array()[i].where(),
                        fmt::format("the command has no {{{}}}: the axis would change nothing", axes.spec(i).key));
  }
  if (diagnostics.error_count() != before) return nullptr;
  return std::make_unique<CommandSubject>(std::move(command), std::move(figures), axes, folder);
}

}  // namespace dynoproof::campaign
