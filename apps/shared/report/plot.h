// SPDX-License-Identifier: Apache-2.0
// Scatter plots side by side as one drawing (SVG 1.1), for figures that people read.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace ibr::app {

struct PlotPoint {
  double x = 0, y = 0;           // not finite: not drawn; nor is <= 0 on a logarithmic axis
  std::string label;             // written beside it where there is room, the usual ones' further off too
  bool usual = false;            // the setting that all others are compared with: ringed
  double low = NAN, high = NAN;  // of x: an interval around it, drawn where both are finite
  bool labelled = true;          // false: its label is told, but not written
  double size = 1;               // of its marker, in usual ones
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
};

/// A value of y that stands for all x: a dashed line. Not finite: none.
struct PlotLevel {
  std::string name;
  double y;
};

struct PlotPanel {
  std::string title, xName, yName;
  bool logarithmicX = false, logarithmicY = false;
  bool joinFront = false;     // of each series the points that no other one beats: less of x, more of y
  bool joinAll = false;       // the same of all series together
  bool lessIsBetter = false;  // of y, for what is joined
  std::vector<PlotSeries> series;
  std::vector<PlotLevel> levels;
  double width = 380;  // of its field, px
};

/// Words of the legend.
struct PlotWords {
  std::string usual = "default";
  std::string joined = "joined: none of its method is both faster and better";
  std::vector<std::pair<double, std::string>> sizes;  // of markers, and what they mean
  std::string interval;                               // what a bar through a marker means; empty: not told
};

/// Panels in a row under `title`, with a legend of the first panel's series, and lines of text below. A series has the
/// same colour (safe for colour-blind eyes) and marker in all panels, by its place; there are six of each. Valid XML
/// whatever the texts are; of any panels, empty ones too.
std::string plotSvg(const std::string& title, const std::vector<PlotPanel>& panels,
                    const std::vector<std::string>& notes, const PlotWords& words = {});

}  // namespace ibr::app
