// The nightly record: an SQLite file with one record a night, machine class and commit, and its readings.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "history/reading.h"

struct sqlite3;

namespace dynoproof::history {

/// When and where readings were taken.
struct Night {
  std::string time;     // ISO 8601, UTC: "2026-01-31T02:00:00Z"
  std::string commit;   // of the program
  std::string machine;  // class of machine: only like machines are compared
};

/// One figure over the nights of one machine class, oldest first.
struct Series {
  std::string name, unit = {};
  bool scatters = false;
  Sense sense = Sense::kNeither;
  double relevant = 0.0;                 // of its newest reading
  std::vector<std::size_t> nights = {};  // places among History::nights
  std::vector<std::optional<double>> values = {};
};

struct History {
  std::vector<Night> nights;
  std::vector<Series> series;  // by name
};

class Store {
 public:
  /// Opens the file, making it when `create`. Fails (exit code 2: it is missing, or no history; 3: cannot be written).
  static Result<Store> Open(const std::string& file, bool create);

  /// Adds readings to a night, all or none; a reading that the night has already is replaced. Nights of one time,
  /// commit and machine are one.
  Status Add(const Night& night, const std::vector<Reading>& readings);
  /// Adds them as a night of their own: at its time, or at the first second after it that no night of this commit and
  /// machine has. @return the night.
  Result<Night> AddNight(Night night, const std::vector<Reading>& readings);
  /// Everything of a machine class; of the newest night's class where `machine` is empty. Values are in the unit of the
  /// newest; a unit of another quantity is another series, named with it. Fails (exit code 2) on a cell that is no
  /// number where one belongs.
  Result<History> Read(const std::string& machine) const;

 private:
  Result<History> ReadNow(const std::string& machine) const;
  struct Closer {
    void operator()(sqlite3* database) const;
  };
  Store() = default;
  Failure Wrong(const std::string& what, int exit_code = 3) const;
  /// Within a transaction: adds what `add` adds, all or none.
  Status Transact(const std::function<bool()>& add);
  bool AddReadings(const Night& night, const std::vector<Reading>& readings);

  std::unique_ptr<sqlite3, Closer> database_;
  std::string file_;
};

}  // namespace dynoproof::history
