// SPDX-License-Identifier: Apache-2.0
#include "render/plan/transition.h"

#include <algorithm>
#include <map>
#include <set>

namespace ibr {
namespace {

struct Common {
  std::vector<bool> before, wanted;  // what stays, of the entries shown and of the cells wanted
};

Common longestCommon(std::span<const ShownCell> before, std::span<const std::uint32_t> cells) {
  const std::size_t n = before.size(), m = cells.size();
  std::vector<std::uint32_t> length((n + 1) * (m + 1), 0);  // of the common subsequence of what follows (i, j)
  const auto at = [&](std::size_t i, std::size_t j) -> std::uint32_t& { return length[i * (m + 1) + j]; };
  const auto same = [&](std::size_t i, std::size_t j) { return !before[i].leaving && before[i].cell == cells[j]; };
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
std::vector<ShownCell> merged(std::span<const ShownCell> before, const WantedOrder& wanted) {
  const Common common = longestCommon(before, wanted.cells);
  const std::set<std::uint32_t> all(wanted.cells.begin(), wanted.cells.end());
  std::multiset<std::uint32_t> ahead;   // cells of entries that leave, still to be met
  std::map<std::uint32_t, double> met;  // their largest opacity
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!common.before[i]) ahead.insert(before[i].cell);
  std::vector<ShownCell> shown;
  for (std::size_t i = 0, j = 0; i < before.size() || j < wanted.cells.size();) {
    if (i < before.size() && !common.before[i]) {
      ShownCell gone = before[i++];
      gone.leaving = true;
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

// One step of all fades. Whatever is behind the front copy of a cell waits until that one is whole; what leaves for
// good waits until all that arrives is whole, so that no hole opens between them.
std::vector<ShownCell> faded(std::vector<ShownCell> shown, double step) {
  std::map<std::uint32_t, double> wanted;  // opacity
  bool arriving = false;
  for (ShownCell& entry : shown)
    if (!entry.leaving) {
      entry.opacity = std::min(1.0, entry.opacity + step);
      wanted[entry.cell] = entry.opacity;
      arriving |= entry.opacity < 1;
    }
  std::map<std::uint32_t, double> inFront;  // largest opacity of copies
  std::set<std::uint32_t> passed;           // of the wanted
  std::erase_if(shown, [&](ShownCell& entry) {
    double& front = inFront[entry.cell];
    bool gone = false;
    if (!entry.leaving) {
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

std::vector<ShownCell> showCells(std::span<const ShownCell> before, const WantedOrder& wanted, double step) {
  std::vector<ShownCell> shown;
  if ((before.empty() && !wanted.backed) || step >= 1) {
    for (const std::uint32_t cell : wanted.cells) shown.push_back({cell, 1.0, false});
    return shown;
  }
  shown = merged(before, wanted);
  // Nothing of the frame before is left in view: a fade would begin with an empty picture.
  if (!wanted.backed && std::ranges::none_of(shown, [](const ShownCell& entry) { return entry.opacity >= 1; }))
    return showCells({}, wanted, step);
  shown = faded(std::move(shown), step);
  // The faintest go first; of those that are whole, the one furthest back.
  const auto isLeaving = [](const ShownCell& entry) { return entry.leaving; };
  while (std::ranges::count_if(shown, isLeaving) > std::ptrdiff_t(kLargestLeavingCount)) {
    auto faintest = std::ranges::find_if(shown, isLeaving);
    for (auto entry = faintest; entry != shown.end(); ++entry)
      if (entry->leaving && entry->opacity <= faintest->opacity) faintest = entry;
    shown.erase(faintest);
  }
  return shown;
}

}  // namespace ibr
