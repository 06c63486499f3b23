// SPDX-License-Identifier: Apache-2.0
// Advice about capture sites: groups without connection, distances between neighbours, missing viewing directions, and
// the shape of all sites together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ibr/advice.h"
#include "scene/advice/capture_facts.h"
#include "scene/advice/walk_estimate.h"

namespace ibr {

/// AdviceKind::tooFew or AdviceKind::turned: one entry if the scene has fewer than two photographs, one capture site
/// or no cells; else empty. Other functions of this header require that the result is empty.
std::vector<Advice> tooFewAdvice(const CaptureFacts& facts);

/// AdviceKind::apart: one entry for each group of sites with photographs in cells, except the group with most of them.
std::vector<Advice> apartAdvice(const CaptureFacts& facts);

/// Photographs to take between two neighbouring sites.
struct LinkRemedy {
  std::size_t advice;  // index into LinkAdvice::advice
  SiteLink link;
  std::uint32_t i, j;  // nodes at the link's ends a and b
  std::size_t count;   // number of photographs to take
};
struct LinkAdvice {
  std::vector<Advice> advice;
  std::vector<LinkRemedy> remedies;
};

/// AdviceKind::hole and AdviceKind::wide: neighbouring sites of one group between which `walk` shows too little.
LinkAdvice linkAdvice(const CaptureFacts& facts, const WalkEstimate& walk);

/// Returns the text of a remedy for up to two photographs that repeats the chosen next-best views on the link: the
/// estimate may prefer thirds of the link to its middle. nullopt if no view lies on the link, or for more photographs.
std::optional<std::string> linkRemedyText(const CaptureFacts& facts, const LinkRemedy& remedy,
                                          std::span<const NextView> views);

/// AdviceKind::direction: sites that lack a viewing direction that at least two of their neighbours have.
std::vector<Advice> directionAdvice(const CaptureFacts& facts, const WalkEstimate& walk);

/// AdviceKind::row: one entry if all sites lie in one row; else empty.
std::vector<Advice> rowAdvice(const CaptureFacts& facts);

}  // namespace ibr
