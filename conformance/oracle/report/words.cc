#include "conformance/oracle/report/words.h"

#include <fmt/format.h>

namespace rubric::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD.

// Length of the well-formed UTF-8 sequence at the front; 0 if there is none.
std::size_t sequence_length(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = at(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((at(i) & 0xC0) != 0x80) return 0;
  }
  // Overlong forms, surrogates, and what lies beyond U+10FFFF.
  const unsigned char second = at(1);
  const bool wrong = (lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
                     (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F);
  return wrong ? 0 : length;
}

// Calls `put` for each well-formed character, with U+FFFD for each byte of what is not.
template <class Put>
void each_character(std::string_view text, Put put) {
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    put(length == 0 ? kReplacement : text.substr(0, length));
    text.remove_prefix(length == 0 ? 1 : length);
  }
}

}  // namespace

std::string_view severity_name(oracle::Severity severity) {
  switch (severity) {
    case oracle::Severity::kNote: return "note";
    case oracle::Severity::kWeak: return "weak";
    case oracle::Severity::kStray: return "stray";
    case oracle::Severity::kInconclusive: return "inconclusive";
    case oracle::Severity::kFail: return "fail";
  }
  return "fail";
}

std::string_view verdict_name(oracle::Verdict verdict) {
  switch (verdict) {
    case oracle::Verdict::kPass: return "pass";
    case oracle::Verdict::kWeak: return "weak";
    case oracle::Verdict::kStray: return "stray";
    case oracle::Verdict::kInconclusive: return "inconclusive";
    case oracle::Verdict::kFail: return "fail";
  }
  return "error";
}

std::string seconds_text(std::int64_t time_us) {
  if (time_us < 0) return {};
  return fmt::format("{}.{:06}", time_us / 1'000'000, time_us % 1'000'000);
}

std::string place_text(const oracle::Run& run, const oracle::Place& place) {
  std::string out = place.frame == 0 ? std::string("the end of the run")
                                     : fmt::format("frame {}", place.frame);
  if (place.frame != 0 && run.files.size() > 1 && place.file < run.files.size()) {
    out += " of " + run.files[place.file];
  }
  if (place.time_us >= 0) out += " at " + seconds_text(place.time_us) + " s";
  return out;
}

std::string counted(std::uint64_t number, std::string_view singular, std::string_view plural) {
  if (number == 1) return fmt::format("1 {}", singular);
  if (plural.empty()) return fmt::format("{} {}s", number, singular);
  return fmt::format("{} {}", number, plural);
}

std::string wrapped(std::string_view first, std::string_view text, std::size_t width,
                    std::size_t hang) {
  std::string out(first);
  std::size_t column = first.size();
  bool fresh = true;  // Nothing stands in this line yet.
  while (!text.empty()) {
    const std::size_t begin = text.find_first_not_of(" \n\t\r");
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find_first_of(" \n\t\r"));
    text.remove_prefix(word.size());
    if (!fresh && column + 1 + word.size() > width) {
      out += '\n';
      out.append(hang, ' ');
      column = hang;
      fresh = true;
    }
    if (!fresh) out += ' ', ++column;
    out += word;
    column += word.size();
    fresh = false;
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out + '\n';
}

std::string json_string(std::string_view text) {
  std::string out = "\"";
  each_character(text, [&](std::string_view c) {
    const auto byte = static_cast<unsigned char>(c.front());
    if (c == "\"" || c == "\\") {
      out += '\\';
      out += c;
    } else if (c == "\n") {
      out += "\\n";
    } else if (byte < 0x20) {
      out += fmt::format("\\u{:04x}", byte);
    } else {
      out += c;
    }
  });
  return out + '"';
}

std::string xml_text(std::string_view text) {
  std::string out;
  each_character(text, [&](std::string_view c) {
    const auto byte = static_cast<unsigned char>(c.front());
    const bool forbidden = (byte < 0x20 && c != "\n" && c != "\t") ||
                           c == "\xEF\xBF\xBE" || c == "\xEF\xBF\xBF";
    if (c == "&") {
      out += "&amp;";
    } else if (c == "<") {
      out += "&lt;";
    } else if (c == ">") {
      out += "&gt;";
    } else if (c == "\"") {
      out += "&quot;";
    } else {
      out += forbidden ? kReplacement : c;
    }
  });
  return out;
}

}  // namespace rubric::report
