// SPDX-License-Identifier: Apache-2.0
// Suggestions for misspelt commands and options.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace ibr::app {

/// Returns the name with the fewest typing errors (a letter changed, added, missing, or swapped with the next): at most
/// two, and one for every three letters of the word. Returns nullopt if there is none, or if the word is a name.
std::optional<std::string> nearName(std::string_view word, std::span<const std::string> names);

/// Returns the fault of the first argument that is a misspelt option of the command; nullopt if there is none.
std::optional<std::string> misspeltOption(const CLI::App& command, std::span<const char* const> arguments);

}  // namespace ibr::app
