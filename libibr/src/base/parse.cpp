// SPDX-License-Identifier: Apache-2.0
#include "base/parse.h"

#include <charconv>
#include <cmath>

namespace ibr {
namespace {

template <class T>
std::optional<T> parseWhole(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> parseDouble(std::string_view text) {
  const auto value = parseWhole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> parseInt(std::string_view text) {
  return parseWhole<std::int64_t>(text);
}

}  // namespace ibr
