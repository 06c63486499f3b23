// SPDX-License-Identifier: Apache-2.0
#include "viewer/viewer.h"

#include <fmt/format.h>

#include <algorithm>

#include "ibr/asset.h"
#include "ibr/error.h"
#include "viewer/window.h"

namespace fs = std::filesystem;

namespace ibr::app {

void Viewer::open(const fs::path& path) {
  std::error_code ignored;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (fs::equivalent(places[i]->path, path, ignored)) {
      current = i;
      return;
    }
  if (!assetKind(path) && fs::is_directory(path, ignored) && holdsPhotographs(path)) {
    building.push_back(std::make_unique<BuildJob>(path));
    say(LogLevel::info, fmt::format("making a scene of {}", path.string()));
    return;
  }
  opening.push_back({path, std::async(std::launch::async, [path] {
                       struct Wake {
                         ~Wake() { wakeWindow(); }
                       } wake;
                       return openPlace(path);
                     })});
}

bool Viewer::takeBuilt() {
  const std::size_t before = building.size();
  for (std::size_t i = building.size(); i-- > 0;) {
    const BuildJob& job = *building[i];
    const BuildJob::State state = job.state();
    if (state == BuildJob::State::running) continue;
    if (state == BuildJob::State::done) open(job.scene());
    if (state == BuildJob::State::cancelled)
      say(LogLevel::info, fmt::format("{}: stopped", job.photographs().string()));
    if (state == BuildJob::State::failed) say(LogLevel::error, job.progress());
    building.erase(building.begin() + std::ptrdiff_t(i));
  }
  return building.size() != before;
}

bool Viewer::takeOpened() {
  bool any = takeBuilt();
  // In the order in which they were asked for.
  while (!opening.empty() && opening[0].place.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    Opening done = std::move(opening[0]);
    opening.erase(opening.begin());
    any = true;
    try {
      places.push_back(std::make_unique<Place>(done.place.get()));
      current = places.size() - 1;
      place()->settings = first;
      say(LogLevel::info, fmt::format("{}: {} photographs", places.back()->name, places.back()->viewpoints.size()));
    } catch (const std::exception& e) {
      say(LogLevel::error, e.what());
    }
  }
  return any;
}

void Viewer::closeCurrent() {
  if (!place()) return;
  places.erase(places.begin() + std::ptrdiff_t(current));
  current = std::min(current, places.empty() ? 0 : places.size() - 1);
}

void Viewer::show(std::string text) {
  message = text;
  messageUntil = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  say(LogLevel::info, std::move(text));
}

void Viewer::say(LogLevel level, std::string text) {
  constexpr std::size_t kLines = 1000;
  if (mirror) mirror(level, text);
  failed |= level == LogLevel::error;
  if (level >= LogLevel::warning) {
    message = text;
    messageUntil = std::chrono::steady_clock::now() + std::chrono::seconds(8);
  }
  log.push_back({level, std::move(text)});
  if (log.size() > kLines) log.pop_front();
}

}  // namespace ibr::app
