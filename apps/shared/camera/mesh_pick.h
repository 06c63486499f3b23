// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ibr/htm_model.h"

namespace ibr::app {

/// The nearest point of a mesh before an eye in a direction (world; of any length but 0), its front or its back;
/// nullopt where there is none.
std::optional<glm::dvec3> pickedPoint(const TriangleMesh& mesh, glm::dvec3 eye, glm::dvec3 direction);

}  // namespace ibr::app
