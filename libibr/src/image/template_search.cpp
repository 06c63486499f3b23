// SPDX-License-Identifier: Apache-2.0
#include "ibr/template_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "image/template_tasks.h"

namespace ibr {
namespace {

constexpr int kSide = 2 * kLargestTemplateRadius + 1;

// A picture's colours, each by itself, so that a row of displacements is a row of neighbours.
struct Planes {
  int width = 0, height = 0;
  std::array<std::vector<std::int16_t>, 3> plane;

  explicit Planes(const Image8& picture) : width(picture.width), height(picture.height) {
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    for (std::size_t c = 0; c < 3; ++c) {
      plane[c].resize(pixels);
      for (std::size_t p = 0; p < pixels; ++p) plane[c][p] = picture.values[3 * p + c];
    }
  }

  // `count` values from column x on of row y, both of which may lie outside; in `room` where they are not a piece of
  // the plane.
  const std::int16_t* row(std::size_t colour, int x, int y, int count, std::int16_t* room) const {
    const std::int16_t* start = &plane[colour][std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width)];
    if (x >= 0 && x + count <= width) return start + x;
    for (int k = 0; k < count; ++k) room[k] = start[std::clamp(x + k, 0, width - 1)];
    return room;
  }
};

// Adds a sample to the sums of a row of displacements.
void addDifferences(const std::int16_t* __restrict values, std::int16_t wanted, int count,
                    std::int32_t* __restrict sums) {
  for (int k = 0; k < count; ++k) {
    const int difference = values[k] - wanted;
    sums[k] += difference < 0 ? -difference : difference;
  }
}
void addProducts(const std::int16_t* __restrict values, std::int16_t wanted, int count, std::int32_t* __restrict sum,
                 std::int32_t* __restrict squares, std::int32_t* __restrict products) {
  for (int k = 0; k < count; ++k) {
    const std::int32_t value = values[k];
    sum[k] += value;
    squares[k] += value * value;
    products[k] += value * wanted;
  }
}

using Grid = std::array<std::int32_t, kSide * kSide>;

struct Window {
  const Planes& picture;
  std::span<const TemplateSample> samples;
  glm::ivec2 start;
  int radius;
  int side() const { return 2 * radius + 1; }

  // add(c, wanted colour, row of the picture, row of displacements) for each sample, colour and row.
  template <class Add>
  void forRows(Add&& add) const {
    std::array<std::int16_t, kSide> room;
    for (const TemplateSample& sample : samples) {
      const std::array<std::int16_t, 3> wanted{sample.red, sample.green, sample.blue};
      for (int dy = 0; dy < side(); ++dy)
        for (std::size_t c = 0; c < 3; ++c)
          add(c, wanted[c],
              picture.row(c, sample.x + start.x - radius, sample.y + start.y - radius + dy, side(), room.data()), dy);
    }
  }
};

void absoluteDifferences(const Window& window, std::vector<float>& cost) {
  Grid sums{};
  window.forRows([&](std::size_t, std::int16_t wanted, const std::int16_t* values, int dy) {
    addDifferences(values, wanted, window.side(), &sums[std::size_t(dy * window.side())]);
  });
  const float norm = 1.0f / (3.0f * float(window.samples.size()));
  for (std::size_t k = 0; k < cost.size(); ++k) cost[k] = float(sums[k]) * norm;
}

void correlation(const Window& window, std::vector<float>& cost) {
  std::array<Grid, 3> sum{}, squares{}, products{};
  window.forRows([&](std::size_t c, std::int16_t wanted, const std::int16_t* values, int dy) {
    const auto at = std::size_t(dy * window.side());
    addProducts(values, wanted, window.side(), &sum[c][at], &squares[c][at], &products[c][at]);
  });
  const double n = double(window.samples.size());
  std::array<double, 3> wantedSum{};
  double wantedVariance = 0;
  for (const TemplateSample& sample : window.samples) {
    const std::array<double, 3> wanted{double(sample.red), double(sample.green), double(sample.blue)};
    for (std::size_t c = 0; c < 3; ++c) wantedSum[c] += wanted[c], wantedVariance += n * wanted[c] * wanted[c];
  }
  for (std::size_t c = 0; c < 3; ++c) wantedVariance -= wantedSum[c] * wantedSum[c];
  for (std::size_t k = 0; k < cost.size(); ++k) {
    double common = 0, variance = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double s = sum[c][k];
      common += n * products[c][k] - s * wantedSum[c];
      variance += n * squares[c][k] - s * s;
    }
    const double scale = std::sqrt(variance * wantedVariance);
    cost[k] = scale > 0 ? float(1 - common / scale) : 1.0f;
  }
}

TemplateMatch best(const Window& window, const std::vector<float>& cost) {
  TemplateMatch match{window.start, std::numeric_limits<float>::infinity()};
  int distance = std::numeric_limits<int>::max();
  for (int dy = -window.radius; dy <= window.radius; ++dy)
    for (int dx = -window.radius; dx <= window.radius; ++dx) {
      const float here = cost[std::size_t((dy + window.radius) * window.side() + dx + window.radius)];
      if (here < match.cost || (here == match.cost && dx * dx + dy * dy < distance)) {
        match = {window.start + glm::ivec2(dx, dy), here};
        distance = dx * dx + dy * dy;
      }
    }
  return match;
}

}  // namespace

TemplateSearch processorTemplateSearch(std::span<const Image8* const> pictures) {
  checkTemplatePictures(pictures);
  auto planes = std::make_shared<std::vector<Planes>>();
  for (const Image8* picture : pictures) planes->emplace_back(*picture);
  return [planes](std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
                  TemplateMeasure measure) {
    checkTemplateTasks(tasks, samples, radius, planes->size());
    std::vector<TemplateMatch> matches;
    matches.reserve(tasks.size());
    std::vector<float> cost(std::size_t(2 * radius + 1) * std::size_t(2 * radius + 1));
    for (const TemplateTask& task : tasks) {
      if (task.count == 0) {
        matches.push_back({task.start, std::numeric_limits<float>::infinity()});
        continue;
      }
      const Window window{(*planes)[task.picture], samples.subspan(task.first, task.count), task.start, radius};
      (measure == TemplateMeasure::correlation ? correlation : absoluteDifferences)(window, cost);
      matches.push_back(best(window, cost));
    }
    return matches;
  };
}

}  // namespace ibr
