// SPDX-License-Identifier: Apache-2.0
// ibr-decode: reads a HEIC, AVIF, WebP or raw photograph from stdin and writes what io/decoded.h describes to stdout.
//   ibr-decode probe PIXELS      the header
//   ibr-decode picture PIXELS    the header and the rows; at most this number of pixels
// Exit status: 0; 1 and a line on stderr: damaged; 3 and a line: not supported.
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <vector>

#include "base/check.h"
#include "decode/picture_file.h"
#include "io/decoded.h"

namespace {

using namespace ibr;

constexpr int kDamaged = 1, kWrongUse = 2, kUnsupported = 3;
constexpr std::size_t kLargestFile = std::size_t(1) << 30;

void limit(int resource, rlim_t most) {
  rlimit at{};
  ::getrlimit(decltype(RLIMIT_AS)(resource), &at);
  at.rlim_cur = at.rlim_max = std::min(at.rlim_max, most);
  ::setrlimit(decltype(RLIMIT_AS)(resource), &at);
}

// Address space, which counts libraries and threads, too, and processor time.
void limitFor(double pixels) {
  constexpr double kLibraries = 1.5e9, kBytesPerPixel = 60, kSeconds = 60, kSecondsPerMegapixel = 3;
  limit(RLIMIT_AS, rlim_t(kLibraries + double(kLargestFile) + kBytesPerPixel * pixels));
  limit(RLIMIT_CPU, rlim_t(kSeconds + kSecondsPerMegapixel * 1e-6 * pixels));
}

std::vector<std::byte> readAll() {
  constexpr std::size_t kPiece = std::size_t(1) << 20;
  std::vector<std::byte> bytes;
  for (;;) {
    const std::size_t before = bytes.size();
    check(before <= kLargestFile, ErrorCode::unsupported, "files over 1 GiB are not supported");
    bytes.resize(before + kPiece);
    const ssize_t got = ::read(STDIN_FILENO, bytes.data() + before, kPiece);
    if (got < 0 && errno == EINTR) {
      bytes.resize(before);
      continue;
    }
    bytes.resize(before + std::size_t(std::max<ssize_t>(got, 0)));
    if (got <= 0) return bytes;
  }
}

void write(const void* bytes, std::size_t size) {
  check(std::fwrite(bytes, 1, size, stdout) == size, ErrorCode::io, "the output cannot be written");
}

std::unique_ptr<app::PictureFile> open(std::span<const std::byte> file) {
  switch (io::programFormat(file).value_or(ImageFormat::jpeg)) {
    case ImageFormat::heic:
    case ImageFormat::avif:
      return app::openHeif(file);
    case ImageFormat::webp:
      return app::openWebp(file);
    case ImageFormat::raw:
      return app::openRaw(file);
    default:
      fail(ErrorCode::unsupported, "the file is none of HEIC, AVIF, WebP and raw");
  }
}

void decode(bool picture, std::int64_t pixels) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limitFor(0);
  const std::vector<std::byte> file = readAll();
  const std::unique_ptr<app::PictureFile> opened = open(file);
  const ImageFileInfo info = opened->info();
  const io::DecodedHeader header = io::headerOf(info);
  write(&header, sizeof(header));
  if (!picture) return;
  io::checkSize(info, {.pixels = pixels}, "the picture");
  const Image8 rows = opened->decode();
  write(rows.values.data(), rows.values.size());
}

}  // namespace

int main(int count, char** arguments) {
  const std::string_view step = count == 3 ? arguments[1] : "";
  const long long pixels = count == 3 ? std::atoll(arguments[2]) : 0;
  if ((step != "probe" && step != "picture") || pixels <= 0) {
    std::fputs(
        "ibr-decode is run by libibr, which reads HEIC, AVIF, WebP and raw photographs with it.\n"
        "ibr-decode probe|picture PIXELS < FILE > DECODED\n",
        stderr);
    return kWrongUse;
  }
  try {
    decode(step == "picture", pixels);
    return std::fflush(stdout) == 0 ? 0 : kDamaged;
  } catch (const std::bad_alloc&) {
    std::fputs("decoding needs too much memory\n", stderr);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    if (error.code() == ErrorCode::unsupported) return kUnsupported;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return kDamaged;
}
