// SPDX-License-Identifier: Apache-2.0
#include "author/textureless.h"

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>
#include <vector>

namespace ibr {
namespace {

constexpr float kFlat = 2.0f;       // grey levels from pixel to pixel, smoothed
constexpr int kIndifferent = 30;    // ε, of costs up to kCostLargest
constexpr std::size_t kLeast = 80;  // px of a region
constexpr float kOnPlane = 1.0f;    // levels
constexpr double kSurface = 0.6;    // share of the border on one plane that makes it a surface
constexpr double kFarthest = 0.1;   // of the border's levels, sorted
constexpr float kAllBut = 3.0f;     // levels from infinity
constexpr int kTries = 64;

class Settler {
 public:
  Settler(ImageF& level, const CostVolume& volume)
      : level_(level), volume_(volume), width_(level.width), height_(level.height), flat_(level.values.size(), 0) {}

  void run() {
    findFlat();
    std::vector<int> region, border;
    std::vector<int> seen(flat_.size(), 0);  // by the number of a region
    int number = 0;
    for (int seed = 0; seed < width_ * height_; ++seed) {
      if (!flat_[std::size_t(seed)] || seen[std::size_t(seed)]) continue;
      collect(seed, ++number, seen, region, border);
      if (region.size() < kLeast || border.empty()) continue;
      const auto plane = commonPlane(border);
      const float far = farthest(border);
      for (const int at : region) {
        const float behind = plane ? float(plane->x + plane->y * (at % width_) + plane->z * (at / width_)) : far;
        float& here = level_.values[std::size_t(at)];
        here = std::min(here, behind <= kAllBut ? 0.0f : behind);
      }
    }
  }

 private:
  void findFlat() {
    const cv::Mat guide(height_, width_, CV_32F, const_cast<float*>(volume_.guide.values.data()));
    cv::Mat smooth, low, high;
    cv::blur(guide, smooth, {3, 3}, {-1, -1}, cv::BORDER_REPLICATE);
    const cv::Mat around = cv::Mat::ones(3, 3, CV_8U);
    cv::erode(smooth, low, around);
    cv::dilate(smooth, high, around);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const std::size_t at = std::size_t(y) * std::size_t(width_) + std::size_t(x);
        const std::uint8_t* const cost = &volume_.cost[at * std::size_t(volume_.levels)];
        const std::uint8_t best = *std::min_element(cost, cost + volume_.levels);
        flat_[at] = high.at<float>(y, x) - low.at<float>(y, x) <= 2 * kFlat && cost[0] <= best + kIndifferent;
      }
  }

  void collect(int seed, int number, std::vector<int>& seen, std::vector<int>& region, std::vector<int>& border) const {
    region.assign(1, seed);
    border.clear();
    seen[std::size_t(seed)] = number;
    for (std::size_t k = 0; k < region.size(); ++k) {
      const int x = region[k] % width_, y = region[k] / width_;
      const auto grow = [&](int u, int v) {
        if (u < 0 || v < 0 || u >= width_ || v >= height_) return;
        const int to = v * width_ + u;
        if (seen[std::size_t(to)] == number) return;
        if (flat_[std::size_t(to)]) {
          seen[std::size_t(to)] = number;
          region.push_back(to);
        } else {
          seen[std::size_t(to)] = number;
          border.push_back(to);
        }
      };
      grow(x - 1, y), grow(x + 1, y), grow(x, y - 1), grow(x, y + 1);
    }
  }

  float farthest(const std::vector<int>& border) const {
    std::vector<float> levels;
    for (const int at : border) levels.push_back(level_.values[std::size_t(at)]);
    const auto part = levels.begin() + std::ptrdiff_t(kFarthest * double(levels.size()));
    std::nth_element(levels.begin(), part, levels.end());
    return *part;
  }

  // The plane of levels (value at pixel 0, 0; per pixel in x; in y) that most of the border lies on, if there is one:
  // RANSAC, with the same tries every time.
  std::optional<glm::dvec3> commonPlane(const std::vector<int>& border) const {
    const auto place = [&](int at) {
      return glm::dvec3(at % width_, at / width_, double(level_.values[std::size_t(at)]));
    };
    std::mt19937 random(1);
    std::ptrdiff_t most = std::ptrdiff_t(std::ceil(kSurface * double(border.size()))) - 1;
    std::optional<glm::dvec3> best;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const auto pick = [&] { return place(border[random() % border.size()]); };
      const glm::dvec3 a = pick(), b = pick() - a, c = pick() - a;
      const double turn = b.x * c.y - b.y * c.x;
      if (std::abs(turn) < 1) continue;
      const double slopeX = (b.z * c.y - b.y * c.z) / turn, slopeY = (b.x * c.z - b.z * c.x) / turn;
      const glm::dvec3 plane(a.z - slopeX * a.x - slopeY * a.y, slopeX, slopeY);
      const auto on = std::ranges::count_if(border, [&](int at) {
        const glm::dvec3 p = place(at);
        return std::abs(plane.x + plane.y * p.x + plane.z * p.y - p.z) <= double(kOnPlane);
      });
      if (on > most) most = on, best = plane;
    }
    return best;
  }

  ImageF& level_;
  const CostVolume& volume_;
  int width_, height_;
  std::vector<char> flat_;
};

}  // namespace

void settleTextureless(ImageF& level, const CostVolume& volume) {
  Settler(level, volume).run();
}

}  // namespace ibr
