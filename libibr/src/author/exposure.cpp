// SPDX-License-Identifier: Apache-2.0
#include "author/exposure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>

#include "author/posed_model.h"

namespace ibr {
namespace {

constexpr int kAbsoluteRounds = 30, kTukeyRounds = 30;
constexpr double kTukey = 4.685;           // standard deviations beyond which nothing counts
constexpr double kLeastDeviation = 0.005;  // of residuals, in units of what matches say of themselves
constexpr double kExifDeviation = 0.2;     // of log exposure: thirds of a stop, and shutters' tolerance
constexpr double kRidge = 1e-10;           // of the mean weight, on what nothing holds
constexpr std::size_t kEnough = 8;         // matches, to join two photographs

// x[second] − x[first] = difference.
struct Relation {
  std::size_t first, second;
  glm::dvec3 difference;
  double deviation;
};

// Which of `count` are joined by relations: the least index of each one's part.
class Parts {
 public:
  explicit Parts(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t(0)); }
  std::size_t of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = of(a), b = of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

using Logs = std::vector<glm::dvec3>;

double residualOf(const Relation& r, const Logs& x) {
  return glm::length(x[r.second] - x[r.first] - r.difference) / (std::sqrt(3.0) * r.deviation);
}

// The minimum of Σ weight·|x[second] − x[first] − difference|²; the three channels share one matrix.
Logs solved(const std::vector<Relation>& relations, const std::vector<double>& weights, std::size_t count) {
  const int n = int(count);
  cv::Mat matrix = cv::Mat::zeros(n, n, CV_64F), side = cv::Mat::zeros(n, 3, CV_64F), x;
  double total = 0;
  for (std::size_t k = 0; k < relations.size(); ++k) {
    const Relation& r = relations[k];
    const int a = int(r.first), b = int(r.second);
    const double w = weights[k];
    total += w;
    matrix.at<double>(a, a) += w;
    matrix.at<double>(b, b) += w;
    matrix.at<double>(a, b) -= w;
    matrix.at<double>(b, a) -= w;
    for (int c = 0; c < 3; ++c) {
      side.at<double>(b, c) += w * r.difference[c];
      side.at<double>(a, c) -= w * r.difference[c];
    }
  }
  for (int i = 0; i < n; ++i) matrix.at<double>(i, i) += kRidge * total / double(n) + 1e-300;
  Logs logs(count, glm::dvec3(0.0));
  if (!cv::solve(matrix, side, x, cv::DECOMP_CHOLESKY)) return logs;
  for (int i = 0; i < n; ++i) logs[std::size_t(i)] = {x.at<double>(i, 0), x.at<double>(i, 1), x.at<double>(i, 2)};
  return logs;
}

Logs robustlySolved(const std::vector<Relation>& relations, std::size_t count) {
  std::vector<double> weights, residuals(relations.size());
  for (const Relation& r : relations) weights.push_back(1 / (r.deviation * r.deviation));
  const std::vector<double> plain = weights;
  Logs x = solved(relations, weights, count);
  const auto again = [&](auto&& weightOf) {
    for (std::size_t k = 0; k < relations.size(); ++k) residuals[k] = residualOf(relations[k], x);
    std::vector<double> sorted = residuals;
    const double scale = std::max(kLeastDeviation, 1.4826 * median(sorted));
    for (std::size_t k = 0; k < relations.size(); ++k) weights[k] = plain[k] * weightOf(residuals[k], scale);
    x = solved(relations, weights, count);
  };
  for (int round = 0; round < kAbsoluteRounds; ++round)
    again([](double r, double) { return 1 / std::max(r, 0.1 * kLeastDeviation); });
  for (int round = 0; round < kTukeyRounds; ++round)
    again([](double r, double scale) {
      const double share = r / (kTukey * scale);
      return share < 1 ? (1 - share * share) * (1 - share * share) : 0.0;
    });
  return x;
}

// Pairs of photographs that few points join say too little.
std::vector<Relation> relationsOf(const std::vector<ExposureMatch>& matches) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> count;
  const auto pairOf = [](const ExposureMatch& m) { return std::minmax(m.first, m.second); };
  for (const ExposureMatch& m : matches) ++count[pairOf(m)];
  std::vector<Relation> relations;
  for (const ExposureMatch& m : matches)
    if (count[pairOf(m)] >= kEnough) relations.push_back({m.first, m.second, m.ratio, m.deviation});
  return relations;
}

std::string cameraOf(const CaptureFacts& exif) {
  return exif.maker + '\n' + exif.model;
}

// What EXIF says of photographs that nothing else is known of: log gain + log exposure is the same for all of a camera.
void completeByExif(const std::vector<CaptureFacts>& exif, const std::vector<bool>& known, Logs& x) {
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

std::string describedGains(const std::vector<glm::dvec3>& gains) {
  double least = 1, most = 1, tint = 1;
  std::size_t known = 0;
  for (const glm::dvec3& g : gains) {
    known += g != glm::dvec3(1.0);
    least = std::min(least, g.g);
    most = std::max(most, g.g);
    tint = std::max({tint, g.r / g.g, g.g / g.r, g.b / g.g, g.g / g.b});
  }
  if (known == 0) return "exposures were not measured: no matches tell them";
  return fmt::format("exposures of {} of {} photographs measured: {:.2f} stops apart, white balance within {:.1f} %",
                     known, gains.size(), std::log2(most / least), 100 * (tint - 1));
}

std::vector<glm::dvec3> solveExposures(std::size_t photographs, const std::vector<ExposureMatch>& matches,
                                       const std::vector<CaptureFacts>& exif) {
  std::vector<Relation> relations = relationsOf(matches);
  Parts parts(photographs);
  std::vector<bool> known(photographs, false);
  for (const Relation& r : relations) {
    parts.join(r.first, r.second);
    known[r.first] = known[r.second] = true;
  }
  // Each camera of each part adds an unknown: what its log gain and log exposure sum up to.
  std::size_t count = photographs;
  std::map<std::pair<std::size_t, std::string>, std::size_t> cameras;
  for (std::size_t n = 0; n < std::min(exif.size(), photographs); ++n)
    if (const auto exposure = relativeExposure(exif[n]); exposure && known[n]) {
      const auto [camera, isNew] = cameras.emplace(std::pair(parts.of(n), cameraOf(exif[n])), count);
      count += isNew;
      relations.push_back({n, camera->second, glm::dvec3(std::log(*exposure)), kExifDeviation});
    }
  std::vector<glm::dvec3> gains(photographs, glm::dvec3(1.0));
  Logs x(photographs, glm::dvec3(0.0));
  if (!relations.empty()) {
    x = robustlySolved(relations, count);
    x.resize(photographs);
  }
  std::map<std::size_t, std::pair<glm::dvec3, double>> means;
  for (std::size_t n = 0; n < photographs; ++n) {
    auto& [sum, members] = means[parts.of(n)];
    sum += x[n];
    ++members;
  }
  for (std::size_t n = 0; n < photographs; ++n) {
    const auto& [sum, members] = means[parts.of(n)];
    x[n] -= sum / members;
  }
  if (exif.size() == photographs) completeByExif(exif, known, x);
  for (std::size_t n = 0; n < photographs; ++n)
    gains[n] = glm::clamp(glm::exp(x[n]), glm::dvec3(1 / kLargestGain), glm::dvec3(kLargestGain));
  return gains;
}

}  // namespace ibr
