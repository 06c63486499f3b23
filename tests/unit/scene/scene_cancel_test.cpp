// SPDX-License-Identifier: Apache-2.0
// Loading a scene ends soon after a stop was requested.
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "ibr/camera.h"
#include "ibr/error.h"
#include "ibr/scene.h"
#include "scene/capture_spacing.h"
#include "scene/json_check.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;

namespace {

// A scene of two photographs and many cells, each with a file of its own.
Scene manyCells(std::size_t count) {
  Scene scene;
  for (int n = 0; n < 2; ++n) {
    Node node;
    node.name = std::to_string(n) + ".jpg";
    node.camera.intrinsics = pinholeFromFov(64, 48, 0.8);
    node.camera.pose.position = {n, 0, 0};
    scene.nodes.push_back(node);
  }
  Cell cell{{0, 1}, {}, {}};
  cell.mesh.match.assign(2, {{8, 8}, {40, 8}, {8, 40}});
  cell.mesh.ratio.assign(2, {1, 1, 1});
  cell.mesh.inverseDistance = cell.mesh.uncertainty = {0, 0, 0};
  cell.mesh.triangles = {{0, 1, 2}};
  cell.mesh.tier = {kTierConsistent};
  cell.mesh.ecc = {0.5f};
  scene.cells.assign(count, cell);
  return scene;
}

std::stop_token stopped() {
  std::stop_source source;
  source.request_stop();
  return source.get_token();
}

// Lists the files of a folder that are opened, in order.
class OpenedFiles {
 public:
  explicit OpenedFiles(const fs::path& folder) : watch_(::inotify_init1(IN_CLOEXEC)) {
    REQUIRE(watch_ >= 0);
    REQUIRE(::inotify_add_watch(watch_, folder.c_str(), IN_OPEN) >= 0);
  }
  OpenedFiles(const OpenedFiles&) = delete;
  OpenedFiles& operator=(const OpenedFiles&) = delete;
  ~OpenedFiles() { ::close(watch_); }

  // Waits until at least one more file is opened.
  std::vector<std::string> next() {
    alignas(inotify_event) std::array<char, 1 << 16> bytes;
    const ssize_t size = ::read(watch_, bytes.data(), bytes.size());
    std::vector<std::string> names;
    for (ssize_t at = 0; at < size;) {
      inotify_event event;
      std::memcpy(&event, &bytes[std::size_t(at)], sizeof event);
      names.emplace_back(event.len > 0 ? &bytes[std::size_t(at) + sizeof event] : "");
      at += ssize_t(sizeof event + event.len);
    }
    return names;
  }

 private:
  int watch_;
};

}  // namespace

TEST_CASE("loading with a stop that was requested before opens no mesh") {
  TemporaryFolder folder;
  saveScene(manyCells(3), folder.path());
  CHECK(loadScene(folder.path(), std::stop_source().get_token()).cells.size() == 3);
  fs::remove_all(folder / "cells");
  CHECK(errorOf([&] { loadScene(folder.path()); }).code() == ErrorCode::io);
  const Error error = errorOf([&] { loadScene(folder.path(), stopped()); });
  CHECK(error.code() == ErrorCode::cancelled);
  CHECK_THAT(error.what(), Contains("loading the scene"));
}

TEST_CASE("a stop while meshes are loaded ends the loading before the second next mesh") {
  TemporaryFolder folder;
  constexpr std::size_t kCells = 2000;
  saveScene(manyCells(kCells), folder.path());
  const fs::path mark = folder / "cells/mark";
  std::ofstream(mark).put('\n');
  OpenedFiles opened(folder / "cells");
  std::stop_source stop;
  ErrorCode code{};
  std::thread loading([&] { code = errorOf([&] { loadScene(folder.path(), stop.get_token()); }).code(); });
  std::vector<std::string> names = opened.next();
  stop.request_stop();
  std::ifstream(mark).get();  // marks the request in the list of opened files
  loading.join();
  std::ofstream(folder / "cells/end").put('\n');
  while (names.back() != "end")
    for (std::string& name : opened.next()) names.push_back(std::move(name));
  const auto marked = std::find(names.begin(), names.end(), "mark");
  REQUIRE(marked != names.end());
  CHECK(code == ErrorCode::cancelled);
  CHECK(marked != names.begin());
  // One mesh may have passed its check before the request.
  CHECK(names.end() - marked <= 3);
  CHECK(names.size() < kCells);
}

TEST_CASE("a stop ends the parsing of a long document, the check of a scene and its spacing") {
  std::string list = "[0";
  for (int i = 0; i < 10000; ++i) list += ",0";
  CHECK(parseJson(list + "]").size() == 10001);
  CHECK(errorOf([&] { parseJson(list + "]", stopped()); }).code() == ErrorCode::cancelled);
  CHECK(errorOf([&] { parseJson(list, stopped()); }).code() == ErrorCode::cancelled);  // before the syntax error
  const std::vector<Camera> cameras(3, Camera{pinholeFromFov(8, 8, 1), {}});
  CHECK(captureSpacing(cameras) == 1);
  CHECK(errorOf([&] { captureSpacing(cameras, stopped()); }).code() == ErrorCode::cancelled);
}
