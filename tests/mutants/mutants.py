# SPDX-License-Identifier: Apache-2.0
# The faults that a renderer like this one is known to get, planted one by one into a copy of the sources (NUMERICS §9).
# `name`: of the fault. `edits`: file, text, what stands in its place; the text must be there just once.
# `test`, `cases`: the program that ought to see it, and which of its cases (Catch2's words) to begin with.
from dataclasses import dataclass


@dataclass
class Mutant:
    name: str
    edits: list
    test: str
    cases: str = ""


MUTANTS = [
    Mutant("a barrier is missing between counting and copying",
           [("libibr/src/optimise/alignment_buffers.cpp",
             "  bufferBarrier(commands, use::kComputeReadWrite, use::kTransferRead);\n", "")],
           "ibr_test_optimise"),
    Mutant("a target is left in the wrong image layout",
           [("libibr/src/render/passes/composite_pass.cpp",
             "  transitionTarget(commandBuffer, target, use::kColourAttachment, target.after);",
             "  transitionTarget(commandBuffer, target, use::kColourAttachment, use::kSampled);")],
           "ibr_test_reference", "*eye*"),
    Mutant("an atomic counter is counted one too high",
           [("shaders/render/colour_count.comp", "+ c * uint(kLevels) + levels[c]], 1u);",
             "+ c * uint(kLevels) + levels[c] + 1u], 1u);")],
           "ibr_test_reference", "*count*,*histogram*"),
    Mutant("sums of 32 bits",
           [("libibr/src/optimise/row_sums.cpp", "sums.xx += dot(a, a), sums.yy",
             "sums.xx = std::int32_t(sums.xx + dot(a, a)), sums.yy")],
           "ibr_test_unit_optimise"),
    Mutant("products are shifted before they are added",
           [("libibr/src/optimise/row_sums.cpp", "  return std::int64_t(p.x) * q.x + std::int64_t(p.y) * q.y + "
             "std::int64_t(p.z) * q.z;",
             "  return (std::int64_t(p.x) * q.x >> 12 << 12) + (std::int64_t(p.y) * q.y >> 12 << 12) +\n"
             "         (std::int64_t(p.z) * q.z >> 12 << 12);")],
           "ibr_test_unit_optimise"),
    Mutant("weights are not made to sum to 1 again",
           [("libibr/src/render/plan/barycentric.cpp", "  for (double& w : result) w /= sum;\n", "  (void)sum;\n")],
           "ibr_test_unit_render", "*smoothstep*"),
    Mutant("the weights of two members are swapped",
           [("libibr/src/render/passes/cell_parameters.cpp", "member.blend = float(step.weights.blend[i]);",
             "member.blend = float(step.weights.blend[i < 2 ? 1 - i : i]);")],
           "ibr_test_reference", "*photograph*"),
    Mutant("smoothstep before weights are clamped",
           [("libibr/src/render/plan/frame_plan.cpp", "planned.view[v].blend = smoothstep(weights.clamped);",
             "planned.view[v].blend = smoothstep(weights.free);")],
           "ibr_test_unit_render", "*eyes*,*cells*,*extrapolat*"),
    Mutant("alpha is compared for equality",
           [("shaders/shared/colour_map.h", "  const uint code = uint(alpha * 255.0f + 0.5f);\n"
             "  if (code < 16u) return kPixelEmpty;\n"
             "  return ((code - 16u) / 32u & 1u) == 0u ? kPixelPending : kPixelFinal;",
             "  if (alpha == 0.0f) return kPixelEmpty;\n"
             "  return alpha == 1.0f - kPendingStep ? kPixelPending : kPixelFinal;")],
           "ibr_test_unit_render", "the state of a pixel*"),
    Mutant("sRGB is applied twice",
           [("shaders/render/composite.frag", "vec4(kEncodedByTarget ? decode(shown.rgb) : shown.rgb,",
             "vec4(shown.rgb,")],
           "ibr_test_reference", "every target format*"),
    Mutant("red and blue are swapped",
           [("libibr/src/gpu/draw/offscreen.cpp", "  if (blueFirst(state_->image.info().format))\n", "  if (false)\n"),
            ("libibr/src/gpu/draw/offscreen.cpp", "bool blueFirst(VkFormat format) {",
             "[[maybe_unused]] bool blueFirst(VkFormat format) {")],
           "ibr_test_gpu", "*offscreen*"),
    Mutant("half a pixel to the side",
           [("libibr/src/render/passes/cell_parameters.cpp",
             "member.principal = {float(k.cx / k.width), float(k.cy / k.height)};",
             "member.principal = {float((k.cx + 0.5) / k.width), float((k.cy + 0.5) / k.height)};")],
           "ibr_test_reference", "*photograph*"),
    Mutant("acos of floats near the pole",
           [("libibr/src/scene/camera.cpp", "(0.5 - std::atan2(d.y, std::hypot(d.x, d.z)) / kPi) * k.height);",
             "double(std::acos(float(d.y))) / kPi * k.height);")],
           "ibr_test_unit_scene", "panorama round trips*"),
    Mutant("the world in floats",
           [("libibr/src/render/passes/cell_parameters.cpp", "(camera.pose.position - eye.pose.position);",
             "glm::dvec3(glm::vec3(camera.pose.position) - glm::vec3(eye.pose.position));")],
           "ibr_test_reference", "moving and turning the world*"),
    Mutant("a near plane that cuts at 0.1",
           [("libibr/src/render/passes/cell_pipeline.cpp", "info.depthClamp = true;", "info.depthClamp = false;"),
            ("libibr/src/render/passes/cell_parameters.cpp", "cell.nearDistance = float(plan.nearDistance);",
             "cell.nearDistance = 0.1f;")],
           "ibr_test_reference", "*near*"),
    Mutant("the two histograms of an overlap have different masks",
           [("shaders/render/colour_count.comp", "      atomicAdd(counters[jointOffset",
             "      if (noiseRank[cell.y * uint(kNoiseSize) + cell.x] * 2u < frame.kept)\n"
             "        atomicAdd(counters[jointOffset")],
           "ibr_test_reference", "*count*,*histogram*"),
    Mutant("ceil in floats",
           [("shaders/shared/colour_map.h", "    const int mixed = (range.bottomLevel * i + range.bottom - 1) / "
             "range.bottom;",
             "    const int mixed = -int(floor(-(float(range.bottomLevel) * (float(i) / float(range.bottom)))));")],
           "ibr_test_unit_render", "tables*"),
    Mutant("the colour map of the other eye",
           [("libibr/src/render/passes/colour_map_pass.cpp",
             "cells_->drawStep(commands, layout_.get(), step, cells_->firstParameter(Order::current, view) + s);",
             "cells_->drawStep(commands, layout_.get(), step, cells_->firstParameter(Order::current, 0) + s);")],
           "ibr_test_reference", "*eye*"),
    Mutant("an order of cells for each eye",
           [("libibr/src/render/passes/steps.cpp", "  for (std::uint32_t b = 0; b < plan.backdrops.size(); ++b)\n"
             "    if (shown[b] < 1) addBackdrop(kTierAgrees, b, 1);",
             "  if (view == 1 && steps.count > 1) std::swap(steps.step[0], steps.step[1]);\n"
             "  for (std::uint32_t b = 0; b < plan.backdrops.size(); ++b)\n"
             "    if (shown[b] < 1) addBackdrop(kTierAgrees, b, 1);")],
           "ibr_test_reference", "*eye*"),
    Mutant("photographs are turned the wrong way",
           [("libibr/src/io/image_file.cpp",
             "mirroredX = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;",
             "mirroredX = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 6;")],
           "ibr_test_unit_io", "*orient*,*EXIF*"),
    Mutant("COLMAP's axes are taken as they are",
           [("libibr/src/author/geometry/world_to_camera.h", "  const glm::dquat halfTurnAboutX(0.0, 1.0, 0.0, 0.0);",
             "  const glm::dquat halfTurnAboutX(1.0, 0.0, 0.0, 0.0);")],
           "ibr_test_unit_author", "*COLMAP*"),
    Mutant("an index is not checked",
           [("libibr/src/scene/scene.cpp",
             'faults.add(fmt::format("{}.triangles[{}]", at, t), "({}, {}, {}) has an index beyond the {} points",',
             'if (t > 1000000) faults.add(fmt::format("{}.triangles[{}]", at, t), '
             '"({}, {}, {}) has an index beyond the {} points",')],
           "ibr_test_unit_scene", "*valid*"),
    Mutant("a path may lead out of the scene's folder",
           [("libibr/src/base/file.cpp", "relative.is_relative() && rootEnd == root.end() && path != root",
             "(rootEnd == root.end() || true)")],
           "ibr_test_robustness", "*outside*,*path*,*leads*"),
    Mutant("an allocation's result is not checked",
           [("libibr/src/gpu/device/memory.cpp", "  check(result != VK_ERROR_OUT_OF_DEVICE_MEMORY && result != "
             "VK_ERROR_OUT_OF_HOST_MEMORY, ErrorCode::outOfMemory,",
             "  check(true, ErrorCode::outOfMemory,"),
            ("libibr/src/gpu/device/memory.cpp", '  vk(result, "vkAllocateMemory");\n', "")],
           "ibr_test_gpu"),
    Mutant("numbers are read as the locale has them",
           [("libibr/src/base/parse.cpp", "  const auto value = parseWhole<double>(text);",
             "  const std::string copy(text);\n  char* end = nullptr;\n"
             "  const std::optional<double> value = std::strtod(copy.c_str(), &end);\n"
             "  if (copy.empty() || *end != 0) return std::nullopt;"),
            ("libibr/src/base/parse.cpp", "#include <cmath>\n", "#include <cmath>\n#include <cstdlib>\n#include "
             "<string>\n")],
           "ibr_test_unit_base", "*locale*,*parse*,*number*"),
]
