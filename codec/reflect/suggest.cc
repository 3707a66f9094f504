#include "codec/reflect/suggest.h"

#include <algorithm>

namespace rubric::reflect {

// Damerau-Levenshtein, restricted: three rows are enough.
int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> before(b.size() + 1);
  std::vector<int> above(b.size() + 1);
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int replace = above[j - 1] + (a[i - 1] != b[j - 1]);
      row[j] = std::min({row[j - 1] + 1, above[j] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

std::string_view nearest(std::string_view word, const std::vector<std::string>& names) {
  constexpr std::size_t kLongest = 64;  // Longer words are no names.
  if (word.size() > kLongest) return {};
  std::string_view best;
  int best_distance = 0;
  for (const std::string& name : names) {
    // A beginning counts as near: "dec" means "decode", "output" means "out".
    const bool begins = (word.size() >= 2 && name.starts_with(word)) ||
                        (name.size() >= 3 && word.starts_with(name));
    const int distance = begins ? 1 : edit_distance(word, name);
    if (best.empty() || distance < best_distance) {
      best = name;
      best_distance = distance;
    }
  }
  const int tolerated = std::max<int>(1, static_cast<int>(word.size()) / 3);
  return best_distance <= tolerated ? best : std::string_view{};
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  const std::string_view name = nearest(word, names);
  return name.empty() ? std::string{} : " (did you mean '" + std::string(name) + "'?)";
}

}  // namespace rubric::reflect
