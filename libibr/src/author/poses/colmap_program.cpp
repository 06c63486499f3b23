// SPDX-License-Identifier: Apache-2.0
#include "author/poses/colmap_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <fstream>
#include <optional>

#include "base/check.h"
#include "base/file.h"
#include "base/parse.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLinesInErrors = 12;

struct Count {
  std::size_t done, total;
};

std::optional<std::size_t> numberAt(std::string_view text, std::size_t& at) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789", at), text.size());
  const auto value = parseInt(text.substr(at, end - at));
  at = end;
  return value && *value >= 0 ? std::optional(std::size_t(*value)) : std::nullopt;
}

// Parses "… [3/12] …", or "… [2/3, 1/4] …" for nested blocks.
std::optional<Count> bracketed(std::string_view line) {
  std::size_t at = line.find('[');
  if (at == line.npos) return std::nullopt;
  std::optional<Count> count;
  while (at < line.size() && line[at] != ']') {
    at = std::min(line.find_first_of("0123456789", at), line.size());
    const auto done = numberAt(line, at);
    if (!done || at >= line.size() || line[at] != '/') return std::nullopt;
    const auto total = numberAt(line, ++at);
    if (!total || *total == 0 || *done > *total) return std::nullopt;
    count = count ? Count{(count->done - std::min<std::size_t>(count->done, 1)) * *total + *done, count->total * *total}
                  : Count{*done, *total};
  }
  return count;
}

// Parses "Registering image #5 (12)", in newer versions "(num_reg_frames=12)".
std::optional<std::size_t> registered(std::string_view line) {
  if (line.find("Registering image") == line.npos) return std::nullopt;
  const std::size_t open = line.rfind('(');
  if (open == line.npos) return std::nullopt;
  std::size_t at = std::min(line.find_first_of("0123456789", open), line.size());
  return numberAt(line, at);
}

std::optional<Count> progressIn(std::string_view line, std::size_t photographs) {
  if (const auto count = registered(line)) return Count{*count, photographs};
  return bracketed(line);
}

}  // namespace

ColmapProgram::OptionNames ColmapProgram::optionNames(const char* stage) const {
  bool newer = false;
  runLine(
      {program_, "feature_extractor", "--help"},
      [&](std::string_view text) { newer = newer || text.find("FeatureExtraction.use_gpu") != text.npos; },
      [&] { return reportProgress(stage, 0, 1); });
  return newer ? OptionNames{"--FeatureExtraction", "--FeatureMatching"}
               : OptionNames{"--SiftExtraction", "--SiftMatching"};
}

void ColmapProgram::run(const std::string& mark, const std::string& command, const char* stage,
                        const std::vector<std::string>& arguments, std::size_t photographs) const {
  if (fs::exists(doneFile(mark, command))) return;
  std::vector<std::string> line{program_, command};
  line.insert(line.end(), arguments.begin(), arguments.end());
  const fs::path logFile = folder_ / (mark + command + ".log");
  std::ofstream all(logFile, std::ios::app);
  std::deque<std::string> last;
  Count count{0, photographs};
  bool nothing = false;  // no model found, which is no failure
  const ChildResult result = runLine(
      line,
      [&](std::string_view text) {
        all << text << '\n';
        last.emplace_back(text);
        if (last.size() > kLinesInErrors) last.pop_front();
        nothing = nothing || text.find("failed to create sparse model") != text.npos;
        if (const auto now = progressIn(text, photographs)) count = *now;
      },
      [&] { return reportProgress(stage, std::min(count.done, count.total), count.total); });
  check(!result.stopped, ErrorCode::cancelled, "cancelled while {}; start again to resume", stage);
  if (nothing) return;
  check(result.status == 0, ErrorCode::io,
        "{} {} failed with exit status {}; its last lines of output (full log: {}):\n{}", program_, command,
        result.status, logFile.string(), fmt::join(last, "\n"));
  writeFile(doneFile(mark, command), std::string_view("done\n"));
}

bool ColmapProgram::reportProgress(const char* stage, std::size_t done, std::size_t total) const {
  return !progress_ || progress_({stage, done, total});
}

ChildResult ColmapProgram::runLine(const std::vector<std::string>& line,
                                   const std::function<void(std::string_view)>& print,
                                   const std::function<bool()>& shouldContinue) const {
  try {
    return runChild(line, {{"QT_QPA_PLATFORM", "offscreen"}}, print, shouldContinue);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::io) throw;
    fail(ErrorCode::io,
         "{}; photographs without poses need the program COLMAP: install it (Debian: apt-get install colmap), set its "
         "path (--colmap) or provide poses (--model, --transforms, --panoramas)",
         e.what());
  }
}

}  // namespace ibr
