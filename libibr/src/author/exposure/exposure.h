// SPDX-License-Identifier: Apache-2.0
// Measures how each photograph was exposed and white-balanced, from points that several photographs show.
//
// A camera maps the light L of a point to e_n·L, with a factor e_n for each photograph n and channel. Two photographs
// of a point give log e_a − log e_b = d, whatever L is. All log gains x_n = −log e_n are solved at once by iteratively
// reweighted least squares: first for the least sum of absolute residuals, then with Tukey's weights, which exclude
// moving objects, highlights and wrong matches.
//
// Gauge: connected photographs have log gains of mean 0, so that a scene becomes neither brighter nor tinted. Parts of
// a scene without common matches each keep their own mean, since no image shows them together. A photograph without
// matches has a gain of 1, or one derived from its EXIF data relative to other photographs of its camera.
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
  glm::dvec3 ratio{0};                       // log of the first's linear light over that of the second: R, G, B
  double deviation = 1;                      // standard deviation of `ratio`, > 0
  double firstRadius = 0, secondRadius = 0;  // vignettingRadius
};

/// Matches of overlaps (author/exposure/exposure_overlap.h) and, for photographs that these leave unconnected, of
/// tracks: means of linear light over small windows without clipped or masked pixels. `model` and `depths`: of these
/// photographs, in their order. Throws Error{cancelled}, and what reading a photograph throws.
std::vector<ExposureMatch> exposureMatches(const std::vector<Photograph>& photographs, const PosedModel& model,
                                           const std::vector<PhotographDepth>& depths, const BuildJobs& jobs);

struct Exposures {
  std::vector<glm::dvec3> gains;  // by photograph: linear light times the gain is comparable
  std::size_t measured = 0;       // photographs that matches connect to others
  std::size_t parts = 0;          // groups of measured photographs that no match connects
  bool alike = false;             // all gains are within 1 % of 1, and are set to 1
};

/// Solves all gains. EXIF data of every photograph helps where matches are few; its exposures are accurate to about a
/// third of a stop. Values of matches or EXIF data that are not finite are ignored.
Exposures solveExposures(std::size_t photographs, const std::vector<ExposureMatch>& matches,
                         const std::vector<CaptureMetadata>& exif = {});

/// Describes how far the exposures are apart, for people.
std::string describeExposures(const Exposures& exposures);

/// Vignetting coefficients of each photograph (author/exposure/vignetting.h), from the same matches; one result for all
/// colours. `lenses`: index of each photograph's lens, from 0.
std::vector<glm::dvec2> solveVignetting(std::size_t photographs, const std::vector<ExposureMatch>& matches,
                                        const std::vector<std::uint32_t>& lenses);

/// The matches that photographs without vignetting would give.
std::vector<ExposureMatch> withoutVignetting(std::vector<ExposureMatch> matches,
                                             const std::vector<glm::dvec2>& vignetting);

}  // namespace ibr
