// SPDX-License-Identifier: Apache-2.0
// Clears the targets of a plan that the renderer does not support.
#pragma once

#include <glm/vec3.hpp>

#include "ibr/target.h"

namespace ibr {

/// Colour becomes the display-encoded background with alpha 1, depth becomes far. initialUse → finalUse.
void clearTarget(VkCommandBuffer commands, const Target& target, glm::vec3 background) noexcept;

/// Clears to the values that BufferTargets documents for empty pixels.
void clearTargets(VkCommandBuffer commands, const BufferTargets& targets) noexcept;

}  // namespace ibr
