// SPDX-License-Identifier: Apache-2.0
#include "optimise/topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "optimise/judge.h"
#include "optimise/star_mesh.h"
#include "optimise/workers.h"

namespace ibr {
namespace {

constexpr double kSureSamples = 1024;

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Pair = std::array<glm::uvec3, 2>;

Edge either(std::uint32_t a, std::uint32_t b) {
  return std::minmax(a, b);
}

struct Flip {
  std::array<std::size_t, 2> triangle{};  // indices
  Pair before{}, after{};
  Edge edge;            // the new one
  double surplus = -1;  // of the ECC, beyond what is asked for
};

class EdgeFlips {
 public:
  EdgeFlips(Alignment& alignment, std::span<const Texels> pictures, const FlipOptions& options)
      : alignment_(alignment), pictures_(pictures), options_(options), changed_(alignment.triangles.size(), true) {}

  std::size_t run() {
    std::size_t flips = 0;
    for (int pass = 0; pass < options_.mostPasses; ++pass) {
      const std::size_t now = flipBest();
      if (now == 0) break;
      flips += now;
    }
    return flips;
  }

 private:
  // The best first; those beside one that was flipped are judged again in the next pass.
  std::size_t flipBest() {
    findEdges();
    std::vector<Flip> flips = possible();
    forEachInParallel(flips.size(), options_.threads, [&](std::size_t i) { flips[i].surplus = surplusOf(flips[i]); });
    std::erase_if(flips, [](const Flip& f) { return !(f.surplus > 0); });
    std::ranges::stable_sort(flips, std::greater<>{}, &Flip::surplus);
    changed_.assign(changed_.size(), false);
    std::size_t count = 0;
    for (const Flip& f : flips) {
      if (changed_[f.triangle[0]] || changed_[f.triangle[1]] || !edges_.insert(f.edge).second) continue;
      for (std::size_t k = 0; k < 2; ++k) {
        alignment_.triangles[f.triangle[k]] = f.after[k];
        changed_[f.triangle[k]] = true;
      }
      ++count;
    }
    return count;
  }

  void findEdges() {
    beside_.clear(), edges_.clear(), barred_.clear();
    for (std::size_t t = 0; t < alignment_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const glm::uvec3& corner = alignment_.triangles[t];
        const std::uint32_t a = corner[k], b = corner[(k + 1) % 3];
        edges_.insert(either(a, b));
        if (!beside_.emplace(Edge(a, b), t).second) barred_.insert(either(a, b));
      }
    for (const glm::uvec3& corner : alignment_.kept)
      for (int k = 0; k < 3; ++k) {
        const Edge edge = either(corner[k], corner[(k + 1) % 3]);
        edges_.insert(edge);
        barred_.insert(edge);
      }
  }

  // By the edges' points. Where neither triangle has changed since, the last pass has said no.
  std::vector<Flip> possible() const {
    std::vector<Flip> flips;
    for (const auto& [edge, s] : beside_) {
      const auto [a, b] = edge;
      const auto other = beside_.find({b, a});
      if (a > b || other == beside_.end() || barred_.contains(edge) || fixed(a) != fixed(b)) continue;
      const std::size_t t = other->second;
      if (!changed_[s] && !changed_[t]) continue;
      const std::uint32_t c = opposite(s, a, b), d = opposite(t, a, b);
      Flip flip{{s, t}, {alignment_.triangles[s], alignment_.triangles[t]}, {{{a, d, c}, {d, b, c}}}, either(c, d)};
      const auto unfoldedHere = [&](const glm::uvec3& triangle) { return unfolded(alignment_.position, triangle); };
      if (c != d && !edges_.contains(flip.edge) && std::ranges::all_of(flip.after, unfoldedHere) &&
          std::ranges::all_of(flip.before, unfoldedHere))
        flips.push_back(flip);
    }
    return flips;
  }

  bool fixed(std::uint32_t point) const { return !alignment_.fixed.empty() && alignment_.fixed[point] != 0; }
  std::uint32_t opposite(std::size_t t, std::uint32_t a, std::uint32_t b) const {
    const glm::uvec3& corner = alignment_.triangles[t];
    for (int k = 0; k < 2; ++k)
      if (corner[k] != a && corner[k] != b) return corner[k];
    return corner.z;
  }

  struct Agreement {
    double ecc = 0, samples = 0;  // means over the sources
  };
  std::optional<Agreement> agreement(const Pair& triangles) const {
    Agreement mean;
    const double members = double(pictures_.size());
    for (std::size_t source = 0; source < pictures_.size(); ++source) {
      const Judgement judgement = judgeTriangles(pictures_, alignment_.position, triangles, source);
      if (!judgement.whole) return std::nullopt;
      mean.ecc += eccOf(judgement.score(EccDefinition::channels, options_.varianceFloor)) / members;
      mean.samples += double(judgement.pixels()) / (members * double(judgement.count));
    }
    return mean;
  }

  double surplusOf(const Flip& flip) const {
    const auto before = agreement(flip.before), after = agreement(flip.after);
    if (!before || !after || before->samples == 0) return -1;
    return after->ecc - before->ecc - options_.gain * std::max(1.0, std::sqrt(kSureSamples / before->samples));
  }

  Alignment& alignment_;
  const std::span<const Texels> pictures_;
  const FlipOptions& options_;
  std::vector<bool> changed_;           // triangles, by the last pass
  std::map<Edge, std::size_t> beside_;  // an edge as a triangle has it: that triangle
  std::set<Edge> edges_;                // of all triangles, ends ascending
  std::set<Edge> barred_;               // of them, of those only kept, and of more than two
};

}  // namespace

std::size_t flipEdges(Alignment& alignment, std::span<const Texels> pictures, const FlipOptions& options) {
  return EdgeFlips(alignment, pictures, options).run();
}

}  // namespace ibr
