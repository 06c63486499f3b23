// SPDX-License-Identifier: Apache-2.0
// One entry of advice, and the parts that all entries share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "ibr/advice.h"

namespace ibr {

inline constexpr double kNoAdviceValue =
    std::numeric_limits<double>::quiet_NaN();  // Advice::value of kinds without one
inline constexpr double kMaxTurnDegrees = 30;  // maximum angle between viewing directions of successive photographs

inline const std::string& nodeName(const Scene& scene, std::uint32_t node) {
  return scene.nodes[node].name;
}

/// Returns an entry whose photographs are sorted by name. `nodes`: indices into Scene::nodes.
inline Advice adviceEntry(const Scene& scene, AdviceKind kind, Severity severity, std::vector<std::uint32_t> nodes,
                          double value, std::string problem, std::string remedy) {
  std::ranges::sort(nodes, {}, [&](std::uint32_t i) -> const std::string& { return nodeName(scene, i); });
  return {kind, severity, std::move(problem), std::move(remedy), std::move(nodes), value};
}

/// Returns a share, 0 to 1, as a rounded percentage.
inline int roundedPercent(double share) {
  return int(std::lround(100 * share));
}

}  // namespace ibr
