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
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "author/depth/photograph_depth.h"
#include "author/geometry/posed_model.h"
#include "author/jobs/build_jobs.h"
#include "author/photographs/photographs.h"
#include "ibr/capture.h"

namespace ibr {

/// A point that two photographs show.
struct ExposureMatch {
  std::uint32_t first = 0, second = 0;       // photographs, different
  glm::dvec3 ratio{0};                       // log of the linear light of the first over that of the second: R, G, B
  double deviation = 1;                      // one standard deviation of it, > 0
  double firstRadius = 0, secondRadius = 0;  // vignettingRadius
};

/// What overlaps say (author/exposure/exposure_overlap.h), and of photographs that these do not join the model's
/// tracks: means of linear light over small windows, where nothing is clipped or masked. `model` and `depths`: of these
/// photographs, in their order. Throws Error{cancelled}, and what reading a photograph throws.
std::vector<ExposureMatch> exposureMatches(const std::vector<Photograph>& photographs, const PosedModel& model,
                                           const std::vector<PhotographDepth>& depths, const BuildJobs& jobs);

struct Exposures {
  std::vector<glm::dvec3> gains;  // one a photograph: each times it, in linear light, is as the others are
  std::size_t measured = 0;       // photographs that matches join to others
  std::size_t parts = 0;          // of these, that no match joins to each other
  bool alike = false;             // no gain that was measured is 1 % off, so that all are 1
};

/// EXIF, where it is given for every photograph, helps where matches are few: it knows exposures to about a third of a
/// stop. What of it or of a match is not finite says nothing.
Exposures solveExposures(std::size_t photographs, const std::vector<ExposureMatch>& matches,
                         const std::vector<CaptureFacts>& exif = {});

/// How far apart they are, for people.
std::string describedExposures(const Exposures& exposures);

/// Coefficients of each photograph (author/exposure/vignetting.h), from the same matches; matches are of all colours
/// alike. `lenses`: of each photograph its lens's number, from 0.
std::vector<glm::dvec2> solveVignetting(std::size_t photographs, const std::vector<ExposureMatch>& matches,
                                        const std::vector<std::uint32_t>& lenses);

/// As photographs without it would have matched.
std::vector<ExposureMatch> withoutVignetting(std::vector<ExposureMatch> matches,
                                             const std::vector<glm::dvec2>& vignetting);

}  // namespace ibr
