// SPDX-License-Identifier: Apache-2.0
// Enumerations of the runtime, which ibr._runtime defines.
#pragma once

#include "ibr/ibr.h"
#include "support/enums.h"

namespace ibr::python {

struct RuntimeEnum {
  static constexpr const char* module = "ibr._runtime";
};

template <>
struct EnumTraits<ErrorCode> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("ErrorCode");
  static constexpr EnumMember members[] = {
      {"INVALID_INPUT", int(ErrorCode::invalidInput)}, {"IO", int(ErrorCode::io)},
      {"UNSUPPORTED", int(ErrorCode::unsupported)},    {"OUT_OF_MEMORY", int(ErrorCode::outOfMemory)},
      {"DEVICE_LOST", int(ErrorCode::deviceLost)},     {"VULKAN", int(ErrorCode::vulkan)},
      {"CANCELLED", int(ErrorCode::cancelled)}};
};

template <>
struct EnumTraits<DeviceKind> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("DeviceKind");
  static constexpr EnumMember members[] = {{"SOFTWARE", int(DeviceKind::software)},
                                           {"HARDWARE", int(DeviceKind::hardware)}};
};

template <>
struct EnumTraits<AssetKind> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("AssetKind");
  static constexpr EnumMember members[] = {{"SCENE", int(AssetKind::scene)},
                                           {"HTM_MODEL", int(AssetKind::htmModel)},
                                           {"HTM_SEQUENCE", int(AssetKind::htmSequence)}};
};

template <>
struct EnumTraits<CameraModel> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("CameraModel");
  static constexpr EnumMember members[] = {{"PINHOLE", int(CameraModel::pinhole)},
                                           {"EQUIRECTANGULAR", int(CameraModel::equirectangular)}};
};

template <>
struct EnumTraits<Composition> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("Composition");
  static constexpr EnumMember members[] = {{"CELLS", int(Composition::cells)},
                                           {"GATHERED", int(Composition::gathered)},
                                           {"HYBRID", int(Composition::hybrid)}};
};

template <>
struct EnumTraits<BlendMode> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("BlendMode");
  static constexpr EnumMember members[] = {
      {"BLEND", int(BlendMode::blend)}, {"DITHER", int(BlendMode::dither)}, {"MIXED", int(BlendMode::mixed)}};
};

template <>
struct EnumTraits<Morph> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("Morph");
  static constexpr EnumMember members[] = {{"OURS", int(Morph::ours)}, {"PAPER", int(Morph::paper)}};
};

template <>
struct EnumTraits<DrawOrder> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("DrawOrder");
  static constexpr EnumMember members[] = {{"OURS", int(DrawOrder::ours)}, {"PAPER", int(DrawOrder::paper)}};
};

template <>
struct EnumTraits<ColourMapping> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("ColourMapping");
  static constexpr EnumMember members[] = {{"OFF", int(ColourMapping::off)},
                                           {"OURS", int(ColourMapping::ours)},
                                           {"PAPER", int(ColourMapping::paper)},
                                           {"PAPER_REDRAW", int(ColourMapping::paperRedraw)}};
};

template <>
struct EnumTraits<Exposure> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("Exposure");
  static constexpr EnumMember members[] = {
      {"OFF", int(Exposure::off)}, {"SCENE", int(Exposure::scene)}, {"ADAPTED", int(Exposure::adapted)}};
};

template <>
struct EnumTraits<ColourTable> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("ColourTable");
  static constexpr EnumMember members[] = {{"NAIVE", int(ColourTable::naive)},
                                           {"STRICT", int(ColourTable::strict)},
                                           {"PRESERVING", int(ColourTable::preserving)}};
};

template <>
struct EnumTraits<AlphaContent> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("AlphaContent");
  static constexpr EnumMember members[] = {{"OPAQUE", int(AlphaContent::opaque)}, {"TIER", int(AlphaContent::tier)}};
};

template <>
struct EnumTraits<Overlay> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("Overlay");
  static constexpr EnumMember members[] = {
      {"NONE", int(Overlay::none)},       {"WIREFRAME", int(Overlay::wireframe)},   {"TIERS", int(Overlay::tiers)},
      {"WEIGHTS", int(Overlay::weights)}, {"CONFIDENCE", int(Overlay::confidence)}, {"DEPTH", int(Overlay::depth)},
      {"OVERLAP", int(Overlay::overlap)}, {"AGREEMENT", int(Overlay::agreement)}};
};

template <>
struct EnumTraits<Preset> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("Preset");
  static constexpr EnumMember members[] = {{"FAST", int(Preset::fast)},
                                           {"BALANCED", int(Preset::balanced)},
                                           {"ACCURATE", int(Preset::accurate)},
                                           {"REFERENCE", int(Preset::reference)}};
};

template <>
struct EnumTraits<TextureFilter> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("TextureFilter");
  static constexpr EnumMember members[] = {{"AUTOMATIC", int(TextureFilter::automatic)},
                                           {"BILINEAR", int(TextureFilter::bilinear)},
                                           {"TRILINEAR", int(TextureFilter::trilinear)},
                                           {"BICUBIC", int(TextureFilter::bicubic)}};
};

template <>
struct EnumTraits<BlockTextureMode> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("BlockTextureMode");
  static constexpr EnumMember members[] = {{"AUTOMATIC", int(BlockTextureMode::automatic)},
                                           {"KEEP", int(BlockTextureMode::keep)},
                                           {"DECODE", int(BlockTextureMode::decode)}};
};

template <>
struct EnumTraits<TextureFormat> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("TextureFormat");
  static constexpr EnumMember members[] = {
      {"RGBA8", int(TextureFormat::rgba8)}, {"BC1", int(TextureFormat::bc1)}, {"BC7", int(TextureFormat::bc7)}};
};

template <>
struct EnumTraits<HtmMethod> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("HtmMethod");
  static constexpr EnumMember members[] = {{"HARMONISED", int(HtmMethod::harmonised)},
                                           {"BLENDED", int(HtmMethod::blended)},
                                           {"VERTEX_COLOURS", int(HtmMethod::vertexColours)}};
};

template <>
struct EnumTraits<HtmDirection> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("HtmDirection");
  static constexpr EnumMember members[] = {{"MIDDLE", int(HtmDirection::middle)}, {"AXIS", int(HtmDirection::axis)}};
};

template <>
struct EnumTraits<AlignmentMethod> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("AlignmentMethod");
  static constexpr EnumMember members[] = {{"RASTER", int(AlignmentMethod::raster)},
                                           {"COMPUTE", int(AlignmentMethod::compute)},
                                           {"CPU", int(AlignmentMethod::cpu)},
                                           {"GRADIENT", int(AlignmentMethod::gradient)}};
};

template <>
struct EnumTraits<EccDefinition> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("EccDefinition");
  static constexpr EnumMember members[] = {{"CHANNELS", int(EccDefinition::channels)},
                                           {"CONCATENATED", int(EccDefinition::concatenated)}};
};

template <>
struct EnumTraits<AdviceKind> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("AdviceKind");
  static constexpr EnumMember members[] = {{"TOO_FEW", int(AdviceKind::tooFew)},
                                           {"TURNED", int(AdviceKind::turned)},
                                           {"APART", int(AdviceKind::apart)},
                                           {"HOLE", int(AdviceKind::hole)},
                                           {"WIDE", int(AdviceKind::wide)},
                                           {"DIRECTION", int(AdviceKind::direction)},
                                           {"EXPOSURE", int(AdviceKind::exposure)},
                                           {"BLURRED", int(AdviceKind::blurred)},
                                           {"UNMATCHED", int(AdviceKind::unmatched)},
                                           {"POSE", int(AdviceKind::pose)},
                                           {"UNUSED", int(AdviceKind::unused)},
                                           {"TWICE", int(AdviceKind::twice)},
                                           {"ROW", int(AdviceKind::row)}};
};

template <>
struct EnumTraits<Severity> : RuntimeEnum {
  static constexpr auto label = pybind11::detail::const_name("Severity");
  static constexpr EnumMember members[] = {
      {"HINT", int(Severity::hint)}, {"WARNING", int(Severity::warning)}, {"SERIOUS", int(Severity::serious)}};
};

}  // namespace ibr::python
