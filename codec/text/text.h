// Text for people and for programs, in every form of a report: broken into lines, quoted, counted.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>

namespace rubric::text {

/// Returns "3.842100"; empty without a time, which is a negative one.
std::string seconds_text(std::int64_t time_us);
/// Returns "1 frame", "2 frames".
std::string counted(std::uint64_t number, std::string_view singular, std::string_view plural = {});

/// Returns lines of at most `width` characters, broken at blanks, each with its end: the first
/// after `first`, the others after `hang` blanks. A longer word has a line of its own. Both texts
/// are made harmless.
std::string wrapped(std::string_view first, std::string_view text, std::size_t width,
                    std::size_t hang);
/// Returns the same of texts that are harmless already.
std::string broken_at_blanks(std::string_view first, std::string_view text, std::size_t width,
                             std::size_t hang);
/// Returns the same with as many blanks as `first` has characters.
inline std::string wrapped(std::string_view first, std::string_view text, std::size_t width) {
  return wrapped(first, text, width, first.size());
}

/// How a report for people looks.
struct TextStyle {
  std::size_t width = 100;
  bool color = false;
};
inline constexpr std::string_view kIndent = "  ";

/// In a style of the terminal ("1;31"), if colours are wanted.
std::string painted(const TextStyle& look, std::string_view style, std::string_view text);
std::string in_capitals(std::string_view text);
/// A coloured first word, and the rest broken into lines.
std::string styled(const TextStyle& look, std::string_view style, std::string_view head,
                   std::string_view rest);
/// "  Rule:     text", broken into lines; empty for an empty text.
std::string field(std::string_view name, std::string_view text, const TextStyle& look);

/// Length of the UTF-8 sequence that `text` begins with; 0 if it begins with none.
std::size_t utf8_length(std::string_view text);

/// Returns `text` as a JSON string with quotes. Bytes that are not UTF-8 become U+FFFD.
std::string json_string(std::string_view text);
/// Writes the same at a place that has room for 6 * text.size() + 2 characters; returns its end.
char* put_json_string(char* at, std::string_view text);

/// Returns text for attributes and content of XML 1.0 alike; characters that it cannot hold become
/// U+FFFD.
std::string xml_text(std::string_view text);

/// Which characters of control a text keeps that people read.
enum class Keep : std::uint8_t { kNone, kLines };

/// Returns `text` with everything that a terminal would obey, and bytes that are not UTF-8,
/// replaced by U+FFFD; kLines keeps line feeds and tabs. What comes from outside and is shown to
/// people goes through this: names of files, cases and interfaces, source lines, texts of
/// expectations, notes.
std::string harmless(std::string_view text, Keep keep = Keep::kNone);

/// Prints lines for people to a file, harmless. Throws std::system_error if that cannot be written;
/// what stderr does not take is lost.
void print_harmless(std::FILE* file, std::string_view lines);

/// Returns a text harmless and without line ends, anything else as it is.
template <class T>
decltype(auto) in_one_line(const T& value) {
  if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    return harmless(value);
  } else {
    return (value);
  }
}

/// Prints the same of a format and texts that have no line ends: those in a name would begin a line
/// that looks like one of ours. See fmt::print().
template <class... Args>
void print(std::FILE* file, fmt::format_string<Args...> format, const Args&... args) {
  print_harmless(file, fmt::vformat(format, fmt::make_format_args(in_one_line(args)...)));
}

}  // namespace rubric::text
