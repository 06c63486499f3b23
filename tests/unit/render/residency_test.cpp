// SPDX-License-Identifier: Apache-2.0
#include "render/resident/residency.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <numeric>
#include <random>
#include <set>

using namespace ibr;
using Step = Residency::Step;

namespace {

// Carries out the residency's steps and checks its rules.
class Device {
 public:
  Device(std::vector<Residency::Class> classes, std::vector<std::uint32_t> classOf, std::uint64_t budget)
      : residency(classes, classOf, {budget}),
        classes_(std::move(classes)),
        classOf_(std::move(classOf)),
        budget_(budget) {}

  // Loads arrive at once, at most `loads` of them.
  Residency::Counts frame(const std::vector<std::uint32_t>& wanted, std::size_t needed, std::uint64_t number,
                          std::uint64_t completed, int loads = 1000) {
    residency.begin(wanted, needed, number, completed);
    while (loads > 0) {
      const auto step = residency.next();
      if (!step) break;
      if (step->kind == Step::Kind::makeArray) {
        REQUIRE_FALSE(arrays_.contains(step->array));
        arrays_[step->array] = {step->itemClass, 0};
      } else if (step->kind == Step::Kind::freeArray) {
        REQUIRE(arrays_.contains(step->array));
        REQUIRE(arrays_[step->array].lastFrame <= completed);
        arrays_.erase(step->array);
      } else {
        REQUIRE(arrays_.contains(step->array));
        REQUIRE(step->layer < classes_[arrays_[step->array].itemClass].layersPerArray);
        // No unfinished frame may use the photograph that is in the slot.
        const std::pair slot{step->array, step->layer};
        REQUIRE(layerUse_[slot] <= completed);
        layerUse_[slot] = arrays_[step->array].lastFrame = number;
        residency.finishLoad(step->item);
        ++loaded;
        --loads;
      }
      std::uint64_t bytes = 0;
      for (const auto& [array, of] : arrays_) bytes += classes_[of.itemClass].arrayBytes;
      REQUIRE(bytes == residency.arrayBytes());
      REQUIRE(bytes <= budget_);
    }
    const Residency::Counts counts = residency.endFrame();
    std::set<std::pair<std::uint32_t, std::uint32_t>> slots;
    std::uint32_t here = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (classOf_[wanted[i]] == Residency::kNone)
        here += i < needed;
      else if (const auto slot = residency.slot(wanted[i])) {
        REQUIRE(slots.insert({slot->array, slot->layer}).second);
        if (i >= needed) continue;
        ++here;
        layerUse_[{slot->array, slot->layer}] = arrays_[slot->array].lastFrame = number;
      }
    CHECK(here + counts.waiting + counts.overBudget + counts.failed == needed);
    return counts;
  }

  Residency residency;
  int loaded = 0;

 private:
  struct PageOf {
    std::uint32_t itemClass;
    std::uint64_t lastFrame;
  };
  std::vector<Residency::Class> classes_;
  std::vector<std::uint32_t> classOf_;
  std::uint64_t budget_;
  std::map<std::uint32_t, PageOf> arrays_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> layerUse_;
};

std::vector<std::uint32_t> range(std::uint32_t first, std::uint32_t count) {
  std::vector<std::uint32_t> values(count);
  std::iota(values.begin(), values.end(), first);
  return values;
}

std::vector<std::uint32_t> ofOneClass(std::size_t count) {
  return std::vector<std::uint32_t>(count, 0);
}

}  // namespace

TEST_CASE("photographs that fit are loaded and stay") {
  Device device({{100, 4}}, ofOneClass(10), 250);  // two texture arrays of four layers
  CHECK(device.frame(range(0, 8), 3, 1, 0).waiting == 0);
  CHECK(device.loaded == 8);
  for (std::uint32_t p = 0; p < 8; ++p) CHECK(device.residency.slot(p));
  CHECK(device.frame(range(0, 8), 3, 2, 1).waiting == 0);
  CHECK(device.loaded == 8);
}

TEST_CASE("the most urgent photographs are loaded first") {
  Device device({{100, 4}}, ofOneClass(10), 100);
  const auto counts = device.frame({7, 3, 9, 1}, 3, 1, 0, 2);
  CHECK(device.residency.slot(7));
  CHECK(device.residency.slot(3));
  CHECK_FALSE(device.residency.slot(9));
  CHECK(counts.waiting == 1);
  CHECK(counts.overBudget == 0);
}

TEST_CASE("a shown photograph is not displaced by photographs of lower rank") {
  Device device({{100, 4}}, ofOneClass(10), 100);
  device.frame(range(0, 4), 4, 1, 0);
  const auto counts = device.frame(range(0, 6), 6, 2, 1);
  CHECK(counts.overBudget == 2);  // photographs 4 and 5
  CHECK(device.loaded == 4);
  device.frame(range(0, 8), 4, 3, 2);
  CHECK(device.loaded == 4);
}

TEST_CASE("a layer is reused only after its last frame has finished") {
  Device device({{100, 4}}, ofOneClass(10), 100);
  device.frame(range(0, 4), 4, 5, 4);
  CHECK(device.frame(range(4, 4), 4, 6, 4).waiting == 4);  // frame 5 may be unfinished
  CHECK(device.loaded == 4);
  CHECK(device.frame(range(4, 4), 4, 7, 5).waiting == 0);
  CHECK(device.loaded == 8);
}

TEST_CASE("a less urgent photograph is evicted for a more urgent one even if always shown") {
  Device device({{100, 2}}, ofOneClass(4), 100);
  device.frame({1, 2}, 2, 1, 0);
  // The device is always two frames behind. 0 is more urgent than 1 and 2, which every frame shows as well.
  auto counts = device.frame({0, 1, 2}, 3, 2, 0);
  CHECK(device.residency.slot(1));
  CHECK_FALSE(device.residency.slot(2));  // its substitute is shown
  CHECK(counts.waiting == 2);
  counts = device.frame({0, 1, 2}, 3, 3, 1);
  CHECK(device.residency.slot(0));
  CHECK(device.residency.slot(1));
  CHECK(counts.waiting == 0);
  CHECK(counts.overBudget == 1);
  for (std::uint64_t frame = 4; frame < 8; ++frame) counts = device.frame({0, 1, 2}, 3, frame, frame - 2);
  CHECK(device.loaded == 3);  // the state is stable
  CHECK(counts.overBudget == 1);

  // A photograph that lost its slot gets the slot back without a load if the more urgent one is not requested.
  device.frame({2, 0, 1}, 3, 8, 6);
  CHECK_FALSE(device.residency.slot(1));
  device.frame({0, 1}, 2, 9, 7);
  CHECK(device.residency.slot(1));
  CHECK(device.loaded == 3);
}

TEST_CASE("the least recently shown photograph is evicted first") {
  Device device({{100, 4}}, ofOneClass(10), 100);
  for (std::uint32_t p = 0; p < 4; ++p) device.frame({p}, 1, p + 1, p);
  device.frame({0}, 1, 5, 4);  // 1 is the least recently used
  device.frame({8}, 1, 6, 5);
  CHECK(device.residency.slot(0));
  CHECK_FALSE(device.residency.slot(1));
  device.frame({2}, 1, 7, 6);
  device.frame({1}, 1, 8, 7);
  CHECK_FALSE(device.residency.slot(3));
  CHECK(device.residency.slot(2));
}

TEST_CASE("memory moves between classes, and no texture array is freed in vain") {
  // Photographs 0 to 7 are small, 8 to 11 large, 12 is larger than the budget.
  std::vector<std::uint32_t> classOf(13, 0);
  for (std::size_t p = 8; p < 12; ++p) classOf[p] = 1;
  classOf[12] = 2;
  Device device({{100, 4}, {150, 1}, {1000, 1}}, classOf, 250);
  device.frame(range(0, 8), 8, 1, 0);
  CHECK(device.residency.arrayBytes() == 200);
  CHECK(device.frame({8}, 1, 2, 0).waiting == 1);  // frame 1 may be unfinished
  CHECK(device.frame({8}, 1, 3, 2).waiting == 0);
  CHECK(device.residency.arrayBytes() == 250);  // one small texture array was freed
  CHECK(device.frame({12}, 1, 4, 3).overBudget == 1);
  CHECK(device.residency.arrayBytes() == 250);
  CHECK(device.frame({8, 9}, 2, 5, 4).overBudget == 1);
  CHECK(device.frame(range(0, 8), 8, 6, 5).waiting == 0);
  CHECK_FALSE(device.residency.slot(8));
}

TEST_CASE("unstreamed and unreadable photographs and a refused allocation are handled") {
  Residency residency({{100, 2}}, {Residency::kNone, 0, 0, 0, 0}, {1000});
  residency.begin(std::vector<std::uint32_t>{0, 1, 2, 3, 4}, 4, 1, 0);
  CHECK(residency.next()->kind == Step::Kind::makeArray);
  auto step = residency.next();
  REQUIRE(step->kind == Step::Kind::load);
  CHECK(step->item == 1);
  residency.failed(1);
  step = residency.next();
  CHECK(step->item == 2);
  residency.finishLoad(2);
  step = residency.next();
  CHECK(step->item == 3);
  residency.finishLoad(3);
  step = residency.next();
  REQUIRE(step->kind == Step::Kind::makeArray);
  residency.allocationFailed(step->array);
  CHECK(residency.arrayBytes() == 100);
  CHECK_FALSE(residency.next());
  const auto counts = residency.endFrame();
  CHECK(counts.failed == 1);
  CHECK(counts.waiting == 0);
  residency.begin(std::vector<std::uint32_t>{1, 4}, 2, 2, 1);
  step = residency.next();  // replaces another photograph: the budget is the memory that could be allocated
  REQUIRE(step->kind == Step::Kind::load);
  CHECK(step->item == 4);
  residency.finishLoad(4);
  CHECK(residency.endFrame().failed == 1);
}

TEST_CASE("random walks keep the residency rules") {
  std::mt19937 random(3);
  for (int run = 0; run < 60; ++run) {
    constexpr std::uint32_t kPhotographs = 60;
    std::vector<Residency::Class> classes;
    for (int c = 0; c < 3; ++c) classes.push_back({50 + random() % 200, 1 + std::uint32_t(random() % 5)});
    std::vector<std::uint32_t> classOf;
    for (std::uint32_t p = 0; p < kPhotographs; ++p) classOf.push_back(random() % 10 ? p % 3 : Residency::kNone);
    Device device(classes, classOf, 300 + random() % 2000);
    std::uint64_t completed = 0;
    Residency::Counts last;
    std::vector<std::uint32_t> wanted;
    for (std::uint64_t frame = 1; frame <= 300; ++frame) {
      completed = std::min<std::uint64_t>(frame - 1, completed + random() % 3);
      if (frame < 60) {
        wanted = range(0, kPhotographs);
        std::shuffle(wanted.begin(), wanted.end(), random);
        wanted.resize(20);
      } else {
        completed = std::max(completed, frame - 3);  // steady state
      }
      last = device.frame(wanted, 10, frame, completed, frame < 60 ? 1 + int(random() % 8) : 1000);
    }
    CHECK(last.waiting == 0);
  }
}

TEST_CASE("loads use an array before it exists, and are absent again if it cannot be made") {
  Residency residency({{100, 2}}, ofOneClass(4), {200});
  residency.begin(range(0, 4), 4, 1, 0);
  const auto made = residency.next();
  REQUIRE(made->kind == Step::Kind::makeArray);
  CHECK(residency.next(false)->item == 0);
  CHECK(residency.next(false)->item == 1);
  CHECK_FALSE(residency.next(false));  // photograph 2 needs another array
  CHECK(residency.next(true)->kind == Step::Kind::makeArray);
  CHECK(residency.next(false)->item == 2);
  CHECK(residency.endFrame().waiting == 4);
  residency.begin(range(0, 4), 4, 2, 1);
  residency.allocationFailed(made->array);
  CHECK(residency.arrayBytes() == 100);
  residency.finishLoad(2);
  CHECK(residency.slot(2));
  CHECK(residency.next(false)->item == 0);  // into the layer beside photograph 2
  CHECK_FALSE(residency.next(true));        // the budget was lowered
  const auto counts = residency.endFrame();
  CHECK(counts.waiting == 3);  // 0 is loading, 1 has claimed the layer of 2
  CHECK(counts.overBudget == 1);
}

TEST_CASE("the layer of a cancelled load is free at once, and the photograph is requested again") {
  Residency residency({{100, 1}}, ofOneClass(3), {100});
  residency.begin(std::vector<std::uint32_t>{0}, 1, 1, 0);
  residency.next();
  REQUIRE(residency.next()->item == 0);
  residency.endFrame();
  residency.begin(std::vector<std::uint32_t>{1, 0}, 1, 2, 0);  // frame 1 is in flight
  CHECK(residency.rank(0) == 1);
  CHECK(residency.rank(2) == Residency::kNone);
  residency.cancel(0);
  REQUIRE(residency.next()->item == 1);
  residency.endFrame();
  residency.begin(std::vector<std::uint32_t>{0}, 1, 3, 0);
  residency.cancel(1);
  CHECK(residency.next()->item == 0);
}

TEST_CASE("arrays are used again after they were freed, and their number is bounded") {
  Residency residency({{100, 2}, {150, 1}}, {0, 0, 0, 1, 1}, {250});
  CHECK(residency.maxArrays() == 3);
  std::set<std::uint32_t> arrays;
  for (std::uint64_t frame = 1; frame < 40; ++frame) {
    const auto wanted = frame % 2 ? std::vector<std::uint32_t>{0, 1, 2} : std::vector<std::uint32_t>{3, 4};
    residency.begin(wanted, wanted.size(), frame, frame - 1);
    while (const auto step = residency.next()) {
      REQUIRE(step->array < residency.maxArrays());
      if (step->kind == Step::Kind::makeArray) {
        CHECK(arrays.insert(step->array).second);
        residency.arrayMade(step->array);
      }
      if (step->kind == Step::Kind::freeArray) CHECK(arrays.erase(step->array) == 1);
      if (step->kind == Step::Kind::load) residency.finishLoad(step->item);
    }
    CHECK(residency.endFrame().waiting == 0);
    CHECK(residency.arrayBytes() <= 250);
  }
}

TEST_CASE("a claim that is not renewed lapses, also where the frame takes no further steps") {
  Device device({{100, 2}}, ofOneClass(4), 100);
  device.frame({1, 2}, 2, 1, 0);
  device.frame({0, 1, 2}, 3, 2, 0);
  CHECK_FALSE(device.residency.slot(2));  // claimed by 0
  device.residency.begin(std::vector<std::uint32_t>{1, 2}, 2, 3, 0);
  CHECK(device.residency.slot(2));
}

TEST_CASE("groups have budgets of their own, and a full group leaves room to the other") {
  // Items 0 to 3 are in group 0, items 4 to 7 in group 1.
  Residency residency({{100, 1, 0}, {10, 1, 1}}, {0, 0, 0, 0, 1, 1, 1, 1}, {100, 30});
  residency.begin(std::vector<std::uint32_t>{0, 1, 4, 2, 5, 6, 3, 7}, 1, 1, 0);
  std::vector<std::uint32_t> loaded;
  while (const auto step = residency.next())
    if (step->kind == Step::Kind::load) {
      residency.finishLoad(step->item);
      loaded.push_back(step->item);
    }
  CHECK(loaded == std::vector<std::uint32_t>{0, 4, 5, 6});
  CHECK(residency.arrayBytes(0) == 100);
  CHECK(residency.arrayBytes(1) == 30);
  residency.endFrame();
  // Arrays of one group are not freed for the other.
  residency.begin(std::vector<std::uint32_t>{7, 3}, 2, 2, 1);
  while (const auto step = residency.next()) {
    CHECK(step->kind == Step::Kind::load);
    residency.finishLoad(step->item);
  }
  CHECK(residency.endFrame().waiting == 0);
}

TEST_CASE("while arrays of group 0 cannot be made, arrays of the other group can") {
  Residency residency({{100, 1, 0}, {10, 1, 1}}, {0, 1, 0}, {200, 30});
  residency.begin(std::vector<std::uint32_t>{1, 0, 2}, 3, 1, 0);
  REQUIRE(residency.next(false)->kind == Step::Kind::makeArray);
  CHECK(residency.next(false)->item == 1);
  CHECK_FALSE(residency.next(false));
  CHECK(residency.next(true)->itemClass == 0);
}
