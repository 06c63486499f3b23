// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <mutex>

#include "base/vulkan/submit.h"
#include "ibr/template_search_pass.h"
#include "image/template_tasks.h"

namespace ibr {
namespace {

// Limits the length of a dispatch, for devices that also drive a display.
constexpr TemplateCapacity kPiece{16384, std::size_t(1) << 20};
static_assert(kPiece.samples >= kMaxTemplateSampleCount);

class DeviceSearch {
 public:
  DeviceSearch(const Device& device, std::span<const Image8* const> pictures, std::shared_ptr<std::mutex> turn)
      : turn_(std::move(turn)), pictures_(pictures.size()), pass_(device, pictures, kPiece), submission_(device) {}

  std::vector<TemplateMatch> operator()(std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples,
                                        int radius, TemplateMeasure measure) {
    checkTemplateTasks(tasks, samples, radius, pictures_);
    const std::lock_guard lock(*turn_);
    std::vector<TemplateMatch> matches;
    matches.reserve(tasks.size());
    for (std::size_t t = 0; t < tasks.size();) {
      t += take(tasks.subspan(t), samples);
      pass_.set(piece_, samples_, radius, measure);
      submission_.run([&](VkCommandBuffer commands) { pass_.record(commands); });
      const std::vector<TemplateMatch> found = pass_.matches();
      matches.insert(matches.end(), found.begin(), found.end());
    }
    return matches;
  }

 private:
  // Copies the first tasks with their samples, as many as fit; returns their number.
  std::size_t take(std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples) {
    piece_.clear();
    samples_.clear();
    for (TemplateTask task : tasks.first(std::min(tasks.size(), kPiece.tasks))) {
      if (samples_.size() + task.count > kPiece.samples) break;
      const auto own = samples.subspan(task.first, task.count);
      task.first = std::uint32_t(samples_.size());
      samples_.insert(samples_.end(), own.begin(), own.end());
      piece_.push_back(task);
    }
    return piece_.size();
  }

  std::shared_ptr<std::mutex> turn_;
  std::size_t pictures_;
  TemplateSearchPass pass_;
  Submission submission_;
  std::vector<TemplateTask> piece_;
  std::vector<TemplateSample> samples_;
};

}  // namespace

TemplateSearchFactory deviceTemplateSearch(const Device& device) {
  return [&device, turn = std::make_shared<std::mutex>()](std::span<const Image8* const> pictures) -> TemplateSearch {
    const auto search = std::make_shared<DeviceSearch>(device, pictures, turn);
    return [search](std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
                    TemplateMeasure measure) { return (*search)(tasks, samples, radius, measure); };
  };
}

}  // namespace ibr
