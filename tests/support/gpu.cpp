// SPDX-License-Identifier: Apache-2.0
#include "support/gpu.h"

#include <dlfcn.h>
#include <link.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <thread>

#include "support/gpu_session.h"

namespace ibr::test {
namespace {

struct Session {
  std::unique_ptr<Device> device;
  std::mutex mutex;
  std::thread::id testThread;  // the only thread that may call Catch2; none between test cases
  ExpectedMessages* expected = nullptr;
  int messagesInTest = 0;
  int stray = 0;
};

Session& session() {
  static Session session;
  return session;
}

void receive(LogLevel level, std::string_view message) {
  if (level != LogLevel::warning && level != LogLevel::error) return;
  Session& s = session();
  const std::lock_guard lock(s.mutex);
  if (s.expected) {
    s.expected->texts.emplace_back(message);
  } else if (s.testThread == std::this_thread::get_id()) {
    ++s.messagesInTest;
    FAIL_CHECK(std::string(message));
  } else {
    ++s.stray;
    std::fprintf(stderr, "outside any test case: %.*s\n", int(message.size()), message.data());
  }
}

/// Keeps drivers and layers loaded. The last instance unloads them, and a leak checker cannot attribute memory that
/// an unloaded library has not freed. Loading them once for all tests is also faster.
void keepDriversLoaded() {
  std::vector<std::string> names;
  dl_iterate_phdr(
      [](dl_phdr_info* library, std::size_t, void* list) {
        if (std::strstr(library->dlpi_name, "vulkan_") || std::strstr(library->dlpi_name, "VkLayer_"))
          static_cast<std::vector<std::string>*>(list)->emplace_back(library->dlpi_name);
        return 0;
      },
      &names);
  for (const std::string& name : names) ::dlopen(name.c_str(), RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
}

}  // namespace

Device& testDevice() {
  return *session().device;
}

LogCallback testLog() {
  return receive;
}

void expectNoValidationMessages() {
  CHECK(session().messagesInTest == 0);
}

ExpectedMessages::ExpectedMessages() {
  const std::lock_guard lock(session().mutex);
  session().expected = this;
}

ExpectedMessages::~ExpectedMessages() {
  const std::lock_guard lock(session().mutex);
  session().expected = nullptr;
}

void makeTestDevice() {
  session().device = std::make_unique<Device>(Device::create({.validation = true, .log = receive}));
  keepDriversLoaded();
}

void destroyTestDevice() {
  session().device.reset();
}

void beginTestCase() {
  session().messagesInTest = 0;
  session().testThread = std::this_thread::get_id();
}

void endTestCase() {
  session().testThread = {};
}

int strayMessages() {
  return session().stray;
}

}  // namespace ibr::test
