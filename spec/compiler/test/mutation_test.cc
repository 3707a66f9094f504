// The compiler never crashes or hangs: it reads wire specs with random damage and either reports
// something or emits.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "spec/compiler/emit/emit.h"
#include "spec/compiler/load/load.h"
#include "spec/compiler/wire_specs.h"
#include "tools/tests/made_inputs.h"

namespace rubricc {
namespace {

constexpr int kRounds = rubric::made_inputs(300);

std::string read(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    out.push_back(text.substr(at, end - at));
    at = end;
  }
  return out;
}

class Damage {
 public:
  explicit Damage(unsigned seed) : random_(seed) {}

  std::string to(const std::string& text) {
    std::vector<std::string> lines = lines_of(text);
    for (std::size_t left = 1 + below(3); left > 0; --left) once(lines);
    std::string out;
    for (const std::string& line : lines) out += line;
    return out;
  }

 private:
  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }

  void once(std::vector<std::string>& lines) {
    std::string& line = lines[below(lines.size())];
    const std::string other = lines[below(lines.size())];
    switch (below(6)) {
      case 0: line.clear(); break;
      case 1: line += other; break;
      case 2: line = other; break;
      case 3: line.insert(below(line.size() + 1), 1, " {}[]:,&*'\"-#|>\n0x"[below(18)]); break;
      case 4:
        if (!line.empty()) line.erase(below(line.size()), 1);
        break;
      default: replace_value(line, other); break;
    }
  }

  /// Keeps the key, and takes the value from elsewhere.
  static void replace_value(std::string& line, const std::string& other) {
    const std::size_t mine = line.find(": "), theirs = other.find(": ");
    if (mine != line.npos && theirs != other.npos) {
      line = line.substr(0, mine) + other.substr(theirs);
    }
  }

  std::mt19937 random_;
};

TEST(Mutations, AreReportedOrCompiled) {
  int compiled = 0;
  Model known;
  Diagnostics none;
  load_requirements("spec/requirements.yaml", known, none);
  ASSERT_TRUE(none.empty());
  for (const std::string& file : wire_specs()) {
    const std::string text = read(file);
    ASSERT_FALSE(text.empty());
    for (int round = 0; round < kRounds; ++round) {
      SCOPED_TRACE(testing::Message() << file << ", seed " << round);
      Model model;
      Diagnostics diagnostics;
      model.requirements = known.requirements;
      load_spec_text(file, Damage(static_cast<unsigned>(round)).to(text), model, diagnostics);
      check_model(model, diagnostics);
      diagnostics.print();
      if (!diagnostics.empty()) continue;
      ++compiled;
      for (const auto& spec : model.specs) {
        EXPECT_FALSE(emit_tables(*spec).empty());
        EXPECT_FALSE(emit_messages(*spec).empty());
        EXPECT_FALSE(emit_dictionary(*spec).empty());
        EXPECT_FALSE(emit_cpp(*spec).empty());
        EXPECT_FALSE(emit_java(*spec).empty());
      }
      EXPECT_FALSE(emit_json(model).empty());
    }
  }
  EXPECT_GT(compiled, 20);
}

}  // namespace
}  // namespace rubricc
