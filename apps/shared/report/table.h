// SPDX-License-Identifier: Apache-2.0
// Columns for people, and numbers that may be missing.
#pragma once

#include <string>
#include <vector>

namespace ibr::app {

/// The first column is set flush left, the others flush right; the first row is the heading.
class Table {
 public:
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// "–" where the value is NaN.
std::string numberText(double value, int decimals);

/// 1536 → "1.5 KiB"
std::string bytesText(double bytes);

}  // namespace ibr::app
