// Folds the output of templates to 100 columns.
#include <algorithm>
#include <vector>

#include "spec/compiler/emit/cpp/emit_cpp_text.h"

namespace rubricc::cpp {
namespace {

constexpr std::size_t kColumns = 100;

std::size_t indent_of(const std::string& line) {
  const std::size_t at = line.find_first_not_of(' ');
  return at == line.npos ? line.size() : at;
}

std::string mark_of(const std::string& line) {
  const std::string text = line.substr(indent_of(line));
  if (text.starts_with("/// ")) return "///";
  return text.starts_with("// ") ? "//" : "";
}

// Returns the last place within the columns where a line may end: the best kind of place first.
std::size_t break_of(const std::string& line, std::size_t indent) {
  for (const std::string_view text : {" && ", " || ", " ? ", ", ", " + ", "(", " = "}) {
    for (std::size_t at = line.rfind(text, kColumns - text.size());
         at != line.npos && at >= indent + 8; at = line.rfind(text, at - 1)) {
      if (text == "(" && (line[at + 1] == ')' || line.find("if (") + 3 == at)) continue;
      const bool keep_left = text != " ? " && text != " + ";
      return keep_left ? at + text.size() : at + 1;
    }
  }
  return line.npos;
}

void fold_code(const std::string& line, std::vector<std::string>& out) {
  if (line.size() <= kColumns) return out.push_back(line);
  const std::size_t indent = indent_of(line);
  const std::string pad(indent, ' ');
  const std::size_t open = line.find(") const { ");
  const std::size_t plain = line.find(") { ");
  const std::size_t body = open != line.npos ? open + 9 : plain != line.npos ? plain + 3 : open;
  if (body != line.npos && line.ends_with(" }")) {  // A function in one line becomes three.
    fold_code(line.substr(0, body), out);
    fold_code(pad + "  " + line.substr(body + 1, line.size() - body - 3), out);
    return out.push_back(pad + "}");
  }
  const std::size_t at = break_of(line, indent);
  if (at == line.npos) return out.push_back(line);
  std::string head = line.substr(0, at);
  while (head.ends_with(' ')) head.pop_back();
  out.push_back(head);
  fold_code(pad + "    " + line.substr(at), out);
}

}  // namespace

std::string fold(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  std::vector<std::string> out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string mark = mark_of(lines[i]);
    if (mark.empty() || lines[i].size() <= kColumns) {
      fold_code(lines[i], out);
      continue;
    }
    // Fills the whole rest of the paragraph again.
    const std::size_t indent = indent_of(lines[i]);
    std::string prose;
    for (; i < lines.size() && mark_of(lines[i]) == mark; ++i) {
      prose += lines[i].substr(indent + mark.size()) + " ";
    }
    --i;
    std::string filled = comment(prose, mark, indent);
    for (std::size_t at = 0; at < filled.size();) {
      const std::size_t end = filled.find('\n', at);
      out.push_back(std::string(indent, ' ') + filled.substr(at, end - at));
      at = end + 1;
    }
  }
  std::string folded;
  for (const std::string& line : out) folded += line + "\n";
  return folded;
}

}  // namespace rubricc::cpp
