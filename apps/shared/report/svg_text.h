// SPDX-License-Identifier: Apache-2.0
// Texts inside drawings (SVG).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ibr::app {

/// For the content and the attributes (in double quotes) of an element; control characters become '?'.
std::string escapedXml(const std::string& text);

/// Letters, not bytes, of UTF-8.
std::size_t lettersOf(const std::string& text);

/// At spaces, into lines of at most so many letters; longer words stand alone. At least one line.
std::vector<std::string> wrapped(const std::string& text, std::size_t letters);

}  // namespace ibr::app
