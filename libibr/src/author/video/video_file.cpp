// SPDX-License-Identifier: Apache-2.0
#include "author/video/video_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/child_process.h"
#include "base/parse.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

// Value of a member; empty text, 0 or null where it is missing or of another type.
std::string textOf(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  return at != json.end() && at->is_string() ? at->get<std::string>() : "";
}
double numberOf(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  if (at == json.end()) return 0;
  if (at->is_number()) return at->get<double>();
  return at->is_string() ? parseDouble(at->get<std::string>()).value_or(0) : 0;
}
const Json& memberOf(const Json& json, const char* key) {
  static const Json kNone;
  const auto at = json.is_object() ? json.find(key) : json.end();
  return at != json.end() ? *at : kNone;
}

// "30000/1001" → 29.97; 0 if it is not a positive fraction.
double fractionOf(const std::string& text, char between = '/') {
  const std::size_t bar = text.find(between);
  if (bar == text.npos) return 0;
  const double above = parseDouble(text.substr(0, bar)).value_or(0),
               below = parseDouble(text.substr(bar + 1)).value_or(0);
  return above > 0 && below > 0 ? above / below : 0;
}

// ISO 6709: "+48.8577+002.295+035.0/".
std::optional<GeoLocation> locationIn(const std::string& text) {
  std::vector<double> values;
  for (std::size_t at = 0; at < text.size() && (text[at] == '+' || text[at] == '-');) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789.", at + 1), text.size());
    const auto value = parseDouble(text.substr(at + 1, end - at - 1));
    if (!value) return std::nullopt;
    values.push_back(text[at] == '-' ? -*value : *value);
    at = end;
  }
  if (values.size() < 2 || std::abs(values[0]) > 90 || std::abs(values[1]) > 180) return std::nullopt;
  return GeoLocation{values[0], values[1], values.size() > 2 ? std::optional(values[2]) : std::nullopt};
}

// First tag whose name starts with one of these.
std::string tagOf(const Json& tags, std::initializer_list<const char*> names) {
  if (tags.is_object())
    for (const char* name : names)
      for (const auto& [key, value] : tags.items())
        if (key.starts_with(name) && value.is_string()) return value.get<std::string>();
  return "";
}

int rotationOf(const Json& stream) {
  double degrees = numberOf(memberOf(stream, "tags"), "rotate");
  for (const Json& data : memberOf(stream, "side_data_list"))
    if (data.is_object() && data.contains("rotation")) degrees = -numberOf(data, "rotation");
  const int turns = int(std::lround(degrees / 90)) % 4;
  return 90 * ((turns + 4) % 4);
}

int primariesOf(const std::string& name) {
  if (name == "bt2020") return 9;
  return name == "smpte432" ? 12 : 1;
}

std::string describe(const Json& stream) {
  const std::string kind = textOf(stream, "codec_type"), tag = textOf(stream, "codec_tag_string");
  std::string handler = tagOf(memberOf(stream, "tags"), {"handler_name"});
  std::erase_if(handler, [](char c) { return c >= 0 && c < ' '; });
  return fmt::format("{}{}{}", kind.empty() ? "stream" : kind, tag.starts_with('[') || tag.empty() ? "" : ' ' + tag,
                     handler.empty() ? "" : " (" + handler + ')');
}

bool isPicture(const Json& stream) {
  return numberOf(memberOf(stream, "disposition"), "attached_pic") != 0;
}

}  // namespace

VideoStream streamOf(const std::string& probed, const std::string& name) {
  const Json json = Json::parse(probed, nullptr, false);
  const Json& streams = memberOf(json, "streams");
  check(streams.is_array(), ErrorCode::invalidInput, "{}: is not a video", name);
  VideoStream result;
  VideoInfo& info = result.info;
  const Json* video = nullptr;
  for (const Json& stream : streams) {
    if (!video && textOf(stream, "codec_type") == "video" && !isPicture(stream))
      video = &stream;
    else if (textOf(stream, "codec_type") != "audio")
      info.ignored.push_back(describe(stream));
  }
  check(video != nullptr, ErrorCode::invalidInput, "{}: has no video stream", name);
  result.index = int(numberOf(*video, "index"));
  const double width = numberOf(*video, "width"), height = numberOf(*video, "height");
  constexpr double kMaxSide = 1 << 15;
  check(width >= 16 && height >= 16 && width <= kMaxSide && height <= kMaxSide, ErrorCode::invalidInput,
        "{}: frames of {}x{} px are not supported", name, width, height);
  const double shape = fractionOf(textOf(*video, "sample_aspect_ratio"), ':');
  result.squarePixels = shape == 0 || std::abs(shape - 1) < 1e-3 || shape < 0.1 || shape > 10;
  info.width = int(std::lround(result.squarePixels ? width : width * shape));
  info.height = int(height);
  info.rotation = rotationOf(*video);
  if (info.rotation % 180 != 0) std::swap(info.width, info.height);
  const double mean = fractionOf(textOf(*video, "avg_frame_rate")), base = fractionOf(textOf(*video, "r_frame_rate"));
  info.framesPerSecond = mean > 0 ? mean : base;
  info.variableRate = mean > 0 && base > 0 && std::abs(mean - base) > 0.02 * base;
  const Json& format = memberOf(json, "format");
  info.seconds = std::max({0.0, numberOf(*video, "duration"), numberOf(format, "duration")});
  const std::string transfer = textOf(*video, "color_transfer");
  info.hdr = transfer == "smpte2084" || transfer == "arib-std-b67";
  result.colour = {primariesOf(textOf(*video, "color_primaries")), transfer == "smpte2084" ? 16 : 18};
  if (textOf(*video, "color_space").empty() || textOf(*video, "color_space") == "unknown")
    result.matrix = info.hdr ? "bt2020" : std::min(width, height) >= 720 ? "bt709" : "bt601";
  for (const Json* tags : {&memberOf(format, "tags"), &memberOf(*video, "tags")}) {
    if (!info.location) info.location = locationIn(tagOf(*tags, {"com.apple.quicktime.location.ISO6709", "location"}));
    if (info.capture.maker.empty())
      info.capture.maker = tagOf(*tags, {"com.apple.quicktime.make", "make", "com.android.manufacturer"});
    if (info.capture.model.empty())
      info.capture.model = tagOf(*tags, {"com.apple.quicktime.model", "model", "com.android.model"});
  }
  return result;
}

VideoStream probeStream(const fs::path& video, const std::string& ffprobe) {
  check(fs::is_regular_file(video), ErrorCode::io, "{}: is not a file", video.string());
  std::string printed;
  constexpr std::size_t kMost = std::size_t(1) << 24;
  const ChildOutput result = readChild(
      {ffprobe, "-v", "error", "-show_format", "-show_streams", "-of", "json", fs::absolute(video).string()}, {},
      [&](std::span<const std::byte> bytes) {
        printed.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return printed.size() < kMost;
      },
      [] { return true; });
  check(result.status == 0, ErrorCode::invalidInput, "{}: is not a video that ffprobe can read: {}", video.string(),
        result.lastWords);
  return streamOf(printed, video.string());
}

VideoInfo probeVideo(const fs::path& video, const std::string& ffprobe) {
  return probeStream(video, ffprobe).info;
}

std::size_t VideoFile::decode(const std::string& filter, const std::string& format, std::size_t frameBytes,
                              const std::function<bool(std::span<const std::uint8_t>)>& frame) const {
  std::vector<std::uint8_t> buffer(frameBytes);
  std::size_t filled = 0, count = 0;
  bool wanted = true;
  const ChildOutput result = readChild(
      {ffmpeg_, "-v", "error", "-nostdin", "-i", fs::absolute(video_).string(), "-map",
       fmt::format("0:{}", stream_.index), "-fps_mode", "passthrough", "-vf", filter, "-f", "rawvideo", "-pix_fmt",
       format, "pipe:1"},
      {},
      [&](std::span<const std::byte> bytes) {
        while (!bytes.empty() && wanted) {
          const std::size_t more = std::min(bytes.size(), frameBytes - filled);
          std::memcpy(buffer.data() + filled, bytes.data(), more);
          bytes = bytes.subspan(more);
          filled += more;
          if (filled < frameBytes) break;
          wanted = frame(buffer);
          filled = 0;
          ++count;
        }
        return wanted;
      },
      [] { return true; });
  check(wanted, ErrorCode::cancelled, "cancelled while decoding {}", video_.string());
  // A damaged end is no reason to lose what comes before.
  check(count > 0, ErrorCode::io, "{}: ffmpeg decoded no frame: {}", video_.string(), result.lastWords);
  return count;
}

std::size_t VideoFile::greyFrames(int width, int height,
                                  const std::function<bool(std::size_t, const Image8&)>& frame) const {
  Image8 picture(width, height, 1);
  std::size_t number = 0;
  return decode(fmt::format("scale={}:{}:flags=area:out_range=pc,format=gray", width, height), "gray",
                picture.values.size(), [&](std::span<const std::uint8_t> bytes) {
                  std::ranges::copy(bytes, picture.values.begin());
                  return frame(number++, picture);
                });
}

void VideoFile::colourFrames(std::span<const std::size_t> numbers,
                             const std::function<bool(std::size_t, const Image8&)>& frame) const {
  constexpr std::size_t kBatch = 64;  // ffmpeg's expressions have at most 100 terms
  const int width = stream_.info.width, height = stream_.info.height;
  const std::size_t values = std::size_t(width) * std::size_t(height) * 3;
  for (std::size_t begin = 0; begin < numbers.size(); begin += kBatch) {
    const auto batch = numbers.subspan(begin, std::min(kBatch, numbers.size() - begin));
    std::vector<std::string> equals;
    for (const std::size_t number : batch) equals.push_back(fmt::format("eq(n\\,{})", number));
    const std::string matrix = stream_.matrix.empty() ? "" : ":in_color_matrix=" + stream_.matrix;
    const std::string filter = fmt::format("select={},scale={}:{}:flags=bicubic+accurate_rnd+full_chroma_int{}",
                                           fmt::join(equals, "+"), width, height, matrix);
    std::size_t done = 0;
    decode(filter, stream_.info.hdr ? "rgb48le" : "rgb24", values * (stream_.info.hdr ? 2 : 1),
           [&](std::span<const std::uint8_t> bytes) {
             if (done == batch.size()) return true;
             const std::size_t number = batch[done++];
             if (stream_.info.hdr) {
               Image<std::uint16_t> wide(width, height, 3);
               for (std::size_t i = 0; i < values; ++i)
                 wide.values[i] = std::uint16_t(bytes[2 * i] | bytes[2 * i + 1] << 8);
               return frame(number, io::toSrgb(wide, stream_.colour));
             }
             Image8 picture(width, height, 3);
             std::ranges::copy(bytes, picture.values.begin());
             return frame(number, picture);
           });
    check(done == batch.size(), ErrorCode::io, "{}: ffmpeg decoded {} of {} frames", video_.string(), done,
          batch.size());
  }
}

}  // namespace ibr
