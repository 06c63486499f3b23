// SPDX-License-Identifier: Apache-2.0
#include "shared/report/graph_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <vector>

#include "shared/report/graph_view.h"
#include "shared/report/svg_text.h"

namespace ibr::app {
namespace {

// Lengths in px of the drawing.
constexpr double kWidth = 900, kMinHeight = 240, kMaxHeight = 900;
constexpr double kMargin = 60, kLegend = 380, kLine = 16, kScaleBar = 160;
constexpr std::size_t kLegendCharacters = 56;  // of a legend line
constexpr std::size_t kMaxListed = 40, kMaxProblems = 10;
constexpr const char *kAddColour = "#c2410c", *kProblemColour = "#b91c1c";

// The viridis colour map (Smith & van der Walt 2015) without its bright end, which is invisible on white.
std::string colourOf(double share) {
  if (std::isnan(share)) return "#8899aa";
  constexpr std::array<std::array<double, 3>, 4> kStops{{{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}}};
  const double at = std::clamp(share, 0.0, 1.0) * double(kStops.size() - 1);
  const std::size_t low = std::min(std::size_t(at), kStops.size() - 2);
  std::array<int, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = int(std::lround(kStops[low][c] + (at - double(low)) * (kStops[low + 1][c] - kStops[low][c])));
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

class Drawing {
 public:
  Drawing(const Scene& scene, const CaptureAdvice& advice)
      : scene_(scene), advice_(advice), view_(graphView(scene)), used_(scene.nodes.size(), false) {
    for (const Cell& cell : scene.cells) {
      for (const std::uint32_t member : cell.members) used_[member] = true;
      if (cell.quality.score > best_) best_ = cell.quality.score;
    }
    for (const UnusedPhotograph& unused : scene.unusedPhotographs) reason_.emplace(unused.name, unused.reason);
    fit();
  }

  std::string text() {
    for (const Cell& cell : scene_.cells) drawCell(cell);
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n)
      if (!used_[n]) drawCamera(n);
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n)
      if (used_[n]) drawCamera(n);
    for (const Advice& advice : advice_.advice) drawProblem(advice);
    for (std::size_t v = 0; v < advice_.views.size(); ++v) drawNextView(v);
    drawScale();
    const double legend = drawLegend();
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
               "{1:.0f}\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" "
               "fill=\"#ffffff\"/>\n",
               kWidth + kLegend, std::max(height_, legend)) +
           out_ + "</svg>\n";
  }

 private:
  template <class... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    out_ += fmt::format(format, std::forward<Args>(args)...) + '\n';
  }

  void fit() {
    glm::dvec2 low(0.0), high(0.0);
    std::vector<glm::dvec2> positions;
    for (const Node& node : scene_.nodes) {
      positions.push_back(view_.flat(node.camera.pose.position));
      low = glm::min(low, positions.back());
      high = glm::max(high, positions.back());
    }
    for (const NextView& view : advice_.views) {
      low = glm::min(low, view_.flat(view.camera.pose.position));
      high = glm::max(high, view_.flat(view.camera.pose.position));
    }
    const glm::dvec2 size = high - low;
    scale_ = std::min((kWidth - 2 * kMargin) / size.x, (kMaxHeight - 2 * kMargin) / size.y);
    if (!std::isfinite(scale_)) scale_ = 1;
    height_ = std::max(kMinHeight, size.y * scale_ + 2 * kMargin);
    shift_ = glm::dvec2(kWidth, height_) / 2.0 - glm::dvec2(1, -1) * scale_ * (low + high) / 2.0;
    frustum_ = std::clamp(0.35 * spacing(positions) * scale_, 7.0, 34.0);
  }

  // Typical distance in the drawing from a position to the nearest other one, from up to 200 samples.
  static double spacing(const std::vector<glm::dvec2>& positions) {
    constexpr std::size_t kSamples = 200;
    double longest = 0;
    for (const glm::dvec2& p : positions) longest = std::max(longest, glm::length(p));
    std::vector<double> nearest;
    for (std::size_t i = 0; i < positions.size(); i += 1 + positions.size() / kSamples) {
      double least = std::numeric_limits<double>::infinity();
      for (const glm::dvec2& other : positions)  // positions that coincide count once
        if (const double d = glm::distance(positions[i], other); d > 1e-3 * longest) least = std::min(least, d);
      if (std::isfinite(least)) nearest.push_back(least);
    }
    if (nearest.empty()) return std::numeric_limits<double>::infinity();
    std::nth_element(nearest.begin(), nearest.begin() + std::ptrdiff_t(nearest.size() / 2), nearest.end());
    return nearest[nearest.size() / 2];
  }

  glm::dvec2 at(glm::dvec3 point) const { return shift_ + glm::dvec2(1, -1) * scale_ * view_.flat(point); }

  std::string points(const std::vector<glm::dvec2>& list) const {
    std::string text;
    for (const glm::dvec2& p : list) text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", p.x, p.y);
    return text;
  }

  // NaN if the cells have no scores.
  double share(double score) const { return best_ > 0 ? score / best_ : std::numeric_limits<double>::quiet_NaN(); }

  void drawCell(const Cell& cell) {
    std::vector<glm::dvec2> corners;
    std::string names;
    for (const std::uint32_t member : cell.members) {
      corners.push_back(at(scene_.nodes[member].camera.pose.position));
      names += (names.empty() ? "" : ", ") + scene_.nodes[member].name;
    }
    const std::string colour = colourOf(share(cell.quality.score));
    put("<g stroke=\"{0}\" fill=\"{0}\" stroke-linejoin=\"round\"><title>{1}{2}</title>", colour, escapedXml(names),
        std::isnan(cell.quality.score) ? "" : fmt::format(", score {:.3f}", cell.quality.score));
    if (corners.size() == 2) {
      put("<polyline points=\"{}\" stroke-width=\"4\" stroke-opacity=\".55\" fill=\"none\"/>", points(corners));
    } else if (corners.size() == 3) {
      put("<polygon points=\"{}\" fill-opacity=\".3\" stroke-opacity=\".6\" stroke-width=\"1.2\"/>", points(corners));
    } else {
      for (std::size_t left = 0; left < corners.size(); ++left) {
        std::vector<glm::dvec2> face = corners;
        face.erase(face.begin() + std::ptrdiff_t(left));
        put("<polygon points=\"{}\" fill-opacity=\".05\" stroke-opacity=\".35\" stroke-width=\"1\"/>", points(face));
      }
    }
    put("</g>");
  }

  void drawCamera(std::size_t n) {
    const Node& node = scene_.nodes[n];
    std::string title = escapedXml(node.name);
    if (const auto why = reason_.find(node.name); why != reason_.end()) title += ": " + escapedXml(why->second);
    put("<g stroke=\"{0}\" stroke-width=\"{1}\" fill=\"{0}\"><title>{2}</title>", used_[n] ? "#202830" : "#9a9a9a",
        used_[n] ? 1.0 : 1.6, title);
    drawFrustum(node.camera);
    const glm::dvec2 centre = at(node.camera.pose.position);
    put("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.2\" stroke=\"none\"/></g>", centre.x, centre.y);
  }

  void drawNextView(std::size_t v) {
    const NextView& next = advice_.views[v];
    const glm::dvec2 centre = at(next.camera.pose.position);
    put("<g stroke=\"{0}\" fill=\"{0}\"><title>{1}: {2}</title>", kAddColour, v + 1, escapedXml(next.where));
    drawFrustum(next.camera);
    put("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"8\" stroke=\"#ffffff\"/>", centre.x, centre.y);
    put("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" font-size=\"10\" font-weight=\"bold\" "
        "stroke=\"none\" fill=\"#ffffff\">{}</text></g>",
        centre.x, centre.y + 3.5, v + 1);
  }

  void drawProblem(const Advice& advice) {
    const auto place = [&](std::size_t i) { return at(scene_.nodes[advice.nodes[i]].camera.pose.position); };
    if (advice.nodes.empty() || advice.kind == AdviceKind::apart || advice.kind == AdviceKind::unused) return;
    put("<g stroke=\"{}\" stroke-width=\"1.6\" fill=\"none\"><title>{}</title>", kProblemColour,
        escapedXml(advice.problem));
    if (advice.kind == AdviceKind::wide || advice.kind == AdviceKind::hole)
      put("<polyline points=\"{}\" stroke-dasharray=\"5 4\"/>", points({place(0), place(1)}));
    else
      put("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"7\"/>", place(0).x, place(0).y);
    put("</g>");
  }

  void drawFrustum(const Camera& camera) {
    const Intrinsics& k = camera.intrinsics;
    const glm::dvec2 centre = at(camera.pose.position);
    if (k.model == CameraModel::equirectangular) {
      put("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill-opacity=\".08\"/>", centre.x, centre.y, frustum_ / 2);
    } else {
      std::vector<glm::dvec2> corners;
      for (const glm::dvec2 corner : {glm::dvec2(0, 0), {k.width, 0}, {k.width, k.height}, {0, k.height}}) {
        const glm::dvec3 ray = camera.pose.rotation * unproject(k, corner);
        corners.push_back(centre + frustum_ * glm::dvec2(glm::dot(ray, view_.right), -glm::dot(ray, view_.up)));
      }
      put("<polygon points=\"{}\" fill-opacity=\".08\"/>", points(corners));
      for (const glm::dvec2& corner : corners) put("<polyline points=\"{}\" fill=\"none\"/>", points({centre, corner}));
    }
  }

  void drawScale() {
    const double longest = kScaleBar / scale_, power = std::pow(10.0, std::floor(std::log10(longest)));
    const double length = power * (longest >= 5 * power ? 5 : longest >= 2 * power ? 2 : 1);
    const double y = height_ - 18, end = 20 + length * scale_;
    put("<path d=\"M20 {0:.1f}v-8v4H{1:.1f}v-4v8\" stroke=\"#202830\" fill=\"none\"/>", y, end);
    put("<text x=\"{:.1f}\" y=\"{:.1f}\">{:g} world units</text>", end + 8, y, length);
  }

  double drawLegend() {
    double y = 30;
    const auto line = [&](const std::string& text, double x, const char* style) {
      put("<text x=\"{:.0f}\" y=\"{:.0f}\"{}>{}</text>", kWidth + x, y, style, escapedXml(text));
      y += kLine;
    };
    std::array<std::size_t, 5> cells{};
    for (const Cell& cell : scene_.cells) ++cells[std::min<std::size_t>(cell.members.size(), 4)];
    line(fmt::format("{} photographs", scene_.nodes.size()), 0, " font-weight=\"bold\"");
    line(fmt::format("{} lines, {} triangles, {} tetrahedra", cells[2], cells[3], cells[4]), 0, "");
    y += 6;
    line(best_ > 0 ? "cell scores" : "cells have no scores", 0, " font-weight=\"bold\"");
    if (best_ > 0) {
      constexpr int kSteps = 20;
      for (int s = 0; s < kSteps; ++s)
        put("<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"9.5\" height=\"10\" fill=\"{}\"/>", kWidth + 9 * s, y - 9,
            colourOf((s + 0.5) / kSteps));
      y += 14;
      put("<text x=\"{:.0f}\" y=\"{:.0f}\">0</text>", kWidth, y);
      put("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\">{:.2f}</text>", kWidth + 180, y, best_);
      y += kLine;
    }
    y += 6;
    if (!advice_.views.empty()) {
      line("next-best views", 0, fmt::format(" font-weight=\"bold\" fill=\"{}\"", kAddColour).c_str());
      for (std::size_t v = 0; v < advice_.views.size(); ++v) {
        bool first = true;
        for (const std::string& part : wrapped(advice_.views[v].where, kLegendCharacters)) {
          line(first ? fmt::format("{} {}", v + 1, part) : part, first ? 0 : 12, " font-size=\"11\"");
          first = false;
        }
      }
      y += 6;
    }
    if (!advice_.advice.empty()) {
      line("problems", 0, fmt::format(" font-weight=\"bold\" fill=\"{}\"", kProblemColour).c_str());
      for (std::size_t a = 0; a < std::min(advice_.advice.size(), kMaxProblems); ++a)
        for (const std::string& part : wrapped(advice_.advice[a].problem, kLegendCharacters))
          line(part, 0, " font-size=\"11\"");
      if (advice_.advice.size() > kMaxProblems)
        line(fmt::format("and {} more", advice_.advice.size() - kMaxProblems), 0, " font-size=\"11\"");
      y += 6;
    }
    if (scene_.unusedPhotographs.empty()) return y;
    line(fmt::format("{} unused", scene_.unusedPhotographs.size()), 0, " font-weight=\"bold\" fill=\"#7a7a7a\"");
    for (std::size_t i = 0; i < std::min(scene_.unusedPhotographs.size(), kMaxListed); ++i) {
      line(scene_.unusedPhotographs[i].name, 0, " fill=\"#7a7a7a\"");
      for (const std::string& part : wrapped(scene_.unusedPhotographs[i].reason, kLegendCharacters))
        line(part, 12, " fill=\"#7a7a7a\" font-size=\"11\"");
    }
    if (scene_.unusedPhotographs.size() > kMaxListed)
      line(fmt::format("and {} more", scene_.unusedPhotographs.size() - kMaxListed), 0, " fill=\"#7a7a7a\"");
    return y;
  }

  const Scene& scene_;
  const CaptureAdvice& advice_;
  GraphView view_;
  std::vector<bool> used_;
  std::map<std::string, std::string> reason_;
  double best_ = 0;  // best score of the cells
  double scale_ = 1, height_ = kMinHeight, frustum_ = 10;
  glm::dvec2 shift_{0.0};
  std::string out_;
};

}  // namespace

std::string graphSvg(const Scene& scene, const CaptureAdvice& advice) {
  return Drawing(scene, advice).text();
}

}  // namespace ibr::app
