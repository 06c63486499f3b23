// SPDX-License-Identifier: Apache-2.0
#include "render/plan/transition.h"

#include <algorithm>
#include <map>
#include <set>

namespace ibr {
namespace {

struct Common {
  std::vector<bool> before, wanted;  // true: the entry shown, or the wanted cell, is in the common subsequence
};

Common longestCommonSubsequence(std::span<const DrawOrderEntry> before, std::span<const std::uint32_t> cells) {
  const std::size_t n = before.size(), m = cells.size();
  std::vector<std::uint32_t> length((n + 1) * (m + 1), 0);  // of the common subsequence of the rests from (i, j) on
  const auto at = [&](std::size_t i, std::size_t j) -> std::uint32_t& { return length[i * (m + 1) + j]; };
  const auto same = [&](std::size_t i, std::size_t j) { return !before[i].fadingOut && before[i].cell == cells[j]; };
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

// Merges both lists; a cell that fades out comes before its successor.
std::vector<DrawOrderEntry> merged(std::span<const DrawOrderEntry> before, const WantedOrder& wanted) {
  const Common common = longestCommonSubsequence(before, wanted.cells);
  const std::set<std::uint32_t> all(wanted.cells.begin(), wanted.cells.end());
  std::multiset<std::uint32_t> ahead;   // cells of entries that fade out, not merged yet
  std::map<std::uint32_t, double> met;  // the largest opacity of those already merged
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!common.before[i]) ahead.insert(before[i].cell);
  std::vector<DrawOrderEntry> shown;
  for (std::size_t i = 0, j = 0; i < before.size() || j < wanted.cells.size();) {
    if (i < before.size() && !common.before[i]) {
      DrawOrderEntry gone = before[i++];
      gone.fadingOut = true;
      ahead.erase(ahead.find(gone.cell));
      met[gone.cell] = std::max(met[gone.cell], gone.opacity);
      if (all.contains(gone.cell) || wanted.stillVisible(gone.cell)) shown.push_back(gone);
    } else if (j < wanted.cells.size() && !common.wanted[j]) {
      const std::uint32_t cell = wanted.cells[j++];
      const bool fadesIn = ahead.contains(cell) || wanted.wasHidden(cell);
      shown.push_back({cell, met.contains(cell) ? met[cell] : fadesIn ? 0.0 : 1.0, false});
    } else {
      shown.push_back(before[i++]);
      ++j;
    }
  }
  return shown;
}

// Advances all fades by one step. A copy behind the front copy of a cell waits until the front copy is opaque. A cell
// that is not wanted any more waits until all arriving cells are opaque, so that no hole opens between them.
std::vector<DrawOrderEntry> faded(std::vector<DrawOrderEntry> shown, double step) {
  std::map<std::uint32_t, double> wanted;  // opacity
  bool arriving = false;
  for (DrawOrderEntry& entry : shown)
    if (!entry.fadingOut) {
      entry.opacity = std::min(1.0, entry.opacity + step);
      wanted[entry.cell] = entry.opacity;
      arriving |= entry.opacity < 1;
    }
  std::map<std::uint32_t, double> inFront;  // largest opacity of the copies so far
  std::set<std::uint32_t> passed;           // wanted cells so far
  std::erase_if(shown, [&](DrawOrderEntry& entry) {
    double& front = inFront[entry.cell];
    bool gone = false;
    if (!entry.fadingOut) {
      passed.insert(entry.cell);
    } else if (front >= 1) {
      gone = true;
    } else if (!passed.contains(entry.cell) && (wanted.contains(entry.cell) || !arriving)) {
      entry.opacity -= step;
      gone = entry.opacity <= 0;
    }
    if (!gone) front = std::max(front, entry.opacity);
    return gone;
  });
  return shown;
}

}  // namespace

std::vector<DrawOrderEntry> advanceFades(std::span<const DrawOrderEntry> before, const WantedOrder& wanted,
                                         double step) {
  std::vector<DrawOrderEntry> shown;
  if ((before.empty() && !wanted.backed) || step >= 1) {
    for (const std::uint32_t cell : wanted.cells) shown.push_back({cell, 1.0, false});
    return shown;
  }
  shown = merged(before, wanted);
  // Cut if no opaque cell of the previous frame is left in view: a fade would begin with an empty image.
  if (!wanted.backed && std::ranges::none_of(shown, [](const DrawOrderEntry& entry) { return entry.opacity >= 1; }))
    return advanceFades({}, wanted, step);
  shown = faded(std::move(shown), step);
  // Above the limit, drop the faintest; among equals, the one farthest back.
  const auto isFadingOut = [](const DrawOrderEntry& entry) { return entry.fadingOut; };
  while (std::ranges::count_if(shown, isFadingOut) > std::ptrdiff_t(kMaxFadingOutCount)) {
    auto faintest = std::ranges::find_if(shown, isFadingOut);
    for (auto entry = faintest; entry != shown.end(); ++entry)
      if (entry->fadingOut && entry->opacity <= faintest->opacity) faintest = entry;
    shown.erase(faintest);
  }
  return shown;
}

}  // namespace ibr
