// SPDX-License-Identifier: Apache-2.0
// Pages "Times" and "Memory".
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "viewer/panels/panels.h"

namespace ibr::app {
namespace {

// Colours of Okabe and Ito, distinguishable with any colour vision deficiency.
constexpr std::array kColours{IM_COL32(86, 180, 233, 255), IM_COL32(230, 159, 0, 255),   IM_COL32(0, 158, 115, 255),
                              IM_COL32(240, 228, 66, 255), IM_COL32(204, 121, 167, 255), IM_COL32(0, 114, 178, 255),
                              IM_COL32(213, 94, 0, 255)};

ImU32 colourOf(std::size_t index) {
  return kColours[index % kColours.size()];
}

void swatchOf(std::size_t index) {
  const ImVec4 colour = ImGui::ColorConvertU32ToFloat4(colourOf(index));
  swatch({colour.x, colour.y, colour.z});
  ImGui::SameLine();
}

float sumOf(const FrameTimes& times) {
  return std::accumulate(times.passes.begin(), times.passes.end(), 0.0f,
                         [](float sum, const auto& pass) { return sum + pass.second; });
}

// Rounds x up to 1, 2 or 5 times a power of ten.
float roundedUp(float x) {
  const float power = std::pow(10.0f, std::floor(std::log10(std::max(x, 1e-3f))));
  for (const float step : {1.0f, 2.0f, 5.0f})
    if (x <= step * power) return step * power;
  return 10 * power;
}

struct Graph {
  ImVec2 corner, size;
  float most;  // ms
  float y(float milliseconds) const { return corner.y + size.y * (1 - std::clamp(milliseconds / most, 0.0f, 1.0f)); }
};

void tellFrame(const FrameTimes& times, const FrameHistory& history) {
  ImGui::BeginTooltip();
  ImGui::Text("frame %zu", times.frame);
  if (!std::isnan(times.sinceLast)) ImGui::Text("%8.2f ms since the previous frame", double(times.sinceLast));
  for (const auto& [pass, milliseconds] : times.passes) {
    swatchOf(pass);
    ImGui::Text("%6.2f ms  %s", double(milliseconds), history.names()[pass].c_str());
  }
  ImGui::EndTooltip();
}

// Draws passes on the device as stacked bars, and the frame-to-frame time as a line.
void drawGraph(const FrameHistory& history, std::size_t last) {
  const std::size_t first = last >= FrameHistory::kLength ? last - FrameHistory::kLength + 1 : 1;
  Graph graph{
      ImGui::GetCursorScreenPos(), {std::max(50.0f, ImGui::GetContentRegionAvail().x), 8 * ImGui::GetFontSize()}, 1};
  const auto isThere = [&](std::size_t frame) { return history.of(frame).frame == frame; };
  float most = 0;
  for (std::size_t frame = first; frame <= last; ++frame)
    if (isThere(frame))
      most = std::max(
          {most, sumOf(history.of(frame)), std::isnan(history.of(frame).sinceLast) ? 0 : history.of(frame).sinceLast});
  graph.most = roundedUp(most);
  ImGui::InvisibleButton("frames", graph.size);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(graph.corner, {graph.corner.x + graph.size.x, graph.corner.y + graph.size.y},
                     ImGui::GetColorU32(ImGuiCol_FrameBg));
  const float wide = graph.size.x / float(FrameHistory::kLength);
  const auto x = [&](std::size_t frame) { return graph.corner.x + graph.size.x - wide * float(last - frame + 1); };
  for (std::size_t frame = first; frame <= last; ++frame) {
    if (!isThere(frame)) continue;
    const FrameTimes& times = history.of(frame);
    float below = 0;
    for (const auto& [pass, milliseconds] : times.passes) {
      list.AddRectFilled({x(frame), graph.y(below + milliseconds)},
                         {x(frame) + std::max(1.0f, wide - 1), graph.y(below)}, colourOf(pass));
      below += milliseconds;
    }
    if (frame > first && isThere(frame - 1) && !std::isnan(times.sinceLast) &&
        !std::isnan(history.of(frame - 1).sinceLast))
      list.AddLine({x(frame - 1) + wide / 2, graph.y(history.of(frame - 1).sinceLast)},
                   {x(frame) + wide / 2, graph.y(times.sinceLast)}, IM_COL32_WHITE, 1.5f);
  }
  list.AddText({graph.corner.x + 4, graph.corner.y + 2}, ImGui::GetColorU32(ImGuiCol_TextDisabled),
               fmt::format("{:g} ms", graph.most).c_str());
  if (!ImGui::IsItemHovered()) return;
  const auto back = std::size_t(std::max(0.0f, (graph.corner.x + graph.size.x - ImGui::GetIO().MousePos.x) / wide));
  if (back < last && isThere(last - back)) tellFrame(history.of(last - back), history);
}

double inMiB(std::uint64_t bytes) {
  return double(bytes) / (1 << 20);
}

// Draws the used memory, one colour per class, as a share of `whole`.
void drawBar(const std::vector<MemoryClass>& classes, bool sceneAlone, std::uint64_t whole) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size{std::max(50.0f, ImGui::GetContentRegionAvail().x), 1.2f * ImGui::GetFontSize()};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + size.x, at.y + size.y}, ImGui::GetColorU32(ImGuiCol_FrameBg));
  double taken = 0;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (sceneAlone && !classes[i].ofScene) continue;
    const auto x = [&](double bytes) {
      return at.x + size.x * float(std::min(1.0, bytes / double(std::max<std::uint64_t>(whole, 1))));
    };
    const float from = x(taken);
    taken += double(classes[i].bytes);
    list.AddRectFilled({from, at.y}, {x(taken), at.y + size.y}, colourOf(i));
  }
  ImGui::Dummy(size);
}

std::uint64_t sumOf(const std::vector<MemoryClass>& classes, bool sceneAlone) {
  std::uint64_t sum = 0;
  for (const MemoryClass& one : classes)
    if (one.ofScene || !sceneAlone) sum += one.bytes;
  return sum;
}

}  // namespace

void showTimes(PanelInput& input) {
  Viewer& viewer = input.viewer;
  drawGraph(viewer.history, viewer.frames);
  const float last = viewer.history.of(viewer.frames).sinceLast;
  if (std::isnan(last))
    ImGui::TextUnformatted("no frame interval: the view is at rest");
  else
    ImGui::Text("line: frame interval, %.1f ms, %.0f frames/s", double(last), 1000 / std::max(1e-3, double(last)));
  ImGui::Separator();
  ImGui::TextUnformatted("device times:");
  for (const ScopeTime& scope : viewer.deviceTimes) {
    const float indent = float(scope.depth) * ImGui::GetFontSize() + 0.01f;
    ImGui::Indent(indent);
    if (scope.depth == 0) swatchOf(viewer.history.indexOf(scope.name));
    ImGui::Text("%8.3f ms  %s", scope.milliseconds, scope.name.c_str());
    ImGui::Unindent(indent);
  }
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("%s", input.device.c_str());
  ImGui::PopTextWrapPos();
}

void showMemory(PanelInput& input) {
  if (input.sceneBudget > 0) {
    ImGui::Text("budget: %.1f of %.1f MiB (--vram-budget)", inMiB(sumOf(input.memory, true)), inMiB(input.sceneBudget));
    drawBar(input.memory, true, input.sceneBudget);
  }
  const MemoryBudget& device = input.budget;
  ImGui::Text("open scene: %.1f of %.0f MiB %s", inMiB(sumOf(input.memory, false)), inMiB(device.bytes),
              device.used ? "available to this program" : "of the device");
  drawBar(input.memory, false, device.bytes);
  ImGui::Separator();
  for (std::size_t i = 0; i < input.memory.size(); ++i) {
    swatchOf(i);
    ImGui::Text("%9.1f MiB  %s", inMiB(input.memory[i].bytes), input.memory[i].name.c_str());
  }
  if (device.used)
    ImGui::TextWrapped("%.1f MiB in total, with other open scenes, the window and the driver", inMiB(*device.used));
  if (!input.streamed || input.streamed->needed == 0) return;
  const GpuScene::StreamStatus& s = *input.streamed;
  ImGui::Separator();
  ImGui::Text("%u photographs and meshes in view; %u loading, %u without memory, %u unreadable", s.needed, s.waiting,
              s.overBudget, s.failed);
  ImGui::Text("%u being read, %u queued", s.reading, s.queued);
}

}  // namespace ibr::app
