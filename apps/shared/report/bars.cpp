// SPDX-License-Identifier: Apache-2.0
#include "shared/report/bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/report/plot_axis.h"
#include "shared/report/svg_text.h"

namespace ibr::app {
namespace {

// Lengths in px of the drawing.
constexpr double kNames = 190, kWidth = 460, kRow = 24, kTop = 70, kGap = 40, kCharacterWidth = 5.6, kRight = 110;
// Colours for colour-blind viewers: Okabe & Ito, "Color universal design", 2008.
constexpr std::array kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#606870", "#a0b030"};

std::string text(double x, double y, const std::string& words, const std::string& style = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, style, escapedXml(words));
}

std::string box(double x, double y, double width, double height, const char* colour, const std::string& title,
                double opacity = 1) {
  return fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\" fill-opacity=\"{}\">"
      "<title>{}</title></rect>\n",
      x, y, std::max(width, 0.5), height, colour, opacity, escapedXml(title));
}

std::string drawing(double width, double height, const std::string& title, const std::string& inside) {
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
             "{1:.0f}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#202830\">\n<rect width=\"100%\" "
             "height=\"100%\" fill=\"#ffffff\"/>\n",
             width, height) +
         text(16, 28, title, "font-size=\"16\" font-weight=\"bold\"") + inside + "</svg>\n";
}

bool counts(double value) {
  return std::isfinite(value) && value >= 0;
}

double sumOf(const StackedBar& bar) {
  double sum = 0;
  for (const BarPart& part : bar.parts) sum += counts(part.value) ? part.value : 0;
  return sum;
}

// Interval that covers the row's marks in a column and the middle.
std::pair<double, double> reachOf(const TornadoRow& row, std::size_t column, double middle) {
  std::pair reach{middle, middle};
  for (const TornadoMark& mark : row.marks)
    if (std::isfinite(mark.at[column]))
      reach = {std::min(reach.first, mark.at[column]), std::max(reach.second, mark.at[column])};
  return reach;
}

double extentOf(const TornadoRow& row, const TornadoColumn& column) {
  const auto [low, high] = reachOf(row, 0, column.middle);
  return column.logarithmic ? std::log(high / low) : high - low;
}

std::string tornadoColumn(const TornadoColumn& column, std::size_t c, const std::vector<TornadoRow>& rows,
                          double left) {
  std::vector<double> values{column.middle};
  for (const TornadoRow& row : rows)
    for (const TornadoMark& mark : row.marks)
      if (std::isfinite(mark.at[c])) values.push_back(mark.at[c]);
  const PlotAxis axis = axisOver(values, column.logarithmic);
  const auto at = [&](double value) { return left + kWidth * axis.share(value); };
  const double bottom = kTop + kRow * double(rows.size());
  std::string out = text(left, kTop - 12, column.title, "font-weight=\"bold\"");
  for (std::size_t t = 0; t < axis.ticks.size(); ++t) {
    const double x = at(axis.ticks[t]);
    out += fmt::format("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"#e2e6ea\"/>\n", x, kTop, bottom);
    out += text(x, bottom + 16, axis.labels[t], "text-anchor=\"middle\"");
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double y = kTop + kRow * double(r);
    const auto [low, high] = reachOf(rows[r], c, column.middle);
    out += box(at(low), y + 5, at(high) - at(low), kRow - 10, kColours[5], rows[r].name, 0.5);
    double taken = -1e9;  // end of the last label, px
    std::vector<const TornadoMark*> marks;
    for (const TornadoMark& mark : rows[r].marks)
      if (std::isfinite(mark.at[c])) marks.push_back(&mark);
    std::ranges::stable_sort(marks, {}, [&](const TornadoMark* mark) { return mark->at[c]; });
    for (const TornadoMark* mark : marks) {
      const double x = at(mark->at[c]), width = kCharacterWidth * double(characterCount(mark->value));
      out += box(x - 1, y + 3, 2, kRow - 6, kColours[0], fmt::format("{}: {:.4g}", mark->value, mark->at[c]));
      if (x + 3 < taken || x + 3 + width > left + kWidth + kGap) continue;
      out += text(x + 3, y + 16, mark->value, "font-size=\"10\"");
      taken = x + 3 + width + 3;
    }
  }
  return out +
         fmt::format("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"#202830\"/>\n", at(column.middle), kTop, bottom);
}

}  // namespace

std::string stackedSvg(const std::string& title, const std::vector<StackedBar>& bars, const std::string& unit) {
  std::vector<std::string> names;
  double most = 0;
  for (const StackedBar& bar : bars) {
    most = std::max(most, sumOf(bar));
    for (const BarPart& part : bar.parts)
      if (counts(part.value) && std::ranges::find(names, part.name) == names.end()) names.push_back(part.name);
  }
  const auto colourOf = [&](const std::string& name) {
    return kColours[std::size_t(std::ranges::find(names, name) - names.begin()) % kColours.size()];
  };
  std::string out;
  double x = 16;
  for (const std::string& name : names) {
    out += box(x, kTop - 24, 12, 12, colourOf(name), name) + text(x + 17, kTop - 14, name);
    x += 36 + 7 * double(characterCount(name));
  }
  for (std::size_t b = 0; b < bars.size(); ++b) {
    const double y = kTop + kRow * double(b);
    out += text(kNames - 8, y + 16, bars[b].name, "text-anchor=\"end\"");
    double left = kNames;
    for (const BarPart& part : bars[b].parts) {
      if (!counts(part.value) || most <= 0) continue;
      const double width = kWidth * part.value / most;
      out += box(left, y + 3, width, kRow - 6, colourOf(part.name),
                 fmt::format("{}: {:.4g}{}", part.name, part.value, unit));
      left += width;
    }
    out += text(left + 6, y + 16, fmt::format("{:.3g}{}", sumOf(bars[b]), unit));
  }
  return drawing(std::max(kNames + kWidth + kRight, x), kTop + kRow * double(bars.size()) + 16, title, out);
}

std::string tornadoSvg(const std::string& title, const std::vector<TornadoColumn>& columns,
                       std::vector<TornadoRow> rows) {
  if (!columns.empty())
    std::ranges::stable_sort(rows, std::ranges::greater(),
                             [&](const TornadoRow& row) { return extentOf(row, columns[0]); });
  std::string out;
  for (std::size_t r = 0; r < rows.size(); ++r)
    out += text(kNames - 8, kTop + kRow * double(r) + 16, rows[r].name, "text-anchor=\"end\"");
  for (std::size_t c = 0; c < columns.size(); ++c)
    out += tornadoColumn(columns[c], c, rows, kNames + double(c) * (kWidth + kGap));
  return drawing(kNames + double(columns.size()) * (kWidth + kGap) + 16, kTop + kRow * double(rows.size()) + 36, title,
                 out);
}

}  // namespace ibr::app
