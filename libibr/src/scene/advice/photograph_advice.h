// SPDX-License-Identifier: Apache-2.0
// Advice about single photographs: repeated, of another exposure, hardly matched, with an inaccurate pose, or unused.
// Blurred photographs are in sharpness_advice.h.
#pragma once

#include <vector>

#include "ibr/advice.h"
#include "scene/advice/capture_facts.h"

namespace ibr {

/// AdviceKind::twice: photographs with the site and the viewing direction of another.
std::vector<Advice> twiceAdvice(const CaptureFacts& facts);

/// AdviceKind::exposure: photographs whose exposure is more than a stop from the median of their neighbours. Judges
/// the gains that make photographs alike: stored data, not displayed colours.
std::vector<Advice> exposureAdvice(const CaptureFacts& facts);

/// AdviceKind::unmatched: photographs of which a far smaller share matches others than of their neighbours.
std::vector<Advice> matchAdvice(const CaptureFacts& facts);

/// AdviceKind::pose: one entry if the cells' residuals are typically large; else one for each photograph whose cells
/// all have large residuals.
std::vector<Advice> poseAdvice(const Scene& scene);

/// AdviceKind::unused: one entry for each of Scene::unusedPhotographs.
std::vector<Advice> unusedAdvice(const Scene& scene);

}  // namespace ibr
