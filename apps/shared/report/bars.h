// SPDX-License-Identifier: Apache-2.0
// Bars one below the other as a drawing (SVG 1.1): parts of a whole, or how far values reach from a middle.
#pragma once

#include <string>
#include <vector>

namespace ibr::app {

struct BarPart {
  std::string name;  // parts of one name have one colour
  double value;      // not finite or below 0: none
};

struct StackedBar {
  std::string name;
  std::vector<BarPart> parts;
};

/// Each bar's parts side by side, with their sum; names of all parts in a legend. `unit` follows the sums.
std::string stackedSvg(const std::string& title, const std::vector<StackedBar>& bars, const std::string& unit);

/// What one knob does: a value, and a mark on each of the columns.
struct TornadoMark {
  std::string value;
  std::vector<double> at;  // one a column; not finite: none
};

struct TornadoRow {
  std::string name;
  std::vector<TornadoMark> marks;
};

struct TornadoColumn {
  std::string title;
  double middle;             // where the bars start
  bool logarithmic = false;  // values and middle are positive
};

/// Rows from the one that reaches furthest in the first column; a bar from the least to the largest mark, the marks on
/// it with their values.
std::string tornadoSvg(const std::string& title, const std::vector<TornadoColumn>& columns,
                       std::vector<TornadoRow> rows);

}  // namespace ibr::app
