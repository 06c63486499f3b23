// SPDX-License-Identifier: Apache-2.0
#include "scene/picture_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "ibr/error.h"
#include "image/ktx2.h"
#include "image/sharpness.h"
#include "image/srgb.h"

namespace ibr {
namespace {

constexpr int kSharpnessSide = 1600, kExposureSide = 512;  // px, the longer side at most
constexpr int kDarkest = 8, kBrightest = 247;              // of a channel: what lies beyond is clipped or noise
constexpr std::size_t kLeastShared = 40;                   // points that tell a ratio
constexpr double kStops = 1.0;                             // from the median of its neighbours
constexpr double kBlur = 0.35;                             // of the median of its neighbours, and of all
constexpr int kSweeps = 200;

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, at);
  return *at;
}

struct Look {
  Image8 small;  // RGBA; empty where the texture cannot be read
  double sharpness = std::numeric_limits<double>::quiet_NaN();
};

Look lookAt(const std::filesystem::path& file) {
  Look look;
  try {
    const Ktx2Info info = probeKtx2(file);
    int level = 0;
    while (std::max(info.width, info.height) >> level > kSharpnessSide && level + 1 < info.levels) ++level;
    std::vector<Image8> levels = decodeTexture(readKtx2(file, level));
    if (levels.size() > 3) look.sharpness = sharpness(levels[0], levels[3]);
    std::size_t small = 0;
    while (std::max(levels[small].width, levels[small].height) > kExposureSide && small + 1 < levels.size()) ++small;
    look.small = std::move(levels[small]);
  } catch (const Error&) {
  }
  return look;
}

std::optional<double> luminance(const Image8& picture, const Intrinsics& k, glm::vec2 pixel) {
  if (picture.width < 1) return std::nullopt;
  const int x = std::clamp(int(pixel.x * float(picture.width) / float(k.width)), 0, picture.width - 1);
  const int y = std::clamp(int(pixel.y * float(picture.height) / float(k.height)), 0, picture.height - 1);
  const auto rgb = picture.pixel(x, y);
  for (int c = 0; c < 3; ++c)
    if (rgb[std::size_t(c)] < kDarkest || rgb[std::size_t(c)] > kBrightest) return std::nullopt;
  return 0.2126 * srgbToLinear(rgb[0] / 255.0) + 0.7152 * srgbToLinear(rgb[1] / 255.0) +
         0.0722 * srgbToLinear(rgb[2] / 255.0);
}

struct Ratio {
  std::uint32_t a, b;
  double stops;  // b is brighter than a by
};

std::vector<Ratio> ratiosOf(const Scene& scene, const std::vector<Look>& looks) {
  std::vector<Ratio> ratios;
  for (const Cell& cell : scene.cells) {
    std::set<std::uint32_t> agreeing;
    for (std::size_t t = 0; t < cell.mesh.tier0Count(); ++t)
      for (int c = 0; c < 3; ++c) agreeing.insert(cell.mesh.triangles[t][c]);
    for (std::size_t m = 1; m < cell.members.size(); ++m) {
      std::vector<double> stops;
      const std::uint32_t a = cell.members[0], b = cell.members[m];
      for (const std::uint32_t v : agreeing) {
        const auto first = luminance(looks[a].small, scene.nodes[a].camera.intrinsics, cell.mesh.match[0][v]);
        const auto second = luminance(looks[b].small, scene.nodes[b].camera.intrinsics, cell.mesh.match[m][v]);
        if (first && second) stops.push_back(std::log2(*second / *first));
      }
      if (stops.size() >= kLeastShared) ratios.push_back({a, b, median(std::move(stops))});
    }
  }
  return ratios;
}

// Gauss–Seidel on the normal equations; what no ratio reaches stays at 0.
std::vector<double> stopsOf(const std::vector<Ratio>& ratios, std::size_t count) {
  std::vector<std::vector<std::pair<std::uint32_t, double>>> beside(count);
  for (const Ratio& r : ratios) {
    beside[r.b].push_back({r.a, r.stops});
    beside[r.a].push_back({r.b, -r.stops});
  }
  std::vector<double> stops(count, 0.0);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0;
      for (const auto& [j, difference] : beside[i]) sum += stops[j] + difference;
      if (!beside[i].empty()) stops[i] = sum / double(beside[i].size());
    }
  return stops;
}

}  // namespace

std::vector<Advice> pictureAdvice(const Scene& scene) {
  if (scene.folder.empty()) return {};
  std::vector<std::set<std::uint32_t>> mates(scene.nodes.size());
  for (const Cell& cell : scene.cells)
    for (const std::uint32_t i : cell.members)
      for (const std::uint32_t j : cell.members)
        if (i != j) mates[i].insert(j);
  std::vector<Look> looks(scene.nodes.size());
  std::vector<double> allSharp;
  for (std::size_t n = 0; n < looks.size(); ++n)
    if (!mates[n].empty() && !scene.nodes[n].textureFile.empty()) {
      looks[n] = lookAt(scene.folder / scene.nodes[n].textureFile);
      if (std::isfinite(looks[n].sharpness)) allSharp.push_back(looks[n].sharpness);
    }
  const std::vector<double> stops = stopsOf(ratiosOf(scene, looks), looks.size());
  const double typical = median(allSharp);
  std::vector<Advice> advice;
  for (std::uint32_t n = 0; n < looks.size(); ++n) {
    if (mates[n].empty()) continue;
    std::vector<double> theirs, sharp;
    std::string beside;
    for (const std::uint32_t m : mates[n]) {
      theirs.push_back(stops[m]);
      if (std::isfinite(looks[m].sharpness)) sharp.push_back(looks[m].sharpness);
      if (beside.empty() || scene.nodes[m].name < beside) beside = scene.nodes[m].name;
    }
    const std::string& name = scene.nodes[n].name;
    if (const double jump = stops[n] - median(theirs); std::abs(jump) > kStops)
      advice.push_back({AdviceKind::exposure,
                        Severity::warning,
                        fmt::format("{} is {:.1f} stops {} than the photographs beside it, {} for one.", name,
                                    std::abs(jump), jump > 0 ? "brighter" : "darker", beside),
                        "Lock the exposure before the first photograph, or set it by hand.",
                        {n},
                        jump});
    const double blur = looks[n].sharpness / std::max(1e-9, std::min(median(std::move(sharp)), typical));
    if (blur < kBlur)
      advice.push_back({AdviceKind::blurred,
                        Severity::warning,
                        fmt::format("{} is much less sharp than the photographs beside it, {} for one.", name, beside),
                        "Hold the camera still, or use a shorter exposure, and take it again.",
                        {n},
                        blur});
  }
  return advice;
}

}  // namespace ibr
