// SPDX-License-Identifier: Apache-2.0
// Template searches on the CPU and on a device, against a double-precision search that follows the contract in
// ibr/template_search.h directly.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <random>
#include <thread>

#include "base/vulkan/submit.h"
#include "ibr/template_search_pass.h"
#include "support/error_of.h"
#include "support/gpu.h"

using namespace ibr;
using namespace ibr::test;

namespace {

using Matches = std::vector<TemplateMatch>;
constexpr double kNone = std::numeric_limits<double>::infinity();

glm::dvec3 colourAt(const Image8& picture, glm::ivec2 at) {
  const auto p = picture.pixel(std::clamp(at.x, 0, picture.width - 1), std::clamp(at.y, 0, picture.height - 1));
  return {p[0], p[1], p[2]};
}

double costOf(const Image8& picture, std::span<const TemplateSample> samples, glm::ivec2 displacement,
              TemplateMeasure measure) {
  const double n = double(samples.size());
  if (samples.empty()) return kNone;
  double apart = 0;
  glm::dvec3 sumA(0), sumB(0), aa(0), bb(0), ab(0);
  for (const TemplateSample& s : samples) {
    const glm::dvec3 a = colourAt(picture, glm::ivec2(s.x, s.y) + displacement), b(s.red, s.green, s.blue);
    const glm::dvec3 d = glm::abs(a - b);
    apart += d.x + d.y + d.z;
    sumA += a, sumB += b, aa += a * a, bb += b * b, ab += a * b;
  }
  if (measure == TemplateMeasure::absoluteDifferences) return apart / (3 * n);
  const glm::dvec3 common = n * ab - sumA * sumB, varA = n * aa - sumA * sumA, varB = n * bb - sumB * sumB;
  const double scale = std::sqrt((varA.x + varA.y + varA.z) * (varB.x + varB.y + varB.z));
  return scale > 0 ? 1 - (common.x + common.y + common.z) / scale : 1;
}

struct Case {
  std::vector<Image8> pictures;
  std::vector<TemplateSample> samples;
  std::vector<TemplateTask> tasks;
  std::vector<const Image8*> views() const {
    std::vector<const Image8*> views;
    for (const Image8& picture : pictures) views.push_back(&picture);
    return views;
  }
  std::span<const TemplateSample> of(const TemplateTask& task) const {
    return std::span(samples).subspan(task.first, task.count);
  }
};

Matches reference(const Case& all, int radius, TemplateMeasure measure) {
  Matches matches;
  for (const TemplateTask& task : all.tasks) {
    TemplateMatch best{task.start, float(kNone)};
    double least = kNone;
    int nearest = 0;
    for (int y = -radius; y <= radius; ++y)
      for (int x = -radius; x <= radius; ++x) {
        const double cost = costOf(all.pictures[task.picture], all.of(task), task.start + glm::ivec2(x, y), measure);
        if (cost < least || (cost == least && cost < kNone && x * x + y * y < nearest)) {
          best = {task.start + glm::ivec2(x, y), float(cost)};
          least = cost;
          nearest = x * x + y * y;
        }
      }
    matches.push_back(best);
  }
  return matches;
}

enum class Look { noise, flat, stripes };

Image8 pictureOf(int width, int height, Look look, std::mt19937& random) {
  Image8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        picture.pixel(x, y)[c] = look == Look::noise  ? std::uint8_t(random() & 255u)
                                 : look == Look::flat ? std::uint8_t(90)
                                                      : std::uint8_t(x % 4 < 2 ? 0 : 255);
  return picture;
}

// Adds a task: samples of a rectangle with gaps, cut from its image with noise.
void addTask(Case& all, std::uint32_t picture, glm::ivec2 corner, glm::ivec2 size, glm::ivec2 start, int noise,
             std::mt19937& random) {
  const auto first = std::uint32_t(all.samples.size());
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      if (random() % 7 == 0) continue;
      const glm::ivec2 at = corner + glm::ivec2(x, y);
      const glm::dvec3 colour = colourAt(all.pictures[picture], at + glm::ivec2(2, -1));
      const auto level = [&](double v) {
        const int by = noise > 0 ? int(random() % unsigned(2 * noise + 1)) - noise : 0;
        return std::uint8_t(std::clamp(int(v) + by, 0, 255));
      };
      all.samples.push_back(
          {std::int16_t(at.x), std::int16_t(at.y), level(colour.x), level(colour.y), level(colour.z)});
    }
  all.tasks.push_back({picture, first, std::uint32_t(all.samples.size()) - first, start});
}

// Noise, a flat image and stripes with many equal matches; tasks inside the images, over borders, and far outside.
Case manyCases(unsigned seed) {
  std::mt19937 random(seed);
  Case all;
  all.pictures = {pictureOf(67, 41, Look::noise, random), pictureOf(32, 50, Look::flat, random),
                  pictureOf(48, 40, Look::stripes, random), pictureOf(1, 1, Look::noise, random)};
  for (std::uint32_t p = 0; p < 4; ++p)
    for (int k = 0; k < 6; ++k) {
      const Image8& picture = all.pictures[p];
      const glm::ivec2 corner(int(random() % unsigned(picture.width + 8)) - 4,
                              int(random() % unsigned(picture.height + 8)) - 4);
      addTask(all, p, corner, {1 + int(random() % 19u), 1 + int(random() % 9)},
              {int(random() % 7) - 3, int(random() % 7) - 3}, k % 3 == 0 ? 0 : 20, random);
    }
  // Exact samples inside, and samples whose best match lies over one border.
  addTask(all, 0, {60, 12}, {6, 5}, {}, 0, random);
  addTask(all, 0, {20, 1}, {9, 3}, {0, -1}, 0, random);
  addTask(all, 0, {20, 36}, {9, 5}, {1, 0}, 0, random);
  addTask(all, 0, {0, 12}, {6, 5}, {}, 0, random);
  addTask(all, 0, {-5000, 300}, {5, 5}, {5020, -290}, 0, random);
  addTask(all, 0, {30, 20}, {4, 4}, {kMaxTemplateStartPx, -kMaxTemplateStartPx}, 0, random);
  all.tasks.push_back({1, 3, 0, {7, -9}});  // without samples
  // Samples in random order, one of them twice, some far apart.
  const auto first = std::uint32_t(all.samples.size());
  for (int k = 0; k < 40; ++k)
    all.samples.push_back({std::int16_t(random() % 67), std::int16_t(random() % 41), std::uint8_t(random()),
                           std::uint8_t(random()), std::uint8_t(random())});
  all.samples.push_back(all.samples.back());
  all.samples.push_back({-32768, 32767, 1, 2, 3});
  all.tasks.push_back({0, first, std::uint32_t(all.samples.size()) - first, {1, 1}});
  all.tasks.push_back({0, first + 7, 1, {}});  // a range that shares samples with the previous task
  return all;
}

Matches onDevice(const Case& all, int radius, TemplateMeasure measure) {
  return deviceTemplateSearch(testDevice())(all.views())(all.tasks, all.samples, radius, measure);
}
Matches onProcessor(const Case& all, int radius, TemplateMeasure measure) {
  return cpuTemplateSearch(all.views())(all.tasks, all.samples, radius, measure);
}

void expectSame(const Matches& a, const Matches& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t t = 0; t < a.size(); ++t) {
    CAPTURE(t);
    CHECK(a[t].displacement == b[t].displacement);
    CHECK(a[t].cost == b[t].cost);
  }
}

void expectCloseCorrelation(const Case& all, const Matches& matches, const Matches& wanted, int radius,
                            double tolerance) {
  REQUIRE(matches.size() == wanted.size());
  for (std::size_t t = 0; t < matches.size(); ++t) {
    CAPTURE(t);
    if (std::isinf(wanted[t].cost)) {
      CHECK(matches[t].displacement == wanted[t].displacement);
      CHECK(std::isinf(matches[t].cost));
      continue;
    }
    CHECK(std::abs(double(matches[t].cost) - double(wanted[t].cost)) <= tolerance);
    // Another match is allowed if its cost is as low.
    const TemplateTask& task = all.tasks[t];
    const glm::ivec2 way = glm::abs(matches[t].displacement - task.start);
    CHECK(std::max(way.x, way.y) <= radius);
    CHECK(std::abs(
              costOf(all.pictures[task.picture], all.of(task), matches[t].displacement, TemplateMeasure::correlation) -
              double(wanted[t].cost)) <= tolerance);
  }
}

}  // namespace

TEST_CASE("absolute differences: CPU and device find the same matches as the reference") {
  const int radius = GENERATE(0, 1, 2, 8, kMaxTemplateRadius);
  const Case all = manyCases(unsigned(radius) + 1);
  const Matches processor = onProcessor(all, radius, TemplateMeasure::absoluteDifferences);
  const Matches wanted = reference(all, radius, TemplateMeasure::absoluteDifferences);
  REQUIRE(processor.size() == wanted.size());
  for (std::size_t t = 0; t < wanted.size(); ++t) {
    CAPTURE(t);
    CHECK(processor[t].displacement == wanted[t].displacement);
    CHECK((processor[t].cost == wanted[t].cost || std::abs(processor[t].cost - wanted[t].cost) < 1e-4));
  }
  expectSame(onDevice(all, radius, TemplateMeasure::absoluteDifferences), processor);
}

TEST_CASE("correlation: CPU and device find the same matches as the reference up to rounding") {
  const int radius = GENERATE(0, 3, 9);
  const Case all = manyCases(unsigned(radius) + 100);
  const Matches wanted = reference(all, radius, TemplateMeasure::correlation);
  expectCloseCorrelation(all, onProcessor(all, radius, TemplateMeasure::correlation), wanted, radius, 1e-6);
  expectCloseCorrelation(all, onDevice(all, radius, TemplateMeasure::correlation), wanted, radius, 4e-6);
}

TEST_CASE("the largest template with the largest contrast does not overflow", "[N12]") {
  std::mt19937 random(5);
  Case all;
  all.pictures = {Image8(80, 80, 3)};
  for (std::uint8_t& v : all.pictures[0].values) v = random() & 1 ? 255 : 0;
  for (int k = 0; k < int(kMaxTemplateSampleCount); ++k) {
    const auto p = all.pictures[0].pixel(8 + k % 64, 8 + k / 64);
    all.samples.push_back({std::int16_t(8 + k % 64), std::int16_t(8 + k / 64), std::uint8_t(255 - p[0]),
                           std::uint8_t(255 - p[1]), std::uint8_t(255 - p[2])});
  }
  all.tasks = {{0, 0, kMaxTemplateSampleCount, {}}};
  for (const Matches& matches : {onProcessor(all, 0, TemplateMeasure::absoluteDifferences),
                                 onDevice(all, 0, TemplateMeasure::absoluteDifferences)})
    CHECK(matches[0].cost == Approx(255));
  for (const Matches& matches :
       {onProcessor(all, 0, TemplateMeasure::correlation), onDevice(all, 0, TemplateMeasure::correlation)})
    CHECK(matches[0].cost == Approx(2));
}

TEST_CASE("tasks beyond the capacity are searched in batches, from several threads") {
  std::mt19937 random(9);
  Case all;
  all.pictures = {pictureOf(64, 64, Look::noise, random)};
  addTask(all, 0, {20, 20}, {6, 5}, {}, 0, random);
  addTask(all, 0, {2, 30}, {7, 3}, {}, 0, random);
  addTask(all, 0, {9, 11}, {13, 17}, {}, 0, random);
  for (int k = 0; k < 34000; ++k) {  // first the samples exceed the size of a piece, then the tasks
    all.tasks.push_back(all.tasks[std::size_t(k < 17000 ? k % 3 : (k + 1) % 2)]);
    all.tasks.back().start = {k % 5 - 2, k % 3 - 1};
  }
  const Matches wanted = onProcessor(all, 1, TemplateMeasure::absoluteDifferences);
  const TemplateSearchFactory make = deviceTemplateSearch(testDevice());
  const TemplateSearch one = make(all.views()), other = make(all.views());
  Matches byOne, byOther;
  std::thread thread([&] { byOne = one(all.tasks, all.samples, 1, TemplateMeasure::absoluteDifferences); });
  byOther = other(all.tasks, all.samples, 1, TemplateMeasure::absoluteDifferences);
  thread.join();
  const auto same = [](const TemplateMatch& a, const TemplateMatch& b) {
    return a.displacement == b.displacement && a.cost == b.cost;
  };
  CHECK(std::ranges::equal(byOne, wanted, same));
  CHECK(std::ranges::equal(byOther, wanted, same));
}

TEST_CASE("a pass can be recorded repeatedly into the caller's commands") {
  const Case all = manyCases(3);
  TemplateSearchPass pass(testDevice(), all.views(), {all.tasks.size(), all.samples.size()});
  const std::span tasks(all.tasks);
  for (const std::size_t count : {all.tasks.size(), std::size_t(3), std::size_t(0), all.tasks.size()}) {
    pass.set(tasks.first(count), all.samples, 2, TemplateMeasure::absoluteDifferences);
    submitAndWait(testDevice(), [&](VkCommandBuffer commands) {
      pass.record(commands);
      pass.record(commands);
    });
    expectSame(pass.matches(), cpuTemplateSearch(all.views())(tasks.first(count), all.samples, 2,
                                                              TemplateMeasure::absoluteDifferences));
  }
  CHECK(errorOf([&] {
          pass.set(std::vector<TemplateTask>(all.tasks.size() + 1), all.samples, 2, TemplateMeasure::correlation);
        }).code() == ErrorCode::invalidInput);
}

TEST_CASE("images beyond the device's limits are refused as unsupported") {
  const Image8 picture(1024, 1024, 3);
  const std::size_t most = testDevice().properties().limits.maxStorageBufferRange >> 22;
  const std::vector<const Image8*> tooMany(most + 1, &picture);
  const Error error = errorOf([&] { deviceTemplateSearch(testDevice())(tooMany); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Catch::Contains(std::to_string(4 * tooMany.size()) + " MiB"));
  const std::vector<const Image8*> one{&picture};
  CHECK(errorOf([&] {
          TemplateSearchPass(testDevice(), one, {std::size_t(1) << 40, 1});
        }).code() == ErrorCode::unsupported);
  CHECK(errorOf([&] { TemplateSearchPass(testDevice(), one, {1, 0}); }).code() == ErrorCode::invalidInput);
}

TEST_CASE("CPU and device searches refuse the same input") {
  const Image8 picture(4, 4, 3), grey(4, 4, 1), none;
  const std::vector<const Image8*> good{&picture};
  const std::vector<TemplateSample> samples(5000);
  for (const TemplateSearchFactory& make :
       {TemplateSearchFactory(cpuTemplateSearch), deviceTemplateSearch(testDevice())}) {
    for (const Image8* bad : {&grey, &none})
      CHECK(errorOf([&] { make(std::vector{bad}); }).code() == ErrorCode::invalidInput);
    const TemplateSearch search = make(good);
    const auto refused = [&](TemplateTask task, int radius) {
      return errorOf([&] {
               search({&task, 1}, samples, radius, TemplateMeasure::absoluteDifferences);
             }).code() == ErrorCode::invalidInput;
    };
    CHECK(refused({0, 0, 1, {}}, -1));
    CHECK(refused({0, 0, 1, {}}, kMaxTemplateRadius + 1));
    CHECK(refused({1, 0, 1, {}}, 1));
    CHECK(refused({0, 0, kMaxTemplateSampleCount + 1, {}}, 1));
    CHECK(refused({0, 4999, 2, {}}, 1));
    CHECK(refused({0, 0xffffffffu, 2, {}}, 1));
    CHECK(refused({0, 0, 1, {kMaxTemplateStartPx + 1, 0}}, 1));
    CHECK(refused({0, 0, 1, {0, std::numeric_limits<int>::min()}}, 1));
    CHECK(search({}, {}, 1, TemplateMeasure::correlation).empty());
  }
}
