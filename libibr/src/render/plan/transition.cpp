// SPDX-License-Identifier: Apache-2.0
#include "render/plan/transition.h"

#include <algorithm>
#include <map>
#include <set>

namespace ibr {
namespace {

struct Common {
  std::vector<bool> before, wanted;  // what stays, of the entries shown and of the meshes wanted
};

Common longestCommon(std::span<const ShownMesh> before, std::span<const std::uint32_t> meshes) {
  const std::size_t n = before.size(), m = meshes.size();
  std::vector<std::uint32_t> length((n + 1) * (m + 1), 0);  // of the common subsequence of what follows (i, j)
  const auto at = [&](std::size_t i, std::size_t j) -> std::uint32_t& { return length[i * (m + 1) + j]; };
  const auto same = [&](std::size_t i, std::size_t j) { return !before[i].leaving && before[i].mesh == meshes[j]; };
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t j = m; j-- > 0;)
      at(i, j) = same(i, j) ? at(i + 1, j + 1) + 1 : std::max(at(i + 1, j), at(i, j + 1));
  Common common{std::vector<bool>(n, false), std::vector<bool>(m, false)};
  for (std::size_t i = 0, j = 0; i < n && j < m;) {
    if (same(i, j))
      common.before[i++] = common.wanted[j++] = true;
    else if (at(i + 1, j) >= at(i, j + 1))
      ++i;
    else
      ++j;
  }
  return common;
}

// Both lists as one; what leaves stands before what takes its place.
std::vector<ShownMesh> merged(std::span<const ShownMesh> before, const WantedOrder& wanted) {
  const Common common = longestCommon(before, wanted.meshes);
  const std::set<std::uint32_t> all(wanted.meshes.begin(), wanted.meshes.end());
  std::multiset<std::uint32_t> ahead;   // meshes of entries that leave, still to be met
  std::map<std::uint32_t, double> met;  // their largest opacity
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!common.before[i]) ahead.insert(before[i].mesh);
  std::vector<ShownMesh> shown;
  for (std::size_t i = 0, j = 0; i < before.size() || j < wanted.meshes.size();) {
    if (i < before.size() && !common.before[i]) {
      ShownMesh gone = before[i++];
      gone.leaving = true;
      ahead.erase(ahead.find(gone.mesh));
      met[gone.mesh] = std::max(met[gone.mesh], gone.opacity);
      if (all.contains(gone.mesh) || wanted.stillVisible(gone.mesh)) shown.push_back(gone);
    } else if (j < wanted.meshes.size() && !common.wanted[j]) {
      const std::uint32_t mesh = wanted.meshes[j++];
      const bool fadesIn = ahead.contains(mesh) || wanted.wasHidden(mesh);
      shown.push_back({mesh, met.contains(mesh) ? met[mesh] : fadesIn ? 0.0 : 1.0, false});
    } else {
      shown.push_back(before[i++]);
      ++j;
    }
  }
  return shown;
}

// One step of all fades. Whatever is behind the front copy of a mesh waits until that one is whole; what leaves for
// good waits until all that arrives is whole, so that no hole opens between them.
std::vector<ShownMesh> faded(std::vector<ShownMesh> shown, double step) {
  std::map<std::uint32_t, double> wanted;  // opacity
  bool arriving = false;
  for (ShownMesh& entry : shown)
    if (!entry.leaving) {
      entry.opacity = std::min(1.0, entry.opacity + step);
      wanted[entry.mesh] = entry.opacity;
      arriving |= entry.opacity < 1;
    }
  std::map<std::uint32_t, double> inFront;  // largest opacity of copies
  std::set<std::uint32_t> passed;           // of the wanted
  std::erase_if(shown, [&](ShownMesh& entry) {
    double& front = inFront[entry.mesh];
    bool gone = false;
    if (!entry.leaving) {
      passed.insert(entry.mesh);
    } else if (front >= 1) {
      gone = true;
    } else if (!passed.contains(entry.mesh) && (wanted.contains(entry.mesh) || !arriving)) {
      entry.opacity -= step;
      gone = entry.opacity <= 0;
    }
    if (!gone) front = std::max(front, entry.opacity);
    return gone;
  });
  return shown;
}

}  // namespace

std::vector<ShownMesh> showMeshes(std::span<const ShownMesh> before, const WantedOrder& wanted, double step) {
  std::vector<ShownMesh> shown;
  if (before.empty() || step >= 1) {
    for (const std::uint32_t mesh : wanted.meshes) shown.push_back({mesh, 1.0, false});
    return shown;
  }
  shown = merged(before, wanted);
  // Nothing of the frame before is left in view: a fade would begin with an empty picture.
  if (std::ranges::none_of(shown, [](const ShownMesh& entry) { return entry.opacity >= 1; }))
    return showMeshes({}, wanted, step);
  shown = faded(std::move(shown), step);
  // The faintest go first; of those that are whole, the one furthest back.
  const auto isLeaving = [](const ShownMesh& entry) { return entry.leaving; };
  while (std::ranges::count_if(shown, isLeaving) > std::ptrdiff_t(wanted.mostLeaving)) {
    auto faintest = std::ranges::find_if(shown, isLeaving);
    for (auto entry = faintest; entry != shown.end(); ++entry)
      if (entry->leaving && entry->opacity <= faintest->opacity) faintest = entry;
    shown.erase(faintest);
  }
  return shown;
}

std::vector<std::uint32_t> keepWhileFading(std::span<const ShownMesh> before, const WantedOrder& wanted,
                                           std::size_t most) {
  const std::vector<std::uint32_t> atOnce(wanted.meshes.begin(), wanted.meshes.end());
  if (std::ranges::all_of(before, [](const ShownMesh& entry) { return !entry.leaving && entry.opacity >= 1; }))
    return atOnce;
  std::vector<std::uint32_t> order;
  std::set<std::uint32_t> kept;
  for (const ShownMesh& entry : before)
    if (!entry.leaving && order.size() < most && wanted.stillVisible(entry.mesh)) {
      order.push_back(entry.mesh);
      kept.insert(entry.mesh);
    }
  for (const std::uint32_t mesh : wanted.meshes)
    if (order.size() < most && !kept.contains(mesh) && !wanted.wasHidden(mesh)) order.push_back(mesh);
  return 2 * order.size() < atOnce.size() ? atOnce : order;
}

}  // namespace ibr
