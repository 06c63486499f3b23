// SPDX-License-Identifier: Apache-2.0
// Steps of autoPath:
//   1. collect stations: the distinct centres of the cells, where photographs are blended and coverage is highest
//   2. order the stations along the principal axis if they are nearly a line, else by nearest neighbour and 2-opt
//   3. choose at each station the cell's view direction with the smallest turn; at panoramas look along the path
//   4. smooth positions and directions, extend both ends beyond the cells, and time the keys by distance and turn
#include "shared/camera/auto_path.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <numeric>

#include "base/check.h"
#include "base/median.h"

namespace ibr::app {
namespace {

constexpr double kBeyond = 0.1;         // extension past the first and the last photograph, share of a cell's reach
constexpr double kMinNarrowing = 0.55;  // limits of narrowing(), share of the photographs' field of view, as a tangent
constexpr double kMaxNarrowing = 0.9;
constexpr double kNeighbours = 1.1;   // factor on the coverage, since neighbouring cells add their surroundings
constexpr double kTurnPerStep = 0.5;  // turn that takes as long as a median step, radians
constexpr double kMaxLineVariance =
    0.05;                            // maximum of the variance off the principal axis, share of the total variance
constexpr double kFps = 30;          // frames a second, common for viewers and videos
constexpr int kSmoothingPasses = 2;  // passes of the filter (1 2 1) / 4
constexpr std::size_t kMax2OptStations =
    500;  // maximum number of stations for 2-opt, which takes quadratic time a pass

struct Look {
  glm::dvec3 axis, up;
};

// View direction at a station, and the photographs that the direction comes from.
struct Choice {
  Look look;
  std::vector<std::uint32_t> nodes;
  double weight = 0;  // tier-0 triangles of the cell; 1 for a single photograph
};

struct Station {
  glm::dvec3 position;
  std::vector<Choice> choices;
  bool allRound = false;  // true: a choice at the station has panoramas only
};

// Mean direction, or the first direction if the directions nearly cancel (up vectors of a drone that changed heading).
glm::dvec3 meanDirection(const std::vector<glm::dvec3>& directions) {
  glm::dvec3 sum(0.0);
  for (const glm::dvec3 direction : directions) sum += direction;
  return glm::normalize(glm::length(sum) > 0.5 * double(directions.size()) ? sum : directions[0]);
}

Choice choiceOf(const Scene& scene, std::vector<std::uint32_t> nodes, double weight) {
  std::vector<glm::dvec3> axes, ups;
  for (const std::uint32_t node : nodes) {
    const Pose& pose = scene.nodes[node].camera.pose;
    axes.push_back(viewAxis(pose));
    ups.push_back(pose.rotation * glm::dvec3(0, 1, 0));
  }
  return {{meanDirection(axes), meanDirection(ups)}, std::move(nodes), weight};
}

glm::dvec3 centreOf(const Scene& scene, const std::vector<std::uint32_t>& nodes) {
  glm::dvec3 centre(0.0);
  for (const std::uint32_t node : nodes) centre += scene.nodes[node].camera.pose.position / double(nodes.size());
  return centre;
}

std::vector<Station> stationsOf(const Scene& scene) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const Node& node : scene.nodes) {
    low = glm::min(low, node.camera.pose.position);
    high = glm::max(high, node.camera.pose.position);
  }
  const double same = 1e-4 * glm::length(high - low);
  std::vector<Station> stations;
  const auto add = [&](const std::vector<std::uint32_t>& nodes, double weight) {
    const glm::dvec3 centre = centreOf(scene, nodes);
    const auto found = std::ranges::find_if(
        stations, [&](const Station& station) { return glm::distance(station.position, centre) <= same; });
    Station& station = found != stations.end() ? *found : stations.emplace_back(Station{centre, {}});
    station.choices.push_back(choiceOf(scene, nodes, weight));
    station.allRound |= std::ranges::all_of(nodes, [&](std::uint32_t node) {
      return scene.nodes[node].camera.intrinsics.model == CameraModel::equirectangular;
    });
  };
  for (const Cell& cell : scene.cells) add(cell.members, double(cell.mesh.tier0Count()));
  if (scene.cells.empty())
    for (std::uint32_t node = 0; node < scene.nodes.size(); ++node) add({node}, 1.0);
  return stations;
}

// Principal axis by power iteration, and the share of the variance that is off the axis.
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

// 2-opt: reverses sections of the open tour while a reversal makes the tour shorter.
void improveBy2Opt(std::vector<Station>& tour) {
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
  if (off >= kMaxLineVariance) {
    nearestNeighbours(stations);
    if (stations.size() <= kMax2OptStations) improveBy2Opt(stations);
  }
  // From the earlier photograph to the later, which is the direction in which the photographer walked.
  if (stations.front().choices[0].nodes[0] > stations.back().choices[0].nodes[0]) std::ranges::reverse(stations);
}

glm::dquat rotationOf(const Look& look) {
  const glm::dvec3 back = -glm::normalize(look.axis);
  const glm::dvec3 right = glm::normalize(glm::cross(look.up, back));
  return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)));
}

// Direction towards the next station, orthogonal to the up vector.
glm::dvec3 ahead(const std::vector<Station>& tour, std::size_t i, const Look& last) {
  if (tour.size() < 2) return last.axis;
  const std::size_t from = std::min(i, tour.size() - 2);
  const glm::dvec3 way = tour[from + 1].position - tour[from].position;
  const glm::dvec3 level = way - glm::dot(way, last.up) * last.up;
  return glm::length(level) > 0.1 * glm::length(way) ? glm::normalize(level) : last.axis;
}

std::vector<Look> looksAlong(const std::vector<Station>& tour, const Choice& start) {
  glm::dvec3 meanUp(0.0);
  std::size_t count = 0;
  for (const Station& station : tour)
    for (const Choice& choice : station.choices) {
      meanUp += choice.look.up;
      ++count;
    }
  // If the photographs agree on an up vector (photographer on foot), all looks use the mean. If not (drone that changes
  // its heading), each look keeps the previous up vector.
  const bool agreed = glm::length(meanUp) > 0.5 * double(count);
  std::vector<Look> looks;
  Look last = start.look;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    const Station& station = tour[i];
    const Choice& nearest = *std::ranges::max_element(
        station.choices, {}, [&](const Choice& choice) { return glm::dot(choice.look.axis, last.axis); });
    Look look{nearest.look.axis, agreed ? glm::normalize(meanUp) : last.up};
    if (station.allRound) look.axis = ahead(tour, i, {nearest.look.axis, look.up});
    if (std::abs(glm::dot(look.axis, look.up)) > 0.98) look.up = nearest.look.up;
    looks.push_back(last = look);
  }
  return looks;
}

template <class T, class Member>
void smooth(std::vector<T>& values, Member member) {
  for (int pass = 0; pass < kSmoothingPasses; ++pass) {
    const std::vector<T> old = values;
    for (std::size_t i = 1; i + 1 < values.size(); ++i)
      values[i].*member = 0.25 * (old[i - 1].*member) + 0.5 * (old[i].*member) + 0.25 * (old[i + 1].*member);
  }
}

// Restores looks whose smoothed axis or up vector vanished, as the mean over a half turn does.
void repair(std::vector<Look>& looks, const std::vector<Look>& before) {
  for (std::size_t i = 0; i < looks.size(); ++i)
    if (!(glm::length(glm::cross(looks[i].axis, looks[i].up)) > 0.1)) looks[i] = before[i];
}

void chooseSize(const Intrinsics& photograph, CameraPath& path) {
  if (path.width > 0 && path.height > 0) return;
  if (photograph.model == CameraModel::equirectangular) {
    path.width = 1280;
    path.height = 720;
    return;
  }
  const double scale = std::min(1.0, 1280.0 / std::max(photograph.width, photograph.height));
  const auto even = [&](int side) { return std::max(2, int(std::lround(side * scale / 2)) * 2); };
  path.width = even(photograph.width);
  path.height = even(photograph.height);
}

// Vertical, radians: the photographs' field of view times `narrowed`; panoramas: fixed, like a wide-angle lens.
double fieldOfView(const Intrinsics& photograph, const CameraPath& path, double narrowed) {
  constexpr double kPanoramaFovY = 1.1;
  if (photograph.model == CameraModel::equirectangular) return kPanoramaFovY;
  const double tanX = 0.5 * photograph.width / photograph.fx, tanY = 0.5 * photograph.height / photograph.fy;
  return 2 * std::atan(narrowed * std::min(tanY, tanX * path.height / path.width));
}

// Share of the photographs' field of view that the path shows, as a length: from the cells' median coverage.
double narrowing(const Scene& scene) {
  std::vector<double> coverages;
  for (const Cell& cell : scene.cells)
    if (std::isfinite(cell.quality.coverage)) coverages.push_back(cell.quality.coverage);
  return coverages.empty() ? kMaxNarrowing
                           : std::clamp(kNeighbours * std::sqrt(median(coverages)), kMinNarrowing, kMaxNarrowing);
}

// Moves the end key outwards along the path, to a little past the last photograph of the cell at this station.
CameraKey beyond(const Scene& scene, const Station& station, CameraKey end, const CameraKey& before) {
  const glm::dvec3 step = end.position - before.position;
  if (!(glm::length(step) > 0)) return end;
  const glm::dvec3 way = glm::normalize(step);
  double furthest = 0;
  for (const Choice& choice : station.choices)
    for (const std::uint32_t node : choice.nodes)
      furthest = std::max(furthest, glm::dot(scene.nodes[node].camera.pose.position - end.position, way));
  const bool single = station.choices[0].nodes.size() == 1;
  const double reach = single ? glm::length(step) : furthest;
  end.position += (furthest + kBeyond * reach) * way;
  return end;
}

// A path for one station: crosses a cell from member to member, or stands still at a single photograph.
std::vector<CameraKey> keysAcross(const Scene& scene, const CameraKey& centre, const Choice& choice) {
  std::vector<CameraKey> keys;
  for (const std::uint32_t node : choice.nodes) {
    const glm::dvec3 outwards = scene.nodes[node].camera.pose.position - centre.position;
    keys.push_back(centre);
    keys.back().position += (1 + kBeyond) * outwards;
  }
  if (keys.size() == 1) keys.push_back(keys[0]);
  return keys;
}

void setTimes(std::vector<CameraKey>& keys, double duration) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < keys.size(); ++i) steps.push_back(glm::distance(keys[i - 1].position, keys[i].position));
  const double typical = median(steps) > 0 ? median(steps) : 1.0;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const double cosine = std::abs(glm::dot(keys[i - 1].rotation, keys[i].rotation));
    const double turn = 2 * std::acos(std::min(1.0, cosine));
    keys[i].time = keys[i - 1].time + std::max(1e-3, steps[i - 1] / typical + turn / kTurnPerStep);
  }
  const double total = keys.back().time;
  for (CameraKey& key : keys) key.time *= duration / total;
}

}  // namespace

CameraPath autoPath(const Scene& scene, int frameCount, int width, int height) {
  assert(frameCount >= 1);
  std::vector<Station> tour = stationsOf(scene);
  check(!tour.empty(), ErrorCode::invalidInput, "the scene has no photograph to make a path from");
  sortIntoTour(tour);
  const Choice start = *std::ranges::max_element(tour.front().choices, {}, &Choice::weight);
  const std::vector<Look> asPhotographed = looksAlong(tour, start);
  std::vector<Look> looks = asPhotographed;
  smooth(tour, &Station::position);
  smooth(looks, &Look::axis);
  smooth(looks, &Look::up);
  repair(looks, asPhotographed);

  const Intrinsics& photograph = scene.nodes[start.nodes[0]].camera.intrinsics;
  CameraPath path{width, height, kFps, {}};
  chooseSize(photograph, path);
  const double fovY = fieldOfView(photograph, path, narrowing(scene));
  std::vector<CameraKey>& keys = path.keys;
  for (std::size_t i = 0; i < tour.size(); ++i) keys.push_back({0, tour[i].position, rotationOf(looks[i]), fovY});
  if (tour.size() == 1) {
    keys = keysAcross(scene, keys[0], start);
  } else {
    const CameraKey first = beyond(scene, tour.front(), keys.front(), keys[1]);
    const CameraKey last = beyond(scene, tour.back(), keys.back(), keys[keys.size() - 2]);
    keys.insert(keys.begin(), first);
    keys.push_back(last);
  }
  if (frameCount == 1)
    keys = {keys[keys.size() / 2]};
  else
    setTimes(keys, (frameCount - 1) / kFps);
  return path;
}

}  // namespace ibr::app
