// Text of strangers made fit to be shown and stored.
#pragma once

#include <string>
#include <string_view>

namespace dynoproof {

bool IsUtf8(std::string_view text);

/// `text` if it is UTF-8, else what it says as Windows-1252 (Latin-1 with signs in the gap), which any bytes are.
std::string ToUtf8(std::string_view text);

/// Control characters and those that turn the direction of writing, written out: a terminal must not obey a file.
/// Those in `kept` stay.
std::string WithoutControls(std::string_view text, std::string_view kept = "");

/// `text` as a message: UTF-8, without controls but ends of lines and tabs. Names in it come from files, and a file must
/// not write what looks like another message.
std::string AsMessage(std::string_view text);

/// `text` in quotes for a message: UTF-8, at most 40 characters, nothing a terminal obeys.
std::string Shown(std::string_view text);

}  // namespace dynoproof
