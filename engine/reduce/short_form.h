// A scenario on as few lines as a reader takes in: a table that fits on a line stands on one.
#pragma once

#include <cstddef>
#include <string>

#include "model/value.h"

namespace dynoproof::reduce {

/// TOML that reads back as an equal tree but for the order of its entries: tables and lists of up to 130 characters on the line of
/// their key.
std::string ShortForm(const Value& root);

/// Lines that hold something.
std::size_t LinesOf(const std::string& toml);

/// Numbers, texts and truths below a value: what a reader has to know, however it is written.
std::size_t ValuesOf(const Value& value);

}  // namespace dynoproof::reduce
