// SPDX-License-Identifier: Apache-2.0
// Command lines of `ibr-lab sweep`.
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

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> commaParts(const std::string& line) {
  std::vector<std::string> parts{""};
  for (const char c : line)
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

std::vector<std::string> sweepOfTiny(const fs::path& output, const std::vector<std::string>& more) {
  std::vector<std::string> line{"sweep", tinyScene(), "--truth", tinySet().truth, "-o", output};
  line.insert(line.end(), more.begin(), more.end());
  return line;
}

// Options that give seven rows.
const std::vector<std::string> kSmall{"--method",    "cpu",   "gradient",   "--instances", "16",
                                      "--radius",    "1",     "5",          "--decay",     "0.5",
                                      "--threshold", "0.005", "--rigidity", "0",           "1"};

std::vector<std::string> listed(const std::vector<std::string>& options) {
  std::vector<std::string> line = sweepOfTiny("unused", options);
  line.push_back("--list");
  const Outcome outcome = runLab(line);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  return linesOf(outcome.out);
}

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

bool has(const std::vector<std::string>& lines, const std::string& line) {
  return std::ranges::find(lines, line) != lines.end();
}

}  // namespace

TEST_CASE("ibr-lab sweep measures the figures of ibr optimise and ibr eval for each setting") {
  if (!deviceIsThere()) return;
  const TemporaryFolder folder;
  const fs::path out = folder / "swept";
  std::vector<std::string> line = sweepOfTiny(out, kSmall);
  line.insert(line.end(), {"--json", folder / "report.json"});
  const Outcome outcome = runLab(line);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.out, Contains("setting") && Contains("ECC") && Contains("PSNR") &&
                              Contains("gradient rigidity 0") && Contains("Spearman") && Contains("6 settings"));
  CHECK_THAT(outcome.err, Contains("7 settings") && Contains("cells 0") && Contains("0 cached") && Contains("%"));

  const std::string text = readTextFile(out / "sweep.json");
  CHECK(text == readTextFile(folder / "report.json"));
  const Json report = parseJson(text);
  const std::vector<std::string> names{"unoptimised",        "cpu default",      "cpu R 1",
                                       "cpu rigidity 0",     "gradient default", "gradient R 1",
                                       "gradient rigidity 0"};
  REQUIRE(report.at("settings").size() == names.size());
  for (std::size_t s = 0; s < names.size(); ++s) {
    const Json& row = report["settings"][s];
    INFO(names[s]);
    CHECK(row.at("setting") == names[s]);
    CHECK(row.at("default") == names[s].ends_with("default"));
    CHECK((row.at("seconds") > 0) == (s > 0));
    CHECK((row.at("mutations") > 100) == (s > 0));
    CHECK(row.at("ecc") >= report["settings"][0].at("ecc"));
    CHECK(row.at("eccPaper") > 0.5);
    CHECK(row.at("scores").at("psnrCovered") > 15);
    CHECK(row["scores"].at("psnr") <= row["scores"]["psnrCovered"]);
  }
  CHECK(report["settings"][2].at("radius") == 1);
  CHECK(report["settings"][3].at("rigidity") == 0);
  CHECK(report["settings"][0].at("radius").is_null());
  CHECK(report.at("views") == Json{"between.png"});
  CHECK(report.at("cells") == Json{0});
  CHECK(report.at("evaluation").at("cells") == 1);
  CHECK(report["evaluation"].at("tiers") == 0);
  CHECK(report.at("scene") == tinyScene().string());
  CHECK_THAT(report.at("command").get<std::string>(),
             Contains("ibr-lab sweep " + tinyScene().string()) && Contains("--radius 1 5 --decay 0.5"));
  CHECK(!report.at("device").get<std::string>().empty());
  for (const char* which : {"all", "cpu", "gradient"}) CHECK(report.at("spearman").contains(which));

  const std::vector<std::string> csv = linesOf(readTextFile(out / "sweep.csv"));
  REQUIRE(csv.size() == 1 + names.size());
  const std::vector<std::string> heading = commaParts(csv[0]);
  for (std::size_t s = 0; s < names.size(); ++s) {
    const std::vector<std::string> parts = commaParts(csv[1 + s]);
    REQUIRE(parts.size() == heading.size());
    CHECK(parts[0] == names[s]);
    const auto at = [&](const char* name) {
      return parts[std::size_t(std::ranges::find(heading, name) - heading.begin())];
    };
    CHECK(std::stod(at("ecc")) == report["settings"][s]["ecc"]);
    CHECK(std::stod(at("psnrCovered")) == report["settings"][s]["scores"]["psnrCovered"]);
    CHECK(at("radius") == (s == 0 ? "" : s % 3 == 2 ? "1" : "5"));
  }

  const std::string svg = readTextFile(out / "sweep.svg");
  CHECK_THAT(svg, Contains(">unoptimised<") && Contains("Spearman") && Contains(">gradient<") && Contains("</svg>"));
  // Each setting is plotted three times: time and ECC, time and PSNR, ECC and PSNR.
  CHECK(countOf(svg, "<title>cpu rigidity 0: ") == 3);

  SECTION("the figures equal those of the single commands") {
    const auto scoresOf = [&](const fs::path& scene) {
      const Outcome eval = runProgram({"eval", scene, "--truth", tinySet().truth, "--composition", "cells", "--cells",
                                       "1", "--tiers", "0", "-q", "--json", "-"});
      REQUIRE(eval.code == 0);
      return parseJson(eval.out).at("mean");
    };
    const Outcome optimised = runProgram({"optimise", tinyScene(), "-o", folder / "sharper", "--method", "cpu",
                                          "--instances", "16", "--radius", "1", "-q", "--json", "-"});
    REQUIRE(optimised.code == 0);
    const Json mean = parseJson(optimised.out).at("mean"), cell = parseJson(optimised.out)["cells"][0];
    const Json& row = report["settings"][2];
    CHECK(row["ecc"] == mean.at("finalEcc"));
    CHECK(row["eccPaper"] == mean.at("finalEccPaper"));
    CHECK(row["mutations"] == cell.at("mutations"));
    CHECK(report["settings"][0]["ecc"] == mean.at("initialEcc"));
    CHECK(report["settings"][0]["eccPaper"] == mean.at("initialEccPaper"));
    const Json before = scoresOf(tinyScene()), after = scoresOf(folder / "sharper");
    for (const char* figure : {"psnr", "ssim", "psnrCovered", "ssimCovered", "coverage"}) {
      INFO(figure);
      CHECK(report["settings"][0]["scores"][figure] == before.at(figure));
      CHECK(row["scores"][figure] == after.at(figure));
    }
    CHECK(before["psnrCovered"] != after["psnrCovered"]);
  }
  SECTION("a second run measures nothing") {
    const Outcome again = runLab(line);
    REQUIRE(again.code == 0);
    CHECK_THAT(again.err, Contains("7 cached") && !Contains("%"));
    CHECK(again.out == outcome.out);
    CHECK(readTextFile(out / "sweep.json") == text);
    CHECK(readTextFile(out / "sweep.svg") == svg);
  }
  SECTION("damaged cached settings, and settings with another seed, tier or number of threads, are measured again") {
    std::vector<std::string> kept = linesOf(readTextFile(out / "sweep.kept.jsonl"));
    REQUIRE(kept.size() == 7);
    kept[3].resize(kept[3].size() / 2);
    const std::size_t ecc = kept[5].find("\"ecc\"");
    REQUIRE(ecc != std::string::npos);
    kept[5].replace(ecc, 5, "\"abc\"");
    std::string damaged;
    for (const std::string& l : kept) damaged += l + '\n';
    writeFile(out / "sweep.kept.jsonl", std::string_view(damaged));
    const Outcome again = runLab(line);
    REQUIRE(again.code == 0);
    CHECK_THAT(again.err, Contains("5 cached"));
    CHECK(parseJson(readTextFile(out / "sweep.json")).at("settings").size() == 7);
    for (const std::vector<std::string>& other :
         std::vector<std::vector<std::string>>{{"--seed", "2"}, {"--tiers", "1"}, {"--threads", "1"}}) {
      std::vector<std::string> words = sweepOfTiny(
          out, {"--method", "gradient", "--radius", "5", "--decay", "0.5", "--threshold", "0.005", "--rigidity", "1"});
      words.insert(words.end(), other.begin(), other.end());
      INFO(other[0]);
      CHECK_THAT(runLab(words).err, Contains("2 settings") && Contains("0 cached"));
    }
  }
}

TEST_CASE("ibr-lab sweep lists settings around the default, or all combinations") {
  const std::vector<std::string> usual = listed({});
  CHECK(usual.size() == 1 + 16 + 13);
  CHECK(usual[0] == "unoptimised");
  CHECK(usual[1] == "cpu default");
  CHECK(has(usual, "cpu M 128"));
  CHECK(has(usual, "gradient R 20"));
  CHECK(!has(usual, "gradient M 128"));  // the gradient method does not use M
  CHECK(!has(usual, "cpu pruned"));
  CHECK(listed({"--prune"}).size() == usual.size() + 1);
  CHECK(has(listed({"--prune"}), "cpu pruned"));
  // If a list lacks the default, its first value serves as the default.
  CHECK(listed({"--method", "cpu", "--radius", "2", "3", "2", "--instances", "64", "--decay", "0.5", "--threshold",
                "0.005", "--rigidity", "1"}) == std::vector<std::string>{"unoptimised", "cpu default", "cpu R 3"});
  const std::vector<std::string> grid = listed({"--grid"});
  CHECK(grid.size() == 1 + 4 * 5 * 4 + 5 * 4);
  CHECK(has(grid, "cpu M 16 R 20 D 0.25"));
  CHECK(has(grid, "gradient R 20 D 1"));
  CHECK(listed({"--grid", "--prune", "--method", "compute", "--instances", "32", "64", "--radius", "5", "--decay",
                "0.5", "1", "--rigidity", "0", "1", "10"})
            .size() == 1 + 2 * (2 * 2 * 3));
}

TEST_CASE("ibr-lab sweep resumes after Ctrl-C with the measured settings cached") {
  if (!deviceIsThere()) return;
  const TemporaryFolder folder;
  const fs::path out = folder / "swept";
  const std::vector<std::string> line = sweepOfTiny(out, kSmall);
  Outcome stopped;
  // On a busy machine the signal may arrive after the end of the program; the test then repeats the attempt.
  for (int attempt = 0; attempt < 10 && stopped.code != 130; ++attempt) {
    fs::remove_all(out);
    stopped = runLab(line, {.interruptWhen = [&](const std::string&) { return fs::exists(out / "sweep.csv"); }});
  }
  INFO(stopped.err);
  REQUIRE(stopped.code == 130);
  CHECK_THAT(stopped.err, Contains("again"));
  const std::size_t kept = linesOf(readTextFile(out / "sweep.kept.jsonl")).size();
  CHECK(kept >= 1);
  CHECK(kept < 7);
  const Outcome resumed = runLab(line);
  REQUIRE(resumed.code == 0);
  CHECK_THAT(resumed.err, Contains(std::to_string(kept) + " cached"));
  CHECK(parseJson(readTextFile(out / "sweep.json")).at("settings").size() == 7);
}

TEST_CASE("ibr-lab sweep rejects invalid options and inputs") {
  const TemporaryFolder folder;
  const fs::path out = folder / "swept";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{"--method", "cpu", "magic"},
                                                                                     {"--instances", "64", "1"},
                                                                                     {"--instances", "1.5"},
                                                                                     {"--radius", "65"},
                                                                                     {"--decay", "0.5", "1.1"},
                                                                                     {"--threshold", "-1"},
                                                                                     {"--rigidity", "x"},
                                                                                     {"--cells-only", "-1"},
                                                                                     {"--radius"}}) {
    const Outcome outcome = runLab(sweepOfTiny(out, words));
    INFO(words[0] << ": " << outcome.err);
    CHECK(outcome.code == 1);
    CHECK_THAT(outcome.err, Contains(words[0]));
    if (words.size() > 1) CHECK_THAT(outcome.err, Contains("'" + words.back() + "'"));
  }
  CHECK(runLab({"sweep", tinyScene(), "-o", out}).code == 1);
  CHECK(runLab({"sweep", tinyScene(), "--truth", tinySet().truth}).code == 1);
  CHECK(runLab({"sweep", folder / "none", "--truth", tinySet().truth, "-o", out}).code == 2);
  CHECK(runLab({"sweep", tinyScene(), "--truth", folder / "none", "-o", out}).code == 2);
  const Outcome inside = runLab(sweepOfTiny(tinySet().truth / "swept", {}));
  CHECK(inside.code == 3);
  CHECK_THAT(inside.err, Contains("--output"));
  CHECK(!fs::exists(tinySet().truth / "swept"));
  const Outcome cell = runLab(sweepOfTiny(out, {"--cells-only", "99"}));
  CHECK(cell.code == 3);
  CHECK_THAT(cell.err, Contains("99") && Contains("--cells-only"));
  const Outcome view = runLab(sweepOfTiny(out, {"--views", "nowhere.png"}));
  CHECK(view.code == 3);
  CHECK_THAT(view.err, Contains("nowhere.png") && Contains("--views"));
  CHECK(!fs::exists(out));
  const Outcome help = runLab({"sweep", "--help"});
  CHECK(help.code == 0);
  CHECK_THAT(help.out,
             Contains("Examples:") && Contains("--grid") && Contains("--rigidity X...") && Contains("[0 1 10]"));
}
