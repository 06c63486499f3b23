// SPDX-License-Identifier: Apache-2.0
#include "shared/report/graph_svg.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "shared/report/graph_view.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::app;
using Catch::Contains;

namespace {

Scene sceneOf(const std::vector<Camera>& cameras) {
  Scene scene;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    scene.nodes.push_back({fmt::format("{}.jpg", i), cameras[i], {}, {}});
  return scene;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t number = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++number;
  return number;
}

void checkFrame(const GraphView& view) {
  CHECK(glm::length(view.right) == Approx(1));
  CHECK(glm::length(view.up) == Approx(1));
  CHECK(glm::dot(view.right, view.toward) == Approx(0).margin(1e-9));
  CHECK(glm::length(glm::cross(view.right, view.up) - view.toward) == Approx(0).margin(1e-9));
}

}  // namespace

TEST_CASE("the graph is projected along the axis of least spread, seen from above") {
  std::vector<Camera> ground, wall, line;
  for (int i = 0; i < 12; ++i) {
    ground.push_back(test::lookingAlong({i % 4, i / 4, 0.1 * (i % 2)}, {0, 1, 0}));
    wall.push_back(test::lookingAlong({i % 4, 0.05 * (i % 3), i / 4}, {0, 1, 0}));
    line.push_back(test::lookingAlong({i, 0.5 * i, 0}, {0, 1, 0}));
  }
  const glm::dquat turn = GENERATE(glm::dquat(1, 0, 0, 0), glm::normalize(glm::dquat(0.2, 0.4, -0.7, 0.5)));
  const auto viewOf = [&](std::vector<Camera> cameras) {
    for (Camera& c : cameras) c.pose = {turn * c.pose.position * 30.0, turn * c.pose.rotation};
    const GraphView view = graphView(sceneOf(cameras));
    checkFrame(view);
    return view;
  };
  CHECK(glm::dot(viewOf(ground).toward, turn * glm::dvec3(0, 0, 1)) > 0.99);
  CHECK(glm::dot(viewOf(wall).toward, turn * glm::dvec3(0, -1, 0)) > 0.99);  // from behind the cameras
  CHECK(glm::dot(viewOf(line).toward, turn * glm::dvec3(0, 0, 1)) > 0.99);
  const GraphView row = viewOf(line);
  CHECK(std::abs(row.flat(turn * line[11].pose.position * 30.0).y) < 1e-6);
}

TEST_CASE("the graph's SVG shows cameras, cells and unused photographs, with escaped texts") {
  std::vector<Camera> cameras;
  for (int i = 0; i < 5; ++i) cameras.push_back(test::lookingAlong({i % 2, i / 2, 0.4 * (i == 3)}, {0, 1, 0}));
  Scene scene = sceneOf(cameras);
  scene.nodes[4].name = "<last> & \"least\".jpg";
  scene.cells.resize(3);
  scene.cells[0].members = {0, 1};
  scene.cells[1].members = {0, 1, 2};
  scene.cells[2].members = {0, 1, 2, 3};
  for (std::size_t c = 0; c < 3; ++c) scene.cells[c].quality.score = 0.1 * double(c + 1);
  scene.unusedPhotographs = {
      {scene.nodes[4].name, "its axis is 47° from that of any photograph from another place, more than 26°"},
      {"file.jpg", "not registered\x01"}};
  const std::string svg = graphSvg(scene);
  CHECK_THAT(svg, Contains("<svg xmlns") && Contains("5 photographs") && Contains("1 lines") &&
                      Contains("1 triangles") && Contains("1 tetrahedra"));
  CHECK_THAT(svg, Contains("&lt;last&gt; &amp; &quot;least&quot;.jpg") && Contains("47°") && Contains("2 unused"));
  CHECK_THAT(svg, Contains("0.30"));  // the best score
  CHECK(svg.find("<last>") == std::string::npos);
  CHECK(svg.find('\x01') == std::string::npos);
  CHECK(count(svg, "r=\"2.2\"") == 5);
  CHECK(count(svg, ", score 0.") == 3);
  CHECK(count(svg, "<g ") == count(svg, "</g>"));
  CHECK(count(svg, "#9a9a9a") == 2 * 1);  // one camera: stroke and fill
}

TEST_CASE("next-best views are numbered, problems are drawn at their photographs") {
  std::vector<Camera> cameras;
  for (int i = 0; i < 4; ++i) cameras.push_back(test::lookingAlong({i, 0, 0}, {0, 1, 0}));
  const Scene scene = sceneOf(cameras);
  CaptureAdvice advice;
  advice.views = {{test::lookingAlong({1.5, 0, 0}, {0, 1, 0}), {1, 2}, 0.5, "halfway between <1> and 2"},
                  {test::lookingAlong({9, 4, 0}, {0, 1, 0}), {3}, 0.4, "far off"}};  // extends the drawing
  advice.advice = {{AdviceKind::wide, Severity::warning, "1.jpg & 2.jpg are too far apart", "", {1, 2}, 0.5},
                   {AdviceKind::blurred, Severity::warning, "3.jpg is not sharp", "", {3}, 0.2},
                   {AdviceKind::row, Severity::hint, "a row", "", {}, 0}};
  const std::string svg = graphSvg(scene, advice);
  CHECK_THAT(svg, Contains("1: halfway between &lt;1&gt; and 2") && Contains("2: far off") && Contains("next-best"));
  CHECK_THAT(svg, Contains("1.jpg &amp; 2.jpg are too far apart") && Contains("problems") && Contains("a row"));
  CHECK(count(svg, "r=\"8\"") == 2);
  CHECK(count(svg, "stroke-dasharray") == 1);
  CHECK(count(svg, "r=\"7\"") == 1);
  CHECK(count(svg, "<g ") == count(svg, "</g>"));
  CHECK(graphSvg(scene) == graphSvg(scene, {}));
}

TEST_CASE("graphs without extent, scores or photographs give valid SVG") {
  const Camera camera = test::lookingAlong({3, 4, 5}, {0, 1, 0});
  Scene one = sceneOf({camera}), same = sceneOf({camera, camera}), two = sceneOf({camera, camera});
  two.nodes[1].camera.pose.position.x += 1e-6;
  two.cells.resize(1);
  two.cells[0].members = {0, 1};
  for (const Scene& scene : {Scene{}, one, same, two}) {
    checkFrame(graphView(scene));
    const std::string svg = graphSvg(scene);
    CHECK_THAT(svg, Contains("</svg>") && Contains("no scores"));
    CHECK(svg.find("inf") == std::string::npos);
    CHECK(svg.find("=\"nan") == std::string::npos);
    CHECK(svg.find(",nan") == std::string::npos);
  }
}
