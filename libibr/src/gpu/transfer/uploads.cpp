// SPDX-License-Identifier: Apache-2.0
#include "ibr/uploads.h"

#include "gpu/transfer/upload_batch.h"

namespace ibr {

Uploads::Uploads(const Device& device) : state_(std::make_unique<State>(State{device.handle(), {}})) {}
Uploads::Uploads(Uploads&&) noexcept = default;
Uploads& Uploads::operator=(Uploads&&) noexcept = default;
Uploads::~Uploads() = default;

void Uploads::record(VkCommandBuffer commandBuffer) const noexcept {
  recordSteps(commandBuffer, state_->batch.steps);
}

void Uploads::clear() noexcept {
  state_->batch = {};
}

bool Uploads::empty() const noexcept {
  return state_->batch.steps.empty();
}

std::uint64_t Uploads::bytes() const noexcept {
  return state_->batch.stagingBytes();
}

Uploads::State& stateOf(Uploads& uploads) noexcept {
  return *uploads.state_;
}

}  // namespace ibr
