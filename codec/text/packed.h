// Files packed by gzip or zstd, read and written piece by piece.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "codec/runtime/bytes.h"

namespace rubric::text {

enum class Packing : std::uint8_t { kNone, kGzip, kZstd };

/// Returns how a file that begins with these bytes is packed.
Packing packing_of(Bytes first_bytes);
/// Returns how a file of this name is to be packed: .gz, .zst.
Packing packing_of_name(std::string_view name);
/// Returns the name without the suffix that says how it is packed.
std::string_view name_unpacked(std::string_view name);

/// Packed bytes that are damaged; `what` says so.
class PackedDamage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Unpacker {
 public:
  virtual ~Unpacker() = default;
  /// Unpacks into `to`, takes what it used off `packed`, and returns the number of bytes written,
  /// 0 only if it needs more of `packed`. Takes files that were packed one by one and joined.
  /// Throws PackedDamage.
  virtual std::size_t unpack(Bytes& packed, MutableBytes to) = 0;
  /// Returns whether the input may end here.
  virtual bool may_end() const = 0;
};

class Packer {
 public:
  virtual ~Packer() = default;
  /// Appends what is ready to be written.
  virtual void pack(std::string_view bytes, std::string& out) = 0;
  virtual void finish(std::string& out) = 0;
};

/// Return null for kNone.
std::unique_ptr<Unpacker> make_unpacker(Packing packing);
std::unique_ptr<Packer> make_packer(Packing packing);

/// Unpacks the whole of a file. Throws PackedDamage.
std::string unpacked(Packing packing, std::string_view packed);

}  // namespace rubric::text
