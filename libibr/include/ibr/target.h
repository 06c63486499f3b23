// SPDX-License-Identifier: Apache-2.0
// The caller's images, and their uses before and after recorded commands. Nothing here owns a handle.
#pragma once

#include <vulkan/vulkan_core.h>

#include <compare>
#include <cstdint>
#include <limits>
#include <optional>

namespace ibr {

/// Layout, stages and accesses of one use of an image. A barrier goes from one use to the next; nothing is tracked.
struct ImageUse {
  VkImageLayout layout;          // layout of the image during the use
  VkPipelineStageFlags2 stages;  // stages that access the image
  VkAccessFlags2 access;         // kinds of access
};

/// Common uses of images.
namespace use {
/// No contents: a barrier from this use discards them.
inline constexpr ImageUse kUndefined{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE};
/// Read and written as a colour attachment.
inline constexpr ImageUse kColourAttachment{
    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
    VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
/// Read and written as a depth attachment.
inline constexpr ImageUse kDepthAttachment{
    VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
/// Sampled by fragment shaders.
inline constexpr ImageUse kSampled{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
/// Read by transfer commands.
inline constexpr ImageUse kTransferSource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                                          VK_ACCESS_2_TRANSFER_READ_BIT};
/// Written by transfer commands.
inline constexpr ImageUse kTransferDestination{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                                               VK_ACCESS_2_TRANSFER_WRITE_BIT};
/// Read and written as a storage image by compute shaders.
inline constexpr ImageUse kStorage{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
/// Presented by the presentation engine.
inline constexpr ImageUse kPresent{VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE};
}  // namespace use

/// Depth image for the scene's depth, so that the caller's polygons can be tested against it. Near surfaces are exact
/// to about one part in 10⁴. Pixels without metric depth (ρ = 0) and empty pixels are at the far plane. Needs
/// DrawOrder::ours: with the paper's order all pixels are far.
struct DepthTarget {
  VkImage image = VK_NULL_HANDLE;             // image of `view`
  VkImageView view = VK_NULL_HANDLE;          // 2D, one level, one layer, depth attachment usage
  VkFormat format = VK_FORMAT_D32_SFLOAT;     // format of the image: D32_SFLOAT or D16_UNORM
  ImageUse initialUse = use::kUndefined;      // the caller's last use; contents are replaced
  ImageUse finalUse = use::kDepthAttachment;  // the caller's next use
  double nearPlane = 0.1;  // near plane of the caller's projection: distance along the viewing axis, world units, > 0
  double farPlane = std::numeric_limits<double>::infinity();  // far plane, in the same way; > nearPlane
  bool reversed = false;    // depth is 1 at nearPlane and 0 at farPlane; false: 0 and 1
  std::uint32_t layer = 0;  // layer of the image; other layers are untouched
};

/// Encoding of the colours that a target stores. Alpha is never encoded.
enum class Encoding : std::uint8_t {
  display,  // sRGB-encoded (IEC 61966-2-1)
  linear,   // linear light with sRGB's primaries, 1 = display white
};

/// Format and encoding of a colour target. Supported combinations:
///
///   VK_FORMAT_                        encoding           alpha
///   R8G8B8A8_UNORM, B8G8R8A8_UNORM    display            8 bits
///   R8G8B8A8_SRGB, B8G8R8A8_SRGB      display            8 bits
///   A2B10G10R10_UNORM_PACK32          display, linear    2 bits
///   R16G16B16A16_SFLOAT               display, linear    half float
///
/// SRGB formats store display-encoded values, through their encoder. Working images have 8 bits a channel; only
/// cross-fades, other render scales, filled pixels and the floor give finer values. Values are rounded, not dithered.
/// In 10 bits, the smallest linear value above black is 3.2 display-encoded 8-bit levels. In 2 bits, AlphaContent::tier
/// is 1 for tier 0, 1/3 for tiers 2 and 3, and 0 where nothing is drawn. A background outside 0 to 1 is clamped, except
/// in R16G16B16A16_SFLOAT.
struct TargetFormat {
  VkFormat format;    // format of the image
  Encoding encoding;  // encoding of the colours

  /// Makes a format; display-encoded by default.
  constexpr TargetFormat(VkFormat f, Encoding e = Encoding::display) : format(f), encoding(e) {}  // NOLINT: implicit
  auto operator<=>(const TargetFormat&) const = default;
};

/// Colour image for a renderer's picture. The image must outlive the commands recorded with it; nothing is kept after
/// `record` returns.
struct Target {
  VkImage image = VK_NULL_HANDLE;         // image of `view`
  VkImageView view = VK_NULL_HANDLE;      // 2D, one mip level, one layer, identity swizzle, colour attachment usage
  VkFormat format = VK_FORMAT_UNDEFINED;  // format of the image
  Encoding encoding = Encoding::display;  // with the format: a combination of TargetFormat
  VkExtent2D extent{0, 0};                // size of the image, px
  ImageUse initialUse = use::kUndefined;  // the caller's last use; contents are replaced
  ImageUse finalUse = use::kColourAttachment;  // the caller's next use
  std::optional<DepthTarget> depth;            // depth image of the same extent; nullopt: none
  std::uint32_t layer = 0;                     // layer of the image; other layers are untouched
};

/// Floating-point image. It must outlive the commands recorded with it.
struct BufferTarget {
  VkImage image = VK_NULL_HANDLE;              // image of `view`
  VkImageView view = VK_NULL_HANDLE;           // 2D, one level, one layer, colour attachment usage
  ImageUse initialUse = use::kUndefined;       // the caller's last use; contents are replaced
  ImageUse finalUse = use::kColourAttachment;  // the caller's next use
  std::uint32_t layer = 0;                     // layer of the image; other layers are untouched
};

inline constexpr VkFormat kSurfaceFormat = VK_FORMAT_R32G32B32A32_SFLOAT;  // format of BufferTargets::surface
inline constexpr VkFormat kWeightsFormat = VK_FORMAT_R32G32B32A32_SFLOAT;  // format of BufferTargets::weights
inline constexpr VkFormat kConfidenceFormat = VK_FORMAT_R32G32_SFLOAT;     // format of BufferTargets::confidence

/// Per-pixel data of a plan's current draw order; a previous order that is cross-faded is left out. Values in brackets:
/// where nothing is drawn.
struct BufferTargets {
  VkExtent2D extent{0, 0};  // size of all three images, px
  /// kSurfaceFormat. R: depth along the view's −z, world units; infinity where ρ = 0 [infinity]. G: tier [3 where the
  /// plan fills holes, else −1]. B: rank of the cell in the plan, of a cell that fades out its previous one; −1 where
  /// the pixel is gathered [−1]. A: the cell's extrapolation distance, world units [0].
  BufferTarget surface;
  /// kWeightsFormat: weights of the members' colours, in the order of Cell::members; they sum to 1 [0].
  BufferTarget weights;
  /// kConfidenceFormat. R: weighted standard deviation of the members' colours, root mean square over the
  /// display-encoded channels, 0 to 1, before colour mapping [0]. G: σ of ρ, 1 / world unit: of the mesh, or of the
  /// vote where the pixel is gathered (gatherSigma in shaders/shared/gather.h) [infinity].
  BufferTarget confidence;
};

}  // namespace ibr
