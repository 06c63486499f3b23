// SPDX-License-Identifier: Apache-2.0
#include "viewer/control/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "ibr/asset.h"
#include "ibr/error.h"
#include "viewer/control/job_plans.h"
#include "window/window.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

// The first settings apply to all scenes, and may name cells that this scene lacks. Returns true if any were removed.
bool dropMissingCells(const Scene& scene, RenderSettings& settings) {
  std::size_t dropped = 0;
  for (std::vector<std::uint32_t>* cells : {&settings.mutedCells, &settings.soloCells})
    dropped += std::erase_if(*cells, [&](std::uint32_t cell) { return cell >= scene.cells.size(); });
  return dropped > 0;
}

bool same(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored) || fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
}

}  // namespace

void Viewer::open(const fs::path& path) {
  for (std::size_t i = 0; i < items.size(); ++i)
    if (same(items[i]->path, path)) {
      current = i;
      return;
    }
  if (std::ranges::any_of(opening, [&](const Opening& other) { return same(other.path, path); })) return;
  std::error_code ignored;
  if (!assetKind(path) && fs::is_directory(path, ignored) && containsPhotographs(path)) {
    JobPlan plan = buildPlan(path);
    if (std::ranges::any_of(jobs, [&](const auto& job) { return job->plan().resultScene == plan.resultScene; })) return;
    jobs.push_back(std::make_unique<Job>(std::move(plan)));
    logMessage(LogLevel::info, fmt::format("building a scene from {}", path.string()));
    return;
  }
  opening.push_back({path, Background<OpenItem>([path](const std::stop_token& stop) {
                       struct Wake {
                         ~Wake() { wakeWindow(); }
                       } wake;
                       return openItem(path, stop);
                     })});
}

bool Viewer::collectFinishedJobs() {
  const std::size_t before = jobs.size();
  for (std::size_t i = jobs.size(); i-- > 0;) {
    const Job::State state = jobs[i]->state();
    if (state == Job::State::running) continue;
    const std::unique_ptr<Job> job = std::move(jobs[i]);
    jobs.erase(jobs.begin() + std::ptrdiff_t(i));
    const JobPlan& plan = job->plan();
    if (state == Job::State::done && !plan.resultScene.empty()) {
      std::erase_if(items, [&](const auto& item) { return same(item->path, plan.resultScene); });
      current = std::min(current, items.empty() ? 0 : items.size() - 1);
      open(plan.resultScene);
    }
    if (state == Job::State::done && !plan.done.empty()) show(plan.done);
    if (state == Job::State::cancelled) logMessage(LogLevel::info, fmt::format("{}: stopped", plan.name));
    if (state == Job::State::failed) logMessage(LogLevel::error, fmt::format("{}: {}", plan.name, job->progress()));
  }
  return jobs.size() != before;
}

bool Viewer::collectOpenedItems() {
  takePosted();
  bool any = collectFinishedJobs();
  // Takes results in the order of the requests.
  while (!opening.empty() && opening[0].item.isReady()) {
    Opening done = std::move(opening[0]);
    opening.erase(opening.begin());
    any = true;
    try {
      items.push_back(std::make_shared<OpenItem>(done.item.take()));
      current = items.size() - 1;
      item()->settings = first;
      if (initialCameraPath) {
        item()->cameraPath = *std::exchange(initialCameraPath, std::nullopt);
        item()->loopingPath = true;
        item()->showCameraPath();
      }
      if (item()->scene && dropMissingCells(*item()->scene, item()->settings))
        logMessage(LogLevel::warning,
                   fmt::format("{}: the scene has {} cells; --mute and --solo of other cells are ignored", item()->name,
                               item()->scene->cells.size()));
      logMessage(LogLevel::info,
                 fmt::format("{}: {} photographs", items.back()->name, items.back()->viewpoints.size()));
    } catch (const std::exception& e) {
      logMessage(LogLevel::error, e.what());
    }
  }
  return any;
}

void Viewer::closeCurrent() {
  if (!item()) return;
  items.erase(items.begin() + std::ptrdiff_t(current));
  current = std::min(current, items.empty() ? 0 : items.size() - 1);
}

void Viewer::show(std::string text) {
  message = text;
  messageIsWarning = false;
  messageUntil = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  logMessage(LogLevel::info, std::move(text));
}

void Viewer::logMessage(LogLevel level, std::string text) {
  constexpr std::size_t kLines = 1000;
  if (mirror) mirror(level, text);
  failed |= level == LogLevel::error;
  if (level >= LogLevel::warning) {
    message = text;
    messageIsWarning = true;
    messageUntil = std::chrono::steady_clock::now() + std::chrono::seconds(8);
  }
  log.push_back({level, std::move(text)});
  if (log.size() > kLines) log.pop_front();
}

void Viewer::post(LogLevel level, std::string_view text) {
  {
    const std::lock_guard lock(postedMutex_);
    posted_.push_back({level, std::string(text)});
  }
  wakeWindow();
}

bool Viewer::hasPosted() const {
  const std::lock_guard lock(postedMutex_);
  return !posted_.empty();
}

void Viewer::takePosted() {
  std::vector<LogLine> lines;
  {
    const std::lock_guard lock(postedMutex_);
    lines.swap(posted_);
  }
  for (LogLine& line : lines) logMessage(line.level, std::move(line.text));
}

}  // namespace ibr::app
