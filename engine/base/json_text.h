// The one way to write JSON.
#pragma once

#include <string>

namespace dynoproof {

/// A document as text, in one line or with `indent` spaces a level. Bytes that are no UTF-8 become U+FFFD: names of files
/// and labels are whatever their owner made them, and must not keep the document from him by an exception.
template <class Json>
std::string JsonText(const Json& document, int indent = -1) {
  return document.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace dynoproof
