// Colours of a terminal.
#pragma once

#include <string_view>

#include "tools/format/buffer.h"

namespace rubric::format {

/// The role of a piece of text; each has a look of its own in colour.
enum class Style : unsigned char { kPlain, kDim, kMessage, kNote, kError, kField };

inline constexpr std::size_t kFieldColors = 6;

/// Returns escape sequences that begin a style; kField has kFieldColors of them, to be taken in
/// turn.
inline std::string_view style_start(Style style, std::size_t turn = 0) {
  constexpr std::string_view kTurns[kFieldColors] = {"\033[36m", "\033[33m", "\033[35m",
                                                     "\033[32m", "\033[34m", "\033[96m"};
  switch (style) {
    case Style::kPlain: return {};
    case Style::kDim: return "\033[2m";
    case Style::kMessage: return "\033[1;36m";
    case Style::kNote: return "\033[33m";
    case Style::kError: return "\033[1;31m";
    case Style::kField: return kTurns[turn % kFieldColors];
  }
  return {};
}
inline constexpr std::string_view kStyleEnd = "\033[0m";

/// Appends in styles, or plainly.
class Styled {
 public:
  Styled(Buffer& out, bool color) : out_(out), color_(color) {}

  void begin(Style style, std::size_t turn = 0) {
    open_ = color_ && style != Style::kPlain;
    if (open_) out_.append(style_start(style, turn));
  }
  void end() {
    if (open_) out_.append(kStyleEnd);
    open_ = false;
  }
  void put(Style style, std::string_view text) {
    begin(style);
    out_.append(text);
    end();
  }
  Buffer& out() { return out_; }
  bool color() const { return color_; }

 private:
  Buffer& out_;
  bool color_;
  bool open_ = false;
};

}  // namespace rubric::format
