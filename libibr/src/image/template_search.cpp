// SPDX-License-Identifier: Apache-2.0
#include "ibr/template_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <glm/common.hpp>
#include <limits>
#include <memory>

#include "image/template_tasks.h"

namespace ibr {
namespace {

// Before loops over a block: GCC would unroll the loops before vectorising them.
#if defined(__GNUC__) && !defined(__clang__)
#define IBR_AS_LOOP _Pragma("GCC unroll 1")
#else
#define IBR_AS_LOOP
#endif

// Bytes of one comparison: up to five neighbours of a row and one unused byte.
constexpr std::size_t kBlock = 16;
constexpr int kBlockPixels = 5;
using Bytes = std::array<std::uint8_t, kBlock>;

// RGB, padded for reads of a block beyond the last pixel.
struct Picture {
  int width, height;
  std::vector<std::uint8_t> bytes;

  explicit Picture(const Image8& picture) : width(picture.width), height(picture.height), bytes(picture.values) {
    bytes.resize(bytes.size() + kBlock);
  }
  std::ptrdiff_t offset(int x, int y) const { return 3 * (std::ptrdiff_t(y) * width + x); }
};

struct Block {
  glm::ivec2 pixel;     // the first
  std::ptrdiff_t from;  // offset of its bytes from those of the displacement
  Bytes wanted{}, mask{};
};

// A template at one position in an image.
class Template {
 public:
  Template(std::span<const TemplateSample> samples, const Picture& picture, glm::ivec2 start, int radius)
      : picture_(picture), count_(samples.size()) {
    glm::ivec2 low(std::numeric_limits<int>::max()), high(std::numeric_limits<int>::min());
    int used = kBlockPixels;
    for (const TemplateSample& sample : samples) {
      const glm::ivec2 pixel(sample.x, sample.y);
      low = glm::min(low, pixel);
      high = glm::max(high, pixel);
      if (used == kBlockPixels || pixel != blocks_.back().pixel + glm::ivec2(used, 0)) {
        blocks_.push_back({pixel, 0});
        used = 0;
      }
      const auto at = std::size_t(3 * used++);
      const std::array colour{sample.red, sample.green, sample.blue};
      for (std::size_t c = 0; c < 3; ++c) blocks_.back().wanted[at + c] = colour[c], blocks_.back().mask[at + c] = 255;
    }
    low += start - radius;
    high += start + radius;
    inside_ = low.x >= 0 && low.y >= 0 && high.x < picture.width && high.y < picture.height;
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      blocks_[b].from = inside_ ? picture.offset(blocks_[b].pixel.x, blocks_[b].pixel.y) : std::ptrdiff_t(b * kBlock);
    if (!inside_) gathered_.resize(blocks_.size() * kBlock);
  }

  const std::vector<Block>& blocks() const { return blocks_; }
  double count() const { return double(count_); }

  // Base address of all blocks' `from` for a displacement.
  const std::uint8_t* at(glm::ivec2 displacement) {
    if (inside_) return picture_.bytes.data() + picture_.offset(displacement.x, displacement.y);
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      for (int k = 0; k < kBlockPixels; ++k) {
        const glm::ivec2 p = blocks_[b].pixel + displacement + glm::ivec2(k, 0);
        const std::uint8_t* from = picture_.bytes.data() + picture_.offset(std::clamp(p.x, 0, picture_.width - 1),
                                                                           std::clamp(p.y, 0, picture_.height - 1));
        std::copy(from, from + 3, &gathered_[b * kBlock + std::size_t(3 * k)]);
      }
    return gathered_.data();
  }

 private:
  const Picture& picture_;
  std::size_t count_;
  bool inside_;  // for all displacements
  std::vector<Block> blocks_;
  std::vector<std::uint8_t> gathered_;
};

class AbsoluteDifferences {
 public:
  explicit AbsoluteDifferences(const Template& wanted) : norm_(1.0f / (3.0f * float(wanted.count()))) {}

  float operator()(const std::vector<Block>& blocks, const std::uint8_t* values) const {
    int sum = 0;
    for (const Block& block : blocks) {
      const std::uint8_t* here = values + block.from;
      IBR_AS_LOOP
      for (std::size_t k = 0; k < kBlock; ++k) {
        const std::uint8_t value = here[k] & block.mask[k];
        sum += std::abs(int(value) - int(block.wanted[k]));
      }
    }
    return float(sum) * norm_;
  }

 private:
  float norm_;
};

class Correlation {
 public:
  explicit Correlation(const Template& wanted) : count_(wanted.count()) {
    Bytes all;
    all.fill(255);
    for (const Block& block : wanted.blocks()) add(wanted_, block.wanted.data(), block.wanted, all);
  }

  float operator()(const std::vector<Block>& blocks, const std::uint8_t* values) const {
    Sums sums;
    for (const Block& block : blocks) add(sums, values + block.from, block.wanted, block.mask);
    double common = count_ * sums.products, variance = count_ * sums.squares, wanted = count_ * wanted_.squares;
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = sums.colour(c), b = wanted_.colour(c);
      common -= a * b;
      variance -= a * a;
      wanted -= b * b;
    }
    const double scale = std::sqrt(variance * wanted);
    return scale > 0 ? float(1 - common / scale) : 1.0f;
  }

 private:
  struct Sums {
    std::array<int, kBlock> values{};  // of each byte of a block
    int squares = 0, products = 0;     // below 2³⁰ for 4096 samples
    int colour(std::size_t c) const {
      int sum = 0;
      for (std::size_t k = c; k < 3 * kBlockPixels; k += 3) sum += values[k];
      return sum;
    }
  };
  // One loop per sum: GCC would not vectorise a combined loop.
  static void add(Sums& sums, const std::uint8_t* values, const Bytes& wanted, const Bytes& mask) {
    std::array<std::int16_t, kBlock> a, b;
    int squares = 0, products = 0;
    IBR_AS_LOOP
    for (std::size_t k = 0; k < kBlock; ++k) a[k] = std::int16_t(values[k] & mask[k]);
    IBR_AS_LOOP
    for (std::size_t k = 0; k < kBlock; ++k) b[k] = wanted[k];
    IBR_AS_LOOP
    for (std::size_t k = 0; k < kBlock; ++k) sums.values[k] += a[k];
    IBR_AS_LOOP
    for (std::size_t k = 0; k < kBlock; ++k) squares += a[k] * a[k];
    IBR_AS_LOOP
    for (std::size_t k = 0; k < kBlock; ++k) products += a[k] * b[k];
    sums.squares += squares;
    sums.products += products;
  }

  double count_;
  Sums wanted_;
};

template <class Cost>
TemplateMatch best(Template& wanted, glm::ivec2 start, int radius) {
  const Cost cost(wanted);
  TemplateMatch match{start, std::numeric_limits<float>::infinity()};
  int distance = std::numeric_limits<int>::max();
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      const glm::ivec2 displacement = start + glm::ivec2(dx, dy);
      const float here = cost(wanted.blocks(), wanted.at(displacement));
      if (here < match.cost || (here == match.cost && dx * dx + dy * dy < distance)) {
        match = {displacement, here};
        distance = dx * dx + dy * dy;
      }
    }
  return match;
}

}  // namespace

TemplateSearch cpuTemplateSearch(std::span<const Image8* const> pictures) {
  checkTemplateImages(pictures);
  auto copies = std::make_shared<std::vector<Picture>>();
  for (const Image8* picture : pictures) copies->emplace_back(*picture);
  return [copies](std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
                  TemplateMeasure measure) {
    checkTemplateTasks(tasks, samples, radius, copies->size());
    std::vector<TemplateMatch> matches;
    matches.reserve(tasks.size());
    for (const TemplateTask& task : tasks) {
      if (task.count == 0) {
        matches.push_back({task.start, std::numeric_limits<float>::infinity()});
        continue;
      }
      Template wanted(samples.subspan(task.first, task.count), (*copies)[task.picture], task.start, radius);
      matches.push_back((measure == TemplateMeasure::correlation
                             ? best<Correlation>
                             : best<AbsoluteDifferences>)(wanted, task.start, radius));
    }
    return matches;
  };
}

}  // namespace ibr
