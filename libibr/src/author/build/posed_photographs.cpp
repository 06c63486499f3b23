// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "author/build/build_input.h"
#include "author/photographs/masks.h"
#include "author/photographs/photographs.h"
#include "ibr/author/build.h"

namespace ibr {

struct PosedPhotographs::State {
  std::vector<PosedImage> images;
  std::vector<Photograph> photographs;
};

PosedPhotographs::PosedPhotographs(const BuildOptions& options, const LogCallback& log)
    : state_(std::make_unique<State>()) {
  state_->photographs = std::move(readInput(options, log).photographs);
  for (const Photograph& photograph : state_->photographs)
    state_->images.push_back({photograph.name, photograph.camera});
}
PosedPhotographs::PosedPhotographs(PosedPhotographs&&) noexcept = default;
PosedPhotographs::~PosedPhotographs() = default;

const std::vector<PosedImage>& PosedPhotographs::images() const noexcept {
  return state_->images;
}

Image8 PosedPhotographs::photograph(std::size_t image) const {
  return loadPhotograph(state_->photographs.at(image));
}

Image8 PosedPhotographs::mask(std::size_t image) const {
  const Photograph& photograph = state_->photographs.at(image);
  return photograph.mask.empty() ? Image8() : loadMask(photograph, photograph.mask);
}

}  // namespace ibr
