// What the program answers: messages on stderr, and the one document of --json. The document is written when the
// command has ended, so that its `exit` and `diagnostics` are right whatever happened.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "base/diagnostics.h"

namespace dynoproof::app {

/// Says what went wrong; it is also one of the document's diagnostics.
void Complain(const std::string& text);
/// The same for what a reader should know although nothing is wrong.
void Note(const std::string& text);
/// All diagnostics to stderr, and into the document; kUsage when there are errors, else kGood.
int Report(const Diagnostics& diagnostics);

/// One diagnostic as the documents have it.
nlohmann::json AsJson(const Diagnostic& diagnostic);
/// Keeps a command's result for the document; a command that keeps none leaves exit and diagnostics alone in it.
void KeepJson(nlohmann::json document);

/// Where --json asks for the document, empty where it does not. Read from the words themselves: an error of usage ends
/// the program before any command has its options.
std::string JsonFile(int argc, const char* const* argv);
/// Writes the document there ("-": stdout) with the exit code, and returns that, or a worse one when writing fails.
int FinishJson(const std::string& file, int exit);

}  // namespace dynoproof::app
