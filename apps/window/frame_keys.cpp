// SPDX-License-Identifier: Apache-2.0
#include "window/frame_keys.h"

namespace ibr::app {

void FrameKeys::beginFrame(std::span<const KeyChange> changes) {
  waiting_.insert(waiting_.end(), changes.begin(), changes.end());
  std::set<int> changed;
  for (; !waiting_.empty() && changed.insert(waiting_.front().key).second; waiting_.pop_front()) {
    if (waiting_.front().down)
      down_.insert(waiting_.front().key);
    else
      down_.erase(waiting_.front().key);
  }
}

}  // namespace ibr::app
