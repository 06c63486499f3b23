// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/frame_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>

#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::app;
using namespace ibr::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

constexpr int kFrames = 5000;

// Adds frames, and a decision after every hundredth frame.
void addFrames(FrameLog& log) {
  for (int i = 1; i <= kFrames; ++i) {
    log.add({.frame = std::uint64_t(i), .intervalMs = 11, .processorMs = 2, .deviceMs = i % 2 == 0 ? 3.0 : 0.0});
    if (i % 100 == 0) log.add(std::uint64_t(i), "frame " + std::to_string(i));
  }
}

void checkLines(std::istream& file) {
  std::string text;
  for (int i = 1; i <= kFrames; ++i) {
    REQUIRE(std::getline(file, text));
    const Json line = Json::parse(text);
    REQUIRE(line.at("frame") == i);
    REQUIRE(line.at("processorMs") == 2);
    if (i % 100 != 0) continue;
    REQUIRE(std::getline(file, text));
    REQUIRE(Json::parse(text) == Json{{"frame", i}, {"decision", "frame " + std::to_string(i)}});
  }
}

}  // namespace

TEST_CASE("the frame log contains all lines in order, and the summary at the end") {
  const TemporaryFolder folder;
  const fs::path path = folder / "frames.jsonl";
  FrameLog log(path);
  addFrames(log);
  const auto summary = log.finish();
  log.check();
  CHECK(summary.at("frames") == kFrames);
  CHECK(summary.at("decisions") == kFrames / 100);
  CHECK(summary.at("deviceMs").at("p50") == 3);
  std::ifstream file(path);
  checkLines(file);
  std::string text;
  REQUIRE(std::getline(file, text));
  CHECK(Json::parse(text).at("summary") == Json::parse(summary.dump()));
  CHECK(!std::getline(file, text));
}

TEST_CASE("the frame log writes all lines when it is destroyed without a summary") {
  const TemporaryFolder folder;
  const fs::path path = folder / "frames.jsonl";
  {
    FrameLog log(path);
    addFrames(log);
  }
  std::ifstream file(path);
  checkLines(file);
}

TEST_CASE("frames do not wait for a file that takes no more bytes") {
  const TemporaryFolder folder;
  const fs::path pipe = folder / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);  // else the log's open would wait for a reader
  REQUIRE(reader >= 0);
  FrameLog log(pipe);
  addFrames(log);  // far more bytes than a pipe holds
  std::ifstream file(pipe);
  close(reader);
  auto finished = std::async(std::launch::async, [&] { return log.finish(); });
  checkLines(file);
  std::string summary;
  CHECK(std::getline(file, summary));
  CHECK(finished.get().at("frames") == kFrames);
  log.check();
}

TEST_CASE("the frame log reports a file that cannot be written, and writes none without a path") {
  CHECK(errorOf([] { FrameLog("/no such folder/frames.jsonl"); }).code() == ErrorCode::io);
  FrameLog full("/dev/full");
  addFrames(full);
  full.finish();
  const Error error = errorOf([&] { full.check(); });
  CHECK(error.code() == ErrorCode::io);
  CHECK_THAT(error.what(), Contains("/dev/full"));

  FrameLog none("");
  addFrames(none);
  CHECK(none.finish().at("frames") == kFrames);
  none.check();
}
