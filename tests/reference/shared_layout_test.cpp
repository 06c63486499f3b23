// SPDX-License-Identifier: Apache-2.0
// One header for GLSL and C++: the offsets that the compiler wrote into the SPIR-V are those of the C++ struct.
#include <catch2/catch.hpp>
#include <cstddef>

#include "reference/shader_offsets.h"
#include "shaders/cell_frag.h"
#include "shaders/cell_vert.h"
#include "shaders/colour_tables_comp.h"
#include "shared/cell.h"
#include "shared/colour_map.h"

using ibr::shader::CellExposure;
using ibr::shader::CellMember;
using ibr::shader::CellParameters;
using ibr::shader::MemberExposure;
using ibr::test::offsetsOf;

TEST_CASE("cell parameters lie in memory as the shader reads them") {
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
                                                     {"alpha", offsetof(CellParameters, alpha)},
                                                     {"table", offsetof(CellParameters, table)},
                                                     {"opacity", offsetof(CellParameters, opacity)},
                                                     {"noise", offsetof(CellParameters, noise)}});
  CHECK(sizeof(CellParameters) == 4 * sizeof(CellMember) + 60);
}

TEST_CASE("what the colour passes share lies in memory as their shaders read it") {
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
                                                      {"largestStep", offsetof(ColourFrame, largestStep)},
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
