// SPDX-License-Identifier: Apache-2.0
#include "base/child_process.h"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "base/file.h"
#include "ibr/error.h"
#include "support/temporary_folder.h"

using namespace ibr;
using Catch::Contains;

namespace {
const auto kAlways = [] { return true; };
}

TEST_CASE("a child receives all bytes written to its stdin, also while it prints more than a pipe holds") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "copy";
  std::vector<std::byte> bytes(3'000'000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::byte(i * 7 / 3);
  ChildWriter child({"sh", "-c", "tee \"$0\"", file});
  CHECK(child.write(std::span(bytes).first(1'000'001), kAlways));
  CHECK(child.write(std::span(bytes).subspan(1'000'001), kAlways));
  CHECK(child.finish(kAlways));
  CHECK((readFile(file) == bytes));
}

TEST_CASE("a child that fails is an error with the end of its messages") {
  const std::vector<std::byte> bytes(3'000'000);
  const auto run = [&](const std::string& script) {
    ChildWriter child({"sh", "-c", script});
    child.write(bytes, kAlways);
    child.finish(kAlways);
  };
  CHECK_THROWS_WITH(run("echo early; echo no room >&2; exit 3"), Contains("status 3") && Contains("no room"));
  CHECK_THROWS_WITH(run("cat >/dev/null; echo late >&2; exit 4"), Contains("status 4") && Contains("late"));
  CHECK_THROWS_WITH(run("exec <&- >&- 2>&-; sleep 100"), Contains("no message"));
  CHECK_THROWS_AS(ChildWriter({"/nowhere/program"}), Error);
}

TEST_CASE("a child that does not read is stopped when the caller does not continue") {
  const std::vector<std::byte> bytes(3'000'000);
  ChildWriter child({"sleep", "100"});
  int calls = 0;
  CHECK_FALSE(child.write(bytes, [&] { return ++calls < 4; }));
  CHECK_FALSE(child.finish([] { return false; }));
}
