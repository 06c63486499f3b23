// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/typed_path.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "base/file.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr::app;

TEST_CASE("a typed folder is completed to the common prefix of the matching folders") {
  ibr::test::TemporaryFolder folder;
  for (const char* name : {"lane by day", "lane by night", "lanterns/inner", ".hidden", "Höhe", "Höfe"})
    fs::create_directories(folder / name);
  ibr::writeFile(folder / "lantern.txt", "no folder");
  const std::string in = folder.path().string() + "/";
  CHECK(completedFolder(in + "la") == in + "lan");
  CHECK(completedFolder(in + "lane") == in + "lane by ");
  CHECK(completedFolder(in + "lane by n") == in + "lane by night/");
  CHECK(completedFolder(in + "lant") == in + "lanterns/");
  CHECK(completedFolder(in + "lanterns/") == in + "lanterns/inner/");
  CHECK(completedFolder(in + "none") == in + "none");
  CHECK(completedFolder(in + "none/at all") == in + "none/at all");
  CHECK(completedFolder(in) == in);  // no common prefix
  CHECK(completedFolder(in + ".") == in + ".hidden/");
  CHECK(completedFolder(in + "H") == in + "Hö");
}

TEST_CASE("completion does not cut UTF-8 characters") {
  ibr::test::TemporaryFolder folder;
  for (const char* name : {"aä", "aö"}) fs::create_directories(folder / name);  // the first bytes of both are equal
  CHECK(completedFolder(folder / "a") == folder / "a");
}

TEST_CASE("a typed path may start with ~, and white space around the path is ignored") {
  const char* home = std::getenv("HOME");
  const std::string before = home ? home : "";
  ibr::test::TemporaryFolder folder;
  fs::create_directories(folder / "scenes");
  ::setenv("HOME", folder.path().c_str(), 1);
  CHECK(typedPath(" ~/scenes \n") == folder / "scenes");
  CHECK(typedPath("~") == folder.path());
  CHECK(typedPath("~other/x") == "~other/x");
  CHECK(typedPath("a b/c") == "a b/c");
  CHECK(typedPath(" \n").empty());
  CHECK(completedFolder("~/sc") == "~/scenes/");
  ::setenv("HOME", before.c_str(), 1);
}
