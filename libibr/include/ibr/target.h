// SPDX-License-Identifier: Apache-2.0
// The caller's image, and how images are used between commands. Nothing here owns anything.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <limits>
#include <optional>

namespace ibr {

/// Layout, stages and accesses of one use of an image. A barrier goes from one use to the next; nothing is tracked.
struct ImageUse {
  VkImageLayout layout;
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
};

namespace use {
inline constexpr ImageUse kUndefined{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE};
inline constexpr ImageUse kColourAttachment{
    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
    VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse kDepthAttachment{
    VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse kSampled{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
inline constexpr ImageUse kTransferSource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                                          VK_ACCESS_2_TRANSFER_READ_BIT};
inline constexpr ImageUse kTransferDestination{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                                               VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr ImageUse kStorage{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
inline constexpr ImageUse kPresent{VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE};
}  // namespace use

/// Where a renderer puts the scene's real depth, so that the caller's polygons can be tested against it. What is near
/// is exact to about a part in 10⁴ (the canvas shares its depth among all that is drawn); what has no metric depth (ρ =
/// 0) and what is empty lies at the far end. Written for DrawOrder::ours; the paper's order has no depth: all is far.
struct DepthTarget {
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;       // 2D, one level, one layer, depth attachment usage
  VkFormat format = VK_FORMAT_D32_SFLOAT;  // or D16_UNORM
  ImageUse before = use::kUndefined;       // its contents are replaced
  ImageUse after = use::kDepthAttachment;
  double nearPlane = 0.1;  // of the caller's projection, distances along the viewing axis, world units, 0 < near < far
  double farPlane = std::numeric_limits<double>::infinity();
  bool reversed = false;    // near → 1, far → 0
  std::uint32_t layer = 0;  // of the image, that the view shows: no other is touched
};

/// Where a renderer puts its picture. The image must outlive the commands recorded with it; nothing is kept after
/// `record` returns. UNORM formats receive display-encoded values, SRGB formats the same picture through their encoder.
struct Target {
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;  // 2D, one mip level, one layer, identity swizzle, colour attachment usage
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkExtent2D extent{0, 0};
  ImageUse before = use::kUndefined;  // how the caller used it last; its contents are replaced
  ImageUse after = use::kColourAttachment;
  std::optional<DepthTarget> depth;  // of the same extent
  std::uint32_t layer = 0;           // of the image, that the view shows: no other is touched
};

/// An image for floats. It must outlive the commands recorded with it.
struct BufferTarget {
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;  // 2D, one level, one layer, colour attachment usage
  ImageUse before = use::kUndefined;  // its contents are replaced
  ImageUse after = use::kColourAttachment;
  std::uint32_t layer = 0;  // of the image, that the view shows: no other is touched
};

inline constexpr VkFormat kSurfaceFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
inline constexpr VkFormat kWeightsFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
inline constexpr VkFormat kConfidenceFormat = VK_FORMAT_R32G32_SFLOAT;

/// Where a renderer puts what it knows of every pixel beside its colour, of the plan's current order: a former one that
/// is mixed in is left out. Values where nothing is drawn stand in brackets.
struct BufferTargets {
  VkExtent2D extent{0, 0};
  /// kSurfaceFormat: depth along the view's -z in world units, infinity where it is unknown (ρ = 0) [infinity]; tier
  /// [3 where the plan asks to fill, else −1]; rank of the cell in the plan (of one that
  /// leaves: its former place), −1 where a pixel is gathered [−1];
  /// the cell's extrapolation distance, world units [0].
  BufferTarget surface;
  /// kWeightsFormat: of the members' colours, in the order of the cell's; they sum to 1 [0].
  BufferTarget weights;
  /// kConfidenceFormat: spread of the members' colours, their standard deviation under the weights, root mean square
  /// over R, G, B as displayed, 0 to 1, before colour mapping [0]; uncertainty of ρ, one standard deviation, 1 / world
  /// unit: the mesh's; where a pixel is gathered, of the vote (gatherSigma in shaders/shared/gather.h) [infinity].
  BufferTarget confidence;
};

}  // namespace ibr
