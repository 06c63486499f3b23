// SPDX-License-Identifier: Apache-2.0
// Colour tables made on the device equal the reference implementation bit for bit, also while they adapt over frames.
#include "render/passes/colour_tables.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <random>

#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/submit.h"
#include "gpu/transfer/readback.h"
#include "gpu/transfer/upload.h"
#include "image/blue_noise.h"
#include "reference/colour_reference.h"
#include "shared/cell.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kWidth = 90, kHeight = 70, kColumns = 3;
constexpr std::uint32_t kEverything = shader::kNoiseSize * shader::kNoiseSize;

// Overlapping windows on one random image, each cell with its own gain and gamma.
std::vector<Image8> cellPictures(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  Image8 scene(kWidth, kHeight, 3);
  for (std::uint8_t& v : scene.values) v = std::uint8_t(20 + random() % 180);
  std::vector<Image8> pictures;
  for (int k = 0; k < count; ++k) {
    Image8 picture(kWidth, kHeight, 4);
    const int x0 = int(random() % 50), x1 = x0 + 20 + int(random() % 60);
    const double gain = 0.75 + double(random() % 100) / 200, gamma = 0.8 + double(random() % 100) / 250;
    for (int y = 0; y < kHeight; ++y)
      for (int x = std::max(0, x0); x < std::min(kWidth, x1); ++x) {
        for (std::size_t c = 0; c < 3; ++c)
          picture.pixel(x, y)[c] = std::uint8_t(
              std::clamp(std::lround(255 * gain * std::pow(scene.pixel(x, y)[c] / 255.0, gamma)), 0l, 255l));
        picture.pixel(x, y)[3] = 255;
      }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

shader::ColourFrame frameOf(std::uint32_t count) {
  shader::ColourFrame frame{};
  frame.count = count;
  frame.joint = 1;
  frame.method = shader::kMapPreserving;
  frame.least = 64;
  frame.kept = kEverything;
  frame.measured = 1;
  frame.mainShare = frame.share = shader::kWhole;
  frame.maxStep = 256 * shader::kFine;
  frame.tileColumns = kColumns;
  frame.tileWidth = kWidth;
  frame.tileHeight = kHeight;
  for (std::uint32_t k = 0; k < count; ++k) {
    frame.slot[k] = (5 * k + 3) % kColourSlotCount;
    frame.owner[k] = 100 + k;
  }
  return frame;
}

class Bench {
 public:
  explicit Bench(std::uint32_t cells) : Bench(cells, Uploader(testDevice())) {}
  Bench(std::uint32_t cells, Uploader&& uploader)
      : tables_(testDevice(), cells, uploader),
        rows_(int((cells + kColumns - 1) / kColumns)),
        proxy_(testDevice(),
               {.format = VK_FORMAT_R8G8B8A8_UNORM,
                .extent = {kColumns * kWidth, std::uint32_t(rows_ * kHeight)},
                .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT},
               "proxy"),
        set_(tables_.makeSet(testDevice(), proxy_.view(), VK_NULL_HANDLE)) {
    uploader.flush();
  }

  std::vector<reference::CellTable> run(const std::vector<Image8>& pictures, const shader::ColourFrame& frame) {
    Image8 atlas(kColumns * kWidth, rows_ * kHeight, 4);
    for (std::size_t k = 0; k < pictures.size(); ++k)
      for (int y = 0; y < kHeight; ++y)
        std::copy_n(pictures[k].pixel(0, y).data(), 4 * kWidth,
                    atlas.pixel(int(k) % kColumns * kWidth, int(k) / kColumns * kHeight + y).data());
    Uploader uploader(testDevice());
    uploader.image(proxy_, 0, 0, proxy_.info().extent, std::as_bytes(std::span(atlas.values)));
    uploader.flush();
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) { record(commands, frame); });
    return read(frame);
  }

  void record(VkCommandBuffer commands, const shader::ColourFrame& frame) {
    tables_.begin(commands, frame);
    if (frame.measured) tables_.count(commands, set_, frame);
    tables_.chain(commands, set_, 0, frame.count);
  }

  std::vector<reference::CellTable> read(const shader::ColourFrame& frame) {
    const std::vector<std::byte> bytes = readBuffer(testDevice(), tables_.tablesBuffer());
    std::vector<std::uint32_t> entries(bytes.size() / 4);
    std::memcpy(entries.data(), bytes.data(), bytes.size());
    std::vector<reference::CellTable> all(frame.count);
    for (std::uint32_t k = 0; k < frame.count; ++k)
      for (std::uint32_t i = 0; i < 256; ++i)
        for (std::uint32_t c = 0; c < 3; ++c)
          all[k][c][i] = std::uint8_t(shader::packedLevel(entries[frame.slot[k] * 256 + i], c));
    return all;
  }

  const ColourTables& tables() const { return tables_; }

 private:
  ColourTables tables_;
  int rows_;
  GpuImage proxy_;
  VkDescriptorSet set_;
};

reference::MappedCells expectedTables(const std::vector<Image8>& pictures, const shader::ColourFrame& frame) {
  return {pictures, blueNoise(shader::kNoiseSize, 1), frame.kept, frame.method, frame.least};
}

int largestStep(const std::vector<reference::CellTable>& a, const std::vector<reference::CellTable>& b) {
  int largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < 256; ++i) largest = std::max(largest, std::abs(a[k][c][i] - b[k][c][i]));
  return largest;
}

reference::CellTable identity() {
  reference::CellTable table;
  table.fill(identityTable());
  return table;
}

}  // namespace

TEST_CASE("colour tables of the device equal the reference bit for bit", "[N9][T16][P7]") {
  for (int count : {1, 2, 3, 7, 12}) {
    Bench bench{std::uint32_t(count)};
    for (std::uint32_t method : {shader::kMapNaive, shader::kMapStrict, shader::kMapPreserving})
      for (std::uint32_t kept : {0u, 100u, kEverything / 2, kEverything}) {
        const std::vector<Image8> pictures = cellPictures(count, 7 * kept + method + std::uint32_t(count));
        shader::ColourFrame frame = frameOf(std::uint32_t(count));
        frame.method = method;
        frame.kept = kept;
        std::fill_n(frame.fresh, count, 1u);
        INFO(count << " cells, method " << method << ", kept " << kept);
        CHECK(bench.run(pictures, frame) == reference::tables(expectedTables(pictures, frame)));
      }
  }
}

TEST_CASE("colour tables are exact without overlap, with one level, no pixels, and all white", "[N9]") {
  Bench bench(4);
  std::vector<Image8> pictures = cellPictures(4, 3);
  pictures[1].values.assign(pictures[1].values.size(), 0);
  pictures[2].values.assign(pictures[2].values.size(), 255);
  for (std::size_t at = 0; at < pictures[3].values.size(); ++at) pictures[3].values[at] = at % 4 == 3 ? 255 : 7;
  shader::ColourFrame frame = frameOf(4);
  for (std::uint32_t least : {1u, 64u, 1000u, 5000u, 1u << 20}) {
    frame.least = least;
    std::fill_n(frame.fresh, 4, 1u);
    const std::vector<reference::CellTable> tables = bench.run(pictures, frame);
    CHECK(tables == reference::tables(expectedTables(pictures, frame)));
    CHECK(tables[0] == identity());
    CHECK(tables[1] == identity());
  }
}

TEST_CASE("64 cells are counted, and nothing is written outside the histograms") {
  Bench bench(64);
  const std::vector<Image8> pictures = cellPictures(64, 21);
  shader::ColourFrame frame = frameOf(64);
  for (std::uint32_t k = 0; k < 64; ++k) frame.slot[k] = 127 - k;
  CHECK(bench.run(pictures, frame) == reference::tables(expectedTables(pictures, frame)));

  // A smaller frame uses only the beginning of the counters. The rest of the large frame serves as a canary.
  const std::vector<std::byte> before = readBuffer(testDevice(), bench.tables().counters());
  shader::ColourFrame small = frameOf(3);
  const std::vector<Image8> few(pictures.begin(), pictures.begin() + 3);
  bench.run(few, small);
  const std::vector<std::byte> after = readBuffer(testDevice(), bench.tables().counters());
  const std::size_t used = 4 * shader::counterCount(3, true);
  CHECK(std::equal(before.begin() + std::ptrdiff_t(used), before.end(), after.begin() + std::ptrdiff_t(used)));
  CHECK_FALSE(std::equal(before.begin(), before.begin() + std::ptrdiff_t(used), after.begin()));
}

TEST_CASE("a table approaches its target in bounded steps and stays there") {
  Bench bench(3);
  const std::vector<Image8> before = cellPictures(3, 31), after = cellPictures(3, 32);
  shader::ColourFrame frame = frameOf(3);
  std::vector<reference::CellTable> shown = bench.run(before, frame);  // no previous tables: shown at once
  CHECK(shown == reference::tables(expectedTables(before, frame)));
  const std::vector<reference::CellTable> target = reference::tables(expectedTables(after, frame));
  REQUIRE(largestStep(shown, target) > 8);
  frame.share = shader::kWhole / 4;
  frame.maxStep = 2 * shader::kFine;
  int frames = 0;
  for (; frames < 200; ++frames) {
    const std::vector<reference::CellTable> next = bench.run(after, frame);
    CHECK(largestStep(shown, next) <= 2);
    for (const reference::CellTable& cell : next)
      for (const LevelTable& table : cell) CHECK(std::is_sorted(table.begin(), table.end()));
    const bool rests = next == shown;
    shown = next;
    if (rests && shown == target) break;
  }
  CHECK(shown == target);
  CHECK(frames > 4);

  SECTION("a frame without measurement keeps its target") {
    frame.measured = 0;
    CHECK(bench.run(before, frame) == target);
  }
  SECTION("zero time step keeps tables") {
    frame.share = 0;
    CHECK(bench.run(before, frame) == target);
  }
  SECTION("an unsubmitted frame of other cells has no effect") {
    shader::ColourFrame other = frame;
    for (std::uint32_t k = 0; k < 3; ++k) other.owner[k] = 200 + k;
    const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                           .queueFamilyIndex = testDevice().queueFamily()};
    const CommandPoolHandle pool = make<CommandPoolHandle>(testDevice(), vkCreateCommandPool, poolInfo, "pool");
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool.get(),
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    VkCommandBuffer commands = VK_NULL_HANDLE;
    REQUIRE(vkAllocateCommandBuffers(testDevice().handle(), &info, &commands) == VK_SUCCESS);
    const VkCommandBufferBeginInfo beginInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    REQUIRE(vkBeginCommandBuffer(commands, &beginInfo) == VK_SUCCESS);
    bench.record(commands, other);
    REQUIRE(vkEndCommandBuffer(commands) == VK_SUCCESS);
    CHECK(bench.run(after, frame) == target);
    // A plan that assumes the unsubmitted frame finds slots of another owner, so its tables start from the beginning.
    other.share = 0;
    CHECK(bench.run(before, other) == reference::tables(expectedTables(before, other)));
  }
}

TEST_CASE("the main cell's table approaches the identity in equal steps") {
  Bench bench(2);
  const std::vector<Image8> pictures = cellPictures(2, 41);
  shader::ColourFrame frame = frameOf(2);
  const reference::CellTable start = bench.run(pictures, frame)[1];
  REQUIRE(start != identity());
  // The second cell becomes the main cell.
  std::swap(frame.slot[0], frame.slot[1]);
  std::swap(frame.owner[0], frame.owner[1]);
  const std::vector<Image8> swapped{pictures[1], pictures[0]};
  frame.share = shader::kWhole / 8;
  for (int step = 1; step <= 10; ++step) {
    frame.mainShare = shader::kWhole / std::uint32_t(11 - step);
    const reference::CellTable main = bench.run(swapped, frame)[0];
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < 256; ++i) {
        const double expected = start[c][i] + (double(i) - start[c][i]) * step / 10;
        REQUIRE(std::abs(main[c][i] - expected) <= 0.6);
      }
    if (step == 10) CHECK(main == identity());
  }
}
