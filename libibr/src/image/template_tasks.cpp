// SPDX-License-Identifier: Apache-2.0
#include "image/template_tasks.h"

#include "base/check.h"

namespace ibr {

void checkTemplateImages(std::span<const Image8* const> pictures) {
  for (const Image8* picture : pictures)
    check(picture->channels == 3 && !picture->empty(), ErrorCode::invalidInput,
          "template search: an image has {} channels and {} × {} px, not 3 channels and a size", picture->channels,
          picture->width, picture->height);
}

void checkTemplateTasks(std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
                        std::size_t pictures) {
  check(radius >= 0 && radius <= kMaxTemplateRadius, ErrorCode::invalidInput,
        "template search: radius {} is not within 0 to {}", radius, kMaxTemplateRadius);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const TemplateTask& task = tasks[t];
    check(task.picture < pictures && task.count <= kMaxTemplateSampleCount && task.first <= samples.size() &&
              task.count <= samples.size() - task.first,
          ErrorCode::invalidInput, "template search: task {} refers to images or samples that do not exist", t);
    const auto near = [](int start) { return start >= -kMaxTemplateStartPx && start <= kMaxTemplateStartPx; };
    check(near(task.start.x) && near(task.start.y), ErrorCode::invalidInput,
          "template search: task {} starts at ({}, {}), more than {} px from the origin", t, task.start.x, task.start.y,
          kMaxTemplateStartPx);
  }
}

}  // namespace ibr
