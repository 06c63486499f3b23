// SPDX-License-Identifier: Apache-2.0
// Headers shared by GLSL and C++: struct offsets in the SPIR-V equal those of the C++ struct.
#include <catch2/catch.hpp>
#include <cstddef>

#include "reference/shader_offsets.h"
#include "shaders/cell_frag.h"
#include "shaders/cell_vert.h"
#include "shaders/colour_tables_comp.h"
#include "shaders/gather_frag.h"
#include "shared/cell.h"
#include "shared/colour_map.h"
#include "shared/gather.h"

using ibr::shader::CellExposure;
using ibr::shader::CellMember;
using ibr::shader::CellParameters;
using ibr::shader::MemberExposure;
using ibr::test::offsetsOf;

TEST_CASE("cell parameters have the memory layout of the shader") {
  const auto member = offsetsOf(ibr::shaders::cell_vert, "CellMember");
  CHECK(member == std::map<std::string, std::uint32_t>{{"toView", offsetof(CellMember, toView)},
                                                       {"focal", offsetof(CellMember, focal)},
                                                       {"principal", offsetof(CellMember, principal)},
                                                       {"position", offsetof(CellMember, position)},
                                                       {"blend", offsetof(CellMember, blend)},
                                                       {"layer", offsetof(CellMember, layer)}});
  const auto exposure = offsetsOf(ibr::shaders::cell_frag, "MemberExposure");
  CHECK(exposure == std::map<std::string, std::uint32_t>{{"gain", offsetof(MemberExposure, gain)},
                                                         {"slope", offsetof(MemberExposure, slope)}});
  CHECK(sizeof(CellExposure) == 4 * sizeof(MemberExposure));
  CHECK(sizeof(MemberExposure) == 24);
  const auto cell = offsetsOf(ibr::shaders::cell_vert, "CellParameters");
  CHECK(cell == std::map<std::string, std::uint32_t>{{"member", offsetof(CellParameters, member)},
                                                     {"shift", offsetof(CellParameters, shift)},
                                                     {"nearDistance", offsetof(CellParameters, nearDistance)},
                                                     {"projection", offsetof(CellParameters, projection)},
                                                     {"unitRays", offsetof(CellParameters, unitRays)},
                                                     {"detail", offsetof(CellParameters, detail)},
                                                     {"table", offsetof(CellParameters, table)},
                                                     {"opacity", offsetof(CellParameters, opacity)},
                                                     {"noise", offsetof(CellParameters, noise)}});
  CHECK(sizeof(CellParameters) == 4 * sizeof(CellMember) + 56);
}

TEST_CASE("structures of the colour passes have the memory layout of their shaders") {
  using ibr::shader::ColourFrame;
  using ibr::shader::ColourSlot;
  const auto frame = offsetsOf(ibr::shaders::colour_tables_comp, "ColourFrame");
  CHECK(frame == std::map<std::string, std::uint32_t>{{"count", offsetof(ColourFrame, count)},
                                                      {"joint", offsetof(ColourFrame, joint)},
                                                      {"method", offsetof(ColourFrame, method)},
                                                      {"least", offsetof(ColourFrame, least)},
                                                      {"kept", offsetof(ColourFrame, kept)},
                                                      {"measured", offsetof(ColourFrame, measured)},
                                                      {"mainShare", offsetof(ColourFrame, mainShare)},
                                                      {"share", offsetof(ColourFrame, share)},
                                                      {"maxStep", offsetof(ColourFrame, maxStep)},
                                                      {"tileColumns", offsetof(ColourFrame, tileColumns)},
                                                      {"tileWidth", offsetof(ColourFrame, tileWidth)},
                                                      {"tileHeight", offsetof(ColourFrame, tileHeight)},
                                                      {"slot", offsetof(ColourFrame, slot)},
                                                      {"owner", offsetof(ColourFrame, owner)},
                                                      {"fresh", offsetof(ColourFrame, fresh)}});
  const auto slot = offsetsOf(ibr::shaders::colour_tables_comp, "ColourSlot");
  CHECK(slot == std::map<std::string, std::uint32_t>{{"owner", offsetof(ColourSlot, owner)},
                                                     {"shown", offsetof(ColourSlot, shown)},
                                                     {"target", offsetof(ColourSlot, target)}});
}

TEST_CASE("candidates of the gather have the memory layout of its shaders") {
  using ibr::shader::GatherCandidate;
  using ibr::shader::GatherConstants;
  using ibr::shader::GatherView;
  const std::map<std::string, std::uint32_t> candidate{{"toView", offsetof(GatherCandidate, toView)},
                                                       {"place", offsetof(GatherCandidate, place)},
                                                       {"toPhotograph", offsetof(GatherCandidate, toPhotograph)},
                                                       {"shift", offsetof(GatherCandidate, shift)},
                                                       {"focal", offsetof(GatherCandidate, focal)},
                                                       {"principal", offsetof(GatherCandidate, principal)},
                                                       {"aspect", offsetof(GatherCandidate, aspect)},
                                                       {"focalPx", offsetof(GatherCandidate, focalPx)},
                                                       {"weight", offsetof(GatherCandidate, weight)},
                                                       {"voteWeight", offsetof(GatherCandidate, voteWeight)},
                                                       {"distanceCost", offsetof(GatherCandidate, distanceCost)},
                                                       {"step", offsetof(GatherCandidate, step)},
                                                       {"residual", offsetof(GatherCandidate, residual)},
                                                       {"depthScale", offsetof(GatherCandidate, depthScale)},
                                                       {"slot", offsetof(GatherCandidate, slot)},
                                                       {"layer", offsetof(GatherCandidate, layer)},
                                                       {"depthSlot", offsetof(GatherCandidate, depthSlot)},
                                                       {"depthLayer", offsetof(GatherCandidate, depthLayer)},
                                                       {"panorama", offsetof(GatherCandidate, panorama)},
                                                       {"gain", offsetof(GatherCandidate, gain)},
                                                       {"slope", offsetof(GatherCandidate, slope)}};
  CHECK(offsetsOf(ibr::shaders::gather_frag, "GatherCandidate") == candidate);
  const std::map<std::string, std::uint32_t> view{
      {"candidate", offsetof(GatherView, candidate)}, {"projection", offsetof(GatherView, projection)},
      {"toRay", offsetof(GatherView, toRay)},         {"spacing", offsetof(GatherView, spacing)},
      {"step", offsetof(GatherView, step)},           {"focalPx", offsetof(GatherView, focalPx)},
      {"detail", offsetof(GatherView, detail)},       {"nearDistance", offsetof(GatherView, nearDistance)},
      {"count", offsetof(GatherView, count)},         {"maxTier", offsetof(GatherView, maxTier)}};
  CHECK(offsetsOf(ibr::shaders::gather_frag, "GatherView") == view);
  const std::map<std::string, std::uint32_t> constants{{"extent", offsetof(GatherConstants, extent)},
                                                       {"voteExtent", offsetof(GatherConstants, voteExtent)},
                                                       {"tile", offsetof(GatherConstants, tile)},
                                                       {"view", offsetof(GatherConstants, view)},
                                                       {"depthFirst", offsetof(GatherConstants, depthFirst)},
                                                       {"depthSpan", offsetof(GatherConstants, depthSpan)}};
  CHECK(offsetsOf(ibr::shaders::gather_frag, "GatherConstants") == constants);
  CHECK(sizeof(GatherView) == ibr::shader::kMaxGathered * sizeof(GatherCandidate) + offsetof(GatherView, maxTier) + 4 -
                                  offsetof(GatherView, projection));
}
