// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/htm_player.h"

#include <utility>

#include "base/check.h"
#include "base/stopwatch.h"
#include "ibr/asset.h"

namespace ibr::app {
namespace {

// Runs on the loading thread.
HtmImage readPrepared(const HtmModel& model, std::size_t camera) {
  return prepareHtmImage(model, camera, readHtmPicture(model, camera));
}

}  // namespace

HtmPlayer::HtmPlayer(const std::filesystem::path& path, const HtmPlayerOptions& options, const Context& context)
    : path_(path), sourceMesh_(options.sourceMesh), showsGraph_(options.graph), context_(context) {
  if (assetKind(path) == AssetKind::htmSequence) {
    sequence_ =
        std::make_unique<HtmSequence>(path, readPrepared, HtmSequenceOptions{.framesAhead = options.framesAhead});
    show(options.seconds);
    return;
  }
  const Stopwatch watch;
  HtmFrame alone{loadHtmModel(path), {}};  // images are read during the upload: there may be many
  shown_.push_back({.frame = 0, .name = path_.filename().string(), .loading = 1e3 * watch.seconds()});
  take(std::make_shared<const HtmFrame>(std::move(alone)));
}

void HtmPlayer::take(std::shared_ptr<const HtmFrame> frame) {
  uploaded_ = false;
  frame_ = std::move(frame);
  const HtmModel& model = frame_->model;
  check(!sourceMesh_ || model.source.has_value(), ErrorCode::invalidInput,
        "{}: the model has no source mesh, which --mesh source requires", model.folder.string());
  model_ = sourceMesh_ ? std::make_shared<const HtmModel>(unoptimisedModel(model))
                       : std::shared_ptr<const HtmModel>(frame_, &model);
}

void HtmPlayer::show(double seconds) {
  if (!sequence_) return;
  const std::size_t index = sequence_->frameAt(seconds);
  if (frame_ && shown_.back().frame == index) return;
  const Stopwatch watch;
  std::shared_ptr<const HtmFrame> frame = sequence_->frame(index);
  shown_.push_back({.frame = index,
                    .name = frame->model.folder.filename().string(),
                    .loading = frame->loadMilliseconds,
                    .waiting = 1e3 * watch.seconds()});
  take(std::move(frame));
}

void HtmPlayer::upload() {
  if (!device_)
    device_ = std::make_unique<Device>(Device::create({.device = context_.options().device, .log = context_.log()}));
  double reading = 0;  // s
  const Stopwatch watch;
  const HtmImageSource source = [&](const HtmModel& model, std::size_t camera) {
    if (!frame_->pictures.empty()) return frame_->pictures[camera];
    const Stopwatch file;
    HtmImage picture = readHtmPicture(model, camera);
    reading += file.seconds();
    return picture;
  };
  if (pictures_) {
    pictures_->show(*model_, source);
  } else {
    pictures_ = std::make_unique<HtmModelRenderer>(*model_, *device_, source);
    if (showsGraph_) pictures_->showGraph();
  }
  uploaded_ = true;
  shown_.back().upload = 1e3 * (watch.seconds() - reading);
  shown_.back().loading += 1e3 * reading;
}

HtmPlayer::Picture HtmPlayer::render(const Camera& view, double seconds, const HtmSettings& settings,
                                     HtmPlanState& state, double dtSeconds) {
  show(seconds);
  if (!uploaded_) upload();
  if (stateOf_ && stateOf_ != model_) state = transferHtmState(*model_, *stateOf_, state);
  stateOf_ = model_;
  FrameCosts& shown = shown_.back();
  const Picture picture{pictures_->render(view, settings, state, dtSeconds), shown.frame};
  shown.preparation += picture.preparation;
  shown.rendering += picture.milliseconds;
  ++shown.pictures;
  return picture;
}

}  // namespace ibr::app
