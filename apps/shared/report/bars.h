// SPDX-License-Identifier: Apache-2.0
// Bar charts as SVG 1.1: stacked bars for parts of a whole, tornado charts for the range of values around a middle.
#pragma once

#include <string>
#include <vector>

namespace ibr::app {

struct BarPart {
  std::string name;  // parts of the same name have the same colour
  double value;      // not finite or below 0: not drawn
};

struct StackedBar {
  std::string name;
  std::vector<BarPart> parts;
};

/// Draws each bar's parts side by side, with their sum followed by `unit`, and a legend of all parts.
std::string stackedSvg(const std::string& title, const std::vector<StackedBar>& bars, const std::string& unit);

/// A value of a setting, and its result in each column.
struct TornadoMark {
  std::string value;
  std::vector<double> at;  // one a column; not finite: not drawn
};

struct TornadoRow {
  std::string name;
  std::vector<TornadoMark> marks;
};

struct TornadoColumn {
  std::string title;
  double middle;             // start of the bars
  bool logarithmic = false;  // true: values and middle are positive
};

/// Sorts the rows by their range in the first column, largest first. A bar spans the smallest to the largest mark; its
/// marks carry their values.
std::string tornadoSvg(const std::string& title, const std::vector<TornadoColumn>& columns,
                       std::vector<TornadoRow> rows);

}  // namespace ibr::app
