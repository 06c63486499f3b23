// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/path_recorder.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "base/check.h"
#include "shared/camera/camera_json.h"
#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

constexpr double kMinKeySeconds = 1e-3;  // minimum time between keys, s
constexpr int kSamples = 32;             // samples of a segment, to measure its length
constexpr int kTimingIterations = 8;     // iterations of the timing: the spline's shape depends a little on its times
constexpr double kStill = 1e-12;         // share of the world's size below which a length counts as zero

Pose poseOf(const CameraKey& key) {
  return {key.position, key.rotation};
}

bool later(const CameraKey& a, const CameraKey& b) {
  return a.time < b.time;
}

CameraPath checked(CameraPath path) {
  checkCameraPath(path, "camera path");
  return path;
}

// Lengths along the spline from each key to the next. The times need not match these lengths.
std::vector<double> segmentLengths(const CameraPath& path, double unitsPerRadian) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i + 1 < path.keys.size(); ++i) {
    const CameraKey &from = path.keys[i], &to = path.keys[i + 1];
    Pose last = poseOf(from);
    double length = 0;
    for (int s = 1; s <= kSamples; ++s) {
      const Pose pose = cameraAt(path, std::lerp(from.time, to.time, double(s) / kSamples)).pose;
      length += poseDistance(last, pose, unitsPerRadian);
      last = pose;
    }
    lengths.push_back(length);
  }
  return lengths;
}

bool standsStill(const CameraKey& a, const CameraKey& b, double unitsPerRadian) {
  const double size = std::max({1.0, glm::length(a.position), unitsPerRadian});
  return poseDistance(poseOf(a), poseOf(b), unitsPerRadian) <= kStill * size;
}

// `seconds`: duration of the whole path; 0: `unitsPerSecond` applies.
CameraPath retimed(const CameraPath& before, double unitsPerSecond, double seconds) {
  CameraPath path = before;
  const std::size_t segments = path.keys.empty() ? 0 : path.keys.size() - 1;
  const double unitsPerRadian = unitsPerRadianOf(path);
  for (int round = 0; round < kTimingIterations; ++round) {
    std::vector<double> steps = segmentLengths(path, unitsPerRadian);
    double length = 0, pauses = 0;
    std::vector<bool> still(segments);
    for (std::size_t i = 0; i < segments; ++i) {
      still[i] = standsStill(before.keys[i], before.keys[i + 1], unitsPerRadian);
      (still[i] ? pauses : length) += still[i] ? before.keys[i + 1].time - before.keys[i].time : steps[i];
    }
    const double total = before.keys.empty() ? 0 : before.keys.back().time - before.keys.front().time;
    double speed = unitsPerSecond, pauseShare = 1;
    if (seconds > 0) {
      pauseShare = seconds / total;
      speed = length / (seconds - pauses * pauseShare);
    }
    for (std::size_t i = 0; i < segments; ++i) {
      const double step = still[i] ? (before.keys[i + 1].time - before.keys[i].time) * pauseShare : steps[i] / speed;
      path.keys[i + 1].time = path.keys[i].time + std::max(step, kMinKeySeconds);
    }
  }
  return path;
}

}  // namespace

std::size_t putKey(CameraPath& path, const CameraKey& key) {
  CameraPath changed = path;
  std::erase_if(changed.keys, [&](const CameraKey& k) { return std::abs(k.time - key.time) < kMinKeySeconds; });
  const auto place = std::lower_bound(changed.keys.begin(), changed.keys.end(), key, later);
  const std::size_t index = std::size_t(place - changed.keys.begin());
  changed.keys.insert(place, key);
  changed = checked(std::move(changed));
  changed.keys[index].rotation = unitRotation(key.rotation);  // normalised here, so that saving does not change the key
  path = std::move(changed);
  return index;
}

std::size_t appendKey(CameraPath& path, const Pose& pose, double fovY, double unitsPerSecond) {
  check(unitsPerSecond > 0, ErrorCode::invalidInput, "camera path: the speed must be above 0");
  double time = 0;
  if (!path.keys.empty()) {
    const CameraKey& last = path.keys.back();
    CameraPath longer = path;  // includes the new step: a path of one key has no distances
    longer.keys.push_back({last.time + 1, pose.position, pose.rotation, fovY});
    const double length = poseDistance(poseOf(last), pose, unitsPerRadianOf(longer));
    time = last.time + std::max(length / unitsPerSecond, std::max(1 / path.fps, kMinKeySeconds));
  }
  return putKey(path, {time, pose.position, pose.rotation, fovY});
}

std::size_t moveKey(CameraPath& path, std::size_t key, double time) {
  check(key < path.keys.size(), ErrorCode::invalidInput, "camera path: there is no key {}", key);
  CameraPath changed = path;
  CameraKey moved = changed.keys[key];
  changed.keys.erase(changed.keys.begin() + std::ptrdiff_t(key));
  moved.time = time;
  for (const CameraKey& other : changed.keys)
    check(!(std::abs(other.time - time) < kMinKeySeconds), ErrorCode::invalidInput,
          "camera path: there is already a key at {} s", other.time);
  const std::size_t index = putKey(changed, moved);
  path = std::move(changed);
  return index;
}

void deleteKey(CameraPath& path, std::size_t key) {
  check(key < path.keys.size(), ErrorCode::invalidInput, "camera path: there is no key {}", key);
  path.keys.erase(path.keys.begin() + std::ptrdiff_t(key));
}

double poseDistance(const Pose& from, const Pose& to, double unitsPerRadian) {
  const glm::dquat turn = glm::conjugate(from.rotation) * to.rotation;
  const double angle = 2 * std::atan2(std::hypot(turn.x, turn.y, turn.z), std::abs(turn.w));
  return std::hypot(glm::distance(from.position, to.position), angle * unitsPerRadian);
}

double unitsPerRadianOf(const CameraPath& path) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i + 1 < path.keys.size(); ++i)
    if (const double length = glm::distance(path.keys[i].position, path.keys[i + 1].position); length > 0)
      lengths.push_back(length);
  return lengths.empty() ? 1.0 : 2 * quantile(lengths, 0.5);
}

void retimeAtSpeed(CameraPath& path, double unitsPerSecond) {
  check(unitsPerSecond > 0 && std::isfinite(unitsPerSecond), ErrorCode::invalidInput,
        "camera path: the speed must be above 0");
  if (path.keys.size() > 1) path = checked(retimed(path, unitsPerSecond, 0));
}

void retimeToLast(CameraPath& path, double seconds) {
  check(seconds > 0 && std::isfinite(seconds), ErrorCode::invalidInput, "camera path: the duration must be above 0 s");
  if (path.keys.size() > 1) path = checked(retimed(path, 0, seconds));
}

}  // namespace ibr::app
