// SPDX-License-Identifier: Apache-2.0
#include "ibr/scope_timer.h"

#include <cassert>

#include "base/vulkan/debug.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/handle.h"

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

struct ScopeTimer::State {
  struct Scope {
    const char* name;
    int depth;
  };

  State(const Device& on, std::uint32_t maxScopes);

  const Device* device;
  PFN_vkCmdBeginDebugUtilsLabelEXT beginLabel;
  PFN_vkCmdEndDebugUtilsLabelEXT endLabel;
  double millisecondsPerTick;
  std::uint64_t tickMask = 0;
  QueryPoolHandle queries;  // scope i begins at query 2i and ends at 2i + 1
  std::uint32_t maxScopes = 0;
  std::vector<Scope> scopes;        // reserved for maxScopes: recording does not allocate
  std::vector<std::uint32_t> open;  // indices into scopes, outermost first
  std::uint32_t untimed = 0;        // open scopes without a query
};

ScopeTimer::State::State(const Device& on, std::uint32_t wanted)
    : device(&on),
      beginLabel(load<PFN_vkCmdBeginDebugUtilsLabelEXT>(on, "vkCmdBeginDebugUtilsLabelEXT")),
      endLabel(load<PFN_vkCmdEndDebugUtilsLabelEXT>(on, "vkCmdEndDebugUtilsLabelEXT")),
      millisecondsPerTick(double(on.properties().limits.timestampPeriod) * 1e-6) {
  const std::uint32_t bits = timestampBits(on);
  if (bits == 0 || wanted == 0) return;
  tickMask = bits >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << bits) - 1;
  const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                   .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                   .queryCount = 2 * wanted};
  queries = make<QueryPoolHandle>(on, vkCreateQueryPool, info, "vkCreateQueryPool");
  nameObject(on, VK_OBJECT_TYPE_QUERY_POOL, queries.get(), "scope timer");
  maxScopes = wanted;
  scopes.reserve(wanted);
  open.reserve(wanted);
}

ScopeTimer::ScopeTimer(const Device& device, std::uint32_t maxScopes)
    : state_(std::make_unique<State>(device, maxScopes)) {}
ScopeTimer::ScopeTimer(ScopeTimer&&) noexcept = default;
ScopeTimer& ScopeTimer::operator=(ScopeTimer&&) noexcept = default;
ScopeTimer::~ScopeTimer() = default;

void ScopeTimer::reset(VkCommandBuffer commands) noexcept {
  State& s = *state_;
  assert(s.open.empty() && s.untimed == 0);
  s.scopes.clear();
  if (s.maxScopes > 0) vkCmdResetQueryPool(commands, s.queries.get(), 0, 2 * s.maxScopes);
}

void ScopeTimer::begin(VkCommandBuffer commands, const char* name) noexcept {
  State& s = *state_;
  if (s.beginLabel) {
    const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, .pLabelName = name};
    s.beginLabel(commands, &label);
  }
  const auto index = std::uint32_t(s.scopes.size());
  if (index == s.maxScopes) {
    ++s.untimed;
    return;
  }
  s.scopes.push_back({name, int(s.open.size())});
  s.open.push_back(index);
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, s.queries.get(), 2 * index);
}

void ScopeTimer::end(VkCommandBuffer commands) noexcept {
  State& s = *state_;
  if (s.endLabel) s.endLabel(commands);
  // Once the pool is full, no further scope is timed: untimed scopes are the innermost.
  if (s.untimed > 0) {
    --s.untimed;
    return;
  }
  assert(!s.open.empty());
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, s.queries.get(), 2 * s.open.back() + 1);
  s.open.pop_back();
}

std::vector<ScopeTime> ScopeTimer::read() const {
  const State& s = *state_;
  struct Query {
    std::uint64_t ticks, available;
  };
  std::vector<Query> queries(2 * s.scopes.size());
  if (queries.empty()) return {};
  const VkResult result = vkGetQueryPoolResults(s.device->handle(), s.queries.get(), 0, std::uint32_t(queries.size()),
                                                queries.size() * sizeof(Query), queries.data(), sizeof(Query),
                                                VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
  if (result != VK_NOT_READY) vk(*s.device, result, "vkGetQueryPoolResults");

  std::vector<ScopeTime> times;
  for (std::size_t i = 0; i < s.scopes.size(); ++i) {
    const Query &first = queries[2 * i], &last = queries[2 * i + 1];
    if (!first.available || !last.available) continue;
    times.push_back(
        {s.scopes[i].name, s.scopes[i].depth, double((last.ticks - first.ticks) & s.tickMask) * s.millisecondsPerTick});
  }
  return times;
}

}  // namespace ibr
