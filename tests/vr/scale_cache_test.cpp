// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/scale_cache.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <limits>

#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using ibr::app::ScaleCache;

namespace {

struct Log {
  int warnings = 0;
  ibr::LogCallback callback() {
    return [this](ibr::LogLevel, std::string_view) { ++warnings; };
  }
};

}  // namespace

TEST_CASE("scales are saved for each scene, for any spelling of the scene's path") {
  ibr::test::TemporaryFolder folder;
  Log log;
  {
    ScaleCache scales(folder / "scales.json", log.callback());
    CHECK_FALSE(scales.of(folder / "hall"));
    scales.store(folder / "hall", 0.37);
    scales.store(folder / "garden", 1e-6);
    scales.store(folder / "hall", 0.1 + 0.2);
    CHECK(scales.of(folder / "hall") == 0.1 + 0.2);
  }
  const ScaleCache again(folder / "scales.json", log.callback());
  CHECK(again.of(folder / "garden" / ".." / "hall" / "") == 0.1 + 0.2);
  CHECK(again.of(folder / "garden") == 1e-6);
  CHECK_FALSE(again.of(folder / "yard"));
  CHECK(log.warnings == 0);
}

TEST_CASE("invalid scales are neither saved nor read") {
  ibr::test::TemporaryFolder folder;
  Log log;
  const fs::path file = folder / "scales.json";
  ScaleCache scales(file, log.callback());
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    scales.store(folder / "hall", bad);
  CHECK_FALSE(fs::exists(file));
  std::ofstream(file) << R"({"version":1,"scales":{"/a":0,"/b":-1,"/c":"2","/d":3}})";
  const ScaleCache read(file, log.callback());
  for (const char* scene : {"/a", "/b", "/c"}) CHECK_FALSE(read.of(scene));
  CHECK(read.of("/d") == 3.0);
  CHECK(log.warnings == 0);
}

TEST_CASE("a broken or unwritable file of scales gives a warning only") {
  ibr::test::TemporaryFolder folder;
  const fs::path file = folder / "scales.json";
  for (const char* text : {"", "{", "[]", R"({"scales":3})"}) {
    Log log;
    std::ofstream(file, std::ios::trunc) << text;
    CHECK_FALSE(ScaleCache(file, log.callback()).of("/a"));
    CHECK(log.warnings == (std::string(text) == R"({"scales":3})" ? 0 : 1));
  }
  Log log;
  ScaleCache nowhere(folder / "missing" / "scales.json", log.callback());
  nowhere.store("/a", 2);
  CHECK(log.warnings == 1);
  CHECK(nowhere.of("/a") == 2.0);
  ScaleCache none({}, log.callback());
  none.store("/a", 2);
  CHECK(log.warnings == 1);
}
