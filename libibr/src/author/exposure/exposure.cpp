// SPDX-License-Identifier: Apache-2.0
#include "author/exposure/exposure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>

#include "author/exposure/vignetting.h"
#include "author/geometry/disjoint_sets.h"
#include "author/geometry/posed_model.h"

namespace ibr {
namespace {

constexpr int kAbsoluteRounds = 30, kTukeyRounds = 30;
constexpr double kConvergedChange = 1e-7;      // change of all logs below which iteration stops
constexpr double kTukeyConstant = 4.685;       // standard deviations; residuals beyond have weight 0
constexpr double kMinDeviation = 0.005;        // of residuals, relative to the matches' own deviations
constexpr double kExifDeviation = 0.2;         // of log exposure: thirds of a stop, and shutters' tolerance
constexpr double kLensDeviation = 1;           // prior of a lens's coefficients around 0
constexpr double kRidge = 1e-10;               // regularises unconstrained unknowns, relative to the mean weight
constexpr std::size_t kMinPairMatches = 8;     // matches needed to connect two photographs
constexpr double kMaxNeutralDeviation = 0.01;  // gains this near to 1 change no value by more than one 8-bit level

// Linear equation: Σ factor·x[at] = difference, over the first `terms` entries.
struct Relation {
  std::array<std::uint32_t, 6> at{};
  std::array<float, 6> factor{};
  std::uint32_t terms = 0;
  glm::dvec3 difference{0.0};
  double deviation = 1;

  void add(std::size_t unknown, double f) {
    at[terms] = std::uint32_t(unknown);
    factor[terms++] = float(f);
  }
};

using Logs = std::vector<glm::dvec3>;

double residualOf(const Relation& r, const Logs& x) {
  glm::dvec3 sum = -r.difference;
  for (std::size_t k = 0; k < r.terms; ++k) sum += double(r.factor[k]) * x[r.at[k]];
  return glm::length(sum) / (std::sqrt(3.0) * r.deviation);
}

// Minimises Σ weight·|Σ factor·x − difference|²; the three channels share one matrix.
Logs solved(const std::vector<Relation>& relations, const std::vector<double>& weights, std::size_t count) {
  const int n = int(count);
  cv::Mat matrix = cv::Mat::zeros(n, n, CV_64F), side = cv::Mat::zeros(n, 3, CV_64F), x;
  double total = 0;
  for (std::size_t k = 0; k < relations.size(); ++k) {
    const Relation& r = relations[k];
    total += weights[k];
    for (std::size_t i = 0; i < r.terms; ++i) {
      const double w = weights[k] * double(r.factor[i]);
      for (std::size_t j = 0; j < r.terms; ++j)
        matrix.at<double>(int(r.at[i]), int(r.at[j])) += w * double(r.factor[j]);
      for (int c = 0; c < 3; ++c) side.at<double>(int(r.at[i]), c) += w * r.difference[c];
    }
  }
  for (int i = 0; i < n; ++i) matrix.at<double>(i, i) += kRidge * total / double(n) + 1e-300;
  Logs logs(count, glm::dvec3(0.0));
  if (!cv::solve(matrix, side, x, cv::DECOMP_CHOLESKY)) return logs;
  for (int i = 0; i < n; ++i) logs[std::size_t(i)] = {x.at<double>(i, 0), x.at<double>(i, 1), x.at<double>(i, 2)};
  return logs;
}

double maxChange(const Logs& a, const Logs& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, glm::length(a[i] - b[i]));
  return most;
}

Logs robustlySolved(const std::vector<Relation>& relations, std::size_t count) {
  std::vector<double> weights, residuals(relations.size());
  for (const Relation& r : relations) weights.push_back(1 / (r.deviation * r.deviation));
  const std::vector<double> plain = weights;
  Logs x = solved(relations, weights, count);
  const auto rounds = [&](int most, auto&& weightOf) {
    for (int round = 0; round < most; ++round) {
      for (std::size_t k = 0; k < relations.size(); ++k) residuals[k] = residualOf(relations[k], x);
      std::vector<double> sorted = residuals;
      const double scale = std::max(kMinDeviation, 1.4826 * median(sorted));
      for (std::size_t k = 0; k < relations.size(); ++k) weights[k] = plain[k] * weightOf(residuals[k], scale);
      const Logs before = std::exchange(x, solved(relations, weights, count));
      if (maxChange(before, x) < kConvergedChange) return;
    }
  };
  rounds(kAbsoluteRounds, [](double r, double) { return 1 / std::max(r, 0.1 * kMinDeviation); });
  rounds(kTukeyRounds, [](double r, double scale) {
    const double share = r / (kTukeyConstant * scale);
    return share < 1 ? (1 - share * share) * (1 - share * share) : 0.0;
  });
  return x;
}

// Indices of usable matches: finite ones, of pairs of photographs with at least kMinPairMatches matches.
std::vector<std::uint32_t> usableMatches(const std::vector<ExposureMatch>& matches) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> count;
  const auto pairOf = [](const ExposureMatch& m) { return std::minmax(m.first, m.second); };
  const auto isUsable = [](const ExposureMatch& m) {
    return std::isfinite(glm::dot(m.ratio, m.ratio)) && std::isfinite(m.deviation) && m.deviation > 0;
  };
  for (const ExposureMatch& m : matches) count[pairOf(m)] += isUsable(m);
  std::vector<std::uint32_t> counting;
  for (std::uint32_t k = 0; k < matches.size(); ++k)
    if (isUsable(matches[k]) && count[pairOf(matches[k])] >= kMinPairMatches) counting.push_back(k);
  return counting;
}

Relation relationOf(const ExposureMatch& m) {
  Relation r;
  r.add(m.second, 1);
  r.add(m.first, -1);
  r.difference = m.ratio;
  r.deviation = m.deviation;
  return r;
}

std::string cameraOf(const CaptureMetadata& exif) {
  return exif.maker + '\n' + exif.model;
}

// Sets unmeasured gains from EXIF data: log gain + log exposure is the same for all photographs of a camera.
void completeByExif(const std::vector<CaptureMetadata>& exif, const std::vector<bool>& known, Logs& x) {
  std::map<std::string, std::pair<glm::dvec3, double>> sums;
  for (std::size_t n = 0; n < exif.size(); ++n)
    if (const auto exposure = relativeExposure(exif[n]); exposure && known[n]) {
      auto& [sum, count] = sums[cameraOf(exif[n])];
      sum += x[n] + std::log(*exposure);
      ++count;
    }
  for (std::size_t n = 0; n < exif.size(); ++n) {
    const auto exposure = relativeExposure(exif[n]);
    const auto camera = sums.find(cameraOf(exif[n]));
    if (!known[n] && exposure && camera != sums.end())
      x[n] = camera->second.first / camera->second.second - std::log(*exposure);
  }
}

}  // namespace

std::string describeExposures(const Exposures& exposures) {
  if (exposures.measured == 0) return "exposures were not measured: no usable matches between photographs";
  double least = 1, most = 1, tint = 1;
  for (const glm::dvec3& g : exposures.gains) {
    least = std::min(least, g.g);
    most = std::max(most, g.g);
    tint = std::max({tint, g.r / g.g, g.g / g.r, g.b / g.g, g.g / g.b});
  }
  std::string text =
      fmt::format("exposures of {} of {} photographs measured: ", exposures.measured, exposures.gains.size());
  text +=
      exposures.alike
          ? fmt::format("all are alike within {:.0f} %, so no gains are stored", 100 * kMaxNeutralDeviation)
          : fmt::format("{:.2f} stops apart, white balance within {:.1f} %", std::log2(most / least), 100 * (tint - 1));
  if (exposures.parts > 1)
    text += fmt::format("; {} parts without common matches, each keeps its mean brightness", exposures.parts);
  return text;
}

std::vector<glm::dvec2> solveVignetting(std::size_t photographs, const std::vector<ExposureMatch>& matches,
                                        const std::vector<std::uint32_t>& lenses) {
  std::vector<glm::dvec2> vignetting(photographs, glm::dvec2(0.0));
  const std::vector<std::uint32_t> counting = usableMatches(matches);
  if (counting.empty()) return vignetting;
  const auto unknown = [&](std::uint32_t photograph, std::size_t k) {
    return photographs + 2 * lenses[photograph] + k;
  };
  const std::size_t lensCount = std::size_t(*std::ranges::max_element(lenses)) + 1;
  std::vector<Relation> relations;
  for (const std::uint32_t k : counting) {
    const ExposureMatch& m = matches[k];
    Relation r = relationOf(m);
    const double a = m.firstRadius * m.firstRadius, b = m.secondRadius * m.secondRadius;
    r.add(unknown(m.first, 0), a);
    r.add(unknown(m.first, 1), a * a);
    r.add(unknown(m.second, 0), -b);
    r.add(unknown(m.second, 1), -b * b);
    relations.push_back(r);
  }
  for (std::size_t u = photographs; u < photographs + 2 * lensCount; ++u) {
    Relation r;
    r.add(u, 1);
    r.deviation = kLensDeviation;
    relations.push_back(r);
  }
  const Logs x = robustlySolved(relations, photographs + 2 * lensCount);
  // Lens and aperture darken all colours alike, so the least-squares solution for all three is their mean.
  const auto mean = [](const glm::dvec3& v) { return (v.r + v.g + v.b) / 3; };
  for (std::uint32_t n = 0; n < photographs; ++n) vignetting[n] = {mean(x[unknown(n, 0)]), mean(x[unknown(n, 1)])};
  return vignetting;
}

std::vector<ExposureMatch> withoutVignetting(std::vector<ExposureMatch> matches,
                                             const std::vector<glm::dvec2>& vignetting) {
  for (ExposureMatch& m : matches)
    m.ratio -= glm::dvec3(logVignetting(vignetting[m.first], m.firstRadius) -
                          logVignetting(vignetting[m.second], m.secondRadius));
  return matches;
}

Exposures solveExposures(std::size_t photographs, const std::vector<ExposureMatch>& matches,
                         const std::vector<CaptureMetadata>& exif) {
  std::vector<Relation> relations;
  DisjointSets parts(photographs);
  std::vector<bool> known(photographs, false);
  for (const std::uint32_t k : usableMatches(matches)) {
    const ExposureMatch& m = matches[k];
    relations.push_back(relationOf(m));
    parts.unite(m.first, m.second);
    known[m.first] = known[m.second] = true;
  }
  // Each camera of each part adds an unknown: the constant sum of its log gain and log exposure.
  std::size_t count = photographs;
  std::map<std::pair<std::size_t, std::string>, std::size_t> cameras;
  for (std::size_t n = 0; n < std::min(exif.size(), photographs); ++n)
    if (const auto exposure = relativeExposure(exif[n]); exposure && known[n]) {
      const auto [camera, isNew] = cameras.emplace(std::pair(parts.find(std::uint32_t(n)), cameraOf(exif[n])), count);
      count += isNew;
      Relation r;
      r.add(camera->second, 1);
      r.add(n, -1);
      r.difference = glm::dvec3(std::log(*exposure));
      r.deviation = kExifDeviation;
      relations.push_back(r);
    }
  Logs x(photographs, glm::dvec3(0.0));
  if (!relations.empty()) {
    x = robustlySolved(relations, count);
    x.resize(photographs);
  }
  std::map<std::size_t, std::pair<glm::dvec3, double>> means;
  for (std::size_t n = 0; n < photographs; ++n) {
    auto& [sum, members] = means[parts.find(std::uint32_t(n))];
    sum += x[n];
    ++members;
  }
  Exposures exposures;
  for (const auto& [part, mean] : means) exposures.parts += known[part];
  for (std::size_t n = 0; n < photographs; ++n) {
    const auto& [sum, members] = means[parts.find(std::uint32_t(n))];
    x[n] -= sum / members;
    exposures.measured += known[n];
  }
  if (exif.size() == photographs) completeByExif(exif, known, x);
  exposures.alike = std::ranges::all_of(x, [](const glm::dvec3& log) {
    return glm::all(glm::lessThan(glm::abs(log), glm::dvec3(kMaxNeutralDeviation)));
  });
  for (std::size_t n = 0; n < photographs; ++n)
    exposures.gains.push_back(
        exposures.alike ? glm::dvec3(1.0) : glm::clamp(glm::exp(x[n]), glm::dvec3(1 / kMaxGain), glm::dvec3(kMaxGain)));
  return exposures;
}

}  // namespace ibr
