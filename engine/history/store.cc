#include "history/store.h"

#include <sqlite3.h>

#include <filesystem>
#include <map>

namespace dynoproof::history {
namespace {

constexpr const char* kSchema = R"(
  CREATE TABLE IF NOT EXISTS night (
    id INTEGER PRIMARY KEY, time TEXT NOT NULL, commit_id TEXT NOT NULL, machine TEXT NOT NULL,
    UNIQUE (time, commit_id, machine));
  CREATE TABLE IF NOT EXISTS reading (
    night INTEGER NOT NULL REFERENCES night, series TEXT NOT NULL, value REAL, unit TEXT NOT NULL,
    scatters INTEGER NOT NULL, sense INTEGER NOT NULL, relevant REAL NOT NULL, PRIMARY KEY (night, series)) WITHOUT ROWID;
  PRAGMA application_id = 1146703952;
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
  bool NothingAt(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }

 private:
  sqlite3_stmt* statement_ = nullptr;
  bool good_ = false;
};

bool Execute(sqlite3* database, const char* sql) {
  return sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK;
}

}  // namespace

void Store::Closer::operator()(sqlite3* database) const { sqlite3_close(database); }

Failure Store::Wrong(const std::string& what, int exit_code) const {
  return {.message = what + ": " + sqlite3_errmsg(database_.get()), .signal = file_, .exit_code = exit_code};
}

Result<Store> Store::Open(const std::string& file, bool create) {
  if (!create && !std::filesystem::exists(file)) {
    return Failure{
        .message = "there is no history here; begin one with `dynoproof history add`", .signal = file, .exit_code = 2};
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
    kind.Step();
    if (!tables.Step()) return store.Wrong("is no history", 2);
    if (tables.IntegerAt(0) > 0 && kind.IntegerAt(0) != 1146703952) {
      return Failure{.message = "is a database of something else", .signal = file, .exit_code = 2};
    }
  }
  if (create && !Execute(database, kSchema)) return store.Wrong("cannot be written");
  return store;
}

Status Store::Add(const Night& night, const std::vector<Reading>& readings) {
  sqlite3* database = database_.get();
  if (!Execute(database, "BEGIN IMMEDIATE")) return Wrong("cannot be written");
  const auto give_up = [&]() -> Status {
    Failure failure = Wrong("cannot be written");
    Execute(database, "ROLLBACK");
    return failure;
  };
  Statement add_night(database, "INSERT OR IGNORE INTO night (time, commit_id, machine) VALUES (?, ?, ?)");
  if (!add_night.Text(1, night.time).Text(2, night.commit).Text(3, night.machine).Run()) return give_up();
  Statement find(database, "SELECT id FROM night WHERE time = ? AND commit_id = ? AND machine = ?");
  if (!find.Text(1, night.time).Text(2, night.commit).Text(3, night.machine).Step()) return give_up();
  const std::int64_t id = find.IntegerAt(0);
  Statement add(database, "INSERT OR REPLACE INTO reading VALUES (?, ?, ?, ?, ?, ?, ?)");
  for (const Reading& reading : readings) {
    add.Integer(1, id).Text(2, reading.series).Number(3, reading.value).Text(4, reading.unit);
    add.Integer(5, reading.scatters).Integer(6, static_cast<int>(reading.sense)).Number(7, reading.relevant);
    if (!add.Run()) return give_up();
  }
  return Execute(database, "COMMIT") ? Status() : give_up();
}

Result<History> Store::Read(const std::string& machine) const {
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
  while (rows.Step()) {
    const std::string name = rows.TextAt(0);
    if (history.series.empty() || history.series.back().name != name) history.series.push_back({.name = name});
    Series& series = history.series.back();
    series.nights.push_back(place.at(rows.IntegerAt(1)));
    series.values.push_back(rows.NothingAt(2) ? std::nullopt : std::optional(rows.NumberAt(2)));
    series.unit = rows.TextAt(3);
    series.scatters = rows.IntegerAt(4) != 0;
    series.sense = static_cast<Sense>(rows.IntegerAt(5));
    series.relevant = rows.NumberAt(6);
  }
  if (!rows.good()) return Wrong("cannot be read");
  return history;
}

}  // namespace dynoproof::history
