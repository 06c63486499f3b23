// SPDX-License-Identifier: Apache-2.0
#include "shared/report/plot.h"

#include <catch2/catch.hpp>
#include <charconv>
#include <cmath>
#include <limits>

#include "shared/report/plot_axis.h"
#include "shared/report/svg_text.h"

using namespace ibr::app;
using Catch::Contains;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
using Values = std::vector<double>;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t number = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++number;
  return number;
}

PlotPanel panelOf(const std::vector<PlotPoint>& points) {
  return {.title = "time and worth",
          .xName = "s",
          .yName = "dB",
          .logarithmicX = true,
          .joinFront = true,
          .series = {{"cpu", points}},
          .levels = {}};
}

}  // namespace

TEST_CASE("ticks are round numbers, at most as many as fit") {
  CHECK(roundTicks(0, 1, 6).values == Values{0, 0.2, 0.4, 0.6, 0.8, 1});
  CHECK(roundTicks(0, 1, 5).values == Values{0, 0.5, 1});
  CHECK(roundTicks(-3, 12, 8).values == Values{-2, 0, 2, 4, 6, 8, 10, 12});
  CHECK(roundTicks(0.871, 0.8734, 4).values == Values{0.871, 0.872, 0.873});
  CHECK(roundTicks(0.871, 0.8734, 4).decimals == 3);
  CHECK(roundTicks(1200, 5200, 5).values == Values{2000, 3000, 4000, 5000});
  CHECK(roundTicks(1200, 5200, 5).decimals == 0);
}

TEST_CASE("an axis covers all values") {
  for (const bool logarithmic : {false, true})
    for (const Values& values :
         {Values{3}, Values{3, 3}, Values{0.2, 700}, Values{28.1, 28.10001}, Values{1e-7, 1e9}}) {
      const PlotAxis axis = axisOver(values, logarithmic);
      INFO(logarithmic << " " << values.front() << " … " << values.back());
      for (const double value : values) {
        CHECK(axis.share(value) > 0);
        CHECK(axis.share(value) < 1);
      }
      REQUIRE(axis.ticks.size() >= 2);
      CHECK(axis.ticks.size() <= 7);
      CHECK(axis.labels.size() == axis.ticks.size());
      for (std::size_t i = 0; i < axis.ticks.size(); ++i) {
        CHECK(axis.share(axis.ticks[i]) >= -1e-9);
        CHECK(axis.share(axis.ticks[i]) <= 1 + 1e-9);
        if (i > 0) CHECK(axis.labels[i] != axis.labels[i - 1]);
      }
    }
}

TEST_CASE("an axis ignores values that are not finite, and is valid without values") {
  const PlotAxis axis = axisOver({kNan, 1, 2, std::numeric_limits<double>::infinity()}, false);
  CHECK(axis.low > 0.8);
  CHECK(axis.high < 2.2);
  CHECK(axisOver({0, -4, 10, 100}, true).low > 5);
  CHECK(axisOver({10, 100}, true).labels == std::vector<std::string>{"10", "20", "50", "100"});
  CHECK(axisOver({10, 100}, true).share(std::sqrt(1000.0)) == Approx(0.5));
  CHECK(axisOver({}, false).high == 1);
  CHECK(axisOver({kNan}, true).high == 10);
}

TEST_CASE("a plot shows its points, names, the default setting and the Pareto front") {
  const std::string svg = plotSvg("all",
                                  {panelOf({{1, 20, "R 1", false},
                                            {10, 30, "default", true},
                                            {20, 25, "R 20", false},
                                            {0, 30, "none", false},
                                            {5, kNan, "failed", false}})},
                                  {"a note"});
  CHECK(count(svg, "<path class=\"s0\"") == 1 + 3);  // one in the legend, and the three points that can be shown
  CHECK(count(svg, "class=\"usual\"") == 2);
  CHECK(count(svg, "class=\"front\"") == 1);
  const std::size_t front = svg.find("d=\"", svg.find("class=\"front\""));
  const std::string path = svg.substr(front, svg.find('"', front + 3) - front);
  CHECK(count(path, "M") + count(path, "L") == 2);  // R 20 is not on the front
  for (const char* part : {"time and worth", ">s<", ">dB<", "a note", ">R 1<", "cpu R 20: 20, 25", ">default<"})
    CHECK_THAT(svg, Contains(part));
  CHECK_THAT(svg, !Contains("failed") && !Contains("nan") && !Contains("inf"));
}

TEST_CASE("a level is a dashed line at its value, within the axis") {
  PlotPanel panel = panelOf({{1, 20, "", false}, {2, 21, "", false}});
  panel.levels = {{"before", 10}, {"not known", kNan}};
  const std::string svg = plotSvg("", {panel}, {});
  CHECK(count(svg, "class=\"level\"") == 1);
  CHECK_THAT(svg, Contains(">before<") && Contains(">10<"));
}

TEST_CASE("plots without points and with special characters are valid XML") {
  CHECK_THAT(plotSvg("", {}, {}), Contains("</svg>"));
  CHECK_THAT(plotSvg("", {panelOf({})}, {}), Contains("</svg>") && !Contains("nan"));
  const std::string svg = plotSvg("<a & \"b\">", {panelOf({{1, 2, "<i>", false}})}, {"c < d"});
  CHECK_THAT(svg, Contains("&lt;a &amp; &quot;b&quot;&gt;") && Contains("&lt;i&gt;") && Contains("c &lt; d"));
  CHECK_THAT(svg, !Contains("<i>") && !Contains("<a"));
}

TEST_CASE("on a logarithmic axis equal factors are equal distances, and values up to 0 are left out") {
  PlotPanel panel = panelOf({{1, 0.1, "low"}, {2, 0.2, "middle"}, {4, 0.4, "high"}, {8, 0, "nothing"}});
  const auto heights = [&] {
    std::vector<double> all;
    const std::string svg = plotSvg("", {panel}, {});
    const std::size_t field = svg.find("<rect x=");  // after the legend
    for (std::size_t at = svg.find("translate(", field); at != std::string::npos; at = svg.find("translate(", at + 1))
      std::from_chars(&svg[svg.find(' ', at) + 1], svg.data() + svg.size(), all.emplace_back());
    return all;
  };
  REQUIRE(heights().size() == 4);
  panel.logarithmicY = true;
  const std::vector<double> y = heights();
  REQUIRE(y.size() == 3);
  CHECK(y[0] - y[1] == Approx(y[1] - y[2]).margin(0.15));
  CHECK(axisOver({0.08, 0.3}, true).labels == std::vector<std::string>{"0.08", "0.09", "0.1", "0.2", "0.3"});
}

TEST_CASE("default points are labelled even in crowded plots, and the legend explains the markers") {
  std::vector<PlotPoint> points;
  for (int i = 0; i < 200; ++i) points.push_back({1 + 1e-3 * (i % 20), 20 + 1e-3 * (i / 20), "", false});
  for (const char* name : {"fast", "balanced", "accurate", "reference"}) points.push_back({1.01, 20.005, name, true});
  const std::string svg = plotSvg("", {panelOf(points)}, {}, {"preset", "", {{0.6, "2 MiB"}, {1.5, "9 MiB"}}, "half"});
  for (const char* name : {">fast<", ">balanced<", ">accurate<", ">reference<", ">2 MiB<", ">9 MiB<", ">half<"})
    CHECK(count(svg, name) == 1);
}

TEST_CASE("labels never overlap") {
  std::vector<PlotPoint> points;
  for (int i = 0; i < 40; ++i) points.push_back({1 + 1e-4 * i, 20 + 1e-6 * i, "crowded", false});
  points.push_back({10, 30, "alone", false});
  const std::string svg = plotSvg("", {panelOf(points)}, {});
  CHECK(count(svg, ">crowded</text>") >= 1);
  CHECK(count(svg, ">crowded</text>") <= 6);
  CHECK(count(svg, ">alone</text>") == 1);
}

TEST_CASE("long lines are wrapped by number of characters") {
  CHECK(wrapped("", 5) == std::vector<std::string>{""});
  CHECK(wrapped("ab cd ef", 5) == std::vector<std::string>{"ab cd", "ef"});
  CHECK(wrapped("äö üß", 5) == std::vector<std::string>{"äö üß"});
  CHECK(wrapped("a verylongword b", 4) == std::vector<std::string>{"a", "verylongword", "b"});
}
