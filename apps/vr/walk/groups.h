// SPDX-License-Identifier: Apache-2.0
// Which points are at one place.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace ibr::app {

/// Indices of points that share a place (spots.h, spotsOf), each group ascending, groups by their first. Points that
/// are not finite are each alone.
std::vector<std::vector<std::uint32_t>> groupsOf(const std::vector<glm::dvec3>& points);

}  // namespace ibr::app
