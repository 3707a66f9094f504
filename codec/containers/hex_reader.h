// Packets as lines of hex text, as TinyOS's Listen prints them.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "codec/containers/hdlc_reader.h"
#include "codec/containers/reader.h"

namespace rubric {

inline constexpr std::int64_t kDayNs = 86'400'000'000'000;

struct LineStamp {
  std::size_t size = 0;  ///< Of all that is before the bytes, blanks included; 0: nothing.
  std::int64_t time_ns = kNoTime;  ///< Since 1970 or the start of something, or of the day.
  bool of_day = false;             ///< A time of day without a date.
  std::string_view marker;         ///< The word for "received", as `RX:`; empty without one.
};

/// Reads the time stamp that a line begins with, blanks and an arrow after it included, a label as
/// `mote 2:` or `node 2:` before a packet, and a marker before bytes: `rx`, `RX`, with a colon or
/// not, or `<-`. Stamps are a text in brackets with a digit, as `[12.345]` or `(12.345)`; a number
/// with a point, as `1700000000.123`; a time of day, as `12:34:56.789` or `10:00:00 AM`, after a
/// date or not: those of `ts`, minicom, the Arduino IDE and Contiki's serialdump are. A `:` or `|`
/// may end them. Hex text never begins so. And a number of 10, 13, 16 or 19 digits from 1 on, as
/// `date +%s` prints it, before words of another size: hex text has words of one size.
///
/// A stamp has a time if it says milliseconds at least, and one moment only: a number counts
/// seconds; a date must name its year and not leave open which number is the month. A date and a
/// time without a zone are taken for UTC.
LineStamp read_stamp(Bytes line);

/// The most characters of a line that are kept.
inline constexpr std::size_t kHexLineMax = 64 * 1024;

/// Reads a packet a line: two hex digits of either case for each byte, with or without white space
/// between bytes, each byte or run of bytes optionally led by 0x. Skips empty lines and everything
/// after a '#'. An option gives the framing of the lines (hex_framing). Where that is kSf, a line
/// that begins_serial_frame() has the bytes of a serial line, flags and escapes included; a frame
/// goes on in the next lines until its closing flag.
///
/// What read_stamp() knows is passed over; its time is the packet's, which came when its line was
/// printed, or somewhat before. A time of day without a date counts from the first midnight; where
/// it goes back by more than half a day, the next one has begun. In a log the lines that is_noise()
/// knows, and those with fewer bytes than a packet's header, are passed over and counted; those of
/// read_radio_line() are radio frames.
///
/// Faults: kUnexpected (a line that is no hex text: the line itself is delivered, the offset counts
/// its characters), kTooLong (a line beyond kHexLineMax), kCut never: the last line needs no end;
/// and those of the framing, whose offsets count the bytes of the packet.
/// Source: TinyOS Listen tool.
class HexReader final : public Reader {
 public:
  explicit HexReader(const ReaderOptions& options = {}, bool is_log = false);

  void feed(Bytes chunk, PacketSink sink) override;
  void finish(PacketSink sink) override;
  Noise noise() const override { return noise_; }

 private:
  bool is_serial_bytes(Bytes bytes) const;
  void serial_bytes(Bytes bytes, std::int64_t time_ns, PacketSink sink);
  std::int64_t time_of(const LineStamp& stamp);
  void hold(Bytes text);
  void line(Bytes whole, PacketSink sink);
  void pass_over(Bytes whole);
  void deliver_held(PacketSink sink);

  ReaderOptions options_;
  bool is_log_;
  Noise noise_;
  std::uint64_t line_number_ = 0;
  std::unique_ptr<HdlcReader> serial_;  // Made for the first line of a serial line's bytes.
  bool in_frame_ = false;               // The last byte of such a line was no flag.
  std::int64_t of_day_ns_ = 0;          // The last time of day,
  std::int64_t days_ = 0;               // and the midnights before it.
  std::uint64_t line_offset_ = 0;
  std::uint64_t dropped_ = 0;
  std::vector<std::uint8_t> held_;   // The beginning of a line that spans chunks.
  std::vector<std::uint8_t> bytes_;  // The present line, decoded.
};

/// The bytes of a serial packet's header; a shorter line of hex digits in a log may be a word or a
/// number.
inline constexpr std::size_t kPacketLineBytes = 8;

/// Returns whether a line that is no hex text is of another kind altogether, such as a program's
/// greeting, rather than hex text with a mistake: whether its first word is no hex digits, or a
/// word has two characters that are none.
bool is_noise(Bytes line);

/// Returns whether a line of these bytes, one at least, is taken for those of a serial line: a
/// flag, and a second flag or a packet kind of TEP 113 if more follows. A packet may begin with 7E,
/// too.
bool begins_serial_frame(Bytes bytes);

/// Returns whether hex text begins with the bytes of a packet's header.
bool begins_packet(Bytes text);

/// Returns the bytes of a line before hex text that begins_packet(), a known stamp included; 0
/// where nothing else is before it.
std::size_t unknown_prefix(Bytes line);

/// Returns the bytes of the mark with which editors begin a file of UTF-8 text: 3 or 0.
std::size_t mark_size(Bytes text);

bool is_hex_digit(std::uint8_t c);

/// Decodes one line into `bytes`, which is cleared first. The error's offset counts characters.
Error decode_hex_line(Bytes text, std::vector<std::uint8_t>& bytes);

}  // namespace rubric
