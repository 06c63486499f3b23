// SPDX-License-Identifier: Apache-2.0
// Text tables, and formatting of numbers that may be missing.
#pragma once

#include <string>
#include <vector>

namespace ibr::app {

/// The first column is left-aligned, the others right-aligned; the first row is the heading.
class Table {
 public:
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// Returns "–" if the value is NaN.
std::string numberText(double value, int decimals);

/// Formats bytes: 1536 → "1.5 KiB".
std::string bytesText(double bytes);

}  // namespace ibr::app
