// Sums without order on several threads, as no code of this project may.
#include <tbb/parallel_for.h>

#include <cstdio>

int main() {
  long sum = 0;
  tbb::parallel_for(0, 1000, [&](int i) { sum += i; });
  std::printf("%ld\n", sum);
}
