// The program that the tool's own test mutates.
#include <cstdio>

namespace sample {

constexpr int kMost = 7;

int less(int a, int b) { return a * 10 - b; }

bool is_inside(int x) { return x > 2 && x <= kMost; }

void count(int* sum, int to) {
  for (int i = 0; i < to; ++i) {
    if (i == 3) continue;
    *sum += i;
  }
}

}  // namespace sample

int main() {
  for (int x = 0; x < 12; ++x) std::printf("%d", sample::is_inside(x) ? 1 : 0);
  int sum = 1;
  sample::count(&sum, 6);
  std::printf(" %d %d\n", sum, sample::less(3, 4));
}
