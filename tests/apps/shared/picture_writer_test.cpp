// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/picture_writer.h"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <fstream>
#include <semaphore>
#include <stdexcept>
#include <thread>

#include "io/image_file.h"
#include "shared/draw/picture_record.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;
using Catch::Contains;

namespace {

Image8 grey(std::uint8_t value) {
  Image8 image(8, 6, 3);
  std::ranges::fill(image.values, value);
  return image;
}

PictureJob writing(const fs::path& file, std::uint8_t value, bool required = false) {
  return {.name = file.string(),
          .write =
              [file, value] {
                writePicture(file, grey(value), {Camera{pinholeFromFov(8, 6, 1), {}}, std::nullopt, {}});
                return std::vector{file};
              },
          .required = required};
}

Error errorOf(const PictureResult& result) {
  return test::errorOf([&] { std::rethrow_exception(result.error); });
}

}  // namespace

TEST_CASE("the picture writer writes all pictures in the order of the jobs") {
  TemporaryFolder folder;
  std::atomic<int> results = 0;
  constexpr int kCount = 20;
  std::vector<PictureResult> all;
  {
    PictureWriter writer([&] { ++results; }, 2);
    CHECK_FALSE(writer.hasResults());
    CHECK(writer.takeResults().empty());
    CHECK(writer.finish().empty());
    for (int i = 0; i < kCount; ++i)
      writer.add(writing(folder / (std::to_string(i) + ".png"), std::uint8_t(i), i % 2 == 1));
    all = writer.takeResults();
    for (PictureResult& result : writer.finish()) all.push_back(std::move(result));
    CHECK_FALSE(writer.hasResults());
  }
  CHECK(results == kCount);
  REQUIRE(all.size() == kCount);
  for (int i = 0; i < kCount; ++i) {
    const PictureResult& result = all[std::size_t(i)];
    const fs::path file = folder / (std::to_string(i) + ".png");
    CHECK(result.files == std::vector{file});
    CHECK(result.required == (i % 2 == 1));
    CHECK(!result.error);
    CHECK((readImage(file).values == grey(std::uint8_t(i)).values));
  }
}

TEST_CASE("the picture writer runs on another thread, and waits only for a full queue") {
  std::counting_semaphore<100> started(0), allowed(0);
  std::atomic<int> done = 0;
  const std::thread::id own = std::this_thread::get_id();
  std::atomic<bool> elsewhere = true;
  const PictureJob job{.name = "slow", .write = [&] {
                         elsewhere = elsewhere && std::this_thread::get_id() != own;
                         started.release();
                         allowed.acquire();
                         ++done;
                         return std::vector<fs::path>{};
                       }};
  PictureWriter writer({}, 2);
  writer.add(job);
  started.acquire();  // the thread has taken the first job
  writer.add(job);
  writer.add(job);  // two wait
  CHECK(done == 0);
  CHECK_FALSE(writer.hasResults());
  std::atomic<bool> added = false;
  std::thread fourth([&] {
    writer.add(job);
    added = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  CHECK_FALSE(added);  // the queue is full until the first job has ended
  allowed.release();
  started.acquire();
  fourth.join();
  CHECK(done == 1);
  allowed.release(3);
  CHECK(writer.finish().size() == 4);
  CHECK(done == 4);
  CHECK(elsewhere);
}

TEST_CASE("the picture writer's first result is available while other jobs wait") {
  std::counting_semaphore<100> allowed(0);
  PictureWriter writer;
  CHECK(writer.waitForResults().empty());  // without jobs
  for (int i = 0; i < 3; ++i)
    writer.add({.name = "slow", .write = [&allowed, i] {
                  allowed.acquire();
                  return std::vector<fs::path>{std::to_string(i)};
                }});
  for (int i = 0; i < 3; ++i) {
    allowed.release();
    const std::vector<PictureResult> results = writer.waitForResults();
    REQUIRE(results.size() == 1);
    CHECK(results[0].files == std::vector<fs::path>{std::to_string(i)});
  }
  CHECK(writer.waitForResults().empty());
}

TEST_CASE("the picture writer reports errors with the file's name, and continues") {
  TemporaryFolder folder;
  std::ofstream(folder / "file").put('\n');
  PictureWriter writer;
  writer.add(writing(folder / "file/inside.png", 1, true));
  writer.add({.name = "view.png", .write = []() -> std::vector<fs::path> { throw std::runtime_error("no memory"); }});
  writer.add(writing(folder / "good.png", 3));
  const std::vector<PictureResult> results = writer.finish();
  REQUIRE(results.size() == 3);
  CHECK_THAT(errorOf(results[0]).what(), Contains("inside.png"));
  CHECK(errorOf(results[0]).code() == ErrorCode::io);
  CHECK(results[0].required);
  CHECK_THAT(errorOf(results[1]).what(), Contains("view.png") && Contains("no memory"));
  CHECK(results[1].files.empty());
  CHECK(!results[2].error);
  CHECK(fs::exists(folder / "good.png"));
}

TEST_CASE("the picture writer's destruction writes all queued pictures") {
  TemporaryFolder folder;
  {
    PictureWriter writer({}, 100);
    for (int i = 0; i < 30; ++i) writer.add(writing(folder / (std::to_string(i) + ".png"), std::uint8_t(i)));
  }
  for (int i = 0; i < 30; ++i) CHECK(fs::exists(folder / (std::to_string(i) + ".png")));
}
