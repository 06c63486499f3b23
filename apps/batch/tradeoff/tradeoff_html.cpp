// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_html.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/file.h"
#include "ibr/metrics.h"
#include "io/image_file.h"
#include "shared/report/svg_text.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

// Base64, RFC 4648 §4.
std::string base64(const std::vector<std::byte>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t three = 0;
    for (std::size_t b = 0; b < 3; ++b)
      three = three << 8 | (at + b < bytes.size() ? std::uint32_t(bytes[at + b]) : 0u);
    for (std::size_t d = 0; d < 4; ++d) text += at + d > bytes.size() ? '=' : kDigits[three >> (18 - 6 * d) & 63];
  }
  return text;
}

std::string dataUri(const Image8& picture, const fs::path& scratch) {
  const fs::path file = scratch / "picture.part.jpg";
  writeImage(file, picture, 85);
  const std::string text = "data:image/jpeg;base64," + base64(readFile(file));
  fs::remove(file);
  return text;
}

std::string tableHtml(const std::vector<std::vector<std::string>>& rows) {
  std::string out = "<table>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    out += "<tr>";
    for (const std::string& cell : rows[r])
      out += fmt::format("<{0}>{1}</{0}>", r == 0 ? "th" : "td", escapedXml(cell));
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

std::string settingsTable(const TradeoffReport& report) {
  std::vector<std::vector<std::string>> rows{{"setting", "ms", "quartiles", "PSNR", "SSIM", "MS-SSIM", "FLIP", "detail",
                                              "FLIP to reference", "holes %", "draws", "triangles", "MiB"}};
  for (const TradeoffRow& row : report.rows) {
    if (!row.failure.empty()) {
      rows.push_back({row.setting.name(), row.failure});
      continue;
    }
    const ImageSimilarity truth = row.truth();
    const double views = double(row.views.size());
    rows.push_back({row.setting.name(), numberText(row.medianMs(), 1),
                    numberText(row.quantileMs(0.25), 1) + "–" + numberText(row.quantileMs(0.75), 1),
                    numberText(truth.psnr, 2), numberText(truth.ssim, 4), numberText(truth.msSsim, 4),
                    numberText(truth.flip, 4), numberText(truth.detail, 3), numberText(row.reference().flip, 4),
                    numberText(100 * row.holes(), 2), numberText(double(row.draws()) / views, 1),
                    numberText(double(row.triangles()) / views, 0), numberText(double(row.bytes()) / 1048576, 1)});
  }
  return tableHtml(rows);
}

std::string gatesTable(const TradeoffReport& report) {
  std::vector<std::vector<std::string>> rows{{"", "guarantee", "measured"}};
  for (const TradeoffGate& gate : report.gates())
    rows.push_back({gate.holds ? "holds" : "FAILS", gate.name, gate.found});
  return tableHtml(rows);
}

std::string walksTable(const TradeoffReport& report) {
  std::vector<std::vector<std::string>> rows{
      {"preset", "frames", "switches", "median step, 8-bit levels", "step at a switch", "largest FLIP", "hole px"}};
  for (const TradeoffWalk& walk : report.walks)
    rows.push_back({walk.preset, std::to_string(walk.frames), std::to_string(walk.switches),
                    numberText(walk.medianStep, 3), numberText(walk.switchStep, 3), numberText(walk.pop, 4),
                    std::to_string(walk.holePixels)});
  return tableHtml(rows);
}

// Returns an empty text if no setting has two views.
std::string eyesTable(const TradeoffReport& report) {
  std::vector<std::vector<std::string>> rows{
      {"setting", "seen by both %", "by the same cell %", "mean difference, 8-bit levels", "95 % quantile"}};
  for (const TradeoffRow& row : report.rows)
    if (const auto eyes = row.eyes())
      rows.push_back({row.setting.name(), numberText(100 * eyes->seenByBoth, 1), numberText(100 * eyes->sameCell, 2),
                      numberText(eyes->difference, 3), numberText(eyes->difference95, 2)});
  return rows.size() == 1 ? "" : tableHtml(rows);
}

std::string referenceErrorTable(const TradeoffReport& report) {
  std::vector<std::vector<std::string>> rows{{"view", "compared pixels %", "mean difference, 8-bit levels", "largest",
                                              "beyond the bound of texture filters %"}};
  for (const ImplementationError& error : report.implementation)
    rows.push_back({error.name, numberText(100 * error.compared, 1), numberText(error.meanLevels, 3),
                    numberText(error.largestLevels, 2), numberText(100 * error.beyondBound, 4)});
  return tableHtml(rows);
}

std::string worstHtml(const std::vector<WorstView>& worst, const fs::path& scratch) {
  std::string out;
  for (const WorstView& view : worst) {
    out += fmt::format("<h3>{}: {}, FLIP {:.4f}</h3>\n<p>", escapedXml(view.preset), escapedXml(view.view), view.flip);
    for (const auto& [name, picture] :
         {std::pair{"rendered", &view.picture}, {"truth or reference", &view.truth}, {"FLIP", &view.difference}})
      out += fmt::format("<img alt=\"{0}\" title=\"{0}\" src=\"{1}\"/>\n", name, dataUri(*picture, scratch));
    out += "</p>\n";
  }
  return out;
}

constexpr const char* kStyle =
    "body{font:15px/1.45 sans-serif;color:#202830;max-width:1200px;margin:24px auto;padding:0 16px}"
    "table{border-collapse:collapse;font-size:13px}td,th{padding:2px 9px;border-bottom:1px solid "
    "#e2e6ea;text-align:right}"
    "td:first-child,th:first-child{text-align:left}img{max-width:32%;margin-right:6px}svg{max-width:100%;height:auto}"
    "code{background:#f2f4f6;padding:1px 4px;overflow-wrap:anywhere}";

}  // namespace

Image8 flipPicture(const Image8& picture, const Image8& truth) {
  const ImageF map = flipMap(picture, truth);
  Image8 shown(map.width, map.height, 3);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      for (int c = 0; c < 3; ++c)
        shown.pixel(x, y)[std::size_t(c)] =
            std::uint8_t(255 * std::clamp(3 * double(map.pixel(x, y)[0]) - c, 0.0, 1.0) + 0.5);
  return shown;
}

std::string tradeoffHtml(const TradeoffReport& report, const std::vector<TradeoffFigure>& figures,
                         const std::vector<WorstView>& worst, const fs::path& scratch) {
  const std::string scene = escapedXml(report.about.value("scene", ""));
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><title>Speed against accuracy: {0}</title>"
      "<style>{1}</style></head><body>\n<h1>Speed against accuracy: {0}</h1>\n",
      scene, kStyle);
  out += fmt::format("<p>{} on {}; libibr {}.</p>\n<p><code>{}</code></p>\n",
                     escapedXml(report.about.value("device", "")), escapedXml(report.about.value("processor", "")),
                     escapedXml(report.about.value("libibr", "")), escapedXml(report.about.value("command", "")));
  if (report.about.value("software", false))
    out += "<p>This is a software device: times are those of a CPU and do not predict those of a GPU.</p>\n";
  for (const TradeoffFigure& figure : figures)
    out += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", figure.svg, escapedXml(figure.caption));
  out += "<h2>Guarantees of the presets</h2>\n" + gatesTable(report);
  if (!report.walks.empty()) out += "<h2>Walk in small steps</h2>\n" + walksTable(report);
  if (!report.implementation.empty())
    out += "<h2>Device against the double-precision reference implementation</h2>\n" + referenceErrorTable(report);
  if (const std::string eyes = eyesTable(report); !eyes.empty())
    out += "<h2>Agreement of two eyes at the same depth</h2>\n" + eyes;
  if (!worst.empty()) out += "<h2>Worst view of each preset</h2>\n" + worstHtml(worst, scratch);
  out += "<h2>All settings</h2>\n" + settingsTable(report);
  if (!report.missing.empty()) {
    out += "<h2>Not measured</h2>\n<ul>\n";
    for (const std::string& missing : report.missing) out += "<li>" + escapedXml(missing) + "</li>\n";
    out += "</ul>\n";
  }
  return out + "</body></html>\n";
}

}  // namespace ibr::app
