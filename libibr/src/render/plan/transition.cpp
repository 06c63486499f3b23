// SPDX-License-Identifier: Apache-2.0
#include "render/plan/transition.h"

#include <algorithm>
#include <map>
#include <set>

namespace ibr {
namespace {

struct Common {
  std::pmr::vector<bool> before, wanted;  // true: the entry shown, or the wanted cell, is in the common subsequence
};

Common longestCommonSubsequence(std::span<const DrawOrderEntry> before, std::span<const std::uint32_t> cells,
                                std::pmr::memory_resource* memory) {
  const std::size_t n = before.size(), m = cells.size();
  // Of the common subsequence of the rests from (i, j) on.
  std::pmr::vector<std::uint32_t> length((n + 1) * (m + 1), 0, memory);
  const auto at = [&](std::size_t i, std::size_t j) -> std::uint32_t& { return length[i * (m + 1) + j]; };
  const auto same = [&](std::size_t i, std::size_t j) { return !before[i].fadingOut && before[i].cell == cells[j]; };
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t j = m; j-- > 0;)
      at(i, j) = same(i, j) ? at(i + 1, j + 1) + 1 : std::max(at(i + 1, j), at(i, j + 1));
  Common common{std::pmr::vector<bool>(n, false, memory), std::pmr::vector<bool>(m, false, memory)};
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
void merge(std::span<const DrawOrderEntry> before, const WantedOrder& wanted, std::pmr::memory_resource* memory,
           std::vector<DrawOrderEntry>& shown) {
  const Common common = longestCommonSubsequence(before, wanted.cells, memory);
  const std::pmr::set<std::uint32_t> all(wanted.cells.begin(), wanted.cells.end(), memory);
  std::pmr::multiset<std::uint32_t> ahead(memory);   // cells of entries that fade out, not merged yet
  std::pmr::map<std::uint32_t, double> met(memory);  // the largest opacity of those already merged
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!common.before[i]) ahead.insert(before[i].cell);
  for (std::size_t i = 0, j = 0; i < before.size() || j < wanted.cells.size();) {
    if (i < before.size() && !common.before[i]) {
      DrawOrderEntry gone = before[i++];
      gone.fadingOut = true;
      ahead.erase(ahead.find(gone.cell));
      met[gone.cell] = std::max(met[gone.cell], gone.opacity);
      if (all.contains(gone.cell) || std::ranges::binary_search(wanted.stillVisible, gone.cell)) shown.push_back(gone);
    } else if (j < wanted.cells.size() && !common.wanted[j]) {
      const std::uint32_t cell = wanted.cells[j++];
      const bool fadesIn = ahead.contains(cell) || std::ranges::binary_search(wanted.hidden, cell);
      shown.push_back({cell, met.contains(cell) ? met[cell] : fadesIn ? 0.0 : 1.0, false});
    } else {
      shown.push_back(before[i++]);
      ++j;
    }
  }
}

// Advances all fades by one step. A copy behind the front copy of a cell waits until the front copy is opaque. A cell
// that is not wanted any more waits until all arriving cells are opaque, so that no hole opens between them.
void fade(std::vector<DrawOrderEntry>& shown, double step, std::pmr::memory_resource* memory) {
  std::pmr::map<std::uint32_t, double> wanted(memory);  // opacity
  bool arriving = false;
  for (DrawOrderEntry& entry : shown)
    if (!entry.fadingOut) {
      entry.opacity = std::min(1.0, entry.opacity + step);
      wanted[entry.cell] = entry.opacity;
      arriving |= entry.opacity < 1;
    }
  std::pmr::map<std::uint32_t, double> inFront(memory);  // largest opacity of the copies so far
  std::pmr::set<std::uint32_t> passed(memory);           // wanted cells so far
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
}

void cutTo(std::span<const std::uint32_t> cells, std::vector<DrawOrderEntry>& shown) {
  shown.clear();
  for (const std::uint32_t cell : cells) shown.push_back({cell, 1.0, false});
}

}  // namespace

void advanceFades(std::span<const DrawOrderEntry> before, const WantedOrder& wanted, double step,
                  std::pmr::memory_resource* memory, std::vector<DrawOrderEntry>& shown) {
  if ((before.empty() && !wanted.backed) || step >= 1) return cutTo(wanted.cells, shown);
  shown.clear();
  merge(before, wanted, memory, shown);
  // Cut if no opaque cell of the previous frame is left in view: a fade would begin with an empty image.
  if (!wanted.backed && std::ranges::none_of(shown, [](const DrawOrderEntry& entry) { return entry.opacity >= 1; }))
    return cutTo(wanted.cells, shown);
  fade(shown, step, memory);
  // Above the limit, drop the faintest; among equals, the one farthest back.
  const auto isFadingOut = [](const DrawOrderEntry& entry) { return entry.fadingOut; };
  while (std::ranges::count_if(shown, isFadingOut) > std::ptrdiff_t(kMaxFadingOutCount)) {
    auto faintest = std::ranges::find_if(shown, isFadingOut);
    for (auto entry = faintest; entry != shown.end(); ++entry)
      if (entry->fadingOut && entry->opacity <= faintest->opacity) faintest = entry;
    shown.erase(faintest);
  }
}

}  // namespace ibr
