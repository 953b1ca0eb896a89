// The border between batch_eigen.cpp and the kernels that are compiled once per register width. Plain data only:
// an inline function here would be compiled with AVX-512 flags too and the linker might keep that copy.
#pragma once

namespace mottle::lane_kernels {

/// Where the mass is when a kernel gets to work.
enum class MassKind {
  folded,           ///< constant; the stiffness terms are in standard form already
  folded_diagonal,  ///< the same, and the back-transformation is diagonal
  diagonal,         ///< depends on the sample; every term diagonal
  full,             ///< depends on the sample
};

/// A family and its coefficients. Packed matrices hold the lower triangle column by column.
struct Problem {
  int order = 0;
  int modes = 0;
  bool vectors = false;
  MassKind mass_kind = MassKind::folded;
  int stiffness_terms = 0;
  int mass_terms = 0;
  const double* stiffness = nullptr;               ///< [1 + terms][packed], the constant first
  const double* mass = nullptr;                    ///< [1 + terms][packed, or order if diagonal]; null if folded
  const double* back_transform = nullptr;          ///< folded: L^-T, [order x order] by columns; null otherwise
  const double* stiffness_coefficients = nullptr;  ///< [sample][term]
  const double* mass_coefficients = nullptr;
  long stiffness_stride = 0;
  long mass_stride = 0;
};

/// Where results go; a sample that the kernel does not vouch for gets trusted = 0.
struct Output {
  double* values = nullptr;   ///< [sample][mode]
  double* vectors = nullptr;  ///< [sample][mode][dof] or null
  unsigned char* trusted = nullptr;
};

/// A sparse symmetric matrix by its lower triangle, compressed columns.
struct SparseLower {
  int columns = 0;
  const int* starts = nullptr;
  const int* rows = nullptr;
  const double* values = nullptr;
};

/// A supernodal L as CHOLMOD keeps it: neighbouring columns of equal pattern are one dense block [row x column] by
/// columns, whose first rows are those of its diagonal. What lies above the diagonal is not read.
struct SupernodalLower {
  int supernodes = 0;
  const int* columns = nullptr;       ///< [supernode + 1]: the first column of each
  const int* row_starts = nullptr;    ///< [supernode + 1]: into rows
  const int* rows = nullptr;          ///< ascending in each supernode
  const int* value_starts = nullptr;  ///< [supernode + 1]: into values
  const double* values = nullptr;
};

/// Vectors side by side are padded to a multiple of this.
constexpr int k_vector_padding = 8;

/// Kernels of one register width; each solves samples [begin, end).
struct Kernels {
  void (*solve_small)(const Problem&, const Output&, long begin, long end);
  /// The workspace holds workspace_doubles(problem) and is aligned to 64 bytes.
  void (*solve_large)(const Problem&, const Output&, long begin, long end, double* workspace);
  long (*workspace_doubles)(const Problem&);
  /// out += A in for `width` vectors, a multiple of k_vector_padding: both [column][vector].
  void (*add_symmetric_product)(const SparseLower&, int width, const double* in, double* out);
  /// Solve L X = B and L' X = B in place for `width` right-hand sides, one or a multiple of `lanes`: x [row][side].
  void (*solve_lower)(const SupernodalLower&, int width, double* x);
  void (*solve_lower_transposed)(const SupernodalLower&, int width, double* x);
  int lanes;  ///< doubles in a register
};

/// The kernels of the widest registers that this processor has.
const Kernels& widest_kernels();

/// Orders that the kernels take: small ones up to k_jacobi_limit, large ones up to k_order_limit.
constexpr int k_jacobi_limit = 8;
constexpr int k_order_limit = 400;

void jacobi_plain(const Problem&, const Output&, long begin, long end);
extern const Kernels k_plain;
#if defined(__x86_64__)
void jacobi_avx2(const Problem&, const Output&, long begin, long end);
void jacobi_avx512(const Problem&, const Output&, long begin, long end);
extern const Kernels k_avx2;
extern const Kernels k_avx512;
#endif

}  // namespace mottle::lane_kernels
