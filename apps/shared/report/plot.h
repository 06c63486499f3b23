// SPDX-License-Identifier: Apache-2.0
// Scatter plots side by side in one drawing (SVG 1.1), for figures in reports.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace ibr::app {

struct PlotPoint {
  double x = 0, y = 0;           // not finite, or <= 0 on a logarithmic axis: not drawn
  std::string label;             // drawn beside the marker if there is room; a usual point's label also farther away
  bool usual = false;            // the setting that all others are compared with: ringed
  double low = NAN, high = NAN;  // interval of x, drawn if both are finite
  bool labelled = true;          // false: the label is a tooltip only
  double size = 1;               // factor on the marker's size
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
};

/// Horizontal dashed line at a value of y. Not finite: not drawn.
struct PlotLevel {
  std::string name;
  double y;
};

struct PlotPanel {
  std::string title, xName, yName;
  bool logarithmicX = false, logarithmicY = false;
  bool joinFront = false;      // joins each series' Pareto front: smaller x, larger y
  bool joinAll = false;        // the same for all series together
  bool lowerIsBetter = false;  // inverts y for the front
  std::vector<PlotSeries> series;
  std::vector<PlotLevel> levels;
  double width = 380;  // of the plot area, px
};

/// Texts of the legend.
struct PlotWords {
  std::string usual = "default";
  std::string joined = "line: Pareto front of each method";
  std::vector<std::pair<double, std::string>> sizes;  // sizes of markers, and their meanings
  std::string interval;                               // meaning of a bar through a marker; empty: not shown
};

/// Draws panels in a row under `title`, with a legend of the first panel's series, and lines of text below. A series
/// has the same colour (safe for colour-blind viewers) and marker in all panels, by its index; there are six of each.
/// The XML is valid for any text. Accepts any panels, empty ones too.
std::string plotSvg(const std::string& title, const std::vector<PlotPanel>& panels,
                    const std::vector<std::string>& notes, const PlotWords& words = {});

}  // namespace ibr::app
