// SPDX-License-Identifier: Apache-2.0
// Loading a scene ends soon after a stop was requested.
#include <fcntl.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstring>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "ibr/camera.h"
#include "ibr/error.h"
#include "ibr/scene.h"
#include "scene/capture_spacing.h"
#include "scene/json_check.h"
#include "scene/scene_faults.h"
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

// Requests a stop when a file of a folder is opened, on the thread that opens the file and before its open returns: the
// kernel sends a signal with the event. Made on that thread; one at a time.
class StopAtOpen {
 public:
  explicit StopAtOpen(const fs::path& folder) : watch_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
    REQUIRE(watch_ >= 0);
    stop = &stop_;
    struct sigaction action {};
    // The thread is in open, hence in no function of the stop source.
    action.sa_handler = [](int) { stop->request_stop(); };
    action.sa_flags = SA_RESTART;
    REQUIRE(::sigaction(SIGIO, &action, &before_) == 0);
    const f_owner_ex owner{F_OWNER_TID, ::gettid()};
    REQUIRE(::fcntl(watch_, F_SETOWN_EX, &owner) == 0);
    REQUIRE(::fcntl(watch_, F_SETFL, O_ASYNC | O_NONBLOCK) == 0);
    REQUIRE(::inotify_add_watch(watch_, folder.c_str(), IN_OPEN) >= 0);
  }
  StopAtOpen(const StopAtOpen&) = delete;
  StopAtOpen& operator=(const StopAtOpen&) = delete;
  ~StopAtOpen() {
    ::close(watch_);
    ::sigaction(SIGIO, &before_, nullptr);
  }

  std::stop_token token() const { return stop_.get_token(); }

  // Returns the names of the files that were opened, in order.
  std::vector<std::string> opened() const {
    alignas(inotify_event) std::array<char, 1 << 16> bytes;
    std::vector<std::string> names;
    const ssize_t size = ::read(watch_, bytes.data(), bytes.size());
    for (ssize_t at = 0; at < size;) {
      inotify_event event;
      std::memcpy(&event, &bytes[std::size_t(at)], sizeof event);
      names.emplace_back(event.len > 0 ? &bytes[std::size_t(at) + sizeof event] : "");
      at += ssize_t(sizeof event + event.len);
    }
    return names;
  }

 private:
  static inline std::stop_source* stop = nullptr;
  std::stop_source stop_;
  struct sigaction before_ {};
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

TEST_CASE("a stop while a mesh is loaded ends the loading before the next mesh") {
  TemporaryFolder folder;
  saveScene(manyCells(5), folder.path());
  const StopAtOpen stop(folder / "cells");
  const Error error = errorOf([&] { loadScene(folder.path(), stop.token()); });
  CHECK(error.code() == ErrorCode::cancelled);
  CHECK_THAT(error.what(), Contains("loading the scene"));
  CHECK(stop.opened().size() == 1);
}

TEST_CASE("a stop ends the parsing of a long document, the check of a scene and its spacing") {
  std::string list = "[0";
  for (int i = 0; i < 10000; ++i) list += ",0";
  CHECK(parseJson(list + "]").size() == 10001);
  CHECK(errorOf([&] { parseJson(list + "]", stopped()); }).code() == ErrorCode::cancelled);
  CHECK(errorOf([&] { parseJson(list, stopped()); }).code() == ErrorCode::cancelled);  // before the syntax error
  const Scene scene = manyCells(3);
  CHECK(faultsOf(scene, 1, std::stop_source().get_token()).empty());
  CHECK(errorOf([&] { static_cast<void>(faultsOf(scene, 1, stopped())); }).code() == ErrorCode::cancelled);
  const std::vector<Camera> cameras(3, Camera{pinholeFromFov(8, 8, 1), {}});
  CHECK(captureSpacing(cameras) == 1);
  CHECK(errorOf([&] { captureSpacing(cameras, stopped()); }).code() == ErrorCode::cancelled);
}
