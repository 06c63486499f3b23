// SPDX-License-Identifier: Apache-2.0
#include "base/file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <future>
#include <span>
#include <string>
#include <vector>

#include "ibr/error.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;

namespace {
template <class F>
ErrorCode codeOf(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    INFO(e.what());
    return e.code();
  }
  FAIL("nothing was thrown");
  return {};
}
}  // namespace

TEST_CASE("a written file reads back unchanged and leaves no temporary file") {
  test::TemporaryFolder folder;
  writeFile(folder / "a.txt", "first, longer");
  writeFile(folder / "a.txt", "second");
  CHECK(readTextFile(folder / "a.txt") == "second");
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("reading a missing file, a folder, a device or a file over the limit throws") {
  test::TemporaryFolder folder;
  CHECK(codeOf([&] { readFile(folder / "missing"); }) == ErrorCode::io);
  CHECK(codeOf([&] { readFile(folder.path()); }) == ErrorCode::io);
  CHECK(codeOf([&] { readFile("/dev/zero"); }) == ErrorCode::io);
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  CHECK(codeOf([&] { readFile(folder / "pipe"); }) == ErrorCode::io);
  writeFile(folder / "long", "12345");
  CHECK(codeOf([&] { readFile(folder / "long", 4); }) == ErrorCode::invalidInput);
  CHECK(readTextFile(folder / "long", 5) == "12345");
  CHECK(readFileStart(folder / "long", 3).size() == 3);
  CHECK(readFileStart(folder / "long", 9).size() == 5);
  CHECK(codeOf([&] { readFileStart(folder / "missing", 3); }) == ErrorCode::io);
}

TEST_CASE("writing to a missing folder or a full device throws") {
  test::TemporaryFolder folder;
  CHECK(codeOf([&] { writeFile(folder / "no/such/folder", "x"); }) == ErrorCode::io);
  CHECK(codeOf([&] { writeFile("/dev/full", "x"); }) == ErrorCode::io);
}

TEST_CASE("concurrent writes leave one complete version of the file") {
  test::TemporaryFolder folder;
  const auto write = [&](char c) {
    for (int n = 0; n < 200; ++n) writeFile(folder / "a.txt", std::string(10'000, c));
  };
  std::vector<std::future<void>> writers;
  for (const char c : {'a', 'b', 'c'}) writers.push_back(std::async(std::launch::async, write, c));
  for (auto& writer : writers) CHECK_NOTHROW(writer.get());
  const std::string text = readTextFile(folder / "a.txt");
  CHECK(text == std::string(10'000, text.empty() ? ' ' : text[0]));
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("makeFolders creates nested folders, or names the folder in its error") {
  test::TemporaryFolder folder;
  makeFolders(folder / "a/b");
  makeFolders(folder / "a/b");
  CHECK(fs::is_directory(folder / "a/b"));
  writeFile(folder / "file", "");
  CHECK_THROWS_WITH(makeFolders(folder / "file/below"), Catch::Contains("file/below"));
  CHECK(codeOf([&] { makeFolders(folder / "file/below"); }) == ErrorCode::io);
  CHECK(codeOf([&] { makeFolders(folder / "file"); }) == ErrorCode::io);
}

TEST_CASE("checkFolderWritable finds an unwritable folder and creates nothing") {
  test::TemporaryFolder folder;
  writeFile(folder / "file", "");
  checkFolderWritable(folder.path());
  checkFolderWritable(folder / "new/below");
  CHECK(!fs::exists(folder / "new"));
  CHECK_THROWS_WITH(checkFolderWritable(folder / "file/below"), Catch::Contains("file/below"));
  CHECK(codeOf([&] { checkFolderWritable(folder / "file"); }) == ErrorCode::io);
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  if (::access(folder.path().c_str(), W_OK) != 0)  // root may write everywhere
    CHECK(codeOf([&] { checkFolderWritable(folder / "new"); }) == ErrorCode::io);
  fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST_CASE("pathInside refuses paths outside of the folder") {
  test::TemporaryFolder folder;
  CHECK(pathInside(folder.path(), "images/a..b.png").filename() == "a..b.png");
  CHECK(pathInside(folder.path(), "images/../b.png") == fs::canonical(folder.path()) / "b.png");
  CHECK(codeOf([&] { pathInside(folder.path(), "../x"); }) == ErrorCode::invalidInput);
  CHECK(codeOf([&] { pathInside(folder.path(), "images/../../x"); }) == ErrorCode::invalidInput);
  CHECK(codeOf([&] { pathInside(folder.path(), "/etc/passwd"); }) == ErrorCode::invalidInput);
  CHECK(codeOf([&] { pathInside(folder.path(), "."); }) == ErrorCode::invalidInput);
  CHECK(codeOf([&] { pathInside(folder.path(), std::string(5000, 'x')); }) == ErrorCode::invalidInput);
  fs::create_symlink("loop", folder / "loop");
  CHECK(codeOf([&] { pathInside(folder.path(), "loop/x"); }) == ErrorCode::invalidInput);
  fs::create_directory_symlink("/etc", folder / "link");
  CHECK(codeOf([&] { pathInside(folder.path(), "link/passwd"); }) == ErrorCode::invalidInput);
}

TEST_CASE("parts of a file are read in any order") {
  const test::TemporaryFolder folder;
  writeFile(folder / "a", std::string_view("0123456789"));
  const InputFile file(folder / "a");
  CHECK(file.size() == 10);
  const auto text = [&](std::uint64_t offset, std::size_t count) {
    std::string bytes(count, ' ');
    file.read(offset, std::as_writable_bytes(std::span(bytes)));
    return bytes;
  };
  CHECK(text(7, 3) == "789");
  CHECK(text(0, 2) == "01");
  CHECK(text(10, 0).empty());
  std::filesystem::resize_file(folder / "a", 5);
  CHECK_THROWS_WITH(text(3, 4), Catch::Contains((folder / "a").string()) && Catch::Contains("ends after 5 bytes"));
  CHECK_THROWS_WITH(InputFile(folder / "b"), Catch::Contains((folder / "b").string()));
  CHECK_THROWS_WITH(InputFile(folder.path()), Catch::Contains("not a regular file"));
}
