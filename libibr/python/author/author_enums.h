// SPDX-License-Identifier: Apache-2.0
// Enumerations of the author, which ibr.author._author defines.
#pragma once

#include "ibr/author/build.h"
#include "ibr/author/htm.h"
#include "ibr/author/panorama.h"
#include "support/runtime_enums.h"

namespace ibr::python {

struct AuthorEnum {
  static constexpr const char* module = "ibr.author._author";
};

template <>
struct EnumTraits<TrackSource> : AuthorEnum {
  static constexpr auto label = pybind11::detail::const_name("TrackSource");
  static constexpr EnumMember members[] = {
      {"AUTOMATIC", int(TrackSource::automatic)}, {"MODEL", int(TrackSource::model)}, {"OWN", int(TrackSource::own)}};
};

template <>
struct EnumTraits<RefinePoses> : AuthorEnum {
  static constexpr auto label = pybind11::detail::const_name("RefinePoses");
  static constexpr EnumMember members[] = {
      {"AUTOMATIC", int(RefinePoses::automatic)}, {"ON", int(RefinePoses::on)}, {"OFF", int(RefinePoses::off)}};
};

template <>
struct EnumTraits<MatchMethod> : AuthorEnum {
  static constexpr auto label = pybind11::detail::const_name("MatchMethod");
  static constexpr EnumMember members[] = {{"AUTOMATIC", int(MatchMethod::automatic)},
                                           {"SWEEP", int(MatchMethod::sweep)},
                                           {"HOMOGRAPHIC", int(MatchMethod::homographic)},
                                           {"FLOW", int(MatchMethod::flow)}};
};

template <>
struct EnumTraits<DepthSearch> : AuthorEnum {
  static constexpr auto label = pybind11::detail::const_name("DepthSearch");
  static constexpr EnumMember members[] = {{"FAST", int(DepthSearch::fast)},
                                           {"SWEPT", int(DepthSearch::swept)},
                                           {"REFINED", int(DepthSearch::refined)},
                                           {"FINE", int(DepthSearch::fine)}};
};

template <>
struct EnumTraits<TriangleFilter> : AuthorEnum {
  static constexpr auto label = pybind11::detail::const_name("TriangleFilter");
  static constexpr EnumMember members[] = {{"CONSISTENCY", int(TriangleFilter::consistency)},
                                           {"HOMOGENEOUS", int(TriangleFilter::homogeneous)}};
};

template <>
struct EnumTraits<Orientation> : AuthorEnum {
  static constexpr auto label = pybind11::detail::const_name("Orientation");
  static constexpr EnumMember members[] = {{"AUTOMATIC", int(Orientation::automatic)},
                                           {"STORED", int(Orientation::stored)},
                                           {"EXIF", int(Orientation::exif)}};
};

template <>
struct EnumTraits<ImageFileFormat> : AuthorEnum {
  static constexpr auto label = pybind11::detail::const_name("ImageFileFormat");
  static constexpr EnumMember members[] = {{"AS_SOURCE", int(ImageFileFormat::asSource)},
                                           {"JPEG", int(ImageFileFormat::jpeg)},
                                           {"PNG", int(ImageFileFormat::png)}};
};

template <>
struct EnumTraits<TemplateMeasure> : AuthorEnum {
  static constexpr auto label = pybind11::detail::const_name("TemplateMeasure");
  static constexpr EnumMember members[] = {{"ABSOLUTE_DIFFERENCES", int(TemplateMeasure::absoluteDifferences)},
                                           {"CORRELATION", int(TemplateMeasure::correlation)}};
};

}  // namespace ibr::python
