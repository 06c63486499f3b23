// SPDX-License-Identifier: Apache-2.0
// Parses numbers from text, the same in every locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace ibr {

/// Parses all of `text` as a number: no spaces, no trailing characters; a leading '+' is allowed. Returns nullopt
/// otherwise. parseDouble refuses NaN, infinity and values beyond the range of a double.
std::optional<double> parseDouble(std::string_view text);
std::optional<std::int64_t> parseInt(std::string_view text);

}  // namespace ibr
