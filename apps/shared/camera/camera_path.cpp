// SPDX-License-Identifier: Apache-2.0
// Cubic Hermite curves through the keys. The tangent at a key is the slope of the parabola through the key and its two
// neighbours. For even spacing this is the Catmull–Rom tangent. The end keys use the slope of the chord.
#include "shared/camera/camera_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "shared/camera/camera_json.h"

namespace ibr::app {
namespace {

// The interpolated fields of a key, as one value with vector arithmetic.
struct Sample {
  glm::dvec3 position;
  glm::dvec4 rotation;
  double fovY;
};
Sample operator+(const Sample& a, const Sample& b) {
  return {a.position + b.position, a.rotation + b.rotation, a.fovY + b.fovY};
}
Sample operator*(double s, const Sample& a) {
  return {s * a.position, s * a.rotation, s * a.fovY};
}
Sample operator-(const Sample& a, const Sample& b) {
  return a + -1.0 * b;
}

Sample sampleOf(const CameraKey& key) {
  return {key.position, {key.rotation.x, key.rotation.y, key.rotation.z, key.rotation.w}, key.fovY};
}

// q and −q are the same rotation; chooses the sign that is nearer to the previous sample.
Sample alignedTo(const Sample& last, Sample sample) {
  if (glm::dot(last.rotation, sample.rotation) < 0.0) sample.rotation = -sample.rotation;
  return sample;
}

Sample tangent(const Sample& before, const Sample& at, const Sample& after, double stepBefore, double stepAfter) {
  const Sample in = (1.0 / stepBefore) * (at - before), out = (1.0 / stepAfter) * (after - at);
  return (1.0 / (stepBefore + stepAfter)) * (stepAfter * in + stepBefore * out);
}

}  // namespace

Camera cameraAt(const CameraPath& path, double time) {
  assert(!path.keys.empty());
  const auto& keys = path.keys;
  time = std::clamp(time, keys.front().time, keys.back().time);
  const auto after =
      std::upper_bound(keys.begin() + 1, keys.end(), time, [](double t, const CameraKey& key) { return t < key.time; });
  Sample sample = sampleOf(keys.front());
  if (keys.size() > 1) {
    const auto i = std::min(std::size_t(after - keys.begin()), keys.size() - 1) - 1;
    const auto step = [&](std::size_t from) { return keys[from + 1].time - keys[from].time; };
    const Sample from = sampleOf(keys[i]), to = alignedTo(from, sampleOf(keys[i + 1]));
    const Sample chord = (1.0 / step(i)) * (to - from);
    const Sample leave =
        i == 0 ? chord : tangent(alignedTo(from, sampleOf(keys[i - 1])), from, to, step(i - 1), step(i));
    const Sample arrive =
        i + 2 == keys.size() ? chord : tangent(from, to, alignedTo(to, sampleOf(keys[i + 2])), step(i), step(i + 1));
    const double u = (time - keys[i].time) / step(i), u2 = u * u, u3 = u2 * u;
    sample = (2 * u3 - 3 * u2 + 1) * from + ((u3 - 2 * u2 + u) * step(i)) * leave + (3 * u2 - 2 * u3) * to +
             ((u3 - u2) * step(i)) * arrive;
    // The spline must not overshoot the keys' fields of view.
    sample.fovY = std::clamp(sample.fovY, std::min(from.fovY, to.fovY), std::max(from.fovY, to.fovY));
  }
  const glm::dvec4 q = sample.rotation;
  return {pinholeFromFov(path.width, path.height, sample.fovY),
          {sample.position, unitRotation(glm::dquat(q.w, q.x, q.y, q.z))}};
}

std::vector<View> frames(const CameraPath& path) {
  const double duration = path.keys.back().time - path.keys.front().time;
  // The tolerance keeps the last key as a frame if duration × fps is a rounding error below a whole number.
  const auto count = std::size_t(std::floor(duration * path.fps + 1e-6)) + 1;
  std::vector<View> views(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double time = path.keys.front().time + double(i) / path.fps;
    views[i] = {fmt::format("frame_{:04}", i), cameraAt(path, time), time};
  }
  return views;
}

}  // namespace ibr::app
