// SPDX-License-Identifier: Apache-2.0
// Chooses the set of photographs that covers the view best: greedily, then by exchanges. Pure.
#pragma once

#include <cstddef>
#include <memory_resource>
#include <span>
#include <vector>

#include "render/photographs/photograph_values.h"

namespace ibr {

struct SetMember {
  std::size_t photograph = 0;  // index in the pool
  float weight = 1;            // 0 … 1: 0 where an outsider would do as well
};

/// Returns at most `count` photographs of the pool, ascending. First the photograph that adds most to
/// F(S) = coverage of the set's sum is taken until the set is complete or nothing adds. Then the exchange of a member
/// for an outsider that adds most is made, at most 2 × count times, while F grows by more than rounding.
///
/// Gains of photographs that cannot be the largest are not computed: F is concave, so slopes and previous gains bound
/// them. The result is that of computing them all.
std::pmr::vector<SetMember> bestSet(std::span<const SampleValues* const> pool, std::size_t count,
                                    std::pmr::memory_resource* memory);

}  // namespace ibr
