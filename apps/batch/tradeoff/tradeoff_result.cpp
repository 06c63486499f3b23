// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "ibr/metrics.h"
#include "shared/draw/image_operations.h"
#include "shared/report/statistics.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Figure {
  const char* name;
  double ImageSimilarity::*value;
};
constexpr Figure kFigures[] = {{"psnr", &ImageSimilarity::psnr},     {"ssim", &ImageSimilarity::ssim},
                               {"msSsim", &ImageSimilarity::msSsim}, {"flip", &ImageSimilarity::flip},
                               {"detail", &ImageSimilarity::detail}, {"edges", &ImageSimilarity::edges}};

struct Count {
  const char* name;
  std::uint64_t TradeoffView::*value;
};
constexpr Count kCounts[] = {{"passes", &TradeoffView::passes},         {"draws", &TradeoffView::draws},
                             {"dispatches", &TradeoffView::dispatches}, {"triangles", &TradeoffView::triangles},
                             {"cells", &TradeoffView::cells},           {"photographs", &TradeoffView::photographs}};

struct EyeFigure {
  const char* name;
  double EyeAgreement::*value;
};
constexpr EyeFigure kEyeFigures[] = {{"seenByBoth", &EyeAgreement::seenByBoth},
                                     {"sameCell", &EyeAgreement::sameCell},
                                     {"difference", &EyeAgreement::difference},
                                     {"difference95", &EyeAgreement::difference95}};

Json eyesJson(const EyeAgreement& eyes) {
  Json json = Json::object();
  for (const EyeFigure& figure : kEyeFigures) json[figure.name] = eyes.*figure.value;
  return json;
}

EyeAgreement eyesOf(const Json& json) {
  EyeAgreement eyes;
  for (const EyeFigure& figure : kEyeFigures)
    if (const Json& value = json.at(figure.name); value.is_number()) eyes.*figure.value = value;
  return eyes;
}

Json likenessJson(const ImageSimilarity& similarity) {
  Json json = Json::object();
  for (const Figure& figure : kFigures) json[figure.name] = similarity.*figure.value;
  return json;
}

ImageSimilarity likenessOf(const Json& json) {
  ImageSimilarity similarity;
  for (const Figure& figure : kFigures)
    if (const Json& value = json.at(figure.name); value.is_number()) similarity.*figure.value = value;
  return similarity;
}

Json bytesJson(const TradeoffBytes& bytes) {
  return {{"positions", bytes.positions}, {"indices", bytes.indices}, {"textures", bytes.textures}};
}

TradeoffBytes bytesOf(const Json& json) {
  return {json.at("positions"), json.at("indices"), json.at("textures")};
}

ImageSimilarity meanOfViews(const TradeoffRow& row, ImageSimilarity TradeoffView::*which) {
  std::vector<ImageSimilarity> all;
  for (const TradeoffView& view : row.views) all.push_back(view.*which);
  return meanOf(all);
}

std::uint64_t sumOfViews(const TradeoffRow& row, std::uint64_t TradeoffView::*which) {
  std::uint64_t sum = 0;
  for (const TradeoffView& view : row.views) sum += view.*which;
  return sum;
}

std::string csvText(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

}  // namespace

ImageSimilarity::ImageSimilarity() {
  for (const Figure& figure : kFigures) this->*figure.value = std::nan("");
}

ImageSimilarity similarity(const Image8& picture, const Image8& other, const Image8& cover) {
  ImageSimilarity result;
  result.psnr = psnr(picture, other);
  result.ssim = ssim(picture, other);
  result.msSsim = msSsim(picture, other);
  result.flip = flip(picture, other);
  const Detail kept = detail(picture, other, cover);
  result.detail = kept.energy;
  result.edges = kept.correlation;
  return result;
}

ImageSimilarity meanOf(const std::vector<ImageSimilarity>& all) {
  ImageSimilarity result;
  for (const Figure& figure : kFigures) {
    std::vector<double> values;
    for (const ImageSimilarity& similarity : all)
      if (std::isfinite(similarity.*figure.value)) values.push_back(similarity.*figure.value);
    if (!values.empty()) result.*figure.value = mean(values);
  }
  return result;
}

ImageSimilarity TradeoffRow::truth() const {
  return meanOfViews(*this, &TradeoffView::truth);
}

ImageSimilarity TradeoffRow::reference() const {
  return meanOfViews(*this, &TradeoffView::reference);
}

double TradeoffRow::holes() const {
  std::vector<double> all;
  for (const TradeoffView& view : views) all.push_back(view.holes);
  return all.empty() ? std::nan("") : mean(all);
}

std::optional<EyeAgreement> TradeoffRow::eyes() const {
  std::optional<EyeAgreement> result;
  for (const EyeFigure& figure : kEyeFigures) {
    std::vector<double> values;
    for (const TradeoffView& view : views)
      if (view.eyes && std::isfinite((*view.eyes).*figure.value)) values.push_back((*view.eyes).*figure.value);
    if (values.empty()) continue;
    if (!result) result.emplace();
    (*result).*figure.value = mean(values);
  }
  return result;
}

std::uint64_t TradeoffRow::draws() const {
  return sumOfViews(*this, &TradeoffView::draws);
}

std::uint64_t TradeoffRow::triangles() const {
  return sumOfViews(*this, &TradeoffView::triangles);
}

std::vector<double> TradeoffRow::frameMs() const {
  std::vector<double> all;
  for (std::size_t r = 0; r < deviceMs.size(); ++r) all.push_back(mean(deviceMs[r]) + mean(planMs[r]));
  return all;
}

double TradeoffRow::quantileMs(double q) const {
  return quantile(frameMs(), q);
}

double errorOf(const TradeoffRow& row) {
  const double truth = row.truth().flip;
  return std::isfinite(truth) ? truth : row.reference().flip;
}

Json pictureJson(const TradeoffRow& row) {
  Json views = Json::array();
  for (const TradeoffView& view : row.views) {
    Json json{{"name", view.name},
              {"truth", likenessJson(view.truth)},
              {"reference", likenessJson(view.reference)},
              {"holes", view.holes},
              {"prediction", view.prediction}};
    for (const Count& count : kCounts) json[count.name] = view.*count.value;
    if (view.eyes) json["eyes"] = eyesJson(*view.eyes);
    views.push_back(std::move(json));
  }
  return {{"views", views},
          {"bytes", {{"measured", bytesJson(row.measured)}, {"predicted", bytesJson(row.predicted)}}},
          {"pipelines", row.pipelines},
          {"workingBytes", row.workingBytes}};
}

void readPicture(const Json& json, TradeoffRow& row) {
  TradeoffRow read{row.setting, {}, {}, {}, {}, 0, 0, {}, {}, {}};
  for (const Json& each : json.at("views")) {
    TradeoffView view{each.at("name"), likenessOf(each.at("truth")), likenessOf(each.at("reference")), each.at("holes"),
                      each.at("prediction")};
    for (const Count& count : kCounts) view.*count.value = each.at(count.name);
    if (each.contains("eyes")) view.eyes = eyesOf(each["eyes"]);
    read.views.push_back(std::move(view));
  }
  read.measured = bytesOf(json.at("bytes").at("measured"));
  read.predicted = bytesOf(json.at("bytes").at("predicted"));
  read.pipelines = json.at("pipelines");
  read.workingBytes = json.at("workingBytes");
  row = std::move(read);
}

Json rowJson(const TradeoffRow& row) {
  Json labels = Json::array();
  for (const TradeoffLabel& label : row.setting.labels)
    labels.push_back({{"knob", label.knob}, {"value", label.value}});
  Json json{{"setting", row.setting.name()}, {"labels", labels}, {"knobs", variantJson(row.setting.variant)}};
  if (!row.failure.empty()) {
    json["failure"] = row.failure;
    return json;
  }
  json["ms"] = {{"median", row.medianMs()}, {"low", row.quantileMs(0.25)}, {"high", row.quantileMs(0.75)},
                {"device", row.deviceMs},   {"plan", row.planMs},          {"passes", row.passMs}};
  json["truth"] = likenessJson(row.truth());
  json["reference"] = likenessJson(row.reference());
  json["holes"] = row.holes();
  if (const auto eyes = row.eyes()) json["eyes"] = eyesJson(*eyes);
  json.update(pictureJson(row));
  return json;
}

std::string tradeoffCsv(const std::vector<TradeoffRow>& rows) {
  std::string csv = "setting,knob,value,medianMs,lowMs,highMs";
  for (const char* kind : {"truth", "reference"})
    for (const Figure& figure : kFigures) csv += fmt::format(",{}.{}", kind, figure.name);
  csv += ",holes,draws,triangles,positionBytes,indexBytes,textureBytes,workingBytes,failure\n";
  for (const TradeoffRow& row : rows) {
    // One line for each knob that the setting belongs to.
    for (const TradeoffLabel& label : row.setting.labels) {
      csv += fmt::format("{},{},{}", quoted(row.setting.name()), quoted(label.knob), quoted(label.value));
      for (const double q : {0.5, 0.25, 0.75}) csv += fmt::format(",{}", csvText(row.quantileMs(q)));
      for (const ImageSimilarity& similarity : {row.truth(), row.reference()})
        for (const Figure& figure : kFigures) csv += fmt::format(",{}", csvText(similarity.*figure.value));
      csv += fmt::format(",{},{},{},{},{},{},{},{}\n", csvText(row.holes()), row.draws(), row.triangles(),
                         row.measured.positions, row.measured.indices, row.measured.textures, row.workingBytes,
                         quoted(row.failure));
    }
  }
  return csv;
}

std::string tradeoffTable(const std::vector<TradeoffRow>& rows) {
  Table table;
  table.row({"setting", "ms", "quartiles", "PSNR", "SSIM", "MS-SSIM", "FLIP", "detail", "FLIP (ref.)", "holes %",
             "draws", "triangles", "memory"});
  for (const TradeoffRow& row : rows) {
    if (!row.failure.empty()) {
      table.row({row.setting.name(), row.failure});
      continue;
    }
    const ImageSimilarity truth = row.truth(), reference = row.reference();
    const double views = double(row.views.size());
    table.row({row.setting.name(), numberText(row.medianMs(), 1),
               fmt::format("{}–{}", numberText(row.quantileMs(0.25), 1), numberText(row.quantileMs(0.75), 1)),
               numberText(truth.psnr, 2), numberText(truth.ssim, 4), numberText(truth.msSsim, 4),
               numberText(truth.flip, 4), numberText(truth.detail, 3), numberText(reference.flip, 4),
               numberText(100 * row.holes(), 2), numberText(double(row.draws()) / views, 1),
               numberText(double(row.triangles()) / views, 0), bytesText(double(row.bytes()))});
  }
  return table.text();
}

}  // namespace ibr::app
