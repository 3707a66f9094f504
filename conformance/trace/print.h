// Prints traces as text, in the one canonical layout.
#pragma once

#include <string>

#include "conformance/trace/trace.h"

namespace rubric::trace {

/// Returns the text of a whole file. For every file that check() accepts parse(print(file)) gives
/// the same file.
std::string print(const File& file);
/// Returns one line of a case without its line end.
std::string print(const Line& line);
std::string print(const Message& message);
std::string print(const Time& time);

/// Appends the same: logs are written line by line.
void put_line(const Line& line, std::string& out);
void put_header(const Header& header, std::string& out);
void put_message(const Message& message, std::string& out);

}  // namespace rubric::trace
