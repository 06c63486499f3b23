// SPDX-License-Identifier: Apache-2.0
#include "author/video/frame_choice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "author/video/frame_motion.h"

namespace ibr {
namespace {

constexpr double kParallax = 0.03, kShift = 0.2;  // between chosen frames, of the longer side
constexpr double kFewestShared = 0.2;             // share of points below which frames have lost each other
constexpr double kPerMinuteLeast = 40, kPerMinuteMost = 80;
constexpr double kSharp = 0.75;  // sharpness from which a frame counts as sharp

// Chooses frames with one spacing after another; motions are measured once.
class Choice {
 public:
  Choice(const MeasuredVideo& video, std::span<const double> sharpness) : video_(video), sharpness_(sharpness) {}

  /// `spacing`: factor of kParallax and kShift.
  std::vector<std::size_t> with(double spacing) {
    std::vector<std::size_t> chosen{sharpest(0, std::min(count(), halfSecond()))};
    while (const auto next = after(chosen.back(), spacing)) chosen.push_back(*next);
    return chosen;
  }

 private:
  std::size_t count() const { return video_.frames.size(); }
  std::size_t halfSecond() const { return std::max<std::size_t>(3, std::size_t(0.5 * video_.framesPerSecond)); }

  std::size_t sharpest(std::size_t begin, std::size_t end) const {
    return std::size_t(std::max_element(sharpness_.begin() + long(begin), sharpness_.begin() + long(end)) -
                       sharpness_.begin());
  }

  // Distance of two frames, 1 where they are one spacing of 1 apart; nullopt where they have lost each other.
  std::optional<double> distance(std::size_t from, std::size_t to) {
    const auto key = std::pair(from, to);
    auto found = motions_.find(key);
    if (found == motions_.end())
      found = motions_
                  .emplace(key, motionBetween(video_.frames[from].points, video_.frames[to].points, video_.width,
                                              video_.height))
                  .first;
    const FrameMotion& motion = found->second;
    if (motion.shared < kFewestShared) return std::nullopt;
    return std::max(motion.parallax / kParallax, motion.shift / kShift);
  }

  // The frame to use after `from`: of those about one spacing away the sharpest, else a sharp one nearer or farther.
  std::optional<std::size_t> after(std::size_t from, double spacing) {
    constexpr double kNear = 0.7, kFar = 1.3, kNearest = 0.35, kFarthest = 2, kLoss = 0.3;
    std::vector<std::pair<std::size_t, double>> away;  // frames and their distances in spacings
    std::size_t to = from + 1;
    for (double farthest = 0; to < count() && farthest < kFarthest; ++to) {
      if (video_.frames[to].points.empty()) continue;  // blurred
      const auto d = distance(from, to);
      if (!d) break;
      away.emplace_back(to, *d / spacing);
      farthest = std::max(farthest, *d / spacing);
    }
    const bool lost = to < count() && (away.empty() || away.back().second < kFarthest);
    std::optional<std::size_t> best;
    const auto choose = [&](double nearest, double farthest, double least) {
      double bestScore = 0;
      for (const auto& [frame, d] : away) {
        if (d < nearest || d > farthest || sharpness_[frame] < least) continue;
        const double score = sharpness_[frame] - kLoss * std::abs(d - 1);
        if (!best || score > bestScore) best = frame, bestScore = score;
      }
      return best.has_value();
    };
    if (choose(kNear, kFar, kSharp) || choose(kNearest, kFarthest, kSharp)) return best;
    if (!lost) return choose(kNear, kFar, 0) ? best : std::nullopt;
    // The view has changed within a few frames, or the points are gone: goes on with the sharpest frame after the
    // change.
    return sharpest(to, std::min(count(), to + halfSecond()));
  }

  const MeasuredVideo& video_;
  std::span<const double> sharpness_;
  std::map<std::pair<std::size_t, std::size_t>, FrameMotion> motions_;
};

}  // namespace

std::vector<double> relativeSharpness(const MeasuredVideo& video) {
  const std::size_t reach = std::max<std::size_t>(2, std::size_t(0.5 * video.framesPerSecond));
  std::vector<double> sharpness(video.frames.size(), 1);
  for (std::size_t i = 0; i < video.frames.size(); ++i)
    for (std::size_t direction = 0; direction < 4; ++direction) {
      float most = 0;
      for (std::size_t j = i - std::min(i, reach); j < std::min(video.frames.size(), i + reach + 1); ++j)
        most = std::max(most, video.frames[j].detail[direction]);
      if (most > 0)
        sharpness[i] = std::min(sharpness[i], std::sqrt(double(video.frames[i].detail[direction]) / double(most)));
    }
  return sharpness;
}

std::vector<std::size_t> chooseFrames(const MeasuredVideo& video, std::span<const double> sharpness,
                                      std::size_t wanted) {
  if (video.frames.empty()) return {};
  Choice choice(video, sharpness);
  const double minutes = double(video.frames.size()) / std::max(1.0, video.framesPerSecond) / 60;
  double least = wanted > 0 ? 0.95 * double(wanted) : std::max(3.0, kPerMinuteLeast * minutes);
  double most = wanted > 0 ? 1.05 * double(wanted) : std::max(8.0, kPerMinuteMost * minutes);
  std::vector<std::size_t> chosen = choice.with(1);
  const bool tooFew = double(chosen.size()) < least;
  if (!tooFew && double(chosen.size()) <= most) return chosen;
  // More frames as the spacing falls: bisects its logarithm, for a number near the limit that spacing 1 misses, and
  // keeps the nearest. A camera that hardly moves gives fewer frames.
  constexpr int kRounds = 10;
  constexpr double kSmallest = 0.05, kLargest = 20, kNearLimit = 0.8;
  if (tooFew)
    most = std::min(most, least / kNearLimit);
  else
    least = std::max(least, most * kNearLimit);
  const auto miss = [&](double count) { return count < least ? least / count : std::max(1.0, count / most); };
  double near = tooFew ? kSmallest : 1, far = tooFew ? 1 : kLargest;
  for (int round = 0; round < kRounds && miss(double(chosen.size())) > 1; ++round) {
    const double spacing = std::sqrt(near * far);
    std::vector<std::size_t> tried = choice.with(spacing);
    (double(tried.size()) < least ? far : near) = spacing;
    if (miss(double(tried.size())) < miss(double(chosen.size()))) chosen = std::move(tried);
  }
  return chosen;
}

}  // namespace ibr
