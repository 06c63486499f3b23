// SPDX-License-Identifier: Apache-2.0
#include "render/photographs/photograph_set.h"

#include <algorithm>
#include <limits>

namespace ibr {
namespace {

constexpr float kFadeShare = 0.25f;  // a member whose loss exceeds the best outsider's gain by this share has weight 1
constexpr float kMinRelativeGain = 1e-6f;  // of F: smaller gains are rounding
constexpr float kRounding = 1e-5f;         // of F: upper bound of the rounding of a coverage, or of a bound

class Chooser {
 public:
  Chooser(std::span<const SampleValues* const> pool, std::size_t count, std::pmr::memory_resource* memory)
      : pool_(pool),
        count_(std::min(count, pool.size())),
        memory_(memory),
        members_(memory),
        taken_(pool.size(), false, memory),
        slope_(pool.size(), memory),
        bySlope_(memory) {}

  std::pmr::vector<SetMember> run() {
    takeGreedily();
    std::pmr::vector<SetMember> result(members_.size(), memory_);
    if (members_.size() < pool_.size()) {
      for (std::size_t round = 0; round < 2 * members_.size() && exchange(); ++round) continue;
      findSlopes();
      for (std::size_t m = 0; m < members_.size(); ++m) result[m].weight = weightOf(m);
    }
    for (std::size_t m = 0; m < members_.size(); ++m) result[m].photograph = members_[m];
    std::ranges::sort(result, {}, &SetMember::photograph);
    return result;
  }

 private:
  void takeGreedily() {
    SampleValues sum;
    float base = 0;
    std::pmr::vector<float> gain(pool_.size(), std::numeric_limits<float>::infinity(), memory_);
    while (members_.size() < count_) {
      std::size_t best = pool_.size();
      float most = base;
      // A gain shrinks while the set grows: the previous one is an upper bound. Starts with the largest.
      std::size_t first = pool_.size();
      for (std::size_t i = 0; i < pool_.size(); ++i)
        if (!taken_[i] && (first == pool_.size() || gain[i] > gain[first])) first = i;
      for (std::size_t k = 0; k <= pool_.size(); ++k) {
        const std::size_t i = k == 0 ? first : k - 1;
        if (i == pool_.size() || taken_[i] || (k > 0 && i == first)) continue;
        if (base + gain[i] + kRounding * base < most) continue;
        const float with = coverage(sum, *pool_[i]);
        gain[i] = with - base;
        if (with > most || (with == most && best != pool_.size() && i < best)) most = with, best = i;
      }
      if (best == pool_.size()) return;
      taken_[best] = true;
      members_.push_back(best);
      add(sum, *pool_[best]);
      base = coverage(sum);
    }
  }

  // Adds the others instead of subtracting one: a difference would leave rounding errors where the sum is 0.
  SampleValues sumWithout(std::size_t left) const {
    SampleValues sum;
    for (std::size_t m = 0; m < members_.size(); ++m)
      if (m != left) add(sum, *pool_[members_[m]]);
    return sum;
  }

  // The set's slopes bound every exchange: F(S − m + o) <= F(S) + slope(o) − slope(m).
  void findSlopes() {
    const SampleValues sum = sumWithout(members_.size());
    const CoverageSlopes slopes = coverageSlopes(sum);
    whole_ = coverage(sum);
    bySlope_.clear();
    for (std::size_t i = 0; i < pool_.size(); ++i) {
      slope_[i] = linear(slopes, *pool_[i]);
      if (!taken_[i]) bySlope_.push_back(i);
    }
    std::ranges::sort(
        bySlope_, [&](std::size_t a, std::size_t b) { return slope_[a] != slope_[b] ? slope_[a] > slope_[b] : a < b; });
  }

  struct Replacement {
    std::size_t photograph;
    float coverage;  // of the set with it
  };

  // Returns the best outsider in place of a member, if it reaches `least`; else any outsider, or none.
  Replacement bestReplacement(std::size_t m, const SampleValues& others, float least) const {
    Replacement best{pool_.size(), 0};
    for (const std::size_t i : bySlope_) {
      const float bound = whole_ + (slope_[i] - slope_[members_[m]]) + kRounding * (whole_ + slope_[i]);
      if (bound < std::max(least, best.coverage)) break;
      const float with = coverage(others, *pool_[i]);
      if (with > best.coverage || (with == best.coverage && i < best.photograph)) best = {i, with};
    }
    return best;
  }

  // Makes the best exchange; false if none improves F.
  bool exchange() {
    findSlopes();
    float most = 0;
    std::size_t outgoing = 0, incoming = pool_.size();
    for (std::size_t m = 0; m < members_.size(); ++m) {
      const SampleValues others = sumWithout(m);
      const float here = coverage(others, *pool_[members_[m]]);
      const float needed = std::max(most, kMinRelativeGain * here);
      const Replacement best = bestReplacement(m, others, here + needed);
      if (best.photograph == pool_.size() || !(best.coverage - here > needed)) continue;
      most = best.coverage - here;
      outgoing = m;
      incoming = best.photograph;
    }
    if (incoming == pool_.size()) return false;
    taken_[members_[outgoing]] = false;
    taken_[incoming] = true;
    members_[outgoing] = incoming;
    return true;
  }

  float weightOf(std::size_t m) const {
    const SampleValues others = sumWithout(m);
    const float base = coverage(others), loss = coverage(others, *pool_[members_[m]]) - base;
    const Replacement best = bestReplacement(m, others, base + loss / (1 + kFadeShare));
    const float gain = best.coverage - base;
    return gain > 0 ? std::clamp((loss / gain - 1) / kFadeShare, 0.0f, 1.0f) : 1.0f;
  }

  std::span<const SampleValues* const> pool_;
  std::size_t count_;
  std::pmr::memory_resource* memory_;
  std::pmr::vector<std::size_t> members_;
  std::pmr::vector<bool> taken_;
  std::pmr::vector<float> slope_;          // by photograph
  std::pmr::vector<std::size_t> bySlope_;  // outsiders, largest slope first
  float whole_ = 0;                        // F of the set
};

}  // namespace

std::pmr::vector<SetMember> bestSet(std::span<const SampleValues* const> pool, std::size_t count,
                                    std::pmr::memory_resource* memory) {
  return Chooser(pool, count, memory).run();
}

}  // namespace ibr
