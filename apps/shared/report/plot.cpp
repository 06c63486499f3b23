// SPDX-License-Identifier: Apache-2.0
#include "shared/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>

#include "shared/report/plot_axis.h"
#include "shared/report/rank.h"
#include "shared/report/svg_text.h"

namespace ibr::app {
namespace {

// Lengths in px of the drawing.
constexpr double kHeight = 330;  // of a panel's plot area
constexpr double kLeft = 88, kRight = 24, kTop = 92, kBottom = 50;
constexpr double kLine = 18, kCharacterWidth = 5.6, kNoteCharacterWidth = 7, kLabelHeight = 11, kMarker = 5, kRing = 9;

// Okabe & Ito, "Color universal design", 2008; without yellow, which is invisible on white.
constexpr std::array kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

const char* colourOf(std::size_t series) {
  return kColours[series % kColours.size()];
}

// SVG path of a marker, centred on the origin.
const char* markerOf(std::size_t series) {
  constexpr std::array kMarkers{"M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0z",
                                "M-4.5-4.5h9v9h-9z",
                                "M0-6L5.6 4.4h-11.2z",
                                "M0-6.4L6.4 0L0 6.4L-6.4 0z",
                                "M0 6L5.6-4.4h-11.2z",
                                "M-5.5-1.8h3.7v-3.7h3.6v3.7h3.7v3.6h-3.7v3.7h-3.6v-3.7h-3.7z"};
  return kMarkers[series % kMarkers.size()];
}

std::string text(glm::dvec2 at, const std::string& words, const std::string& style = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}{}>{}</text>\n", at.x, at.y, style.empty() ? "" : " ", style,
                     escapedXml(words));
}

std::string marker(std::size_t series, glm::dvec2 at, const std::string& title, double size = 1) {
  const std::string scale = size == 1 ? "" : fmt::format(" scale({:.2f})", size);
  return fmt::format(
      "<path class=\"s{}\" transform=\"translate({:.1f} {:.1f}){}\" d=\"{}\" fill=\"{}\" fill-opacity=\".75\" "
      "stroke=\"#fff\" stroke-width=\".8\"><title>{}</title></path>\n",
      series, at.x, at.y, scale, markerOf(series), colourOf(series), escapedXml(title));
}

std::string ring(glm::dvec2 at) {
  return fmt::format(
      "<circle class=\"usual\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"none\" stroke=\"#202830\" "
      "stroke-width=\"1.6\"/>\n",
      at.x, at.y, kRing);
}

struct Box {
  glm::dvec2 low, high;
  bool meets(const Box& other) const {
    return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
  }
};

class Panel {
 public:
  Panel(const PlotPanel& panel, glm::dvec2 at) : panel_(panel), field_{at, at + glm::dvec2(panel.width, kHeight)} {
    std::vector<double> x, y;
    for (const PlotSeries& series : panel.series)
      for (const PlotPoint& point : series.points) {
        if (!drawn(point)) continue;
        x.push_back(point.x);
        y.push_back(point.y);
        if (hasInterval(point)) x.insert(x.end(), {point.low, point.high});
      }
    for (const PlotLevel& level : panel.levels) y.push_back(level.y);
    x_ = axisOver(x, panel.logarithmicX);
    y_ = axisOver(y, panel.logarithmicY);
  }

  std::string drawing() {
    drawAxes();
    for (const PlotLevel& level : panel_.levels) drawLevel(level);
    for (std::size_t s = 0; s < panel_.series.size() && panel_.joinFront; ++s)
      drawFront(panel_.series[s].points, colourOf(s));
    if (panel_.joinAll) {
      std::vector<PlotPoint> all;
      for (const PlotSeries& series : panel_.series) all.insert(all.end(), series.points.begin(), series.points.end());
      drawFront(all, "#202830");
    }
    for (std::size_t s = 0; s < panel_.series.size(); ++s)
      for (const PlotPoint& point : panel_.series[s].points)
        if (drawn(point)) drawPoint(s, point);
    for (const bool usual : {true, false})
      for (std::size_t s = 0; s < panel_.series.size(); ++s)
        for (const PlotPoint& point : panel_.series[s].points)
          if (point.usual == usual && drawn(point)) drawLabel(s, point);
    return out_;
  }

 private:
  bool drawn(const PlotPoint& point) const {
    return std::isfinite(point.x) && std::isfinite(point.y) && (!panel_.logarithmicX || point.x > 0) &&
           (!panel_.logarithmicY || point.y > 0);
  }

  bool hasInterval(const PlotPoint& point) const {
    return std::isfinite(point.low) && std::isfinite(point.high) && (!panel_.logarithmicX || point.low > 0);
  }

  glm::dvec2 at(double x, double y) const {
    return {glm::mix(field_.low.x, field_.high.x, x_.share(x)), glm::mix(field_.high.y, field_.low.y, y_.share(y))};
  }

  void drawAxes() {
    const auto [low, high] = field_;
    out_ += text({low.x, low.y - 12}, panel_.title, "font-weight=\"bold\" font-size=\"13\"");
    std::string grid;
    for (std::size_t i = 0; i < x_.ticks.size(); ++i) {
      const double x = at(x_.ticks[i], y_.low).x;
      grid += fmt::format("M{:.1f} {:.1f}V{:.1f}", x, high.y, low.y);
      out_ += text({x, high.y + 16}, x_.labels[i], "text-anchor=\"middle\" class=\"tick\"");
    }
    for (std::size_t i = 0; i < y_.ticks.size(); ++i) {
      const double y = at(x_.low, y_.ticks[i]).y;
      grid += fmt::format("M{:.1f} {:.1f}H{:.1f}", low.x, y, high.x);
      out_ += text({low.x - 6, y + 4}, y_.labels[i], "text-anchor=\"end\" class=\"tick\"");
    }
    out_ += fmt::format("<path d=\"{}\" stroke=\"#e2e6ea\"/>\n", grid);
    out_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#8a949e\"/>\n",
                        low.x, low.y, panel_.width, kHeight);
    out_ += text({(low.x + high.x) / 2, high.y + 36}, panel_.xName, "text-anchor=\"middle\"");
    const glm::dvec2 side(low.x - 68, (low.y + high.y) / 2);
    out_ += text(side, panel_.yName,
                 fmt::format("text-anchor=\"middle\" transform=\"rotate(-90 {:.1f} {:.1f})\"", side.x, side.y));
  }

  void drawLevel(const PlotLevel& level) {
    if (!std::isfinite(level.y) || (panel_.logarithmicY && level.y <= 0)) return;
    const glm::dvec2 left = at(x_.low, level.y);
    out_ +=
        fmt::format("<path class=\"level\" d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#606870\" stroke-dasharray=\"5 4\"/>\n",
                    left.x, left.y, field_.high.x);
    const bool above = left.y - 2 * kLabelHeight > field_.low.y;
    const glm::dvec2 low(left.x + 6, above ? left.y - 4 - kLabelHeight : left.y + 4);
    taken_.push_back({low, low + glm::dvec2(kCharacterWidth * double(characterCount(level.name)), kLabelHeight)});
    out_ += text({low.x, low.y + kLabelHeight - 2}, level.name, "font-size=\"10\" fill=\"#606870\"");
  }

  void drawFront(const std::vector<PlotPoint>& of, const char* colour) {
    std::vector<glm::dvec2> points;
    for (const PlotPoint& point : of)
      points.emplace_back(drawn(point) ? point.x : std::nan(""), panel_.lowerIsBetter ? -point.y : point.y);
    std::string path;
    for (const std::size_t i : paretoFront(points)) {
      const glm::dvec2 p = at(of[i].x, of[i].y);
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", p.x, p.y);
    }
    if (path.empty()) return;
    out_ += fmt::format("<path class=\"front\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-opacity=\".6\"/>\n", path,
                        colour);
  }

  void drawPoint(std::size_t s, const PlotPoint& point) {
    const glm::dvec2 p = at(point.x, point.y);
    const std::string name = panel_.series[s].name;
    if (hasInterval(point))
      out_ += fmt::format("<path class=\"interval\" d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"{}\" stroke-width=\"1.6\"/>\n",
                          at(point.low, point.y).x, p.y, at(point.high, point.y).x, colourOf(s));
    out_ += marker(s, p, fmt::format("{} {}: {:.4g}, {:.4g}", name, point.label, point.x, point.y), point.size);
    if (point.usual) out_ += ring(p);
    const double reach = point.usual ? kRing : kMarker * point.size;
    taken_.push_back({p - reach, p + reach});
  }

  // Reserves a box inside the field; returns false if the box meets a reserved one.
  bool take(const Box& box) {
    if (box.low.x < field_.low.x || box.low.y < field_.low.y || box.high.x > field_.high.x ||
        box.high.y > field_.high.y || std::ranges::any_of(taken_, [&](const Box& other) { return box.meets(other); }))
      return false;
    taken_.push_back(box);
    return true;
  }

  // Places the label on the first free side of its marker. Without room the label is left out; a usual point's label
  // is placed farther away, with a line to its marker.
  void drawLabel(std::size_t s, const PlotPoint& point) {
    if (point.label.empty() || !point.labelled) return;
    const double characters = double(characterCount(point.label)) + (point.usual ? 1 : 0);
    const glm::dvec2 p = at(point.x, point.y),
                     size((point.usual ? 1.1 : 1) * kCharacterWidth * characters, kLabelHeight);
    const auto write = [&](glm::dvec2 low) {
      out_ += text({low.x, low.y + size.y - 2}, point.label,
                   fmt::format("class=\"label\" font-size=\"{}\" fill=\"{}\"", point.usual ? 11 : 10, colourOf(s)));
    };
    const double gap = point.usual ? 11 : kMarker + 2;
    for (const glm::dvec2 low : {glm::dvec2(p.x + gap, p.y - size.y / 2),
                                 {p.x - gap - size.x, p.y - size.y / 2},
                                 {p.x - size.x / 2, p.y - gap - size.y},
                                 {p.x - size.x / 2, p.y + gap}})
      if (take({low, low + size})) return write(low);
    for (double distance = 24; point.usual && distance < 160; distance += 8)
      for (int direction = 0; direction < 16; ++direction) {
        const double angle = direction * glm::two_pi<double>() / 16;
        const glm::dvec2 towards(std::cos(angle), std::sin(angle));
        const glm::dvec2 middle = p + towards * (distance + 0.5 * size.x * std::abs(towards.x));
        if (!take({middle - 0.5 * size, middle + 0.5 * size})) continue;
        const glm::dvec2 from = p + towards * kRing, to = p + towards * (distance - kLabelHeight / 2);
        out_ += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#606870\" stroke-width=\".8\"/>\n",
                            from.x, from.y, to.x, to.y);
        return write(middle - 0.5 * size);
      }
  }

  const PlotPanel& panel_;
  Box field_;
  PlotAxis x_, y_;
  std::vector<Box> taken_;
  std::string out_;
};

// Lays out the legend in rows of at most `width`; sets `rows` to their number.
std::string legend(const std::vector<PlotPanel>& panels, const PlotWords& words, double width, int& rows) {
  std::string out;
  glm::dvec2 at(kLeft, 52);
  rows = 1;
  // `mark`: SVG element centred on the origin.
  const auto entry = [&](const std::string& mark, const std::string& name) {
    const double length = 26 + 6.6 * double(characterCount(name));
    if (at.x > kLeft && at.x + length > width) {
      at = {kLeft, at.y + kLine};
      ++rows;
    }
    out += fmt::format("<g transform=\"translate({:.1f} {:.1f})\">\n{}{}</g>\n", at.x, at.y, mark, text({14, 4}, name));
    at.x += length;
  };
  if (panels.empty()) return out;
  for (std::size_t s = 0; s < panels[0].series.size(); ++s)
    entry(marker(s, {0, 0}, panels[0].series[s].name), panels[0].series[s].name);
  for (const auto& [size, name] : words.sizes)
    entry(fmt::format("<circle r=\"{:.1f}\" fill=\"none\" stroke=\"#606870\"/>\n", kMarker * size), name);
  if (!words.interval.empty())
    entry("<path d=\"M-9 0h18\" stroke=\"#606870\" stroke-width=\"1.6\"/>\n", words.interval);
  if (!words.usual.empty()) entry(ring({0, 0}), words.usual);
  if (!words.joined.empty()) entry("<path d=\"M-9 4L9-4\" stroke=\"#202830\" stroke-opacity=\".6\"/>\n", words.joined);
  return out;
}

}  // namespace

std::string plotSvg(const std::string& title, const std::vector<PlotPanel>& panels,
                    const std::vector<std::string>& notes, const PlotWords& words) {
  double width = panels.empty() ? kLeft + kRight : 0;
  for (const PlotPanel& panel : panels) width += kLeft + panel.width + kRight;
  int rows = 1;
  const std::string entries = legend(panels, words, width, rows);
  const double top = kTop + kLine * (rows - 1);
  std::vector<std::string> lines;
  for (const std::string& note : notes)
    for (const std::string& line : wrapped(note, std::size_t((width - kLeft - kRight) / kNoteCharacterWidth)))
      lines.push_back(line);
  const double below = top + kHeight + kBottom;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"12\" fill=\"#202830\">\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"#ffffff\"/>\n",
      width, below + kLine * double(lines.size()) + 12);
  out += text({kLeft, 28}, title, "font-size=\"16\" font-weight=\"bold\"");
  out += entries;
  double left = kLeft;
  for (const PlotPanel& panel : panels) {
    out += "<g>\n" + Panel(panel, {left, top}).drawing() + "</g>\n";
    left += panel.width + kRight + kLeft;
  }
  for (std::size_t n = 0; n < lines.size(); ++n) out += text({kLeft, below + kLine * double(n) + 8}, lines[n]);
  return out + "</svg>\n";
}

}  // namespace ibr::app
