// SPDX-License-Identifier: Apache-2.0
// Numbers from text, the same in every locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace ibr {

/// The whole of `text` as a number: no spaces, no trailing characters; nullopt otherwise. A leading '+' is allowed.
/// parseDouble refuses NaN and infinity, and what does not fit into a double.
std::optional<double> parseDouble(std::string_view text);
std::optional<std::int64_t> parseInt(std::string_view text);

}  // namespace ibr
