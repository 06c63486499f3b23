// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ibr/htm_model.h"

namespace ibr::app {

/// Returns the nearest intersection of a ray with a mesh, world axes; both sides of a triangle count. `direction` may
/// have any length but 0. nullopt: the ray misses the mesh.
std::optional<glm::dvec3> pickedPoint(const TriangleMesh& mesh, glm::dvec3 eye, glm::dvec3 direction);

}  // namespace ibr::app
