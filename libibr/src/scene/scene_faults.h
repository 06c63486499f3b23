// SPDX-License-Identifier: Apache-2.0
// Checks of untrusted data, for validate().
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "ibr/scene.h"

namespace ibr {

inline bool finite(glm::dvec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Maximum coordinate, world units. Larger than any distance on Earth; products of three lengths stay finite in single
/// precision.
inline constexpr double kWorldRadius = 1e12;

inline bool withinWorld(glm::dvec3 v) {
  return std::abs(v.x) <= kWorldRadius && std::abs(v.y) <= kWorldRadius && std::abs(v.z) <= kWorldRadius;
}

/// Collects faults up to a limit.
class Faults {
 public:
  explicit Faults(std::size_t limit) : limit_(limit) {}
  bool full() const { return list_.size() >= limit_; }
  template <class... Args>
  void add(std::string field, fmt::format_string<Args...> format, Args&&... args) {
    if (!full()) list_.push_back({std::move(field), fmt::format(format, std::forward<Args>(args)...)});
  }
  std::vector<Fault> take() { return std::move(list_); }

 private:
  std::size_t limit_;
  std::vector<Fault> list_;
};

/// Returns the faults that validate() returns. A requested stop throws Error{cancelled} before the next photograph or
/// cell.
std::vector<Fault> faultsOf(const Scene& scene, std::size_t limit, const std::stop_token& stop);

/// Adds faults of size, intrinsics and pose; `at` is the field that holds the camera.
void checkCamera(const Camera& camera, const std::string& at, Faults& faults);

}  // namespace ibr
