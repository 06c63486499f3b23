// SPDX-License-Identifier: Apache-2.0
// Command lines and inputs that ibr-lab accuracy refuses. The measurement itself is tested with the library
// (tests/unit/author/eval/accuracy_test.cpp).
#include <catch2/catch.hpp>
#include <filesystem>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr::test;
using Catch::Contains;

TEST_CASE("ibr-lab accuracy rejects invalid inputs and writes nothing") {
  const TemporaryFolder folder;
  const fs::path out = folder / "exact";
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"accuracy", tinyScene(), "--truth", tinySet().truth};
    words.insert(words.end(), more.begin(), more.end());
    return runLab(words);
  };
  const Outcome noDepth = run({"--exact", out});
  CHECK(noDepth.code == 2);
  CHECK_THAT(noDepth.err, Contains("depth/between.png"));
  const Outcome noiseAlone = run({"--noise", "2"});
  CHECK(noiseAlone.code == 1);
  CHECK_THAT(noiseAlone.err, Contains("--exact"));
  for (const char* noise : {"-1", "65", "nan", "much"}) {
    const Outcome wrong = run({"--exact", out, "--noise", noise});
    CHECK(wrong.code == 1);
    CHECK_THAT(wrong.err, Contains("--noise"));
  }
  CHECK(!fs::exists(out));
}
