// SPDX-License-Identifier: Apache-2.0
#include "io/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>

#include <cassert>
#include <cstring>

#include "base/check.h"
#include "base/file.h"

namespace ibr {
namespace {

// Turns exceptions of OpenEXR into Error.
template <class Work>
auto guarded(const std::filesystem::path& path, ErrorCode code, Work&& work) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    fail(code, "{}: OpenEXR: {}", path.string(), e.what());
  }
}

Imf::Slice slice(const ImageF& image) {
  return Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(image.values.data())), sizeof(float),
                    sizeof(float) * std::size_t(image.width));
}

class MemoryStream : public Imf::IStream {
 public:
  MemoryStream(std::span<const std::byte> bytes, const std::string& name) : Imf::IStream(name.c_str()), bytes_(bytes) {}

  bool read(char to[], int count) override {
    check(count >= 0 && std::size_t(count) <= bytes_.size() - at_, ErrorCode::invalidInput, "{}: the file is truncated",
          fileName());
    std::memcpy(to, bytes_.data() + at_, std::size_t(count));
    at_ += std::size_t(count);
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override {
    check(at <= bytes_.size(), ErrorCode::invalidInput, "{}: the file is truncated", fileName());
    at_ = std::size_t(at);
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

}  // namespace

void writeExr(const std::filesystem::path& path, std::span<const ExrChannel> channels) {
  assert(!channels.empty());
  Imf::Header header(channels[0].values.width, channels[0].values.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer pixels;
  for (const ExrChannel& channel : channels) {
    assert(channel.values.channels == 1 && channel.values.width == channels[0].values.width &&
           channel.values.height == channels[0].values.height);
    header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    pixels.insert(channel.name, slice(channel.values));
  }
  Imf::StdOSStream stream;
  guarded(path, ErrorCode::io, [&] {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(pixels);
    file.writePixels(channels[0].values.height);
  });
  const std::string text = stream.str();
  writeFile(path, std::as_bytes(std::span(text)));
}

std::vector<ExrChannel> readExr(const std::filesystem::path& path) {
  constexpr std::int64_t kMaxSide = 1 << 16, kMaxPixels = std::int64_t(1) << 28;
  const std::vector<std::byte> bytes = readFile(path);
  return guarded(path, ErrorCode::invalidInput, [&] {
    MemoryStream stream(bytes, path.string());
    Imf::InputFile file(stream, 0);
    const auto box = file.header().dataWindow();
    const std::int64_t width = std::int64_t(box.max.x) - box.min.x + 1,
                       height = std::int64_t(box.max.y) - box.min.y + 1;
    check(width > 0 && height > 0 && width <= kMaxSide && height <= kMaxSide && width * height <= kMaxPixels,
          ErrorCode::invalidInput, "{}: {}×{} pixels; the limits are {} per side and {} in total", path.string(), width,
          height, kMaxSide, kMaxPixels);
    std::vector<ExrChannel> channels;
    for (auto channel = file.header().channels().begin(); channel != file.header().channels().end(); ++channel)
      channels.push_back({channel.name(), ImageF(int(width), int(height), 1)});
    Imf::FrameBuffer pixels;
    for (const ExrChannel& channel : channels) {
      Imf::Slice to = slice(channel.values);
      to.base -= std::int64_t(sizeof(float)) * (box.min.y * width + box.min.x);
      pixels.insert(channel.name, to);
    }
    file.setFrameBuffer(pixels);
    file.readPixels(box.min.y, box.max.y);
    return channels;
  });
}

}  // namespace ibr
