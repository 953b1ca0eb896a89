/* Frequencies of three masses of 1 kg on six springs, as a solver that fails in every way: of the runs it crashes in one
   part, hangs in another, prints garbage in a third, loses a mode in a fourth. Which runs these are depends on the numbers
   of the input alone. It says at its end in a log that it has run.

   solver INPUT OUTPUT;   FAULTS="crash hang garbage lost" (parts), RUN_LOG=FILE, PAUSE_MS=N */
#include <math.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void rotate(double a[3][3], int p, int q) {
  if (a[p][q] == 0.0) return;
  double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
  double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
  double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
  for (int k = 0; k < 3; ++k) {
    double x = a[k][p], y = a[k][q];
    a[k][p] = c * x - s * y;
    a[k][q] = s * x + c * y;
  }
  for (int k = 0; k < 3; ++k) {
    double x = a[p][k], y = a[q][k];
    a[p][k] = c * x - s * y;
    a[q][k] = s * x + c * y;
  }
}

static int ascending(const void* a, const void* b) {
  double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

int main(int count, char** arguments) {
  double k[6], f[3], crash = 0.0, hang = 0.0, garbage = 0.0, lost = 0.0;
  FILE* input = count == 3 ? fopen(arguments[1], "r") : NULL;
  if (input == NULL) return 2;
  for (int i = 0; i < 6; ++i) {
    if (fscanf(input, "%lf", &k[i]) != 1) return 2;
  }
  uint64_t hash = 1469598103934665603u;
  for (size_t i = 0; i < sizeof(k); ++i) hash = (hash ^ ((unsigned char*)k)[i]) * 1099511628211u;
  hash ^= hash >> 33;
  hash *= 0xff51afd7ed558ccdu;
  hash ^= hash >> 33;
  double chance = (double)(hash >> 11) / 9007199254740992.0;
  if (k[0] == 2.0 && k[1] == 2.0 && k[4] == 2.0) chance = 1.0; /* the first run, at the means: else nothing would start */
  if (getenv("PAUSE_MS") != NULL) usleep(1000 * atoi(getenv("PAUSE_MS")));
  if (getenv("FAULTS") != NULL) sscanf(getenv("FAULTS"), "%lf %lf %lf %lf", &crash, &hang, &garbage, &lost);
  if (chance < crash) raise(SIGSEGV);
  if ((chance -= crash) >= 0.0 && chance < hang) {
    for (;;) pause();
  }
  int is_garbage = (chance -= hang) >= 0.0 && chance < garbage;
  int is_lost = (chance -= garbage) >= 0.0 && chance < lost;

  double a[3][3] = {{k[0] + k[3] + k[5], -k[3], -k[5]}, {-k[3], k[1] + k[3] + k[4], -k[4]}, {-k[5], -k[4], k[2] + k[4] + k[5]}};
  for (int sweep = 0; sweep < 30; ++sweep) {
    rotate(a, 0, 1);
    rotate(a, 0, 2);
    rotate(a, 1, 2);
  }
  for (int i = 0; i < 3; ++i) f[i] = sqrt(a[i][i]) / (2.0 * acos(-1.0));
  qsort(f, 3, sizeof(f[0]), ascending);
  FILE* output = fopen(arguments[2], "w");
  if (output == NULL) return 3;
  fprintf(output, "NATURAL FREQUENCIES\n");
  for (int i = 0; i < 3; ++i) {
    if (is_lost && i == 1) continue;
    if (is_garbage && i == 1) fprintf(output, "  2  ********\n");
    else fprintf(output, "%3d  %.15e\n", i + 1, f[i]);
  }
  if (fclose(output) != 0) return 3;
  if (getenv("RUN_LOG") != NULL) {
    FILE* log = fopen(getenv("RUN_LOG"), "a");
    if (log == NULL || fprintf(log, "%016llx\n", (unsigned long long)hash) < 0 || fclose(log) != 0) return 3;
  }
  return 0;
}
