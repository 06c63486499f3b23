// SPDX-License-Identifier: Apache-2.0
//
//   1. stations: the different places of the photographs
//   2. order them: along the principal axis where they are nearly a line, else nearest neighbour, then 2-opt
//   3. at each, look as that photograph there does that turns the view least
//   4. smooth places and directions, add the ends, and time the keys by way and turn
#include "shared/auto_path.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <numeric>

#include "base/check.h"

namespace ibr::app {
namespace {

constexpr double kBeyond = 0.1;         // of a step, past the first and the last photograph
constexpr double kNarrower = 0.9;       // of the photographs' field of view, as a tangent
constexpr double kTurnPerStep = 0.5;    // radians that take as long as a median step
constexpr double kNearlyLine = 0.05;    // variance off the principal axis against variance along it
constexpr double kFps = 30;             // what viewers and videos expect
constexpr int kSmoothings = 2;          // passes of (1 2 1) / 4
constexpr std::size_t kMost2Opt = 500;  // stations; beyond, nearest neighbour has to do

struct Station {
  glm::dvec3 position;
  std::vector<std::size_t> nodes;
};

// How many cells each node is a member of.
std::vector<std::size_t> cellCounts(const Scene& scene) {
  std::vector<std::size_t> counts(scene.nodes.size(), 0);
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t node : cell.members) ++counts[node];
  return counts;
}

std::vector<Station> stationsOf(const Scene& scene, const std::vector<std::size_t>& cells) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const Node& node : scene.nodes) {
    low = glm::min(low, node.camera.pose.position);
    high = glm::max(high, node.camera.pose.position);
  }
  const double same = 1e-4 * glm::length(high - low);
  std::vector<Station> stations;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Camera& camera = scene.nodes[i].camera;
    if (camera.intrinsics.model != CameraModel::pinhole || (cells[i] == 0 && !scene.cells.empty())) continue;
    const auto found = std::ranges::find_if(stations, [&](const Station& station) {
      return glm::distance(station.position, camera.pose.position) <= same;
    });
    if (found != stations.end())
      found->nodes.push_back(i);
    else
      stations.push_back({camera.pose.position, {i}});
  }
  return stations;
}

// Principal axis by power iteration, and the share of the variance that is off it.
std::pair<glm::dvec3, double> principalAxis(const std::vector<Station>& stations) {
  glm::dvec3 mean(0.0);
  for (const Station& station : stations) mean += station.position / double(stations.size());
  glm::dmat3 covariance(0.0);
  for (const Station& station : stations)
    covariance += glm::outerProduct(station.position - mean, station.position - mean);
  const double total = covariance[0][0] + covariance[1][1] + covariance[2][2];
  if (!(total > 0)) return {glm::dvec3(1, 0, 0), 0.0};
  int widest = 0;
  for (int i = 1; i < 3; ++i)
    if (covariance[i][i] > covariance[widest][widest]) widest = i;
  glm::dvec3 axis = covariance[widest];
  for (int i = 0; i < 200; ++i) axis = glm::normalize(covariance * axis);
  return {axis, 1.0 - glm::dot(axis, covariance * axis) / total};
}

void nearestNeighbours(std::vector<Station>& tour) {
  for (std::size_t i = 1; i < tour.size(); ++i) {
    const glm::dvec3 from = tour[i - 1].position;
    const auto nearest = std::min_element(tour.begin() + std::ptrdiff_t(i), tour.end(), [&](auto& a, auto& b) {
      return glm::distance(from, a.position) < glm::distance(from, b.position);
    });
    std::iter_swap(tour.begin() + std::ptrdiff_t(i), nearest);
  }
}

// Turns pieces of the open tour round for as long as that makes it shorter.
void untangle(std::vector<Station>& tour) {
  const auto between = [&](std::size_t a, std::size_t b) { return glm::distance(tour[a].position, tour[b].position); };
  for (bool shorter = true; shorter;) {
    shorter = false;
    for (std::size_t i = 0; i + 2 < tour.size(); ++i)
      for (std::size_t j = i + 2; j < tour.size(); ++j) {
        const double now = between(i, i + 1) + (j + 1 < tour.size() ? between(j, j + 1) : 0.0);
        const double then = between(i, j) + (j + 1 < tour.size() ? between(i + 1, j + 1) : 0.0);
        if (then >= now * (1 - 1e-9)) continue;
        std::reverse(tour.begin() + std::ptrdiff_t(i) + 1, tour.begin() + std::ptrdiff_t(j) + 1);
        shorter = true;
      }
  }
}

void sortIntoTour(std::vector<Station>& stations) {
  const auto [axis, off] = principalAxis(stations);
  const auto along = [axis = axis](const Station& a, const Station& b) {
    return glm::dot(axis, a.position) < glm::dot(axis, b.position);
  };
  std::ranges::stable_sort(stations, along);
  if (off >= kNearlyLine) {
    nearestNeighbours(stations);
    if (stations.size() <= kMost2Opt) untangle(stations);
  }
  // From the earlier photograph to the later: who walked, walked that way.
  if (stations.front().nodes.front() > stations.back().nodes.front()) std::ranges::reverse(stations);
}

struct Look {
  glm::dvec3 axis, up;
};

Look lookOf(const Scene& scene, std::size_t node) {
  const Pose& pose = scene.nodes[node].camera.pose;
  return {viewAxis(pose), pose.rotation * glm::dvec3(0, 1, 0)};
}

glm::dquat rotationOf(const Look& look) {
  const glm::dvec3 back = -glm::normalize(look.axis);
  const glm::dvec3 right = glm::normalize(glm::cross(look.up, back));
  return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)));
}

std::vector<Look> looksAlong(const Scene& scene, const std::vector<Station>& tour, std::size_t start) {
  glm::dvec3 meanUp(0.0);
  std::size_t count = 0;
  for (const Station& station : tour)
    for (const std::size_t node : station.nodes) {
      meanUp += lookOf(scene, node).up;
      ++count;
    }
  // Where the photographs agree on an up, as walkers' do, it is kept; a drone that turns its heading has none, and the
  // view keeps its own.
  const bool agreed = glm::length(meanUp) > 0.5 * double(count);
  std::vector<Look> looks;
  Look last = lookOf(scene, start);
  for (const Station& station : tour) {
    const std::size_t node = *std::ranges::max_element(
        station.nodes, {}, [&](std::size_t n) { return glm::dot(lookOf(scene, n).axis, last.axis); });
    Look look{lookOf(scene, node).axis, agreed ? glm::normalize(meanUp) : last.up};
    if (std::abs(glm::dot(look.axis, look.up)) > 0.98) look.up = lookOf(scene, node).up;
    looks.push_back(last = look);
  }
  return looks;
}

template <class T, class Member>
void smooth(std::vector<T>& values, Member member) {
  for (int pass = 0; pass < kSmoothings; ++pass) {
    const std::vector<T> old = values;
    for (std::size_t i = 1; i + 1 < values.size(); ++i)
      values[i].*member = 0.25 * (old[i - 1].*member) + 0.5 * (old[i].*member) + 0.25 * (old[i + 1].*member);
  }
}

// Looks that were averaged over a half turn may have cancelled out.
void repair(std::vector<Look>& looks, const std::vector<Look>& before) {
  for (std::size_t i = 0; i < looks.size(); ++i)
    if (!(glm::length(glm::cross(looks[i].axis, looks[i].up)) > 0.1)) looks[i] = before[i];
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void chooseSize(const Intrinsics& photograph, CameraPath& path) {
  if (path.width > 0 && path.height > 0) return;
  const double scale = std::min(1.0, 1280.0 / std::max(photograph.width, photograph.height));
  const auto even = [&](int side) { return std::max(2, int(std::lround(side * scale / 2)) * 2); };
  path.width = even(photograph.width);
  path.height = even(photograph.height);
}

}  // namespace

CameraPath autoPath(const Scene& scene, int frameCount, int width, int height) {
  assert(frameCount >= 1);
  const auto cells = cellCounts(scene);
  std::vector<Station> tour = stationsOf(scene, cells);
  check(!tour.empty(), ErrorCode::invalidInput, "the scene has no pinhole photograph to make a path from");
  sortIntoTour(tour);
  const std::size_t start = *std::ranges::max_element(tour.front().nodes, {}, [&](std::size_t n) { return cells[n]; });
  const std::vector<Look> asPhotographed = looksAlong(scene, tour, start);
  std::vector<Look> looks = asPhotographed;
  smooth(tour, &Station::position);
  smooth(looks, &Look::axis);
  smooth(looks, &Look::up);
  repair(looks, asPhotographed);

  const Intrinsics& photograph = scene.nodes[start].camera.intrinsics;
  CameraPath path{width, height, kFps, {}};
  chooseSize(photograph, path);
  const double tanX = 0.5 * photograph.width / photograph.fx, tanY = 0.5 * photograph.height / photograph.fy;
  const double fovY = 2 * std::atan(kNarrower * std::min(tanY, tanX * path.height / path.width));
  for (std::size_t i = 0; i < tour.size(); ++i) path.keys.push_back({0, tour[i].position, rotationOf(looks[i]), fovY});
  if (tour.size() > 1) {
    CameraKey first = path.keys.front(), last = path.keys.back();
    first.position += kBeyond * (first.position - path.keys[1].position);
    last.position += kBeyond * (last.position - path.keys[path.keys.size() - 2].position);
    path.keys.insert(path.keys.begin(), first);
    path.keys.push_back(last);
  } else {
    path.keys.push_back(path.keys.front());  // a single place: the view stands still
  }
  if (frameCount == 1) path.keys = {path.keys[path.keys.size() / 2]};

  std::vector<double> steps;
  for (std::size_t i = 1; i < path.keys.size(); ++i)
    steps.push_back(glm::distance(path.keys[i - 1].position, path.keys[i].position));
  const double typical = steps.empty() || median(steps) == 0 ? 1.0 : median(steps);
  for (std::size_t i = 1; i < path.keys.size(); ++i) {
    const double cosine = std::abs(glm::dot(path.keys[i - 1].rotation, path.keys[i].rotation));
    const double turn = 2 * std::acos(std::min(1.0, cosine));
    path.keys[i].time = path.keys[i - 1].time + std::max(1e-3, steps[i - 1] / typical + turn / kTurnPerStep);
  }
  const double duration = (frameCount - 1) / kFps, total = path.keys.back().time;
  for (CameraKey& key : path.keys) key.time *= total > 0 ? duration / total : 0;
  return path;
}

}  // namespace ibr::app
