#include "history/store.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <map>
#include <span>
#include <sstream>

#include "base/atomic_file.h"
#include "base/units.h"

namespace dynoproof::history {
namespace {

// One transaction: a history that was begun and not finished is none, and the next call begins it.
constexpr const char* kSchema = R"(
  BEGIN IMMEDIATE;
  PRAGMA application_id = 1146703952;
  CREATE TABLE IF NOT EXISTS night (
    id INTEGER PRIMARY KEY, time TEXT NOT NULL, commit_id TEXT NOT NULL, machine TEXT NOT NULL,
    UNIQUE (time, commit_id, machine));
  CREATE TABLE IF NOT EXISTS reading (
    night INTEGER NOT NULL REFERENCES night, series TEXT NOT NULL, value REAL, unit TEXT NOT NULL,
    scatters INTEGER NOT NULL, sense INTEGER NOT NULL, relevant REAL NOT NULL, PRIMARY KEY (night, series)) WITHOUT ROWID;
  COMMIT;
)";

/// A prepared statement; texts and numbers are bound from 1 on.
class Statement {
 public:
  Statement(sqlite3* database, const char* sql) { sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr); }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& Text(int place, const std::string& text) {
    sqlite3_bind_text(statement_, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
    return *this;
  }
  Statement& Number(int place, std::optional<double> value) {
    value ? sqlite3_bind_double(statement_, place, *value) : sqlite3_bind_null(statement_, place);
    return *this;
  }
  Statement& Integer(int place, std::int64_t value) {
    sqlite3_bind_int64(statement_, place, value);
    return *this;
  }
  /// True with a row, false when done; `good` tells whether it went well.
  bool Step() {
    const int code = sqlite3_step(statement_);
    good_ = code == SQLITE_ROW || code == SQLITE_DONE;
    return code == SQLITE_ROW;
  }
  /// Runs a statement without rows, ready to be bound anew.
  bool Run() {
    Step();
    sqlite3_reset(statement_);
    return good_;
  }
  bool good() const { return good_; }
  std::string TextAt(int column) const {
    const unsigned char* text = sqlite3_column_text(statement_, column);
    return text == nullptr ? "" : reinterpret_cast<const char*>(text);
  }
  std::int64_t IntegerAt(int column) const { return sqlite3_column_int64(statement_, column); }
  double NumberAt(int column) const { return sqlite3_column_double(statement_, column); }
  bool IsNumberAt(int column) const {
    const int type = sqlite3_column_type(statement_, column);
    return type == SQLITE_INTEGER || (type == SQLITE_FLOAT && std::isfinite(NumberAt(column)));
  }
  bool NothingAt(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }

 private:
  sqlite3_stmt* statement_ = nullptr;
  bool good_ = false;
};

bool Execute(sqlite3* database, const char* sql) {
  return sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK;
}

/// The second after an ISO time such as 2026-01-31T02:00:00Z.
std::string NextSecond(const std::string& time) {
  std::tm parts{};
  std::istringstream(time) >> std::get_time(&parts, "%Y-%m-%dT%H:%M:%SZ");
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(timegm(&parts) + 1));
}

/// What takes a value in one unit to the other; nothing where they are of different quantities.
std::optional<double> FactorTo(const std::string& unit, const std::string& other) {
  if (unit == other) return 1.0;
  const std::optional<Unit> from = ParseUnit(unit), to = ParseUnit(other);
  if (!from || !to || !SameQuantity(*from, *to) || from->offset != to->offset) return std::nullopt;
  return from->factor / to->factor;
}

/// Gathers the rows of one series: the parts of different quantities are different series.
class SeriesRows {
 public:
  void Add(const Series& newest, std::size_t night, std::optional<double> value) {
    for (Series& part : parts_) {
      const std::optional<double> factor = FactorTo(part.unit, newest.unit);
      if (!factor) continue;
      for (std::optional<double>& earlier : part.values) {
        if (earlier) *earlier *= *factor;
      }
      Append(part, newest, night, value);
      return;
    }
    parts_.push_back(newest);
    Append(parts_.back(), newest, night, value);
  }
  /// The part of the newest night keeps the name.
  void MoveTo(std::vector<Series>& all) {
    std::size_t newest = 0;
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      if (parts_[i].nights.back() >= parts_[newest].nights.back()) newest = i;
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (i != newest) parts_[i].name += fmt::format(" [{}]", parts_[i].unit);
      all.push_back(std::move(parts_[i]));
    }
    parts_.clear();
  }

 private:
  static void Append(Series& part, const Series& newest, std::size_t night, std::optional<double> value) {
    part.unit = newest.unit;
    part.scatters = newest.scatters;
    part.sense = newest.sense;
    part.relevant = newest.relevant;
    part.nights.push_back(night);
    part.values.push_back(value);
  }
  std::vector<Series> parts_;
};

}  // namespace

void Store::Closer::operator()(sqlite3* database) const { sqlite3_close(database); }

Failure Store::Wrong(const std::string& what, int exit_code) const {
  return {.message = what + ": " + sqlite3_errmsg(database_.get()), .signal = file_, .exit_code = exit_code};
}

namespace {

/// Makes a history without nights, whole or not at all: what SQLite itself makes is an empty file at first.
Status Create(const std::string& file) {
  sqlite3* memory = nullptr;
  if (sqlite3_open_v2(":memory:", &memory, SQLITE_OPEN_READWRITE, nullptr) != SQLITE_OK || !Execute(memory, kSchema)) {
    Failure failure{.message = fmt::format("cannot be begun: {}", sqlite3_errmsg(memory)), .signal = file};
    sqlite3_close(memory);
    return failure;
  }
  sqlite3_int64 size = 0;
  unsigned char* image = sqlite3_serialize(memory, "main", &size, 0);
  const Status failed =
      image == nullptr ? Status(Failure{.message = "cannot be begun: out of memory", .signal = file})
                       : CreateFileAtomically(file, std::as_bytes(std::span(image, static_cast<std::size_t>(size))));
  sqlite3_free(image);
  sqlite3_close(memory);
  return failed;
}

}  // namespace

Result<Store> Store::Open(const std::string& file, bool create) {
  if (!create && !std::filesystem::exists(file)) {
    return Failure{
        .message = "there is no history here; begin one with `dynoproof history add`", .signal = file, .exit_code = 2};
  }
  if (create && !std::filesystem::exists(file)) {
    if (Status failed = Create(file)) return *failed;
  }
  Store store;
  store.file_ = file;
  sqlite3* database = nullptr;
  const int opened =
      sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READWRITE | (create ? SQLITE_OPEN_CREATE : 0), nullptr);
  store.database_.reset(database);
  if (opened != SQLITE_OK) return store.Wrong("cannot be opened");
  sqlite3_busy_timeout(database, 10'000);  // another job may be writing
  {
    Statement kind(database, "PRAGMA application_id");
    Statement tables(database, "SELECT count(*) FROM sqlite_master");
    // Those of a history whose beginning an earlier version was killed in: its tables came first, one by one.
    Statement own(database, "SELECT count(*) FROM sqlite_master WHERE tbl_name IN ('night', 'reading')");
    kind.Step();
    if (!tables.Step() || !own.Step()) return store.Wrong("is no history", 2);
    const bool begun = kind.IntegerAt(0) == 0 && own.IntegerAt(0) == tables.IntegerAt(0);
    if (tables.IntegerAt(0) > 0 && kind.IntegerAt(0) != 1146703952 && !begun) {
      return Failure{.message = "is a database of something else", .signal = file, .exit_code = 2};
    }
  }
  {
    Statement sound(database, "PRAGMA quick_check(1)");
    if (!sound.Step()) return store.Wrong("is no history", 2);
    if (sound.TextAt(0) != "ok")
      return Failure{
          .message = "is damaged: " + sound.TextAt(0) + "; take it from a copy", .signal = file, .exit_code = 2};
  }
  if (create && !Execute(database, kSchema)) {
    Failure failure = store.Wrong("cannot be written");
    Execute(database, "ROLLBACK");
    return failure;
  }
  return store;
}

Status Store::Transact(const std::function<bool()>& add) {
  sqlite3* database = database_.get();
  if (!Execute(database, "BEGIN IMMEDIATE")) return Wrong("cannot be written");
  if (add() && Execute(database, "COMMIT")) return {};
  Failure failure = Wrong("cannot be written");
  Execute(database, "ROLLBACK");
  return failure;
}

bool Store::AddReadings(const Night& night, const std::vector<Reading>& readings) {
  sqlite3* database = database_.get();
  Statement find(database, "SELECT id FROM night WHERE time = ? AND commit_id = ? AND machine = ?");
  if (!find.Text(1, night.time).Text(2, night.commit).Text(3, night.machine).Step()) return false;
  const std::int64_t id = find.IntegerAt(0);
  Statement add(database, "INSERT OR REPLACE INTO reading VALUES (?, ?, ?, ?, ?, ?, ?)");
  for (const Reading& reading : readings) {
    add.Integer(1, id).Text(2, reading.series).Number(3, reading.value).Text(4, reading.unit);
    add.Integer(5, reading.scatters).Integer(6, static_cast<int>(reading.sense)).Number(7, reading.relevant);
    if (!add.Run()) return false;
  }
  return true;
}

Status Store::Add(const Night& night, const std::vector<Reading>& readings) {
  return Transact([&] {
    Statement add(database_.get(), "INSERT OR IGNORE INTO night (time, commit_id, machine) VALUES (?, ?, ?)");
    return add.Text(1, night.time).Text(2, night.commit).Text(3, night.machine).Run() && AddReadings(night, readings);
  });
}

Result<Night> Store::AddNight(Night night, const std::vector<Reading>& readings) {
  const Status failed = Transact([&] {
    sqlite3* database = database_.get();
    for (;;) {
      Statement add(database, "INSERT OR IGNORE INTO night (time, commit_id, machine) VALUES (?, ?, ?)");
      if (!add.Text(1, night.time).Text(2, night.commit).Text(3, night.machine).Run()) return false;
      if (sqlite3_changes(database) > 0) return AddReadings(night, readings);
      night.time = NextSecond(night.time);
    }
  });
  if (failed) return *failed;
  return night;
}

Result<History> Store::Read(const std::string& machine) const {
  sqlite3* database = database_.get();
  // Nights and readings of one moment, whoever adds to them meanwhile.
  if (!Execute(database, "BEGIN")) return Wrong("cannot be read");
  Result<History> history = ReadNow(machine);
  Execute(database, "ROLLBACK");
  return history;
}

Result<History> Store::ReadNow(const std::string& machine) const {
  sqlite3* database = database_.get();
  std::string wanted = machine;
  if (wanted.empty()) {
    Statement newest(database, "SELECT machine FROM night ORDER BY time DESC, id DESC LIMIT 1");
    if (newest.Step()) wanted = newest.TextAt(0);
  }
  History history;
  std::map<std::int64_t, std::size_t> place;
  Statement nights(database, "SELECT id, time, commit_id FROM night WHERE machine = ? ORDER BY time, id");
  nights.Text(1, wanted);
  while (nights.Step()) {
    place[nights.IntegerAt(0)] = history.nights.size();
    history.nights.push_back({nights.TextAt(1), nights.TextAt(2), wanted});
  }
  if (!nights.good()) return Wrong("cannot be read");
  Statement rows(database,
                 "SELECT series, night.id, value, unit, scatters, sense, relevant FROM reading JOIN night ON night = "
                 "night.id WHERE machine = ? ORDER BY series, time, night.id");
  rows.Text(1, wanted);
  SeriesRows gathered;
  std::string last;
  while (rows.Step()) {
    const std::string name = rows.TextAt(0);
    const std::size_t night = place.at(rows.IntegerAt(1));
    static constexpr const char* kColumns[] = {"value", "", "scatters", "sense", "relevant"};
    for (const int column : {2, 4, 5, 6}) {
      if (rows.IsNumberAt(column) || (column == 2 && rows.NothingAt(column))) continue;
      return Failure{
          .message = fmt::format("\"{}\" stands for the {} of series \"{}\" in the night of {}: a number "
                                 "belongs there; correct the row, or begin a new history",
                                 rows.TextAt(column), kColumns[column - 2], name, history.nights[night].time),
          .signal = file_,
          .exit_code = 2};
    }
    if (name != last) gathered.MoveTo(history.series);
    last = name;
    const bool scatters = rows.IntegerAt(4) != 0;
    std::optional<double> value = rows.NothingAt(2) ? std::nullopt : std::optional(rows.NumberAt(2));
    if (scatters && value && *value <= 0.0) value.reset();  // no time: an earlier version kept those of errors
    gathered.Add({.name = name,
                  .unit = rows.TextAt(3),
                  .scatters = scatters,
                  .sense = static_cast<Sense>(rows.IntegerAt(5)),
                  .relevant = rows.NumberAt(6)},
                 night, value);
  }
  gathered.MoveTo(history.series);
  if (!rows.good()) return Wrong("cannot be read");
  return history;
}

}  // namespace dynoproof::history
