// SPDX-License-Identifier: Apache-2.0
#include "viewer/build_job.h"

#include <cctype>

#include "base/child_process.h"
#include "ibr/error.h"
#include "viewer/window.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

bool isPhotograph(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
  for (const char* known : {".jpg", ".jpeg", ".png", ".tif", ".tiff"})
    if (extension == known) return true;
  return false;
}

// The poses that lie with the photographs, as options.
std::vector<std::string> posesIn(const fs::path& folder) {
  for (const char* model : {"sparse/0", "sparse"})
    for (const char* images : {"images.bin", "images.txt"})
      if (fs::exists(folder / model / images)) return {"--model", (folder / model).string()};
  if (fs::exists(folder / "transforms.json")) return {"--transforms", (folder / "transforms.json").string()};
  return {};
}

}  // namespace

bool holdsPhotographs(const fs::path& folder) noexcept try {
  constexpr int kEnough = 2, kLooks = 10000;
  int found = 0, looks = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
    if (++looks > kLooks) return false;
    if (isPhotograph(entry.path()) && ++found == kEnough) return true;
  }
  return false;
} catch (const fs::filesystem_error&) {
  return false;
}

fs::path builderProgram() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& beside : {self.parent_path() / "ibr", self.parent_path().parent_path() / "batch/ibr"})
    if (!error && fs::is_regular_file(beside)) return beside;
  return "ibr";
}

BuildJob::BuildJob(const fs::path& photographs) : photographs_(fs::absolute(photographs).lexically_normal()) {
  if (photographs_.filename().empty()) photographs_ = photographs_.parent_path();
  scene_ = photographs_.string() + "-scene";
  std::vector<std::string> words{builderProgram().string(), "build", photographs_.string(), "-o", scene_.string()};
  for (std::string& word : posesIn(photographs_)) words.push_back(std::move(word));
  thread_ = std::thread([this, words = std::move(words)] { run(words); });
}

BuildJob::~BuildJob() {
  cancel();
  thread_.join();
}

void BuildJob::run(const std::vector<std::string>& words) {
  const auto said = [this](std::string_view line) {
    const std::lock_guard lock(mutex_);
    progress_ = line;
    wakeWindow();
  };
  State ended = State::failed;
  try {
    const ChildResult result = runChild(words, {}, said, [this] { return !cancelled_; });
    ended = result.stopped ? State::cancelled : result.status == 0 ? State::done : State::failed;
  } catch (const Error& e) {
    said(e.what());
  }
  const std::lock_guard lock(mutex_);
  state_ = ended;
  wakeWindow();
}

BuildJob::State BuildJob::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::string BuildJob::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

}  // namespace ibr::app
