// SPDX-License-Identifier: Apache-2.0
// VrApp: screenshots. A frame records copies of the eyes' images; once the frame has finished, another thread encodes
// and writes the copies.
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/stopwatch.h"
#include "ibr/error.h"
#include "shared/cli/settings.h"
#include "vr/headset/eye_pictures.h"
#include "vr/show/vr_capture.h"

namespace fs = std::filesystem;

namespace ibr::app {

// Returns a free capture if this frame needs a screenshot. A screenshot of the menu waits for the next frame with a
// free capture; those of options belong to this frame, which waits for the first capture that the writer releases.
VrApp::Capture* VrApp::dueCapture() {
  const std::uint64_t number = state_.shown + 1;
  const bool last = number == options().frames && !options().screenshot.empty();
  const bool exact = last || (options().screenshotEvery > 0 && number % options().screenshotEvery == 0);
  if (!exact && !screenshotRequested_) return nullptr;
  Capture* capture = freeCapture();
  if (exact && !capture) {
    static_assert(std::tuple_size_v<decltype(captures_)> > FrameRing::kSlots);  // so the writer has at least one
    const Stopwatch waiting;
    while (!(capture = freeCapture())) reportPictures(writer_.waitForResults());
    excludedMs_ += 1e3 * waiting.seconds();
  }
  if (capture) capture->required = last;
  return capture;
}

VrApp::Capture* VrApp::freeCapture() const {
  const auto capture = std::ranges::find_if(captures_, [](const auto& one) { return one->images.isFree(); });
  return capture == captures_.end() ? nullptr : capture->get();
}

// Call after the frame with the capture's copies was submitted.
void VrApp::keepCapture(Capture& capture, std::uint64_t frame, const std::array<Camera, 2>& eyes) {
  capture.eyes = eyes;
  capture.settings = drawnSettings_;
  capture.floor = floor_;
  capture.isQueued = false;
  capture.images.submitted(frame);
  screenshotRequested_ = false;
  ignoreNextFrames(governor_);  // the copies take time on the device
}

// Gives captures of finished frames to the writer.
void VrApp::writeCaptures(std::uint64_t completed) {
  for (const auto& owned : captures_) {
    Capture& capture = *owned;
    if (capture.images.isFree() || capture.isQueued || capture.images.frame() > completed) continue;
    capture.isQueued = true;
    const fs::path& place = capture.required ? options().screenshot : options().screenshots;
    writer_.add({.name = place.string(),
                 .write =
                     [this, &capture] {
                       const fs::path file =
                           capture.required ? options().screenshot : freePicture(options().screenshots);
                       struct Release {
                         EyeCapture& images;
                         ~Release() { images.release(); }
                       } release{capture.images};
                       const auto files =
                           writeEyes(file, capture.images.read(), capture.eyes,
                                     pictureSettingsJson(capture.settings, options().gpuScene, capture.floor));
                       return std::vector<fs::path>(files.begin(), files.end());
                     },
                 .required = capture.required});
  }
}

void VrApp::reportPictures(const std::vector<PictureResult>& results) {
  for (const PictureResult& result : results) {
    if (!result.error) {
      state_.pictures.insert(state_.pictures.end(), result.files.begin(), result.files.end());
      for (const fs::path& file : result.files) logMessage(LogLevel::info, fmt::format("{} written", file.string()));
      continue;
    }
    try {
      std::rethrow_exception(result.error);
    } catch (const Error& e) {
      if (result.required) throw;  // the requested screenshot failed, so the program fails
      lastError_ = e.what();
      logMessage(LogLevel::error, lastError_);
    }
  }
}

// Writes all captures, also those of frames in flight, and waits.
void VrApp::finishPictures() {
  const Stopwatch waiting;
  if (std::ranges::any_of(captures_, [](const auto& c) { return !c->images.isFree() && !c->isQueued; })) {
    ring_.wait();
    writeCaptures(std::numeric_limits<std::uint64_t>::max());
  }
  reportPictures(writer_.finish());
  excludedMs_ += 1e3 * waiting.seconds();
}

}  // namespace ibr::app
