// SPDX-License-Identifier: Apache-2.0
// How each photograph was exposed and white-balanced, from what photographs show of the same points (ALGORITHMS §4.5).
//
// A camera turns the light L of a point into e_n·L, a factor e_n for each photograph n and channel. Two photographs
// that show the point say log e_a − log e_b = d, whatever L is. All of that is solved at once for log gains x_n = −log
// e_n, by least squares that are weighted anew until they hold: first for the least sum of absolute residuals, then
// with weights that fall to nothing (Tukey's), so that what moved, shines or was matched wrongly does not count.
//
// Gauge: photographs that are joined by matches have log gains of mean 0, so that a whole scene becomes neither
// brighter nor tinted. Parts of a scene that no match joins each keep their own mean, since no picture shows them side
// by side. A photograph without matches has a gain of 1, or what its EXIF says it has in relation to other photographs
// of its camera.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "author/build_jobs.h"
#include "author/photographs.h"
#include "ibr/capture.h"
#include "ibr/scene.h"

namespace ibr {

/// A point that two photographs show.
struct ExposureMatch {
  std::uint32_t first = 0, second = 0;  // photographs, different
  glm::dvec3 ratio{0};                  // log of the linear light of the first over that of the second: R, G, B
  double deviation = 1;                 // one standard deviation of it, > 0
};

/// What the cells' vertices of tier 0 say, at most 1000 a cell, and the model's tracks, which also join photographs
/// that no cell does: means of linear light over small windows, where nothing is clipped. `model`: of these
/// photographs. Throws Error{cancelled}, and what reading a photograph throws.
std::vector<ExposureMatch> exposureMatches(const std::vector<Photograph>& photographs, const PosedModel& model,
                                           const std::vector<Cell>& cells, const BuildJobs& jobs);

/// Gains, one a photograph: each times the photograph, in linear light, is as the others are. EXIF, where it is given
/// for every photograph, helps where matches are few: it knows exposures to about a third of a stop.
std::vector<glm::dvec3> solveExposures(std::size_t photographs, const std::vector<ExposureMatch>& matches,
                                       const std::vector<CaptureFacts>& exif = {});

/// How far apart they are, for people.
std::string describedGains(const std::vector<glm::dvec3>& gains);

/// Both.
std::vector<glm::dvec3> exposureGains(const std::vector<Photograph>& photographs, const PosedModel& model,
                                      const std::vector<Cell>& cells, const BuildJobs& jobs);

}  // namespace ibr
