// SPDX-License-Identifier: Apache-2.0
// Command lines of `ibr tradeoff`.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

// Presets, two more values of the blend knob, and two builds with the same content.
std::vector<std::string> tradeoffOfTiny(const fs::path& output) {
  return {"tradeoff", tinyScene(),
          "--truth",  tinySet().truth,
          "--knobs",  "blend",
          "tiers",    "--no-grid",
          "--build",  "again=" + tinyScene().string(),
          "--repeat", "2",
          "--walk",   "20",
          "-o",       output};
}

const Json& settingOf(const Json& report, std::string_view name) {
  for (const Json& row : report.at("settings"))
    if (row.at("setting") == name) return row;
  FAIL(name);
  return report;
}

}  // namespace

TEST_CASE("ibr tradeoff measures the scores of ibr eval, and a second run reuses all measurements") {
  if (!deviceIsThere()) return;
  const TemporaryFolder folder;
  const fs::path out = folder / "report";
  const Outcome outcome = runProgram(tradeoffOfTiny(out));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.out,
             Contains("preset reference") && Contains("front") && Contains("between.png") && Contains("99 %"));
  const std::string text = readTextFile(out / "tradeoff.json");
  const Json report = parseJson(text);

  // Scores against the truth equal those of `ibr eval`.
  for (const char* preset : {"fast", "balanced"}) {
    const Outcome eval =
        runProgram({"eval", tinyScene(), "--truth", tinySet().truth, "--preset", preset, "-q", "--json", "-"});
    REQUIRE(eval.code == 0);
    const Json mean = parseJson(eval.out).at("mean"), &row = settingOf(report, std::string("preset ") + preset);
    for (const char* figure : {"psnr", "ssim", "flip"}) CHECK(row.at("truth").at(figure) == mean.at(figure));
    CHECK(row.at("holes").get<double>() == Approx(1 - mean.at("coverage").get<double>()).margin(1e-12));
  }
  // Scores of the reference preset against itself.
  const Json& reference = settingOf(report, "preset reference");
  CHECK(reference.at("reference").at("psnr").is_null());
  CHECK(reference.at("reference").at("flip") == 0);
  CHECK(reference.at("truth").at("flip") > 0);
  // Comparison with the reference implementation.
  REQUIRE(report.at("implementation").size() == 1);
  CHECK(report["implementation"][0].at("compared") > 0.3);
  CHECK(report["implementation"][0].at("beyondBound") == 0);

  const Json &usual = settingOf(report, "preset balanced"), &again = settingOf(report, "build again");
  CHECK(usual.at("views")[0].at("prediction") == again.at("views")[0].at("prediction"));
  CHECK(usual["views"][0]["prediction"] != settingOf(report, "blend dither").at("views")[0].at("prediction"));
  CHECK(usual.at("bytes").at("predicted").at("textures") > 0);
  CHECK(usual["bytes"]["measured"].at("textures") >= usual["bytes"]["predicted"]["textures"]);
  CHECK(usual["bytes"]["measured"].at("positions") >= usual["bytes"]["predicted"].at("positions"));
  for (const Json& row : report["settings"]) {
    REQUIRE(row.at("ms").at("device").size() == 2);
    for (const Json& round : row["ms"]["device"]) CHECK(round.at(0) > 0);
  }
  CHECK(settingOf(report, "tiers 0").at("views")[0].at("draws") <= usual["views"][0]["draws"]);
  CHECK(report.at("walks").size() == 4);

  const std::string html = readTextFile(out / "report.html");
  CHECK_THAT(html, Contains("<svg") && Contains("src=\"data:image/jpeg;base64,") && !Contains("<script") &&
                       !Contains("src=\"http") && !Contains("href="));
  for (const char* figure : {"pareto.svg", "knobs.svg", "memory.svg", "passes.svg", "histogram.svg"}) {
    const std::string svg = readTextFile(out / figure);
    CHECK_THAT(svg, Contains("</svg>"));
    CHECK((html.find(svg) != std::string::npos));
  }
  CHECK_THAT(readTextFile(out / "tradeoff.csv"), Contains("\"preset balanced\",\"tiers\",\"3\","));

  const Outcome more = runProgram(tradeoffOfTiny(out));
  CHECK_THAT(more.err, Contains("12 of 12"));
  CHECK(readTextFile(out / "tradeoff.json") == text);  // cached file, raw times included
}

TEST_CASE("ibr tradeoff reports how far two eyes agree, also from cached measurements") {
  if (!deviceIsThere()) return;
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  const std::vector<std::string> line{"tradeoff",  tinyScene(), "--truth", tinySet().truth, "--knobs", "eyeColours",
                                      "--no-grid", "--repeat",  "1",       "--walk",        "0",       "-q",
                                      "-o",        out};
  REQUIRE(runProgram(line).code == 0);
  const std::string text = readTextFile(out / "tradeoff.json");
  const Json report = parseJson(text);
  CHECK_FALSE(settingOf(report, "preset balanced").contains("eyes"));
  for (const char* setting : {"eyeColours shared", "eyeColours own"}) {
    const Json& eyes = settingOf(report, setting).at("eyes");
    CHECK(eyes.at("seenByBoth") > 0.3);
    CHECK(eyes.at("difference") > 0);  // the eyes have different positions
    CHECK(eyes.at("difference") < 10);
    CHECK(eyes.at("difference95") >= eyes.at("difference"));
    CHECK(eyes == settingOf(report, setting).at("views")[0].at("eyes"));
  }
  const std::string html = readTextFile(out / "report.html"), cell = "<td>eyeColours own</td>";
  const std::size_t first = html.find(cell), second = html.find(cell, first + 1);
  CHECK((first != std::string::npos && second != std::string::npos));  // tables of eyes and of all settings
  REQUIRE(runProgram(line).code == 0);
  CHECK(readTextFile(out / "tradeoff.json") == text);
}

TEST_CASE("ibr tradeoff resumes after Ctrl-C without losing measurements") {
  if (!deviceIsThere()) return;
  const TemporaryFolder folder;
  const fs::path out = folder / "report", kept = out / "tradeoff.kept.jsonl";
  std::vector<std::string> line = tradeoffOfTiny(out);
  *std::ranges::find(line, "2") = "40";  // enough rounds to interrupt the program
  const auto linesKept = [&] {
    const std::string text = fs::exists(kept) ? readTextFile(kept) : "";
    return std::ranges::count(text, '\n');
  };
  Outcome stopped;
  // On a busy machine the signal may arrive after the end of the program; the test then repeats the attempt.
  for (int attempt = 0; attempt < 10 && stopped.code != 130; ++attempt) {
    fs::remove_all(out);
    stopped = runProgram(line, {.interruptWhen = [&](const std::string&) { return linesKept() >= 13; }});
  }
  INFO(stopped.err);
  REQUIRE(stopped.code == 130);
  CHECK_THAT(stopped.err, Contains("again"));
  CHECK_FALSE(fs::exists(out / "tradeoff.json"));
  const std::string before = readTextFile(kept);
  const auto found = std::ranges::count(before, '\n');
  const auto linesWith = [&](const std::string& what) {
    std::istringstream lines(before);
    int count = 0;
    for (std::string each; std::getline(lines, each);) count += each.find(what) != std::string::npos;
    return count;
  };
  CHECK(linesWith("\"prediction\"") == 10);  // settings: images come first
  CHECK(linesWith("\"times\"") >= 2);        // rounds
  const Outcome resumed = runProgram(line);
  INFO(resumed.err);
  REQUIRE(resumed.code == 0);
  CHECK_THAT(resumed.err, Contains(std::to_string(found) + " of 50"));
  const std::string after = readTextFile(kept);
  std::istringstream lines(before);
  for (std::string each; std::getline(lines, each);) CHECK((after.find(each + '\n') != std::string::npos));
  CHECK(settingOf(parseJson(readTextFile(out / "tradeoff.json")), "preset fast").at("ms").at("device").size() == 40);
}

TEST_CASE("ibr tradeoff plots the optimiser's settings that ibr-lab sweep measured") {
  if (!deviceIsThere()) return;
  const TemporaryFolder folder;
  const Outcome swept =
      runLab({"sweep", tinyScene(), "--truth", tinySet().truth, "-o", folder / "swept", "--method", "cpu",
              "--instances", "16", "--radius", "1", "5", "--decay", "0.5", "--threshold", "0.005", "-q"});
  INFO(swept.err);
  REQUIRE(swept.code == 0);
  const Json sweep = parseJson(readTextFile(folder / "swept" / "sweep.json"));
  const Outcome outcome =
      runProgram({"tradeoff", tinyScene(), "--truth", tinySet().truth, "--knobs", "blend", "--no-grid", "--repeat", "1",
                  "--walk", "0", "--sweep", folder / "swept" / "sweep.json", "-o", folder / "out", "-q"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const std::string svg = readTextFile(folder / "out" / "optimiser.svg");
  std::size_t drawn = 0;
  for (const Json& row : sweep.at("settings")) {
    const std::string method = row.at("method"), name = row.at("setting");
    if (method == "none") {
      CHECK_THAT(svg, Contains(">" + name + "<"));
      continue;
    }
    ++drawn;
    // The tooltip of each mark shows the exact numbers.
    for (const Json& y : {row.at("scores").at("psnrCovered"), row.at("ecc")})
      CHECK_THAT(svg, Contains(fmt::format("<title>{}: {:.4g}, {:.4g}</title>", name, row.at("seconds").get<double>(),
                                           y.get<double>())));
  }
  CHECK(drawn == sweep.at("settings").size() - 1);
  CHECK(drawn >= 2);
  CHECK((readTextFile(folder / "out" / "report.html").find(svg) != std::string::npos));
}

TEST_CASE("ibr tradeoff rejects invalid options and inputs") {
  CHECK(runProgram({"tradeoff", tinyScene(), "--knobs", "speed", "-o", "x"}).code == 1);
  const Outcome inside = runProgram({"tradeoff", tinyScene(), "-o", tinyScene() / "report"});
  CHECK(inside.code == 3);
  CHECK_THAT(inside.err, Contains("--output"));
  CHECK_THAT(runProgram({"tradeoff", tinyScene(), "--build", "nameless", "-o", "x"}).err, Contains("NAME=SCENE"));
  const TemporaryFolder folder;
  writeFile(folder / "sweep.json", std::string_view("{\"settings\":[{}]}"));
  const Outcome sweep = runProgram({"tradeoff", tinyScene(), "--sweep", folder / "sweep.json", "-o", folder / "x"});
  CHECK(sweep.code == 3);
  CHECK_THAT(sweep.err, Contains("sweep.json") && Contains("--sweep"));
}
