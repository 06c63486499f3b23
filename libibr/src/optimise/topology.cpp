// SPDX-License-Identifier: Apache-2.0
#include "optimise/topology.h"

#include <algorithm>
#include <array>
#include <vector>

#include "optimise/mesh_edges.h"
#include "optimise/triangle_agreement.h"
#include "optimise/workers.h"

namespace ibr {
namespace {

using Pair = std::array<glm::uvec3, 2>;

struct Flip {
  std::array<std::size_t, 2> triangle{};  // indices
  Pair before{}, after{};
  MeshEdges::Edge edge;  // the new one
  double surplus = -1;   // rise of the ECC beyond the required gain
};

class EdgeFlips {
 public:
  EdgeFlips(Alignment& alignment, std::span<const Texels> pictures, const FlipOptions& options)
      : alignment_(alignment), pictures_(pictures), options_(options), changed_(alignment.triangles.size(), true) {}

  std::size_t run() {
    std::size_t flips = 0;
    for (int pass = 0; pass < options_.maxPasses; ++pass) {
      const std::size_t now = flipBest();
      if (now == 0) break;
      flips += now;
    }
    return flips;
  }

 private:
  // Flips the best first; edges beside a flipped one are judged again in the next pass.
  std::size_t flipBest() {
    edges_ = MeshEdges(alignment_);
    std::vector<Flip> flips = possible();
    forEachInParallel(flips.size(), options_.threads, [&](std::size_t i) { flips[i].surplus = judged(flips[i]); });
    std::erase_if(flips, [](const Flip& f) { return !(f.surplus > 0); });
    std::ranges::stable_sort(flips, std::greater<>{}, &Flip::surplus);
    changed_.assign(changed_.size(), false);
    std::size_t count = 0;
    for (const Flip& f : flips) {
      if (changed_[f.triangle[0]] || changed_[f.triangle[1]] || !edges_.all.insert(f.edge).second) continue;
      for (std::size_t k = 0; k < 2; ++k) {
        alignment_.triangles[f.triangle[k]] = f.after[k];
        changed_[f.triangle[k]] = true;
      }
      ++count;
    }
    return count;
  }

  // Ordered by the edges' points. Skips edges whose triangles did not change since the last pass refused them.
  std::vector<Flip> possible() const {
    std::vector<Flip> flips;
    for (const auto& [edge, s] : edges_.beside) {
      const auto [a, b] = edge;
      const std::size_t t = edges_.beyond(a, b);
      if (a > b || t == MeshEdges::none || fixed(a) != fixed(b) || (!changed_[s] && !changed_[t])) continue;
      const Pair before{alignment_.triangles[s], alignment_.triangles[t]};
      const std::uint32_t c = opposite(before[0], a, b), d = opposite(before[1], a, b);
      const Flip flip{{s, t}, before, {{{a, d, c}, {d, b, c}}}, MeshEdges::either(c, d)};
      const auto unfoldedHere = [&](const glm::uvec3& triangle) { return isUnfolded(alignment_.position, triangle); };
      if (c != d && !edges_.all.contains(flip.edge) && std::ranges::all_of(flip.after, unfoldedHere) &&
          std::ranges::all_of(flip.before, unfoldedHere))
        flips.push_back(flip);
    }
    return flips;
  }

  bool fixed(std::uint32_t point) const { return !alignment_.fixed.empty() && alignment_.fixed[point] != 0; }

  double judged(const Flip& flip) const {
    const auto agreement = [&](const Pair& triangles) {
      return agreementOf(pictures_, alignment_.position, triangles, options_.varianceFloor);
    };
    return surplusOf(agreement(flip.before), agreement(flip.after), options_.gain);
  }

  Alignment& alignment_;
  const std::span<const Texels> pictures_;
  const FlipOptions& options_;
  std::vector<bool> changed_;  // by the last pass
  MeshEdges edges_;
};

}  // namespace

std::size_t flipEdges(Alignment& alignment, std::span<const Texels> pictures, const FlipOptions& options) {
  return EdgeFlips(alignment, pictures, options).run();
}

}  // namespace ibr
