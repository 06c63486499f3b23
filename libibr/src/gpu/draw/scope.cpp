// SPDX-License-Identifier: Apache-2.0
#include "gpu/draw/scope.h"

#include <cassert>

#include "gpu/device/debug.h"

namespace ibr {
namespace {

std::uint32_t timestampBits(const Device& device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device.physicalDevice(), &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device.physicalDevice(), &count, families.data());
  return families.at(device.queueFamily()).timestampValidBits;
}

template <class Function>
Function load(const Device& device, const char* name) {
  return reinterpret_cast<Function>(vkGetInstanceProcAddr(device.instance(), name));
}

}  // namespace

ScopeTimer::ScopeTimer(const Device& device, std::uint32_t maxScopes)
    : device_(&device),
      beginLabel_(load<PFN_vkCmdBeginDebugUtilsLabelEXT>(device, "vkCmdBeginDebugUtilsLabelEXT")),
      endLabel_(load<PFN_vkCmdEndDebugUtilsLabelEXT>(device, "vkCmdEndDebugUtilsLabelEXT")),
      millisecondsPerTick_(double(device.properties().limits.timestampPeriod) * 1e-6) {
  const std::uint32_t bits = timestampBits(device);
  if (bits == 0 || maxScopes == 0) return;
  tickMask_ = bits >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << bits) - 1;
  const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                   .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                   .queryCount = 2 * maxScopes};
  queries_ = make<QueryPoolHandle>(device, vkCreateQueryPool, info, "vkCreateQueryPool");
  nameObject(device, VK_OBJECT_TYPE_QUERY_POOL, queries_.get(), "scope timer");
  maxScopes_ = maxScopes;
  scopes_.reserve(maxScopes);
  open_.reserve(maxScopes);
}

void ScopeTimer::reset(VkCommandBuffer commands) noexcept {
  assert(open_.empty() && untimed_ == 0);
  scopes_.clear();
  if (maxScopes_ > 0) vkCmdResetQueryPool(commands, queries_.get(), 0, 2 * maxScopes_);
}

void ScopeTimer::begin(VkCommandBuffer commands, const char* name) noexcept {
  if (beginLabel_) {
    const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, .pLabelName = name};
    beginLabel_(commands, &label);
  }
  const auto index = std::uint32_t(scopes_.size());
  if (index == maxScopes_) {
    ++untimed_;
    return;
  }
  scopes_.push_back({name, int(open_.size())});
  open_.push_back(index);
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_.get(), 2 * index);
}

void ScopeTimer::end(VkCommandBuffer commands) noexcept {
  if (endLabel_) endLabel_(commands);
  // Once there is no room, no scope is timed any more: those without a time are the innermost.
  if (untimed_ > 0) {
    --untimed_;
    return;
  }
  assert(!open_.empty());
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_.get(), 2 * open_.back() + 1);
  open_.pop_back();
}

std::vector<ScopeTime> ScopeTimer::read() const {
  struct Query {
    std::uint64_t ticks, available;
  };
  std::vector<Query> queries(2 * scopes_.size());
  if (queries.empty()) return {};
  const VkResult result = vkGetQueryPoolResults(device_->handle(), queries_.get(), 0, std::uint32_t(queries.size()),
                                                queries.size() * sizeof(Query), queries.data(), sizeof(Query),
                                                VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
  if (result != VK_NOT_READY) vk(*device_, result, "vkGetQueryPoolResults");

  std::vector<ScopeTime> times;
  for (std::size_t i = 0; i < scopes_.size(); ++i) {
    const Query &first = queries[2 * i], &last = queries[2 * i + 1];
    if (!first.available || !last.available) continue;
    times.push_back(
        {scopes_[i].name, scopes_[i].depth, double((last.ticks - first.ticks) & tickMask_) * millisecondsPerTick_});
  }
  return times;
}

}  // namespace ibr
