// What a fuzz target is: a reader, fed with any bytes as a file, and what must hold of whatever it says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::fuzz {

/// Ends the process with a sentence where `held` is false: a finding.
void Require(bool held, std::string_view what);

/// Writes the bytes as the only such file of this process, in a folder of its own, over those of the last call.
/// `name`: the file's name, whose ending some readers go by.
std::filesystem::path InputFile(std::string_view name, const std::uint8_t* data, std::size_t size);

/// A message can be shown and stored: it is UTF-8, and no terminal obeys a word of it.
void CheckMessage(const std::string& text);
void CheckFailure(const Failure& failure);
/// A file that gave nothing has a fault, with a message that can be shown.
void CheckDiagnostics(const Diagnostics& diagnostics, bool read);

/// Nothing in a record is at odds with the rest of it: stamps are as many as values, each number that is none is told,
/// and the finite ones are.
void CheckRecord(const Result<trace::Record>& record);

}  // namespace dynoproof::fuzz

/// The entry that libFuzzer calls; replay.cc does where there is no libFuzzer.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
