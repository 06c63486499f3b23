// SPDX-License-Identifier: Apache-2.0
// Videos by the programs ffmpeg and ffprobe: properties, colours, rotation, rates.
#include "author/video/video_file.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "base/child_process.h"
#include "base/file.h"
#include "base/srgb.h"
#include "io/exif.h"
#include "io/image_file.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

using namespace ibr;
using Catch::Contains;

namespace {

void ffmpeg(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"ffmpeg", "-v", "error", "-y"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::string output;
  const ChildResult result = runChild(
      all, {}, [&](std::string_view line) { output += std::string(line) + '\n'; }, [] { return true; });
  INFO(output);
  REQUIRE(result.status == 0);
}

// A pan over noise that is smooth enough for codecs: 90 frames at 30 a second.
const std::vector<std::string> kPan{
    "-f", "lavfi", "-i",
    "nullsrc=s=900x200:r=30:d=3,geq=lum='128+60*sin(X/7)*cos(Y/9)+50*sin(X/17+Y/5)':cb=128:cr=128,"
    "crop=320:180:x='2*n':y=8,format=yuv420p"};

std::string pan(const test::TemporaryFolder& folder, const std::string& name, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = kPan;
  arguments.insert(arguments.end(), {"-c:v", "libx264", "-crf", "12"});
  arguments.insert(arguments.end(), more.begin(), more.end());
  arguments.push_back((folder / name).string());
  ffmpeg(arguments);
  return (folder / name).string();
}

// Copies an MP4 file with a track matrix that turns it by a quarter, as a phone writes it.
void turn(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::string file = readTextFile(from);
  const std::size_t header = file.find("tkhd");
  REQUIRE(header != file.npos);
  std::size_t at = header + 4 + 40;  // before the matrix: times, number, duration and layer of the track
  for (const std::uint32_t value : {0u, 0x10000u, 0u, 0xffff0000u, 0u, 0u, 0u, 0u, 0x40000000u})
    for (const int shift : {24, 16, 8, 0}) file.at(at++) = char(value >> shift);
  writeFile(to, std::string_view(file));
}

}  // namespace

TEST_CASE("a video's properties are read from what ffprobe prints") {
  const VideoStream stream = streamOf(
      R"({"streams":[{"index":0,"codec_type":"data","codec_tag_string":"gpmd","tags":{"handler_name":"\tGoPro MET"}},
          {"index":1,"codec_type":"video","width":1920,"height":1080,"sample_aspect_ratio":"1:1",
           "r_frame_rate":"30/1","avg_frame_rate":"2711/100","color_transfer":"arib-std-b67","color_primaries":"bt2020",
           "color_space":"bt2020nc","duration":"12.5","side_data_list":[{"rotation":-90}]},
          {"index":2,"codec_type":"audio","codec_tag_string":"mp4a"}],
          "format":{"duration":"12.6","tags":{"com.apple.quicktime.location.ISO6709":"+48.8577+002.2950+035.0/",
          "com.apple.quicktime.make":"Apple","com.apple.quicktime.model":"iPhone 12"}}})",
      "a.mov");
  const VideoInfo& info = stream.info;
  CHECK((stream.index == 1 && info.width == 1080 && info.height == 1920 && info.rotation == 90));
  CHECK((info.hdr && info.variableRate && info.framesPerSecond == Approx(27.11) && info.seconds == Approx(12.6)));
  CHECK((stream.colour.primaries == 9 && stream.colour.transfer == 18));
  REQUIRE(info.location.has_value());
  CHECK((info.location->latitude == Approx(48.8577) && info.location->longitude == Approx(2.295)));
  CHECK((info.capture.maker == "Apple" && info.capture.model == "iPhone 12"));
  REQUIRE(info.ignored.size() == 1);
  CHECK_THAT(info.ignored[0], Contains("gpmd (GoPro MET)"));
}

TEST_CASE("damaged answers of ffprobe are errors or ignored") {
  for (const char* text :
       {"", "{", "[]", "{}", R"({"streams":{}})", R"({"streams":[]})", R"({"streams":[1,null]})",
        R"({"streams":[{"codec_type":"audio"}]})", R"({"streams":[{"codec_type":"video"}]})",
        R"({"streams":[{"codec_type":"video","width":"a","height":[]}]})",
        R"({"streams":[{"codec_type":"video","width":1e9,"height":1e9}]})",
        R"({"streams":[{"codec_type":"video","width":64,"height":64,"disposition":{"attached_pic":1}}]})"}) {
    INFO(text);
    const Error error = test::errorOf([&] { streamOf(text, "a.mp4"); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Contains("a.mp4"));
  }
  for (const char* location : {"", "+", "+1", "+999+0/", "48 N", "+48.1+x"}) {
    const VideoStream stream = streamOf(
        std::string(
            R"({"streams":[{"codec_type":"video","width":64,"height":64,"avg_frame_rate":"0/0"}],"format":{"tags":{"location":")") +
            location + "\"}}}",
        "a.mp4");
    CHECK_FALSE(stream.info.location.has_value());
    CHECK(stream.info.framesPerSecond == 0);
  }
}

TEST_CASE("frames of a pan are chosen evenly and written with EXIF; a second call writes nothing") {
  const test::TemporaryFolder folder;
  const std::string video = pan(folder, "pan.mp4", {"-metadata", "location=+48.8577-002.2950+035.0/"});
  VideoOptions options;
  options.video = video;
  options.folder = folder / "frames";
  std::string logged;
  const VideoFrames frames = extractFrames(options, {}, [&](LogLevel, std::string_view text) { logged += text; });
  CHECK(frames.decoded == 90);
  REQUIRE(frames.chosen.size() >= 3);
  CHECK_THAT(logged, Contains("320x180") && Contains("location"));
  for (const VideoFrames::Frame& frame : frames.chosen) {
    const ImageFileInfo info = probeImage(options.folder / frame.name);
    CHECK((info.width == 320 && info.height == 180));
    CHECK(frame.name == fmt::format("pan_{:06}.jpg", frame.number));
    // The frame itself, not one beside it: column x shows what frame n shows 2n px to the left.
    const Image8 picture = readImage(options.folder / frame.name);
    double sum = 0;
    for (int x = 20; x < 300; ++x) {
      const double u = x + 2.0 * double(frame.number), v = 90 + 8;
      const double wanted = 128 + 60 * std::sin(u / 7) * std::cos(v / 9) + 50 * std::sin(u / 17 + v / 5);
      // Limited range, which a player widens.
      sum += std::abs((wanted - 16) * 255 / 219 - picture.pixel(x, 90)[1]);
    }
    CHECK(sum / 280 < 4);
  }
  const std::string first = frames.chosen[0].name;
  const auto time = std::filesystem::last_write_time(options.folder / first);
  const VideoFrames again = extractFrames(options);
  CHECK(again.chosen.size() == frames.chosen.size());
  CHECK(std::filesystem::last_write_time(options.folder / first) == time);
  // Another choice removes the frames of this one, and nothing else.
  for (const char* name : {"mine.jpg", "pan_notes.jpg", "pan_999999.jpg"}) writeFile(options.folder / name, "x");
  options.frames = 12;
  const VideoFrames more = extractFrames(options);
  CHECK(more.chosen.size() > frames.chosen.size());
  CHECK(std::filesystem::exists(options.folder / "mine.jpg"));
  CHECK(std::filesystem::exists(options.folder / "pan_notes.jpg"));
  CHECK_FALSE(std::filesystem::exists(options.folder / "pan_999999.jpg"));
}

TEST_CASE("a turned video gives upright frames, and a variable rate changes nothing") {
  const test::TemporaryFolder folder;
  pan(folder, "plain.mp4");
  turn(folder / "plain.mp4", folder / "turned.mp4");
  ffmpeg({"-i", (folder / "plain.mp4").string(), "-vf", "setpts='if(lt(N,45),PTS,PTS*2)'", "-fps_mode", "vfr", "-crf",
          "12", (folder / "variable.mp4").string()});
  const auto decoded = [&](const char* name) {
    const VideoStream stream = probeStream(folder / name, "ffprobe");
    Image8 frame;
    const std::size_t number[] = {60};
    VideoFile(folder / name, stream, "ffmpeg").colourFrames(number, [&](std::size_t, const Image8& picture) {
      frame = picture;
      return true;
    });
    return frame;
  };
  const Image8 plain = decoded("plain.mp4"), variable = decoded("variable.mp4");
  const VideoInfo turned = probeVideo(folder / "turned.mp4");
  CHECK((turned.width == 180 && turned.height == 320 && turned.rotation % 180 == 90));
  CHECK(probeVideo(folder / "variable.mp4").variableRate);
  REQUIRE(plain.values.size() == variable.values.size());
  double difference = 0, turnedDifference = 0;
  const Image8 wanted = upright(plain, turned.rotation == 90 ? 6 : 8), upturned = decoded("turned.mp4");
  REQUIRE((upturned.width == wanted.width && upturned.height == wanted.height));
  for (std::size_t i = 0; i < plain.values.size(); ++i) {
    difference += std::abs(int(plain.values[i]) - int(variable.values[i]));
    turnedDifference += std::abs(int(wanted.values[i]) - int(upturned.values[i]));
  }
  CHECK(difference / double(plain.values.size()) < 2);
  CHECK(turnedDifference / double(plain.values.size()) < 1);
}

TEST_CASE("HDR video becomes SDR as HDR pictures do") {
  const test::TemporaryFolder folder;
  // Grey of 92 cd/m² in PQ: half of the range.
  ffmpeg({"-f", "lavfi", "-i", "color=c=0x808080:s=64x64:r=10:d=1,format=yuv420p10le", "-c:v", "libx265",
          "-x265-params", "log-level=error:colorprim=bt2020:transfer=smpte2084:colormatrix=bt2020nc",
          "-color_primaries", "bt2020", "-color_trc", "smpte2084", "-colorspace", "bt2020nc",
          (folder / "hdr.mp4").string()});
  const VideoStream stream = probeStream(folder / "hdr.mp4", "ffprobe");
  CHECK((stream.info.hdr && stream.colour.transfer == 16 && stream.colour.primaries == 9));
  const std::size_t number[] = {3};
  VideoFile(folder / "hdr.mp4", stream, "ffmpeg").colourFrames(number, [&](std::size_t, const Image8& picture) {
    CHECK(std::abs(picture.pixel(32, 32)[1] - 255 * linearToSrgb(92.2 / 203)) < 4);
    return true;
  });
}

TEST_CASE("what is no video, and missing programs, are named") {
  const test::TemporaryFolder folder;
  writeFile(folder / "a.mp4", "no video at all");
  CHECK_THAT(test::errorOf([&] { probeVideo(folder / "a.mp4"); }).what(), Contains("a.mp4"));
  CHECK_THAT(test::errorOf([&] { probeVideo(folder / "b.mp4"); }).what(), Contains("b.mp4"));
  CHECK_THAT(test::errorOf([&] { probeVideo(folder / "a.mp4", "missing-ffprobe"); }).what(),
             Contains("missing-ffprobe"));
  const std::string video = pan(folder, "pan.mp4");
  VideoOptions options{.video = video, .folder = folder / "frames"};
  CHECK(test::errorOf([&] { extractFrames(options, [](const Progress&) { return false; }); }).code() ==
        ErrorCode::cancelled);
  CHECK_FALSE(std::filesystem::exists(folder / "frames/.video.json"));
  // A video that ends early gives the frames before.
  const std::vector<std::byte> bytes = readFile(video);
  pan(folder, "whole.mkv", {"-g", "5"});
  const std::vector<std::byte> whole = readFile(folder / "whole.mkv");
  writeFile(folder / "cut.mkv", std::span(whole).first(whole.size() * 6 / 10));
  options.video = folder / "cut.mkv";
  const VideoFrames cut = extractFrames(options);
  INFO(cut.decoded << " frames of 90");
  CHECK((cut.decoded > 20 && cut.decoded < 90));
}
