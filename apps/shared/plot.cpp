// SPDX-License-Identifier: Apache-2.0
#include "shared/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "shared/plot_axis.h"
#include "shared/rank.h"
#include "shared/svg_text.h"

namespace ibr::app {
namespace {

// All lengths in px of the drawing.
constexpr double kWidth = 380, kHeight = 330;  // of a panel's field
constexpr double kLeft = 88, kRight = 24, kTop = 92, kBottom = 50;
constexpr double kLine = 18, kLetter = 5.6, kNoteLetter = 7, kLabelHeight = 11, kMarker = 5, kRing = 9;

// Okabe & Ito, "Color universal design", 2008; without yellow, which is lost on white.
constexpr std::array kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

const char* colourOf(std::size_t series) {
  return kColours[series % kColours.size()];
}

// Around the origin.
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
  Panel(const PlotPanel& panel, double left) : panel_(panel), field_{{left, kTop}, {left + kWidth, kTop + kHeight}} {
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
    y_ = axisOver(y, false);
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
    return std::isfinite(point.x) && std::isfinite(point.y) && (!panel_.logarithmicX || point.x > 0);
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
                        low.x, low.y, kWidth, kHeight);
    out_ += text({(low.x + high.x) / 2, high.y + 36}, panel_.xName, "text-anchor=\"middle\"");
    const glm::dvec2 side(low.x - 68, (low.y + high.y) / 2);
    out_ += text(side, panel_.yName,
                 fmt::format("text-anchor=\"middle\" transform=\"rotate(-90 {:.1f} {:.1f})\"", side.x, side.y));
  }

  void drawLevel(const PlotLevel& level) {
    if (!std::isfinite(level.y)) return;
    const glm::dvec2 left = at(x_.low, level.y);
    out_ +=
        fmt::format("<path class=\"level\" d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#606870\" stroke-dasharray=\"5 4\"/>\n",
                    left.x, left.y, field_.high.x);
    const bool above = left.y - 2 * kLabelHeight > field_.low.y;
    const glm::dvec2 low(left.x + 6, above ? left.y - 4 - kLabelHeight : left.y + 4);
    taken_.push_back({low, low + glm::dvec2(kLetter * double(lettersOf(level.name)), kLabelHeight)});
    out_ += text({low.x, low.y + kLabelHeight - 2}, level.name, "font-size=\"10\" fill=\"#606870\"");
  }

  void drawFront(const std::vector<PlotPoint>& of, const char* colour) {
    std::vector<glm::dvec2> points;
    for (const PlotPoint& point : of)
      points.emplace_back(drawn(point) ? point.x : std::nan(""), panel_.lessIsBetter ? -point.y : point.y);
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
      out_ +=
          fmt::format("<path class=\"interval\" d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"{}\" stroke-opacity=\".45\"/>\n",
                      at(point.low, point.y).x, p.y, at(point.high, point.y).x, colourOf(s));
    out_ += marker(s, p, fmt::format("{} {}: {:.4g}, {:.4g}", name, point.label, point.x, point.y), point.size);
    if (point.usual) out_ += ring(p);
    const double reach = point.usual ? kRing : kMarker * point.size;
    taken_.push_back({p - reach, p + reach});
  }

  // On the first side that is free; a label for which there is no room is left out.
  void drawLabel(std::size_t s, const PlotPoint& point) {
    if (point.label.empty() || !point.labelled) return;
    const glm::dvec2 p = at(point.x, point.y), size(kLetter * double(lettersOf(point.label)), kLabelHeight);
    const double gap = point.usual ? 11 : kMarker + 2;
    for (const glm::dvec2 low : {glm::dvec2(p.x + gap, p.y - size.y / 2),
                                 {p.x - gap - size.x, p.y - size.y / 2},
                                 {p.x - size.x / 2, p.y - gap - size.y},
                                 {p.x - size.x / 2, p.y + gap}}) {
      const Box box{low, low + size};
      if (low.x < field_.low.x || low.y < field_.low.y || box.high.x > field_.high.x || box.high.y > field_.high.y ||
          std::ranges::any_of(taken_, [&](const Box& other) { return box.meets(other); }))
        continue;
      taken_.push_back(box);
      out_ += text({low.x, low.y + size.y - 2}, point.label,
                   fmt::format("class=\"label\" font-size=\"10\" fill=\"{}\"", colourOf(s)));
      return;
    }
  }

  const PlotPanel& panel_;
  Box field_;
  PlotAxis x_, y_;
  std::vector<Box> taken_;
  std::string out_;
};

// `end`: where it ends, px.
std::string legend(const std::vector<PlotPanel>& panels, const PlotWords& words, double& end) {
  std::string out;
  glm::dvec2 at(kLeft, 52);
  const auto entry = [&](const std::string& mark, const std::string& name) {
    out += mark + text(at + glm::dvec2(14, 4), name);
    at.x += 40 + 7 * double(lettersOf(name));
  };
  if (panels.empty()) return out;
  for (std::size_t s = 0; s < panels[0].series.size(); ++s)
    entry(marker(s, at, panels[0].series[s].name), panels[0].series[s].name);
  if (!words.usual.empty()) entry(ring(at), words.usual);
  if (!words.joined.empty())
    entry(fmt::format("<path d=\"M{:.1f} {:.1f}h18\" stroke=\"#202830\" stroke-opacity=\".6\"/>\n", at.x - 9, at.y),
          words.joined);
  end = at.x;
  return out;
}

}  // namespace

std::string plotSvg(const std::string& title, const std::vector<PlotPanel>& panels,
                    const std::vector<std::string>& notes, const PlotWords& words) {
  double width = std::max<double>(1, double(panels.size())) * (kLeft + kWidth + kRight), end = 0;
  const std::string entries = legend(panels, words, end);
  width = std::max(width, end);
  std::vector<std::string> lines;
  for (const std::string& note : notes)
    for (const std::string& line : wrapped(note, std::size_t((width - kLeft - kRight) / kNoteLetter)))
      lines.push_back(line);
  const double below = kTop + kHeight + kBottom;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"12\" fill=\"#202830\">\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"#ffffff\"/>\n",
      width, below + kLine * double(lines.size()) + 12);
  out += text({kLeft, 28}, title, "font-size=\"16\" font-weight=\"bold\"");
  out += entries;
  for (std::size_t p = 0; p < panels.size(); ++p)
    out += "<g>\n" + Panel(panels[p], kLeft + double(p) * (kLeft + kWidth + kRight)).drawing() + "</g>\n";
  for (std::size_t n = 0; n < lines.size(); ++n) out += text({kLeft, below + kLine * double(n) + 8}, lines[n]);
  return out + "</svg>\n";
}

}  // namespace ibr::app
