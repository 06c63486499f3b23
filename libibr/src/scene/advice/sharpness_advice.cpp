// SPDX-License-Identifier: Apache-2.0
#include "scene/advice/sharpness_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/median.h"
#include "ibr/error.h"
#include "ibr/metrics.h"
#include "ibr/texture.h"
#include "scene/advice/advice_entry.h"

namespace ibr {
namespace {

constexpr int kSide = 1600;     // px, maximum of the longer side
constexpr double kBlur = 0.35;  // of the median of its neighbours, and of all
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double sharpnessOf(const std::filesystem::path& texture) {
  try {
    const Ktx2Info info = probeKtx2(texture);
    int level = 0;
    while (std::max(info.width, info.height) >> level > kSide && level + 1 < info.levels) ++level;
    const std::vector<Image8> levels = decodeTexture(readKtx2(texture, level));
    return levels.size() > 3 ? sharpness(levels[0], levels[3]) : kUnknown;
  } catch (const Error&) {
    return kUnknown;
  }
}

}  // namespace

std::vector<Advice> sharpnessAdvice(const Scene& scene, const std::vector<std::vector<std::uint32_t>>& neighbours) {
  if (scene.folder.empty()) return {};
  std::vector<double> sharp(scene.nodes.size(), kUnknown);
  for (std::size_t n = 0; n < sharp.size(); ++n)
    if (!neighbours[n].empty() && !scene.nodes[n].textureFile.empty())
      sharp[n] = sharpnessOf(scene.folder / scene.nodes[n].textureFile);
  const double typical = median(sharp);
  std::vector<Advice> advice;
  for (std::uint32_t n = 0; n < sharp.size(); ++n) {
    std::vector<double> theirs;
    for (const std::uint32_t m : neighbours[n]) theirs.push_back(sharp[m]);
    const double share = sharp[n] / std::max(1e-9, std::min(median(std::move(theirs)), typical));
    if (!(share < kBlur)) continue;
    const auto name = [&](std::uint32_t m) -> const std::string& { return nodeName(scene, m); };
    advice.push_back(adviceEntry(scene, AdviceKind::blurred, Severity::warning, {n}, share,
                                 fmt::format("{} is much less sharp than its neighbours, for example {}.", name(n),
                                             name(*std::ranges::min_element(neighbours[n], {}, name))),
                                 "Hold the camera still, or use a shorter exposure, and take it again."));
  }
  return advice;
}

}  // namespace ibr
