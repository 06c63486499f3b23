// SPDX-License-Identifier: Apache-2.0
#include "base/usage.h"

#include <catch2/catch.hpp>
#include <vector>

#include "base/file.h"
#include "support/temporary_folder.h"

using namespace ibr;

TEST_CASE("the memory limit of a control group is the minimum over the group and its parents") {
  const test::TemporaryFolder folder;
  makeFolders(folder / "a/b/c");
  CHECK(!cgroupMemoryLimit(folder / "", "0::/a/b/c\n"));
  writeFile(folder / "a/memory.max", std::string_view("3000000000\n"));
  writeFile(folder / "a/b/memory.max", std::string_view("max\n"));
  CHECK(cgroupMemoryLimit(folder / "", "0::/a/b/c\n") == 3e9);
  writeFile(folder / "a/b/c/memory.max", std::string_view("2000000000\n"));
  CHECK(cgroupMemoryLimit(folder / "", "0::/a/b/c\n") == 2e9);
  writeFile(folder / "memory.max", std::string_view("1000000000\n"));  // the file as a container sees it
  CHECK(cgroupMemoryLimit(folder / "", "0::/a/b/c\n") == 1e9);
  CHECK(cgroupMemoryLimit(folder / "", "0::/\n") == 1e9);
  CHECK(cgroupMemoryLimit(folder / "", "0::/not/there\n") == 1e9);
}

TEST_CASE("control groups of version 1 use their own hierarchy for memory") {
  const test::TemporaryFolder folder;
  makeFolders(folder / "memory/job");
  writeFile(folder / "memory/job/memory.limit_in_bytes", std::string_view("500000000\n"));
  writeFile(folder / "memory/memory.limit_in_bytes", std::string_view("9223372036854771712\n"));
  CHECK(cgroupMemoryLimit(folder / "", "5:cpu,cpuacct:/x\n4:memory:/job\n1:name=systemd:/y\n") == 5e8);
  CHECK(!cgroupMemoryLimit(folder / "", "5:cpu,cpuacct:/x\n"));
  CHECK(!cgroupMemoryLimit(folder / "", "no such line"));
}

TEST_CASE("resident memory includes an allocation and stays below the limit") {
  const double before = residentMemory();
  const std::vector<char> much(64 << 20, 1);
  CHECK(residentMemory() >= before + 60e6 + much[7]);
  CHECK(peakMemory() >= 60e6);
  CHECK(memoryLimit() > residentMemory());
  CHECK(cpuSeconds() > 0);
}
