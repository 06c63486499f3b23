// SPDX-License-Identifier: Apache-2.0
// Text in SVG drawings.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ibr::app {

/// Escapes text for the content and the double-quoted attributes of an element; control characters become '?'.
std::string escapedXml(const std::string& text);

/// Returns the number of characters, not bytes, of a UTF-8 text.
std::size_t characterCount(const std::string& text);

/// Wraps at spaces into lines of at most `characters` characters; longer words get their own line. Never empty.
std::vector<std::string> wrapped(const std::string& text, std::size_t characters);

}  // namespace ibr::app
