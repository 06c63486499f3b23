// SPDX-License-Identifier: Apache-2.0
#include "ibr/htm_sequence.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <future>
#include <limits>
#include <thread>

#include "base/file.h"
#include "ibr/asset.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"
#include "support/test_meshes.h"

namespace fs = std::filesystem;

namespace ibr {
namespace {

constexpr std::size_t kFrames = 6;

// A folder of frames; the camera's name in a frame is the frame's number.
struct Video {
  test::TemporaryFolder folder;
  HtmSequenceIndex index{10, {}};
  Video() {
    for (std::size_t f = 0; f < kFrames; ++f) {
      index.frames.push_back("frame" + std::to_string(f));
      HtmModel model;
      HtmCamera camera;
      camera.name = std::to_string(f);
      camera.camera.intrinsics = {CameraModel::pinhole, 10, 10, 10, 10, 5, 5};
      camera.imageFile = "a.png";
      model.cameras = {camera};
      model.surface = {test::cube(), std::vector<CameraSet>(8, 1)};
      saveHtmModel(model, folder / index.frames.back());
      writeFile(folder / index.frames.back() / "a.png", "a picture");
    }
    saveHtmSequence(index, folder.path());
  }
};

HtmImage picture(const HtmModel& model, std::size_t) {
  return {Image8(10, 10, 3, std::uint8_t(std::stoi(model.cameras[0].name))), {}};
}

template <class F>
void waitFor(F&& holds) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::seconds(20); !holds();) {
    REQUIRE(Clock::now() < end);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST_CASE("a saved index loads unchanged") {
  const Video video;
  for (const fs::path& path : {video.folder.path(), video.folder / "sequence.json"}) {
    const HtmSequenceIndex index = loadHtmSequence(path);
    CHECK(index.fps == 10);
    CHECK(index.frames == video.index.frames);
    CHECK(validateHtmSequenceFiles(path).empty());
    CHECK(assetKind(path) == AssetKind::htmSequence);
  }
}

TEST_CASE("faults of an index are reported with their field") {
  const Video video;
  const auto refused = [&](const std::string& text, const std::string& place) {
    INFO(text);
    writeFile(video.folder / "sequence.json", text);
    const Error error = test::errorOf([&] { loadHtmSequence(video.folder.path()); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Catch::Contains("sequence.json: " + place));
    const std::vector<Fault> faults = validateHtmSequenceFiles(video.folder.path());
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].field == place);
  };
  refused(R"({"version":2,"fps":25,"frames":["a"]})", "/version");
  refused(R"({"version":1,"fps":0,"frames":["a"]})", "/fps");
  refused(R"({"version":1,"fps":1e9,"frames":["a"]})", "/fps");
  refused(R"({"version":1,"fps":"25","frames":["a"]})", "/fps");
  refused(R"({"version":1,"fps":25,"frames":[]})", "/frames");
  refused(R"({"version":1,"fps":25,"frames":{}})", "/frames");
  refused(R"({"version":1,"fps":25,"frames":["a",""]})", "/frames/1");
  refused(R"({"version":1,"fps":25,"frames":["a","b",3]})", "/frames/2");
  refused(R"({"version":1,"fps":25,"frames":["../a"]})", "/frames/0");
  refused(R"({"version":1,"fps":25,"frames":["/a"]})", "/frames/0");
  const auto unsaved = [&](const HtmSequenceIndex& index) {
    CHECK(test::errorOf([&] { saveHtmSequence(index, video.folder / "new"); }).code() == ErrorCode::invalidInput);
    CHECK_FALSE(fs::exists(video.folder / "new"));
  };
  unsaved({25, {}});
  unsaved({0, {"a"}});
  unsaved({std::numeric_limits<double>::quiet_NaN(), {"a"}});
  unsaved({25, {"../a"}});
  unsaved({25, {"\xff"}});
}

TEST_CASE("faults of frames are reported with their frame") {
  const Video video;
  fs::remove(video.folder / "frame2/a.png");
  fs::remove(video.folder / "frame4/model.gltf");
  const std::vector<Fault> faults = validateHtmSequenceFiles(video.folder.path());
  REQUIRE(faults.size() == 2);
  CHECK(faults[0].field == "/frames/2");
  CHECK_THAT(faults[0].message,
             Catch::Contains("frame2") && Catch::Contains("/extensions") && Catch::Contains("a.png"));
  CHECK(faults[1].field == "/frames/4");
  CHECK(validateHtmSequenceFiles(video.folder.path(), 1).size() == 1);
}

TEST_CASE("times map to their frames") {
  const Video video;
  const HtmSequence loop(video.folder.path(), picture), once(video.folder.path(), picture, {.loop = false});
  CHECK(loop.duration() == Approx(0.6));
  for (std::size_t k = 0; k < kFrames; ++k) {
    CHECK(loop.frameAt(double(k) / 10) == k);
    CHECK(loop.frameAt(double(k) / 10 + 0.099) == k);
    CHECK(loop.frameAt(double(k + 100 * kFrames) / 10) == k);
    CHECK(loop.frameAt((double(k) - double(kFrames)) / 10) == k);
    CHECK(once.frameAt(double(k) / 10) == k);
  }
  for (const double fps : {24 / 1.001, 29.97, 49.0, 0.3}) {
    saveHtmSequence({fps, video.index.frames}, video.folder.path());
    const HtmSequence other(video.folder.path(), picture);
    for (std::size_t k = 0; k < 1000; ++k) CHECK(other.frameAt(double(k) / fps) == k % kFrames);
  }
  CHECK(once.frameAt(-1) == 0);
  CHECK(once.frameAt(0.6) == kFrames - 1);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double time : {infinity, -infinity, 1e300, -1e300, std::nan("")}) {
    CHECK(loop.frameAt(time) < kFrames);
    CHECK(once.frameAt(time) == (time > 0 ? kFrames - 1 : 0));
  }
}

TEST_CASE("frames can be requested in any order") {
  const Video video;
  HtmSequence sequence(video.folder.path(), picture, {.framesAhead = 2});
  for (const std::size_t k : {0u, 1u, 2u, 5u, 0u, 3u, 3u, 2u, 4u, 1u}) {
    const auto frame = sequence.frame(k);
    CHECK(frame->model.cameras[0].name == std::to_string(k));
    REQUIRE(frame->pictures.size() == 1);
    CHECK(frame->pictures[0].photograph.pixel(0, 0)[0] == k);
    CHECK(sequence.frame(k) == frame);
  }
  CHECK(test::errorOf([&] { sequence.frame(kFrames); }).code() == ErrorCode::invalidInput);
  CHECK(sequence.frame(1)->model.cameras[0].name == "1");
}

TEST_CASE("the next frames are loaded before they are requested") {
  const Video video;
  HtmSequence sequence(video.folder.path(), picture, {.framesAhead = 2});
  CHECK(sequence.counts().loads == 0);
  sequence.frame(4);
  waitFor([&] { return sequence.counts().cachedFrames == 3; });  // 4, 5 and, after wrapping around, 0
  for (const std::size_t k : {4u, 5u, 0u}) CHECK(sequence.tryFrame(k) != nullptr);
  waitFor([&] { return sequence.counts().loads == 5; });  // 1 and 2 are loaded too, and no frame twice
  HtmSequence last(video.folder.path(), picture, {.framesAhead = 2});
  last.frame(5);
  waitFor([&] { return last.counts().cachedFrames == 3; });
  CHECK(last.tryFrame(0) != nullptr);
  HtmSequence once(video.folder.path(), picture, {.framesAhead = 2, .loop = false});
  once.frame(5);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  CHECK(once.counts().loads == 1);
}

TEST_CASE("memory stays within the budget") {
  const Video video;
  std::uint64_t one = 0;
  {
    HtmSequence sequence(video.folder.path(), picture, {.framesAhead = 0});
    one = sequence.frame(0)->bytes();
    CHECK(sequence.counts().bytes == one);
    CHECK(one > 300 + 8 * 32);
  }
  std::atomic<bool> roomIsThere = true;
  HtmSequence* self = nullptr;
  HtmSequence two(video.folder.path(),
                  [&](const HtmModel& model, std::size_t camera) {
                    roomIsThere = roomIsThere && self->counts().bytes <= one + one / 2;
                    return picture(model, camera);
                  },
                  {.framesAhead = 5, .budgetBytes = 2 * one + one / 2});
  self = &two;
  for (std::size_t k = 0; k < 3 * kFrames; ++k) {
    two.frame(k % kFrames);
    waitFor([&] { return two.counts().loads == k + 2; });  // the next frame; no frame is loaded twice
    waitFor([&] { return two.counts().cachedFrames == 2; });
    CHECK(two.counts().bytes <= 2 * one + one / 2);
    CHECK(two.tryFrame(k % kFrames) != nullptr);
  }
  CHECK(roomIsThere);
  HtmSequence none(video.folder.path(), picture, {.framesAhead = 5, .budgetBytes = 0});
  for (std::size_t k = 0; k < kFrames; ++k) CHECK(none.frame(k)->model.cameras[0].name == std::to_string(k));
  CHECK(none.counts().cachedFrames == 1);
}

TEST_CASE("tryFrame does not wait for a slow frame, frame does") {
  const Video video;
  std::promise<void> open;
  std::atomic<bool> entered = false;
  HtmSequence sequence(video.folder.path(),
                       [&, gate = open.get_future().share()](const HtmModel& model, std::size_t camera) {
                         entered = true;
                         gate.wait();
                         return picture(model, camera);
                       },
                       {.framesAhead = 1});
  CHECK(sequence.tryFrame(2) == nullptr);
  waitFor([&] { return entered.load(); });
  CHECK(sequence.tryFrame(2) == nullptr);
  CHECK(sequence.tryFrame(4) == nullptr);  // seeks while frame 2 is loading
  open.set_value();
  CHECK(sequence.frame(4)->model.cameras[0].name == "4");
  waitFor([&] { return sequence.counts().cachedFrames == 2; });
  CHECK(sequence.tryFrame(5)->model.cameras[0].name == "5");
}

TEST_CASE("errors of a frame are thrown on use, and a repaired frame loads") {
  const Video video;
  const fs::path model = video.folder / "frame1/model.gltf";
  const std::string text = readTextFile(model);
  fs::remove(model);
  std::atomic<bool> pictureFails = true;
  HtmSequence sequence(video.folder.path(),
                       [&](const HtmModel& m, std::size_t camera) {
                         if (pictureFails && m.cameras[0].name == "2") throw Error(ErrorCode::io, "no such picture");
                         return picture(m, camera);
                       },
                       {.framesAhead = 3});
  CHECK(sequence.frame(0)->model.cameras[0].name == "0");
  waitFor([&] { return sequence.counts().loads == 4; });
  CHECK(sequence.frame(0)->model.cameras[0].name == "0");
  const Error error = test::errorOf([&] { sequence.frame(1); });
  CHECK(error.code() == ErrorCode::io);
  CHECK_THAT(error.what(), Catch::Contains("frame1"));
  CHECK_THAT(test::errorOf([&] { sequence.frame(2); }).what(), Catch::Contains("no such picture"));
  CHECK(sequence.frame(3)->model.cameras[0].name == "3");
  writeFile(model, text);
  pictureFails = false;
  CHECK(sequence.frame(5)->model.cameras[0].name == "5");
  CHECK(sequence.frame(1)->model.cameras[0].name == "1");
  CHECK(sequence.frame(2)->model.cameras[0].name == "2");
}

TEST_CASE("a sequence may be destroyed while loading, and may be used by several threads") {
  const Video video;
  for (int trial = 0; trial < 20; ++trial) {
    HtmSequence sequence(video.folder.path(), picture, {.framesAhead = 5});
    sequence.tryFrame(std::size_t(trial) % kFrames);
  }
  HtmSequence sequence(video.folder.path(), picture, {.framesAhead = 1});
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 3; ++t)
    threads.emplace_back([&, t] {
      for (std::size_t k = 0; k < 40; ++k)
        wrong += sequence.frame((t + 2 * k) % kFrames)->model.cameras[0].name != std::to_string((t + 2 * k) % kFrames);
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
}

}  // namespace
}  // namespace ibr
