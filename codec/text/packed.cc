#include "codec/text/packed.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <new>

namespace rubric::text {
namespace {

constexpr std::size_t kPieceBytes = 64 * 1024;
constexpr int kGzipWindow = 15 + 16;  // The greatest window; 16 asks for gzip's header.

struct Suffix {
  std::string_view text;
  Packing packing;
};
constexpr Suffix kSuffixes[] = {{".gz", Packing::kGzip}, {".zst", Packing::kZstd}};

const Suffix* suffix_of(std::string_view name) {
  for (const Suffix& one : kSuffixes) {
    if (name.size() > one.text.size() && name.ends_with(one.text)) return &one;
  }
  return nullptr;
}

class GzipUnpacker final : public Unpacker {
 public:
  GzipUnpacker() {
    if (inflateInit2(&stream_, kGzipWindow) != Z_OK) throw std::bad_alloc();
  }
  ~GzipUnpacker() override { inflateEnd(&stream_); }
  GzipUnpacker(const GzipUnpacker&) = delete;
  GzipUnpacker& operator=(const GzipUnpacker&) = delete;

  std::size_t unpack(Bytes& packed, MutableBytes to) override {
    if (damaged_) throw damage();
    stream_.next_out = to.data();
    stream_.avail_out = static_cast<uInt>(to.size());
    while (stream_.avail_out == to.size() && !packed.empty()) {
      if (ended_) inflateReset(&stream_);  // Another file follows.
      ended_ = false;
      stream_.next_in = const_cast<std::uint8_t*>(packed.data());  // zlib does not write there.
      stream_.avail_in = static_cast<uInt>(std::min(packed.size(), kPieceBytes));
      const int result = inflate(&stream_, Z_NO_FLUSH);
      packed = packed.from(static_cast<std::size_t>(stream_.next_in - packed.data()));
      if (result == Z_STREAM_END) ended_ = true;
      if (result == Z_OK || result == Z_STREAM_END || result == Z_BUF_ERROR) continue;
      damaged_ = true;
      if (stream_.avail_out == to.size()) throw damage();
    }
    if (stream_.avail_out == to.size() && !ended_) inflate(&stream_, Z_NO_FLUSH);  // What waits.
    return to.size() - stream_.avail_out;
  }
  bool may_end() const override { return ended_; }

 private:
  static PackedDamage damage() { return PackedDamage("its gzip data are damaged"); }

  z_stream stream_{};
  bool ended_ = false;
  bool damaged_ = false;
};

class ZstdUnpacker final : public Unpacker {
 public:
  ZstdUnpacker() : stream_(ZSTD_createDStream(), ZSTD_freeDStream) {
    if (!stream_) throw std::bad_alloc();
  }

  std::size_t unpack(Bytes& packed, MutableBytes to) override {
    // What a call writes before it meets a damage is lost.
    ZSTD_outBuffer out{to.data(), std::min(to.size(), kPieceBytes), 0};
    do {
      ZSTD_inBuffer in{packed.data(), packed.size(), 0};
      const std::size_t left = ZSTD_decompressStream(stream_.get(), &out, &in);
      if (ZSTD_isError(left) != 0) throw PackedDamage("its zstd data are damaged");
      packed = packed.from(in.pos);
      if (in.pos != 0 || out.pos != 0) ended_ = left == 0;
    } while (out.pos == 0 && !packed.empty());
    return out.pos;
  }
  bool may_end() const override { return ended_; }

 private:
  std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream_;
  bool ended_ = false;
};

class GzipPacker final : public Packer {
 public:
  GzipPacker() {
    constexpr int kMemory = 8;  // zlib's default.
    if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, kMemory,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~GzipPacker() override { deflateEnd(&stream_); }
  GzipPacker(const GzipPacker&) = delete;
  GzipPacker& operator=(const GzipPacker&) = delete;

  void pack(std::string_view bytes, std::string& out) override {
    while (!bytes.empty()) {
      const std::string_view piece = bytes.substr(0, kPieceBytes);
      run(piece, Z_NO_FLUSH, out);
      bytes.remove_prefix(piece.size());
    }
  }
  void finish(std::string& out) override { run({}, Z_FINISH, out); }

 private:
  void run(std::string_view piece, int flush, std::string& out) {
    auto* const data = const_cast<char*>(piece.data());  // zlib does not write there.
    stream_.next_in = reinterpret_cast<std::uint8_t*>(data);
    stream_.avail_in = static_cast<uInt>(piece.size());
    std::array<std::uint8_t, kPieceBytes> buffer;
    do {
      stream_.next_out = buffer.data();
      stream_.avail_out = static_cast<uInt>(buffer.size());
      deflate(&stream_, flush);
      out.append(reinterpret_cast<const char*>(buffer.data()), buffer.size() - stream_.avail_out);
    } while (stream_.avail_out == 0);
  }

  z_stream stream_{};
};

class ZstdPacker final : public Packer {
 public:
  ZstdPacker() : stream_(ZSTD_createCStream(), ZSTD_freeCStream) {
    if (!stream_) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(stream_.get(), ZSTD_c_checksumFlag, 1);
  }

  void pack(std::string_view bytes, std::string& out) override { run(bytes, ZSTD_e_continue, out); }
  void finish(std::string& out) override { run({}, ZSTD_e_end, out); }

 private:
  void run(std::string_view bytes, ZSTD_EndDirective what, std::string& out) {
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    std::array<char, kPieceBytes> buffer;
    std::size_t left = 0;
    do {
      ZSTD_outBuffer to{buffer.data(), buffer.size(), 0};
      left = ZSTD_compressStream2(stream_.get(), &to, &in, what);
      if (ZSTD_isError(left) != 0) throw std::bad_alloc();  // Nothing else can fail here.
      out.append(buffer.data(), to.pos);
    } while (in.pos < in.size || (what == ZSTD_e_end && left != 0));
  }

  std::unique_ptr<ZSTD_CStream, decltype(&ZSTD_freeCStream)> stream_;
};

}  // namespace

Packing packing_of(Bytes first_bytes) {
  constexpr std::uint8_t kGzipMagic[] = {0x1F, 0x8B, Z_DEFLATED};
  constexpr std::uint8_t kZstdMagic[] = {0x28, 0xB5, 0x2F, 0xFD};
  const auto begins_with = [&](Bytes magic) {
    return first_bytes.size() >= magic.size() && equal(first_bytes.first(magic.size()), magic);
  };
  if (begins_with(kGzipMagic)) return Packing::kGzip;
  return begins_with(kZstdMagic) ? Packing::kZstd : Packing::kNone;
}

Packing packing_of_name(std::string_view name) {
  const Suffix* const suffix = suffix_of(name);
  return suffix ? suffix->packing : Packing::kNone;
}

std::string_view name_unpacked(std::string_view name) {
  const Suffix* const suffix = suffix_of(name);
  return suffix ? name.substr(0, name.size() - suffix->text.size()) : name;
}

std::unique_ptr<Unpacker> make_unpacker(Packing packing) {
  if (packing == Packing::kGzip) return std::make_unique<GzipUnpacker>();
  if (packing == Packing::kZstd) return std::make_unique<ZstdUnpacker>();
  return nullptr;
}

std::unique_ptr<Packer> make_packer(Packing packing) {
  if (packing == Packing::kGzip) return std::make_unique<GzipPacker>();
  if (packing == Packing::kZstd) return std::make_unique<ZstdPacker>();
  return nullptr;
}

std::string unpacked(Packing packing, std::string_view packed) {
  const std::unique_ptr<Unpacker> unpacker = make_unpacker(packing);
  if (!unpacker) return std::string(packed);
  Bytes rest(reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size());
  std::array<std::uint8_t, kPieceBytes> buffer;
  std::string out;
  while (const std::size_t size = unpacker->unpack(rest, {buffer.data(), buffer.size()})) {
    out.append(reinterpret_cast<const char*>(buffer.data()), size);
  }
  if (!unpacker->may_end()) throw PackedDamage("its compressed data end too soon");
  return out;
}

}  // namespace rubric::text
