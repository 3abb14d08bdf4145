// Small helpers for messages that a person reads.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace dynoproof {

/// The candidate that `word` was most likely meant to be: smallest edit distance, at most a third of its length
/// (at least 2); upper and lower case count as nearly equal. Nothing when none is near.
std::optional<std::string> Closest(std::string_view word, std::span<const std::string> candidates);

/// "1 gap", "3 gaps".
std::string Counted(std::size_t count, const char* noun);

/// Reads a whole text file; nothing when it cannot be read.
std::optional<std::string> ReadTextFile(const std::string& path);

/// A word as a shell takes it: in quotes where it needs them.
std::string ShellQuoted(const std::string& word);

/// The lower-case hexadecimal FNV-1a hash of the bytes, 16 digits: tells texts apart, protects nothing.
std::string Fingerprint(std::string_view bytes);

}  // namespace dynoproof
