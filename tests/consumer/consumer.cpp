// Uses one thing of every layer worth a user's attention, through installed headers alone.
#include <cstdio>

#include "mottle/core/parallel.hpp"
#include "mottle/core/random.hpp"

int main() {
  mottle::RandomStream stream({.seed = 1, .purpose = mottle::StreamPurpose::parameter_cloud}, 0);
  const double uniform = stream.uniform();
  std::printf("uniform %.6f, %d threads\n", uniform, mottle::available_threads());
  return 0.0 < uniform && uniform < 1.0 ? 0 : 1;
}
