// SPDX-License-Identifier: Apache-2.0
// Groups points by capture site.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace ibr::app {

/// Returns indices of points that share a capture site (spotsOf in spots.h): each group ascending, groups ordered by
/// their first index. A point that is not finite is alone in its group.
std::vector<std::vector<std::uint32_t>> groupsOf(const std::vector<glm::dvec3>& points);

}  // namespace ibr::app
