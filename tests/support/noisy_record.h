// What a logger would have written of a machine that the program simulates: inputs as they are, outputs with noise.
#pragma once

#include <cmath>

#include "base/random.h"
#include "score/series.h"
#include "tests/support/program.h"
#include "trace/csv.h"
#include "trace/trace_io.h"

namespace dynoproof::test {

/// Runs `dynoproof run RUN` with solver `reference`, whatever it says to the checks, and reads its trace `file`; white
/// noise of `noise` of what they swing on the outputs.
inline std::vector<trace::Column> NoisyRecord(const Bench& bench, std::vector<std::string> run, const std::string& file,
                                              const std::vector<std::string>& inputs,
                                              const std::vector<std::string>& outputs, double noise = 0.01,
                                              std::uint64_t seed = 3) {
  run.insert(run.begin(), "run");
  run.insert(run.end(), {"--solver", "reference"});
  const Outcome outcome = bench.Call(run);
  const Result<trace::Trace> trace = trace::ReadTrace(bench / file);
  if (!trace.ok()) throw std::runtime_error(outcome.Both());
  std::vector<trace::Column> columns = {{.name = "t", .unit = "s", .values = trace->time}};
  for (const std::string& name : inputs)
    columns.push_back({.name = name, .unit = "", .values = trace->Find(name)->values});
  std::uint64_t stream = 2;
  for (const std::string& name : outputs) {
    columns.push_back({.name = name, .unit = "", .values = trace->Find(name)->values});
    std::vector<double>& values = columns.back().values;
    const double size = noise * score::StandardDeviation(values);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += size * RandomNormal(seed, stream, i);
    ++stream;
  }
  return columns;
}

}  // namespace dynoproof::test
